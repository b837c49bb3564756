//! The blocks of a recording, changed and with right checksums: its own, and those of snapshots in it.

use super::checksum::fix_checksum;
use super::input::Input;
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::replay::{Progress, RecordingBuffer, Replay};
use backstop::{
    BodyDesc, ConvexHull, Geometry, HeightField, LoadLimits, Settings, ShapeDesc, Snapshot, TriangleMesh,
    World,
};
use std::sync::{Arc, OnceLock};

/// Name and version of the format, then blocks: sort, length, content, CRC-32.
const HEADER: usize = 18;

/// A recording from the beginning, and one of the middle of a run, which goes back twice: with the bodies
/// that it had, and before one came.
fn templates() -> &'static [Vec<u8>; 2] {
    static TEMPLATES: OnceLock<[Vec<u8>; 2]> = OnceLock::new();
    TEMPLATES.get_or_init(|| [false, true].map(template))
}

fn template(goes_back: bool) -> Vec<u8> {
    let buffer = RecordingBuffer::default();
    let mut world = World::new(Settings::default()).expect("settings");
    let steps = |world: &mut World| {
        for _ in 0..6 {
            world.step(1.0 / 60.0).expect("a step");
        }
    };
    if !goes_back {
        world.start_recording(buffer.clone()).expect("a new world");
    }
    let corners = vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::ONE, Vec3::Y];
    let mesh = TriangleMesh::new(corners.clone(), vec![[0, 1, 2], [2, 1, 3]]).expect("a mesh");
    let field = HeightField::new(2, 2, Vec2::ONE, vec![0.0, 0.5, 0.0, 0.5]).expect("a field");
    let hull = Arc::new(ConvexHull::new(&corners).expect("a hull"));
    for geometry in [Geometry::Mesh(Arc::new(mesh)), Geometry::HeightField(Arc::new(field))] {
        world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(geometry))).expect("ground");
    }
    let shapes = [Geometry::Hull(hull), Geometry::cuboid(0.3, 0.3, 0.3), Geometry::capsule(0.2, 0.2)];
    for (i, geometry) in shapes.into_iter().enumerate() {
        let desc = BodyDesc::dynamic().with_position(DVec3::new(0.2, 1.0 + i as f64, 0.2));
        let body = world.add_body(&desc.with_shape(ShapeDesc::new(geometry))).expect("a body");
        world.set_velocity(body, Vec3::NEG_Y, Vec3::X).expect("a body");
    }
    steps(&mut world);
    if goes_back {
        world.start_recording(buffer.clone()).expect("a world");
        let mut saved = Snapshot::new();
        world.snapshot(&mut saved);
        steps(&mut world);
        world.restore(&saved).expect("its own state");
        let ball = BodyDesc::dynamic()
            .with_position(DVec3::Y * 5.0)
            .with_shape(ShapeDesc::new(Geometry::sphere(0.2)));
        world.add_body(&ball).expect("a body");
        steps(&mut world);
        world.restore(&saved).expect("its own state");
        steps(&mut world);
    }
    world.stop_recording().expect("a recording");
    buffer.bytes()
}

/// Makes the checksums of snapshots right: bytes of a known mark, after their number as postcard writes it.
fn fix_snapshots(content: &mut [u8]) {
    let marks: Vec<usize> = (1..content.len()).filter(|&at| content[at..].starts_with(b"BSNP")).collect();
    for at in marks {
        let more = content[..at - 1].iter().rev().take(4).take_while(|&&byte| byte & 128 != 0).count();
        let number = content[at - 1 - more..at].iter().rev();
        let length = number.fold(0, |all, &byte| all << 7 | usize::from(byte & 127));
        if let Some(own) = content.get_mut(at..at + length) {
            let mut bytes = own.to_vec();
            fix_checksum(&mut bytes);
            own[..bytes.len()].copy_from_slice(&bytes);
        }
    }
}

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let from = &templates()[usize::from(input.bool())][..];
    let mut to = from[..HEADER].to_vec();
    let mut rest = &from[HEADER..];
    while let Some((head, after)) = rest.split_first_chunk::<5>() {
        let length = u32::from_le_bytes([head[1], head[2], head[3], head[4]]) as usize;
        let mut content = after[..length].to_vec();
        rest = &after[length + 4..];
        for _ in 0..input.below(4) {
            change(&mut content, input);
        }
        fix_snapshots(&mut content);
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
