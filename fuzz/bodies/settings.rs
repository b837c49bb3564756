//! Settings, and a step with them.

use super::check;
use super::input::Input;
use backstop::glam::DVec3;
use backstop::{
    BodyDesc, Budget, ContinuousMethod, ContinuousMode, FrictionCone, FrictionModel, Geometry, Settings,
    ShapeDesc, World,
};

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let mut settings = Settings::default();
    for _ in 0..1 + input.below(6) {
        change(&mut settings, input);
    }
    let Ok(mut world) = World::new(settings) else { return };
    drop(world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))));
    for i in 0..6 {
        let shape =
            if i % 2 == 0 { Geometry::cuboid(0.5, 0.5, 0.5) } else { Geometry::Sphere { radius: 0.5 } };
        let shape = ShapeDesc::new(shape).with_events();
        let at = DVec3::new(0.1 * f64::from(i), 0.4 + 0.9 * f64::from(i), 0.0);
        drop(world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)));
    }
    for _ in 0..8 {
        let dt = if input.byte() < 64 { input.number() } else { 1.0 / 60.0 };
        drop(world.step(dt));
        check(&world);
        let mut settings = world.settings().clone();
        change(&mut settings, input);
        drop(world.set_settings(settings));
    }
}

fn change(settings: &mut Settings, input: &mut Input<'_>) {
    match input.below(20) {
        0 => settings.gravity = input.vector() * 10.0,
        1 => settings.substeps = input.below(80) as u32,
        2 => settings.iterations = input.below(300) as u32 % 9,
        3 => settings.length_unit = input.size(),
        4 => settings.restitution_threshold = input.number(),
        5 => settings.slop = input.number(),
        6 => settings.contact_hertz = input.size() * 30.0,
        7 => settings.contact_damping = input.size(),
        8 => settings.push_speed = input.size(),
        9 => settings.warm_starting = input.bool(),
        10 => {
            (settings.recycling, settings.joint_trees, settings.guard) =
                (input.bool(), input.bool(), input.bool());
        }
        11 => settings.sleeping = input.bool(),
        12 => settings.sleep_speed = input.size(),
        13 => settings.sleep_time = input.size() * 0.1,
        14 => settings.hit_speed = input.number(),
        15 => settings.event_capacity = u32::from(input.byte()),
        16 => settings.budget = Budget::total(1 << (10 + input.below(16))),
        17 => settings.friction_model = input.pick(&[FrictionModel::Patch, FrictionModel::Point]),
        18 => {
            use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
            settings.continuous_method =
                input.pick(&[OnePass, Speculative, LinearCast, ConservativeAdvancement, Talk]);
            settings.friction_cone = input.pick(&[FrictionCone::Cone, FrictionCone::Box]);
        }
        _ => {
            settings.continuous =
                input.pick(&[ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume]);
            settings.threads = input.below(3);
        }
    }
}
