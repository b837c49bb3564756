//! `World::draw`: part by part, on request.

use super::{DebugDraw, DrawOptions, bounds, contacts, joints, shapes, solver};
use crate::world::World;

/// # Debug drawing
impl World {
    /// Draws what the options ask for. Call it between steps, as often as there is something to see.
    ///
    /// What moves is drawn where it is now; contacts, swept ways and colours are those of the last step.
    /// Changes nothing, and costs nothing but the time of the call.
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
