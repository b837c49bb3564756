//! Bodies that become static, kinematic or dynamic while the world runs.

use crate::common::Floor;
use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, BodyKind, Error, Frame, Geometry, JointDesc, MassProperties, Material, QueryFilter,
    Ray, Settings, ShapeDesc, Snapshot, World,
};

const DT: f32 = 1.0 / 60.0;

fn world() -> World {
    World::new(Settings::default().with_sleeping(true)).unwrap()
}

fn block(y: f64) -> BodyDesc {
    BodyDesc::dynamic()
        .with_position(DVec3::Y * y)
        .with_shape(ShapeDesc::new(Geometry::cuboid(1.0, 0.25, 1.0)))
}

fn ball(y: f64) -> BodyDesc {
    BodyDesc::dynamic()
        .with_position(DVec3::Y * y)
        .with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.25 }))
}

fn steps(world: &mut World, count: u32) {
    for _ in 0..count {
        world.step(DT).unwrap();
    }
}

fn height(world: &World, body: BodyHandle) -> f64 {
    world.position(body).unwrap().y
}

#[test]
fn a_falling_block_that_becomes_static_stands_and_carries() {
    let mut world = world();
    let (block, ball) = (world.add_body(&block(5.0)).unwrap(), world.add_body(&ball(6.0)).unwrap());
    steps(&mut world, 20);
    world.set_kind(block, BodyKind::Static).unwrap();
    let place = world.position(block).unwrap();
    assert_eq!(world.linear_velocity(block), Ok(Vec3::ZERO));
    assert_eq!((world.kind(block), world.mass(block)), (Ok(BodyKind::Static), Ok(0.0)));
    steps(&mut world, 120);
    assert_eq!(world.position(block), Ok(place), "nothing moves it");
    // The ball lies on it: half the block, and its own radius above.
    assert!((height(&world, ball) - place.y - 0.5).abs() < 0.002, "{}", height(&world, ball) - place.y);
}

/// Free fall: g t² / 2, from the moment on in which it may.
#[test]
fn a_static_block_that_becomes_dynamic_falls_with_what_lies_on_it() {
    let mut world = world();
    let mut desc = block(5.0);
    desc.kind = BodyKind::Static;
    let (block, ball) = (world.add_body(&desc).unwrap(), world.add_body(&ball(5.5)).unwrap());
    steps(&mut world, 240);
    assert_eq!(world.is_sleeping(ball), Ok(true));
    world.set_kind(block, BodyKind::Dynamic).unwrap();
    assert_eq!(world.is_sleeping(ball), Ok(false), "what lies on it wakes");
    // 1000 kg/m³ times 2 × 0.5 × 2 m.
    assert_eq!(world.mass(block), Ok(2000.0));
    steps(&mut world, 30);
    let fallen = 0.5 * 9.81 * 0.25;
    assert!((5.0 - height(&world, block) - fallen).abs() < 0.02, "{}", height(&world, block));
    assert!((5.5 - height(&world, ball) - fallen).abs() < 0.02, "{}", height(&world, ball));
}

#[test]
fn a_kinematic_body_keeps_its_velocity_when_it_is_let_go() {
    let mut world = world();
    let (mut desc, up) = (ball(1.0), Vec3::new(2.0, 8.0, 0.0));
    (desc.kind, desc.linear_velocity) = (BodyKind::Kinematic, up);
    let body = world.add_body(&desc).unwrap();
    steps(&mut world, 60);
    assert!((height(&world, body) - 9.0).abs() < 1e-4, "no gravity yet");
    world.set_kind(body, BodyKind::Dynamic).unwrap();
    assert_eq!(world.linear_velocity(body), Ok(up));
    steps(&mut world, 60);
    let wanted = 9.0 + 8.0 - 0.5 * 9.81;
    assert!((height(&world, body) - wanted).abs() < 1e-3, "{}", height(&world, body));
}

/// The caller's mass, not that of the shapes.
#[test]
fn a_given_mass_comes_back() {
    let mut world = world();
    let inertia = Mat3::from_cols_array(&[2.0, 0.1, 0.0, 0.1, 3.0, 0.2, 0.0, 0.2, 4.0]);
    let mass = MassProperties { mass: 7.0, centre_of_mass: Vec3::new(0.1, 0.0, -0.1), inertia };
    for kind in [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic] {
        let desc = ball(3.0).with_kind(kind).with_mass(Some(mass));
        let body = world.add_body(&desc).unwrap();
        for other in [BodyKind::Kinematic, BodyKind::Static, BodyKind::Dynamic] {
            world.set_kind(body, other).unwrap();
            let found = world.mass_properties(body).unwrap();
            assert_eq!((found.mass, found.centre_of_mass), (7.0, mass.centre_of_mass));
            assert!(found.inertia.abs_diff_eq(inertia, 1e-5), "{found:?}");
            assert!((world.position(body).unwrap() - DVec3::Y * 3.0).length() < 1e-6);
        }
        assert_eq!(world.mass(body), Ok(7.0));
    }
}

#[test]
fn what_can_not_be_dynamic_is_refused_and_stays_what_it_is() {
    let mut world = world();
    let ground = world.add_body(&Floor::Mesh.desc(Material::default())).unwrap();
    let bare = world.add_body(&BodyDesc::kinematic()).unwrap();
    let weightless = ShapeDesc::new(Geometry::Sphere { radius: 1.0 }).with_density(0.0);
    let light = world.add_body(&BodyDesc::fixed().with_shape(weightless)).unwrap();
    steps(&mut world, 1);
    let before = world.state_hash();
    assert_eq!(world.set_kind(ground, BodyKind::Dynamic), Err(Error::StaticOnly { shape: "triangle mesh" }));
    assert_eq!(world.set_kind(bare, BodyKind::Dynamic), Err(Error::NoMass));
    assert_eq!(world.set_kind(light, BodyKind::Dynamic), Err(Error::NoMass));
    assert_eq!((world.kind(ground), world.kind(bare)), (Ok(BodyKind::Static), Ok(BodyKind::Kinematic)));
    assert_eq!(world.state_hash(), before);
    world.set_kind(ground, BodyKind::Kinematic).unwrap();
    world.remove_body(light).unwrap();
    assert_eq!(world.set_kind(light, BodyKind::Static), Err(Error::StaleBody));
}

/// A door that is held, and let go again, still hangs on its hinge.
#[test]
fn a_joint_waits_for_a_dynamic_body() {
    let mut world = world();
    let post = world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * 4.0)).unwrap();
    let door = world.add_body(&ball(4.0).with_position(DVec3::new(1.0, 4.0, 0.0))).unwrap();
    let joint = JointDesc::ball([post, door], [Frame::default(), Frame::at(Vec3::NEG_X)]);
    let joint = world.add_joint(&joint).unwrap();
    steps(&mut world, 5);
    for held in [BodyKind::Static, BodyKind::Kinematic] {
        world.set_kind(door, held).unwrap();
        let before = world.position(door).unwrap();
        world.set_velocity(door, Vec3::ZERO, Vec3::ZERO).unwrap();
        steps(&mut world, 30);
        assert_eq!(world.position(door), Ok(before));
        // The joint as each reader gets it.
        let mut saved = Snapshot::new();
        world.snapshot(&mut saved);
        world.restore(&Snapshot::from_bytes(&saved.to_whole_bytes()).unwrap()).unwrap();
    }
    world.set_kind(door, BodyKind::Dynamic).unwrap();
    assert!(world.contains_joint(joint));
    steps(&mut world, 200);
    let at = world.position(door).unwrap() - DVec3::Y * 4.0;
    assert!((at.length() - 1.0).abs() < 0.01, "{at}");
}

#[test]
fn queries_and_snapshots_know_the_new_kind() {
    let mut world = world();
    let floor = world.add_body(&block(0.0).with_kind(BodyKind::Static)).unwrap();
    let block = world.add_body(&block(3.0)).unwrap();
    let down = Ray::new(DVec3::Y * 10.0, Vec3::NEG_Y * 20.0);
    let seen = |world: &World| {
        world.cast_ray(&down, &QueryFilter::default()).unwrap().map(|hit| world.body_of(hit.shape).unwrap())
    };
    steps(&mut world, 10);
    let mut saved = Snapshot::new();
    world.snapshot(&mut saved);
    let whole = saved.to_whole_bytes();
    steps(&mut world, 30);
    let (hash, top) = (world.state_hash(), seen(&world));
    assert_eq!(top, Some(block));
    for kind in [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic] {
        world.set_kind(block, kind).unwrap();
        world.set_kind(floor, kind).unwrap();
        assert_eq!(seen(&world), Some(block), "{kind:?}");
        world.set_pose(block, DVec3::X * 30.0, Quat::IDENTITY).unwrap();
        assert_eq!(seen(&world), Some(floor), "{kind:?}");
        steps(&mut world, 3);
        // It goes on to the same bits as if nothing had happened.
        for snapshot in [saved.clone(), Snapshot::from_bytes(&whole).unwrap()] {
            world.restore(&snapshot).unwrap();
            assert_eq!(world.kind(block), Ok(BodyKind::Dynamic));
            steps(&mut world, 30);
            assert_eq!(world.state_hash(), hash, "{kind:?}");
        }
    }
}
