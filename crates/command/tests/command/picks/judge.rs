//! A judge of a run, by its own measurements: of bodies as they are after each step, with nothing of `trade`.
use backstop::glam::{DQuat, DVec3};
use backstop::{Axes, BodyHandle, BodyKind, Geometry, Limit, Motion, Settings, World};
use backstop_lab::{LabWorld, WorldSolver};
use backstop_scene::Scene;

/// What a person who watches a run would see.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// Deepest overlap [m], and as a share of the thinner body's half.
    pub(super) overlap: f64,
    pub(super) overlap_share: f64,
    /// The same share of overlaps that are there for a tenth of a second.
    pub(super) lasting: f64,
    /// Widest gap of a joint [m].
    pub(super) opening: f64,
    /// How far the energy gets above that of the start, by the greatest kinetic energy of all bodies: joints
    /// may give back what they took, but nothing gets beyond what it had.
    pub(super) gain: f64,
    /// The box about all places.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// Mean speed in the last half second, of each body [m/s].
    pub(super) end_speeds: Vec<f64>,
    /// The narrowest width of a body in a joint [m].
    pub(super) narrowest: f64,
    /// Parts that the scene starts with in each other: no fault of a setting.
    from_start: Vec<[usize; 2]>,
}

/// A convex part of a body: a box, or balls along a line.
struct Part {
    body: BodyHandle,
    place: (DVec3, DQuat),
    half: DVec3,
    /// Zero for a box.
    radius: f64,
}

impl Part {
    fn thickness(&self) -> f64 {
        if self.radius > 0.0 { self.radius } else { self.half.min_element() }
    }
}

pub(super) fn watch(scene: &Scene, settings: &Settings, hz: u32, seconds: f64) -> Seen {
    watch_with(scene, (settings, None), hz, seconds)
}

/// The same by a method of the lab.
pub(super) fn watch_with(
    scene: &Scene,
    (settings, solver): (&Settings, Option<WorldSolver>),
    hz: u32,
    seconds: f64,
) -> Seen {
    let mut world = World::new(settings.clone().with_gravity(scene.gravity)).expect("settings");
    world.solve_with(solver);
    let added = scene.add_to(&mut world).expect("a scene");
    let mut seen = Seen { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, ..Seen::default() };
    let dynamic: Vec<BodyHandle> =
        added.bodies.iter().copied().filter(|&b| world.kind(b) == Ok(BodyKind::Dynamic)).collect();
    let steps = (seconds * f64::from(hz)).round() as usize;
    let tail = hz as usize / 2;
    seen.end_speeds = vec![0.0; dynamic.len()];
    seen.narrowest = narrowest(scene);
    overlaps(scene, &world, &added.bodies, true, &mut seen);
    let mut energies = vec![world.energy()];
    let (mut shares, mut kinetic) = (Vec::new(), 0.0_f64);
    for step in 0..steps {
        world.step(1.0 / hz as f32).expect("a step");
        energies.push(world.energy());
        for (&joint, one) in added.joints.iter().zip(&scene.joints) {
            let lock = Limit::lock(Motion::Linear, Axes::All);
            if !one.limits.contains(&lock) {
                continue;
            }
            let [a, b] = world.joint_frames(joint).expect("frames");
            seen.opening = seen.opening.max(a.0.distance(b.0));
        }
        let mut moving = 0.0;
        for (i, &body) in dynamic.iter().enumerate() {
            let at = world.centre_of_mass(body).expect("a body");
            (seen.low, seen.high) = (seen.low.min(at), seen.high.max(at));
            let speed = world.linear_velocity(body).expect("a body").length();
            moving += 0.5 * f64::from(world.mass(body).expect("a body") * speed * speed);
            if step + tail >= steps {
                seen.end_speeds[i] += f64::from(speed) / tail as f64;
            }
        }
        kinetic = kinetic.max(moving);
        let most = std::mem::take(&mut seen.overlap_share);
        overlaps(scene, &world, &added.bodies, false, &mut seen);
        shares.push(seen.overlap_share);
        seen.overlap_share = seen.overlap_share.max(most);
    }
    let least = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
    seen.lasting = shares.windows(hz as usize / 10 + 1).map(least).fold(0.0, f64::max);
    let most = energies.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    seen.gain = (most - energies[0]) / kinetic.max(f64::MIN_POSITIVE);
    seen
}

/// The narrowest side of a body that has joints.
fn narrowest(scene: &Scene) -> f64 {
    let joined = scene.joints.iter().flat_map(|joint| joint.bodies);
    let joined = joined.filter(|&i| scene.bodies[i].desc.kind == BodyKind::Dynamic);
    let thin = |i: usize| {
        let shapes = scene.bodies[i].desc.shapes.iter();
        shapes.map(|shape| match shape.geometry {
            Geometry::Sphere { radius } => 2.0 * f64::from(radius),
            Geometry::Capsule { radius_bottom, .. } => 2.0 * f64::from(radius_bottom),
            Geometry::Box { half_extents } => 2.0 * f64::from(half_extents.min_element()),
            _ => f64::INFINITY,
        })
    };
    joined.flat_map(thin).fold(f64::INFINITY, f64::min)
}

/// Boxes, balls and capsules are compared by geometry alone; others by the contacts of the world.
fn overlaps(scene: &Scene, world: &World, bodies: &[BodyHandle], at_start: bool, seen: &mut Seen) {
    let mut parts: Vec<(Part, bool)> = Vec::new();
    for (&body, one) in bodies.iter().zip(&scene.bodies) {
        let (at, turn) = (world.position(body).expect("a body"), world.rotation(body).expect("a body"));
        let turn = turn.as_dquat();
        for shape in &one.desc.shapes {
            let centre = at + turn * shape.position.as_dvec3();
            let rotation = turn * shape.rotation.as_dquat();
            let (half, radius) = match shape.geometry {
                Geometry::Box { half_extents } => (half_extents.as_dvec3(), 0.0),
                Geometry::Sphere { radius } => (DVec3::ZERO, f64::from(radius)),
                Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                    (DVec3::Y * f64::from(half_height), f64::from(radius_bottom.min(radius_top)))
                }
                _ => continue,
            };
            let part = Part { body, place: (centre, rotation), half, radius };
            parts.push((part, one.desc.kind == BodyKind::Dynamic));
        }
    }
    let index = |body: BodyHandle| bodies.iter().position(|&one| one == body);
    for (i, (a, moves)) in parts.iter().enumerate() {
        for (next, (b, also)) in parts[i + 1..].iter().enumerate() {
            let joined = scene.joints.iter().any(|joint| {
                let pair = joint.bodies.map(Some);
                pair == [index(a.body), index(b.body)] || pair == [index(b.body), index(a.body)]
            });
            if a.body != b.body && (*moves || *also) && !joined {
                let (depth, pair) = (depth(a, b), [i, i + 1 + next]);
                if at_start && depth > 0.0 {
                    seen.from_start.push(pair);
                }
                if seen.from_start.contains(&pair) {
                    continue;
                }
                seen.overlap = seen.overlap.max(depth);
                seen.overlap_share = seen.overlap_share.max(depth / a.thickness().min(b.thickness()));
            }
        }
    }
    for contact in world.contacts() {
        let shapes = contact.bodies.map(|body| index(body).map_or(&[][..], |i| &scene.bodies[i].desc.shapes));
        let plain = |geometry: &Geometry| {
            matches!(geometry, Geometry::Box { .. } | Geometry::Sphere { .. } | Geometry::Capsule { .. })
        };
        if shapes.iter().flat_map(|of| of.iter()).all(|shape| plain(&shape.geometry)) {
            continue;
        }
        let thin =
            shapes.iter().flat_map(|of| of.iter()).map(|shape| f64::from(shape.geometry.inner_radius()));
        let thin = thin.fold(f64::INFINITY, f64::min);
        for point in contact.points() {
            let depth = f64::from(-point.separation);
            seen.overlap = seen.overlap.max(depth);
            seen.overlap_share = seen.overlap_share.max(depth / thin);
        }
    }
}

/// How deep two parts overlap, at least; negative if they don't.
fn depth(a: &Part, b: &Part) -> f64 {
    let reach = |part: &Part| part.half.length() + part.radius;
    if a.place.0.distance(b.place.0) > reach(a) + reach(b) {
        return -1.0;
    }
    match (a.radius > 0.0, b.radius > 0.0) {
        (false, false) => boxes(a, b),
        (true, false) => balls(a).map(|at| ball_in_box(at, a.radius, b)).fold(-1.0, f64::max),
        (false, true) => balls(b).map(|at| ball_in_box(at, b.radius, a)).fold(-1.0, f64::max),
        (true, true) => balls(a)
            .flat_map(|at| balls(b).map(move |other| at.distance(other)))
            .map(|apart| a.radius + b.radius - apart)
            .fold(-1.0, f64::max),
    }
}

/// Centres of balls along a capsule; one for a ball.
fn balls(part: &Part) -> impl Iterator<Item = DVec3> + '_ {
    let count = if part.half == DVec3::ZERO { 1 } else { 9 };
    let share = move |i: i32| if count == 1 { 0.0 } else { f64::from(i) / 4.0 - 1.0 };
    (0..count).map(move |i| part.place.0 + part.place.1 * (part.half * share(i)))
}

fn ball_in_box(at: DVec3, radius: f64, of: &Part) -> f64 {
    let local = of.place.1.conjugate() * (at - of.place.0);
    let outside = (local.abs() - of.half).max(DVec3::ZERO);
    if outside == DVec3::ZERO {
        return radius + (of.half - local.abs()).min_element();
    }
    radius - outside.length()
}

/// The least overlap along the axes that can separate two boxes.
fn boxes(a: &Part, b: &Part) -> f64 {
    let of = |part: &Part| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| part.place.1 * axis);
    let (own, other) = (of(a), of(b));
    let crosses = own.iter().flat_map(|u| other.iter().map(move |v| u.cross(*v)));
    let mut least = f64::INFINITY;
    for axis in own.into_iter().chain(other).chain(crosses) {
        if axis.length_squared() < 1e-6 {
            continue;
        }
        let axis = axis.normalize();
        let reach =
            |half: DVec3, axes: [DVec3; 3]| (0..3).map(|i| half[i] * axes[i].dot(axis).abs()).sum::<f64>();
        let apart = (b.place.0 - a.place.0).dot(axis).abs();
        least = least.min(reach(a.half, own) + reach(b.half, other) - apart);
    }
    least
}
