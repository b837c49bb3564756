//! Debug drawing on a canvas: shapes as shaded solids with their edges, the rest as lines and discs.

use super::camera::View;
use super::canvas::{Behind, Canvas, Rgb, lit};
use backstop::debug::{self, Colour, DebugDraw, DrawnShape, Element, Ink};
use backstop::glam::{DVec3, Mat3, Vec3};
use backstop::{BodyKind, Geometry, GeometryKey};
use std::collections::HashMap;
use std::sync::Arc;

/// Lines and triangles of a shape, in its frame.
#[derive(Debug, Default)]
struct Model {
    triangles: Vec<[Vec3; 3]>,
    lines: Vec<(Vec3, Vec3)>,
}

/// Models, made once.
#[derive(Debug, Default)]
pub(crate) struct Models {
    made: HashMap<GeometryKey, Arc<Model>>,
}

impl Models {
    fn of(&mut self, geometry: &Geometry) -> Arc<Model> {
        let made = self.made.entry(geometry.key()).or_insert_with(|| {
            let mut model = Model::default();
            debug::triangles(geometry, None, &mut |corners| model.triangles.push(corners));
            debug::wireframe(geometry, None, &mut |from, to| model.lines.push((from, to)));
            Arc::new(model)
        });
        made.clone()
    }
}

/// Draws what the world hands it.
pub(crate) struct Painter<'a> {
    pub(crate) canvas: &'a mut Canvas,
    pub(crate) view: View,
    pub(crate) models: &'a mut Models,
    /// Shapes as lines alone.
    pub(crate) wireframe: bool,
    /// Also those faces of static bodies that don't face up.
    pub(crate) walls: bool,
    /// What the world draws dynamic bodies in that are awake; these are coloured by their shape, to tell them
    /// apart.
    pub(crate) own: Colour,
}

impl Painter<'_> {
    fn segment(&mut self, from: Vec3, to: Vec3, thick: f32, colour: Rgb, behind: Behind) {
        if let Some((from, to)) = self.view.line(from, to) {
            self.canvas.line(from, to, thick, colour, behind);
        }
    }

    /// A grid on the ground around a point, in steps that suit the distance.
    pub(crate) fn grid(&mut self, around: DVec3, height: f64, distance: f64) {
        const LINES: i32 = 24;
        let step = f64::from(libm::powf(10.0, libm::floorf(libm::log10f(distance as f32 / 4.0))));
        let snapped = |v: f64| (v / step).round() * step;
        let middle = DVec3::new(snapped(around.x), height, snapped(around.z));
        let reach = step * f64::from(LINES);
        for i in -LINES..=LINES {
            let offset = step * f64::from(i);
            for (across, along) in [(DVec3::X, DVec3::Z), (DVec3::Z, DVec3::X)] {
                let at = middle + across * offset;
                let ends = [at - along * reach, at + along * reach].map(|p| self.view.see(p));
                let tenth = ((at.dot(across) / step).round() as i64) % 10 == 0;
                let colour = if tenth { [0.47, 0.51, 0.57] } else { [0.33, 0.36, 0.41] };
                self.segment(ends[0], ends[1], 1.0, colour, Behind::Hidden);
            }
        }
    }
}

impl DebugDraw for Painter<'_> {
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        let model = self.models.of(shape.geometry);
        let colour = if shape.ink.colour == self.own {
            colour_of(shape.geometry)
        } else {
            shape.ink.colour.to_array()
        };
        let origin = self.view.see(shape.position);
        let turn = Mat3::from_quat(shape.rotation);
        let place = |view: &View, p: Vec3| origin + view.direction(turn * p);
        // Walls would hide what is between them.
        let hides = !self.walls && shape.kind == BodyKind::Static && shape.geometry.is_convex();
        if !self.wireframe {
            for corners in &model.triangles {
                let seen = corners.map(|p| place(&self.view, p));
                // In the world's axes: those of the view are left-handed, which would turn the product round.
                let normal = turn * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let is_back = self.view.direction(normal).dot(seen[0]) > 0.0;
                if is_back && shape.geometry.is_convex() {
                    continue;
                }
                // The side that is seen of a surface that has two.
                let normal = if is_back { -normal } else { normal }.normalize_or_zero();
                if hides && normal.y < 0.1 {
                    continue;
                }
                let lit = lit(colour, normal);
                let canvas = &mut *self.canvas;
                self.view.triangle(seen, &mut |spots| canvas.triangle(spots, lit));
            }
        }
        // If triangles are small, their edges must not dominate.
        let dark = if shape.geometry.is_convex() { 0.55 } else { 0.8 };
        let colour = if self.wireframe { colour } else { colour.map(|c| c * dark) };
        for &(from, to) in &model.lines {
            let (from, to) = (place(&self.view, from), place(&self.view, to));
            self.segment(from, to, 1.0, colour, Behind::Hidden);
        }
    }

    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        let (thick, behind) = match ink.element {
            Element::Aabb | Element::FatAabb => (1.0, Behind::Hidden),
            Element::Impulse | Element::Motion | Element::SolverColour => (2.0, Behind::Faint),
            Element::JointFrame | Element::JointGap | Element::Coupling => (2.0, Behind::Faint),
            _ => (1.0, Behind::Faint),
        };
        let (from, to) = (self.view.see(from), self.view.see(to));
        self.segment(from, to, thick, ink.colour.to_array(), behind);
    }

    fn point(&mut self, at: DVec3, ink: Ink) {
        if let Some(spot) = self.view.spot(self.view.see(at)) {
            self.canvas.disc(spot, 2.5, ink.colour.to_array(), Behind::Faint);
        }
    }
}

/// A colour for each kind of shape.
fn colour_of(geometry: &Geometry) -> Rgb {
    match geometry {
        Geometry::Sphere { .. } => [0.93, 0.42, 0.33],
        Geometry::Capsule { .. } => [0.95, 0.68, 0.30],
        Geometry::Box { .. } => [0.40, 0.62, 0.90],
        Geometry::Cylinder { .. } => [0.45, 0.76, 0.50],
        _ => [0.72, 0.53, 0.86],
    }
}
