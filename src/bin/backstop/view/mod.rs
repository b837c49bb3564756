//! Pictures of a scene: in a window, or as PNG files where there is no display.
//!
//! Both show what `World::draw` draws, on a canvas of our own. The window is minifb's, which shows a buffer
//! of pixels and hands on keys: on Linux it loads X11 when it runs and builds without it. PNG is written by
//! the crate of that name.

mod camera;
mod canvas;
mod frames;
mod painter;
mod window;

pub(crate) use frames::{Frames, SCALE};
pub(crate) use painter::Form;
pub(crate) use window::{Opened, show};

use anyhow::bail;
use backstop::debug::DrawOptions;
use backstop::glam::DVec3;
use backstop::scene::Scene;
use backstop::{BodyKind, Geometry, World};
use camera::Camera;
use canvas::Canvas;
use painter::{Models, Painter};

/// What is shown, and how.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    pub(crate) draw: DrawOptions,
    /// Shapes without their faces.
    pub(crate) wireframe: bool,
    /// A grid at height zero.
    pub(crate) grid: bool,
    /// Static bodies with all their faces, not only those that face up.
    pub(crate) walls: bool,
}

impl Look {
    /// The names of what can be shown.
    pub(crate) const NAMES: [&str; 14] = [
        "shapes",
        "contacts",
        "normals",
        "impulses",
        "joints",
        "aabbs",
        "fat-aabbs",
        "motion",
        "centres",
        "colours",
        "islands",
        "wireframe",
        "grid",
        "walls",
    ];

    pub(crate) fn nothing() -> Look {
        Look { draw: DrawOptions::nothing(), wireframe: false, grid: false, walls: false }
    }

    /// What suits a scene.
    pub(crate) fn of(scene: &Scene) -> Look {
        let ground =
            |g: &Geometry| matches!(g, Geometry::Plane | Geometry::Mesh(_) | Geometry::HeightField(_));
        let mut shapes = scene.bodies.iter().flat_map(|body| &body.desc.shapes);
        // A grid in the air, or through hills, is no ground.
        let grid = !shapes.any(|shape| ground(&shape.geometry));
        Look { draw: DrawOptions::default(), grid, wireframe: false, walls: false }
    }

    /// The switch of a name.
    pub(crate) fn switch(&mut self, name: &str) -> Option<&mut bool> {
        let draw = &mut self.draw;
        Some(match name {
            "shapes" => &mut draw.shapes,
            "contacts" => &mut draw.contacts,
            "normals" => &mut draw.normals,
            "impulses" => &mut draw.impulses,
            "joints" => &mut draw.joints,
            "aabbs" => &mut draw.aabbs,
            "fat-aabbs" => &mut draw.fat_aabbs,
            "motion" => &mut draw.motion,
            "centres" => &mut draw.centres,
            "colours" => &mut draw.solver_colours,
            "islands" => &mut draw.islands,
            "wireframe" => &mut self.wireframe,
            "grid" => &mut self.grid,
            "walls" => &mut self.walls,
            _ => return None,
        })
    }

    /// From a list of names with commas between them.
    pub(crate) fn parse(text: &str) -> Result<Look, String> {
        let mut look = Look::nothing();
        for name in text.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            let switch = look.switch(name);
            *switch.ok_or_else(|| format!("\"{name}\" is none of {}", Look::NAMES.join(", ")))? = true;
        }
        Ok(look)
    }
}

/// A canvas, and what draws on it.
pub(crate) struct Viewer {
    pub(crate) camera: Camera,
    pub(crate) look: Look,
    canvas: Canvas,
    models: Models,
}

impl Viewer {
    pub(crate) fn new(camera: Camera, look: Look, (width, height): (usize, usize), scale: usize) -> Viewer {
        Viewer { camera, look, canvas: Canvas::new(width, height, scale), models: Models::default() }
    }

    pub(crate) fn resize(&mut self, width: usize, height: usize) {
        if self.canvas.size() != (width, height) {
            self.canvas = Canvas::new(width, height, 1);
        }
    }

    /// Draws a world; returns the picture, row by row from the top, each pixel as 0x00RRGGBB.
    pub(crate) fn picture(&mut self, world: &World) -> Vec<u32> {
        self.canvas.clear([0.17, 0.19, 0.23], [0.27, 0.29, 0.33]);
        let (width, height, _) = self.canvas.drawn();
        let view = self.camera.view(width as f32, height as f32);
        let (canvas, models) = (&mut self.canvas, &mut self.models);
        let mut painter =
            Painter { canvas, view, models, wireframe: self.look.wireframe, walls: self.look.walls };
        // Solids first: they hide lines, but lines hide nothing.
        let DrawOptions { shapes, .. } = self.look.draw;
        world.draw(&DrawOptions { shapes, ..DrawOptions::nothing() }, &mut painter);
        if self.look.grid {
            painter.grid(self.camera.target, 0.0, self.camera.distance);
        }
        world.draw(&DrawOptions { shapes: false, ..self.look.draw.clone() }, &mut painter);
        self.canvas.picture()
    }
}

/// A camera that sees most moving bodies of a scene, even after they have fallen to the ground at height
/// zero.
pub(crate) fn camera_for(scene: &Scene, eye: Option<DVec3>, target: Option<DVec3>) -> anyhow::Result<Camera> {
    let moves = |kind| kind != BodyKind::Static;
    let moving = scene.bodies.iter().filter(|body| moves(body.desc.kind));
    let mut places: Vec<DVec3> = moving.map(|body| body.desc.position).collect();
    if places.is_empty() {
        places = scene.bodies.iter().map(|body| body.desc.position).collect();
    }
    if scene.gravity.y < 0.0 && places.iter().all(|p| p.y > 0.0) {
        places.extend(places.clone().iter().map(|p| DVec3::new(p.x, 0.0, p.z)));
    }
    // By the mean, so that a single ball from far away does not move the camera far away.
    let share = 1.0 / places.len().max(1) as f64;
    let middle = places.iter().sum::<DVec3>() * share;
    let spread = (places.iter().map(|p| p.distance_squared(middle)).sum::<f64>() * share).sqrt();
    // A row reaches 1.73 times as far, and a body is larger than its position.
    let fitting = Camera::around(middle, 1.75 * spread + 1.0);
    Ok(match (eye, target) {
        (None, None) => fitting,
        (None, Some(target)) => Camera { target, ..fitting },
        (Some(eye), target) => {
            let target = target.unwrap_or(fitting.target);
            if eye == target {
                bail!("--eye is where --look-at is");
            }
            Camera::between(eye, target)
        }
    })
}
