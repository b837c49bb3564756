//! Shapes made of Bevy's meshes (feature `mesh`).

use crate::common::*;
use backstop_bevy::backstop::Geometry;
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_asset::{Assets, Handle, RenderAssetUsages};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_mesh::{Indices, Mesh, Mesh3d, PrimitiveTopology};
use bevy_transform::components::Transform;

/// A box from one corner to another, as twelve triangles.
fn slab(low: Vec3, high: Vec3) -> Mesh {
    let corner = |i: u32| {
        let side = |bit: u32, low: f32, high: f32| if i & bit == 0 { low } else { high };
        [side(1, low.x, high.x), side(2, low.y, high.y), side(4, low.z, high.z)]
    };
    let corners: Vec<[f32; 3]> = (0..8).map(corner).collect();
    // Each face with its outside to the right hand.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
        .with_inserted_indices(Indices::U32(triangles))
}

fn app_with_meshes() -> App {
    let mut app = app();
    app.insert_resource(Assets::<Mesh>::default()).add_plugins(BackstopMeshPlugin);
    app
}

fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

/// A mesh of 2 x 4 x 2 m whose centre is at y = 2, as each kind of shape, on static bodies. Expected: forms
/// and places by the box around it; the constructor is gone.
#[test]
fn each_constructor_makes_its_shape() {
    let mut app = app_with_meshes();
    let mesh = add(&mut app, slab(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 4.0, 1.0)));
    use ShapeConstructor::{Capsule, Cuboid, Cylinder, Hull, Mesh as Triangles, Sphere};
    let all = [Cuboid, Sphere, Capsule, Cylinder, Hull, Triangles].map(|constructor| {
        app.world_mut().spawn((RigidBody::Static, Mesh3d(mesh.clone()), constructor)).id()
    });
    log::<PhysicsError>(&mut app);
    run(&mut app, 2);
    assert_eq!(logged::<PhysicsError>(&app), []);
    let expected = [
        Geometry::cuboid(1.0, 2.0, 1.0),
        Geometry::sphere(6.0_f32.sqrt()),
        Geometry::capsule(1.0, 1.0),
        Geometry::cylinder(2.0, 1.0),
    ];
    for (place, entity) in all.into_iter().enumerate() {
        assert!(app.world().get::<ShapeConstructor>(entity).is_none());
        let (shape, offset) = (get::<Shape>(&app, entity), get::<ShapeOffset>(&app, entity));
        match expected.get(place) {
            Some(form) => {
                assert_eq!(format!("{:?}", shape.0), format!("{form:?}"));
                assert_eq!(offset, ShapeOffset::at(2.0 * Vec3::Y));
            }
            None => assert_eq!(offset, ShapeOffset::default()),
        }
        let shape = physics(&app).shape(entity).expect("it is in the world");
        let top = physics(&app).shape_aabb(shape).unwrap().max.y;
        assert!((top - if place == 1 { 2.0 + 6.0_f64.sqrt() } else { 4.0 }).abs() < 0.1, "{place}: {top}");
    }
    assert!(matches!(get::<Shape>(&app, all[4]).0, Geometry::Hull(_)));
    assert!(matches!(get::<Shape>(&app, all[5]).0, Geometry::Mesh(_)));
}

/// A scene of a body with a mesh two levels below, whose asset comes a second later, and a marker that is to
/// have no shape. Expected: the body waits in place, and has its shape within two frames of the asset; a ball
/// that falls onto it then comes to rest on top of it.
#[test]
fn a_scene_has_shapes_when_its_meshes_have_loaded() {
    let mut app = app_with_meshes();
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let constructors = ShapeConstructorHierarchy::new(ShapeConstructor::Mesh).with_name("marker", None);
    let root = app.world_mut().spawn((RigidBody::Static, constructors)).id();
    run(&mut app, 10);
    // What a scene spawner does later.
    let node = app.world_mut().spawn((Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(root))).id();
    let part = app.world_mut().spawn((Mesh3d(handle.clone()), ChildOf(node))).id();
    let marker = (Mesh3d(handle.clone()), Name::new("marker"), ChildOf(node));
    let marker = app.world_mut().spawn(marker).id();
    run(&mut app, 50);
    assert!(physics(&app).shape(part).is_none());
    assert_eq!(get::<ShapeConstructor>(&app, part), ShapeConstructor::Mesh);
    let ground = slab(Vec3::new(-5.0, -1.0, -5.0), Vec3::new(5.0, 0.0, 5.0));
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, ground).unwrap();
    run(&mut app, 2);
    assert!(physics(&app).shape(part).is_some());
    assert!(app.world().get::<Shape>(marker).is_none());
    let body = ball(&mut app, 3.0);
    run(&mut app, 120);
    assert!((get::<PhysicsPose>(&app, body).position.y - 1.5).abs() < 0.02);
}

/// Expected: a mesh without vertices, and one of lines where triangles are asked for, are each reported once,
/// with the entity; the app goes on.
#[test]
fn meshes_that_are_no_shape_are_reported() {
    let mut app = app_with_meshes();
    log::<PhysicsError>(&mut app);
    let empty = add(&mut app, Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default()));
    let lines = Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let lines = add(&mut app, lines);
    let spawn = |app: &mut App, mesh, constructor: ShapeConstructor| {
        app.world_mut().spawn((RigidBody::Static, Mesh3d(mesh), constructor)).id()
    };
    let a = spawn(&mut app, empty, ShapeConstructor::Cuboid);
    let b = spawn(&mut app, lines, ShapeConstructor::Mesh);
    run(&mut app, 10);
    let of: Vec<_> = logged::<PhysicsError>(&app).iter().map(|error| error.entity).collect();
    assert_eq!(of, [Some(a), Some(b)]);
    assert!(logged::<PhysicsError>(&app).iter().all(|error| matches!(error.problem, Problem::Mesh(_))));
}
