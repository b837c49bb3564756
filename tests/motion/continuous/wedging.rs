//! A body that lands hard on rough ground gets off it again: thin plates and lopsided shapes do not stay
//! stuck in it.

use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Filter, Geometry, Settings, ShapeDesc, TriangleMesh, World};
use backstop_scene::Terrain;
use std::sync::Arc;

const STEPS: usize = 500;
/// The last of them, in which nothing may need to be held any more.
const LAST: usize = 100;
const BODIES: usize = 400;

/// Thrown at 20 to 60 m/s, spinning: the centre of mass of every one stays above the ground, and once they
/// have come to rest the guard has nothing left to do. A plate of 2 cm overlaps the ground by its whole
/// thickness as soon as it is stuck, and an upright cone's origin is above its centre of mass, so both are
/// pushed out only if the engine knows the side they came from.
#[test]
fn plates_and_cones_thrown_onto_rough_ground_do_not_stay_stuck_in_it() {
    let terrain = Terrain::bumpy(96, 0.75);
    let (vertices, triangles) = terrain.mesh();
    let mut world = World::new(Settings::default()).unwrap();
    let ground = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()));
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(ground))).unwrap();
    let mut random = Random(3);
    let bodies: Vec<BodyHandle> = (0..BODIES)
        .map(|i| {
            let mut shape = ShapeDesc::new(match i % 3 {
                0 => Geometry::cuboid(0.4, 0.01, 0.3),
                1 => Geometry::Cylinder { half_height: 0.35, radius_bottom: 0.3, radius_top: 0.1 },
                _ => Geometry::Cylinder { half_height: 0.05, radius_bottom: 0.3, radius_top: 0.02 },
            });
            // They meet the ground, not each other.
            shape.filter = Filter::default().with_group(-1);
            let (x, z) = (random.range(-25.0, 25.0), random.range(-25.0, 25.0));
            let down = random.range(20.0, 60.0);
            let velocity = Vec3::new(random.range(-0.4, 0.4) * down, -down, random.range(-0.4, 0.4) * down);
            let (axis, angle) = (random.direction(), random.range(0.0, 6.0));
            let desc = BodyDesc::dynamic()
                .with_position(DVec3::new(x.into(), f64::from(terrain.height(x, z)) + 5.0, z.into()))
                .with_rotation(Quat::from_axis_angle(axis, angle))
                .with_velocity(velocity, random.direction() * random.range(5.0, 30.0))
                .with_shape(shape);
            world.add_body(&desc).unwrap()
        })
        .collect();
    let mut held = 0;
    // Over the rim and down: that it drifts back below is no matter of collision.
    let mut fell = vec![false; bodies.len()];
    for step in 0..STEPS {
        world.step(1.0 / 60.0).unwrap();
        if step >= STEPS - LAST {
            held += world.report().held();
        }
        for (i, &body) in bodies.iter().enumerate() {
            let at = world.centre_of_mass(body).unwrap().as_vec3();
            let over = at.y - terrain.height(at.x, at.z);
            // The resolution of f32 at a height of a few metres.
            fell[i] |= !terrain.contains(at.x, at.z) && over < 0.0;
            assert!(
                fell[i] || !terrain.contains(at.x, at.z) || over > -1e-5,
                "{step}: body {i} is {over} over the ground"
            );
        }
    }
    assert_eq!(held, 0, "in the last {LAST} steps");
}
