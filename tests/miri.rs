//! Every stage through the unsafe code that threads share, in worlds so small that Miri can run them.
//!
//! Blocks are as small as can be under Miri, so two threads share a block of other builds. Miri looks for two
//! threads at the same element, and for references to memory that another thread writes. The same worlds,
//! several times over so that threads are worth it, must give the same bits in any build.

mod common;

use backstop::glam::{Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ContinuousMode, ConvexHull, FrictionModel, Geometry, HeightField, Material,
    Settings, ShapeDesc, World,
};
use std::sync::Arc;

/// Threads share a step from 128 bodies on, under Miri from two on.
const COPIES: usize = if cfg!(miri) { 1 } else { 24 };
const STEPS: u32 = if cfg!(miri) { 2 } else { 30 };
/// Metres from one copy to the next.
const APART: f32 = 20.0;

fn settings() -> Settings {
    Settings::default().with_substeps(2)
}

/// Steps the copies of a scene by one thread and by two: no bit may differ.
fn alone_and_shared(settings: &Settings, scene: &[BodyDesc]) {
    alone_and_shared_with(settings, &|world, beside| {
        let moved = scene.iter().map(|desc| desc.clone().with_position(desc.position + beside.as_dvec3()));
        world.add_bodies(&moved.collect::<Vec<_>>()).unwrap()
    });
}

/// The same for bodies that `add` adds at a place.
fn alone_and_shared_with(settings: &Settings, add: &(dyn Fn(&mut World, Vec3) -> Vec<BodyHandle> + Sync)) {
    let run = |threads: usize| {
        let mut world = World::new(settings.clone().with_threads(threads)).unwrap();
        let mut bodies = Vec::new();
        for copy in 0..COPIES {
            bodies.extend(add(&mut world, Vec3::X * (APART * copy as f32)));
        }
        let mut met = 0;
        for step in 0..STEPS {
            if step == STEPS - 1 {
                // Another body takes its place in the columns.
                world.remove_body(bodies[1]).unwrap();
            }
            met += world.step(1.0 / 60.0).unwrap().manifolds;
        }
        assert!(met > 0);
        assert!(common::all_finite(&world));
        world.state_hash()
    };
    let shared = with_helper(|| run(2));
    // Alone a thread does nothing that it does not do beside another: Miri need not see it twice.
    if !cfg!(miri) {
        assert_eq!(shared, run(1));
    }
}

fn with_helper<R: Send>(f: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap().install(f)
}

fn fixed(geometry: Geometry, at: Vec3) -> BodyDesc {
    BodyDesc::fixed().with_position(at).with_shape(ShapeDesc::new(geometry))
}

fn dynamic(geometry: Geometry, at: Vec3) -> BodyDesc {
    common::dynamic(geometry, Material::default().with_restitution(0.3), at)
}

fn cube(half: f32) -> Geometry {
    Geometry::cuboid(half, half, half)
}

/// A square of 2 m on the floor, of 8 triangles.
fn floor_of_triangles() -> BodyDesc {
    fixed(common::flat_mesh(1, 1.0), Vec3::ZERO)
}

/// Three batches of one colour: each of them gathers and scatters velocities beside the others.
#[test]
fn balls_beside_each_other() {
    let mut scene = vec![fixed(Geometry::Plane, Vec3::ZERO)];
    for i in 0..20 {
        let at = Vec3::new((i % 5) as f32 * 1.2, 0.499, (i / 5) as f32 * 1.2);
        scene.push(dynamic(Geometry::Sphere { radius: 0.5 }, at));
    }
    alone_and_shared(&settings(), &scene);
}

#[test]
fn a_stack_of_boxes() {
    let mut scene = vec![fixed(Geometry::Plane, Vec3::ZERO)];
    scene.extend((0..3).map(|i| dynamic(cube(0.5), Vec3::Y * (0.499 + 0.998 * i as f32))));
    // A body that is moved by its velocity alone, and one that may only turn about y.
    let belt = BodyDesc::kinematic().with_position(Vec3::X * 1.5).with_velocity(Vec3::X * -0.1, Vec3::ZERO);
    scene.push(belt.with_shape(ShapeDesc::new(cube(1.0))));
    let mut locked = dynamic(cube(0.5), Vec3::new(1.5, 1.499, 0.0)).with_velocity(Vec3::ZERO, Vec3::Y);
    (locked.lock_translation, locked.lock_rotation) = ([true, false, true], [true, false, true]);
    scene.push(locked);
    alone_and_shared(&settings(), &scene);
}

#[test]
fn one_of_each_shape_on_triangles() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|v| v * 0.6 - Vec3::ONE * 0.3);
    let shapes = [
        Geometry::Sphere { radius: 0.3 },
        Geometry::capsule(0.2, 0.3),
        cube(0.3),
        Geometry::cylinder(0.3, 0.3),
        Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap())),
    ];
    let mut scene = vec![floor_of_triangles()];
    for (i, shape) in shapes.into_iter().enumerate() {
        let at = Vec3::new((i % 3) as f32 * 0.58 - 0.6, 0.298, (i / 3) as f32 * 0.58 - 0.3);
        scene.push(dynamic(shape, at));
    }
    let hills = HeightField::new(3, 3, Vec2::ONE, vec![0.0, 0.1, 0.0, 0.1, 0.0, 0.1, 0.0, 0.1, 0.0]).unwrap();
    scene.push(fixed(Geometry::HeightField(Arc::new(hills)), Vec3::Z * 5.0));
    scene.push(dynamic(Geometry::Sphere { radius: 0.3 }, Vec3::new(0.1, 0.3, 5.1)));
    scene.push(dynamic(cube(0.3), Vec3::new(-0.5, 0.33, 4.6)));
    alone_and_shared(&settings(), &scene);
}

/// Sixty metres a second, spinning, at a plate of 2 cm, at triangles and at each other; one in the mode
/// `Volume`.
#[test]
fn bullets() {
    let plate = fixed(Geometry::cuboid(1.0, 0.01, 1.0), Vec3::X * 4.0);
    let shot = |geometry: Geometry, at: Vec3| {
        dynamic(geometry, at).with_velocity(Vec3::new(1.0, -60.0, 0.5), Vec3::new(3.0, 5.0, 7.0))
    };
    let ball = Geometry::Sphere { radius: 0.05 };
    let mut far = shot(cube(0.05), Vec3::new(4.3, 0.5, 0.2));
    far.continuous = ContinuousMode::Volume;
    let scene = [
        floor_of_triangles(),
        plate,
        shot(ball.clone(), Vec3::new(0.2, 0.6, 0.1)),
        shot(cube(0.05), Vec3::new(-0.3, 0.7, -0.4)),
        shot(ball.clone(), Vec3::new(4.0, 0.4, 0.0)),
        far,
        dynamic(ball, Vec3::new(0.2, -0.4, 0.1)).with_velocity(Vec3::Y * 80.0, Vec3::ZERO),
    ];
    alone_and_shared(&settings(), &scene);
}

/// Balls and tilted cubes that bounce, on triangles and on cubes which stand and bounce too: rows that an
/// impact replaces are put out of action in their lanes.
#[test]
fn elastic_bodies() {
    let bouncy = |mut desc: BodyDesc| {
        desc.shapes[0].material = Material::default().with_restitution(1.0);
        desc
    };
    let down = Vec3::new(0.5, -6.0, 0.0);
    let ball = Geometry::Sphere { radius: 0.2 };
    let cube_at = |x: f32, y: f32| dynamic(cube(0.2), Vec3::new(x, y, 0.1));
    let turn = backstop::glam::Quat::from_rotation_z(0.4);
    let scene = [
        bouncy(floor_of_triangles()),
        cube_at(-0.4, 0.2),
        dynamic(ball.clone(), Vec3::new(-0.4, 0.62, 0.1)).with_velocity(down, Vec3::Z),
        cube_at(0.4, 0.32).with_rotation(turn).with_velocity(down, Vec3::new(3.0, 5.0, 7.0)),
        dynamic(ball, Vec3::new(0.1, 0.25, -0.4)).with_velocity(down, Vec3::Y),
    ]
    .map(bouncy);
    alone_and_shared(&settings(), &scene);
}

/// Nine boxes bear a slab, with friction at every point: more rows on one body than there are colours.
#[test]
fn a_slab_with_more_points_than_colours() {
    let mut scene = Vec::new();
    for i in 0..9 {
        let at = Vec3::new((i % 3) as f32 - 1.0, -0.5, (i / 3) as f32 - 1.0) * 1.2;
        scene.push(BodyDesc::kinematic().with_position(at).with_shape(ShapeDesc::new(cube(0.5))));
    }
    scene.push(dynamic(Geometry::cuboid(2.0, 0.1, 2.0), Vec3::NEG_Y * 0.001));
    let per_point = settings().with_friction_model(FrictionModel::Point);
    alone_and_shared(&per_point, &scene);
}

/// Joints by every kernel, beside contacts of the bodies that hang on them.
#[test]
fn joints_of_every_kind() {
    alone_and_shared_with(&settings(), &|world, at| {
        let mut bodies = common::joints_of_every_kind(world, at);
        bodies.extend(common::joints_without_colour(world, at + Vec3::Y * 3.0));
        // Under the balls of the trees that are alike.
        let plank = fixed(Geometry::cuboid(2.0, 0.1, 0.2), at + Vec3::new(1.75, -1.199, 0.0));
        bodies.push(world.add_body(&plank).unwrap());
        bodies
    });
}
