//! What the page draws of a world: meshes, each once, and where they are.

use backstop::debug::{self, DebugDraw, DrawOptions, DrawnShape, Element, Ink};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, BodyKind, Geometry, GeometryKey, JointHandle, ShapeHandle, World};
use std::collections::HashMap;

/// Numbers of a pose: position [m], rotation, 1 if the body is asleep.
const POSE: usize = 8;

/// The shapes of a world, in an order that stays while it is stepped.
#[derive(Default)]
pub(crate) struct Drawing {
    /// Corners of triangles, three numbers each.
    pub(crate) meshes: Vec<Vec<f32>>,
    /// Mesh and tone of each shape.
    pub(crate) instances: Vec<[u32; 2]>,
    /// Pairs of shapes whose bodies are joined.
    pub(crate) links: Vec<[u32; 2]>,
    places: HashMap<ShapeHandle, usize>,
    made: HashMap<GeometryKey, u32>,
}

impl Drawing {
    pub(crate) fn of(world: &World, joints: &[JointHandle]) -> Drawing {
        let mut drawing = Drawing::default();
        world.draw(&shapes_alone(), &mut drawing);
        let places = &drawing.places;
        let place = |body: BodyHandle| {
            let shape = world.shapes(body).ok()?.next()?;
            places.get(&shape).map(|&place| place as u32)
        };
        let link = |&joint: &JointHandle| {
            let [a, b] = world.joint_bodies(joint).ok()?;
            Some([place(a)?, place(b)?])
        };
        drawing.links = joints.iter().filter_map(link).collect();
        drawing
    }

    /// Where all shapes are.
    pub(crate) fn poses(&self, world: &World, into: &mut Vec<f32>) {
        into.resize(POSE * self.instances.len(), 0.0);
        world.draw(&shapes_alone(), &mut Poses { world, places: &self.places, into });
    }

    fn mesh(&mut self, geometry: &Geometry) -> u32 {
        // Shared geometry is drawn once; the world keeps it alive, so its key is its own.
        *self.made.entry(geometry.key()).or_insert_with(|| {
            let mut corners = Vec::new();
            debug::triangles(geometry, None, &mut |triangle| {
                corners.extend(triangle.iter().flat_map(Vec3::to_array));
            });
            self.meshes.push(corners);
            self.meshes.len() as u32 - 1
        })
    }
}

impl DebugDraw for Drawing {
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        let mesh = self.mesh(shape.geometry);
        self.places.insert(shape.shape, self.instances.len());
        self.instances.push([mesh, tone(shape.kind, shape.geometry)]);
    }
}

/// The colour of a shape, as an index into the renderer's list.
fn tone(kind: BodyKind, geometry: &Geometry) -> u32 {
    match (kind, geometry) {
        _ if !geometry.is_convex() => 7,
        (BodyKind::Static, _) => 6,
        (BodyKind::Kinematic, _) => 5,
        (_, Geometry::Sphere { .. }) => 0,
        (_, Geometry::Capsule { .. }) => 1,
        (_, Geometry::Box { .. }) => 2,
        (_, Geometry::Cylinder { .. }) => 3,
        _ => 4,
    }
}

fn shapes_alone() -> DrawOptions {
    DrawOptions { shapes: true, ..DrawOptions::nothing() }
}

struct Poses<'a> {
    world: &'a World,
    places: &'a HashMap<ShapeHandle, usize>,
    into: &'a mut [f32],
}

impl DebugDraw for Poses<'_> {
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        let Some(&place) = self.places.get(&shape.shape) else { return };
        let (at, turn): (Vec3, Quat) = (shape.position.as_vec3(), shape.rotation);
        let asleep = f32::from(u8::from(self.world.is_sleeping(shape.body).unwrap_or(false)));
        let pose = [at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w, asleep];
        self.into[POSE * place..][..POSE].copy_from_slice(&pose);
    }
}

/// Points of contact: position [m], and 0 for a real one, 1 for a potential one, 2 for a ghost.
pub(crate) struct Points<'a>(pub(crate) &'a mut Vec<f32>);

impl Points<'_> {
    pub(crate) fn draw(&mut self, world: &World) {
        world.draw(&DrawOptions { contacts: true, ..DrawOptions::nothing() }, self);
    }
}

impl DebugDraw for Points<'_> {
    fn shape(&mut self, _: &DrawnShape<'_>) {}

    fn point(&mut self, at: DVec3, ink: Ink) {
        let kind = match ink.element {
            Element::RealPoint => 0.0,
            Element::PotentialPoint => 1.0,
            _ => 2.0,
        };
        let at = at.as_vec3();
        self.0.extend([at.x, at.y, at.z, kind]);
    }
}
