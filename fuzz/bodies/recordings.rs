//! The blocks of a recording, changed and with right checksums.

use super::input::Input;
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::replay::{Progress, RecordingBuffer, Replay};
use backstop::{
    BodyDesc, ConvexHull, Geometry, HeightField, LoadLimits, Settings, ShapeDesc, TriangleMesh, World,
};
use std::sync::{Arc, OnceLock};

/// Name and version of the format, then blocks: sort, length, content, CRC-32.
const HEADER: usize = 18;

fn template() -> &'static [u8] {
    static TEMPLATE: OnceLock<Vec<u8>> = OnceLock::new();
    TEMPLATE.get_or_init(|| {
        let buffer = RecordingBuffer::default();
        let mut world = World::new(Settings::default()).expect("settings");
        world.start_recording(buffer.clone()).expect("a new world");
        let corners = vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::ONE, Vec3::Y];
        let mesh = TriangleMesh::new(corners.clone(), vec![[0, 1, 2], [2, 1, 3]]).expect("a mesh");
        let field = HeightField::new(2, 2, Vec2::ONE, vec![0.0, 0.5, 0.0, 0.5]).expect("a field");
        let hull = Arc::new(ConvexHull::new(&corners).expect("a hull"));
        for geometry in [Geometry::Mesh(Arc::new(mesh)), Geometry::HeightField(Arc::new(field))] {
            world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(geometry))).expect("ground");
        }
        let shapes = [Geometry::Hull(hull), Geometry::cuboid(0.3, 0.3, 0.3), Geometry::capsule(0.2, 0.2)];
        for (i, geometry) in shapes.into_iter().enumerate() {
            let desc = BodyDesc::dynamic().at(DVec3::new(0.2, 1.0 + i as f64, 0.2));
            let body = world.add_body(&desc.with_shape(ShapeDesc::new(geometry))).expect("a body");
            world.set_velocity(body, Vec3::NEG_Y, Vec3::X).expect("a body");
        }
        for _ in 0..6 {
            world.step(1.0 / 60.0).expect("a step");
        }
        world.stop_recording().expect("a recording");
        buffer.bytes()
    })
}

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let from = template();
    let mut to = from[..HEADER].to_vec();
    let mut rest = &from[HEADER..];
    while let Some((head, after)) = rest.split_first_chunk::<5>() {
        let length = u32::from_le_bytes([head[1], head[2], head[3], head[4]]) as usize;
        let mut content = after[..length].to_vec();
        rest = &after[length + 4..];
        for _ in 0..input.below(4) {
            change(&mut content, input);
        }
        let mut block = vec![head[0]];
        block.extend((content.len() as u32).to_le_bytes());
        block.extend(content);
        let sum = crc32fast::hash(&block);
        to.extend(block);
        to.extend(sum.to_le_bytes());
    }
    let mut limits = LoadLimits::default();
    (limits.memory, limits.bodies) = (32 << 20, 200);
    let Ok(mut replay) = Replay::open_limited(&to[..], &limits, |settings| settings.threads = 1) else {
        return;
    };
    // What diverges is a finding of the replay, not of this; it ends there.
    while let Ok(Progress::Same) = replay.step() {}
    super::check(replay.world());
}

fn change(content: &mut Vec<u8>, input: &mut Input<'_>) {
    if content.is_empty() {
        return;
    }
    let at = input.below(content.len());
    match input.below(5) {
        0 => content[at] ^= 1 << (input.byte() % 8),
        1 => content[at] = input.byte(),
        2 if at + 4 <= content.len() => content[at..at + 4].copy_from_slice(&input.number().to_le_bytes()),
        3 => content.truncate(at),
        _ => {
            let length = input.below(300).min(content.len() - at);
            let part = content[at..at + length].to_vec();
            let to = input.below(content.len());
            content.splice(to..to, part);
        }
    }
}
