//! Soft contacts, materials of triangles and cells, holes that are cut at run time, and sensors of what is
//! static do through the interface what they do in Rust: expected values are those of the crate `backstop`,
//! bit by bit.

mod common;

use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, HeightField, Material, Settings, ShapeDesc, TriangleMesh};
use backstop_c::*;
use common::*;
use std::ptr::{null, null_mut};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;

fn twins() -> (World, backstop::World) {
    (world(), backstop::World::new(Settings::default()).unwrap())
}

/// Adds a box to both; returns its body.
fn add_boxes(c: &World, rust: &mut backstop::World, at: DVec3) -> BsBody {
    let desc =
        BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::cuboid(0.2, 0.2, 0.2)));
    rust.add_body(&desc).unwrap();
    add(c, BS_BODY_DYNAMIC, bs_box(0.2, 0.2, 0.2), at.into())
}

fn step_alike(c: &World, rust: &mut backstop::World, count: usize) {
    for step in 0..count {
        steps(c, 1);
        rust.step(DT).unwrap();
        assert_eq!(hash(c), rust.state_hash(), "step {step}");
    }
}

fn shape_of(world: &World, body: BsBody) -> BsShape {
    let (mut shape, mut count) = (BsShape::NONE, 0);
    // SAFETY: the world is alive, and all places are.
    ok(unsafe { bs_body_shapes(world.0, body, &mut shape, 1, &mut count) });
    shape
}

fn fixed(rust: &mut backstop::World, shape: ShapeDesc) -> BodyHandle {
    rust.add_body(&BodyDesc::fixed().with_shape(shape)).unwrap()
}

/// A box on a floor of 5 Hz, which becomes one of 10 Hz. Expected: the hash of the world in Rust after every
/// step, and g / (2 pi f)² of sag, 9.94 mm and 2.49 mm, within 2 %.
#[test]
fn floors_yield_alike() {
    let (c, mut rust) = twins();
    let soft = |hertz| Material::default().with_contact_hertz(hertz).with_contact_damping(0.5);
    let ground = fixed(&mut rust, ShapeDesc::new(Geometry::Plane).with_material(soft(5.0)));
    let twin = rust.shapes(ground).unwrap().next().unwrap();
    let mut desc = bs_shape_desc_default(bs_plane());
    (desc.surface.contact_hertz, desc.surface.contact_damping) = (5.0, 0.5);
    let floor = shape_of(&c, add_shape(&c, BS_BODY_STATIC, &desc, dvec3(0.0, 0.0, 0.0)));
    let body = add_boxes(&c, &mut rust, DVec3::new(0.0, 0.2, 0.0));
    let sag = |hertz: f64| 9.81 / (2.0 * std::f64::consts::PI * hertz).powi(2);
    let sunk = || 0.2 - pose(&c, body).position.y;
    step_alike(&c, &mut rust, 120);
    assert!((sunk() / sag(5.0) - 1.0).abs() < 0.02, "{}", sunk());
    let harder = BsSurface { contact_hertz: 10.0, contact_damping: 0.5, ..BsSurface::default() };
    let mut told = BsSurface::default();
    let before = hash(&c);
    // SAFETY: the world is alive, and all places are.
    unsafe {
        let set = |shape, surface| bs_shape_set_surface(c.0, shape, surface);
        assert_eq!(set(BsShape::NONE, harder), BS_ERROR_STALE_SHAPE);
        for wrong in [-1.0, 2e6] {
            assert_eq!(set(floor, BsSurface { contact_hertz: wrong, ..harder }), BS_ERROR_OUT_OF_RANGE);
        }
        assert_eq!(set(floor, BsSurface { contact_damping: f32::NAN, ..harder }), BS_ERROR_NOT_FINITE);
        assert_eq!(hash(&c), before);
        ok(set(floor, harder));
        // The other part of the material leaves it.
        ok(bs_shape_set_material(c.0, floor, bs_material_default()));
        ok(bs_shape_surface(c.0, floor, &mut told));
    }
    assert_eq!(told, harder);
    rust.set_material(twin, soft(10.0)).unwrap();
    step_alike(&c, &mut rust, 120);
    assert!((sunk() / sag(10.0) - 1.0).abs() < 0.02, "{}", sunk());
}

/// A table in both: ice, and a belt of 1 m/s on a spring.
fn tables() -> ([Material; 2], [BsMaterial; 2], [BsSurface; 2]) {
    let ice = Material::default().with_friction(0.0);
    let belt = Material::default().with_surface_velocity(Vec3::X).with_contact_hertz(8.0);
    let belt = belt.with_contact_damping(0.7);
    let (mut own, mut surfaces) = ([bs_material_default(); 2], [BsSurface::default(); 2]);
    (own[0].static_friction, own[0].dynamic_friction) = (0.0, 0.0);
    (surfaces[1].contact_hertz, surfaces[1].contact_damping) = (8.0, 0.7);
    surfaces[1].surface_velocity = vec3(1.0, 0.0, 0.0);
    ([ice, belt], own, surfaces)
}

/// Two boxes on a mesh of four triangles, one on the belt. Expected: the hash of the world in Rust after each
/// step of two seconds, the table as it was given, and the box on the belt has gone more than a metre.
#[test]
fn triangles_have_materials_alike() {
    let (c, mut rust) = twins();
    let ((table, own, surfaces), numbers) = (tables(), [1, 1, 2, 2]);
    let corners = [[-9.0, 0.0, -9.0], [-9.0, 0.0, 0.0], [-9.0, 0.0, 9.0]];
    let corners: Vec<_> = corners.into_iter().flat_map(|[x, y, z]| [[x, y, z], [-x, y, z]]).collect();
    let triangles = [[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
    let vertices = corners.iter().copied().map(Vec3::from).collect();
    let mesh = TriangleMesh::with_materials(vertices, triangles.into(), &numbers, &table).unwrap();
    fixed(&mut rust, ShapeDesc::new(Geometry::Mesh(Arc::new(mesh))));
    let points: Vec<_> = corners.iter().map(|&[x, y, z]| vec3(x, y, z)).collect();
    let indices = triangles.as_flattened();
    let mut mesh = null();
    let (mut count, mut number) = (0, 9);
    let (mut told, mut surface) = (bs_material_default(), BsSurface::default());
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        let mut make = |numbers: *const u8, own: &[BsMaterial], surfaces: &[BsSurface; 2]| {
            let (points, indices, length) = (points.as_ptr(), indices.as_ptr(), own.len());
            let (own, surfaces, mesh) = (own.as_ptr(), surfaces.as_ptr(), &raw mut mesh);
            bs_mesh_create_with_materials(points, 6, indices, numbers, 4, own, surfaces, length, mesh)
        };
        let (mut wrong, mut spring) = (own, surfaces);
        spring[1].contact_damping = -1.0;
        assert_eq!(make(numbers.as_ptr(), &own, &spring), BS_ERROR_OUT_OF_RANGE);
        wrong[0].friction_combine = 9;
        assert_eq!(make(numbers.as_ptr(), &wrong, &surfaces), BS_ERROR_CONSTANT);
        assert_eq!(make(numbers.as_ptr(), &own[..1], &surfaces), BS_ERROR_OUT_OF_RANGE);
        assert_eq!(make(null(), &own, &surfaces), BS_ERROR_NULL);
        ok(make(numbers.as_ptr(), &own, &surfaces));
        ok(bs_mesh_material_count(mesh, &mut count));
        ok(bs_mesh_material_of(mesh, 3, &mut number));
        assert_eq!((count, number), (2, 2));
        ok(bs_mesh_material_of(mesh, 4, &mut number));
        assert_eq!(number, 0);
        ok(bs_mesh_material(mesh, 2, &mut told, &mut surface));
        assert_eq!((told, surface), (own[1], surfaces[1]));
        ok(bs_mesh_material(mesh, 1, &mut told, null_mut()));
        assert_eq!(told, own[0]);
        for none in [0, 3] {
            assert_eq!(bs_mesh_material(mesh, none, &mut told, &mut surface), BS_ERROR_CONSTANT);
        }
        add(&c, BS_BODY_STATIC, bs_mesh(mesh), dvec3(0.0, 0.0, 0.0));
        bs_mesh_release(mesh);
    }
    add_boxes(&c, &mut rust, DVec3::new(0.0, 0.2, -4.0));
    let carried = add_boxes(&c, &mut rust, DVec3::new(0.0, 0.2, 4.0));
    step_alike(&c, &mut rust, 120);
    assert!(pose(&c, carried).position.x > 1.0);
}

/// A box on the belt of a field, a hole under it after half a second, and the hole is filled. Expected: the
/// hash of the world in Rust after every step, and the fields as they were given.
#[test]
fn cells_have_materials_and_holes_alike() {
    let (c, mut rust) = twins();
    let ((table, own, surfaces), flat) = (tables(), [0.0; 36]);
    let numbers: Vec<u8> = (0..25).map(|cell| if cell == 12 { 2 } else { 0 }).collect();
    let field = HeightField::new(6, 6, Vec2::ONE, flat.to_vec()).unwrap();
    let field = field.with_materials(&numbers, &table).unwrap();
    let ground = fixed(&mut rust, ShapeDesc::new(Geometry::HeightField(Arc::new(field))));
    let twin = rust.shapes(ground).unwrap().next().unwrap();
    let (mut bare, mut field, mut holed) = (null(), null(), null());
    let (mut count, mut number, mut hole) = (0, 9, 9);
    let (mut told, mut surface) = (bs_material_default(), BsSurface::default());
    let holes: [BsBool; 6] = [0, 1, 1, 0, 1, 1];
    // SAFETY: all objects are alive, and all places are.
    let ground = unsafe {
        ok(bs_height_field_create(6, 6, 1.0, 1.0, flat.as_ptr(), &mut bare));
        let mut make = |cells, table, length| {
            let (numbers, surfaces, field) = (numbers.as_ptr(), surfaces.as_ptr(), &raw mut field);
            bs_height_field_with_materials(bare, numbers, cells, table, surfaces, length, field)
        };
        assert_eq!(make(24, own.as_ptr(), 2), BS_ERROR_OUT_OF_RANGE);
        assert_eq!(make(25, own.as_ptr(), 1), BS_ERROR_OUT_OF_RANGE);
        assert_eq!(make(25, null(), 2), BS_ERROR_NULL);
        ok(make(25, own.as_ptr(), 2));
        ok(bs_height_field_material_count(field, &mut count));
        ok(bs_height_field_material_of(field, 25, &mut number));
        assert_eq!((count, number), (2, 2));
        ok(bs_height_field_material(field, 2, &mut told, &mut surface));
        assert_eq!((told, surface), (own[1], surfaces[1]));
        let none = bs_height_field_material(field, 3, &mut told, &mut surface);
        assert_eq!(none, BS_ERROR_CONSTANT);
        let map = |first, holes, holed| bs_height_field_with_hole_map(field, first, 1, 3, 2, holes, holed);
        assert_eq!(map(3, holes.as_ptr(), &mut holed), BS_ERROR_OUT_OF_RANGE);
        assert_eq!(map(1, null(), &mut holed), BS_ERROR_NULL);
        ok(map(1, holes.as_ptr(), &mut holed));
        ok(bs_height_field_is_hole(holed, 2, 2, &mut hole));
        assert_eq!(hole, 1);
        ok(bs_height_field_is_hole(holed, 1, 2, &mut hole));
        assert_eq!(hole, 0);
        let ground = add(&c, BS_BODY_STATIC, bs_height_field(field), dvec3(0.0, 0.0, 0.0));
        bs_height_field_release(bare);
        bs_height_field_release(field);
        bs_height_field_release(holed);
        shape_of(&c, ground)
    };
    let faller = add_boxes(&c, &mut rust, DVec3::new(2.3, 0.2, 2.5));
    step_alike(&c, &mut rust, 30);
    let before = hash(&c);
    // SAFETY: the world is alive, and all places are.
    unsafe {
        let cut = |shape, first, holes| bs_shape_set_holes(c.0, shape, first, 1, 3, 2, holes);
        assert_eq!(cut(BsShape::NONE, 1, holes.as_ptr()), BS_ERROR_STALE_SHAPE);
        assert_eq!(cut(ground, 3, holes.as_ptr()), BS_ERROR_OUT_OF_RANGE);
        assert_eq!(cut(ground, 1, null()), BS_ERROR_NULL);
        assert_eq!(hash(&c), before);
        ok(cut(ground, 1, holes.as_ptr()));
    }
    rust.set_holes(twin, [1, 1], [3, 2], &holes.map(|hole| hole != 0)).unwrap();
    step_alike(&c, &mut rust, 30);
    assert!(pose(&c, faller).position.y < -0.5);
    // SAFETY: the world is alive, and all places are.
    ok(unsafe { bs_shape_set_holes(c.0, ground, 1, 1, 3, 2, [0; 6].as_ptr()) });
    rust.set_holes(twin, [1, 1], [3, 2], &[false; 6]).unwrap();
    add_boxes(&c, &mut rust, DVec3::new(2.5, 0.5, 2.5));
    step_alike(&c, &mut rust, 60);
}

/// A sensor in a wall. Expected: it notices nothing, then, told to, the wall, and nothing again; the hashes
/// are those of Rust.
#[test]
fn sensors_notice_walls_alike() {
    let (c, mut rust) = twins();
    fixed(&mut rust, ShapeDesc::new(Geometry::cuboid(1.0, 1.0, 1.0)));
    add(&c, BS_BODY_STATIC, bs_box(1.0, 1.0, 1.0), dvec3(0.0, 0.0, 0.0));
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 }).with_sensor(true).with_senses_static(true);
    let body = rust.add_body(&BodyDesc::kinematic().with_shape(ball)).unwrap();
    let twin = rust.shapes(body).unwrap().next().unwrap();
    let mut desc = bs_shape_desc_default(bs_sphere(0.5));
    (desc.sensor, desc.senses_static) = (1, 1);
    let sensor = shape_of(&c, add_shape(&c, BS_BODY_KINEMATIC, &desc, dvec3(0.0, 0.0, 0.0)));
    let (mut senses, mut count) = (9, 9);
    for on in [true, false, true] {
        // SAFETY: the world is alive, and all places are.
        unsafe {
            ok(bs_shape_set_senses_static(c.0, sensor, on.into()));
            ok(bs_shape_senses_static(c.0, sensor, &mut senses));
        }
        rust.set_senses_static(twin, on).unwrap();
        step_alike(&c, &mut rust, 2);
        let expected = usize::from(on);
        // SAFETY: the world is alive, and all places are.
        let status = unsafe { bs_sensor_overlaps(c.0, sensor, null_mut(), 0, &mut count) };
        assert_eq!(status, if on { BS_ERROR_BUFFER } else { BS_OK });
        assert_eq!((usize::from(senses), count), (expected, expected));
    }
    // SAFETY: the world is alive, and all places are.
    unsafe {
        assert_eq!(bs_shape_set_senses_static(c.0, BsShape::NONE, 1), BS_ERROR_STALE_SHAPE);
        assert_eq!(bs_shape_senses_static(c.0, BsShape::NONE, &mut senses), BS_ERROR_STALE_SHAPE);
    }
}
