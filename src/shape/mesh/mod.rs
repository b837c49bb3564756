//! Triangle meshes.

pub(crate) mod bvh;
pub(crate) mod edges;
pub(crate) mod rays;
pub(crate) mod segment_triangle;

use super::corners::Corners;
use super::four_tree::FourTree;
use super::slabs::{Near, Slabs};
use super::{Material, Surfaces};
use crate::error::{Error, each, index};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x4, f32x8, ones};
use crate::limits;
use crate::memory::{bytes_of, sum_bytes};
use bvh::{Item, LEAF, MAX_TRIANGLES, MeshBvh, Path, triangles};
#[cfg(feature = "observe")]
use edges::Fold;
use edges::{Edges, find_edges};
use glam::Vec3;
use rays::{TriangleRays, take};
use segment_triangle::SegmentTest;

/// Bits of a corner that are a vertex; the two above are the fold of the edge that starts there.
pub(super) const VERTEX_BITS: u32 = 30;
pub(super) const VERTEX_MASK: u32 = (1 << VERTEX_BITS) - 1;

/// A static triangle mesh, shared by the shapes that use it.
///
/// It is touched from both sides. Triangles are kept in the order of the tree's leaves, so their indices are
/// not those they were given with. 22 bytes a triangle, tree included, where each vertex is shared by six
/// triangles.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    pub(super) vertices: Vec<Vec3>,
    /// Vertex indices with the folds in their top bits.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) tree: MeshBvh,
    pub(super) min: Vec3,
    pub(super) max: Vec3,
    /// Materials of triangles.
    pub(crate) surfaces: Option<Box<Surfaces>>,
}

impl TriangleMesh {
    /// A mesh of triangles that wind counter-clockwise seen from the front (which only the fold of edges
    /// depends on).
    ///
    /// Equal vertices become one; triangles without area, or given twice, are dropped.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// let corners = vec![Vec3::ZERO, Vec3::Z * 9.0, Vec3::X * 9.0, Vec3::new(9.0, 0.0, 9.0)];
    /// let floor = TriangleMesh::new(corners, vec![[0, 1, 2], [1, 3, 2]])?;
    /// assert_eq!(floor.triangle_count(), 2);
    /// let floor = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::mesh(floor)));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// A coordinate is not finite or beyond 1e7, an index has no vertex, no triangle has an area, or there
    /// are more than 2^28 triangles.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<TriangleMesh, Error> {
        TriangleMesh::build(vertices, triangles, find_edges, None)
    }

    /// The same with materials of the triangles, in the order of these: zero for that of the shape
    /// ([`ShapeDesc::material`](crate::ShapeDesc::material)), `i` for `materials[i - 1]`. A contact has the
    /// material of the triangles that it is on. A byte a triangle.
    ///
    /// # Errors
    /// As for [`TriangleMesh::new`]; or the number of triangles isn't that of `of_triangles`, a number is
    /// beyond the table, which has at most 255 materials, or one of these is out of range.
    pub fn with_materials(
        vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        of_triangles: &[u8],
        materials: &[Material],
    ) -> Result<TriangleMesh, Error> {
        let surfaces = Surfaces::new(triangles.len(), of_triangles.to_vec(), materials.to_vec())?;
        TriangleMesh::build(vertices, triangles, find_edges, Some(surfaces))
    }

    /// The same without inactive edges: every edge may yield a normal of its own, as if nothing were beyond
    /// it, and bodies that slide trip over the seams. It is there to measure the effect of inactive edges
    /// (`docs/methods.md`).
    ///
    /// # Errors
    /// As for [`TriangleMesh::new`].
    #[cfg(feature = "observe")]
    pub fn with_active_edges(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<TriangleMesh, Error> {
        let open = |_: &[Vec3], triangles: &[[u32; 3]]| vec![Edges::new([Fold::Open; 3]); triangles.len()];
        TriangleMesh::build(vertices, triangles, open, None)
    }

    fn build(
        mut vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        find_edges: impl Fn(&[Vec3], &[[u32; 3]]) -> Vec<Edges>,
        mut surfaces: Option<Box<Surfaces>>,
    ) -> Result<TriangleMesh, Error> {
        each("vertex", &vertices, |v| {
            v.to_array().iter().try_for_each(|&x| limits::coordinate("mesh vertex", x))
        })?;
        if triangles.len() > MAX_TRIANGLES {
            return Err(Error::TooMany { what: "triangles of a mesh", most: MAX_TRIANGLES as u64 });
        }
        let of_vertex = |&i: &u32| index("mesh index", i as usize, vertices.len()).map(drop);
        each("triangle", &triangles, |corners| corners.iter().try_for_each(of_vertex))?;
        let (triangles, given) = weld(&mut vertices, &triangles);
        if triangles.is_empty() {
            return Err(Error::Degenerate("no triangle of the mesh has an area".into()));
        }
        let mut items: Vec<Item> = (0..)
            .zip(&triangles)
            .map(|(triangle, t)| {
                let [a, b, c] = t.map(|v| vertices[v as usize]);
                Item { min: a.min(b).min(c), max: a.max(b).max(c), triangle }
            })
            .collect();
        let tree = MeshBvh::build(&mut items);

        // Leaf order for triangles, order of first use for vertices: near elements are near in memory.
        // Permanent buffers are allocated before larger temporary ones are freed: many allocators would put
        // later allocations into the holes.
        let mut renamed = vec![u32::MAX; vertices.len()];
        let mut sorted = Vec::with_capacity(vertices.len());
        let mut in_order: Vec<[u32; 3]> = Vec::with_capacity(triangles.len());
        let edges = find_edges(&vertices, &triangles);
        in_order.extend(items.iter().map(|item| {
            let t = item.triangle as usize;
            std::array::from_fn(|k| {
                let v = triangles[t][k] as usize;
                if renamed[v] == u32::MAX {
                    renamed[v] = sorted.len() as u32;
                    sorted.push(vertices[v]);
                }
                renamed[v] | (edges[t].fold(k) as u32) << VERTEX_BITS
            })
        }));
        sorted.shrink_to_fit();
        if let Some(surfaces) = &mut surfaces {
            let part = |item: &Item| surfaces.parts[given[item.triangle as usize] as usize];
            surfaces.parts = items.iter().map(part).collect();
        }
        let min = sorted.iter().fold(Vec3::INFINITY, |m, v| m.min(*v));
        let max = sorted.iter().fold(Vec3::NEG_INFINITY, |m, v| m.max(*v));
        Ok(TriangleMesh { vertices: sorted, triangles: in_order, tree, min, max, surfaces })
    }

    /// Corners of its bounding box [m].
    pub fn aabb(&self) -> (Vec3, Vec3) {
        (self.min, self.max)
    }

    /// How many triangles there are.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Bytes live and reserved.
    pub fn bytes(&self) -> (usize, usize) {
        let own = size_of::<Self>();
        let lists = [bytes_of(&self.vertices), bytes_of(&self.triangles)];
        let more = [self.tree.bytes(), Surfaces::bytes(&self.surfaces), (own, own)];
        sum_bytes(lists.into_iter().chain(more))
    }

    #[inline(always)]
    pub(crate) fn triangle(&self, i: u32) -> [Vec3; 3] {
        // Not `map`: it is not inlined here.
        let [a, b, c] = self.triangles[i as usize];
        let at = |v: u32| self.vertices[(v & VERTEX_MASK) as usize];
        [at(a), at(b), at(c)]
    }

    pub(crate) fn edges(&self, i: u32) -> Edges {
        let t = self.triangles[i as usize];
        Edges((t[0] >> VERTEX_BITS | t[1] >> VERTEX_BITS << 2 | t[2] >> VERTEX_BITS << 4) as u8)
    }

    /// The triangles of a leaf of the tree.
    #[inline(always)]
    fn leaf(&self, first: u32, count: u32) -> Leaf {
        let mut corners = Corners::default();
        let triangles = &self.triangles[first as usize..(first + count) as usize];
        for (lane, triangle) in triangles.iter().enumerate().take(LEAF) {
            for (k, &v) in triangle.iter().enumerate() {
                corners.put(lane, k, self.vertices[(v & VERTEX_MASK) as usize]);
            }
        }
        Leaf { corners, lanes: (1 << triangles.len()) - 1 }
    }

    /// See [`Ground::visit_box`](super::Ground::visit_box).
    #[inline]
    pub(crate) fn visit_box(&self, min: Vec3, max: Vec3, f: &mut (impl FnMut(u32, [Vec3; 3]) + ?Sized)) {
        self.any_in_box(min, max, &mut |i, corners| {
            f(i, corners);
            false
        });
    }

    /// See [`Ground::nears`](super::Ground::nears).
    pub(crate) fn nears(&self, from: Vec3, to: Vec3, reach: f32) -> bool {
        let (min, max) = (from.min(to) - reach, from.max(to) + reach);
        self.tree.any_in_box(min, max, |first, count| {
            let Leaf { corners, lanes } = self.leaf(first, count);
            let near = corners.meeting(min, max) & lanes;
            near != 0 && near & !corners.beyond(from, to, reach) != 0
        })
    }

    /// See [`Ground::visit_segment`](super::Ground::visit_segment).
    #[inline]
    pub(crate) fn visit_segment(
        &self,
        from: Vec3,
        to: Vec3,
        inflate: Vec3,
        f: &mut (impl FnMut(u32, [Vec3; 3], f32) -> f32 + ?Sized),
    ) {
        let path = Path::new(from, to, inflate, self.tree.slack());
        self.visit_ordered(1.0, &|b, _| path.enter::<f32x4>(b), &|b, _| path.enter::<f32x8>(b), f);
    }

    /// Calls `f` with the triangles whose key is at most `most`, about the smallest first; it returns the new
    /// `most`. `four` and `eight` say the keys of boxes ([`FourTree`]), given their low and high corners and
    /// `most`.
    #[inline(always)]
    fn visit_ordered(
        &self,
        most: f32,
        four: &impl Fn([&LaneVec3<f32x4>; 2], f32) -> f32x4,
        eight: &impl Fn([&LaneVec3<f32x8>; 2], f32) -> f32x8,
        f: &mut (impl FnMut(u32, [Vec3; 3], f32) -> f32 + ?Sized),
    ) {
        let mut look = |leaf: u32, _: f32, mut most: f32| {
            let (first, count) = triangles(leaf);
            let Leaf { corners, lanes } = self.leaf(first, count);
            let (low, high) = corners.bounds();
            let keys = eight([&low, &high], most);
            let near = Lanes::le(keys, f32x8::splat(most)).bits() & lanes;
            let keys = keys.to_array();
            for lane in ones(near) {
                if keys[lane % 8] <= most {
                    most = f(first + lane as u32, corners.triangle(lane % 8), most);
                }
            }
            most
        };
        self.tree.visit_ordered(0, &|low, high, most| four([low, high], most), most, &mut look);
    }

    /// The triangles of [`Ground::ray`](super::Ground::ray).
    pub(super) fn ray(
        &self,
        test: &SegmentTest,
        from: Vec3,
        path: Vec3,
        any: bool,
        nearest: &mut (f32, u32),
    ) {
        let (slabs, most) = (self.slabs(from, path), nearest.0);
        self.tree.visit_ordered(
            0,
            &|low, high, most| slabs.enter(low, high, most),
            most,
            &mut |leaf, entry, _| {
                let (first, count) = triangles(leaf);
                self.leaf(first, count).nearest(test, first, entry, nearest);
                if any && nearest.1 != u32::MAX { -1.0 } else { nearest.0 }
            },
        );
    }

    /// The same for rays together, each to the same bits.
    pub(crate) fn rays(&self, rays: &mut TriangleRays) {
        let TriangleRays { stream, walk, tests, nearest, rays, .. } = rays;
        walk.through(&self.tree, stream, *rays, &mut |leaf, rays, stream| {
            let (first, count) = triangles(leaf);
            let leaf = self.leaf(first, count);
            for ray in ones(rays) {
                leaf.nearest(&tests[ray], first, stream.entry[ray], &mut nearest[ray]);
                stream.most[ray] = nearest[ray].0;
            }
        });
    }

    pub(super) fn slabs(&self, from: Vec3, path: Vec3) -> Slabs<f32x4> {
        Slabs::new(from.as_dvec3(), path, Vec3::splat(self.tree.slack()))
    }

    /// See [`Ground::visit_path`](super::Ground::visit_path).
    pub(crate) fn visit_path(
        &self,
        from: glam::DVec3,
        path: Vec3,
        half: Vec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        let (four, eight) = (Slabs::<f32x4>::new(from, path, half), Slabs::<f32x8>::new(from, path, half));
        let four = |[low, high]: [&_; 2], most: f32| four.enter(low, high, most);
        self.visit_ordered(most, &four, &|[low, high], most| eight.enter(low, high, most), f);
    }

    /// See [`Ground::visit_near`](super::Ground::visit_near).
    pub(crate) fn visit_near(
        &self,
        at: glam::DVec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        let (four, eight) = (Near::<f32x4>::new(at), Near::<f32x8>::new(at));
        let four = |[low, high]: [&_; 2], _: f32| four.squared(low, high);
        self.visit_ordered(most, &four, &|[low, high], _| eight.squared(low, high), f);
    }

    /// See [`Ground::any_in_box`](super::Ground::any_in_box).
    #[inline]
    pub(crate) fn any_in_box(
        &self,
        min: Vec3,
        max: Vec3,
        f: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        self.tree.any_in_box(min, max, |first, count| {
            let Leaf { corners, lanes } = self.leaf(first, count);
            let meeting = corners.meeting(min, max) & lanes;
            ones(meeting).any(|lane| f(first + lane as u32, corners.triangle(lane % 8)))
        })
    }

    /// Corners of a triangle [m], in the order of its winding, by the index that queries report; nothing if
    /// there is no such triangle.
    pub fn corners(&self, triangle: u32) -> Option<[Vec3; 3]> {
        ((triangle as usize) < self.triangles.len()).then(|| self.triangle(triangle))
    }

    /// The table of materials; empty if all triangles have that of the shape.
    pub fn materials(&self) -> &[Material] {
        Surfaces::table(&self.surfaces)
    }

    /// Which material a triangle has, by the index that queries report: zero for that of the shape, `i` for
    /// `materials()[i - 1]`.
    pub fn material_of(&self, triangle: u32) -> u8 {
        Surfaces::part(&self.surfaces, triangle as usize)
    }
}

/// Up to eight triangles.
struct Leaf {
    corners: Corners,
    /// A bit for each.
    lanes: u32,
}

impl Leaf {
    /// Makes the first of its triangles that a path meets the nearest if it is: of those before the fraction,
    /// or of a lower index at the same. The leaf's first triangle is `first`, and its box is entered at
    /// `entry`.
    #[inline(always)]
    fn nearest(&self, test: &SegmentTest, first: u32, entry: f32, nearest: &mut (f32, u32)) {
        let corners = [self.corners.corner(0), self.corners.corner(1), self.corners.corner(2)];
        let (hit, t) = test.hits::<f32x8>(corners);
        let mut bits = hit.bits() & self.lanes;
        let t = Lanes::max(t, f32x8::splat(entry)).to_array();
        while bits != 0 {
            let lane = bits.trailing_zeros();
            bits &= bits - 1;
            take(nearest, t[lane as usize], first + lane);
        }
    }
}

/// Whether a triangle's height is above a millionth of its length: of others f32 doesn't know the normal.
pub(super) fn has_area(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() > 1e-6 * longest
}

/// Makes equal vertices one and drops triangles without area and those that are there already, either way
/// round. Returns the triangles, and which of those given each is.
fn weld(vertices: &mut [Vec3], triangles: &[[u32; 3]]) -> (Vec<[u32; 3]>, Vec<u32>) {
    // Adding zero makes of -0 a +0, so that equal numbers are equal bits.
    vertices.iter_mut().for_each(|v| *v += Vec3::ZERO);
    let bits = |v: u32| vertices[v as usize].to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_unstable_by_key(|&v| (bits(v), v));
    let mut first: Vec<u32> = (0..vertices.len() as u32).collect();
    for pair in order.windows(2) {
        if bits(pair[0]) == bits(pair[1]) {
            first[pair[1] as usize] = first[pair[0] as usize];
        }
    }
    let mut kept: Vec<([u32; 3], u32)> = Vec::with_capacity(triangles.len());
    let welded: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| first[v as usize])).collect();
    for (i, t) in (0..).zip(&welded) {
        if has_area(t.map(|v| vertices[v as usize])) {
            let mut sorted = *t;
            sorted.sort_unstable();
            kept.push((sorted, i));
        }
    }
    kept.sort_unstable();
    kept.dedup_by_key(|(sorted, _)| *sorted);
    let mut kept: Vec<u32> = kept.into_iter().map(|(_, i)| i).collect();
    kept.sort_unstable();
    (kept.iter().map(|&i| welded[i as usize]).collect(), kept)
}

#[cfg(test)]
pub(crate) mod testing;

#[cfg(test)]
mod tests;
