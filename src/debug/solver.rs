//! The graph that the solver coloured: contacts as lines between bodies.

use super::{Colour, DebugDraw, DrawOptions, Element, Ink};
use crate::constraint::Part;
use crate::lanes::ones;
use crate::world::World;
use glam::DVec3;

/// Colour of contacts without a solver colour.
const NO_COLOUR: Colour = Colour::new(255, 255, 255);

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let (rows, arranged) = (&world.buffers.rows, &world.buffers.prepare);
    for (n, stage) in rows.stages.iter().enumerate() {
        let colour = if stage.serial { NO_COLOUR } else { Colour::nth(n) };
        let ink = Ink { element: Element::SolverColour, colour };
        let mut part = |part: Part| draw_part(world, part, ink, options, out);
        for &(first, count) in &arranged.ranges[stage.start as usize..stage.end as usize] {
            arranged.sorted[first as usize..(first + count) as usize].iter().for_each(|&of| part(of));
        }
    }
}

fn draw_part(world: &World, part: Part, ink: Ink, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let Some(contact) = world.contacts.get(part.slot()) else { return };
    // A contact that was removed with a body since the step has no points, and one that a call found anew may
    // have fewer.
    let points: Vec<_> = ones(part.points(contact)).filter_map(|i| contact.points().get(i)).collect();
    if points.is_empty() {
        return;
    }
    let a = world.collider_pose(contact.a);
    let middle = points.iter().map(|p| p.position).sum::<glam::Vec3>() / points.len() as f32;
    let at: DVec3 = a.position + (a.rotation * middle).as_dvec3();
    let centre = |collider: u32| {
        let body = world.colliders.all[collider as usize].body as usize;
        (body < world.bodies.movers()).then(|| world.bodies.pose[body].position)
    };
    if options.region.is_some_and(|region| !region.holds(at)) {
        return;
    }
    let [from, to] = [contact.a, contact.b].map(|c| centre(c).unwrap_or(at));
    out.line(from, to, ink);
}
