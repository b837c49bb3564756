//! Scenes that tests draw.

use crate::body::BodyDesc;
use crate::joint::{Frame, JointDesc};
use crate::shape::{Geometry, ShapeDesc, TriangleMesh};
use crate::world::World;
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

pub(super) fn dynamic(geometry: Geometry, at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry))
}

pub(super) fn fixed(geometry: Geometry, at: DVec3) -> BodyDesc {
    BodyDesc::fixed().with_position(at).with_shape(ShapeDesc::new(geometry))
}

/// Cubes on each other on a floor, `base` of them in the lowest row.
pub(super) fn pyramid(world: &mut World, base: i32) {
    world.add_body(&fixed(Geometry::cuboid(20.0, 1.0, 20.0), -DVec3::Y)).unwrap();
    for row in 0..base {
        for column in 0..base - row {
            let at = DVec3::new(f64::from(column) + 0.5 * f64::from(row), f64::from(row) + 0.5, 0.0);
            world.add_body(&dynamic(Geometry::cuboid(0.5, 0.5, 0.5), at)).unwrap();
        }
    }
}

/// Capsules along x, 40 cm each, on ball joints; the first one hangs on a static body.
pub(super) fn add_chain(world: &mut World, links: usize) {
    let along_x = glam::Quat::from_rotation_z(-FRAC_PI_2);
    let mut last = world.add_body(&BodyDesc::fixed()).unwrap();
    for i in 0..links {
        let link = dynamic(Geometry::capsule(0.15, 0.05), DVec3::X * (0.4 * i as f64 + 0.2));
        let link = world.add_body(&link.with_rotation(along_x)).unwrap();
        let over = if i == 0 { 0.0 } else { 0.2 };
        let frames = [over, -0.2].map(|y| Frame::at(Vec3::Y * y));
        world.add_joint(&JointDesc::ball([last, link], frames)).unwrap();
        last = link;
    }
}

/// Uneven ground of 2 x 40 x 40 triangles.
pub(super) fn bumps() -> Geometry {
    let (vertices, triangles) = crate::random::bumps(40, 0.5);
    Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
}
