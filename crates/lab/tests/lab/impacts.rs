//! Impacts of bodies at random: laws in closed form against an integration in small steps, and the engine
//! and methods of the lab against the laws that they say they follow.

use backstop::Settings;
use backstop::glam::DVec2;
use backstop_lab::WorldSolver;
use backstop_lab::impacts::{Body, Impact, Law, Motion, simulate};

/// Numbers in 0..1, the same in each run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// An impact, and a body with a radius of gyration of 1 m.
fn impact(random: &mut Random) -> (Impact, Body) {
    let body =
        Body { gyration: 1.0, friction: random.between(0.0, 1.2), restitution: random.between(0.0, 1.0) };
    loop {
        let arm = DVec2::new(random.between(-1.7, 1.7), random.between(-1.7, -0.1));
        let velocity = DVec2::new(random.between(-3.0, 3.0), random.between(-3.0, 0.0));
        let before = Motion { velocity, spin: random.between(-2.0, 2.0) };
        if before.at(arm).y < -0.2 {
            return (Impact { arm, before, after: before }, body);
        }
    }
}

fn energy(motion: Motion) -> f64 {
    0.5 * (motion.velocity.length_squared() + motion.spin * motion.spin)
}

/// Distance of two motions over the speed before.
fn apart(impact: &Impact, a: Motion, b: Motion) -> f64 {
    (a.velocity - b.velocity).length().hypot(a.spin - b.spin) / (2.0 * energy(impact.before)).sqrt()
}

/// Routh's method in small normal impulses, with friction that rises to its bound within a small speed of
/// slip: no case of sticking or reversing is told from another.
fn by_small_steps(impact: &Impact, body: &Body, law: Law) -> Motion {
    const STEP: f64 = 2e-5;
    const SMALL: f64 = 1e-3;
    let mut now = impact.before;
    let (mut normal, mut ends, mut work) = (0.0, None::<f64>, 0.0);
    loop {
        let slip = now.at(impact.arm);
        if ends.is_none() && slip.y >= 0.0 {
            ends = Some(normal);
            work *= -body.restitution * body.restitution;
        }
        match (ends, law) {
            (Some(compression), Law::Poisson) if normal >= (1.0 + body.restitution) * compression => {
                return now;
            }
            (Some(_), Law::Stronge) if work <= 0.0 => return now,
            _ => {}
        }
        let friction = -body.friction * (slip.x / SMALL).clamp(-1.0, 1.0);
        let impulse = DVec2::new(friction, 1.0) * STEP;
        let next = Motion { velocity: now.velocity + impulse, spin: now.spin + impact.arm.perp_dot(impulse) };
        let done = 0.5 * (slip.y + next.at(impact.arm).y) * STEP;
        work += if ends.is_some() { -done } else { done };
        (now, normal) = (next, normal + STEP);
    }
}

#[test]
fn laws_are_those_of_an_integration_in_small_steps() {
    let mut random = Random(1);
    let mut worst = 0.0_f64;
    for _ in 0..60 {
        let (impact, body) = impact(&mut random);
        for law in [Law::Poisson, Law::Stronge] {
            let exact = law.after(impact.before, impact.arm, &body);
            let off = apart(&impact, exact, by_small_steps(&impact, &body, law));
            assert!(off < 3e-3, "{law:?} is off by {off}: {impact:?} {body:?}");
            worst = worst.max(off);
            assert!(energy(exact) <= energy(impact.before) * (1.0 + 1e-9) || law == Law::Poisson);
        }
    }
    println!("off by at most {worst:.1e}");
}

/// What Newton's law means, checked on its result and not on the way there.
#[test]
fn newtons_law_holds_at_the_end() {
    let mut random = Random(2);
    for _ in 0..10_000 {
        let (impact, body) = impact(&mut random);
        let after = Law::Newton.after(impact.before, impact.arm, &body);
        let (slip, before) = (after.at(impact.arm), impact.before.at(impact.arm));
        let impulse = after.velocity - impact.before.velocity;
        let moment = impact.arm.perp_dot(impulse) - (after.spin - impact.before.spin);
        assert!(moment.abs() < 1e-9);
        assert!((slip.y + body.restitution * before.y).abs() < 1e-9, "{impact:?} {body:?}");
        assert!(impulse.x.abs() <= body.friction * impulse.y + 1e-9);
        let opposes =
            slip.x.abs() < 1e-9 || (impulse.x + body.friction * impulse.y * slip.x.signum()).abs() < 1e-9;
        assert!(opposes, "{impact:?} {body:?}");
    }
}

/// Number of impacts: `BACKSTOP_IMPACTS`, or few.
fn count() -> u32 {
    std::env::var("BACKSTOP_IMPACTS").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

#[test]
fn the_engine_follows_newtons_law() {
    let mut random = Random(3);
    let (mut worst, mut drawn) = (0.0_f64, 0);
    for _ in 0..count() {
        let (impact, body) = impact(&mut random);
        let exact = Law::Newton.after(impact.before, impact.arm, &body);
        let found = simulate(&impact, &body, &Settings::default(), None, 1.0 / 240.0).unwrap();
        assert!(energy(found) <= energy(impact.before) * (1.0 + 1e-4), "{impact:?} {body:?} {found:?}");
        if energy(exact) > energy(impact.before) * (1.0 - 1e-4) {
            drawn += 1;
            continue;
        }
        let off = apart(&impact, exact, found);
        assert!(off < 5e-3, "off by {off}: {impact:?} {body:?} {found:?} {exact:?}");
        worst = worst.max(off);
    }
    println!("off by at most {worst:.1e}; {drawn} of {} would gain energy", count());
}

#[test]
fn methods_of_the_lab_follow_their_laws() {
    for (name, law, bar) in [
        ("gs-cone", Law::Newton, 1e-3),
        ("admm", Law::Newton, 1e-3),
        ("lemke", Law::Newton, 1e-3),
        ("impulse-based", Law::Poisson, 1e-2),
    ] {
        let solver = WorldSolver::by_name(name).expect("a method");
        let (mut random, mut worst, mut beyond) = (Random(4), 0.0_f64, 0);
        for _ in 0..50 {
            let (impact, body) = impact(&mut random);
            let exact = law.after(impact.before, impact.arm, &body);
            if energy(exact) > energy(impact.before) {
                continue;
            }
            let found = simulate(&impact, &body, &Settings::default(), Some(&solver), 1.0 / 240.0).unwrap();
            let off = apart(&impact, exact, found);
            beyond += u32::from(off > bar);
            worst = worst.max(off);
        }
        println!("{name}: off from {} by at most {worst:.1e}, {beyond} beyond {bar:.0e}", law.name());
        assert_eq!(beyond, 0, "{name}: {worst}");
    }
}

#[test]
fn what_is_no_impact_is_refused() {
    let (good, body) = impact(&mut Random(5));
    let settings = Settings::default();
    let refused = |impact: Impact, body: Body| {
        impact.validate(&body).is_err() && simulate(&impact, &body, &settings, None, 0.01).is_err()
    };
    assert!(!refused(good, body));
    let leaves = Motion { velocity: DVec2::Y, spin: 0.0 };
    assert!(refused(Impact { before: leaves, ..good }, body), "it leaves the plate");
    assert!(refused(Impact { arm: DVec2::NAN, ..good }, body));
    assert!(refused(Impact { after: Motion { spin: f64::INFINITY, ..leaves }, ..good }, body));
    assert!(refused(good, Body { gyration: 0.0, ..body }));
    assert!(refused(good, Body { friction: -1.0, ..body }));
    assert!(refused(good, Body { restitution: 1.1, ..body }));
    assert!(simulate(&good, &body, &settings, None, 0.0).is_err(), "no time passes");
}
