//! Every pair with a cylinder against a search over directions in f64.

use crate::narrow_phase::Relative;
use crate::narrow_phase::convex::testing::{Pair, Random, collider, extent, outside, shape};
use crate::narrow_phase::convex::{collide_convex, collide_triangle};
use crate::narrow_phase::manifold::RawManifold;
use crate::shape::{Collider, Geometry, Kind};
use glam::{DVec3, Quat, Vec3};

const MARGIN: f32 = 0.05;
const KINDS: [Kind; 5] = [Kind::Sphere, Kind::Capsule, Kind::Box, Kind::Cylinder, Kind::Hull];

/// How far a manifold is from the truth [m]: what its normal loses against the best direction, how far the deepest point
/// is from the depth along the normal, and how far points are outside of the shapes.
#[derive(Clone, Copy, Debug, Default)]
struct Error {
    normal: f64,
    depth: f64,
    outside: f64,
}

impl Error {
    fn worst(&self) -> f64 {
        self.normal.max(self.depth).max(self.outside)
    }
    fn max(&self, other: &Error) -> Error {
        Error {
            normal: self.normal.max(other.normal),
            depth: self.depth.max(other.depth),
            outside: self.outside.max(other.outside),
        }
    }
}

fn error(pair: &Pair, manifold: &RawManifold) -> Error {
    let distance = pair.signed_distance();
    if manifold.count == 0 {
        return Error { normal: (f64::from(MARGIN) - distance).max(0.0), ..Error::default() };
    }
    let n = manifold.normal.as_dvec3().normalize();
    let along = pair.along(n);
    let least = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
    let rotation = pair.rel.rotation.as_dquat().normalize();
    let mut off = 0.0f64;
    for point in manifold.points() {
        assert!(point.separation <= MARGIN);
        let half = n * (0.5 * f64::from(point.separation));
        let (on_a, on_b) = (point.position.as_dvec3() - half, point.position.as_dvec3() + half);
        let in_b = rotation.conjugate() * (on_b - pair.rel.position.as_dvec3());
        off = off.max(outside(pair.a, on_a)).max(outside(pair.b, in_b));
    }
    for (i, p) in manifold.points().iter().enumerate() {
        assert!(manifold.points()[..i].iter().all(|q| q.key != p.key), "equal keys: {manifold:?}");
    }
    Error { normal: distance - along, depth: (f64::from(least) - along).abs(), outside: off }
}

/// Two shapes in any attitude (or in one where axes are along or across each other), brought together along any
/// direction until they are about `at` apart [m].
fn near(random: &mut Random, a: &Collider, b: &Collider, at: f32) -> Relative {
    let direction = random.sphere();
    let rotation = match random.below(4) {
        0 => Quat::from_rotation_y(random.unit() * 6.0),
        1 => Quat::from_rotation_z(std::f32::consts::FRAC_PI_2) * Quat::from_rotation_y(random.unit() * 6.0),
        _ => random.rotation(),
    };
    let mut far = a.radius + b.radius + 0.5;
    let pair = |t: f32| Pair { a, b, rel: Relative { position: direction * t, rotation } };
    for _ in 0..12 {
        far -= (pair(far).about() as f32 - at).max(-0.3) * 0.9;
    }
    pair(far).rel
}

fn sweep(a: Kind, b: Kind, seed: u64, rounds: usize, show: f64) -> (Error, usize) {
    let mut random = Random(seed);
    let (mut worst, mut bad) = (Error::default(), 0);
    for _ in 0..rounds {
        let (one, two) = (shape(&mut random, a), shape(&mut random, b));
        let at = [-0.05, -0.02, -0.005, -0.001, 0.0, 0.002, 0.03][random.below(7)];
        let rel = near(&mut random, &one, &two, at);
        let manifold = collide_convex(&one, &two, &rel, MARGIN);
        let pair = Pair { a: &one, b: &two, rel };
        let error = error(&pair, &manifold);
        if error.worst() > show {
            bad += 1;
            println!(
                "{error:?} {a:?} {:?} {b:?} {:?} {rel:?}\n{manifold:?} distance {}",
                one.size,
                two.size,
                pair.signed_distance()
            );
        }
        worst = worst.max(&error);
    }
    (worst, bad)
}

/// A millimetre on shapes of about a metre, of which half may be what a flat face is preferred by.
#[test]
fn contacts_agree_with_a_search_over_directions() {
    let mut failed = 0;
    for (i, other) in KINDS.into_iter().enumerate() {
        let (a, b) = (Kind::Cylinder.min(other), Kind::Cylinder.max(other));
        let (worst, bad) = sweep(a, b, i as u64, if cfg!(miri) { 2 } else { 150 }, 1e-3);
        println!("{a:?} {b:?}: {worst:?}");
        failed += bad;
    }
    assert_eq!(failed, 0);
}

#[test]
#[ignore = "long"]
fn dbg_many() {
    for (i, other) in KINDS.into_iter().enumerate() {
        let (a, b) = (Kind::Cylinder.min(other), Kind::Cylinder.max(other));
        let (worst, bad) = sweep(a, b, 100 + i as u64, 300, 1e-3);
        println!("{a:?} {b:?}: {bad} {worst:?}");
    }
}
