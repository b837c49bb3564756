//! The graph that the solver coloured: contacts as lines between bodies.

use super::{Colour, DebugDraw, DrawOptions, Element, Ink};
use crate::constraint::{Batch, Part};
use crate::lanes::Lanes;
use crate::world::World;
use glam::DVec3;

/// Of contacts that found no colour.
const NO_COLOUR: Colour = Colour::new(255, 255, 255);

pub(super) fn draw(world: &World, options: &DrawOptions, out: &mut dyn DebugDraw) {
    let rows = &world.buffers.rows;
    for (n, stage) in rows.stages.iter().enumerate() {
        let colour = if stage.serial { NO_COLOUR } else { Colour::nth(n) };
        let ink = Ink { element: Element::SolverColour, colour };
        let mut part = |part: Part| draw_part(world, part, ink, options, out);
        for batch in &rows.schedule[stage.start as usize..stage.end as usize] {
            let i = batch.index as usize;
            match batch.points {
                1 => each(&rows.p1[i], &mut part),
                2 => each(&rows.p2[i], &mut part),
                3 => each(&rows.p3[i], &mut part),
                4 => each(&rows.p4[i], &mut part),
                _ => each(&rows.single[i], &mut part),
            }
        }
    }
}

fn each<L: Lanes, const P: usize>(batch: &Batch<L, P>, f: &mut dyn FnMut(Part)) {
    batch.contact[..L::N].iter().filter(|part| **part != Part::NONE).for_each(|part| f(*part));
}

fn draw_part(world: &World, part: Part, ink: Ink, options: &DrawOptions, out: &mut dyn DebugDraw) {
    // A contact that is gone, because a body was removed since the step, has no points.
    let Some(contact) = world.contacts.all.get(part.slot()).filter(|contact| contact.count > 0) else {
        return;
    };
    let (first, count) = part.range(contact);
    let points = &contact.points[first..first + count];
    let a = world.collider_pose(contact.a);
    let middle = points.iter().map(|p| p.position).sum::<glam::Vec3>() / count as f32;
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
