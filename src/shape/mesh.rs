//! Triangle meshes.

use super::corners::Corners;
use super::mesh_bvh::{Item, LEAF, MAX_TRIANGLES, MeshBvh, triangles};
#[cfg(feature = "lab")]
use super::mesh_edges::Fold;
use super::mesh_edges::{Edges, find_edges};
use super::segment_triangle::SegmentTest;
use super::slabs::{Near, Slabs};
use super::triangle_rays::{TriangleRays, take};
use crate::error::{Error, finite3};
use crate::lanes::{Lanes, Mask, f32x4, f32x8, ones};
use glam::Vec3;

pub(super) use crate::limits::MAX_COORDINATE as MOST;
/// Bits of a corner that are a vertex; the two above are the fold of the edge that starts there.
pub(super) const VERTEX_BITS: u32 = 30;
pub(super) const VERTEX_MASK: u32 = (1 << VERTEX_BITS) - 1;

/// A static triangle mesh, shared by the shapes that use it.
///
/// It is touched from both sides. Triangles are kept in the order of the tree's leaves, so their indices are not
/// those they were given with. 22 bytes a triangle, tree included, where each vertex is shared by six triangles.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    pub(super) vertices: Vec<Vec3>,
    /// Vertex indices with the folds in their top bits.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) tree: MeshBvh,
    pub(super) min: Vec3,
    pub(super) max: Vec3,
}

impl TriangleMesh {
    /// A mesh of triangles that wind counter-clockwise seen from the front (which only the fold of edges depends on).
    ///
    /// Equal vertices become one; triangles without area, or given twice, are dropped.
    ///
    /// # Errors
    /// A coordinate is not finite or beyond 1e7, an index has no vertex, no triangle has an area, or there are more
    /// than 2^28 triangles.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<TriangleMesh, Error> {
        TriangleMesh::build(vertices, triangles, find_edges)
    }

    /// The same without inactive edges: every edge may yield a normal of its own, as if nothing were beyond it, and bodies that
    /// slide trip over the seams. It is there to measure what inactive edges are worth (`docs/methods.md`).
    ///
    /// # Errors
    /// As for [`TriangleMesh::new`].
    #[cfg(feature = "lab")]
    pub fn with_active_edges(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<TriangleMesh, Error> {
        let open = |_: &[Vec3], triangles: &[[u32; 3]]| vec![Edges::new([Fold::Open; 3]); triangles.len()];
        TriangleMesh::build(vertices, triangles, open)
    }

    fn build(
        mut vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        find_edges: impl Fn(&[Vec3], &[[u32; 3]]) -> Vec<Edges>,
    ) -> Result<TriangleMesh, Error> {
        for v in &vertices {
            finite3("mesh vertex", *v)?;
            crate::error::within("mesh vertex", v.abs().max_element(), 0.0, MOST, "within 1e7")?;
        }
        if triangles.len() > MAX_TRIANGLES {
            return Err(Error::TooMany { what: "triangles of a mesh", most: MAX_TRIANGLES as u64 });
        }
        if let Some(&index) = triangles.iter().flatten().find(|&&i| i as usize >= vertices.len()) {
            return Err(Error::OutOfRange {
                what: "mesh index",
                expected: "an index of a vertex",
                value: index.into(),
            });
        }
        let triangles = weld(&mut vertices, &triangles);
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

        // Leaf order for triangles, order of first use for vertices: what is near is near in memory. Place for what stays is
        // made before what is larger goes: many allocators would put what comes after that between what is left of it.
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
        let min = sorted.iter().fold(Vec3::INFINITY, |m, v| m.min(*v));
        let max = sorted.iter().fold(Vec3::NEG_INFINITY, |m, v| m.max(*v));
        Ok(TriangleMesh { vertices: sorted, triangles: in_order, tree, min, max })
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
        let parts = [
            crate::memory::bytes_of(&self.vertices),
            crate::memory::bytes_of(&self.triangles),
            self.tree.bytes(),
            (size_of::<Self>(), size_of::<Self>()),
        ];
        parts.iter().fold((0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
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

    /// Calls `f` with every triangle whose bounding box meets a box, and its corners.
    #[inline]
    pub(crate) fn visit_box(&self, min: Vec3, max: Vec3, f: &mut (impl FnMut(u32, [Vec3; 3]) + ?Sized)) {
        self.tree.visit_box(min, max, |first, count| {
            let leaf = self.leaf(first, count);
            let mut bits = leaf.corners.meeting(min, max) & leaf.lanes;
            while bits != 0 {
                let lane = bits.trailing_zeros();
                bits &= bits - 1;
                f(first + lane, leaf.corners.triangle(lane as usize));
            }
        });
    }

    /// Whether any triangle may be within `reach` [m] of a segment, as far as boxes and planes tell.
    pub(crate) fn nears(&self, from: Vec3, to: Vec3, reach: f32) -> bool {
        let (min, max) = (from.min(to) - reach, from.max(to) + reach);
        self.tree.any_in_box(min, max, |first, count| {
            let Leaf { corners, lanes } = self.leaf(first, count);
            let near = corners.meeting(min, max) & lanes;
            near != 0 && near & !corners.beyond(from, to, reach) != 0
        })
    }

    /// Calls `f` with the triangles whose boxes, inflated by half extents, a path meets, with their corners and a
    /// fraction before which it does not; nearer ones first, as far as boxes tell. `f` returns the largest fraction that
    /// still matters.
    #[inline]
    pub(crate) fn visit_segment(
        &self,
        from: Vec3,
        to: Vec3,
        inflate: Vec3,
        f: &mut (impl FnMut(u32, [Vec3; 3], f32) -> f32 + ?Sized),
    ) {
        let path = self.tree.path(from, to, inflate);
        let look = |first: u32, count: u32, mut most: f32| {
            let leaf = self.leaf(first, count);
            let (low, high) = leaf.corners.bounds();
            let (meets, entry) = path.meets::<f32x8>(low, high);
            let mut bits = meets.bits() & leaf.lanes;
            let entry = entry.to_array();
            while bits != 0 {
                let lane = bits.trailing_zeros();
                bits &= bits - 1;
                let entry = entry[lane as usize];
                if entry <= most {
                    most = most.min(f(first + lane, leaf.corners.triangle(lane as usize), entry));
                }
            }
            most
        };
        self.tree.visit_segment(&path, look);
    }

    /// Where a path first meets a triangle, from either side: the fraction of it, and the triangle. Nothing slips
    /// through an edge or a vertex that triangles share.
    pub(crate) fn segment_hit(&self, from: Vec3, to: Vec3) -> Option<(f32, u32)> {
        let test = SegmentTest::new(from, to)?;
        let mut nearest: Option<(f32, u32)> = None;
        self.visit_segment(from, to, Vec3::ZERO, &mut |i, corners, _| {
            test.nearer(i, corners, &mut nearest);
            nearest.map_or(1.0, |n| n.0)
        });
        nearest
    }

    /// As [`TriangleMesh::segment_hit`] for queries: by start and displacement, up to the fraction `most`; the first hit,
    /// or if `any` will do, one of them. A hit counts from where its leaf is entered: so it does not matter which leaf is
    /// asked first where edges are widened beyond their boxes.
    pub(crate) fn ray(&self, from: Vec3, path: Vec3, most: f32, any: bool) -> Option<(f32, u32)> {
        let test = SegmentTest::along(from, path)?;
        let slabs = self.slabs(from, path);
        let mut nearest = (most, u32::MAX);
        self.tree.visit_ordered(
            0,
            |low, high, most| slabs.enter(low, high, most),
            most,
            |leaf, entry, _| {
                let (first, count) = triangles(leaf);
                self.leaf(first, count).nearest(&test, first, entry, &mut nearest);
                if any && nearest.1 != u32::MAX { -1.0 } else { nearest.0 }
            },
        );
        (nearest.1 != u32::MAX).then_some(nearest)
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

    /// Calls `f` with the triangles whose boxes a box of half extents `half` meets that moves along a path, up to the
    /// fraction `most`, about the nearest first; it returns the new `most`.
    pub(crate) fn visit_path(
        &self,
        from: glam::DVec3,
        path: Vec3,
        half: Vec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        let (four, eight) = (Slabs::<f32x4>::new(from, path, half), Slabs::<f32x8>::new(from, path, half));
        self.tree.visit_ordered(
            0,
            |low, high, most| four.enter(low, high, most),
            most,
            |leaf, _, mut most| {
                let (first, count) = triangles(leaf);
                let leaf = self.leaf(first, count);
                let (low, high) = leaf.corners.bounds();
                let enter = eight.enter(&low, &high, most).to_array();
                for (lane, &enter) in enter.iter().enumerate().take(count as usize) {
                    if enter <= most {
                        most = f(first + lane as u32, leaf.corners.triangle(lane), most);
                    }
                }
                most
            },
        );
    }

    /// Calls `f` with the triangles whose boxes may be within the squared distance `most` of a point [m²], about the
    /// nearest first; it returns the new `most`.
    pub(crate) fn visit_near(
        &self,
        at: glam::DVec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        let (four, eight) = (Near::<f32x4>::new(at), Near::<f32x8>::new(at));
        self.tree.visit_ordered(
            0,
            |low, high, _| four.squared(low, high),
            most,
            |leaf, _, mut most| {
                let (first, count) = triangles(leaf);
                let leaf = self.leaf(first, count);
                let (low, high) = leaf.corners.bounds();
                let far = eight.squared(&low, &high).to_array();
                for (lane, &far) in far.iter().enumerate().take(count as usize) {
                    if far <= most {
                        most = f(first + lane as u32, leaf.corners.triangle(lane), most);
                    }
                }
                most
            },
        );
    }

    /// Whether `f` says yes to any triangle whose bounding box meets a box.
    pub(crate) fn any_in_box(
        &self,
        min: Vec3,
        max: Vec3,
        f: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        self.tree.any_in_box(min, max, |first, count| {
            let leaf = self.leaf(first, count);
            let bits = leaf.corners.meeting(min, max) & leaf.lanes;
            (0..count)
                .any(|lane| bits >> lane & 1 != 0 && f(first + lane, leaf.corners.triangle(lane as usize)))
        })
    }

    /// Corners of a triangle [m], in the order of its winding, by the index that queries report; nothing if there is no
    /// such triangle.
    pub fn corners(&self, triangle: u32) -> Option<[Vec3; 3]> {
        ((triangle as usize) < self.triangles.len()).then(|| self.triangle(triangle))
    }
}

/// Up to eight triangles.
struct Leaf {
    corners: Corners,
    /// A bit for each.
    lanes: u32,
}

impl Leaf {
    /// Makes the first of its triangles that a path meets the nearest if it is: of those before the fraction, or of a
    /// lower index at the same. The leaf's first triangle is `first`, and its box is entered at `entry`.
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

/// Makes equal vertices one and drops triangles without area and those that are there already, either way round.
fn weld(vertices: &mut [Vec3], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
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
        let [a, b, c] = t.map(|v| vertices[v as usize].as_dvec3());
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        // A height of a millionth of the length: of such a triangle f32 doesn't know the normal.
        if (b - a).cross(c - a).length() > 1e-6 * longest {
            let mut sorted = *t;
            sorted.sort_unstable();
            kept.push((sorted, i));
        }
    }
    kept.sort_unstable();
    kept.dedup_by_key(|(sorted, _)| *sorted);
    let mut kept: Vec<u32> = kept.into_iter().map(|(_, i)| i).collect();
    kept.sort_unstable();
    kept.into_iter().map(|i| welded[i as usize]).collect()
}

/// Meshes and numbers that tests share.
#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// SplitMix64.
    pub(crate) struct Random(pub(crate) u64);

    impl Random {
        pub(crate) fn next(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        }
        pub(crate) fn range(&mut self, low: f32, high: f32) -> f32 {
            low + (high - low) * ((self.next() >> 40) as f32 / (1u64 << 24) as f32)
        }
        pub(crate) fn cube(&mut self) -> Vec3 {
            Vec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0))
        }
        pub(crate) fn below(&mut self, n: usize) -> usize {
            (self.next() % n as u64) as usize
        }
        pub(crate) fn rotation(&mut self) -> glam::Quat {
            let (v, w) = (self.cube(), self.range(-1.0, 1.0));
            glam::Quat::from_xyzw(v.x, v.y, v.z, w + 1e-3).normalize()
        }
    }

    /// A box that winds outwards.
    pub(crate) fn cuboid(half: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let vertices = (0..8).map(|i| Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)) * half).collect();
        let quads = [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];
        (vertices, quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect())
    }

    /// Square cells around the origin whose fronts look up.
    pub(crate) fn grid(
        cells: u32,
        cell: f32,
        height: impl Fn(f32, f32) -> f32,
    ) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (row, half) = (cells + 1, cells as f32 * cell * 0.5);
        let at = |n: u32| n as f32 * cell - half;
        let vertices = (0..row * row).map(|v| (at(v % row), at(v / row)));
        let vertices = vertices.map(|(x, z)| Vec3::new(x, height(x, z), z)).collect();
        let mut triangles = Vec::new();
        for k in 0..cells {
            for i in 0..cells {
                let (v00, v01) = (k * row + i, (k + 1) * row + i);
                triangles.push([v00, v01, v00 + 1]);
                triangles.push([v00 + 1, v01, v01 + 1]);
            }
        }
        (vertices, triangles)
    }

    /// Hills, bumps and sharp ridges.
    pub(crate) fn bumpy(x: f32, z: f32) -> f32 {
        use libm::{cosf, sinf};
        let hills = 1.5 * sinf(0.35 * x) * cosf(0.27 * z);
        let bumps = 0.5 * sinf(0.9 * x + 1.3) * sinf(1.1 * z + 0.7);
        let ridge = 1.0 - sinf(0.21 * x + 0.13 * z).abs();
        hills + bumps + 1.5 * ridge * ridge * ridge
    }

    pub(crate) fn terrain(cells: u32) -> TriangleMesh {
        let (vertices, triangles) = grid(cells, 0.5, bumpy);
        TriangleMesh::new(vertices, triangles).unwrap()
    }

    /// Triangles of all sizes anywhere, with edges in common now and then.
    pub(crate) fn soup(count: usize, random: &mut Random) -> TriangleMesh {
        let vertices: Vec<Vec3> = (0..count).map(|_| random.cube() * 10.0).collect();
        let triangles = (0..count)
            .map(|i| {
                let near = |r: &mut Random| (i + r.below((count / 20).max(9))) % count;
                [i as u32, near(random) as u32, near(random) as u32]
            })
            .collect();
        TriangleMesh::new(vertices, triangles).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::testing::*;
    use super::*;

    #[test]
    fn a_mesh_refuses_what_is_no_mesh_and_drops_what_is_no_triangle() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::X, Vec3::X * 2.0];
        let new = |triangles: &[[u32; 3]]| TriangleMesh::new(corners.clone(), triangles.to_vec());
        assert!(matches!(new(&[]), Err(Error::Degenerate(_))));
        assert!(matches!(new(&[[0, 1, 5]]), Err(Error::OutOfRange { .. })));
        assert!(matches!(new(&[[0, 1, 4], [0, 1, 1], [1, 2, 3]]), Err(Error::Degenerate(_))));
        let bad = TriangleMesh::new(vec![Vec3::NAN; 3], vec![[0, 1, 2]]);
        assert!(matches!(bad, Err(Error::NotFinite { .. })));
        // The same again, turned, and with the other vertex of the same place.
        let mesh = new(&[[0, 1, 2], [1, 2, 0], [0, 2, 3], [0, 1, 4]]).unwrap();
        assert_eq!(mesh.triangle_count(), 1);
        assert_eq!(mesh.vertices.len(), 3);
    }

    #[test]
    fn boxes_find_the_triangles_that_a_search_of_all_finds() {
        let mut random = Random(1);
        for mesh in [soup(3000, &mut random), terrain(40), soup(40, &mut random)] {
            for _ in 0..500 {
                let centre = random.cube() * 11.0;
                let half = random.cube().abs() * random.range(0.0, 3.0);
                let (min, max) = (centre - half, centre + half);
                let mut found = Vec::new();
                mesh.visit_box(min, max, &mut |t, _| found.push(t));
                found.sort_unstable();
                let expected: Vec<u32> = (0..mesh.triangle_count() as u32)
                    .filter(|&t| {
                        let [a, b, c] = mesh.triangle(t);
                        a.min(b).min(c).cmple(max).all() && a.max(b).max(c).cmpge(min).all()
                    })
                    .collect();
                assert_eq!(found, expected);
            }
        }
    }

    /// Whether a path meets a box, by slabs in f64.
    fn slabs(from: Vec3, to: Vec3, min: Vec3, max: Vec3) -> Option<f64> {
        let (mut enter, mut exit) = (0.0f64, 1.0f64);
        for k in 0..3 {
            let (p, d) = (f64::from(from[k]), f64::from(to[k]) - f64::from(from[k]));
            let (low, high) = (f64::from(min[k]), f64::from(max[k]));
            if d == 0.0 {
                if p < low || p > high {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - p) / d, (high - p) / d);
            (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
        }
        (enter <= exit).then_some(enter)
    }

    #[test]
    fn paths_find_every_triangle_whose_inflated_box_they_meet() {
        let mut random = Random(2);
        for mesh in [soup(3000, &mut random), terrain(40)] {
            for round in 0..500 {
                let from = random.cube() * 12.0;
                let mut to = if round % 4 == 0 { from } else { random.cube() * 12.0 };
                if round % 4 == 1 {
                    (to.x, to.z) = (from.x, from.z);
                }
                let inflate = random.cube().abs() * 0.5 * (round % 3) as f32;
                let mut found = vec![None; mesh.triangle_count()];
                mesh.visit_segment(from, to, inflate, &mut |t, _, entry| {
                    assert!(found[t as usize].replace(entry).is_none());
                    1.0
                });
                for (t, found) in found.iter().enumerate() {
                    let [a, b, c] = mesh.triangle(t as u32);
                    let (min, max) = (a.min(b).min(c) - inflate, a.max(b).max(c) + inflate);
                    match (slabs(from, to, min, max), *found) {
                        (Some(enter), Some(entry)) => assert!(f64::from(entry) <= enter + 1e-6),
                        (Some(_), None) => panic!("missed {t}"),
                        (None, Some(_)) => {
                            let more = Vec3::splat(1e-4);
                            assert!(slabs(from, to, min - more, max + more).is_some());
                        }
                        (None, None) => {}
                    }
                }
            }
        }
    }

    /// Segment against triangle in f64, by volumes (Ericson 5.3.4); `None` within `border` of an edge or an end.
    fn exact(from: Vec3, to: Vec3, t: [Vec3; 3], border: f64) -> Option<Option<f64>> {
        let (p, d) = (from.as_dvec3(), to.as_dvec3() - from.as_dvec3());
        let [a, b, c] = t.map(|v| v.as_dvec3() - p);
        let volumes = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
        let sum: f64 = volumes.iter().sum();
        let normal = (b - a).cross(c - a);
        if volumes.iter().any(|v| (v / sum).abs() < border) || sum.abs() <= 1e-9 {
            return None;
        }
        let fraction = a.dot(normal) / d.dot(normal);
        if fraction.abs() < border || (fraction - 1.0).abs() < border {
            return None;
        }
        let inside = volumes.iter().all(|v| v / sum > 0.0) && (0.0..=1.0).contains(&fraction);
        Some(inside.then_some(fraction))
    }

    #[test]
    fn a_path_hits_the_nearest_triangle_of_all() {
        let mut random = Random(3);
        for mesh in [soup(500, &mut random), terrain(30)] {
            let mut hits = 0;
            'paths: for _ in 0..2000 {
                let (from, to) = (random.cube() * 9.0, random.cube() * 9.0);
                let mut nearest: Option<f64> = None;
                for t in 0..mesh.triangle_count() as u32 {
                    match exact(from, to, mesh.triangle(t), 1e-4) {
                        None => continue 'paths,
                        Some(Some(f)) => nearest = Some(nearest.map_or(f, |n: f64| n.min(f))),
                        Some(None) => {}
                    }
                }
                let found = mesh.segment_hit(from, to);
                assert_eq!(found.is_some(), nearest.is_some());
                if let (Some((f, _)), Some(n)) = (found, nearest) {
                    hits += 1;
                    assert!((f64::from(f) - n).abs() < 1e-5, "{f} {n}");
                }
            }
            assert!(hits > 20);
        }
    }

    #[test]
    fn no_path_slips_through_shared_edges_and_vertices() {
        let mut random = Random(4);
        // A closed mesh, left from within; a terrain, crossed from above; over 100 m.
        let (vertices, triangles) = cuboid(Vec3::new(3.0, 1.7, 2.3));
        let closed = TriangleMesh::new(vertices, triangles).unwrap();
        let ground = terrain(64);
        for i in 0..100_000 {
            for (mesh, is_closed) in [(&closed, true), (&ground, false)] {
                let t = random.below(mesh.triangle_count()) as u32;
                let corners = mesh.triangle(t);
                let (a, b) = (corners[random.below(3)], corners[random.below(3)]);
                let through = if i % 3 == 0 { a } else { a.lerp(b, random.range(0.0, 1.0)) };
                if !is_closed && through.x.abs().max(through.z.abs()) > 15.9 {
                    continue;
                }
                let from = if is_closed {
                    random.cube() * 1.5
                } else {
                    through
                        + Vec3::new(
                            random.range(-20.0, 20.0),
                            random.range(30.0, 90.0),
                            random.range(-20.0, 20.0),
                        )
                };
                let direction = (through - from).normalize();
                let to = through + direction * random.range(0.01, 100.0);
                assert!(mesh.segment_hit(from, to).is_some(), "{from} {to} through {through}");
                // And in two steps that meet somewhere near the surface.
                let middle = through + random.cube() * 1e-6 * random.below(3) as f32;
                let two = mesh.segment_hit(from, middle).or(mesh.segment_hit(middle, to));
                assert!(two.is_some(), "{from} {middle} {to}");
            }
        }
    }

    #[test]
    fn a_triangle_of_a_terrain_takes_less_than_24_bytes() {
        let mesh = terrain(224);
        assert_eq!(mesh.triangle_count(), 100_352);
        let (live, reserved) = mesh.bytes();
        let each = reserved as f64 / mesh.triangle_count() as f64;
        println!(
            "{each:.2} bytes a triangle, of them {} of tree",
            mesh.tree.bytes().0 / mesh.triangle_count()
        );
        assert!(live <= reserved && each < 24.0, "{each}");
    }
}
