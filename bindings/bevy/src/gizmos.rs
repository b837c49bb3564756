//! The engine's debug drawing as gizmos.

use crate::ToBevy;
use crate::world::PhysicsWorld;
use backstop::debug::{DebugDraw, DrawOptions, Ink};
use backstop::glam::DVec3;
use bevy_app::prelude::*;
use bevy_color::Color;
use bevy_ecs::prelude::*;
use bevy_gizmos::config::DefaultGizmoConfigGroup;
use bevy_gizmos::gizmos::{GizmoBuffer, Gizmos};
use bevy_math::Vec3;

/// Draws the world in `PostUpdate` while [`PhysicsGizmos`] says so, as of the last step. Needs Bevy's
/// `GizmoPlugin`, and a renderer that shows gizmos.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackstopGizmosPlugin;

/// What is drawn.
#[derive(Resource, Clone, Debug)]
pub struct PhysicsGizmos {
    /// Whether anything is. Default yes.
    pub enabled: bool,
    /// Which elements, and in which colours.
    pub options: DrawOptions,
    /// Length of the arms of the cross that marks a point [m]. Default 0.02.
    pub point_size: f32,
}

impl Default for PhysicsGizmos {
    fn default() -> Self {
        PhysicsGizmos { enabled: true, options: DrawOptions::default(), point_size: 0.02 }
    }
}

impl Plugin for BackstopGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PhysicsGizmos>().add_systems(PostUpdate, draw);
    }
}

fn draw(physics: Option<Res<PhysicsWorld>>, drawn: Res<PhysicsGizmos>, mut gizmos: Gizmos) {
    if let Some(physics) = physics.filter(|_| drawn.enabled) {
        let mut pen = Pen { gizmos: &mut gizmos, origin: physics.origin(), point_size: drawn.point_size };
        physics.draw(&drawn.options, &mut pen);
    }
}

/// Draws lines where transforms are.
struct Pen<'a> {
    gizmos: &'a mut GizmoBuffer<DefaultGizmoConfigGroup, ()>,
    origin: DVec3,
    point_size: f32,
}

impl Pen<'_> {
    fn local(&self, point: DVec3) -> Vec3 {
        (point - self.origin).as_vec3().to_bevy()
    }
}

fn colour(ink: Ink) -> Color {
    let [red, green, blue] = ink.colour.to_array();
    Color::srgb(red, green, blue)
}

impl DebugDraw for Pen<'_> {
    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        let (from, to) = (self.local(from), self.local(to));
        self.gizmos.line(from, to, colour(ink));
    }

    fn point(&mut self, at: DVec3, ink: Ink) {
        let at = self.local(at);
        for arm in [Vec3::X, Vec3::Y, Vec3::Z] {
            let arm = arm * self.point_size;
            self.gizmos.line(at - arm, at + arm, colour(ink));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

    /// A ball of 0.5 m at 1e8 m, where the world's origin is too. Expected: lines of its colour whose ends
    /// are all on it, 0.5 m from zero.
    #[test]
    fn lines_are_where_transforms_are() {
        let far = DVec3::new(1e8, 0.0, 0.0);
        let mut world = World::new(Settings::default()).unwrap();
        world.set_origin(far).unwrap();
        let ball = ShapeDesc::new(Geometry::sphere(0.5));
        world.add_body(&BodyDesc::dynamic().with_position(far).with_shape(ball)).unwrap();
        let mut gizmos = GizmoBuffer::new();
        let mut pen = Pen { gizmos: &mut gizmos, origin: world.origin(), point_size: 0.02 };
        let options = DrawOptions::default();
        world.draw(&options, &mut pen);
        let drawn = gizmos.buffer();
        assert!(drawn.list_positions.len() > 20);
        assert!(drawn.list_positions.iter().all(|point| (point.length() - 0.5).abs() < 1e-5));
        let [red, green, blue] = options.palette.dynamic_body.to_array();
        assert!(drawn.list_colors.iter().all(|colour| *colour == Color::srgb(red, green, blue).to_linear()));
    }
}
