//! The targets, and which side of them a point is on.

use super::super::rng::Rng;
use super::super::weld::Welded;
use super::super::{Terrain, builtin::fixed};
use super::draw::log_range;
use backstop::BodyDesc;
use backstop::Error;
use backstop::{Geometry, TriangleMesh};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Names of the targets.
pub const TARGETS: [&str; 6] =
    ["mesh", "bumpy_mesh", "box_20mm", "box_2mm", "corner_of_boxes", "corner_of_mesh"];

/// Flat targets span x and z in ± this, corners all three axes from 0 to this [m]: what is shot flies up to
/// 100 m in a step, and has to meet the target, not its edge.
const HALF: f32 = 100.0;
/// Starts are this far inside the edge at least [m].
const INSIDE: f32 = 5.0;
/// A crossing nearer to the edge than this does not count [m].
const EDGE: f32 = 0.5;
/// Half the thickness of the walls of a corner of boxes [m].
const WALL: f32 = 0.01;

/// Where a body is relative to the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// In front of the target.
    Right,
    /// It crossed the target.
    Wrong,
    /// It left over the edge: nothing is known from here on.
    Beyond,
    /// Its position is not a number.
    Nowhere,
}

/// All targets, built once and shared by all shots.
#[derive(Clone, Debug)]
pub struct Targets {
    bodies: Vec<Vec<BodyDesc>>,
    bumps: Terrain,
}

impl Targets {
    /// Builds them.
    ///
    /// # Errors
    /// None, unless a mesh is refused.
    pub fn new() -> Result<Targets, Error> {
        let flat = Terrain::from_fn(50, HALF / 25.0, |_, _| 0.0);
        // No steeper than 45 degrees anywhere, so that a height above the ground bounds the distance from it.
        // Cells of 2.5 m: in one long step at full speed the volume mode looks at half of all triangles.
        let bumps = Terrain::from_fn(80, HALF / 40.0, |x, z| {
            use libm::{cosf, sinf};
            0.9 * sinf(0.35 * x) * cosf(0.3 * z) + 0.4 * sinf(0.8 * x + 1.0) * sinf(0.9 * z)
        });
        let mesh = |terrain: &Terrain| {
            let (vertices, triangles) = terrain.mesh();
            Ok(vec![fixed(Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles)?)), Vec3::ZERO)])
        };
        let slab = |half| vec![fixed(Geometry::cuboid(HALF, half, HALF), Vec3::ZERO)];
        let wall = |axis: usize| {
            // Walls reach past each other at the corner, so that nothing slips between them.
            let (mut half, mut centre) = (Vec3::splat(0.5 * HALF + 1.0), Vec3::splat(0.5 * HALF - 1.0));
            (half[axis], centre[axis]) = (WALL, 0.0);
            fixed(Geometry::Box { half_extents: half }, centre)
        };
        let bodies = vec![
            mesh(&flat)?,
            mesh(&bumps)?,
            slab(0.01),
            slab(0.001),
            vec![wall(0), wall(1), wall(2)],
            vec![fixed(Geometry::Mesh(Arc::new(corner()?)), Vec3::ZERO)],
        ];
        Ok(Targets { bodies, bumps })
    }

    pub(super) fn bodies(&self, target: usize) -> &[BodyDesc] {
        &self.bodies[target]
    }

    pub(super) fn is_corner(target: usize) -> bool {
        target >= 4
    }

    /// Height of what can be hit above or below a point; for corners the distance of the walls' front from
    /// their middle.
    pub(super) fn front(&self, target: usize, x: f32, z: f32) -> f32 {
        match TARGETS[target] {
            "bumpy_mesh" => self.bumps.height(x, z),
            "box_20mm" => 0.01,
            "box_2mm" => 0.001,
            "corner_of_boxes" => WALL,
            _ => 0.0,
        }
    }

    /// A point to aim at, and the normal there. On corners mostly close to an edge.
    pub(super) fn aim(&self, target: usize, rng: &mut Rng) -> (Vec3, Vec3) {
        if Self::is_corner(target) {
            let axis = (rng.bits() >> 33) as usize % 3;
            let (mut aim, mut normal) = (Vec3::ZERO, Vec3::ZERO);
            for i in 0..3 {
                aim[i] = log_range(rng, 0.001, 20.0);
            }
            (aim[axis], normal[axis]) = (self.front(target, 0.0, 0.0), 1.0);
            return (aim, normal);
        }
        let (x, z) = (rng.range(-20.0, 20.0), rng.range(-20.0, 20.0));
        (Vec3::new(x, self.front(target, x, z), z), Vec3::Y)
    }

    /// A direction turned so that it leads to the target: into the corner.
    pub(super) fn turned(&self, target: usize, direction: Vec3) -> Vec3 {
        if Self::is_corner(target) { -direction.abs() } else { direction }
    }

    /// Where a body that reaches so far around its origin starts: `away` from the aim if there is room, and
    /// clear of the target.
    pub(super) fn start(&self, target: usize, aim: Vec3, direction: Vec3, away: f32, reach: f32) -> Vec3 {
        let most = HALF - INSIDE;
        let axes: &[usize] = if Self::is_corner(target) { &[0, 1, 2] } else { &[0, 2] };
        let room = axes.iter().fold(away, |room, &i| match direction[i].abs() {
            d if d > 1e-6 => room.min((most + aim[i] * direction[i].signum()) / d),
            _ => room,
        });
        let mut start = aim - direction * room;
        if Self::is_corner(target) {
            let clear = self.front(target, 0.0, 0.0) + 1.01 * reach + 1e-4;
            return start.max(Vec3::splat(clear));
        }
        let clear = self.front(target, start.x, start.z) + 1.5 * reach + 1e-4;
        start.y = start.y.max(clear);
        start
    }

    /// How far a point is in front of the target, at least [m].
    #[cfg(test)]
    pub(super) fn clearance(&self, target: usize, p: DVec3) -> f64 {
        if Self::is_corner(target) {
            return p.min_element() - f64::from(self.front(target, 0.0, 0.0));
        }
        let above = p.y - f64::from(self.front(target, p.x as f32, p.z as f32));
        if TARGETS[target] == "bumpy_mesh" { above * std::f64::consts::FRAC_1_SQRT_2 } else { above }
    }

    /// How far a point is in front of the surface that must not be crossed: a mesh, or the middle of a wall
    /// [m].
    fn depth(&self, target: usize, axis: usize, p: DVec3) -> f64 {
        match TARGETS[target] {
            "bumpy_mesh" => p.y - f64::from(self.bumps.height(p.x as f32, p.z as f32)),
            _ => p[axis],
        }
    }

    /// The side that a centre of mass is on after a step from `before`, in front of the target, to `now`.
    pub(super) fn side(&self, target: usize, before: DVec3, now: DVec3) -> Side {
        if !now.is_finite() {
            return Side::Nowhere;
        }
        let half = f64::from(HALF);
        let inside = |p: DVec3, margin: f64| {
            let across: &[usize] = if Self::is_corner(target) { &[0, 1, 2] } else { &[0, 2] };
            across.iter().all(|&i| p[i].abs() <= half - margin)
        };
        let axes: &[usize] = if Self::is_corner(target) { &[0, 1, 2] } else { &[1] };
        // The first surface that the straight path crosses.
        let crossing = axes
            .iter()
            .filter_map(|&axis| {
                let (a, b) = (self.depth(target, axis, before), self.depth(target, axis, now));
                (b < 0.0).then(|| if a > 0.0 { a / (a - b) } else { 0.0 })
            })
            .min_by(f64::total_cmp);
        match crossing {
            Some(t) if inside(before.lerp(now, t), f64::from(EDGE)) => Side::Wrong,
            Some(_) => Side::Beyond,
            None if inside(now, 0.0) => Side::Right,
            None => Side::Beyond,
        }
    }
}

/// The insides of three faces of a cube, in one mesh.
fn corner() -> Result<TriangleMesh, Error> {
    const CELLS: usize = 25;
    let at = |n: usize| n as f32 * (HALF / CELLS as f32);
    let mut welded = Welded::default();
    for axis in 0..3 {
        let point = |i: usize, k: usize| {
            let mut p = Vec3::ZERO;
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (at(i), at(k));
            p
        };
        for (i, k) in (0..CELLS).flat_map(|i| (0..CELLS).map(move |k| (i, k))) {
            let [a, b, c, d] = [point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1)];
            welded.triangle([a, b, c]);
            welded.triangle([a, c, d]);
        }
    }
    TriangleMesh::new(welded.vertices, welded.triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_crossings_of_the_target_itself_are_on_the_wrong_side() {
        let targets = Targets::new().unwrap();
        let side = |target, a: [f64; 3], b: [f64; 3]| targets.side(target, a.into(), b.into());
        assert_eq!(side(0, [0.0, 1.0, 0.0], [0.0, 0.5, 0.0]), Side::Right);
        assert_eq!(side(0, [0.0, 1.0, 0.0], [0.0, -0.5, 0.0]), Side::Wrong);
        // Half of the way down it is past the edge.
        assert_eq!(side(0, [99.0, 1.0, 0.0], [120.0, -1.0, 0.0]), Side::Beyond);
        assert_eq!(side(0, [99.0, 1.0, 0.0], [120.0, -99.0, 0.0]), Side::Wrong);
        assert_eq!(side(0, [99.0, 1.0, 0.0], [120.0, 1.0, 0.0]), Side::Beyond);
        assert_eq!(side(4, [1.0, 1.0, 1.0], [2.0, 3.0, -0.1]), Side::Wrong);
        assert_eq!(side(5, [1.0, 1.0, 1.0], [0.1, 0.1, 0.1]), Side::Right);
        assert_eq!(side(1, [0.0, 9.0, 0.0], [f64::NAN, 0.0, 0.0]), Side::Nowhere);
    }

    #[test]
    fn the_corner_is_one_mesh_of_three_faces() {
        // 25 by 25 squares of two triangles, three times.
        assert_eq!(corner().unwrap().triangle_count(), 3750);
    }
}
