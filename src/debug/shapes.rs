//! Shapes by kind of body, their lines and triangles, and centres of mass.

use super::{Colour, DebugDraw, DrawOptions, Element, Ink, Region};
use crate::body::BodyKind;
use crate::broad_phase::aabb_of;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::math::Quat;
use crate::shape::Geometry;
use crate::world::World;
use glam::{DVec3, Mat3, Vec3};

/// A shape as it is drawn: its form, pose and colour.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct DrawnShape<'a> {
    /// Identifies the shape from call to call, for renderers that build a mesh once.
    pub shape: ShapeHandle,
    /// Its body.
    pub body: BodyHandle,
    /// Kind of its body.
    pub kind: BodyKind,
    /// Its form, in its own frame.
    pub geometry: &'a Geometry,
    /// Where its frame is in the world [m].
    pub position: DVec3,
    /// How its frame is turned.
    pub rotation: glam::Quat,
    /// The colour of its kind.
    pub ink: Ink,
    /// The region to draw, if not all.
    pub region: Option<Region>,
}

impl DrawnShape<'_> {
    /// Its [`wireframe`], in the world.
    pub fn wireframe(&self, line: &mut dyn FnMut(DVec3, DVec3)) {
        let place = |p: Vec3| self.position + (self.rotation * p).as_dvec3();
        wireframe(self.geometry, self.window(), &mut |from, to| line(place(from), place(to)));
    }

    /// Its [`triangles`], in the world.
    pub fn triangles(&self, triangle: &mut dyn FnMut([DVec3; 3])) {
        let place = |p: Vec3| self.position + (self.rotation * p).as_dvec3();
        triangles(self.geometry, self.window(), &mut |corners| triangle(corners.map(place)));
    }

    /// The box, in the frame of the shape, that holds the region: low and high corner [m].
    pub fn window(&self) -> Option<(Vec3, Vec3)> {
        let region = self.region?;
        let back = self.rotation.conjugate();
        let centre = back * ((region.min + region.max) * 0.5 - self.position).as_vec3();
        let half = ((region.max - region.min) * 0.5).as_vec3();
        let turn = Mat3::from_quat(back);
        let half = turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
        Some((centre - half, centre + half))
    }
}

/// The triangles that show a shape, in its own frame [m], counter-clockwise from outside; those of meshes as
/// they were given.
///
/// `window`: as for [`wireframe`].
pub fn triangles(geometry: &Geometry, window: Option<(Vec3, Vec3)>, triangle: &mut dyn FnMut([Vec3; 3])) {
    geometry.triangles(window, triangle);
}

/// Vertices and triangles of a convex shape; none of any other.
pub fn convex(geometry: &Geometry) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    geometry.solid()
}

/// The lines that show a shape, in its own frame [m]. Their ends are on its surface; between them a line is a
/// chord of a round surface.
///
/// `window`: low and high corner of the box that is wanted, in the same frame. A mesh or height field
/// shows only the edges of triangles whose boxes meet the window, an edge once for each of them; a plane,
/// which has no end, the part in the window, or 20 m around its origin if there is none. All other shapes are
/// drawn as a whole.
pub fn wireframe(geometry: &Geometry, window: Option<(Vec3, Vec3)>, line: &mut dyn FnMut(Vec3, Vec3)) {
    geometry.lines(window, line);
}

/// In which colour a body is drawn: by its kind, that it sleeps, or its island.
fn colour_of(world: &World, options: &DrawOptions, islands: &[u32], body: usize) -> Colour {
    if let Some(&island) = islands.get(body).filter(|&&island| island != u32::MAX) {
        return Colour::nth(island as usize);
    }
    match world.bodies.kind[body] {
        BodyKind::Dynamic if world.bodies.asleep().contains(&body) => options.palette.sleeping_body,
        BodyKind::Static => options.palette.static_body,
        BodyKind::Kinematic => options.palette.kinematic_body,
        BodyKind::Dynamic => options.palette.dynamic_body,
    }
}

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let bodies = &world.bodies;
    let islands = if options.islands { world.islands() } else { Vec::new() };
    for (index, body) in world.bodies().enumerate() {
        let ink = Ink { element: Element::Shape, colour: colour_of(world, options, &islands, index) };
        for &c in bodies.colliders[index].as_slice() {
            let collider = &world.colliders.all[c as usize];
            if let Some(region) = &options.region {
                let pose = &bodies.pose[index];
                let bounds = aabb_of(collider, pose.position, pose.rotation);
                if !region.meets(bounds.min.as_dvec3(), bounds.max.as_dvec3()) {
                    continue;
                }
            }
            let pose = world.collider_pose(c);
            out.shape(&DrawnShape {
                shape: world.shape_handle(c),
                body,
                kind: bodies.kind[index],
                geometry: &collider.geometry,
                position: pose.position,
                rotation: pose.rotation.into(),
                ink,
                region: options.region,
            });
        }
    }
}

pub(super) fn draw_centres(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let ink = Ink { element: Element::CentreOfMass, colour: options.palette.centre_of_mass };
    for (index, pose) in world.bodies.pose.iter().enumerate() {
        if options.region.is_some_and(|region| !region.holds(pose.position)) {
            continue;
        }
        out.point(pose.position, ink);
        if world.bodies.kind[index] == BodyKind::Dynamic {
            draw_axes(pose.position, pose.rotation, Element::PrincipalAxis, options, out);
        }
    }
}

/// Three axes in their colours.
pub(super) fn draw_axes(
    at: DVec3,
    rotation: Quat,
    element: Element,
    options: &DrawOptions,
    out: &mut dyn DebugDraw,
) {
    for (axis, colour) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().zip(options.palette.axes) {
        let end = at + (rotation * axis * options.length).as_dvec3();
        out.line(at, end, Ink { element, colour });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::MassProperties;

    /// Volume by the divergence theorem: positive only if all triangles face outwards and leave no hole.
    fn volume(geometry: &Geometry) -> f32 {
        let mut sum = 0.0;
        triangles(geometry, None, &mut |[a, b, c]| sum += a.dot(b.cross(c)) / 6.0);
        sum
    }

    #[test]
    fn visible_volumes_are_nearly_those_of_the_shapes() {
        for geometry in [
            Geometry::Sphere { radius: 0.7 },
            Geometry::capsule(0.5, 0.3),
            Geometry::Capsule { half_height: 0.5, radius_bottom: 0.5, radius_top: 0.2 },
            Geometry::Capsule { half_height: 0.1, radius_bottom: 0.2, radius_top: 0.5 },
            Geometry::Capsule { half_height: 0.0, radius_bottom: 0.2, radius_top: 0.5 },
            Geometry::cuboid(0.1, 0.2, 0.3),
            Geometry::cylinder(0.4, 0.3),
            Geometry::Cylinder { half_height: 0.4, radius_bottom: 0.3, radius_top: 0.0 },
        ] {
            let exact = MassProperties::of(&geometry, 1.0).mass;
            let ratio = volume(&geometry) / exact;
            assert!(ratio > 0.95 && ratio < 1.0001, "{geometry:?}: {ratio}");
        }
    }
}
