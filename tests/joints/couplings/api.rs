//! Couplings as their caller sees them: refused calls, removal with joints, the same bits again.

use super::*;
use backstop::{Axes, Budget, Category, Error, Feature, Snapshot};

/// Gears, a rack and a rope in one world, at work.
fn workshop(threads: usize) -> (World, [CouplingHandle; 3]) {
    let mut world = World::new(Settings::default().with_threads(threads)).unwrap();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (_, first) = shaft(&mut world, ground, Vec3::ZERO, 0.1);
    let (_, second) = shaft(&mut world, ground, Vec3::Y, 0.2);
    let gear = world.add_coupling(&CouplingDesc::gear([first, second], [12.0, 18.0])).unwrap();
    world.set_joint_motor(first, Motor::velocity(Motion::Angular, Axis::X, 90.0, 3.0)).unwrap();
    let slab = world.add_body(&lump(2.0, 0.1).with_position(Vec3::Y * 1.2)).unwrap();
    let slider = JointDesc::slider([ground, slab], [Frame::at(Vec3::Y * 1.2), Frame::default()]);
    let slider = world.add_joint(&slider).unwrap();
    let rack = world.add_coupling(&CouplingDesc::rack(second, slider, 0.01)).unwrap();
    let bodies = [3.0, 2.0].map(|mass| {
        let side = Vec3::Z * mass;
        (side, world.add_body(&lump(mass, 0.1).with_position(side - Vec3::Y)).unwrap())
    });
    let ropes = bodies.map(|(side, body)| {
        world.add_joint(&JointDesc::new([ground, body], [Frame::at(side), Frame::default()])).unwrap()
    });
    let rope = world.add_coupling(&CouplingDesc::pulley(ropes, 2.0, 3.0)).unwrap();
    (world, [gear, rack, rope])
}

#[test]
fn threads_do_not_show() {
    let (mut one, of_one) = workshop(1);
    let (mut two, of_two) = workshop(2);
    for _ in 0..300 {
        one.step(DT).unwrap();
        two.step(DT).unwrap();
        assert_eq!(one.state_hash(), two.state_hash());
    }
    for (a, b) in of_one.into_iter().zip(of_two) {
        assert_eq!(one.coupling_positions(a), two.coupling_positions(b));
        assert_eq!(one.coupling_force(a), two.coupling_force(b));
    }
}

/// After a hundred turns, in the middle of a run: the same bits again, in the same world, in one that lost
/// its couplings, and in one that never had any.
#[test]
fn a_snapshot_keeps_every_turn() {
    let (mut world, couplings) = workshop(1);
    for _ in 0..500 {
        world.step(DT).unwrap();
    }
    let mut saved = Snapshot::default();
    world.snapshot(&mut saved);
    let bytes = saved.to_whole_bytes();
    let watch = |world: &mut World| -> Vec<_> {
        let mut seen = Vec::new();
        for _ in 0..100 {
            world.step(DT).unwrap();
            let of = |&one| (world.coupling_positions(one).unwrap(), world.coupling_force(one).unwrap());
            seen.push((world.state_hash(), couplings.each_ref().map(of)));
        }
        seen
    };
    let expected = watch(&mut world);
    assert!(expected[99].1[0].0[0] > 100.0 * TAU, "{:?}", expected[99].1[0]);
    world.restore(&saved).unwrap();
    assert_eq!(watch(&mut world), expected);
    world.remove_coupling(couplings[1]).unwrap();
    world.set_coupling_factors(couplings[0], [1.0, 1.0]).unwrap();
    world.step(DT).unwrap();
    world.restore(&saved).unwrap();
    assert_eq!(watch(&mut world), expected);
    let mut other = World::new(Settings::default()).unwrap();
    other.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(watch(&mut other), expected);
}

#[test]
fn what_can_not_be_coupled_is_refused() {
    let mut world = weightless();
    let (_, gear) = pair(&mut world, [0.1, 0.1], [1.0, 2.0]);
    let desc = world.coupling(gear).unwrap();
    let [a, b] = desc.motions;
    let hash = world.state_hash();
    let refused = |world: &mut World, desc: CouplingDesc| world.add_coupling(&desc).unwrap_err();
    assert!(matches!(refused(&mut world, desc.with_motions([a, a])), Error::CoupledMotion { .. }));
    let mut tilt = b;
    tilt.axes = Axes::Perpendicular(Axis::X);
    assert!(matches!(refused(&mut world, desc.with_motions([a, tilt])), Error::CoupledMotion { .. }));
    for factor in [0.0, 1e-12, 1e12] {
        let motions = [a, b.with_factor(factor)];
        assert!(matches!(refused(&mut world, desc.with_motions(motions)), Error::OutOfRange { .. }));
    }
    let motions = [a, b.with_factor(f64::NAN)];
    assert!(matches!(refused(&mut world, desc.with_motions(motions)), Error::NotFinite { .. }));
    for range in [[1.0, 0.0], [f64::INFINITY; 2], [0.0, 1e20]] {
        assert!(matches!(refused(&mut world, desc.with_range(Some(range))), Error::OutOfRange { .. }));
    }
    let weak = desc.with_break_force([1.0, -1.0]);
    assert!(matches!(refused(&mut world, weak), Error::OutOfRange { .. }));
    assert!(world.set_coupling_factors(gear, [0.0, 1.0]).is_err());
    assert!(world.set_coupling_range(gear, Some([f64::NAN; 2])).is_err());
    assert!(world.set_coupling_break_force(gear, [f32::NAN; 2]).is_err());
    assert_eq!((world.coupling_count(), world.state_hash()), (1, hash));
    assert_eq!(world.coupling(gear).unwrap(), desc);
}

#[test]
fn a_coupling_goes_with_its_joints_and_bodies() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.1], [1.0, 2.0]);
    let [of_a, of_b] = [a, b].map(|body| world.joints_of(body).unwrap().next().unwrap());
    let desc = world.coupling(gear).unwrap();
    let second = world.add_coupling(&desc.with_user_data(7)).unwrap();
    assert_eq!(world.couplings_of(of_a).unwrap().collect::<Vec<_>>(), [gear, second]);
    assert_eq!(world.coupling(second).unwrap().user_data, 7);
    world.remove_coupling(gear).unwrap();
    assert_eq!(world.remove_coupling(gear), Err(Error::StaleCoupling));
    world.step(DT).unwrap();
    world.remove_joint(of_a).unwrap();
    assert!(!world.contains_coupling(second) && world.coupling_count() == 0);
    assert_eq!(world.couplings_of(of_b).unwrap().count(), 0);
    assert_eq!(world.add_coupling(&desc), Err(Error::StaleJoint));
    world.step(DT).unwrap();
    let ([_, b], gear) = pair(&mut world, [0.1, 0.1], [1.0, 2.0]);
    world.step(DT).unwrap();
    world.remove_body(b).unwrap();
    world.step(DT).unwrap();
    assert_eq!(world.coupling_force(gear), Err(Error::StaleCoupling));
}

/// A coupling of two disabled bodies has no effect; enabled again, it has.
#[test]
fn a_disabled_wheel_turns_nothing() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.1], [1.0, 1.0]);
    world.set_enabled(b, false).unwrap();
    world.set_velocity(a, Vec3::ZERO, Vec3::X).unwrap();
    world.step(DT).unwrap();
    assert_eq!(spin(&world, a), 1.0);
    world.set_enabled(b, true).unwrap();
    world.set_coupling_range(gear, None).unwrap();
    world.step(DT).unwrap();
    assert!((spin(&world, a) - 0.5).abs() < 1e-3 && (spin(&world, b) + 0.5).abs() < 1e-3);
}

/// A gear that is shifted. Expected: the second wheel keeps its angle and takes the new ratio.
#[test]
fn a_gear_can_be_shifted() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.1], [10.0, 10.0]);
    let hinge = world.joints_of(a).unwrap().next().unwrap();
    world.set_joint_motor(hinge, motor(5.0)).unwrap();
    run(&mut world, 120);
    let [_, before] = world.coupling_positions(gear).unwrap();
    world.set_coupling_factors(gear, [10.0, 40.0]).unwrap();
    assert_eq!(world.coupling_positions(gear).unwrap()[1], before);
    run(&mut world, 240);
    assert!((spin(&world, b) + 1.25).abs() < 1e-4, "{}", spin(&world, b));
    let [_, after] = world.coupling_positions(gear).unwrap();
    assert!((after - before + 5.0).abs() < 0.05, "{before} {after}");
}

/// Teeth that bear 4 N m break under 5, and are reported once; the wheel is free from then on.
#[test]
fn teeth_break_above_their_strength() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.1], [1.0, 1.0]);
    world.set_coupling_break_force(gear, [4.0, f32::INFINITY]).unwrap();
    let mut push = |torque: f32| {
        world.add_torque(a, Vec3::X * torque).unwrap();
        world.add_torque(b, Vec3::X * torque).unwrap();
        world.step(DT).unwrap();
        world.broken_couplings().to_vec()
    };
    assert!((0..60).all(|_| push(3.9).is_empty()));
    let broken: Vec<_> = (0..60).flat_map(|_| push(5.0)).collect();
    assert_eq!(broken, [gear]);
    assert!(!world.contains_coupling(gear) && spin(&world, a) > 10.0 && spin(&world, b) > 10.0);
}

/// A step with couplings allocates nothing beyond what a budget allowed when they were added, and their
/// bytes go when they do.
#[test]
fn couplings_are_in_the_books() {
    let (mut world, couplings) = workshop(1);
    world.step(DT).unwrap();
    let part = |world: &World| world.feature_report().part(Feature::Couplings);
    assert_eq!(part(&world).count, 3);
    assert!(part(&world).bytes > 0);
    couplings.into_iter().for_each(|coupling| world.remove_coupling(coupling).unwrap());
    world.step(DT).unwrap();
    world.step(DT).unwrap();
    assert_eq!((part(&world).count, part(&world).bytes), (0, 0));

    let settings = Settings::default().with_budget(Budget::total(1 << 20));
    let mut world = World::new(settings).unwrap();
    let (_, gear) = pair(&mut world, [0.1, 0.1], [1.0, 2.0]);
    let desc = world.coupling(gear).unwrap();
    let mut refused = 0;
    for i in 0..2000 {
        refused += u32::from(matches!(world.add_coupling(&desc), Err(Error::Budget { .. })));
        if i % 100 == 0 {
            world.step(DT).unwrap();
        }
    }
    let used = world.memory().category(Category::Joints).reserved;
    println!("{} couplings, {refused} refused, {used} bytes", world.coupling_count());
    assert!(refused > 0 && world.memory().total() <= 1 << 20);
}
