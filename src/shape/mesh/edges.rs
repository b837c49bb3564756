//! How the surface folds at an edge, so that a body that slides over a mesh feels the surface and not its
//! triangles.
//!
//! Where two triangles meet flat, or in a valley, the edge between them can't be touched before their faces
//! are. A normal of its own at such an edge is a ghost: a box that slides over a tiled floor would trip.
//! Meshes are touched from both sides, and a ridge from the front is a valley from behind, hence four folds
//! and not a flag.

use crate::config::tuning::FLAT_EDGE_SINE;
use glam::Vec3;

/// How the surface folds at an edge, seen from the triangle's front (the side from which it winds
/// counter-clockwise).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Fold {
    /// Hardly: the edge never matters.
    Flat = 0,
    /// Convex from the front, concave from behind.
    Ridge = 1,
    /// Concave from the front, convex from behind.
    Valley = 2,
    /// A border, or an edge of more than two triangles: it matters from both sides.
    Open = 3,
}

impl Fold {
    pub(crate) fn from_bits(bits: u32) -> Fold {
        match bits & 3 {
            0 => Fold::Flat,
            1 => Fold::Ridge,
            2 => Fold::Valley,
            _ => Fold::Open,
        }
    }

    /// The same fold seen from the other side.
    pub(crate) fn flipped(self) -> Fold {
        match self {
            Fold::Ridge => Fold::Valley,
            Fold::Valley => Fold::Ridge,
            same => same,
        }
    }

    /// The fold at the edge from `a` to `b` of a triangle (a, b, `opposite`), with a neighbour whose third
    /// vertex is `other`.
    pub(crate) fn between(a: Vec3, b: Vec3, opposite: Vec3, other: Vec3) -> Fold {
        let along = b - a;
        // In the plane across the edge: the two triangles as two directions away from it.
        let scale = 1.0 / along.length_squared();
        let away = |p: Vec3| (p - a) - along * ((p - a).dot(along) * scale);
        let (this, that) = (away(opposite), away(other));
        let normal = along.cross(this);
        let lengths = (this.length_squared() * that.length_squared()).sqrt();
        // How far the neighbour rises over this triangle's plane, as a sine; `normal` is |along| |this| long.
        let rise = normal.dot(that) / (normal.length() * that.length());
        if this.dot(that) < 0.0 && rise.abs() < FLAT_EDGE_SINE && lengths > 0.0 {
            Fold::Flat
        } else if rise < -FLAT_EDGE_SINE * 1e-3 {
            Fold::Ridge
        } else if rise > FLAT_EDGE_SINE * 1e-3 {
            Fold::Valley
        } else {
            // Folded back onto itself: a blade, sharp from either side.
            Fold::Open
        }
    }
}

/// The folds of a triangle's edges, from vertex 0 to 1, 1 to 2 and 2 to 0; two bits each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Edges(pub(crate) u8);

impl Edges {
    pub(crate) fn new(folds: [Fold; 3]) -> Edges {
        Edges(folds[0] as u8 | (folds[1] as u8) << 2 | (folds[2] as u8) << 4)
    }
    /// Seen from the front.
    pub(crate) fn fold(self, edge: usize) -> Fold {
        Fold::from_bits(u32::from(self.0) >> (2 * edge))
    }
    /// As seen from behind, if `behind`; the edges stay where they are.
    pub(crate) fn seen(self, behind: bool) -> Edges {
        if !behind {
            return self;
        }
        Edges::new([self.fold(0).flipped(), self.fold(1).flipped(), self.fold(2).flipped()])
    }
    /// Whether an edge may yield a normal of its own, seen from the front.
    #[cfg(test)]
    pub(crate) fn is_active(self, edge: usize) -> bool {
        matches!(self.fold(edge), Fold::Ridge | Fold::Open)
    }
}

/// The folds of every triangle of an indexed mesh whose equal vertices are one.
pub(crate) fn find_edges(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Edges> {
    // Uses of edges by the lower of their ends: a counting sort, with the other end and where the use is.
    let each = |f: &mut dyn FnMut(u32, (u32, u32))| {
        for (t, triangle) in triangles.iter().enumerate() {
            for e in 0..3 {
                let (a, b) = (triangle[e], triangle[(e + 1) % 3]);
                f(a.min(b), (a.max(b), (t * 3 + e) as u32));
            }
        }
    };
    let mut ends = vec![0u32; vertices.len() + 1];
    each(&mut |low, _| ends[low as usize + 1] += 1);
    for i in 0..vertices.len() {
        ends[i + 1] += ends[i];
    }
    let mut uses = vec![(0, 0); 3 * triangles.len()];
    each(&mut |low, of| {
        uses[ends[low as usize] as usize] = of;
        ends[low as usize] += 1;
    });
    // Now each is where the uses of its vertex end.
    let mut first = 0;
    for &end in &ends[..vertices.len()] {
        uses[first..end as usize].sort_unstable();
        first = end as usize;
    }
    let mut edges = vec![Edges::new([Fold::Open; 3]); triangles.len()];
    let starts = std::iter::once(0).chain(ends.iter().map(|&end| end as usize));
    let of_vertices = starts.zip(&ends[..vertices.len()]).map(|(start, &end)| &uses[start..end as usize]);
    for group in of_vertices.flat_map(|uses| uses.chunk_by(|one, other| one.0 == other.0)) {
        let [(_, one), (_, other)] = *group else { continue };
        let corners = |at: u32| {
            let (triangle, e) = (triangles[at as usize / 3], at as usize % 3);
            [0, 1, 2].map(|k| triangle[(e + k) % 3])
        };
        let (this, that) = (corners(one), corners(other));
        let [a, b, c, d] = [this[0], this[1], this[2], that[2]].map(|v| vertices[v as usize]);
        let fold = Fold::between(a, b, c, d);
        // Neighbours that wind the same way run along the edge in opposite directions.
        let same_side = this[0] == that[1];
        for (at, fold) in [(one, fold), (other, if same_side { fold } else { fold.flipped() })] {
            let (t, shift) = (at as usize / 3, 2 * (at % 3));
            edges[t].0 = edges[t].0 & !(3 << shift) | (fold as u8) << shift;
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_ridges_and_flat_diagonals() {
        let (vertices, triangles) = crate::shape::mesh::testing::cuboid(Vec3::ONE);
        for (edges, triangle) in find_edges(&vertices, &triangles).iter().zip(&triangles) {
            for e in 0..3 {
                let [a, b] = [e, (e + 1) % 3].map(|k| vertices[triangle[k] as usize]);
                let diagonal = (b - a).length() > 2.1;
                assert_eq!(edges.fold(e), if diagonal { Fold::Flat } else { Fold::Ridge });
                assert_eq!(edges.is_active(e), !diagonal);
                // From inside the box every edge is a valley.
                assert!(!edges.seen(true).is_active(e));
            }
        }
    }

    #[test]
    fn a_fold_is_known_whichever_way_the_triangles_wind() {
        let vertices = [Vec3::ZERO, Vec3::Z, Vec3::new(-1.0, 0.0, 0.5), Vec3::new(1.0, 0.0, 0.5)];
        for (height, expected) in [
            (-0.5, Fold::Ridge),
            (0.5, Fold::Valley),
            (0.0, Fold::Flat),
            (0.05, Fold::Flat),
            (0.12, Fold::Valley),
        ] {
            let mut vertices = vertices;
            vertices[3].y = height;
            // The first triangle's front is up.
            let up = [1, 0, 2];
            let normal = (vertices[0] - vertices[1]).cross(vertices[2] - vertices[1]);
            let up = if normal.y > 0.0 { up } else { [0, 1, 2] };
            let neighbour = if up == [1, 0, 2] { [0, 1, 3] } else { [1, 0, 3] };
            let edges = find_edges(&vertices, &[up, neighbour]);
            assert_eq!(edges[0].fold(0), expected);
            assert_eq!(edges[1].fold(0), expected);
            let turned = [neighbour[1], neighbour[0], neighbour[2]];
            let edges = find_edges(&vertices, &[up, turned]);
            assert_eq!(edges[0].fold(0), expected);
            assert_eq!(edges[1].fold(0), expected.flipped());
            assert_eq!(edges[0].fold(1), Fold::Open);
        }
        // Folded back onto itself.
        let blade = Fold::between(Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::X + Vec3::Z);
        assert_eq!(blade, Fold::Open);
    }
}
