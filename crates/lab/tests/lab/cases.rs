//! Every case of the lab with a known answer, at the reference setting: the error is within the bar, or
//! within what `docs/cases.md` says that it falls short by.

use backstop_lab::cases::{Case, Setting};

/// Cases that fall short of their bars, with their errors. Each has its line in `docs/cases.md`.
const SHORT: &[(&str, f64)] = &[
    ("euler-disc", 0.37),
    ("bounce-time", 0.012),
    ("oblique-grip", 1.5e-4),
    ("pendulum-179", 1.2e-3),
    ("arch", 0.395),
    ("slide-spin", 1.001),
    ("upright-hoop", 0.255),
    ("upright-disc", 0.335),
    ("rod-slip-plastic", 0.033),
    ("rod-stick", 0.125),
    ("rod-reversal", 0.251),
    ("rocking-loss", 0.08),
    ("superball-table", 1.14),
    ("capstan", 0.026),
    ("squeezer", 0.017),
    ("four-bars-energy", 0.19),
];

fn check(name: &str) {
    let case = Case::by_name(name).expect("a case of this name");
    let outcome = case.run(&Setting::REFERENCE).expect("it runs");
    let error = outcome.error();
    println!("{name}: {error:.2e}, bar {:.0e}; {outcome:?}", case.bar);
    match SHORT.iter().find(|(short, _)| *short == name) {
        None => assert!(error <= case.bar, "{name}: off by {error:.2e}: {outcome:?}; {}", case.formula),
        Some((_, reached)) => {
            assert!(error <= *reached, "{name}: off by {error:.2e}, beyond {reached:.2e}: {outcome:?}");
            assert!(error > case.bar, "{name} falls short no more: {error:.2e}; take it off the list");
        }
    }
}

macro_rules! cases {
    ($($test:ident $name:literal)*) => {
        $(#[test] fn $test() { check($name) })*
        const TESTED: &[&str] = &[$($name),*];
    };
}

cases! {
    slide_0 "slide-0"
    slide_22 "slide-22"
    slide_45 "slide-45"
    slide_60 "slide-60"
    slide_time "slide-time"
    incline_holds "incline-holds"
    incline_slides "incline-slides"
    incline_tips "incline-tips"
    painleve_rod "painleve-rod"
    painleve_jam "painleve-jam"
    boxcar "boxcar"
    cards "cards"
    ladder "ladder"
    wedge "wedge"
    stool "stool"
    slip_to_roll "slip-to-roll"
    slip_time "slip-time"
    slip_distance "slip-distance"
    backspin "backspin"
    roll_sphere "roll-sphere"
    roll_cylinder "roll-cylinder"
    roll_hoop "roll-hoop"
    roll_grip "roll-grip"
    turntable "turntable"
    bowl_rolling "bowl-rolling"
    bowl_smooth "bowl-smooth"
    cue_parabola "cue-parabola"
    cue_direction "cue-direction"
    cylinder_ball "cylinder-ball"
    spinning_disc "spinning-disc"
    euler_disc "euler-disc"
    slide_spin "slide-spin"
    upright_hoop "upright-hoop"
    upright_disc "upright-disc"
    bounce_height "bounce-height"
    bounce_time "bounce-time"
    bounce_rest "bounce-rest"
    bounce_energy "bounce-energy"
    oblique_grip "oblique-grip"
    oblique_slip "oblique-slip"
    rod_end "rod-end"
    rod_end_45 "rod-end-45"
    rod_end_70 "rod-end-70"
    rod_end_spin "rod-end-spin"
    percussion "percussion"
    rod_slip "rod-slip"
    rod_slip_plastic "rod-slip-plastic"
    rod_stick "rod-stick"
    rod_reversal "rod-reversal"
    rocking_time "rocking-time"
    rocking_loss "rocking-loss"
    superball_table "superball-table"
    cradle_2 "cradle-2"
    cradle_3 "cradle-3"
    cradle_4 "cradle-4"
    cradle_5 "cradle-5"
    galperin_0 "galperin-0"
    galperin_1 "galperin-1"
    galperin_2 "galperin-2"
    collapse_wall "collapse-wall"
    collapse_free "collapse-free"
    pendulum_10 "pendulum-10"
    pendulum_45 "pendulum-45"
    pendulum_90 "pendulum-90"
    pendulum_120 "pendulum-120"
    pendulum_150 "pendulum-150"
    pendulum_170 "pendulum-170"
    pendulum_179 "pendulum-179"
    pendulum_energy "pendulum-energy"
    double_pendulum_slow "double-pendulum-slow"
    double_pendulum_fast "double-pendulum-fast"
    capstan "capstan"
    squeezer "squeezer"
    four_bars_fall "four-bars-fall"
    four_bars_energy "four-bars-energy"
    bricard_fall "bricard-fall"
    bricard_energy "bricard-energy"
    free_fall "free-fall"
    falling_rod "falling-rod"
    falling_rod_straight "falling-rod-straight"
    chimney_tip "chimney-tip"
    chimney_race "chimney-race"
    folded_chain "folded-chain"
    free_top_space "free-top-space"
    free_top_body "free-top-body"
    heavy_top_slow "heavy-top-slow"
    heavy_top_fast "heavy-top-fast"
    nutation "nutation"
    sleeping_top "sleeping-top"
    racket_period "racket-period"
    racket_energy "racket-energy"
    racket_momentum "racket-momentum"
    overhang_1 "overhang-1"
    overhang_2 "overhang-2"
    overhang_3 "overhang-3"
    overhang_5 "overhang-5"
    overhang_10 "overhang-10"
    arch "arch"
    stack_100 "stack-100"
    stack_1000 "stack-1000"
    domino_scale "domino-scale"
    domino_push "domino-push"
}

#[test]
fn every_case_has_a_test() {
    let cases: Vec<_> = Case::all().map(|case| case.name).collect();
    assert_eq!(cases, TESTED, "the tests, in the order of the cases");
}

#[test]
fn what_falls_short_is_written_down() {
    let page = include_str!("../../../../docs/cases.md");
    let (_, short) = page.split_once("## Falls short").expect("a section");
    for (name, _) in SHORT {
        assert!(short.contains(&format!("| `{name}` |")), "docs/cases.md says nothing of {name}");
    }
}
