//! Water: what floats, sinks and drifts.

use super::region::{Reached, apply, shapes};
use crate::config::fields;
use crate::debug::convex;
use crate::error::Error;
use crate::limits;
use crate::shape::{Filter, MassProperties};
use crate::world::{Aabb, World};
use glam::{DVec3, Vec3};

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
        let gravity = world.settings().gravity;
        let mut pushes = Vec::new();
        for shape in shapes(world, Some(&Aabb { min: self.min, max: self.max }), self.filter)? {
            let (x, z) = (shape.position.x, shape.position.z);
            let level = height(x, z);
            if !level.is_finite() {
                return Err(Error::NotFinite { what: "height of a fluid", value: level });
            }
            let rise = [height(x + SLOPE_DISTANCE, z) - level, height(x, z + SLOPE_DISTANCE) - level];
            let [along_x, along_z] = rise.map(|rise| (rise / SLOPE_DISTANCE) as f32);
            let normal = Vec3::new(-along_x, 1.0, -along_z).normalize();
            // In the middle of the step: a force of where the shape was would feed a bobbing body.
            let ahead = (world.velocity_at(shape.body, shape.position)? * (0.5 * dt)).as_dvec3();
            let (volume, middle) = submerged(&shape, DVec3::new(x, level, z) - ahead, normal);
            if volume <= 0.0 {
                continue;
            }
            let body = world.mass_properties(shape.body)?;
            let displaced = volume * self.density;
            let lift = -gravity * displaced;
            // As if the drag acted during the step: a light body takes the velocity of the fluid at most.
            let share = displaced / body.mass;
            let slowed = |rate: f32| share * rate / (1.0 + share * rate * dt);
            let velocity = world.velocity_at(shape.body, middle)? - self.flow;
            let drag = -velocity * (body.mass * slowed(self.linear_drag));
            let rotation: crate::math::Quat = world.rotation(shape.body)?.into();
            let spin = rotation.conjugate() * world.angular_velocity(shape.body)?;
            let torque = rotation * (body.inertia * spin) * -slowed(self.angular_drag);
            pushes.push((shape.body, lift + drag, middle, torque));
        }
        apply(world, &pushes)
    }
}

/// Volume of a convex shape below a plane [m³], and the middle of that part [m].
///
/// Pyramids from a point of the plane over the triangles that show the shape, cut off at the plane: the face
/// in the plane has a pyramid of no height. The volume of round shapes is corrected to that of the form.
fn submerged(shape: &Reached<'_>, on_plane: DVec3, normal: Vec3) -> (f32, DVec3) {
    let (vertices, triangles) = convex(shape.geometry);
    let from = (shape.position - on_plane).as_vec3();
    let vertices: Vec<Vec3> = vertices.into_iter().map(|vertex| shape.rotation * vertex + from).collect();
    let (mut part, mut whole, mut sum) = (0.0, 0.0, Vec3::ZERO);
    let pyramid = |[a, b, c]: [Vec3; 3]| a.dot(b.cross(c)) / 6.0;
    for corners in triangles {
        let corners = corners.map(|corner| vertices[corner as usize]);
        whole += pyramid(corners.map(|corner| corner - from));
        for piece in below(corners, normal).into_iter().flatten() {
            let volume = pyramid(piece);
            part += volume;
            sum += (piece[0] + piece[1] + piece[2]) * (0.25 * volume);
        }
    }
    if part <= 0.0 || whole <= 0.0 {
        return (0.0, shape.position);
    }
    let exact = MassProperties::of(shape.geometry, 1.0).mass;
    (part * exact / whole, on_plane + (sum / part).as_dvec3())
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
