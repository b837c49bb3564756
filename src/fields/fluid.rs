//! Water: what floats, sinks and drifts.

use super::region::{Reached, apply, shapes};
use crate::body::exp_map;
use crate::config::fields;
use crate::debug::convex;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::limits;
use crate::math::Quat;
use crate::shape::{Filter, Geometry, MassProperties};
use crate::world::{Aabb, World};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

fields! {
    /// A volume of fluid, as a box with a level top or with waves: buoyancy of the parts of shapes that are
    /// under its surface, and drag.
    ///
    /// ```
    /// use backstop::fields::Fluid;
    /// use backstop::glam::DVec3;
    /// use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
    ///
    /// # fn main() -> Result<(), backstop::Error> {
    /// let mut world = World::new(Settings::default())?;
    /// let wood = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(500.0);
    /// let wood = world.add_body(&BodyDesc::dynamic().with_shape(wood))?;
    /// let lake = Fluid::default().with_min([-50.0, -10.0, -50.0]).with_max([50.0, 0.0, 50.0]);
    /// for _ in 0..600 {
    ///     lake.apply_to(&mut world, 1.0 / 60.0)?;
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// // Half of it is under water.
    /// assert!(world.position(wood)?.y.abs() < 0.01);
    /// # Ok(())
    /// # }
    /// ```
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct Fluid {
        /// Low corner of the box [m].
        with_min(min: DVec3, into) = DVec3::splat(-1e4);
        /// High corner of the box [m]: its y is the surface.
        with_max(max: DVec3, into) = DVec3::new(1e4, 0.0, 1e4);
        /// Density [kg/m³].
        with_density(density: f32) = 1000.0, "fluid density" [0.0, limits::MAX_DENSITY] "in 0..=1e15";
        /// How fast what is under the surface takes the velocity of the fluid, if it is as dense [1/s].
        with_linear_drag(linear_drag: f32) = 1.0, "fluid drag" [0.0, limits::MAX_DAMPING] "in 0..=1e6";
        /// The same of its rotation, which dies down [1/s].
        with_angular_drag(angular_drag: f32) = 1.0, "fluid drag" [0.0, limits::MAX_DAMPING] "in 0..=1e6";
        /// Velocity of the fluid [m/s].
        with_flow(flow: Vec3, into) = Vec3::ZERO, "flow" [-limits::MAX_SPEED, limits::MAX_SPEED]
            "within 1e6 along each axis";
        /// If set, only shapes that would collide with one of this filter float.
        with_filter(filter: Option<Filter>, into) = None;
    }
}

// Guard: the slope of a surface is that between points this far apart [m].
const SLOPE_DISTANCE: f64 = 0.1;

impl Fluid {
    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        limits::position(self.min)?;
        limits::position(self.max)?;
        self.check_ranges()
    }

    /// Adds the forces of a fluid with a level surface for the next step, of `dt` [s]. Returns how many
    /// bodies it touches. Sleeping bodies are left alone.
    ///
    /// # Errors
    /// If a number is out of range, or the budget does not allow the tree of moving shapes
    /// ([`World::cast_ray`]).
    pub fn apply_to(&self, world: &mut World, dt: f32) -> Result<usize, Error> {
        let top = self.max.y;
        self.apply_with_waves(world, dt, |_, _| top)
    }

    /// The same with a surface at the height that a function gives of x and z, all in [m]. Each shape floats
    /// in the plane that touches the surface above or below the middle of it. The box has to contain the
    /// waves.
    ///
    /// # Errors
    /// As [`Fluid::apply_to`]; also if a height is not finite.
    pub fn apply_with_waves(
        &self,
        world: &mut World,
        dt: f32,
        height: impl Fn(f64, f64) -> f64,
    ) -> Result<usize, Error> {
        self.validate()?;
        limits::step(dt)?;
        let mut touched = Vec::new();
        for shape in shapes(world, Some(&Aabb { min: self.min, max: self.max }), self.filter)? {
            let (body, x, z) = (shape.body, shape.position.x, shape.position.z);
            let level = height(x, z);
            if !level.is_finite() {
                return Err(Error::NotFinite { what: "height of a fluid", value: level });
            }
            let rise = [height(x + SLOPE_DISTANCE, z) - level, height(x, z + SLOPE_DISTANCE) - level];
            let [along_x, along_z] = rise.map(|rise| (rise / SLOPE_DISTANCE) as f32);
            let normal = Vec3::new(-along_x, 1.0, -along_z).normalize();
            let under = Submerged::of(&in_the_middle(world, shape, dt)?, DVec3::new(x, level, z), normal);
            if under.volume <= 0.0 {
                continue;
            }
            touched.push((body, under));
        }
        let mut pushes = Vec::new();
        for shapes in touched.chunk_by(|a, b| a.0 == b.0) {
            self.push(world, shapes, dt, &mut pushes)?;
        }
        apply(world, &pushes)
    }

    /// The forces on the shapes of a body.
    fn push(
        &self,
        world: &World,
        shapes: &[(BodyHandle, Submerged)],
        dt: f32,
        pushes: &mut Vec<(BodyHandle, Vec3, DVec3, Vec3)>,
    ) -> Result<(), Error> {
        let body = shapes[0].0;
        let (mass, gravity) = (world.mass_properties(body)?, world.settings().gravity);
        let rotation: Quat = world.rotation(body)?.into();
        let spin = rotation.conjugate() * world.angular_velocity(body)?;
        let (centre, velocity) = (world.centre_of_mass(body)?, world.linear_velocity(body)?);
        let ahead = centre + (velocity * (0.5 * dt)).as_dvec3();
        let weight = gravity * (world.gravity_scale(body)? * mass.mass);

        let (mut lift, mut righting, mut area, mut rolls) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
        for (_, under) in shapes {
            let (arm, force) = ((under.middle - ahead).as_vec3(), -gravity * (under.volume * self.density));
            (lift, righting) = (lift + force, righting + arm.cross(force));
            let aside = arm.reject_from_normalized(under.normal);
            rolls += under.second_moment + under.area * aside.length_squared() + under.volume * arm.length();
            area += under.area;
        }
        // A small body bobs and rolls faster than steps can follow. It does so more slowly instead, as by the
        // trapezoidal rule, which has the same rest.
        let pull = 0.25 * gravity.length() * self.density * dt * dt;
        let bobs = 1.0 / (1.0 + pull * area / mass.mass);
        let rolls = 1.0 / (1.0 + pull * rolls / mass.inertia.diagonal().min_element());
        let net = (weight + lift) * bobs;
        pushes.push((body, net - weight, centre, righting * rolls));

        for (_, under) in shapes {
            // As if the drag acted during the step: a light body takes the velocity of the fluid at most.
            let share = under.volume * self.density / mass.mass;
            let slowed = |rate: f32| share * rate / (1.0 + share * rate * dt);
            let at = centre + (under.middle - ahead);
            let velocity = world.velocity_at(body, at)? - self.flow + net * (dt / mass.mass);
            let drag = -velocity * (mass.mass * slowed(self.linear_drag));
            let torque = rotation * (mass.inertia * spin) * -slowed(self.angular_drag);
            pushes.push((body, drag, at, torque));
        }
        Ok(())
    }
}

/// A shape as it is in the middle of the step: a force of where it was would feed a body that bobs and rolls.
fn in_the_middle<'a>(world: &World, shape: Reached<'a>, dt: f32) -> Result<Reached<'a>, Error> {
    let centre = world.centre_of_mass(shape.body)?;
    let way = world.linear_velocity(shape.body)? * (0.5 * dt);
    let turn = exp_map(world.angular_velocity(shape.body)? * (0.5 * dt));
    let arm = turn * (shape.position - centre).as_vec3();
    let position = centre + (arm + way).as_dvec3();
    Ok(Reached { position, rotation: (turn * shape.rotation).normalize(), ..shape })
}

/// The part of a convex shape below a plane.
struct Submerged {
    /// [m³]
    volume: f32,
    /// [m]
    middle: DVec3,
    /// Normal of the plane.
    normal: Vec3,
    /// Area of the cut [m²], and its second moment about the shape's origin [m⁴].
    area: f32,
    second_moment: f32,
}

impl Submerged {
    /// Exact for a ball. Else pyramids from a point of the plane over the triangles that show the shape, cut
    /// off at the plane: the face in the plane has a pyramid of no height. The volume of round shapes is
    /// corrected to that of the form. The cut is what the rest of the surface leaves open.
    fn of(shape: &Reached<'_>, on_plane: DVec3, normal: Vec3) -> Submerged {
        let from = (shape.position - on_plane).as_vec3();
        if let Geometry::Sphere { radius } = *shape.geometry {
            return Submerged::of_ball(shape, radius, from.dot(normal), normal);
        }
        let (vertices, triangles) = convex(shape.geometry);
        let vertices: Vec<Vec3> = vertices.into_iter().map(|vertex| shape.rotation * vertex + from).collect();
        let (mut part, mut whole, mut sum) = (0.0, 0.0, Vec3::ZERO);
        let (mut area, mut second_moment) = (0.0, 0.0);
        let pyramid = |[a, b, c]: [Vec3; 3]| a.dot(b.cross(c)) / 6.0;
        for corners in triangles {
            let corners = corners.map(|corner| vertices[corner as usize]);
            whole += pyramid(corners.map(|corner| corner - from));
            for piece in below(corners, normal).into_iter().flatten() {
                let volume = pyramid(piece);
                part += volume;
                sum += (piece[0] + piece[1] + piece[2]) * (0.25 * volume);
                let shadow = -0.5 * (piece[1] - piece[0]).cross(piece[2] - piece[0]).dot(normal);
                area += shadow;
                let [a, b, c] = piece.map(|corner| (corner - from).reject_from_normalized(normal));
                let squares = a.dot(a) + b.dot(b) + c.dot(c) + a.dot(b) + b.dot(c) + c.dot(a);
                second_moment += shadow * squares / 6.0;
            }
        }
        if part <= 0.0 || whole <= 0.0 {
            return Submerged { volume: 0.0, middle: shape.position, normal, area: 0.0, second_moment: 0.0 };
        }
        let volume = part * MassProperties::of(shape.geometry, 1.0).mass / whole;
        let (area, second_moment) = (area.max(0.0), second_moment.max(0.0));
        Submerged { volume, middle: on_plane + (sum / part).as_dvec3(), normal, area, second_moment }
    }

    /// The cap of a ball whose centre is at a height above the plane.
    fn of_ball(shape: &Reached<'_>, radius: f32, height: f32, normal: Vec3) -> Submerged {
        let depth = (radius - height).clamp(0.0, 2.0 * radius);
        let volume = PI * depth * depth * (radius - depth / 3.0);
        let square = depth * (2.0 * radius - depth);
        let below = 0.75 * (2.0 * radius - depth) * (2.0 * radius - depth) / (3.0 * radius - depth);
        let middle = shape.position - (normal * below).as_dvec3();
        let area = PI * square;
        Submerged { volume, middle, normal, area, second_moment: 0.5 * area * square }
    }
}

/// The parts of a triangle below a plane through the origin.
fn below(corners: [Vec3; 3], normal: Vec3) -> [Option<[Vec3; 3]>; 2] {
    let heights = corners.map(|corner| corner.dot(normal));
    let under = heights.map(|height| height < 0.0);
    let cut = |i: usize, j: usize| {
        let share = heights[i] / (heights[i] - heights[j]);
        corners[i] + (corners[j] - corners[i]) * share
    };
    match under.iter().filter(|&&under| under).count() {
        0 => [None, None],
        3 => [Some(corners), None],
        1 => {
            let i = under.iter().position(|&under| under).unwrap_or(0);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            [Some([corners[i], cut(i, j), cut(i, k)]), None]
        }
        _ => {
            let i = under.iter().position(|&under| !under).unwrap_or(0);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let (on_j, on_k) = (cut(j, i), cut(k, i));
            [Some([corners[j], corners[k], on_j]), Some([corners[k], on_k, on_j])]
        }
    }
}
