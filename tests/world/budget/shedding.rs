//! Omissions of a step when memory is short: more the less there is, of lower quality, but nothing falls
//! through the ground, and nothing but the world decides.

use crate::common;

use backstop::{Budget, Category, Settings, World};
use backstop_scene::Scene;
use common::piles::Overlaps;

const DT: f32 = 1.0 / 60.0;
const STEPS: u32 = 150;

/// Results of a run.
#[derive(Debug, PartialEq)]
struct Run {
    hash: u64,
    shed: Vec<u32>,
    /// By category before the first step, and the most after any; the same of all.
    first: Vec<usize>,
    most: Vec<usize>,
}

impl Run {
    fn shed(&self) -> u32 {
        self.shed.iter().sum()
    }
}

/// Reserved bytes of each category and of all.
fn held(world: &World) -> Vec<usize> {
    let memory = world.memory();
    memory.iter().map(|(_, bytes)| bytes.reserved).chain([memory.total()]).collect()
}

fn run(scene: &Scene, budget: Budget, threads: usize, mut each: impl FnMut(u32, &World)) -> Run {
    let (mut world, _) =
        common::world_of(scene, Settings::default().with_budget(budget).with_threads(threads));
    let first = held(&world);
    let (mut most, mut shed) = (first.clone(), Vec::new());
    for step in 0..STEPS {
        shed.push(world.step(DT).unwrap().shed);
        let now = held(&world);
        most.iter_mut().zip(&now).for_each(|(most, now)| *most = (*most).max(*now));
        for (i, category) in Category::ALL.into_iter().enumerate() {
            assert!(budget.limit_of(category).is_none_or(|limit| now[i] <= limit), "{category}: {}", now[i]);
        }
        assert!(budget.limit().is_none_or(|limit| now[10] <= limit), "{}", now[10]);
        each(step, &world);
    }
    Run { hash: world.state_hash(), shed, first, most }
}

/// Nobody's centre is below the floor of the pile's box, or outside its walls.
fn all_inside(world: &World) {
    for body in world.bodies().filter(|&b| world.kind(b).unwrap() == backstop::BodyKind::Dynamic) {
        let at = world.centre_of_mass(body).unwrap();
        assert!(at.y > -0.001 && at.x.abs().max(at.z.abs()) < 8.001, "{at}");
    }
}

#[test]
fn quality_falls_step_by_step_and_nothing_falls_through_the_ground() {
    let scene = common::small_pile();
    let wide = run(&scene, Budget::total(1 << 30), 1, |_, _| {});
    let (first, most) = (wide.first[10], wide.most[10]);
    let (mut shed, mut overlaps) = (Vec::new(), Vec::new());
    for share in [1.0, 0.8, 0.6, 0.4] {
        let budget = Budget::total(first + ((most - first) as f64 * share) as usize);
        let (mut quality, mut deepest) = (Overlaps::new(), 0.0f32);
        let tight = run(&scene, budget, 1, |step, world| {
            all_inside(world);
            if step % 10 == 9 {
                deepest = deepest.max(quality.deepest(world));
            }
        });
        println!(
            "{share}: {:?} of {most} bytes, {} shed, overlaps {:.3} m in all, {deepest:.4} m at most",
            budget.limit(),
            tight.shed(),
            quality.sum
        );
        shed.push(tight.shed());
        overlaps.push(quality.sum);
    }
    assert!(shed.is_sorted(), "{shed:?}");
    assert!(shed[3] > 0);
    assert!(overlaps.is_sorted(), "{overlaps:?}");
}

/// Each category for itself, with as much as it likes of all others.
#[test]
fn each_category_keeps_to_its_own_limit() {
    for (name, scene) in [("pile", common::small_pile()), ("crossfire", common::crossfire())] {
        let wide = run(&scene, Budget::total(1 << 30), 1, |_, _| {});
        for category in [
            Category::BroadPhase,
            Category::Manifolds,
            Category::Rows,
            Category::Scratch,
            Category::Continuous,
        ] {
            let (first, most) = (wide.first[category as usize], wide.most[category as usize]);
            for share in [0.0, 0.4] {
                let limit = first + ((most - first) as f64 * share) as usize;
                let tight = run(&scene, Budget::NONE.with(category, limit), 1, |_, world| {
                    if name == "pile" {
                        all_inside(world);
                    }
                });
                println!("{name}: {category} {limit} of {most} bytes: {} shed", tight.shed());
                assert!(tight.shed() > 0 || most == first, "{name}: {category} at {share}");
            }
        }
    }
}

/// Bullets that only continuous collision stops: without place for it the guard holds their centres.
#[test]
fn without_place_for_continuous_collision_the_guard_still_holds() {
    let scene = common::crossfire();
    let first = run(&scene, Budget::total(1 << 30), 1, |_, _| {}).first[Category::Continuous as usize];
    let mut held = 0;
    let tight = run(&scene, Budget::NONE.with(Category::Continuous, first), 1, |_, world| {
        held += world.report().held();
        for body in world.bodies() {
            let at = world.centre_of_mass(body).unwrap();
            // The floor ends 200 m from the middle; a body that flew off it may fall.
            assert!(at.y > -0.001 || at.x.abs().max(at.z.abs()) > 199.0, "{at}");
        }
    });
    println!("{} shed, {held} held", tight.shed());
    assert!(tight.shed() > 0 && held > 0);
}

#[test]
fn what_is_shed_does_not_depend_on_threads() {
    let whole = |wide: &Run, share: f64| {
        let (first, most) = (wide.first[10], wide.most[10]);
        Budget::total(first + ((most - first) as f64 * share) as usize)
    };
    let of = |category: Category| {
        move |wide: &Run, share: f64| {
            let (first, most) = (wide.first[category as usize], wide.most[category as usize]);
            Budget::NONE.with(category, first + ((most - first) as f64 * share) as usize)
        }
    };
    type Limit<'a> = &'a dyn Fn(&Run, f64) -> Budget;
    let cases: [(Scene, Limit<'_>); 6] = [
        (common::small_pile(), &whole),
        (common::crossfire(), &whole),
        (common::small_pile(), &of(Category::BroadPhase)),
        (common::small_pile(), &of(Category::Manifolds)),
        (common::crossfire(), &of(Category::Continuous)),
        (common::crossfire(), &of(Category::Scratch)),
    ];
    for (scene, limit) in cases {
        let wide = run(&scene, Budget::total(1 << 30), 1, |_, _| {});
        for share in [0.1, 0.4] {
            let budget = limit(&wide, share);
            let alone = run(&scene, budget, 1, |_, _| {});
            assert!(alone.shed() > 0, "{budget:?}");
            for threads in [2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let together = pool.install(|| run(&scene, budget, threads, |_, _| {}));
                assert_eq!(together, alone, "{threads} threads, {budget:?}");
            }
        }
    }
}

#[test]
fn events_beyond_their_limit_are_lost_and_nothing_else_changes() {
    let mut scene = common::small_pile();
    for body in &mut scene.bodies {
        body.desc.shapes.iter_mut().for_each(|s| s.events = true);
    }
    let lost = |budget: Budget| {
        let mut lost = 0;
        let ran = run(&scene, budget, 1, |_, world| lost += world.report().events_lost);
        (ran, lost)
    };
    let (wide, none) = lost(Budget::NONE.with(Category::Events, 1 << 30));
    assert_eq!(none, 0);
    for share in [0, 4] {
        let limit = wide.most[Category::Events as usize] * share / 10;
        let (tight, lost) = lost(Budget::NONE.with(Category::Events, limit));
        assert!(lost > 0, "{limit}");
        assert_eq!((tight.hash, tight.shed()), (wide.hash, 0));
    }
}
