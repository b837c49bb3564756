//! The examples of backstop-bevy in a window, with the code of their scenes.
//!
//!     cargo run --manifest-path bindings/bevy/window/Cargo.toml -- game
//!
//! Names: yard, game, platforms. Arrow keys roll the ball of the game, G draws the engine's lines.

#[allow(dead_code, reason = "its main runs without a window")]
#[path = "../../examples/game.rs"]
mod game;
#[allow(dead_code, reason = "its main runs without a window")]
#[path = "../../examples/platforms.rs"]
mod platforms;
#[allow(dead_code, reason = "its main runs without a window")]
#[path = "../../examples/yard.rs"]
mod yard;

use backstop_bevy::backstop::Geometry;
use backstop_bevy::{
    BackstopGizmosPlugin, BackstopOverlayPlugin, PhysicsGizmos, RigidBody, Sensor, Shape, ToBevy,
};
use bevy::prelude::*;

fn main() {
    let name = std::env::args().nth(1).unwrap_or_default();
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, BackstopGizmosPlugin, BackstopOverlayPlugin));
    app.insert_resource(ClearColor(Color::srgb(0.6, 0.7, 0.8)));
    app.add_systems(Startup, light).add_systems(Update, (give_meshes, draw_lines));
    let (eye, target) = match name.as_str() {
        "yard" => {
            app.add_plugins(yard::scene);
            (Vec3::new(2.0, 8.0, 20.0), Vec3::new(0.0, 2.0, 0.0))
        }
        "game" => {
            app.add_plugins(game::scene).add_systems(Update, steer);
            (Vec3::new(4.0, 9.0, 14.0), Vec3::new(4.0, 0.0, 1.0))
        }
        "platforms" => {
            app.add_plugins(platforms::scene);
            (Vec3::new(4.0, 6.0, 14.0), Vec3::new(0.0, 3.5, 0.0))
        }
        _ => {
            eprintln!("name an example: yard, game or platforms");
            return;
        }
    };
    let view = Transform::from_translation(eye).looking_at(target, Vec3::Y);
    app.world_mut().spawn((Camera3d::default(), view));
    app.run();
}

fn light(mut commands: Commands) {
    let from = Transform::from_xyz(4.0, 10.0, 6.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((DirectionalLight { shadow_maps_enabled: true, ..default() }, from));
    commands.insert_resource(GlobalAmbientLight { brightness: 400.0, ..default() });
}

/// The mesh of a form, if the examples have it; others are drawn by the engine's lines alone.
fn mesh_of(geometry: &Geometry) -> Option<Mesh> {
    Some(match geometry {
        Geometry::Sphere { radius } => Sphere::new(*radius).into(),
        Geometry::Box { half_extents } => Cuboid::from_size(2.0 * half_extents.to_bevy()).into(),
        Geometry::Capsule { half_height, radius_top, .. } => {
            Capsule3d::new(*radius_top, 2.0 * half_height).into()
        }
        Geometry::Cylinder { half_height, radius_top, .. } => {
            Cylinder::new(*radius_top, 2.0 * half_height).into()
        }
        Geometry::Plane => Plane3d::new(Vec3::Y, Vec2::splat(50.0)).into(),
        _ => return None,
    })
}

/// Gives each new shape a mesh, in a colour by what it is.
fn give_meshes(
    shapes: Query<(Entity, &Shape, Has<Sensor>), Added<Shape>>,
    bodies: Query<(&RigidBody, Has<Visibility>)>,
    parents: Query<&ChildOf>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, shape, is_sensor) in &shapes {
        let Some(mesh) = mesh_of(&shape.0) else { continue };
        let body = std::iter::once(entity).chain(parents.iter_ancestors(entity));
        let Some(body) = body.into_iter().find(|&entity| bodies.contains(entity)) else { continue };
        let colour = match bodies.get(body) {
            _ if is_sensor => Color::srgba(1.0, 0.9, 0.2, 0.5),
            Ok((RigidBody::Dynamic, _)) => Color::srgb(0.9, 0.5, 0.2),
            Ok((RigidBody::Kinematic, _)) => Color::srgb(0.3, 0.5, 0.9),
            _ => Color::srgb(0.5, 0.55, 0.5),
        };
        if bodies.get(body).is_ok_and(|(_, is_visible)| !is_visible) {
            commands.entity(body).insert(Visibility::default());
        }
        let alpha_mode = if is_sensor { AlphaMode::Blend } else { AlphaMode::Opaque };
        let material = StandardMaterial { base_color: colour, alpha_mode, ..default() };
        commands.entity(entity).insert((Mesh3d(meshes.add(mesh)), MeshMaterial3d(materials.add(material))));
    }
}

/// G switches the engine's debug drawing.
fn draw_lines(keys: Res<ButtonInput<KeyCode>>, mut gizmos: ResMut<PhysicsGizmos>) {
    gizmos.enabled ^= keys.just_pressed(KeyCode::KeyG);
}

/// The arrow keys say where the ball of the game is to go.
fn steer(keys: Res<ButtonInput<KeyCode>>, mut balls: Query<&mut game::Wish>) {
    let axis = |plus: KeyCode, minus: KeyCode| f32::from(keys.pressed(plus)) - f32::from(keys.pressed(minus));
    let along = axis(KeyCode::ArrowRight, KeyCode::ArrowLeft);
    let across = axis(KeyCode::ArrowDown, KeyCode::ArrowUp);
    for mut wish in &mut balls {
        wish.0 = 3.0 * Vec3::new(along, 0.0, across).normalize_or_zero();
    }
}
