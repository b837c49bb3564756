//! Direction memory: a body leaves by the face through which it entered.
//!
//! Overlap is measured along the shortest way out. Once a soft spring lets a body in beyond the middle, the
//! other side is nearer, and the spring pushes the body through. So the direction of a contact is kept from
//! step to step as long as the two bodies touch; if detection reverses it, the depth is measured to the face
//! of entry.

use crate::problem::Law;
use crate::system::{Owner, System};
use backstop::BodyHandle;
use glam::DVec3;

/// State of two bodies that touch.
#[derive(Clone, Copy, Debug)]
struct Entry {
    bodies: [BodyHandle; 2],
    /// Direction of the first row, from the first body to the second.
    normal: DVec3,
    /// Deepest point [m].
    depth: f64,
    /// The length of the whole way through, known once detection reversed the direction [m].
    width: Option<f64>,
}

/// The directions in which bodies entered each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    entries: Vec<Entry>,
}

impl Memory {
    /// Restores the direction of contacts that detection reversed, and keeps the directions of this step.
    pub(crate) fn apply(&mut self, system: &mut System) {
        let mut now: Vec<Entry> = Vec::new();
        for i in 0..system.contacts {
            let law = system.laws[i];
            let (Owner::Contact(bodies), Some(gap)) = (law.owner, law.gap) else { continue };
            let normal = system.rows[law.first].linear[1];
            let last = self.entries.iter().find(|entry| entry.bodies == bodies).copied();
            let turned = last.filter(|last| last.normal.dot(normal) < -0.5 && gap < 0.0);
            let Some(last) = turned else {
                match now.iter_mut().find(|entry| entry.bodies == bodies) {
                    Some(entry) => entry.depth = entry.depth.max(-gap),
                    None => now.push(Entry { bodies, normal, depth: -gap, width: None }),
                }
                continue;
            };
            // Its progress since the previous step, by its speed.
            let speed = -system.speed(&system.rows[law.first], |body| body.start);
            let width = last.width.unwrap_or(last.depth - speed * system.dt - gap);
            system.laws[i].gap = Some(-(width + gap).max(0.0));
            let rows = if matches!(law.law, Law::Contact { .. }) { 1 } else { law.law.rows() };
            for row in &mut system.rows[law.first..law.first + rows] {
                row.linear = row.linear.map(|d| -d);
                row.angular = row.angular.map(|d| -d);
            }
            if now.iter().all(|entry| entry.bodies != bodies) {
                now.push(Entry { width: Some(width), ..last });
            }
        }
        self.entries = now;
    }
}
