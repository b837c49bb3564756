//! The bytes of a snapshot, changed and with a right checksum.

use super::check;
use super::checksum::fix_checksum;
use super::input::Input;
use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axes, BodyDesc, Frame, Geometry, JointDesc, Limit, Motion, Settings, ShapeDesc, Snapshot, World,
};
use std::sync::OnceLock;

fn world() -> World {
    let mut world = World::new(Settings::default().with_sleeping(true)).expect("settings");
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).expect("a floor");
    let mut bodies = Vec::new();
    for i in 0..10 {
        let geometry = if i % 3 == 0 { Geometry::capsule(0.2, 0.3) } else { Geometry::cuboid(0.4, 0.4, 0.4) };
        let at = DVec3::new(f64::from(i % 5), 0.6 + f64::from(i / 5), 0.0);
        let desc = BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry).with_events());
        bodies.push(world.add_body(&desc).expect("a body"));
    }
    let frames = [Frame::at(Vec3::X * 0.5), Frame::at(Vec3::X * -0.5)];
    let joint = JointDesc::new([bodies[0], bodies[1]], frames).with_limit(Limit::new(
        Motion::Linear,
        Axes::All,
        0.0,
        0.0,
    ));
    world.add_joint(&joint).expect("a joint");
    for _ in 0..10 {
        world.step(1.0 / 60.0).expect("a step");
    }
    world.sleep(bodies[7]).expect("a body");
    world.set_enabled(bodies[8], false).expect("a body");
    world
}

/// Snapshots of the state alone, and with all that it refers to.
fn templates() -> &'static [Vec<u8>; 2] {
    static TEMPLATES: OnceLock<[Vec<u8>; 2]> = OnceLock::new();
    TEMPLATES.get_or_init(|| {
        let mut snapshot = Snapshot::new();
        world().snapshot(&mut snapshot);
        [snapshot.to_bytes(), snapshot.to_whole_bytes()]
    })
}

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let mut bytes = templates()[usize::from(input.bool())].clone();
    for _ in 0..1 + input.below(4) {
        let word = input.below(bytes.len() / 4) * 4;
        let new = match input.below(4) {
            0 => input.number().to_bits(),
            1 => input.below(40) as u32,
            2 => u32::MAX - input.below(3) as u32,
            _ => u32::from_le_bytes([0; 4].map(|_: u8| input.byte())),
        };
        bytes[word..word + 4].copy_from_slice(&new.to_le_bytes());
    }
    if input.byte() == 0 {
        bytes.truncate(input.below(bytes.len()));
    }
    fix_checksum(&mut bytes);
    let Ok(snapshot) = Snapshot::from_bytes(&bytes) else { return };
    let mut world = world();
    let before = world.state_hash();
    if world.restore(&snapshot).is_err() {
        assert_eq!(world.state_hash(), before, "what is refused changes nothing");
    }
    for _ in 0..4 {
        world.step(1.0 / 60.0).expect("a usual step");
        check(&world);
    }
}
