//! A window: the scene in motion, turned with the mouse, stopped, stepped and wound back with keys.

use super::Player;
use anyhow::{anyhow, bail};
use std::num::NonZeroU32;
use std::rc::Rc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

/// What the keys do, for the terminal.
const HELP: &str = "\
keys:
  Space       pause, go on            R, Home     back to the start
  N, Right    a step on               P, Left     a step back
  PageDown    sixty steps on          PageUp      sixty steps back
  the line at the lower edge          back to any step that was shown
  drag        turn                    right drag  move
  wheel, +-   nearer, away            E           the camera follows what moves, or stays
  S shapes    C contacts              V normals   I impulses   J joints
  B boxes     F fat boxes             M motion    X centres    O colours of the solver
  G grid      T walls                 L islands   W faces or lines
  Esc, Q      the end
";

/// Switches by their keys.
const SWITCHES: [(&str, &str); 14] = [
    ("s", "shapes"),
    ("c", "contacts"),
    ("v", "normals"),
    ("i", "impulses"),
    ("j", "joints"),
    ("b", "aabbs"),
    ("f", "fat-aabbs"),
    ("m", "motion"),
    ("x", "centres"),
    ("o", "colours"),
    ("l", "islands"),
    ("w", "wireframe"),
    ("g", "grid"),
    ("t", "walls"),
];

/// Said where no window can be opened.
const NO_DISPLAY: &str = "there is no display for the window of --view: --frames DIR writes pictures, and \
                          --report DIR a page that shows the scene in a browser";
/// Steps of a page.
const PAGE: i64 = 60;
/// Time between pictures.
const FRAME: Duration = Duration::from_micros(16_667);

/// The connection to a display.
pub(crate) struct Opened(EventLoop<()>);

impl Opened {
    /// An error where there is no display. The window library's own would name a line of its source.
    pub(crate) fn new() -> anyhow::Result<Opened> {
        let Ok(events) = EventLoop::new() else { bail!(NO_DISPLAY) };
        Ok(Opened(events))
    }
}

/// Shows a run until the window is closed.
pub(crate) fn show(Opened(events): Opened, player: Player, title: &str) -> anyhow::Result<()> {
    eprint!("{HELP}");
    let mut app =
        App { player, title, shown: None, mouse: (0.0, 0.0), drag: None, last: Instant::now(), end: Ok(()) };
    events.run_app(&mut app).map_err(|_| anyhow!("the display has gone"))?;
    app.end
}

/// What a held mouse button does.
#[derive(Clone, Copy)]
enum Drag {
    Turn,
    Shift,
    Scrub,
}

struct Shown {
    window: Rc<Window>,
    surface: softbuffer::Surface<Rc<Window>, Rc<Window>>,
}

struct App<'a> {
    player: Player,
    title: &'a str,
    shown: Option<Shown>,
    mouse: (f32, f32),
    drag: Option<Drag>,
    last: Instant,
    end: anyhow::Result<()>,
}

impl ApplicationHandler for App<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let opened = self.open(events);
        self.finish_on_error(events, opened);
    }

    fn new_events(&mut self, events: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(shown)) = (cause, &self.shown) {
            shown.window.request_redraw();
            events.set_control_flow(ControlFlow::Wait);
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let done = self.on(events, event);
        self.finish_on_error(events, done);
    }
}

impl App<'_> {
    fn finish_on_error(&mut self, events: &ActiveEventLoop, done: anyhow::Result<()>) {
        if done.is_err() {
            self.end = done;
            events.exit();
        }
    }

    fn open(&mut self, events: &ActiveEventLoop) -> anyhow::Result<()> {
        let (width, height) = self.player.viewer.size();
        let size = LogicalSize::new(width as f64, height as f64);
        let title = format!("backstop: {}", self.title);
        let attributes = Window::default_attributes().with_title(title).with_inner_size(size);
        let window = Rc::new(events.create_window(attributes).map_err(|_| anyhow!(NO_DISPLAY))?);
        // Its errors are not for other threads, as anyhow wants them.
        let context = softbuffer::Context::new(window.clone()).map_err(|e| anyhow!("{e}"))?;
        let surface = softbuffer::Surface::new(&context, window.clone()).map_err(|e| anyhow!("{e}"))?;
        self.last = Instant::now();
        window.request_redraw();
        self.shown = Some(Shown { window, surface });
        Ok(())
    }

    fn on(&mut self, events: &ActiveEventLoop, event: WindowEvent) -> anyhow::Result<()> {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => {
                self.draw()?;
                events.set_control_flow(ControlFlow::WaitUntil(self.last + FRAME));
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                self.key(events, &event)?;
            }
            WindowEvent::CursorMoved { position, .. } => {
                let to = (position.x as f32, position.y as f32);
                let from = std::mem::replace(&mut self.mouse, to);
                self.dragged(from, to)?;
            }
            WindowEvent::MouseInput { state: ElementState::Pressed, button, .. } => {
                self.drag = match button {
                    MouseButton::Left if self.player.scrub(self.mouse.0, self.mouse.1, false)? => {
                        Some(Drag::Scrub)
                    }
                    MouseButton::Left => Some(Drag::Turn),
                    MouseButton::Right => Some(Drag::Shift),
                    _ => None,
                };
            }
            WindowEvent::MouseInput { .. } => self.drag = None,
            WindowEvent::MouseWheel { delta, .. } => {
                let lines = match delta {
                    MouseScrollDelta::LineDelta(_, y) => y,
                    MouseScrollDelta::PixelDelta(by) => by.y as f32 / 50.0,
                };
                self.zoom(lines.clamp(-3.0, 3.0));
            }
            _ => {}
        }
        Ok(())
    }

    fn draw(&mut self) -> anyhow::Result<()> {
        let passed = self.last.elapsed().as_secs_f32();
        self.last = Instant::now();
        self.player.pass(passed)?;
        let Some(shown) = &mut self.shown else { return Ok(()) };
        let size = shown.window.inner_size();
        // Nothing to draw on while it is minimised.
        let (Some(width), Some(height)) = (NonZeroU32::new(size.width), NonZeroU32::new(size.height)) else {
            return Ok(());
        };
        self.player.viewer.resize(size.width as usize, size.height as usize);
        let picture = self.player.picture();
        let mut put = || {
            shown.surface.resize(width, height)?;
            let mut buffer = shown.surface.buffer_mut()?;
            buffer.copy_from_slice(&picture);
            buffer.present()
        };
        put().map_err(|e| anyhow!("can't draw in the window: {e}"))
    }

    fn key(&mut self, events: &ActiveEventLoop, event: &KeyEvent) -> anyhow::Result<()> {
        let player = &mut self.player;
        match event.logical_key.as_ref() {
            Key::Named(NamedKey::Escape) | Key::Character("q" | "Q") => events.exit(),
            Key::Named(NamedKey::ArrowRight) | Key::Character("n" | "N") => player.skip(1)?,
            Key::Named(NamedKey::ArrowLeft) | Key::Character("p" | "P") => player.skip(-1)?,
            Key::Named(NamedKey::PageDown) => player.skip(PAGE)?,
            Key::Named(NamedKey::PageUp) => player.skip(-PAGE)?,
            Key::Named(NamedKey::Home) | Key::Character("r" | "R") => player.go_to(0)?,
            Key::Character("+" | "=") => self.zoom(1.0),
            Key::Character("-") => self.zoom(-1.0),
            // What follows are switches, which a key that is held would flip back and forth.
            _ if event.repeat => {}
            Key::Named(NamedKey::Space) => player.playing = !player.playing,
            Key::Character("e" | "E") => player.follows = !player.follows,
            Key::Character(key) => {
                let key = key.to_lowercase();
                let switch = SWITCHES.iter().find(|s| s.0 == key);
                if let Some(shown) = switch.and_then(|s| player.viewer.look.switch(s.1)) {
                    *shown = !*shown;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn dragged(&mut self, from: (f32, f32), to: (f32, f32)) -> anyhow::Result<()> {
        let (_, height) = self.player.viewer.size();
        let (dx, dy) = ((to.0 - from.0) / height as f32, (to.1 - from.1) / height as f32);
        let camera = self.player.viewer.camera;
        match self.drag {
            Some(Drag::Turn) => self.player.viewer.camera = camera.turned(-4.0 * dx, 4.0 * dy),
            Some(Drag::Shift) => {
                self.player.follows = false;
                self.player.viewer.camera = camera.shifted(-dx, dy);
            }
            Some(Drag::Scrub) => _ = self.player.scrub(to.0, to.1, true)?,
            None => {}
        }
        Ok(())
    }

    /// The camera then stays where it is put.
    fn zoom(&mut self, lines: f32) {
        self.player.follows = false;
        let camera = self.player.viewer.camera;
        self.player.viewer.camera = camera.zoomed(f64::from(libm::expf(-0.1 * lines)));
    }
}
