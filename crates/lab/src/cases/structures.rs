//! Blocks on blocks: when they stand or fall, and how fast a row of them falls.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, Rig, dynamic, shape, surface, tilted};
use super::watch::threshold;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{ConvexHull, Geometry};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

const OVERHANG: &str = "H_n / 2 lengths, H_n = 1 + 1/2 + ... + 1/n";
const OVERHANG_ABOUT: &str = "so many blocks, each as far out over the next as it can be: the overhang from \
    which on they fall, in lengths";
const STACK: &str = "0";

const fn overhang_of(name: &'static str, measure: fn(&Setting) -> Result<Outcome, Error>) -> Case {
    Case { name, about: OVERHANG_ABOUT, formula: OVERHANG, unit: "", bar: 0.01, measure }
}

pub(super) const CASES: &[Case] = &[
    overhang_of("overhang-1", |setting| overhang(setting, 1)),
    overhang_of("overhang-2", |setting| overhang(setting, 2)),
    overhang_of("overhang-3", |setting| overhang(setting, 3)),
    overhang_of("overhang-5", |setting| overhang(setting, 5)),
    overhang_of("overhang-10", |setting| overhang(setting, 10)),
    Case {
        name: "arch",
        about: "a half circle of 16 voussoirs: its thickness over its mean radius up to which it falls",
        formula: "t / R = 0.10748 (Milankovitch 1907)",
        unit: "",
        bar: 0.163,
        measure: arch,
    },
    Case {
        name: "stack-100",
        about: "a box on one a hundred times lighter: how much it sinks in 10 s",
        formula: STACK,
        unit: "m",
        bar: 1e-4,
        measure: |setting| stack(setting, 100.0),
    },
    Case {
        name: "stack-1000",
        about: "the same with one a thousand times lighter",
        formula: STACK,
        unit: "m",
        bar: 1e-4,
        measure: |setting| stack(setting, 1000.0),
    },
    Case {
        name: "domino-scale",
        about: "a row of dominoes falls, and one of four times the size: their speeds over each other",
        formula: "v ~ sqrt(h): 2",
        unit: "",
        bar: 0.05,
        measure: domino_scale,
    },
    Case {
        name: "domino-push",
        about: "a row of dominoes pushed hard and gently: their speeds beyond the tenth stone over each \
            other",
        formula: "1",
        unit: "",
        bar: 0.05,
        measure: domino_push,
    },
];

/// The table ends at x = 0; block `i` from the top overhangs the next by 1 / (2 i) of its length, times a
/// factor.
fn overhang(setting: &Setting, count: u32) -> Result<Outcome, Error> {
    let half = Vec3::new(0.5, 0.05, 0.3);
    let found = threshold([0.7, 1.2], 8, |factor| {
        let mut rig = Rig::new(setting, DOWN)?;
        let material = surface(1.0, 0.0);
        let table = shape(Geometry::cuboid(2.0, 0.5, 1.0), material);
        rig.add(&BodyDesc::fixed().with_position(Vec3::new(-2.0, -0.5, 0.0)).with_shape(table))?;
        let (mut edge, mut blocks) = (0.0, Vec::new());
        for i in (1..=count).rev() {
            edge += factor / (2.0 * f64::from(i));
            let y = f64::from(count - i) * 0.1 + 0.05;
            let at = DVec3::new(edge - 0.5, y, 0.0).as_vec3();
            blocks.push(rig.add(&dynamic(Geometry::Box { half_extents: half }, material, at))?);
        }
        let top = blocks[blocks.len() - 1];
        let start = rig.place(top)?.y;
        rig.until(4.0, |rig| Ok(rig.place(top)?.y < start - 0.05))
    })?;
    let sum: f64 = (1..=count).map(|i| 0.5 / f64::from(i)).sum();
    Ok(Outcome::of(sum, found * sum))
}

fn arch(setting: &Setting) -> Result<Outcome, Error> {
    const STONES: u32 = 16;
    let found = threshold([0.07, 0.16], 7, |thickness| {
        let mut rig = Rig::new(setting, DOWN)?;
        // Friction is high enough that no block slips.
        let material = surface(2.0, 0.0);
        rig.floor(material)?;
        let mut crown = None;
        for i in 0..STONES {
            let at = |k: u32, r: f64| {
                let (sin, cos) = libm::sincos(PI * f64::from(k) / f64::from(STONES));
                DVec3::new(-r * cos, r * sin, 0.0)
            };
            let radii = [1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness];
            let middle = 0.5 * (at(i, 1.0) + at(i + 1, 1.0));
            let mut corners = Vec::new();
            for k in [i, i + 1] {
                for r in radii {
                    for z in [-0.25, 0.25] {
                        corners.push((at(k, r) - middle + DVec3::Z * z).as_vec3());
                    }
                }
            }
            let hull = Geometry::Hull(Arc::new(ConvexHull::new(&corners)?));
            let stone =
                rig.add(&BodyDesc::dynamic().with_position(middle).with_shape(shape(hull, material)))?;
            crown = crown.or((i == STONES / 2).then_some(stone));
        }
        let Some(crown) = crown else { return Ok(false) };
        let start = rig.place(crown)?.y;
        let falls = rig.until(5.0, |rig| Ok(rig.place(crown)?.y < start - 0.1))?;
        Ok(!falls)
    })?;
    Ok(Outcome::of(0.10748, found))
}

fn stack(setting: &Setting, ratio: f64) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let material = surface(0.6, 0.0);
    rig.floor(material)?;
    let cube = Geometry::cuboid(0.5, 0.5, 0.5);
    rig.add(&dynamic(cube.clone(), material, Vec3::Y * 0.5))?;
    let mut heavy = dynamic(cube, material, Vec3::Y * 1.5);
    heavy.shapes[0].density *= ratio as f32;
    let heavy = rig.add(&heavy)?;
    let mut lowest = 1.5_f64;
    rig.until(10.0, |rig| {
        lowest = lowest.min(rig.place(heavy)?.y);
        Ok(false)
    })?;
    Ok(Outcome::zero(1.5 - lowest))
}

/// Speed of the fall between the tenth and the twentieth of 25 stones, the first of which starts with a spin
/// [m/s].
fn dominoes(setting: &Setting, height: f64, spin: f64) -> Result<f64, Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let material = surface(0.4, 0.0);
    rig.floor(material)?;
    let half = DVec3::new(0.08, 0.5, 0.25) * height;
    let pitch = 0.5 * height;
    let mut stones: Vec<BodyHandle> = Vec::new();
    for i in 0..25 {
        let at = DVec3::new(f64::from(i) * pitch, half.y, 0.0);
        let mut stone = dynamic(Geometry::Box { half_extents: half.as_vec3() }, material, at.as_vec3());
        if i == 0 {
            // Rotation about its lower front edge.
            let turn = DVec3::NEG_Z * spin;
            let arm = DVec3::new(-half.x, half.y, 0.0);
            stone = stone.with_velocity(turn.cross(arm).as_vec3(), turn.as_vec3());
            stone.rotation = tilted(DVec3::Z, 0.0);
        }
        stones.push(rig.add(&stone)?);
    }
    let mut times = [f64::NAN; 2];
    for (time, stone) in times.iter_mut().zip([stones[9], stones[19]]) {
        let mut before = 0.0;
        let mut share = 1.0;
        if rig.until(30.0, |rig| {
            let lean = 2.0 * rig.turn(stone)?.z.abs();
            let passed = lean > 0.1;
            if passed {
                share = (0.1 - before) / (lean - before);
            }
            before = lean;
            Ok(passed)
        })? {
            *time = rig.time - (1.0 - share) * f64::from(rig.dt);
        }
    }
    Ok(10.0 * pitch / (times[1] - times[0]))
}

fn domino_scale(setting: &Setting) -> Result<Outcome, Error> {
    let push = |height: f64| 3.0 / height.sqrt();
    let speeds = [0.5, 2.0].map(|height| dominoes(setting, height, push(height)));
    let [small, large] = speeds;
    Ok(Outcome::of(2.0, large? / small?))
}

fn domino_push(setting: &Setting) -> Result<Outcome, Error> {
    Ok(Outcome::of(1.0, dominoes(setting, 1.0, 6.0)? / dominoes(setting, 1.0, 2.5)?))
}
