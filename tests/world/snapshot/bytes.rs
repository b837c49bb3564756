//! Snapshots as bytes: for worlds of the same calls, for those with the geometry, refused by others.

use super::*;

fn snapshot_of(world: &World) -> Snapshot {
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    snapshot
}

#[test]
fn bytes_go_to_a_world_that_was_made_by_the_same_calls() {
    for case in cases() {
        let (mut world, bodies) = world_of(&case, 1);
        advance(&mut world, &bodies, &case, 0, 30);
        let bytes = snapshot_of(&world).to_bytes();
        let expected = advance(&mut world, &bodies, &case, 30, 20);
        // One that has not been stepped yet, and one that has.
        for steps in [0, 7] {
            let (mut other, bodies) = world_of(&case, 1);
            advance(&mut other, &bodies, &case, 0, steps);
            other.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
            assert_eq!(advance(&mut other, &bodies, &case, 30, 20), expected, "{}", case.name);
        }
    }
}

#[test]
fn whole_bytes_go_to_a_world_that_has_the_geometry() {
    let scene = pile_of(60);
    let (mut world, _) = common::world_of(&scene, Settings::default());
    common::steps(&mut world, 60, DT);
    let bytes = snapshot_of(&world).to_whole_bytes();
    common::steps(&mut world, 20, DT);
    let snapshot = Snapshot::from_bytes(&bytes).unwrap();
    // Its four hulls are on the first bodies.
    let mut fewer = scene.clone();
    fewer.bodies.truncate(5 + 20);
    let (mut other, _) = common::world_of(&fewer, Settings::default());
    other.restore(&snapshot).unwrap();
    common::steps(&mut other, 20, DT);
    assert_eq!(other.state_hash(), world.state_hash());
    // An empty world lacks them, and stays empty.
    let mut empty = World::new(Settings::default()).unwrap();
    assert!(matches!(empty.restore(&snapshot), Err(Error::ForeignSnapshot { .. })));
    assert_eq!(empty.body_count(), 0);
}

#[test]
fn a_snapshot_of_another_world_is_refused_and_changes_nothing() {
    let (mut world, _) = common::world_of(&pile_of(30), Settings::default());
    common::steps(&mut world, 30, DT);
    let bytes = snapshot_of(&world).to_bytes();
    let (mut other, _) = common::world_of(&pile_of(31), Settings::default());
    common::steps(&mut other, 10, DT);
    let before = (other.state_hash(), snapshot_of(&other).to_bytes());
    assert!(matches!(
        other.restore(&Snapshot::from_bytes(&bytes).unwrap()),
        Err(Error::ForeignSnapshot { .. })
    ));
    assert!(matches!(other.restore(&Snapshot::new()), Err(Error::BrokenSnapshot { .. })));
    assert_eq!((other.state_hash(), snapshot_of(&other).to_bytes()), before);
    let mut newer = bytes.clone();
    newer[4] += 1;
    assert!(matches!(Snapshot::from_bytes(&newer), Err(Error::SnapshotVersion { .. })));
    let mut flipped = bytes.clone();
    *flipped.last_mut().unwrap() ^= 1;
    assert!(matches!(Snapshot::from_bytes(&flipped), Err(Error::BrokenSnapshot { .. })));
}

/// A world refuses bytes or can go on with them: with the checksum wrong, and with it put right.
#[test]
fn any_bytes_are_refused_or_can_be_stepped_on() {
    let mut game = Game::new(true, 1);
    let mut rng = Random(3);
    for _ in 0..150 {
        game.frame(&mut rng);
    }
    for whole in [false, true] {
        let snapshot = snapshot_of(&game.world);
        let good = if whole { snapshot.to_whole_bytes() } else { snapshot.to_bytes() };
        let (mut refused, mut taken) = (0, 0);
        for round in 0..3000 {
            let mut bytes = good.clone();
            for _ in 0..1 + rng.below(3) {
                // Counts come first, and break most.
                let place =
                    if round % 2 == 0 { rng.below(bytes.len()) } else { rng.below(bytes.len().min(400)) };
                match rng.below(4) {
                    0 => bytes[place] ^= 1 << rng.below(8),
                    1 => bytes[place] = rng.bits() as u8,
                    2 => bytes[place] = 0xff,
                    _ if round % 7 == 0 => bytes.truncate(place),
                    _ => bytes[place] = bytes[place].wrapping_add(1),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            assert!(bytes == good || Snapshot::from_bytes(&bytes).is_err());
            common::snapshots::fix_checksum(&mut bytes);
            let before = game.world.state_hash();
            let restored = Snapshot::from_bytes(&bytes).and_then(|snapshot| game.world.restore(&snapshot));
            if restored.is_ok() {
                taken += 1;
                for _ in 0..2 {
                    game.world.step(DT).unwrap();
                }
                game.world.restore(&snapshot).unwrap();
            } else {
                refused += 1;
            }
            assert_eq!(game.world.state_hash(), before);
        }
        println!("whole {whole}: {refused} refused, {taken} taken");
        assert!(refused > 500 && taken > 100);
    }
}

/// Bounds: below 200 bytes for a free body, and below 400 for one in a pile.
#[test]
fn a_body_takes_few_bytes() {
    let mut free = World::new(Settings::default()).unwrap();
    let floor = common::Floor::Box.desc(Material::default());
    free.add_body(&floor).unwrap();
    for i in 0..1000 {
        let at = Vec3::new((i % 10) as f32, 50.0 + (i / 100) as f32, (i / 10 % 10) as f32) * 3.0;
        let bouncy = Material::default().with_restitution(0.5);
        free.add_body(&common::dynamic(Geometry::cuboid(0.3, 0.2, 0.4), bouncy, at)).unwrap();
    }
    common::steps(&mut free, 30, DT);
    let of_free = snapshot_of(&free).size() / 1000;
    let (mut pile, _) = common::world_of(&pile_of(600), Settings::default());
    common::steps(&mut pile, 150, DT);
    let of_pile = snapshot_of(&pile).size() / 600;
    println!("free: {of_free} bytes, pile: {of_pile} bytes");
    assert!(of_free < 200, "{of_free}");
    assert!(of_pile < 400, "{of_pile}");
}
