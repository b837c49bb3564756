//! Only the parts that a scene needs are there: a part that nothing needs has no bytes and no time, one that
//! something needs has them, and loses them once nothing needs it.

use crate::common;

use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Category, ContactHook, ContactHooks, ContinuousMode, ConvexHull,
    Feature, FeatureCost, Frame, Geometry, HeightField, JointDesc, Limit, Material, Motion, Motor,
    QueryFilter, Ray, RowGroup, Settings, ShapeDesc, ShapeHandle, Spring, World,
};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
/// Steps after which buffers for forces and queries are freed (`IDLE` in src/body/store.rs), and one.
const IDLE: u32 = 257;

fn smooth(geometry: Geometry) -> ShapeDesc {
    ShapeDesc::new(geometry).with_material(Material::default().with_friction(0.0))
}

fn ball() -> ShapeDesc {
    smooth(Geometry::Sphere { radius: 0.5 })
}

/// Nothing is continuous in it.
fn settings() -> Settings {
    Settings::default().with_continuous(ContinuousMode::Discrete)
}

/// A floor without friction, and balls on it that touch each other.
fn plain(settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings).unwrap();
    let floor = smooth(Geometry::cuboid(20.0, 1.0, 20.0));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, -1.0, 0.0)).with_shape(floor)).unwrap();
    let balls = (0..4).map(|i| {
        let at = DVec3::new(0.999 * f64::from(i), 0.499, 0.0);
        world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(ball())).unwrap()
    });
    let balls = balls.collect();
    step(&mut world, 3);
    (world, balls)
}

fn step(world: &mut World, steps: u32) {
    (0..steps).for_each(|_| drop(world.step(DT).map(|_| ())));
}

fn part(world: &World, feature: Feature) -> FeatureCost {
    world.feature_report().part(feature)
}

fn bytes(world: &World, category: Category) -> usize {
    world.memory().category(category).reserved
}

#[track_caller]
fn absent(world: &World, feature: Feature) {
    let part = part(world, feature);
    assert_eq!((part.count, part.bytes, part.time_us), (0, 0, None), "{part}");
    assert_eq!(part.to_string(), format!("{feature}: not needed"));
    assert!(world.feature_report().not_needed().any(|other| other == feature));
}

/// It is asked for so often, and has bytes.
#[track_caller]
fn present(world: &World, feature: Feature, count: u32) {
    let part = part(world, feature);
    assert_eq!(part.count, count, "{part}");
    assert!(part.is_needed() && part.bytes > 0, "{part}");
    assert!(!world.feature_report().not_needed().any(|other| other == feature));
}

/// It is asked for so often; it has no bytes of its own.
#[track_caller]
fn counted(world: &World, feature: Feature, count: u32) {
    let part = part(world, feature);
    assert_eq!((part.count, part.bytes), (count, 0), "{part}");
}

#[track_caller]
fn timed(world: &World, feature: Feature) {
    assert!(part(world, feature).time_us.is_some_and(|time| time > 0.0), "{}", part(world, feature));
}

fn first_shape(world: &World, body: BodyHandle) -> ShapeHandle {
    world.shapes(body).unwrap().next().unwrap()
}

#[test]
fn balls_on_a_smooth_floor_need_gravity_and_nothing_else() {
    let (world, balls) = plain(settings());
    assert!(world.report().real >= balls.len() as u32, "they touch");
    let needed: Vec<Feature> =
        world.feature_report().iter().filter(|part| part.is_needed()).map(|part| part.feature).collect();
    assert_eq!(needed, [Feature::Acceleration]);
    for feature in Feature::ALL.into_iter().filter(|&feature| feature != Feature::Acceleration) {
        absent(&world, feature);
    }
    for category in [Category::Continuous, Category::Joints, Category::Events, Category::Meshes] {
        assert_eq!(bytes(&world, category), 0, "{category}");
    }
}

#[test]
fn without_friction_no_friction_rows() {
    let rough = |material: Material| {
        let (mut world, balls) = plain(settings());
        // The floor alone: two balls have half of it against each other too, by their average of nothing.
        let floor = world.bodies().last().unwrap();
        let shape = first_shape(&world, floor);
        world.set_material(shape, material).unwrap();
        step(&mut world, 1);
        (world, balls, shape)
    };
    let (without, ..) = rough(Material::default().with_friction(0.0));
    let (mut with, _, shape) = rough(Material::default());
    absent(&without, Feature::Friction);
    present(&with, Feature::Friction, 1);
    // The rows are the same but for those.
    let more = bytes(&with, Category::Rows) - bytes(&without, Category::Rows);
    assert_eq!(more, part(&with, Feature::Friction).bytes);
    // Eight lanes of 19 numbers at least.
    assert!(more >= 8 * 19 * 4, "{more}");

    with.set_material(shape, Material::default().with_friction(0.0)).unwrap();
    step(&mut with, 1);
    absent(&with, Feature::Friction);
    assert_eq!(bytes(&with, Category::Rows), bytes(&without, Category::Rows));
}

#[test]
fn friction_that_comes_back_acts_again() {
    let (mut world, balls) = plain(Settings::default());
    let floor = world.bodies().last().unwrap();
    let shape = first_shape(&world, floor);
    world.set_velocity(balls[0], -Vec3::X, Vec3::ZERO).unwrap();
    step(&mut world, 30);
    assert_eq!(world.angular_velocity(balls[0]).unwrap(), Vec3::ZERO);
    world.set_material(shape, Material::default()).unwrap();
    step(&mut world, 120);
    // It rolls: w = v / r, at five sevenths of the speed.
    let (v, w) = (world.linear_velocity(balls[0]).unwrap(), world.angular_velocity(balls[0]).unwrap());
    assert!((v.x + 5.0 / 7.0).abs() < 0.01 && (w.z + v.x / 0.5).abs() < 0.01, "{v} {w}");
}

#[test]
fn without_restitution_nothing_of_impacts() {
    let (mut world, balls) = plain(settings());
    let shape = first_shape(&world, balls[0]);
    let smooth = world.material(shape).unwrap();
    world.set_material(shape, smooth.with_restitution(0.5)).unwrap();
    step(&mut world, 1);
    present(&world, Feature::Restitution, 1);
    timed(&world, Feature::Restitution);
    world.set_material(shape, smooth).unwrap();
    step(&mut world, 1);
    absent(&world, Feature::Restitution);
    assert_eq!(bytes(&world, Category::Continuous), 0);
}

#[test]
fn where_all_is_discrete_nothing_is_kept_of_paths() {
    let (mut world, balls) = plain(Settings::default());
    present(&world, Feature::ContinuousCollision, 4);
    world.set_velocity(balls[0], -300.0 * Vec3::X, Vec3::ZERO).unwrap();
    step(&mut world, 1);
    assert_eq!(world.report().swept, 1);
    assert!(bytes(&world, Category::Continuous) > 0);
    // Each body may say so, or the world.
    for &ball in &balls {
        world.set_continuous(ball, ContinuousMode::Discrete).unwrap();
    }
    step(&mut world, 2);
    absent(&world, Feature::ContinuousCollision);
    assert_eq!(bytes(&world, Category::Continuous), 0);
    world.set_continuous(balls[1], ContinuousMode::Volume).unwrap();
    step(&mut world, 1);
    present(&world, Feature::ContinuousCollision, 1);
    world.set_settings(settings()).unwrap();
    step(&mut world, 2);
    absent(&world, Feature::ContinuousCollision);
    assert_eq!(bytes(&world, Category::Continuous), 0);
}

#[test]
fn without_gravity_and_forces_no_accelerations() {
    let (mut world, balls) = plain(settings().with_gravity(Vec3::ZERO));
    absent(&world, Feature::Acceleration);
    absent(&world, Feature::Forces);
    world.add_force(balls[0], Vec3::Y).unwrap();
    present(&world, Feature::Forces, 1);
    step(&mut world, 1);
    present(&world, Feature::Acceleration, 4);
    // One newton for a 60th of a second.
    let mass = world.mass(balls[0]).unwrap();
    let v = world.linear_velocity(balls[0]).unwrap();
    assert!((v.y * mass * 60.0 - 1.0).abs() < 1e-3, "{v}");
    step(&mut world, IDLE);
    absent(&world, Feature::Forces);
    step(&mut world, 1);
    absent(&world, Feature::Acceleration);
    let settings = settings().with_gravity(Vec3::NEG_Y);
    world.set_settings(settings).unwrap();
    step(&mut world, 1);
    present(&world, Feature::Acceleration, 4);
}

#[test]
fn whether_there_is_a_column_of_forces_changes_no_bit() {
    let run = |force: bool| {
        let (mut world, balls) = plain(Settings::default().with_gravity(-9.81 * Vec3::Y));
        world.set_gravity_scale(balls[1], -1.0).unwrap();
        if force {
            world.add_force(balls[0], Vec3::ZERO).unwrap();
        }
        step(&mut world, 20);
        world.state_hash()
    };
    assert_eq!(run(false), run(true));
}

#[test]
fn locked_axes_and_unequal_moments_are_counted() {
    let (mut world, _) = plain(settings());
    let free =
        BodyDesc::dynamic().with_position(DVec3::Y * 5.0).with_shape(smooth(Geometry::cuboid(1.0, 0.5, 0.2)));
    let body = world.add_body(&free).unwrap();
    counted(&world, Feature::GyroscopicTurning, 1);
    let locked = free.with_lock_rotation([true, false, false]);
    let other = world.add_body(&locked).unwrap();
    // A locked body has no axis that wanders.
    counted(&world, Feature::GyroscopicTurning, 1);
    counted(&world, Feature::LockedAxes, 1);
    step(&mut world, 1);
    // A cube turns about any axis.
    let shape = first_shape(&world, body);
    world.add_shape(body, &smooth(Geometry::cuboid(1.0, 1.0, 1.0))).unwrap();
    world.remove_shape(shape).unwrap();
    absent(&world, Feature::GyroscopicTurning);
    world.remove_body(other).unwrap();
    absent(&world, Feature::LockedAxes);
}

#[test]
fn kinematic_bodies_are_counted() {
    let (mut world, _) = plain(settings());
    let body = world.add_body(&BodyDesc::kinematic().with_shape(ball())).unwrap();
    present(&world, Feature::KinematicBodies, 1);
    world.remove_body(body).unwrap();
    absent(&world, Feature::KinematicBodies);
}

#[test]
fn lists_of_shapes_are_those_of_compounds() {
    let (mut world, balls) = plain(settings());
    let before = bytes(&world, Category::Bodies);
    let shape = world.add_shape(balls[0], &ball()).unwrap();
    present(&world, Feature::Compounds, 1);
    assert_eq!(bytes(&world, Category::Bodies) - before, part(&world, Feature::Compounds).bytes);
    world.remove_shape(shape).unwrap();
    absent(&world, Feature::Compounds);
    assert_eq!(bytes(&world, Category::Bodies), before);
}

#[test]
fn geometry_is_counted_by_kind() {
    let points: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
    let hull = Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()));
    let field = Geometry::HeightField(Arc::new(HeightField::new(3, 3, Vec2::ONE, vec![0.0; 9]).unwrap()));
    let cases = [
        (Feature::ConvexHulls, hull, Category::Shapes),
        (Feature::Meshes, common::flat_mesh(2, 1.0), Category::Meshes),
        (Feature::HeightFields, field, Category::Meshes),
    ];
    for (feature, geometry, category) in cases {
        let (mut world, _) = plain(settings());
        let desc = BodyDesc::fixed().with_shape(smooth(geometry));
        // Place for two more shapes, and in the list of geometries.
        let all: Vec<BodyHandle> = (0..2).map(|_| world.add_body(&desc).unwrap()).collect();
        world.remove_bodies(&all).unwrap();
        let before = bytes(&world, category);
        absent(&world, feature);
        let [one, two] = [(); 2].map(|()| world.add_body(&desc).unwrap());
        // Both have the same.
        present(&world, feature, 2);
        assert_eq!(bytes(&world, category) - before, part(&world, feature).bytes, "{feature}");
        world.remove_bodies(&[one, two]).unwrap();
        absent(&world, feature);
        assert_eq!(bytes(&world, category), before, "{feature}");
    }
}

fn joined(desc: impl Fn([BodyHandle; 2], [Frame; 2]) -> JointDesc) -> (World, backstop::JointHandle) {
    let (mut world, balls) = plain(settings());
    let bodies = [balls[0], balls[1]];
    let frames = world.frames_at(bodies, DVec3::new(0.5, 0.5, 0.0), Default::default()).unwrap();
    let joint = world.add_joint(&desc(bodies, frames)).unwrap();
    step(&mut world, 2);
    (world, joint)
}

const OF_JOINTS: [Feature; 7] = [
    Feature::Joints,
    Feature::JointTrees,
    Feature::JointLocks,
    Feature::JointLimits,
    Feature::JointMotors,
    Feature::JointSprings,
    Feature::BreakableJoints,
];

/// Which of them are needed.
fn needed(world: &World) -> Vec<Feature> {
    OF_JOINTS.into_iter().filter(|&feature| part(world, feature).is_needed()).collect()
}

#[test]
fn joints_have_what_their_kind_needs() {
    let spring = Spring::Frequency { hertz: 2.0, ratio: 1.0 };
    type Make = fn([BodyHandle; 2], [Frame; 2], Spring) -> JointDesc;
    let cases: [(Make, &[Feature]); 5] = [
        // A joint by itself is the smallest tree.
        (|b, f, _| JointDesc::ball(b, f), &[Feature::JointTrees]),
        (|b, f, _| JointDesc::distance(b, f, 0.0, 2.0), &[Feature::JointLimits]),
        (
            |b, f, s| {
                let limit = Limit::new(Motion::Linear, Axes::All, 0.0, 0.1).with_spring(s);
                JointDesc::new(b, f).with_limit(limit)
            },
            &[Feature::JointLimits, Feature::JointSprings],
        ),
        (
            |b, f, _| JointDesc::new(b, f).with_motor(Motor::velocity(Motion::Angular, Axis::X, 1.0, 10.0)),
            &[Feature::JointMotors],
        ),
        (
            |b, f, _| JointDesc::ball(b, f).with_break_force(1e9, 1e9),
            &[Feature::JointTrees, Feature::BreakableJoints],
        ),
    ];
    for (make, expected) in cases {
        let (mut world, joint) = joined(|bodies, frames| make(bodies, frames, spring));
        let expected: Vec<Feature> =
            std::iter::once(Feature::Joints).chain(expected.iter().copied()).collect();
        assert_eq!(needed(&world), expected);
        timed(&world, Feature::Joints);
        for &feature in &expected {
            // Springs are numbers of a row, strengths of a joint.
            if !matches!(feature, Feature::JointSprings | Feature::BreakableJoints) {
                assert!(part(&world, feature).bytes > 0, "{feature}");
            }
        }
        world.remove_joint(joint).unwrap();
        step(&mut world, 2);
        OF_JOINTS.into_iter().for_each(|feature| absent(&world, feature));
        // The handles that were given out stay known.
        assert!(bytes(&world, Category::Joints) < 1200, "{}", bytes(&world, Category::Joints));
    }
}

#[test]
fn a_net_has_locks_outside_of_trees() {
    let (mut world, _) = plain(settings());
    let desc = |x: f64, z: f64| BodyDesc::dynamic().with_position(DVec3::new(x, 5.0, z)).with_shape(ball());
    let bodies = [(0.0, 0.0), (2.0, 0.0), (1.0, 2.0), (4.0, 3.0), (3.0, 5.0)]
        .map(|(x, z)| world.add_body(&desc(x, z)).unwrap());
    // Each with each: six loops, more than are cut.
    let pairs = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b)));
    let joints: Vec<_> = pairs
        .map(|(a, b)| {
            let pair = [bodies[a], bodies[b]];
            let middle = 0.5 * (world.position(pair[0]).unwrap() + world.position(pair[1]).unwrap());
            let frames = world.frames_at(pair, middle, Default::default()).unwrap();
            world.add_joint(&JointDesc::ball(pair, frames)).unwrap()
        })
        .collect();
    step(&mut world, 1);
    present(&world, Feature::Joints, 10);
    let model = world.feature_report();
    let (trees, locks) = (model.part(Feature::JointTrees), model.part(Feature::JointLocks));
    assert!(locks.count > 0 && locks.bytes > 0, "{locks}");
    // A ring of the five is left.
    for i in [1, 2, 5, 6, 8] {
        world.remove_joint(joints[i]).unwrap();
    }
    step(&mut world, 1);
    present(&world, Feature::JointTrees, 5);
    assert_eq!(part(&world, Feature::JointLocks).count, 0, "was {locks}, {trees}");
}

#[test]
fn without_sleep_nothing_is_kept_of_rest() {
    let (mut world, _) = plain(settings().with_sleeping(true).with_sleep_time(0.1));
    step(&mut world, 300);
    assert_eq!(world.sleeping_body_count(), 4);
    present(&world, Feature::Sleeping, 4);
    timed(&world, Feature::Sleeping);
    world.set_settings(settings()).unwrap();
    step(&mut world, 1);
    absent(&world, Feature::Sleeping);
}

#[test]
fn where_nobody_listens_there_are_no_events() {
    let (mut world, balls) = plain(settings());
    let shape = first_shape(&world, balls[0]);
    world.set_events(shape, true).unwrap();
    step(&mut world, 1);
    assert!(!world.contact_begins().is_empty());
    present(&world, Feature::ContactEvents, 1);
    timed(&world, Feature::ContactEvents);
    assert_eq!(part(&world, Feature::ContactEvents).bytes, bytes(&world, Category::Events));
    // Contacts that ended with it are still reported.
    world.remove_body(balls[0]).unwrap();
    step(&mut world, 1);
    assert!(!world.contact_ends().is_empty());
    step(&mut world, 2);
    absent(&world, Feature::ContactEvents);
    assert_eq!(bytes(&world, Category::Events), 0);
}

#[test]
fn without_sensors_nobody_is_in_one() {
    let (mut world, _) = plain(settings());
    let sensor = BodyDesc::fixed()
        .with_position(DVec3::Y)
        .with_shape(ShapeDesc::new(Geometry::cuboid(3.0, 1.0, 3.0)).as_sensor());
    let sensor = world.add_body(&sensor).unwrap();
    step(&mut world, 1);
    assert!(!world.sensor_begins().is_empty());
    present(&world, Feature::Sensors, 1);
    timed(&world, Feature::Sensors);
    // It pushes nothing, so its friction is none.
    absent(&world, Feature::Friction);
    world.remove_body(sensor).unwrap();
    step(&mut world, 3);
    absent(&world, Feature::Sensors);
    assert_eq!(bytes(&world, Category::Events), 0);
}

struct Belt;

impl ContactHooks for Belt {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        contact.set_friction(0.5, 0.5).unwrap();
        contact.set_surface_velocity(0, Vec3::Z).unwrap();
    }
}

#[test]
fn hooks_may_ask_for_friction_restitution_and_moving_surfaces() {
    let (mut world, balls) = plain(settings());
    let shape = first_shape(&world, balls[0]);
    world.set_hooks(shape, true).unwrap();
    step(&mut world, 1);
    // They said nothing.
    present(&world, Feature::ContactHooks, 1);
    timed(&world, Feature::ContactHooks);
    absent(&world, Feature::SurfaceVelocities);
    present(&world, Feature::Friction, 1);
    let restitution = part(&world, Feature::Restitution);
    assert_eq!((restitution.count, restitution.bytes), (1, 0), "nothing has any");
    world.step_with(DT, &Belt).unwrap();
    let surfaces = part(&world, Feature::SurfaceVelocities);
    assert!(surfaces.count > 0 && surfaces.bytes > 0, "{surfaces}");
    assert!(world.linear_velocity(balls[0]).unwrap().z.abs() > 0.0);
    world.set_hooks(shape, false).unwrap();
    step(&mut world, 1);
    for feature in
        [Feature::ContactHooks, Feature::SurfaceVelocities, Feature::Friction, Feature::Restitution]
    {
        absent(&world, feature);
    }
}

#[test]
fn a_tree_for_queries_is_there_while_somebody_asks() {
    let (mut world, _) = plain(settings());
    let before = bytes(&world, Category::BroadPhase);
    let ray = Ray::new(DVec3::Y * 5.0, -9.0 * Vec3::Y);
    assert!(world.cast_ray(&ray, &QueryFilter::default()).unwrap().is_some());
    present(&world, Feature::Queries, 1);
    assert_eq!(bytes(&world, Category::BroadPhase) - before, part(&world, Feature::Queries).bytes);
    step(&mut world, IDLE - 1);
    // A query now and then keeps it.
    assert!(world.cast_ray(&ray, &QueryFilter::default()).unwrap().is_some());
    step(&mut world, 2);
    present(&world, Feature::Queries, 1);
    step(&mut world, IDLE);
    absent(&world, Feature::Queries);
    assert!(world.cast_ray(&ray, &QueryFilter::default()).unwrap().is_some());
}

#[test]
fn an_order_of_its_own_only_for_what_is_solved_after_a_group() {
    let (mut world, balls) = plain(settings());
    world.set_body_solved_after(balls[0], Some(RowGroup::StaticContacts)).unwrap();
    step(&mut world, 1);
    present(&world, Feature::SolvedAfter, 1);
    world.set_body_solved_after(balls[0], None).unwrap();
    step(&mut world, 1);
    absent(&world, Feature::SolvedAfter);
}

#[test]
fn a_budget_keeps_the_place_that_was_made() {
    let (mut world, balls) = plain(settings().with_budget(backstop::Budget::total(1 << 24)));
    let joint = {
        let bodies = [balls[0], balls[1]];
        let frames = world.frames_at(bodies, DVec3::new(0.5, 0.5, 0.0), Default::default()).unwrap();
        world.add_joint(&JointDesc::ball(bodies, frames)).unwrap()
    };
    step(&mut world, 1);
    let held = part(&world, Feature::Joints);
    world.remove_joint(joint).unwrap();
    step(&mut world, 2);
    let left = part(&world, Feature::Joints);
    assert!(!left.is_needed() && left.bytes > 0 && left.bytes <= held.bytes, "{held}, {left}");
}
