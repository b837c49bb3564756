//! Bodies, joints, couplings, characters and settings: all that their descriptions can say.

use super::call::{Anchor, CouplingSpec, Id, JointSpec};
use super::draw::Draw;
use super::forms;
use backstop::glam::{Mat3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, BodyKind, Budget, Category, CharacterSettings, ContinuousMethod,
    ContinuousMode, CoupledMotion, CouplingDesc, Frame, FrictionCone, FrictionModel, JointDesc, JointHandle,
    Limit, MassProperties, Motion, Motor, RowGroup, Settings, Spring,
};

pub fn kind(draw: &mut Draw<'_>) -> BodyKind {
    match draw.below(8) {
        0 => BodyKind::Static,
        1 => BodyKind::Kinematic,
        _ => BodyKind::Dynamic,
    }
}

pub fn continuous(draw: &mut Draw<'_>) -> ContinuousMode {
    draw.of(&[
        ContinuousMode::Segment,
        ContinuousMode::Segment,
        ContinuousMode::Volume,
        ContinuousMode::Discrete,
    ])
}

pub fn after(draw: &mut Draw<'_>) -> Option<RowGroup> {
    let groups = Settings::default().order.0;
    draw.bool().then(|| draw.of(&groups))
}

pub fn mass(draw: &mut Draw<'_>) -> MassProperties {
    let (mass, arm) = (draw.scale(0.1, 100.0), draw.scale(0.02, 1.0));
    let centre_of_mass = if draw.bool() { Vec3::ZERO } else { draw.vector(0.4) };
    let moments = Vec3::new(1.0, draw.range(0.6, 1.0), draw.range(0.6, 1.0)) * (mass * arm);
    MassProperties { mass, centre_of_mass, inertia: Mat3::from_diagonal(moments) }
}

pub fn body(draw: &mut Draw<'_>) -> BodyDesc {
    let kind = kind(draw);
    let mut body = BodyDesc::new(kind).with_position(draw.place()).with_rotation(draw.rotation());
    let shapes = draw.of(&[1, 1, 1, 1, 1, 2, 3, 0]);
    for _ in 0..shapes {
        let form = if kind == BodyKind::Dynamic { forms::convex(draw) } else { forms::form(draw) };
        body.shapes.push(forms::shape(draw, form));
    }
    if draw.chance(110) {
        let most = if draw.chance(40) { 50.0 } else { 6.0 };
        (body.linear_velocity, body.angular_velocity) = (draw.vector(most), draw.vector(most));
    }
    if shapes == 0 || draw.chance(40) {
        body.mass = Some(mass(draw));
    }
    if draw.chance(40) {
        (body.lock_translation, body.lock_rotation) = (draw.flags(64), draw.flags(100));
    }
    if draw.chance(40) {
        (body.linear_damping, body.angular_damping) = (draw.range(0.0, 4.0), draw.range(0.0, 4.0));
    }
    if draw.chance(30) {
        body.max_linear_speed = draw.bool().then(|| draw.range(0.0, 20.0));
        body.max_angular_speed = draw.bool().then(|| draw.range(0.0, 20.0));
    }
    if draw.chance(30) {
        body.gravity_scale = draw.range(-1.0, 2.0);
    }
    if draw.chance(24) {
        body.solved_after = after(draw);
    }
    body.continuous = continuous(draw);
    body.can_sleep = !draw.chance(16);
    body
}

pub fn spring(draw: &mut Draw<'_>) -> Spring {
    match draw.below(3) {
        0 => Spring::Frequency { hertz: draw.scale(0.5, 60.0), ratio: draw.range(0.0, 2.0) },
        1 => Spring::Coefficients { stiffness: draw.scale(1.0, 1e4), damping: draw.scale(0.1, 1e3) },
        _ => Spring::Acceleration { stiffness: draw.scale(1.0, 1e4), damping: draw.scale(0.1, 1e2) },
    }
}

pub fn motion(draw: &mut Draw<'_>) -> Motion {
    draw.of(&[Motion::Linear, Motion::Angular])
}

pub fn axis(draw: &mut Draw<'_>) -> Axis {
    draw.of(&Axis::ALL)
}

pub fn axes(draw: &mut Draw<'_>) -> Axes {
    match draw.below(3) {
        0 => Axes::One(axis(draw)),
        1 => Axes::Perpendicular(axis(draw)),
        _ => Axes::All,
    }
}

pub fn limit(draw: &mut Draw<'_>) -> Limit {
    let (motion, axes) = (motion(draw), axes(draw));
    let mut limit = Limit::lock(motion, axes);
    if draw.chance(170) {
        let (low, width) = (draw.range(-1.2, 1.2), draw.range(0.0, 1.5));
        limit = limit.with_range(low, low.max(0.0) + width);
    }
    if draw.chance(24) {
        limit.max = f32::INFINITY;
    }
    if draw.chance(24) {
        limit.min = f32::NEG_INFINITY;
    }
    if draw.chance(60) {
        limit.spring = Some(spring(draw));
    }
    limit
}

pub fn drive(draw: &mut Draw<'_>) -> Motor {
    let (motion, axis) = (motion(draw), axis(draw));
    let mut drive = match draw.below(3) {
        0 => Motor::velocity(motion, axis, draw.range(-10.0, 10.0), draw.scale(1.0, 1e4)),
        1 => Motor::friction(motion, axis, draw.scale(0.1, 1e3)),
        _ => {
            let spring = spring(draw);
            Motor::position(motion, axis, draw.range(-1.0, 1.0), spring)
        }
    };
    if draw.chance(40) {
        drive.max_force = f32::INFINITY;
    }
    drive
}

pub fn frames(draw: &mut Draw<'_>) -> [Frame; 2] {
    [0; 2].map(|_| Frame { position: draw.vector(0.7), rotation: draw.rotation() })
}

pub fn joint(draw: &mut Draw<'_>, bodies: [Id; 2]) -> JointSpec {
    let anchor = if draw.chance(200) {
        Anchor::Between(draw.range(0.0, 1.0), draw.rotation())
    } else {
        Anchor::Frames(frames(draw))
    };
    let (nobody, nowhere) = ([BodyHandle::from_bits(0); 2], [Frame::default(); 2]);
    let mut desc = match draw.below(8) {
        0 => JointDesc::fixed(nobody, nowhere),
        1 | 2 => JointDesc::ball(nobody, nowhere),
        3 => JointDesc::hinge(nobody, nowhere),
        4 => JointDesc::slider(nobody, nowhere),
        5 => {
            let least = draw.range(0.0, 1.0);
            JointDesc::distance(nobody, nowhere, least, least + draw.range(0.0, 1.5))
        }
        6 => {
            let spring = spring(draw);
            JointDesc::wheel(nobody, nowhere, draw.range(0.0, 0.5), spring)
        }
        _ => JointDesc::new(nobody, nowhere),
    };
    for _ in 0..draw.of(&[0, 0, 1, 2]) {
        desc = desc.with_limit(limit(draw));
    }
    for _ in 0..draw.of(&[0, 0, 1, 2]) {
        desc = desc.with_motor(drive(draw));
    }
    desc.collide = draw.chance(80);
    if draw.chance(40) {
        desc = desc.with_break_force(draw.scale(1.0, 1e5), draw.scale(1.0, 1e5));
    }
    if draw.chance(40) {
        desc = desc.with_thresholds(draw.scale(0.1, 1e4), draw.scale(0.1, 1e4));
    }
    if draw.chance(24) {
        desc.solved_after = after(draw);
    }
    JointSpec { bodies, anchor, desc }
}

pub fn range(draw: &mut Draw<'_>) -> Option<[f64; 2]> {
    let low = f64::from(draw.range(-2.0, 2.0));
    match draw.below(4) {
        0 => None,
        1 => Some([f64::NEG_INFINITY, low]),
        _ => Some([low, low + f64::from(draw.range(0.0, 2.0))]),
    }
}

pub fn factor(draw: &mut Draw<'_>) -> f64 {
    f64::from(draw.range(-3.0, 3.0))
}

pub fn strength(draw: &mut Draw<'_>) -> [f32; 2] {
    if draw.chance(40) { [f32::INFINITY; 2] } else { [draw.scale(0.1, 1e4), draw.scale(0.1, 1e4)] }
}

pub fn coupling(draw: &mut Draw<'_>, joints: [Id; 2]) -> CouplingSpec {
    let none = [JointHandle::from_bits(0); 2];
    let mut desc = match draw.below(6) {
        0 => CouplingDesc::gear(none, [factor(draw), factor(draw)]),
        1 => CouplingDesc::rack(none[0], none[1], factor(draw)),
        2 => CouplingDesc::screw(none[0], factor(draw)),
        3 => CouplingDesc::pulley(none, factor(draw), f64::from(draw.range(0.0, 4.0))),
        _ => CouplingDesc::new([0; 2].map(|_| {
            let (motion, axes, factor) = (motion(draw), axis(draw), factor(draw));
            let mut coupled = CoupledMotion::angle(none[0], axes, factor);
            coupled.motion = motion;
            if draw.chance(50) { CoupledMotion::distance(none[0], factor) } else { coupled }
        })),
    };
    if draw.chance(80) {
        desc = desc.with_range(range(draw));
    }
    if draw.chance(60) {
        desc = desc.with_break_force(strength(draw));
    }
    CouplingSpec { joints, desc }
}

pub fn character(draw: &mut Draw<'_>) -> CharacterSettings {
    let mut settings = CharacterSettings::default();
    if draw.bool() {
        settings.radius = draw.scale(0.1, 0.8);
        settings.half_height = draw.range(0.0, 0.9);
        settings.skin = draw.scale(0.002, 0.05);
        (settings.step_height, settings.snap) = (draw.range(0.0, 0.6), draw.range(0.0, 0.6));
        (settings.mass, settings.strength) = (draw.scale(1.0, 200.0), draw.scale(1.0, 2000.0));
        settings.iterations = 1 + draw.below(16) as u32;
        settings.max_slope = draw.range(0.0, 1.57);
    }
    settings
}

pub fn pose(draw: &mut Draw<'_>, bones: usize) -> Vec<Quat> {
    (0..bones).map(|_| draw.rotation()).collect()
}

pub fn budget(draw: &mut Draw<'_>) -> Budget {
    let kibibytes = draw.of(&[40, 60, 90, 130, 200, 300, 500, 1000, 4000]);
    let mut budget = Budget::total(kibibytes << 10);
    if draw.chance(60) {
        budget = budget.with(draw.of(&Category::ALL), kibibytes << 8);
    }
    budget
}

/// Settings as a game has them, with some of them as nobody has them.
pub fn settings(draw: &mut Draw<'_>) -> Settings {
    let mut settings = Settings::default();
    settings.sleeping = draw.chance(150);
    settings.sleep_time = draw.of(&[0.5, 0.05, 0.1, 0.0]);
    settings.substeps = draw.of(&[4, 4, 1, 2, 8]);
    settings.iterations = draw.of(&[1, 1, 1, 2, 4]);
    settings.joint_trees = !draw.chance(40);
    settings.warm_starting = !draw.chance(16);
    settings.recycling = !draw.chance(24);
    settings.guard = !draw.chance(16);
    if draw.chance(60) {
        settings.continuous = continuous(draw);
    }
    if draw.chance(60) {
        settings.continuous_method = draw.of(&[
            ContinuousMethod::Speculative,
            ContinuousMethod::LinearCast,
            ContinuousMethod::ConservativeAdvancement,
            ContinuousMethod::Talk,
        ]);
    }
    if draw.chance(50) {
        settings.friction_cone = FrictionCone::Box;
    }
    if draw.chance(50) {
        settings.friction_model = FrictionModel::Point;
    }
    if draw.chance(40) {
        settings.gravity = draw.vector(20.0);
    }
    if draw.chance(16) {
        settings.order = settings.order.reversed();
    }
    if draw.chance(16) {
        settings.event_capacity = draw.below(4) as u32;
    }
    if draw.chance(16) {
        settings.length_unit = draw.scale(0.2, 5.0);
    }
    if draw.chance(16) {
        settings.hit_speed = draw.range(0.0, 3.0);
    }
    if draw.chance(24) {
        (settings.restitution_threshold, settings.slop) = (draw.range(0.0, 1.0), draw.range(0.0, 0.02));
        (settings.contact_hertz, settings.contact_damping) = (draw.scale(5.0, 500.0), draw.scale(0.5, 20.0));
        settings.push_speed = draw.scale(0.5, 20.0);
    }
    settings
}
