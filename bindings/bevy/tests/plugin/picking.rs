//! Pointers over shapes (feature `picking`), with a window that nothing shows.

use crate::common::*;
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_camera::{Camera, ComputedCameraValues, RenderTarget, RenderTargetInfo};
use bevy_ecs::prelude::*;
use bevy_math::{Mat4, UVec2, Vec2, Vec3, Vec4};
use bevy_picking::backend::{HitData, PointerHits};
use bevy_picking::pointer::{Location, PointerId, PointerLocation};
use bevy_picking::{Pickable, PickingPlugin, PickingSettings};
use bevy_transform::components::{GlobalTransform, Transform};
use bevy_window::{PrimaryWindow, Window};

/// An app with a camera at z = 10 that looks along -z over 400 x 400 pixels, at 90 degrees, with a near plane
/// at 0.1 m, and a pointer there.
fn app_with_pointer(at: Vec2) -> App {
    let mut app = app();
    app.add_plugins((PickingPlugin, BackstopPickingPlugin));
    app.insert_resource(PickingSettings { is_window_picking_enabled: false, ..PickingSettings::default() });
    let window = app.world_mut().spawn((Window::default(), PrimaryWindow)).id();
    let info = RenderTargetInfo { physical_size: UVec2::splat(400), scale_factor: 1.0 };
    // The far plane is infinitely far, at a depth of zero.
    let view = Mat4::from_cols(Vec4::X, Vec4::Y, -Vec4::W, 0.1 * Vec4::Z);
    let computed =
        ComputedCameraValues { clip_from_view: view, target_info: Some(info), ..Default::default() };
    let camera = Camera { computed, order: 3, ..Camera::default() };
    let place = Transform::from_xyz(0.0, 0.0, 10.0);
    let target = RenderTarget::default();
    let location = Location { target: target.normalize(Some(window)).unwrap(), position: at };
    app.world_mut().spawn((camera, target, place, GlobalTransform::from(place)));
    app.world_mut().spawn((PointerId::Mouse, PointerLocation::new(location)));
    app
}

fn still(app: &mut App, shape: Shape, at: Vec3) -> Entity {
    app.world_mut().spawn((RigidBody::Static, shape, Transform::from_translation(at))).id()
}

fn picks(app: &mut App) -> Vec<(Entity, HitData)> {
    log::<PointerHits>(app);
    run(app, 3);
    // Those of frames before this call are among them.
    app.world_mut().resource_mut::<Log<PointerHits>>().0.clear();
    run(app, 1);
    let all = logged::<PointerHits>(app);
    let last = all.last().cloned();
    if let Some(hits) = &last {
        assert_eq!((hits.pointer, hits.order), (PointerId::Mouse, 3.0));
    }
    last.map_or(Vec::new(), |hits| hits.picks)
}

/// A ball of 1 m at the origin, a box of 2 m behind it, and a pointer in the middle. Expected: the ball
/// alone, at z = 1, 8.9 m from the near plane, its normal towards the camera. If it blocks nothing, the box
/// behind it too, farther away; if it is not hoverable, the box alone.
#[test]
fn a_pointer_meets_the_nearest_shape() {
    let mut app = app_with_pointer(Vec2::splat(200.0));
    let ball = still(&mut app, Shape::sphere(1.0), Vec3::ZERO);
    let behind = still(&mut app, Shape::cuboid(2.0, 2.0, 1.0), Vec3::new(0.0, 0.0, -5.0));
    run(&mut app, 2);
    let met = picks(&mut app);
    assert_eq!(met.iter().map(|(entity, _)| *entity).collect::<Vec<_>>(), [ball]);
    let hit = &met[0].1;
    assert!((hit.depth - 8.9).abs() < 1e-3, "{hit:?}");
    assert!(hit.position.unwrap().distance(Vec3::Z) < 1e-3 && hit.normal.unwrap().distance(Vec3::Z) < 1e-3);

    app.world_mut().entity_mut(ball).insert(Pickable { should_block_lower: false, is_hoverable: true });
    let met = picks(&mut app);
    assert_eq!(met.iter().map(|(entity, _)| *entity).collect::<Vec<_>>(), [ball, behind]);
    assert!((met[1].1.depth - 13.9).abs() < 1e-3 && met[0].1.depth < met[1].1.depth);
    app.world_mut().entity_mut(ball).insert(Pickable::IGNORE);
    assert_eq!(picks(&mut app)[0].0, behind);
}

/// A pointer a quarter of the window from its left and upper edges looks along (-0.5, 0.5, -1). Expected: it
/// meets a ball there, by the entity of its shape below the body, and not the one in the middle; where
/// markers are required it meets what has them alone.
#[test]
fn a_pointer_meets_what_is_below_it() {
    let mut app = app_with_pointer(Vec2::splat(100.0));
    still(&mut app, Shape::sphere(1.0), Vec3::ZERO);
    let body = app.world_mut().spawn((RigidBody::Static, Transform::from_xyz(-5.0, 5.0, 0.0))).id();
    let shape = app.world_mut().spawn((Shape::sphere(0.5), ChildOf(body))).id();
    run(&mut app, 2);
    let met = picks(&mut app);
    assert_eq!(met.iter().map(|(entity, _)| *entity).collect::<Vec<_>>(), [shape]);
    let settings = PhysicsPicking { require_markers: true, ..PhysicsPicking::default() };
    app.insert_resource(settings);
    assert_eq!(picks(&mut app).len(), 0);
}
