//! A pile with less memory than it needs gets worse gradually. With 80 % of the bytes that 300 bodies needed
//! beyond their own they overlapped by 0.68 m: contacts that were found late had no place, also those under
//! load, and rows went by the order of pairs.

use crate::common::piles::{Of, Pile, Run, SIZE};
use backstop::Budget;

const PILE: Pile = Pile { of: Of::Boxes, bodies: 300, seed: 1, dt: 1.0 / 60.0 };

/// Results of a pile without a budget, and with shares of the bytes that it needs then beyond those of its
/// bodies, which are never shed.
fn runs(pile: Pile, shares: &[f64]) -> (Run, Vec<Run>) {
    let free = pile.run(Budget::NONE, 1);
    let own = pile.world(backstop::Settings::default().with_budget(Budget::total(1 << 30)));
    let own = own.memory().total();
    println!(
        "{pile:?}: {} bytes, {own} of them the bodies'; deepest overlap {:.4} m",
        free.most, free.deepest
    );
    let with = |share: &f64| {
        let budget = own + ((free.most - own) as f64 * share) as usize;
        let run = pile.run(Budget::total(budget), 1);
        println!(
            "{:3.0} %: {budget} bytes, {:2.0} % of all, {} shed, {} in the last second; deepest {:.4} m, at any time {:.4} m; \
             fastest {:.2} m/s",
            share * 100.0,
            100.0 * budget as f64 / free.most as f64,
            run.shed,
            run.shed_at_rest,
            run.deepest,
            run.worst,
            run.fastest,
        );
        run
    };
    let runs = shares.iter().map(with).collect();
    (free, runs)
}

/// Expected of budgets: with all of the bytes nothing changes; with 80 % overlaps are at most twice as deep;
/// with 60 % they are below a tenth of a body. Balls, in the table below, do so too.
#[test]
fn overlaps_deepen_by_and_by() {
    for of in [Of::Boxes, Of::Mixed] {
        let (free, with) = runs(Pile { of, ..PILE }, &[1.0, 0.8, 0.6]);
        assert_eq!((with[0].shed, with[0].hash), (0, free.hash), "{of:?}");
        assert!(with[1].deepest <= 2.0 * free.deepest, "{of:?}: {} of {}", with[1].deepest, free.deepest);
        assert!(with[2].deepest < 0.1 * SIZE, "{of:?}: {}", with[2].deepest);
        assert!(with[2].shed > with[1].shed, "{of:?}");
    }
}

/// A budget that a running world gets finds contacts with place for just the points that they have. They get
/// place for more as they need it, and nothing is shed; nor is it once the budget is gone again.
#[test]
fn a_wide_budget_on_a_running_world_changes_nothing() {
    let pile = Pile { of: Of::Mixed, ..PILE };
    let mut worlds = [(); 2].map(|()| pile.world(backstop::Settings::default()));
    for step in 0..240 {
        let budget = if step / 40 % 2 == 1 { Budget::total(1 << 30) } else { Budget::NONE };
        worlds[1].set_settings(worlds[1].settings().clone().with_budget(budget)).unwrap();
        let shed = worlds.each_mut().map(|world| world.step(PILE.dt).unwrap().shed);
        assert_eq!(shed, [0; 2], "{step}");
    }
    assert_eq!(worlds[0].state_hash(), worlds[1].state_hash());
}

/// Overlap by share, for `docs/memory.md`: piles of 100 to 1,000, at 60 and 30 Hz.
#[test]
#[ignore = "a table, of some minutes"]
fn table() {
    let shares = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5];
    for of in [Of::Boxes, Of::Spheres, Of::Mixed] {
        for (bodies, seed, rate) in
            [(300, 1, 60.0), (300, 2, 60.0), (300, 1, 30.0), (100, 1, 60.0), (1000, 1, 60.0)]
        {
            runs(Pile { of, bodies, seed, dt: 1.0 / rate }, &shares);
        }
    }
}

/// Whether one way to shed is better than another is not seen from one pile: the deepest overlaps at 80 % and
/// at 60 % over eight seeds, for each kind of pile, in order, and their medians.
#[test]
#[ignore = "a table, of some minutes"]
fn seeds() {
    for of in [Of::Boxes, Of::Spheres, Of::Mixed] {
        for (bodies, rate) in [(100, 60.0), (300, 60.0), (300, 30.0), (1000, 60.0)] {
            for share in [0.8, 0.6] {
                let deepest = |seed| runs(Pile { of, bodies, seed, dt: 1.0 / rate }, &[share]).1[0].deepest;
                let mut all: Vec<f64> = (1..=8).map(|seed| f64::from(deepest(seed))).collect();
                all.sort_by(f64::total_cmp);
                println!(
                    "{of:?}, {bodies} bodies, {rate} Hz, {share}: {:.3} m, {all:.3?}",
                    0.5 * (all[3] + all[4])
                );
            }
        }
    }
}
