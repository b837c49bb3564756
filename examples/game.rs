//! A small game: hills, 200 bodies, a ragdoll, a door with a motor, a sensor, events, rays, a character,
//! rollback and removal.
//!
//!     cargo run --release --example game

use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Character, CharacterSettings, Error, Geometry, HeightField, JointDesc, Limit,
    Motion, Motor, QueryFilter, Ray, Settings, ShapeDesc, Skeleton, Snapshot, World,
};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
const SIZE: usize = 65;

fn hill(x: usize, z: usize) -> f32 {
    let far = Vec2::new(x as f32 - 32.0, z as f32 - 32.0).length();
    0.15 * (far - 8.0).max(0.0)
}

fn main() -> Result<(), Error> {
    let mut world = World::new(Settings::default().with_sleeping(true))?;

    // A valley, flat in the middle.
    let heights = (0..SIZE * SIZE).map(|i| hill(i % SIZE, i / SIZE)).collect();
    let field = Arc::new(HeightField::new(SIZE, SIZE, Vec2::ONE, heights)?);
    let ground = ShapeDesc::new(Geometry::HeightField(field));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::new(-32.0, 0.0, -32.0)).with_shape(ground))?;

    // Crates and barrels, which report what hits them.
    let things: Vec<BodyDesc> = (0..200u16)
        .map(|i| {
            let form =
                if i % 2 == 0 { Geometry::cuboid(0.2, 0.2, 0.2) } else { Geometry::cylinder(0.25, 0.2) };
            let at =
                DVec3::new(f64::from(i % 10) - 4.5, 2.0 + f64::from(i / 100), f64::from(i / 10 % 10) - 4.5);
            BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(form).with_events())
        })
        .collect();
    let things = world.add_bodies(&things)?;
    let doll =
        Skeleton::humanoid().add_to(&mut world, DVec3::new(0.0, 6.0, 0.0), Quat::IDENTITY, Vec3::ZERO)?;

    // A door on a post, with a limit and a motor; its hinge is the frames' x, upright here.
    let slab = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.05));
    let post = world.add_body(&BodyDesc::fixed().with_position(DVec3::new(9.0, 1.8, 0.0)))?;
    let door =
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::new(9.6, 1.8, 0.0)).with_shape(slab))?;
    let upright = Quat::from_xyzw(0.0, 0.0, 0.5f32.sqrt(), 0.5f32.sqrt());
    let frames = world.frames_at([post, door], DVec3::new(9.0, 1.8, 0.0), upright)?;
    let swing = Limit::new(Motion::Angular, Axes::One(Axis::X), -1.5, 1.5);
    let hinge = world.add_joint(&JointDesc::hinge([post, door], frames).with_limit(swing))?;
    world.set_joint_motor(hinge, Motor::velocity(Motion::Angular, Axis::X, 1.0, 200.0))?;

    // A gate that notices who comes through, and a character that walks there.
    let gate = ShapeDesc::new(Geometry::cuboid(2.0, 8.0, 8.0)).as_sensor();
    world.add_body(&BodyDesc::fixed().with_shape(gate))?;
    let mut character = Character::new(CharacterSettings::default(), DVec3::new(-8.0, 1.5, 0.0))?;

    let (mut hits, mut visitors, mut saved, mut hash) = (0, 0, Snapshot::new(), 0);
    for step in 0..600 {
        if step == 300 {
            world.snapshot(&mut saved);
        }
        world.step(DT)?;
        hash = if step == 300 { world.state_hash() } else { hash };
        hits += world.contact_hits().len();
        visitors += world.sensor_begins().len();
        let walked = character.walk(&world, &QueryFilter::new(), Vec3::new(0.5, -3.0, 0.0), DT)?;
        walked.push(&mut world)?;
    }
    let angle = world.joint_position(hinge, Motion::Angular, Axes::One(Axis::X))?;
    let ray = Ray::new(DVec3::new(0.0, 50.0, 20.0), Vec3::NEG_Y * 100.0);
    let hit = world.cast_ray(&ray, &QueryFilter::only_static())?.map(|hit| hit.fraction);
    println!(
        "{hits} hits, {visitors} visitors, door at {angle:.2} rad, ray at {hit:?}, {} asleep",
        world.sleeping_body_count()
    );
    assert!(hits > 0 && visitors > 0 && (angle - 1.5).abs() < 0.02);
    assert!(hit.is_some_and(|t| (100.0 * t - (50.0 - hill(32, 52))).abs() < 0.01));

    // Back to step 300, which gives the same bits again.
    world.restore(&saved)?;
    world.step(DT)?;
    assert_eq!(world.state_hash(), hash);
    world.remove_bodies(&things)?;
    assert!(world.contains(doll.bodies[0]) && !world.contains(things[0]));
    Ok(())
}
