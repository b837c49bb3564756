//! Which couplings and motors make a block.

use super::Owner;
use super::block::MAX_ROWS;
use crate::config::RowGroup;
use crate::constraint::schedule::order::Place;
use crate::joint::{Coupling, Joints, RowKind};

/// The blocks, in the order in which they are solved, and the motors that are in them.
#[derive(Default)]
pub(in crate::constraint::joint) struct Plan {
    pub(in crate::constraint::joint) blocks: Vec<(Place, Vec<Owner>)>,
    /// By the index of a row; empty if there are no couplings.
    drives: Vec<bool>,
}

/// Input of a plan.
pub(in crate::constraint::joint) struct PlanInput<'a> {
    pub(in crate::constraint::joint) joints: &'a Joints,
    /// Where the rows of a joint are solved; none if they have no effect.
    pub(in crate::constraint::joint) place_of: &'a dyn Fn(u32, RowGroup) -> Option<Place>,
    /// Whether a body can be pushed, by its slot.
    pub(in crate::constraint::joint) is_pushed: &'a dyn Fn(u32) -> bool,
}

/// A row, and the first row of its block.
struct Member {
    place: Place,
    root: usize,
    owner: Owner,
}

impl Plan {
    pub(in crate::constraint::joint) fn new(input: &PlanInput<'_>) -> Plan {
        let PlanInput { joints, place_of, is_pushed } = *input;
        if joints.couplings.count == 0 {
            return Plan::default();
        }
        let mut plan = Plan { blocks: Vec::new(), drives: vec![false; joints.rows.len()] };
        let mut members: Vec<Member> = Vec::new();
        for (slot, one) in joints.couplings.live() {
            let group = if one.is_equality() { RowGroup::Joints } else { RowGroup::JointLimits };
            let [a, b] = one.joints().map(|joint| place_of(joint, group));
            let mut bodies = one.joints().into_iter().flat_map(|joint| joints.all[joint as usize].bodies);
            if let (Some(a), Some(b), true) = (a, b, bodies.any(is_pushed)) {
                let root = members.len();
                members.push(Member { place: a.max(b), root, owner: Owner::Coupling(slot) });
            }
        }
        join(&mut members, joints, is_pushed);
        plan.add_drives(&mut members, joints);
        let place = |root: usize| members[root].place;
        // A block is solved where the last of its rows is.
        let mut places: Vec<Place> = (0..members.len()).map(place).collect();
        for member in &members {
            places[member.root] = places[member.root].max(member.place);
        }
        members.sort_by_key(|member| (places[member.root], member.root, member.owner));
        for block in members.chunk_by(|a, b| a.root == b.root) {
            for piece in block.chunks(MAX_ROWS) {
                let owners = piece.iter().map(|member| member.owner).collect();
                plan.blocks.push((places[block[0].root], owners));
            }
        }
        plan
    }

    /// Whether a row is a motor that goes along with a coupling.
    pub(in crate::constraint::joint) fn has_drive(&self, row: u32) -> bool {
        self.drives.get(row as usize).is_some_and(|&is| is)
    }

    /// Adds the motors of motions that are kept at one value to the block that keeps them.
    fn add_drives(&mut self, members: &mut Vec<Member>, joints: &Joints) {
        for i in 0..members.len() {
            let Member { place, root, owner } = members[i];
            let Owner::Coupling(slot) = owner else { continue };
            let coupling = &joints.couplings.all[slot as usize];
            if !coupling.is_equality() {
                continue;
            }
            for term in coupling.terms {
                for row in joints.row_range(term.joint) {
                    let one = &joints.rows[row];
                    let same = (one.motion, one.axes) == (term.motion, term.axes);
                    if same && matches!(one.kind, RowKind::Motor { .. }) && !self.drives[row] {
                        self.drives[row] = true;
                        members.push(Member { place, root, owner: Owner::Motor(row as u32) });
                    }
                }
            }
        }
    }
}

/// Joins the couplings that keep one value and share a body.
fn join(members: &mut [Member], joints: &Joints, is_pushed: &dyn Fn(u32) -> bool) {
    let mut first: Vec<(u32, usize)> = Vec::new();
    for (i, member) in members.iter().enumerate() {
        let Owner::Coupling(slot) = member.owner else { continue };
        let coupling: &Coupling = &joints.couplings.all[slot as usize];
        if coupling.is_equality() {
            let bodies = coupling.joints().into_iter().flat_map(|j| joints.all[j as usize].bodies);
            first.extend(bodies.filter(|&body| is_pushed(body)).map(|body| (body, i)));
        }
    }
    first.sort_unstable();
    for pair in first.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let [a, b] = [pair[0].1, pair[1].1].map(|i| root(members, i));
        members[a.max(b)].root = a.min(b);
    }
    for i in 0..members.len() {
        members[i].root = root(members, i);
    }
}

fn root(members: &[Member], mut i: usize) -> usize {
    while members[i].root != i {
        i = members[i].root;
    }
    i
}
