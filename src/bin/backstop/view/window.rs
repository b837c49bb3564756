//! A window: the scene in motion, turned with the mouse, stopped and stepped with keys.

use super::Viewer;
use backstop::World;
use minifb::{Key, KeyRepeat, MouseButton, MouseMode, Scale, ScaleMode, Window, WindowOptions};
use std::time::Instant;

/// What the keys do, for the terminal.
const HELP: &str = "\
keys:
  Space       pause, go on            N, Right    a step, while paused
  R           from the start          Esc, Q      the end
  drag        turn                    right drag  move
  wheel, +-   nearer, away            W           faces or lines
  S shapes    C contacts              V normals   I impulses   J joints
  B boxes     F fat boxes             M motion    X centres    O colours of the solver
  G grid      T walls                 L islands
";

/// Switches by their keys.
const SWITCHES: [(Key, &str); 14] = [
    (Key::S, "shapes"),
    (Key::C, "contacts"),
    (Key::V, "normals"),
    (Key::I, "impulses"),
    (Key::J, "joints"),
    (Key::B, "aabbs"),
    (Key::F, "fat-aabbs"),
    (Key::M, "motion"),
    (Key::X, "centres"),
    (Key::O, "colours"),
    (Key::L, "islands"),
    (Key::W, "wireframe"),
    (Key::G, "grid"),
    (Key::T, "walls"),
];

/// The most steps to catch up at once: a run slower than real time is shown slower.
const CATCH_UP: u32 = 4;

/// An open window.
pub(crate) struct Opened(Window);

impl Opened {
    /// None where there is no display, with the reason.
    pub(crate) fn new(title: &str, (width, height): (usize, usize)) -> Result<Opened, String> {
        let options = WindowOptions {
            resize: true,
            scale: Scale::X1,
            scale_mode: ScaleMode::UpperLeft,
            ..WindowOptions::default()
        };
        let mut window = Window::new(title, width, height, options).map_err(|e| e.to_string())?;
        window.set_target_fps(60);
        Ok(Opened(window))
    }
}

/// Shows a world until the window is closed. `start` makes it anew.
pub(crate) fn show(
    Opened(mut window): Opened,
    mut viewer: Viewer,
    name: &str,
    dt: f32,
    start: &dyn Fn() -> anyhow::Result<World>,
) -> anyhow::Result<()> {
    eprint!("{HELP}");
    let mut world = start()?;
    let (mut steps, mut paused, mut due) = (0u64, false, 0.0f32);
    let mut last = Instant::now();
    let mut mouse = None;
    while window.is_open() && !window.is_key_down(Key::Escape) && !window.is_key_down(Key::Q) {
        let passed = last.elapsed().as_secs_f32();
        last = Instant::now();
        due = if paused { 0.0 } else { (due + passed).min(CATCH_UP as f32 * dt) };
        for key in window.get_keys_pressed(KeyRepeat::No) {
            match key {
                Key::Space => paused = !paused,
                Key::R => (world, steps) = (start()?, 0),
                _ => {
                    let switch = SWITCHES.iter().find(|s| s.0 == key);
                    if let Some(shown) = switch.and_then(|s| viewer.look.switch(s.1)) {
                        *shown = !*shown;
                    }
                }
            }
        }
        let pressed = |key| window.is_key_pressed(key, KeyRepeat::Yes);
        if paused && (pressed(Key::N) || pressed(Key::Right)) {
            due = dt;
        }
        while due >= dt {
            world.step(dt)?;
            steps += 1;
            due -= dt;
        }
        steer(&window, &mut viewer, &mut mouse);
        let (width, height) = window.get_size();
        viewer.resize(width.max(1), height.max(1));
        window.update_with_buffer(&viewer.picture(&world), width.max(1), height.max(1))?;
        let report = world.report();
        window.set_title(&format!(
            "{name}: step {steps}, {:.2} ms, {} real and {} potential points, {} ghosts{}",
            report.times.step / 1000.0,
            report.real,
            report.potential,
            report.ghosts,
            if paused { ", paused" } else { "" }
        ));
    }
    Ok(())
}

/// Turns, moves and zooms by mouse and keys.
fn steer(window: &Window, viewer: &mut Viewer, mouse: &mut Option<(f32, f32)>) {
    let (_, height) = window.get_size();
    let now = window.get_mouse_pos(MouseMode::Pass);
    if let (Some((x, y)), Some((old_x, old_y))) = (now, *mouse) {
        let (dx, dy) = ((x - old_x) / height.max(1) as f32, (y - old_y) / height.max(1) as f32);
        if window.get_mouse_down(MouseButton::Left) {
            viewer.camera = viewer.camera.turned(-4.0 * dx, 4.0 * dy);
        } else if window.get_mouse_down(MouseButton::Right) {
            viewer.camera = viewer.camera.shifted(-dx, dy);
        }
    }
    *mouse = now;
    let mut zoom = window.get_scroll_wheel().map_or(0.0, |(_, y)| y.clamp(-1.0, 1.0));
    let down = |keys: [Key; 2]| keys.iter().any(|key| window.is_key_down(*key));
    zoom += if down([Key::Equal, Key::NumPadPlus]) { 0.3 } else { 0.0 };
    zoom -= if down([Key::Minus, Key::NumPadMinus]) { 0.3 } else { 0.0 };
    if zoom != 0.0 {
        viewer.camera = viewer.camera.zoomed(f64::from(libm::expf(-0.1 * zoom)));
    }
}
