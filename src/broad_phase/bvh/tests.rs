use super::*;
use crate::random::Random;
use crate::shape::Slabs;
use glam::vec3;

/// In a cube of 100 m.
fn boxes(count: u32, seed: u64) -> Vec<Aabb> {
    let mut random = Random(seed);
    let mut one = || {
        let (at, half) = (random.cube() * 50.0, random.cube().abs());
        Aabb { min: at - half, max: at + half }
    };
    (0..count).map(|_| one()).collect()
}

fn found(tree: &Tree, bounds: &Aabb) -> Vec<u32> {
    let mut found = Vec::new();
    tree.visit_box(&mut Vec::new(), bounds, |c| found.push(c));
    found.sort_unstable();
    found
}

#[test]
fn a_tree_finds_what_a_list_finds_while_leaves_come_go_and_move() {
    let mut all = boxes(600, 3);
    let mut place = vec![NONE; 600];
    let mut tree = Tree::default();
    let check = |tree: &Tree, all: &[Aabb], place: &[u32]| {
        for asked in boxes(50, 99) {
            let expected: Vec<u32> =
                (0..600).filter(|&c| place[c as usize] != NONE && all[c as usize].overlaps(&asked)).collect();
            assert_eq!(found(tree, &asked), expected);
        }
    };
    for (from, to) in [(0, 1), (1, 2), (2, 300), (300, 320), (320, 330), (330, 500), (500, 600)] {
        let new: Vec<u32> = (from..to).collect();
        tree.add(&new, |c| all[c as usize], |c, at| place[c as usize] = at);
        check(&tree, &all, &place);
    }
    for c in (0..600).step_by(3) {
        tree.remove(place[c]);
        place[c] = NONE;
    }
    check(&tree, &all, &place);
    for (round, step) in [(1, 50), (2, 2), (3, 1)] {
        let later = boxes(600, 100 + round);
        let moved: Vec<u32> = (0..600).step_by(step).filter(|&c| place[c as usize] != NONE).collect();
        for &c in &moved {
            all[c as usize] = later[c as usize];
        }
        if tree.refit(moved.iter().map(|&c| (place[c as usize], all[c as usize]))) {
            tree.rebuild(&[], |c| all[c as usize], |c, at| place[c as usize] = at);
        }
        check(&tree, &all, &place);
    }
}

#[test]
fn boxes_that_are_all_the_same_still_make_a_shallow_tree() {
    let mut tree = Tree::default();
    let ids: Vec<u32> = (0..5000).collect();
    tree.add(&ids, |_| Aabb { min: vec3(0.0, 0.0, 0.0), max: vec3(1.0, 1.0, 1.0) }, |_, _| {});
    assert_eq!(found(&tree, &Aabb { min: vec3(0.5, 0.5, 0.5), max: vec3(0.6, 0.6, 0.6) }).len(), 5000);
    assert!(tree.nodes.len() < 2500, "{}", tree.nodes.len());
}

#[test]
fn an_ordered_walk_finds_the_same_as_a_list() {
    let mut random = Random(9);
    let boxes = boxes(3000, 17);
    let ids: Vec<u32> = (0..3000).collect();
    let mut tree = Tree::default();
    tree.add(&ids, |c| boxes[c as usize], |_, _| {});
    for _ in 0..300 {
        let (from, path) = ((random.cube() * 60.0).as_dvec3(), random.cube() * 100.0);
        let slabs = Slabs::<f32x4>::new(from, path, glam::Vec3::ZERO);
        let one = Slabs::<f32>::new(from, path, glam::Vec3::ZERO);
        let of = |c: u32| {
            let b = &boxes[c as usize];
            one.enter(&Vec3::splat(b.min), &Vec3::splat(b.max), 1.0)
        };
        let mut expected: Vec<u32> = ids.iter().copied().filter(|&c| of(c) <= 1.0).collect();
        let key = |min: &Vec3<f32x4>, max: &Vec3<f32x4>, most: f32| slabs.enter(min, max, most);
        let mut found = Vec::new();
        tree.visit_keys(&key, 1.0, &mut |c, most| {
            found.push(c);
            most
        });
        found.sort_unstable();
        assert_eq!(found, expected);
        // Cut at the first: nothing nearer is missed.
        expected.sort_by(|&a, &b| of(a).total_cmp(&of(b)));
        let mut first = f32::INFINITY;
        tree.visit_keys(&key, 1.0, &mut |c, most| {
            first = first.min(of(c));
            most.min(of(c))
        });
        assert_eq!(first, expected.first().map_or(f32::INFINITY, |&c| of(c)));
    }
}
