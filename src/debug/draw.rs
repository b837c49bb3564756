//! `World::draw`: part by part, on request.

use super::{DebugDraw, DrawOptions, bounds, contacts, joints, shapes, solver};
use crate::world::World;

/// # Debug drawing
impl World {
    /// Draws according to the options. Call it between steps, as often as needed.
    ///
    /// Bodies are drawn where they are now; contacts, swept paths and colours are those of the last step.
    /// Changes nothing, and costs nothing but the time of the call.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// /// Counts the lines that would be drawn.
    /// #[derive(Default)]
    /// struct Counted(usize);
    /// impl debug::DebugDraw for Counted {
    ///     fn shape(&mut self, _: &debug::DrawnShape<'_>) {
    ///         self.0 += 1;
    ///     }
    /// }
    /// let mut counted = Counted::default();
    /// world.draw(&debug::DrawOptions::default(), &mut counted);
    /// assert_eq!(counted.0, 2);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn draw(&self, options: &DrawOptions, out: &mut dyn DebugDraw) {
        if options.shapes {
            shapes::draw(self, options, out);
        }
        if options.aabbs || options.fat_aabbs || options.motion {
            bounds::draw(self, options, out);
        }
        if options.contacts || options.normals || options.impulses {
            contacts::draw(self, options, out);
        }
        if options.solver_colours {
            solver::draw(self, options, out);
        }
        if options.joints {
            joints::draw(self, options, out);
        }
        if options.centres {
            shapes::draw_centres(self, options, out);
        }
    }
}
