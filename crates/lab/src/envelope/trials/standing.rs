//! Structures that should stay as they were built.

use super::super::conditions::Conditions;
use super::super::measures::{Gauge, Measure};
use super::setup::{Setup, floor, weight};
use backstop::{ConvexHull, Geometry};
use backstop_scene::Scene;
use backstop_scene::builtin::dynamic;
use glam::{Quat, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// Parts of a structure may move by a twentieth of their size; it has fallen if one moves by half of it.
fn stands(unit: f32) -> Vec<Gauge> {
    vec![Gauge { measure: Measure::Moved { unit: f64::from(unit) }, bounds: [0.05, 0.5] }]
}

/// Ten boxes on each other; the topmost is the heavy one.
pub(super) fn stack(c: &Conditions) -> Setup {
    let mut scene = Scene::new("stack");
    let boundaries = floor(&mut scene, 20.0 * c.size, c.size);
    for i in 0..10 {
        let mut body = dynamic(cube(c.size), Vec3::new(0.0, i as f32 + 0.5, 0.0) * c.size);
        weight(&mut body, if i == 9 { c.mass_ratio } else { 1.0 });
        scene.add("box", body);
    }
    Setup { scene, boundaries, gauges: stands(c.size) }
}

/// A plate on the floor that carries boxes, side by side.
pub(super) fn plate(c: &Conditions) -> Setup {
    let mut scene = Scene::new("plate");
    let rows = (c.carried as f32).sqrt().ceil();
    let half = 0.75 * rows * c.size;
    let boundaries = floor(&mut scene, 2.0 * half + 10.0 * c.size, c.size);
    let thick = 0.25 * c.size;
    scene.add("plate", dynamic(Geometry::cuboid(half, thick, half), Vec3::new(0.0, thick, 0.0)));
    for i in 0..c.carried {
        let (x, z) = (i as f32 % rows, (i as f32 / rows).floor());
        let side = |n: f32| 1.5 * (n + 0.5 - 0.5 * rows);
        let mut body = dynamic(cube(c.size), Vec3::new(side(x), 1.0, side(z)) * c.size);
        weight(&mut body, c.mass_ratio);
        scene.add("box", body);
    }
    Setup { scene, boundaries, gauges: stands(c.size) }
}

fn cube(size: f32) -> Geometry {
    Geometry::cuboid(0.5 * size, 0.5 * size, 0.5 * size)
}

/// Three storeys of leaning cards, with cards lying on the tips of each storey.
pub(super) fn card_house(c: &Conditions) -> Setup {
    /// How far cards lean [rad], half their height, half their thickness, and how far apart the tips are.
    const LEAN: f32 = 0.35;
    const HEIGHT: f32 = 0.5;
    const THICK: f32 = 0.01;
    const APART: f32 = 0.8;
    let mut scene = Scene::new("card house");
    let boundaries = floor(&mut scene, 20.0 * c.size, c.size);
    let (sin, cos) = (libm::sinf(LEAN), libm::cosf(LEAN));
    let (aside, middle) = (THICK * cos + HEIGHT * sin, THICK * sin + HEIGHT * cos);
    let mut card = |half: [f32; 2], at: [f32; 2], lean: f32| {
        let shape = Geometry::cuboid(half[0] * c.size, half[1] * c.size, 0.4 * c.size);
        let body = dynamic(shape, Vec3::new(at[0], at[1], 0.0) * c.size);
        scene.add(
            "card",
            body.with_rotation(Quat::from_xyzw(0.0, 0.0, libm::sinf(0.5 * lean), libm::cosf(0.5 * lean))),
        );
    };
    let mut base = 0.0;
    for storey in (1..=3_i32).rev() {
        let tip = |i: i32| APART * (i as f32 - 0.5 * (storey - 1) as f32);
        for i in 0..storey {
            for side in [-1.0, 1.0] {
                card([THICK, HEIGHT], [tip(i) + side * aside, base + middle], side * LEAN);
            }
        }
        base += 2.0 * middle;
        for i in 1..storey {
            // As long as the distance of the tips, less a gap so that neighbours don't touch.
            card([0.5 * APART - 0.002, THICK], [0.5 * (tip(i - 1) + tip(i)), base + THICK], 0.0);
        }
        base += 2.0 * THICK;
    }
    Setup { scene, boundaries, gauges: stands(c.size) }
}

/// Half a ring of eleven wedges, without mortar.
pub(super) fn arch(c: &Conditions) -> Setup {
    const WEDGES: usize = 11;
    const INNER: f32 = 2.0;
    const OUTER: f32 = 2.8;
    let mut scene = Scene::new("arch");
    let boundaries = floor(&mut scene, 20.0 * c.size, c.size);
    let half = 0.5 * PI / WEDGES as f32;
    // A wedge along x: its faces are at half an angle to either side, and its centre of mass is near the
    // origin.
    let middle = 0.5 * (INNER + OUTER);
    let mut corners = Vec::new();
    for (radius, side, z) in [INNER, OUTER]
        .into_iter()
        .flat_map(|r| [-1.0_f32, 1.0].into_iter().flat_map(move |side| [-0.4_f32, 0.4].map(|z| (r, side, z))))
    {
        let along = radius * libm::cosf(half) - middle;
        corners.push(Vec3::new(along, side * radius * libm::sinf(half), z) * c.size);
    }
    let wedge = Arc::new(ConvexHull::new(&corners).expect("eight corners of a wedge"));
    for i in 0..WEDGES {
        let angle = (2 * i + 1) as f32 * half;
        let (sin, cos) = (libm::sinf(angle), libm::cosf(angle));
        let turn = Quat::from_xyzw(0.0, 0.0, libm::sinf(0.5 * angle), libm::cosf(0.5 * angle));
        let body = dynamic(Geometry::Hull(wedge.clone()), Vec3::new(cos, sin, 0.0) * (middle * c.size));
        scene.add("wedge", body.with_rotation(turn));
    }
    Setup { scene, boundaries, gauges: stands(0.8 * c.size) }
}
