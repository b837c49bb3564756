//! The part of a hull's face that is over a triangle.
//!
//! The face is clipped to the triangle's three sides by values at its corners: the distances beyond each side
//! and over the plane, which are linear along an edge.

use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::cut_off;
use crate::narrow_phase::convex::polytope::Polytope;
use crate::narrow_phase::mesh::patch::Touch;
use crate::narrow_phase::mesh::triangle_contact::key;
use glam::Vec3;

/// Most corners of a face that are used; if it has more, evenly chosen ones.
const MAX_CORNERS: usize = 12;
/// Every side cuts off at least one corner and adds two.
const ROOM: usize = MAX_CORNERS + 4;

/// A corner of the polygon.
#[derive(Clone, Copy, Default)]
struct Corner {
    at: Vec3,
    height: f32,
    beyond: [f32; 3],
    /// Name of the edge that starts here, and of the corner.
    edge: u32,
    feature: u32,
}

/// Edges with these names are the triangle's sides.
const SIDE: u32 = 0x100;

/// Adds the points of a hull's most level face that are over a triangle and nearer than the margin, along the
/// triangle's normal.
pub(crate) fn over_face(p: &Polytope, touch: &Touch, margin: f32, size: f32, points: &mut Vec<RawPoint>) {
    let front = touch.front;
    let offset = front.dot(touch.corners[0]);
    let face = p.face(p.face_towards(-front));
    let side = |i: usize| {
        let out = touch.outward(i);
        let out = out / out.length();
        // Points that are outside by less than this count as inside.
        (out, out.dot(touch.corners[i]) + 1e-4 * size)
    };
    let sides = [side(0), side(1), side(2)];
    let mut polygon = [Corner::default(); ROOM];
    let mut count = face.len().min(MAX_CORNERS);
    let mut outside = [false; 3];
    let mut least = f32::MAX;
    for (i, corner) in polygon[..count].iter_mut().enumerate() {
        let v = face[if face.len() > MAX_CORNERS { i * face.len() / MAX_CORNERS } else { i }];
        let at = p.vertices[usize::from(v)];
        let beyond = |k: usize| sides[k].0.dot(at) - sides[k].1;
        let name = u32::from(v);
        *corner = Corner {
            at,
            height: front.dot(at) - offset,
            beyond: [beyond(0), beyond(1), beyond(2)],
            edge: name,
            feature: name,
        };
        least = least.min(corner.height);
        for (outside, beyond) in outside.iter_mut().zip(corner.beyond) {
            *outside |= beyond > 0.0;
        }
    }
    if least > margin {
        return;
    }
    for k in (0..3).filter(|&k| outside[k]) {
        let crossing = |last: &Corner, this: &Corner, t: f32, leaves: bool| {
            let mix = |a: f32, b: f32| a + (b - a) * t;
            let beyond = |i: usize| mix(last.beyond[i], this.beyond[i]);
            Corner {
                at: last.at + (this.at - last.at) * t,
                height: mix(last.height, this.height),
                beyond: [beyond(0), beyond(1), beyond(2)],
                edge: if leaves { SIDE + k as u32 } else { last.edge },
                feature: (last.edge + 1) << 2 | k as u32,
            }
        };
        count = cut_off(&mut polygon, count, |c| c.beyond[k], crossing);
    }
    for c in polygon[..count].iter().filter(|c| c.height <= margin) {
        let position = c.at - front * (0.5 * c.height);
        let name = c.feature ^ c.feature >> 8 ^ (c.feature >> 2) << 5;
        points.push(RawPoint { position, separation: c.height, key: key(touch.index, name) });
    }
}
