//! The same answers far from the origin, in any order, in every build and by any thread.

use super::*;

/// The bodies that were hit, numbers in place of handles, which differ from world to world; and the numbers.
#[derive(Clone, Debug, Default, PartialEq)]
struct Answer {
    who: Vec<u64>,
    triangle: Option<u32>,
    fraction: f32,
    normal: Vec3,
}

fn answers(world: &World, centre: DVec3, seed: u64, count: usize) -> Vec<Answer> {
    let mut random = Random(seed);
    let who = |body: BodyHandle| world.user_data(body).unwrap();
    let mut out = Vec::new();
    let mut add = |answer: Option<(BodyHandle, Option<u32>, f32, Vec3)>| {
        out.push(answer.map_or_else(Answer::default, |(body, triangle, fraction, normal)| Answer {
            who: vec![who(body)],
            triangle,
            fraction,
            normal,
        }));
    };
    for i in 0..count {
        let (from, path) = (on_grid(&mut random, 25.0), random.cube() * 40.0);
        let at = centre + from;
        let hit = world.cast_ray(&Ray::new(at, path), &ALL()).unwrap();
        add(hit.map(|h| (h.body, h.triangle, h.fraction, h.normal)));
        let found = world.closest_point(at, 9.0, &ALL()).unwrap();
        add(found.map(|f| (f.body, f.triangle, f.distance, f.normal)));
        let (shape, turned) = (convex(&mut random, i), random.rotation());
        let cast = ShapeCast::new(&shape, at, path).with_rotation(turned);
        let hit = world.cast_shape(&cast, &ALL()).unwrap();
        add(hit.map(|h| (h.body, h.triangle, h.fraction, h.normal)));
        let mut over = Vec::new();
        world.overlap(&shape, at, turned, &ALL(), &mut over).unwrap();
        over.iter().for_each(|o: &Overlap| add(Some((o.body, None, 0.0, Vec3::ZERO))));
    }
    // Those of an overlap come by handle.
    out.chunk_by_mut(|a, b| a.normal == Vec3::ZERO && b.normal == Vec3::ZERO)
        .for_each(|same| same.sort_by(|a, b| a.who.cmp(&b.who)));
    out
}

#[test]
fn far_from_the_origin_answers_are_the_same() {
    let order: Vec<usize> = (0..300).collect();
    let near = answers(&crowd(DVec3::ZERO, 5, &order), DVec3::ZERO, 6, 400);
    for far in [DVec3::new(1e6, -1e6, 5e5), DVec3::new(0.0, 0.0, 1.0e7)] {
        let there = answers(&crowd(far, 5, &order), far, 6, 400);
        assert_eq!(near.len(), there.len());
        for (near, there) in near.iter().zip(&there) {
            // Positions of 1e7 m are known to 2e-9 m.
            assert_eq!(near.who, there.who);
            assert!((near.fraction - there.fraction).abs() <= 1e-6, "{near:?} {there:?}");
            assert!((near.normal - there.normal).length() < 1e-4, "{near:?} {there:?}");
        }
    }
}

#[test]
fn answers_depend_on_what_is_there_and_not_on_how_it_came() {
    let forward: Vec<usize> = (0..300).collect();
    let backward: Vec<usize> = forward.iter().rev().copied().collect();
    let expected = answers(&crowd(DVec3::ZERO, 9, &forward), DVec3::ZERO, 6, 300);
    let mut world = crowd(DVec3::ZERO, 9, &backward);
    assert_eq!(answers(&world, DVec3::ZERO, 6, 300), expected);
    // Added and removed, moved away and back.
    let others: Vec<BodyHandle> = (0..50)
        .map(|i| add(&mut world, BodyDesc::dynamic().with_position(DVec3::X * f64::from(i)), ball(1.0)))
        .collect();
    answers(&world, DVec3::ZERO, 6, 3);
    let bodies: Vec<BodyHandle> = world.bodies().collect();
    for &body in bodies.iter().step_by(2) {
        let (position, rotation) = (world.position(body).unwrap(), world.rotation(body).unwrap());
        if position.fract() != DVec3::ZERO && rotation != Quat::IDENTITY {
            continue;
        }
        world.set_pose(body, position + DVec3::Y * 100.0, rotation).unwrap();
        answers(&world, DVec3::ZERO, 6, 1);
        world.set_pose(body, position, rotation).unwrap();
    }
    others.into_iter().for_each(|body| world.remove_body(body).unwrap());
    assert_eq!(answers(&world, DVec3::ZERO, 6, 300), expected);
}

/// SSE2, AVX2 and all other builds: one number for all answers.
#[test]
fn every_build_gives_the_pinned_answers() {
    let order: Vec<usize> = (0..300).collect();
    let mut world = crowd(DVec3::new(1000.0, 0.5, -300.0), 31, &order);
    let mut hash = 0xCBF2_9CE4_8422_2325u64;
    let mut add = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x100_0000_01B3).rotate_left(5);
    for round in 0..3 {
        for answer in answers(&world, DVec3::new(1000.0, 0.5, -300.0), round, 200) {
            answer.who.iter().for_each(|&who| add(who));
            add(answer.triangle.map_or(u64::MAX, u64::from));
            add(answer.fraction.to_bits().into());
            answer.normal.to_array().iter().for_each(|x| add(x.to_bits().into()));
        }
        world.step(1.0 / 60.0).unwrap();
    }
    assert_eq!(format!("{hash:016x}"), "9f15494ad1f364cb");
}

#[test]
fn of_equal_answers_the_lower_handle_comes_first() {
    let mut world = world();
    let twins: Vec<BodyHandle> = (0..9).map(|_| add(&mut world, BodyDesc::dynamic(), ball(1.0))).collect();
    let down = ray([0.0, 5.0, 0.0], [0.0, -10.0, 0.0]);
    let mut all = Vec::new();
    world.cast_ray_all(&down, &ALL(), &mut all).unwrap();
    assert_eq!(all.iter().map(|h| h.body).collect::<Vec<_>>(), twins);
    let drop = ball(0.5);
    let hit = world.cast_shape(&ShapeCast::new(&drop, down.from, down.path), &ALL()).unwrap().unwrap();
    let near = world.closest_point(down.from, 99.0, &ALL()).unwrap().unwrap();
    assert_eq!([first(&world, down).unwrap().body, hit.body, near.body], [twins[0]; 3]);
}

#[test]
fn any_number_of_threads_may_ask() {
    fn shared<T: Sync + Send>() {}
    shared::<World>();
    let order: Vec<usize> = (0..300).collect();
    let mut world = crowd(DVec3::ZERO, 13, &order);
    for _ in 0..5 {
        let fresh = crowd(DVec3::ZERO, 13, &order);
        drop(fresh);
        // The first query makes the tree, on any thread.
        let world_ref = &world;
        let all: Vec<Vec<Answer>> = std::thread::scope(|scope| {
            let asked: Vec<_> =
                (0..4).map(|_| scope.spawn(move || answers(world_ref, DVec3::ZERO, 3, 40))).collect();
            asked.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert!(all.iter().all(|one| *one == all[0]));
        assert_eq!(answers(&world, DVec3::ZERO, 3, 40), all[0]);
        world.step(1.0 / 60.0).unwrap();
    }
}

#[test]
fn queries_change_nothing_in_the_steps() {
    let order: Vec<usize> = (0..200).collect();
    let (mut asked, mut left_alone) = (crowd(DVec3::ZERO, 15, &order), crowd(DVec3::ZERO, 15, &order));
    assert_eq!(asked.memory(), left_alone.memory());
    for i in 0..40 {
        answers(&asked, DVec3::ZERO, i, 5);
        asked.step(1.0 / 60.0).unwrap();
        left_alone.step(1.0 / 60.0).unwrap();
        assert_eq!(asked.state_hash(), left_alone.state_hash());
    }
    assert!(asked.memory().total() > left_alone.memory().total(), "the tree of queries is counted");
}
