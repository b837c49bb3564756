//! Characters that live in the world: snapshots, hashes and recordings have them.

use super::*;
use backstop::{Budget, CharacterHandle, ConvexHull, Snapshot};

/// A game with three characters of different shapes, crates that they push, and a lift.
struct Game {
    world: World,
    lift: BodyHandle,
    walkers: Vec<CharacterHandle>,
    velocities: Vec<Vec3>,
}

fn hull() -> Geometry {
    let corners = [
        [0.3, -0.9, 0.0],
        [-0.3, -0.9, 0.2],
        [-0.2, -0.9, -0.3],
        [0.2, 0.9, 0.2],
        [-0.3, 0.9, 0.0],
        [0.1, 0.9, -0.3],
    ];
    Geometry::Hull(Arc::new(ConvexHull::new(&corners.map(Vec3::from)).unwrap()))
}

impl Game {
    fn new(threads: usize) -> Game {
        let mut world = World::new(Settings::default().with_threads(threads)).unwrap();
        Game::fill(&mut world)
            .map(|(lift, walkers)| Game { world, lift, velocities: vec![Vec3::ZERO; walkers.len()], walkers })
            .unwrap()
    }

    fn fill(world: &mut World) -> Result<(BodyHandle, Vec<CharacterHandle>), Error> {
        floor(world);
        for i in 0..140_u8 {
            let at = DVec3::new(f64::from(i % 12) - 5.5, 0.3, f64::from(i / 12) - 5.5) * 1.3;
            let crate_ = ShapeDesc::new(Geometry::cuboid(0.25, 0.25, 0.25));
            world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(crate_))?;
        }
        let lift = ShapeDesc::new(Geometry::cuboid(1.0, 0.1, 1.0));
        let lift = world
            .add_body(&BodyDesc::kinematic().with_position(DVec3::new(9.0, 0.1, 0.0)).with_shape(lift))?;
        let settings = CharacterSettings::default();
        let at = |x: f64, z: f64| Character::new(settings, DVec3::new(x, 1.5, z));
        let capsule = at(9.0, 0.0)?;
        let mut cuboid = at(-8.0, 1.0)?.with_shape(Geometry::cuboid(0.3, 0.9, 0.4))?;
        cuboid.set_rotation(Quat::from_rotation_y(0.3))?;
        let hulled = at(-8.0, -2.0)?.with_shape(hull())?;
        let walkers =
            [capsule, cuboid, hulled].iter().map(|c| world.add_character(c)).collect::<Result<_, _>>()?;
        Ok((lift, walkers))
    }

    fn frame(&mut self, frame: u32) {
        let angle = 0.05 * frame as f32;
        let up = 0.3 + 0.2 * f64::from(angle).sin();
        self.world.move_kinematic(self.lift, DVec3::new(9.0, up, 0.0), Quat::IDENTITY, DT).unwrap();
        self.world.step(DT).unwrap();
        for (i, &walker) in self.walkers.iter().enumerate() {
            let wish = if i == 0 { Vec3::ZERO } else { Vec3::new(2.5, 0.0, 0.4 * angle.sin()) };
            let velocity = wish.with_y(self.velocities[i].y - G * DT);
            let others = QueryFilter::new();
            let report = self.world.walk_character(walker, &others, velocity, DT).unwrap();
            report.push(&mut self.world).unwrap();
            self.velocities[i] = report.velocity;
        }
    }

    fn run(&mut self, frames: std::ops::Range<u32>) -> Vec<u64> {
        frames
            .map(|frame| {
                self.frame(frame);
                self.world.state_hash()
            })
            .collect()
    }
}

/// Expected: bits of the run that never stopped, at one and two threads, in the same world, and from bytes in
/// another one; velocities of the game are restored by the game, as any state of its own.
#[test]
fn a_game_with_characters_rolls_back_to_the_same_bits() {
    let straight = Game::new(1).run(0..240);
    assert_eq!(Game::new(2).run(0..240), straight);
    for threads in [1, 2] {
        let mut game = Game::new(threads);
        game.run(0..90);
        let mut snapshot = Snapshot::new();
        game.world.snapshot(&mut snapshot);
        let (velocities, size) = (game.velocities.clone(), snapshot.size());
        assert_eq!(game.run(90..200)[..], straight[90..200]);
        // Characters that came meanwhile are gone, and those that went are back.
        let gone = game.walkers[2];
        game.world.remove_character(gone).unwrap();
        let other = Character::new(CharacterSettings::default(), DVec3::Y * 9.0).unwrap();
        let came = game.world.add_character(&other).unwrap();
        game.world.set_character(game.walkers[0], &other).unwrap();
        assert_ne!(came, gone);
        game.world.restore(&snapshot).unwrap();
        assert_eq!(game.world.character(came), Err(Error::StaleCharacter));
        game.velocities.clone_from(&velocities);
        assert_eq!(game.run(90..240)[..], straight[90..240]);
        for bytes in [snapshot.to_bytes(), snapshot.to_whole_bytes()] {
            let mut new = Game::new(1);
            let back = Snapshot::from_bytes(&bytes).unwrap();
            assert_eq!(back.size(), size);
            new.world.restore(&back).unwrap();
            new.velocities.clone_from(&velocities);
            assert_eq!(new.run(90..240)[..], straight[90..240]);
        }
        // The hull has to be somewhere in a world that takes the bytes.
        let mut empty = World::new(Settings::default()).unwrap();
        let whole = Snapshot::from_bytes(&snapshot.to_whole_bytes()).unwrap();
        assert!(matches!(empty.restore(&whole), Err(Error::ForeignSnapshot { .. })));
        assert_eq!(empty.characters().count(), 0);
    }
}

/// Expected: the walks of a character that is nobody's, to the bit.
#[test]
fn it_walks_as_one_outside_of_the_world() {
    let mut game = Game::new(1);
    game.run(0..30);
    for walker in game.walkers.clone() {
        let mut outside = game.world.character(walker).unwrap();
        for step in 0..40_u8 {
            let velocity = Vec3::new(1.0, -0.5, f32::from(step) * 0.1 - 2.0);
            let expected = outside.walk(&game.world, &QueryFilter::new(), velocity, DT).unwrap();
            let filter = QueryFilter::new();
            assert_eq!(game.world.walk_character(walker, &filter, velocity, DT).unwrap(), expected);
            assert_eq!(game.world.character(walker).unwrap(), outside);
        }
        let before = game.world.state_hash();
        let filter = QueryFilter::new();
        assert!(game.world.walk_character(walker, &filter, Vec3::NAN, DT).is_err());
        assert_eq!(game.world.state_hash(), before);
    }
}

/// Expected: handles go stale and are not given out again; bytes of the report, exact at the removal.
#[test]
fn characters_come_and_go_under_their_handles() {
    let mut world = world();
    floor(&mut world);
    let empty = (world.state_hash(), world.memory().total());
    let capsule = Character::new(CharacterSettings::default(), DVec3::Y).unwrap();
    let hulled = capsule.clone().with_shape(hull()).unwrap();
    let first = world.add_character(&capsule).unwrap();
    let second = world.add_character(&hulled).unwrap();
    assert_eq!(world.characters().collect::<Vec<_>>(), [first, second]);
    assert_eq!(world.character(first).as_ref(), Ok(&capsule));
    assert_eq!(world.character(second).as_ref(), Ok(&hulled));
    assert_ne!(world.state_hash(), empty.0);
    assert!(world.memory().total() > empty.1);
    world.remove_character(first).unwrap();
    assert_eq!(world.remove_character(first), Err(Error::StaleCharacter));
    assert_eq!(world.set_character(first, &capsule), Err(Error::StaleCharacter));
    let third = world.add_character(&capsule).unwrap();
    assert!(third != first && CharacterHandle::from_bits(third.to_bits()) == third);
    world.set_character(second, &capsule).unwrap();
    assert_eq!(world.character(second).as_ref(), Ok(&capsule));
    world.remove_character(second).unwrap();
    world.remove_character(third).unwrap();
    assert_eq!(world.state_hash(), empty.0);

    let held = world.memory().total();
    let budget = Budget::total(held + 64);
    world.set_settings(Settings::default().with_budget(budget)).unwrap();
    assert!(matches!(world.add_character(&hulled), Err(Error::Budget { .. })));
    assert_eq!(world.characters().count(), 0);
}

/// Expected: refused by [`Error::BrokenSnapshot`] or a range, or a world that can go on.
#[test]
fn bytes_of_characters_are_checked() {
    let mut game = Game::new(1);
    game.run(0..20);
    let mut snapshot = Snapshot::new();
    game.world.snapshot(&mut snapshot);
    let good = snapshot.to_bytes();
    let mut random = Random(77);
    let (mut refused, mut taken) = (0, 0);
    // Three slots of characters and the print of a hull are at the end of the state.
    let place = good.len() - 3 * 57 * 4 - 12;
    for _ in 0..1500 {
        let mut bytes = good.clone();
        let at = place + random.below(good.len() - place);
        bytes[at] = if random.below(2) == 0 { 0xff } else { bytes[at] ^ (1 << random.below(8)) };
        common::snapshots::fix_checksum(&mut bytes);
        match Snapshot::from_bytes(&bytes).and_then(|snapshot| game.world.restore(&snapshot)) {
            Ok(()) => {
                taken += 1;
                for walker in game.walkers.clone() {
                    _ = game.world.walk_character(walker, &QueryFilter::new(), Vec3::NEG_Y, DT);
                }
                game.world.step(DT).unwrap();
                game.world.restore(&snapshot).unwrap();
            }
            Err(_) => refused += 1,
        }
    }
    println!("{refused} refused, {taken} taken");
    assert!(refused > 200 && taken > 200);
}

/// Expected: the recording plays to the same hashes, though no filter and no velocity is in it.
#[test]
fn recordings_have_characters() {
    use backstop::replay::{RecordingBuffer, Replay};
    let buffer = RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    let (lift, walkers) = Game::fill(&mut world).unwrap();
    let mut game = Game { world, lift, velocities: vec![Vec3::ZERO; walkers.len()], walkers };
    let straight = game.run(0..100);
    assert_eq!(straight[..], Game::new(1).run(0..100));
    let capsule = Character::new(CharacterSettings::default(), DVec3::Y).unwrap();
    game.world.set_character(game.walkers[1], &capsule).unwrap();
    game.world.remove_character(game.walkers[2]).unwrap();
    game.world.step(DT).unwrap();
    game.world.stop_recording().unwrap();
    for threads in [1, 2] {
        let bytes = buffer.bytes();
        let mut replay = Replay::open_with(&bytes[..], move |settings| settings.threads = threads).unwrap();
        let played = replay.run().unwrap();
        assert_eq!(played.divergence, None);
        assert_eq!(replay.world().state_hash(), game.world.state_hash());
    }
}
