//! Shared by the tests: floors of three kinds, worlds out of scenes, and a little mathematics.
#![allow(dead_code, reason = "each test uses a part of it")]

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Frame, Geometry, JointDesc, Limit, Material, Motion, Motor, Settings,
    ShapeDesc, Spring, TriangleMesh, World,
};
use backstop_scene::{Scene, builtin};
use std::sync::Arc;

pub(crate) mod data;
pub(crate) mod piles;
#[path = "../../src/random.rs"]
pub(crate) mod random;
pub(crate) mod snapshots;

/// Standard gravity of every world here [m/s²].
pub(crate) const G: f64 = 9.81;

/// A static surface at y = 0.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Floor {
    Box,
    Plane,
    /// Flat, of 800 triangles of 1 m.
    Mesh,
}

impl Floor {
    pub(crate) const ALL: [Floor; 3] = [Floor::Box, Floor::Plane, Floor::Mesh];

    pub(crate) fn desc(self, material: Material) -> BodyDesc {
        let (geometry, y) = match self {
            Floor::Box => (Geometry::cuboid(20.0, 1.0, 20.0), -1.0),
            Floor::Plane => (Geometry::Plane, 0.0),
            Floor::Mesh => (flat_mesh(10, 1.0), 0.0),
        };
        let mut shape = ShapeDesc::new(geometry);
        (shape.material, shape.position) = (material, Vec3::new(0.0, y, 0.0));
        BodyDesc::fixed().with_shape(shape)
    }
}

/// A flat mesh of squares of `cell` metres, `half` of them to each side of the origin.
pub(crate) fn flat_mesh(half: i32, cell: f32) -> Geometry {
    let n = (2 * half + 1) as u32;
    let vertices = (0..n * n)
        .map(|i| Vec3::new((i % n) as f32 - half as f32, 0.0, (i / n) as f32 - half as f32) * cell)
        .collect();
    let triangles = (0..(n - 1) * (n - 1))
        .flat_map(|i| {
            let corner = i / (n - 1) * n + i % (n - 1);
            [[corner, corner + n, corner + 1], [corner + 1, corner + n, corner + n + 1]]
        })
        .collect();
    Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
}

pub(crate) fn shape(geometry: Geometry, material: Material) -> ShapeDesc {
    let mut shape = ShapeDesc::new(geometry);
    shape.material = material;
    shape
}

pub(crate) fn dynamic(geometry: Geometry, material: Material, at: Vec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(shape(geometry, material))
}

/// A world with the scene in it.
pub(crate) fn world_of(scene: &Scene, settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings.with_gravity(scene.gravity)).unwrap();
    let bodies = scene.add_to(&mut world).unwrap().bodies;
    (world, bodies)
}

/// Whether tests run over all of their cases, with `WIDE=1` (`scripts/reliability wide`), or over as many as
/// one waits for.
pub(crate) fn wide() -> bool {
    std::env::var_os("WIDE").is_some()
}

pub(crate) fn steps(world: &mut World, count: u32, dt: f32) {
    for _ in 0..count {
        world.step(dt).unwrap();
    }
}

/// A rotation about an axis by degrees.
pub(crate) fn turned(axis: Vec3, degrees: f32) -> Quat {
    Quat::from_axis_angle(axis, degrees.to_radians())
}

/// Everything that a body has is a number.
pub(crate) fn all_finite(world: &World) -> bool {
    world.bodies().all(|b| {
        world.position(b).unwrap().is_finite()
            && world.rotation(b).unwrap().is_finite()
            && world.linear_velocity(b).unwrap().is_finite()
            && world.angular_velocity(b).unwrap().is_finite()
    })
}

/// Horizontal length.
pub(crate) fn sideways(v: DVec3) -> f64 {
    v.x.hypot(v.z)
}

/// Balls that hang on a post, and on each other.
struct Hung<'a> {
    world: &'a mut World,
    post: Vec3,
    bodies: Vec<BodyHandle>,
}

impl Hung<'_> {
    fn balls<const N: usize>(&mut self, places: [[f32; 2]; N]) -> [usize; N] {
        places.map(|[x, y]| {
            let at = self.post + Vec3::new(x, y, 0.0);
            let ball = dynamic(Geometry::Sphere { radius: 0.1 }, Material::default(), at);
            // Each starts with a push of its own.
            let ball = ball.with_velocity(Vec3::new(0.3 * y, 0.2, 0.5 - 0.1 * x), Vec3::ZERO);
            self.bodies.push(self.world.add_body(&ball).unwrap());
            self.bodies.len() - 1
        })
    }
    /// Joins two bodies in the middle between them.
    fn join(&mut self, a: usize, b: usize, make: impl Fn([BodyHandle; 2], [Frame; 2]) -> JointDesc) {
        let bodies = [self.bodies[a], self.bodies[b]];
        let [p, q] = bodies.map(|body| self.world.position(body).unwrap());
        let frames = self.world.frames_at(bodies, 0.5 * (p + q), Quat::IDENTITY).unwrap();
        self.world.add_joint(&make(bodies, frames)).unwrap();
    }
}

/// Every kind of joint, by every kernel that there is for them: eight trees alike and one unlike, a loop of
/// points with a hinge and a weld, and single rows. Returns the bodies, the post first.
pub(crate) fn joints_of_every_kind(world: &mut World, post: Vec3) -> Vec<BodyHandle> {
    use {Axes::*, Axis::*, Motion::*};
    let bodies = vec![world.add_body(&BodyDesc::fixed().with_position(post)).unwrap()];
    let mut hung = Hung { world, post, bodies };
    const POST: usize = 0;
    for i in 0..8 {
        let x = 0.5 * i as f32;
        let [a, b] = hung.balls([[x, -0.5], [x, -1.0]]);
        hung.join(POST, a, JointDesc::ball);
        hung.join(a, b, JointDesc::hinge);
    }
    let [a, b, c] = hung.balls([[-0.5, -0.5], [-0.5, -1.0], [-0.9, -1.0]]);
    hung.join(POST, a, JointDesc::fixed);
    hung.join(a, b, |b, f| JointDesc::hinge(b, f).with_motor(Motor::velocity(Angular, X, 2.0, 30.0)));
    hung.join(b, c, |b, f| {
        let cone = Limit::new(Angular, Perpendicular(X), 0.0, 0.4);
        let ball = JointDesc::ball(b, f).with_limit(cone).with_limit(Limit::new(Angular, One(X), -0.3, 0.2));
        ball.with_motor(Motor::friction(Angular, Y, 0.1))
    });
    let [a, b, c] = hung.balls([[-1.5, -0.5], [-1.8, -1.0], [-1.3, -1.0]]);
    hung.join(POST, a, |b, f| JointDesc::distance(b, f, 0.0, 0.3));
    hung.join(a, b, JointDesc::hinge);
    hung.join(b, c, JointDesc::fixed);
    hung.join(c, a, JointDesc::ball);
    let [a, b, c] = hung.balls([[-2.5, -0.5], [-2.5, -1.0], [-2.9, -1.0]]);
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.5 };
    hung.join(POST, a, |b, f| {
        let slider = JointDesc::slider(b, f).with_limit(Limit::new(Linear, One(X), -0.1, 0.2));
        slider.with_motor(Motor::velocity(Linear, X, 1.0, 40.0))
    });
    hung.join(a, b, |b, f| JointDesc::wheel(b, f, 0.1, spring));
    hung.join(b, c, |b, f| {
        let yielding = Limit::new(Linear, All, 0.0, 0.1).with_spring(spring);
        JointDesc::new(b, f).with_limit(yielding).with_motor(Motor::position(Angular, Z, 0.2, spring))
    });
    hung.bodies
}

/// A ball on so many welds, hinges and motors that some of each find no colour, of which there are 31.
/// Returns the bodies, its support first.
pub(crate) fn joints_without_colour(world: &mut World, post: Vec3) -> Vec<BodyHandle> {
    let bodies = vec![world.add_body(&BodyDesc::fixed().with_position(post)).unwrap()];
    let mut hung = Hung { world, post, bodies };
    let [ball] = hung.balls([[0.0, -0.5]]);
    for _ in 0..40 {
        hung.join(0, ball, JointDesc::fixed);
        let motor = Motor::velocity(Motion::Angular, Axis::X, 1.0, 1.0);
        hung.join(0, ball, |b, f| JointDesc::hinge(b, f).with_motor(motor));
    }
    hung.bodies
}

/// Three hundred bodies of every shape fall into a box.
pub(crate) fn small_pile() -> Scene {
    let mut scene = builtin::pile();
    // The floor, its four walls, and three hundred of the bodies, in the middle of the box.
    scene.bodies.truncate(305);
    scene
}

/// A thousand fast bodies that bounce off a mesh and off each other.
pub(crate) fn crossfire() -> Scene {
    let mut scene = builtin::bullets(false);
    for body in &mut scene.bodies {
        body.desc.shapes.iter_mut().for_each(|s| s.material.restitution = 0.5);
    }
    scene
}
