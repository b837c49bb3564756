//! An app without a window, whose clock the test moves.

use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::message::Message;
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::TransformPlugin;
use bevy_transform::components::Transform;
use std::time::Duration;

/// An app with a step of a 60th of a second, whose first update, which takes no time, is done.
pub(crate) fn app_with(plugin: BackstopPlugin) -> App {
    let mut app = App::new();
    app.add_plugins((TimePlugin, TransformPlugin, plugin));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    each_frame(&mut app, Duration::ZERO);
    app.update();
    let step = app.world().resource::<Time<Fixed>>().timestep();
    each_frame(&mut app, step);
    app
}

pub(crate) fn app() -> App {
    app_with(BackstopPlugin::default())
}

/// How long each frame takes from now on.
pub(crate) fn each_frame(app: &mut App, frame: Duration) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
}

/// So many frames.
pub(crate) fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

pub(crate) fn get<T: Component + Clone>(app: &App, entity: Entity) -> T {
    app.world().get::<T>(entity).expect("the entity has it").clone()
}

pub(crate) fn physics(app: &App) -> &PhysicsWorld {
    app.world().resource::<PhysicsWorld>()
}

/// All messages, from now on.
#[derive(Resource, Debug)]
pub(crate) struct Log<M>(pub(crate) Vec<M>);

pub(crate) fn log<M: Message + Clone>(app: &mut App) {
    app.insert_resource(Log::<M>(Vec::new()));
    app.add_systems(Update, |mut all: MessageReader<M>, mut log: ResMut<Log<M>>| {
        log.0.extend(all.read().cloned())
    });
}

pub(crate) fn logged<M: Message + Clone>(app: &App) -> Vec<M> {
    app.world().resource::<Log<M>>().0.clone()
}

pub(crate) fn floor(app: &mut App) -> Entity {
    let under = Transform::from_xyz(0.0, -0.5, 0.0);
    app.world_mut().spawn((RigidBody::Static, Shape::cuboid(20.0, 0.5, 20.0), under)).id()
}

pub(crate) fn ball(app: &mut App, height: f32) -> Entity {
    let at = Transform::from_xyz(0.0, height, 0.0);
    app.world_mut().spawn((RigidBody::Dynamic, Shape::sphere(0.5), at)).id()
}
