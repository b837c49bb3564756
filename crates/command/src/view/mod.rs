//! Pictures of a scene: in a window, or as PNG files where there is no display.
//!
//! Both show what `World::draw` draws, on a canvas of our own (docs/decisions/packages.md says why). The
//! window is winit's and softbuffer's, text on it is embedded-graphics', PNG is written by the crate of that
//! name.

mod camera;
mod canvas;
mod frames;
mod history;
mod overlay;
mod painter;
mod player;
#[cfg(test)]
mod tests;
mod window;

pub(crate) use camera::Camera;
pub(crate) use frames::{Frames, SCALE};
pub(crate) use player::Player;
pub(crate) use window::{Opened, show};

use backstop::debug::DrawOptions;
use backstop::glam::DVec3;

use backstop::{BodyHandle, BodyKind, QueryFilter, Ray, World};
use backstop_scene::Scene;
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
        let mut shapes = scene.bodies.iter().flat_map(|body| &body.desc.shapes);
        // A grid in the air, or through hills, is no ground.
        let grid = shapes.all(|shape| shape.geometry.is_convex());
        // Contacts and joints of a crowd would bury it: they are a key or a name in `--show` away.
        let draw = DrawOptions { shapes: true, ..DrawOptions::nothing() };
        Look { draw, grid, wireframe: false, walls: false }
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

/// Where the eye is and what it looks at, as far as the user says it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wanted {
    pub(crate) eye: Option<DVec3>,
    pub(crate) target: Option<DVec3>,
}

/// A canvas, and what draws on it.
pub(crate) struct Viewer {
    pub(crate) camera: Camera,
    pub(crate) look: Look,
    wanted: Wanted,
    canvas: Canvas,
    models: Models,
}

impl Viewer {
    pub(crate) fn new(wanted: Wanted, look: Look, (width, height): (usize, usize), scale: usize) -> Viewer {
        let camera = Camera::above(DVec3::ZERO, 10.0);
        let canvas = Canvas::new(width, height, scale);
        Viewer { camera, look, wanted, canvas, models: Models::default() }
    }

    /// Pixels of the picture across and down.
    pub(crate) fn size(&self) -> (usize, usize) {
        self.canvas.size()
    }

    /// Width of the picture over its height.
    pub(crate) fn aspect(&self) -> f32 {
        let (width, height) = self.size();
        width as f32 / height as f32
    }

    pub(crate) fn resize(&mut self, width: usize, height: usize) {
        if self.canvas.size() != (width, height) {
            self.canvas = Canvas::new(width, height, 1);
        }
    }

    /// Puts the camera where the user wants it, else where it sees what moves, and what that will fall onto.
    pub(crate) fn frame(&mut self, world: &World) {
        let mut balls = moving(world);
        let below: Vec<_> = balls.iter().filter_map(|ball| ground_below(world, ball)).collect();
        balls.extend(below);
        let fitting = self.camera.fitting(&balls, self.aspect());
        self.camera = match (self.wanted.eye, self.wanted.target) {
            (None, None) => fitting,
            (None, Some(target)) => Camera { target, ..fitting },
            (Some(eye), target) => Camera::between(eye, target.unwrap_or(fitting.target)),
        };
    }

    /// Draws a world; returns the picture, row by row from the top, each pixel as 0x00RRGGBB.
    pub(crate) fn picture(&mut self, world: &World) -> Vec<u32> {
        self.canvas.clear([0.17, 0.19, 0.23], [0.27, 0.29, 0.33]);
        let (width, height, _) = self.canvas.drawn();
        let view = self.camera.view(width as f32, height as f32);
        let (canvas, models) = (&mut self.canvas, &mut self.models);
        let Look { ref draw, wireframe, walls, grid } = self.look;
        let own = draw.palette.dynamic_body;
        let mut painter = Painter { canvas, view, models, wireframe, walls, own };
        // Solids first: they hide lines, but lines hide nothing.
        let DrawOptions { shapes, islands, .. } = *draw;
        world.draw(&DrawOptions { shapes, islands, ..DrawOptions::nothing() }, &mut painter);
        if grid {
            painter.grid(self.camera.target, 0.0, self.camera.distance);
        }
        world.draw(&DrawOptions { shapes: false, ..draw.clone() }, &mut painter);
        self.canvas.picture()
    }
}

/// The camera, as it looks, where it sees what moves; none while nothing does.
pub(crate) fn framing(world: &World, camera: Camera, aspect: f32) -> Option<Camera> {
    world.moved_bodies().next()?;
    Some(camera.fitting(&moving(world), aspect))
}

/// Balls around the bodies that the last step moved, else around all that can move: centre and radius [m].
fn moving(world: &World) -> Vec<(DVec3, f64)> {
    let around = |body: BodyHandle| {
        let bounds = world.aabb(body).ok().flatten().filter(|b| b.min.is_finite() && b.max.is_finite())?;
        Some((bounds.centre(), bounds.half_extents().length()))
    };
    let moves = |body: &BodyHandle| world.kind(*body).is_ok_and(|kind| kind != BodyKind::Static);
    let mut balls: Vec<_> = world.moved_bodies().filter_map(around).collect();
    if balls.is_empty() {
        balls = world.bodies().filter(moves).filter_map(around).collect();
    }
    // Without the furthest twentieth: a ball that flies off must not take the camera with it.
    let middle = balls.iter().map(|ball| ball.0).sum::<DVec3>() / balls.len().max(1) as f64;
    balls.sort_by(|a, b| a.0.distance_squared(middle).total_cmp(&b.0.distance_squared(middle)));
    balls.truncate((balls.len() * 19).div_ceil(20));
    balls
}

/// How far down ground is looked for [m].
const DEEP: f32 = 1000.0;

/// The same ball where it would rest, straight below.
fn ground_below(world: &World, &(at, radius): &(DVec3, f64)) -> Option<(DVec3, f64)> {
    let down = world.settings().gravity.try_normalize()?;
    let ray = Ray::new(at, down * DEEP);
    let hit = world.cast_ray(&ray, &QueryFilter::only_static()).ok().flatten()?;
    Some((hit.point - down.as_dvec3() * radius.min(hit.point.distance(at)), radius))
}
