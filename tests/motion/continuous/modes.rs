//! Each body is kept from passing through others in its own way; a pair is treated as the greater of its two
//! asks for.

use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, BodyHandle, BodyKind, ContinuousMode, Geometry, Settings, ShapeDesc, TriangleMesh, World,
};
use std::sync::Arc;

/// Five metres a step, through walls of at most a centimetre.
const DT: f32 = 1.0 / 60.0;
const SPEED: f32 = 300.0;

fn world(continuous: ContinuousMode) -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO).with_continuous(continuous)).unwrap()
}

fn body(kind: BodyKind, geometry: Geometry, at: DVec3, continuous: ContinuousMode) -> BodyDesc {
    let velocity = if kind == BodyKind::Dynamic { Vec3::X * SPEED } else { Vec3::ZERO };
    let desc = BodyDesc::new(kind)
        .with_position(at)
        .with_velocity(velocity, Vec3::ZERO)
        .with_shape(ShapeDesc::new(geometry));
    desc.with_continuous(continuous)
}

fn bullet(at: DVec3, mode: ContinuousMode) -> BodyDesc {
    body(BodyKind::Dynamic, Geometry::Sphere { radius: 0.02 }, at, mode)
}

/// At x = 0, five metres to each side.
fn walls() -> [Geometry; 2] {
    let corner = |y: f32, z: f32| Vec3::new(0.0, y * 5.0, z * 5.0);
    let vertices = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    [Geometry::cuboid(0.005, 5.0, 5.0), Geometry::Mesh(Arc::new(mesh))]
}

fn is_through(world: &World, body: BodyHandle) -> bool {
    world.centre_of_mass(body).unwrap().x > 0.0
}

fn fly(world: &mut World) {
    for _ in 0..5 {
        world.step(DT).unwrap();
    }
}

/// The second of these starts lets a step begin five centimetres before the wall, where the broad phase has
/// the pair in any mode.
const STARTS: [f64; 2] = [-7.3, -5.05];

#[test]
fn in_one_world_a_discrete_body_passes_where_a_continuous_one_is_held() {
    for wall in walls() {
        for start in STARTS {
            let mut world = world(ContinuousMode::Segment);
            world
                .add_body(&body(BodyKind::Static, wall.clone(), DVec3::ZERO, ContinuousMode::Segment))
                .unwrap();
            let modes = [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume];
            let bullets = [0.0, 1.0, 2.0].map(|y| DVec3::new(start, y, 0.3));
            let bullets =
                std::array::from_fn::<_, 3, _>(|i| world.add_body(&bullet(bullets[i], modes[i])).unwrap());
            fly(&mut world);
            assert_eq!(bullets.map(|b| is_through(&world, b)), [true, false, false], "{wall:?} {start}");
        }
    }
}

#[test]
fn a_mode_that_is_changed_counts_from_the_next_step_on() {
    for wall in walls() {
        for start in STARTS {
            let mut world = world(ContinuousMode::Segment);
            world
                .add_body(&body(BodyKind::Static, wall.clone(), DVec3::ZERO, ContinuousMode::Segment))
                .unwrap();
            let one = world.add_body(&bullet(DVec3::new(start, 0.0, 0.3), ContinuousMode::Discrete)).unwrap();
            let other =
                world.add_body(&bullet(DVec3::new(start, 1.0, 0.3), ContinuousMode::Segment)).unwrap();
            world.set_continuous(one, ContinuousMode::Segment).unwrap();
            world.set_continuous(other, ContinuousMode::Discrete).unwrap();
            fly(&mut world);
            assert_eq!(
                (is_through(&world, one), is_through(&world, other)),
                (false, true),
                "{wall:?} {start}"
            );
        }
    }
}

#[test]
fn a_discrete_body_is_held_by_a_continuous_one_that_moves() {
    // A wall that flies at it is continuous, so the pair is.
    for start in STARTS {
        let mut world = world(ContinuousMode::Segment);
        let wall = Geometry::cuboid(0.005, 5.0, 5.0);
        let wall = body(BodyKind::Kinematic, wall, DVec3::X, ContinuousMode::Segment)
            .with_velocity(Vec3::X * -60.0, Vec3::ZERO);
        let wall = world.add_body(&wall).unwrap();
        let shot = world.add_body(&bullet(DVec3::X * start, ContinuousMode::Discrete)).unwrap();
        world.set_velocity(shot, Vec3::ZERO, Vec3::ZERO).unwrap();
        for step in 0..12 {
            world.step(DT).unwrap();
            let x = |b| world.centre_of_mass(b).unwrap().x;
            assert!(x(shot) < x(wall), "{start} step {step}: {} {}", x(shot), x(wall));
        }
    }
}

#[test]
fn a_discrete_world_lets_everything_pass() {
    let mut world = world(ContinuousMode::Discrete);
    let wall = Geometry::cuboid(0.005, 5.0, 5.0);
    world.add_body(&body(BodyKind::Static, wall, DVec3::ZERO, ContinuousMode::Segment)).unwrap();
    let shot = world.add_body(&bullet(DVec3::X * -7.3, ContinuousMode::Volume)).unwrap();
    fly(&mut world);
    assert!(is_through(&world, shot));
}

/// A ball that is about to hit a wall, and on its way passes a post by a centimetre: how many manifolds it
/// has.
fn manifolds(world_mode: ContinuousMode, mode: ContinuousMode) -> u32 {
    let mut world = world(world_mode);
    let fixed = |geometry, at| body(BodyKind::Static, geometry, at, ContinuousMode::Segment);
    world.add_body(&fixed(Geometry::cuboid(0.005, 5.0, 5.0), DVec3::ZERO)).unwrap();
    world.add_body(&fixed(Geometry::Sphere { radius: 0.1 }, DVec3::new(-1.0, 0.13, 0.0))).unwrap();
    world.add_body(&bullet(DVec3::X * -2.0, mode)).unwrap();
    world.step(DT).unwrap().manifolds
}

#[test]
fn a_volume_body_gets_the_planes_of_what_it_passes_too() {
    use ContinuousMode::{Discrete, Segment, Volume};
    assert_eq!(manifolds(Segment, Discrete), 0);
    assert_eq!(manifolds(Segment, Segment), 1);
    assert_eq!(manifolds(Segment, Volume), 2);
    assert_eq!(manifolds(Volume, Segment), 2);
    assert_eq!(manifolds(Volume, Discrete), 0);
}
