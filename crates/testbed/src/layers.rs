//! What is drawn over the shapes: points, lines, and other colours of shapes.

use crate::command::Layer;
use crate::drawing::Drawing;
use backstop::debug::{Colour, DebugDraw, DrawOptions, DrawnShape, Element, Ink};
use backstop::glam::DVec3;
use backstop::{BodyHandle, BodyKind, World};
use std::collections::HashMap;

/// Colours of bodies that are asleep and awake.
const ASLEEP: Colour = Colour::new(110, 118, 130);
const AWAKE: Colour = Colour::new(240, 160, 60);
/// Where no tint is.
const NONE: f32 = -1.0;

/// All of it, as numbers.
#[derive(Default)]
pub(crate) struct Layers {
    /// Position relative to the origin [m], and kind: 0 real, 1 potential, 2 ghost, 3 centre of mass.
    pub(crate) points: Vec<f32>,
    /// Position and tone of each end.
    pub(crate) lines: Vec<f32>,
    /// Tone of each shape, or -1.
    pub(crate) tints: Vec<f32>,
    /// The colours of lines and tints.
    pub(crate) tones: Vec<Colour>,
    index: HashMap<Colour, usize>,
    origin: DVec3,
}

impl Layers {
    /// These layers of a world.
    pub(crate) fn of(world: &World, drawing: &Drawing, layers: &[Layer]) -> Layers {
        let mut all = Layers { origin: world.origin(), ..Layers::default() };
        if layers.is_empty() {
            return all;
        }
        let has = |layer: Layer| layers.contains(&layer);
        let options = DrawOptions {
            contacts: has(Layer::Contacts),
            normals: has(Layer::Normals),
            impulses: has(Layer::Impulses),
            joints: has(Layer::Joints),
            aabbs: has(Layer::Aabbs),
            fat_aabbs: has(Layer::FatAabbs),
            motion: has(Layer::Motion),
            centres: has(Layer::Centres),
            solver_colours: has(Layer::Colours),
            ..DrawOptions::nothing()
        };
        world.draw(&options, &mut all);
        let tints = layers.iter().rev().find(|l| matches!(l, Layer::Islands | Layer::Trees | Layer::Sleep));
        if let Some(layer) = tints {
            all.tints = vec![NONE; drawing.instances.len()];
            let trees = if *layer == Layer::Trees { Some(trees(world)) } else { None };
            let mut painter = Painter { world, drawing, layer: *layer, trees, all: &mut all };
            let islands = *layer == Layer::Islands;
            world.draw(&DrawOptions { shapes: true, islands, ..DrawOptions::nothing() }, &mut painter);
        }
        all
    }

    fn tone(&mut self, colour: Colour) -> f32 {
        let tones = &mut self.tones;
        let index = self.index.entry(colour).or_insert_with(|| {
            tones.push(colour);
            tones.len() - 1
        });
        *index as f32
    }
}

impl DebugDraw for Layers {
    fn shape(&mut self, _: &DrawnShape<'_>) {}

    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        let tone = self.tone(ink.colour);
        for end in [from, to] {
            let at = (end - self.origin).as_vec3();
            self.lines.extend([at.x, at.y, at.z, tone]);
        }
    }

    fn point(&mut self, at: DVec3, ink: Ink) {
        let kind = match ink.element {
            Element::RealPoint => 0.0,
            Element::PotentialPoint => 1.0,
            Element::CentreOfMass => 3.0,
            _ => 2.0,
        };
        let at = (at - self.origin).as_vec3();
        self.points.extend([at.x, at.y, at.z, kind]);
    }
}

/// Tints shapes of dynamic bodies.
struct Painter<'a> {
    world: &'a World,
    drawing: &'a Drawing,
    layer: Layer,
    trees: Option<HashMap<BodyHandle, usize>>,
    all: &'a mut Layers,
}

impl DebugDraw for Painter<'_> {
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        let Some(place) = self.drawing.place(shape.shape).filter(|_| shape.kind == BodyKind::Dynamic) else {
            return;
        };
        let colour = match (self.layer, &self.trees) {
            (Layer::Trees, Some(trees)) => match trees.get(&shape.body) {
                Some(&tree) => nth(tree),
                None => return,
            },
            (Layer::Sleep, _) if self.world.is_sleeping(shape.body).unwrap_or(false) => ASLEEP,
            (Layer::Sleep, _) => AWAKE,
            _ => shape.ink.colour,
        };
        self.all.tints[place] = self.all.tone(colour);
    }
}

/// Numbers of the groups of dynamic bodies that joints connect, for bodies with joints.
fn trees(world: &World) -> HashMap<BodyHandle, usize> {
    let mut trees = HashMap::new();
    let mut count = 0;
    let mut open = Vec::new();
    for first in world.bodies() {
        let has_joints = world.joints_of(first).is_ok_and(|mut joints| joints.next().is_some());
        if !has_joints || trees.contains_key(&first) || world.kind(first) != Ok(BodyKind::Dynamic) {
            continue;
        }
        open.push(first);
        trees.insert(first, count);
        while let Some(body) = open.pop() {
            for joint in world.joints_of(body).into_iter().flatten() {
                for other in world.joint_bodies(joint).into_iter().flatten() {
                    if world.kind(other) == Ok(BodyKind::Dynamic) && !trees.contains_key(&other) {
                        trees.insert(other, count);
                        open.push(other);
                    }
                }
            }
        }
        count += 1;
    }
    trees
}

/// One of many colours that are easy to tell apart: hues a golden angle from each other.
fn nth(n: usize) -> Colour {
    let hue = (n as f32 * 0.618_034).fract() * 6.0;
    let channel = |at: f32| {
        let away = (hue - at).abs().min(6.0 - (hue - at).abs());
        (50.0 + 205.0 * (2.0 - away).clamp(0.0, 1.0)) as u8
    };
    Colour::new(channel(0.0), channel(2.0), channel(4.0))
}
