//! Contact hooks that read the app.

use crate::common::*;
use backstop_bevy::prelude::*;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;
use bevy_transform::components::Transform;

/// A platform that holds what comes from above alone.
#[derive(Component)]
struct OneWay;

#[derive(SystemParam)]
struct OneWays<'w, 's> {
    platforms: Query<'w, 's, (), With<OneWay>>,
    velocities: Query<'w, 's, &'static Velocity>,
}

impl CollisionHooks for OneWays<'_, '_> {
    fn contact(&self, contact: &mut HookedContact<'_, '_>) {
        let [Some(first), Some(second)] = contact.bodies() else { return };
        let up = contact.normal().y;
        let (guest, up) = match (self.platforms.contains(first), self.platforms.contains(second)) {
            (true, false) => (second, up),
            (false, true) => (first, -up),
            _ => return,
        };
        let rises = self.velocities.get(guest).is_ok_and(|velocity| velocity.linear.y > 0.0);
        if rises || up < 0.5 {
            contact.veto();
        }
    }
}

fn thrown(with_hooks: bool) -> (f64, f64) {
    let plugin = BackstopPlugin::default();
    let mut app = app_with(if with_hooks { plugin.with_hooks::<OneWays>() } else { plugin });
    let platform = (RigidBody::Static, Shape::cuboid(2.0, 0.1, 2.0), OneWay, ContactHooked);
    app.world_mut().spawn((platform, Transform::from_xyz(0.0, 3.0, 0.0)));
    let body = ball(&mut app, 0.0);
    app.world_mut().entity_mut(body).insert(Velocity::linear(10.0 * Vec3::Y));
    let mut top = 0.0_f64;
    for _ in 0..180 {
        app.update();
        top = top.max(get::<PhysicsPose>(&app, body).position.y);
    }
    (top, get::<PhysicsPose>(&app, body).position.y)
}

/// A ball of 0.5 m that is thrown at 10 m/s from below at a platform whose top is at 3.1 m. Expected: with
/// hooks that ask the app it flies through, up to v²/2g = 5.1 m, and comes to rest on it, at 3.6 m; without
/// them it does not pass.
#[test]
fn a_platform_holds_what_comes_from_above_alone() {
    let (top, rest) = thrown(true);
    assert!((top - 100.0 / (2.0 * 9.81)).abs() < 0.15, "it flew up to {top}");
    assert!((rest - 3.6).abs() < 0.02, "it rests at {rest}");
    let (top, rest) = thrown(false);
    assert!(top < 2.5 && rest < 0.0, "it flew up to {top} and is at {rest}");
}

/// Hooks of the plugin see entities, of a shape below its body too; those of the resource are asked as well.
#[derive(SystemParam)]
struct Ghosts<'w, 's> {
    parents: Query<'w, 's, &'static ChildOf>,
}

impl CollisionHooks for Ghosts<'_, '_> {
    fn contact(&self, contact: &mut HookedContact<'_, '_>) {
        let pairs = contact.shapes().into_iter().zip(contact.bodies());
        let is_below = |(shape, body): (Option<Entity>, Option<Entity>)| {
            shape.and_then(|shape| self.parents.get(shape).ok()).map(ChildOf::parent) == body
        };
        if pairs.filter(|pair| is_below(*pair)).count() == 1 {
            contact.veto();
        }
    }
}

/// A ball on a child of its body falls onto a floor. Expected: hooks that let pass what is on a child let it
/// fall through.
#[test]
fn hooks_name_shapes_and_bodies() {
    let mut app = app_with(BackstopPlugin::default().with_hooks::<Ghosts>());
    floor(&mut app);
    let body = app.world_mut().spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 2.0, 0.0))).id();
    app.world_mut().spawn((Shape::sphere(0.5), ContactHooked, ChildOf(body)));
    run(&mut app, 120);
    assert!(get::<PhysicsPose>(&app, body).position.y < -5.0);
}
