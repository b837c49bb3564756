//! A scene that is built through the interface is the scene that is built in Rust: the same bits after the
//! same steps, and the same answers. Expected values are those of the crate `backstop`.

mod common;

use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, ConvexHull, Geometry, HeightField, JointDesc, Limit, Motion, Motor,
    QueryFilter, Ray, Settings, ShapeCast, ShapeDesc, Skeleton, Spring, TriangleMesh,
};
use backstop_c::*;
use common::*;
use std::ptr::{null, null_mut};
use std::sync::Arc;

fn corners() -> Vec<[f32; 3]> {
    let corner = |i: i32| {
        let i = i as f32;
        [(i * 0.77) % 1.7 - 0.8, (i * 1.9) % 1.3 - 0.6, (i * 0.31) % 2.0 - 0.9]
    };
    (0..20).map(corner).collect()
}

fn heights() -> Vec<f32> {
    (0..36).map(|i| (i * i % 5) as f32 * 0.1).collect()
}

const VERTICES: [[f32; 3]; 4] = [[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// Every geometry, in Rust.
fn geometries() -> Vec<Geometry> {
    let points: Vec<_> = corners().into_iter().map(Vec3::from).collect();
    let vertices = VERTICES.map(Vec3::from).into();
    vec![
        Geometry::Sphere { radius: 0.4 },
        Geometry::Capsule { half_height: 0.5, radius_bottom: 0.3, radius_top: 0.2 },
        Geometry::cuboid(0.3, 0.4, 0.5),
        Geometry::Cylinder { half_height: 0.4, radius_bottom: 0.5, radius_top: 0.25 },
        Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap())),
        Geometry::Plane,
        Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, TRIANGLES.into()).unwrap())),
        Geometry::HeightField(Arc::new(HeightField::new(6, 6, Vec2::ONE, heights()).unwrap())),
    ]
}

/// The same through the interface, with the objects that are to be released.
struct Assets {
    hull: *const BsHull,
    mesh: *const BsMesh,
    field: *const BsHeightField,
}

impl Assets {
    fn new() -> Assets {
        let points: Vec<_> = corners().into_iter().map(|[x, y, z]| vec3(x, y, z)).collect();
        let vertices = VERTICES.map(|[x, y, z]| vec3(x, y, z));
        let (mut hull, mut mesh, mut field) = (null(), null(), null());
        // SAFETY: all pointers are to what lives here.
        unsafe {
            ok(bs_hull_create(points.as_ptr(), points.len(), &mut hull));
            ok(bs_mesh_create(vertices.as_ptr(), 4, TRIANGLES.as_ptr().cast(), 2, &mut mesh));
            ok(bs_height_field_create(6, 6, 1.0, 1.0, heights().as_ptr(), &mut field));
        }
        Assets { hull, mesh, field }
    }

    fn geometries(&self) -> Vec<BsGeometry> {
        vec![
            bs_sphere(0.4),
            bs_capsule(0.5, 0.3, 0.2),
            bs_box(0.3, 0.4, 0.5),
            bs_cylinder(0.4, 0.5, 0.25),
            bs_hull(self.hull),
            bs_plane(),
            bs_mesh(self.mesh),
            bs_height_field(self.field),
        ]
    }
}

impl Drop for Assets {
    fn drop(&mut self) {
        // SAFETY: each has the reference of `new`.
        unsafe {
            bs_hull_release(self.hull);
            bs_mesh_release(self.mesh);
            bs_height_field_release(self.field);
        }
    }
}

/// A plane, a mesh and a field, and forty convex bodies over them.
fn rust_scene() -> (backstop::World, Vec<BodyHandle>) {
    let mut world = backstop::World::new(Settings::default()).unwrap();
    let geometries = geometries();
    let mut bodies = Vec::new();
    for (i, at) in [(5, [0.0, -1.0, 0.0]), (6, [0.0, 0.0, 0.0]), (7, [6.0, -0.5, 0.0])] {
        let shape = ShapeDesc::new(geometries[i].clone());
        let desc = BodyDesc::fixed().with_position(DVec3::from_array(at)).with_shape(shape);
        bodies.push(world.add_body(&desc).unwrap());
    }
    let desc = |i: usize| {
        let mut shape = ShapeDesc::new(geometries[i % 5].clone());
        shape.material.restitution = (i % 3) as f32 * 0.2;
        shape.events = i.is_multiple_of(4);
        let at = DVec3::new((i % 4) as f64 * 2.0 - 1.0, 1.0 + i as f64 * 0.5, (i % 3) as f64 - 1.0);
        let desc = BodyDesc::dynamic().with_position(at).with_rotation(Quat::from_xyzw(0.0, 0.6, 0.0, 0.8));
        let desc = desc.with_velocity(Vec3::new(0.0, -5.0, 0.3), Vec3::new(1.0, 0.0, i as f32));
        desc.with_shape(shape)
    };
    let descs: Vec<_> = (0..40).map(desc).collect();
    bodies.extend(world.add_bodies(&descs).unwrap());
    (world, bodies)
}

fn c_scene() -> (World, Vec<BsBody>) {
    let (world, assets) = (world(), Assets::new());
    let geometries = assets.geometries();
    let mut bodies = Vec::new();
    for (i, [x, y, z]) in [(5, [0.0, -1.0, 0.0]), (6, [0.0, 0.0, 0.0]), (7, [6.0, -0.5, 0.0])] {
        bodies.push(add(&world, BS_BODY_STATIC, geometries[i], dvec3(x, y, z)));
    }
    let shape = |i: usize| {
        let mut shape = bs_shape_desc_default(geometries[i % 5]);
        shape.material.restitution = (i % 3) as f32 * 0.2;
        shape.events = i.is_multiple_of(4).into();
        shape
    };
    let shapes: Vec<_> = (0..40).map(shape).collect();
    let desc = |i: usize| {
        let mut desc = bs_body_desc_default();
        desc.position = dvec3((i % 4) as f64 * 2.0 - 1.0, 1.0 + i as f64 * 0.5, (i % 3) as f64 - 1.0);
        desc.rotation = BsQuat { x: 0.0, y: 0.6, z: 0.0, w: 0.8 };
        desc.linear_velocity = vec3(0.0, -5.0, 0.3);
        desc.angular_velocity = vec3(1.0, 0.0, i as f32);
        (desc.shapes, desc.shape_count) = (&shapes[i], 1);
        desc
    };
    let descs: Vec<_> = (0..40).map(desc).collect();
    let mut added = [NO_BODY; 40];
    // SAFETY: all pointers are to what lives here. Assets are released, and shapes keep them.
    ok(unsafe { bs_world_add_bodies(world.0, descs.as_ptr(), 40, added.as_mut_ptr()) });
    bodies.extend(added);
    (world, bodies)
}

#[test]
fn shapes_of_every_kind_fall_alike() {
    let ((mut rust, handles), (c, bodies)) = (rust_scene(), c_scene());
    for step in 0..120 {
        rust.step(1.0 / 60.0).unwrap();
        steps(&c, 1);
        assert_eq!(hash(&c), rust.state_hash(), "step {step}");
        same_events(&c, &rust);
    }
    for (&body, &handle) in bodies.iter().zip(&handles) {
        let (pose, at) = (pose(&c, body), rust.position(handle).unwrap());
        assert_eq!(pose.position, dvec3(at.x, at.y, at.z));
        assert_eq!((body.slot, body.generation), {
            let bits = handle.to_bits();
            (bits as u32, (bits >> 32) as u32)
        });
    }
    same_reports(&c, &rust);
    same_columns(&c, &rust, &bodies);
    same_queries(&c, &rust);
}

/// Events as arrays are those of the engine.
fn same_events(c: &World, rust: &backstop::World) {
    let (mut begins, mut ends, mut count) = (null(), null(), 0);
    // SAFETY: the world is alive, and not stepped before the arrays are read.
    let begins = unsafe {
        ok(bs_world_contact_begins(c.0, &mut begins, &mut count));
        std::slice::from_raw_parts(begins, count)
    };
    assert_eq!(begins.len(), rust.contact_begins().len());
    for (own, engine) in begins.iter().zip(rust.contact_begins()) {
        assert_eq!(own.bodies.map(BodyHandle::from), engine.bodies);
        assert_eq!(own.impulse, engine.impulse);
        assert_eq!(own.point, engine.point.into());
    }
    // SAFETY: as above.
    unsafe { ok(bs_world_contact_ends(c.0, &mut ends, &mut count)) };
    assert_eq!(count, rust.contact_ends().len());
}

fn same_reports(c: &World, rust: &backstop::World) {
    let mut report = BsStepReport { size: size_of::<BsStepReport>() as u32, ..BsStepReport::default() };
    let mut memory = BsMemoryReport { size: size_of::<BsMemoryReport>() as u32, ..BsMemoryReport::default() };
    let mut energy = 0.0;
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_world_report(c.0, &mut report));
        ok(bs_world_memory(c.0, &mut memory));
        ok(bs_world_energy(c.0, &mut energy));
    }
    let engine = rust.report();
    let counts = (report.pairs, report.manifolds, report.real, report.potential, report.faulted);
    assert_eq!(counts, (engine.pairs, engine.manifolds, engine.real, engine.potential, engine.faulted));
    assert!(report.real > 0 && report.step_us > 0.0);
    assert_eq!(memory.total, rust.memory().total() as u64);
    assert_eq!(memory.of.iter().map(|of| of.reserved).sum::<u64>(), memory.total);
    assert_eq!(energy, rust.energy());
}

/// Columns of any stride, in double and in single precision, equal the answers of single calls.
fn same_columns(c: &World, rust: &backstop::World, bodies: &[BsBody]) {
    #[repr(C, packed)]
    #[derive(Clone, Copy, Default)]
    struct Row {
        odd: u8,
        position: [f64; 3],
        rotation: [f32; 4],
        linear: [f32; 3],
    }
    let mut rows = vec![Row::default(); bodies.len()];
    let mut single = vec![[0.0_f32; 3]; bodies.len()];
    let mut columns = bs_columns_default();
    let stride = size_of::<Row>() as u32;
    (columns.position_stride, columns.rotation_stride, columns.linear_stride) = (stride, stride, stride);
    let mut plain = bs_columns_default();
    (plain.position_type, plain.positions) = (BS_POSITIONS_F32, single.as_mut_ptr().cast());
    // SAFETY: buffers have place for all bodies by their strides.
    unsafe {
        let base = rows.as_mut_ptr().cast::<u8>();
        columns.positions = base.add(std::mem::offset_of!(Row, position)).cast();
        columns.rotations = base.add(std::mem::offset_of!(Row, rotation)).cast();
        columns.linear_velocities = base.add(std::mem::offset_of!(Row, linear)).cast();
        ok(bs_world_read_bodies(c.0, bodies.as_ptr(), bodies.len(), &columns));
        ok(bs_world_read_bodies(c.0, bodies.as_ptr(), bodies.len(), &plain));
        columns.position_stride = 23;
        assert_eq!(bs_world_read_bodies(c.0, bodies.as_ptr(), 1, &columns), BS_ERROR_SIZE);
        assert_eq!(bs_world_read_bodies(c.0, null(), 1, &plain), BS_ERROR_BUFFER);
        assert_eq!(bs_world_read_bodies(c.0, &NO_BODY, 1, &plain), BS_ERROR_STALE_BODY);
        ok(bs_world_read_bodies(c.0, null(), bodies.len(), &plain));
    }
    for (row, &body) in rows.iter().zip(bodies) {
        let handle = BodyHandle::from(body);
        assert_eq!({ row.position }, rust.position(handle).unwrap().to_array());
        assert_eq!({ row.rotation }, rust.rotation(handle).unwrap().to_array());
        assert_eq!({ row.linear }, rust.linear_velocity(handle).unwrap().to_array());
        assert_eq!(row.odd, 0);
    }
    let in_order: Vec<_> = rust.bodies().map(|b| rust.local_position(b).unwrap().to_array()).collect();
    assert_eq!(single, in_order);
}

fn same_queries(c: &World, rust: &backstop::World) {
    let down = |i: i32| (dvec3(i as f64 * 0.3 - 3.0, 30.0, 0.1), vec3(0.0, -40.0, 0.0));
    let rays: Vec<_> = (0..32).map(down).map(|(from, path)| BsRay { from, path, reserved: 0 }).collect();
    let mut hits = vec![BsHit::default(); rays.len()];
    // SAFETY: the world is alive, and buffers are as long as they are said to be.
    ok(unsafe { bs_world_cast_rays(c.0, rays.as_ptr(), rays.len(), null(), hits.as_mut_ptr()) });
    let filter = QueryFilter::new();
    for (ray, hit) in rays.iter().zip(&hits) {
        let engine = rust.cast_ray(&Ray::new(ray.from, ray.path.into()), &filter).unwrap();
        let mut single = BsHit::default();
        // SAFETY: the world is alive.
        ok(unsafe { bs_world_cast_ray(c.0, *ray, null(), &mut single) });
        assert_eq!(single, *hit);
        assert_eq!(hit.hit != 0, engine.is_some());
        if let Some(engine) = engine {
            assert_eq!((BodyHandle::from(hit.body), hit.fraction), (engine.body, engine.fraction));
            assert_eq!((hit.point, hit.normal), (engine.point.into(), engine.normal.into()));
        }
    }
    let (probe, own) = (Geometry::cuboid(2.0, 2.0, 2.0), bs_box(2.0, 2.0, 2.0));
    let at = BsPose { position: dvec3(0.0, 8.0, 0.0), rotation: UPRIGHT };
    let (mut count, mut hit, mut near) = (0, BsHit::default(), BsClosestPoint::default());
    let mut overlaps = [BsOverlap { body: NO_BODY, shape: BsShape::NONE }; 64];
    let path = vec3(0.0, -9.0, 0.0);
    // SAFETY: the world is alive, and buffers are as long as they are said to be.
    unsafe {
        ok(bs_world_cast_shape(c.0, &own, at, path, null(), &mut hit));
        let low = BsPose { position: dvec3(0.0, 0.5, 0.0), ..at };
        ok(bs_world_overlap(c.0, &own, low, null(), overlaps.as_mut_ptr(), 64, &mut count));
        ok(bs_world_closest_point(c.0, at.position, 20.0, null(), &mut near));
        let mut any = [9; 2];
        ok(bs_world_closest_point_any(c.0, at.position, near.distance + 1e-3, null(), &mut any[0]));
        ok(bs_world_closest_point_any(c.0, at.position, near.distance - 1e-3, null(), &mut any[1]));
        assert_eq!(any, [1, 0]);
    }
    let cast = ShapeCast::new(&probe, at.position, path.into());
    let engine = rust.cast_shape(&cast, &filter).unwrap().unwrap();
    assert_eq!((BodyHandle::from(hit.body), hit.fraction), (engine.body, engine.fraction));
    let mut found = Vec::new();
    rust.overlap(&probe, DVec3::new(0.0, 0.5, 0.0), Quat::IDENTITY, &filter, &mut found).unwrap();
    assert!(count > 0 && found.iter().map(|o| o.body).eq(overlaps[..count].iter().map(|o| o.body.into())));
    let engine = rust.closest_point(at.position.into(), 20.0, &filter).unwrap().unwrap();
    assert_eq!((BodyHandle::from(near.body), near.distance), (engine.body, engine.distance));
}

/// Expected: the hash after a restored stretch is that of the first time, here and from bytes in a new world.
#[test]
fn a_snapshot_goes_on_to_the_same_bits() {
    let (world, _) = c_scene();
    let (mut snapshot, mut copy, mut count) = (null_mut(), null_mut(), 0);
    // SAFETY: all objects are alive, and buffers are as long as they are said to be.
    unsafe {
        ok(bs_snapshot_create(&mut snapshot));
        steps(&world, 30);
        ok(bs_world_snapshot(world.0, snapshot));
        steps(&world, 30);
        let first = hash(&world);
        ok(bs_world_restore(world.0, snapshot));
        steps(&world, 30);
        assert_eq!(hash(&world), first);
        assert_eq!(bs_snapshot_to_bytes(snapshot, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        let mut bytes = vec![0; count];
        ok(bs_snapshot_to_bytes(snapshot, bytes.as_mut_ptr(), count, &mut count));
        ok(bs_snapshot_from_bytes(bytes.as_ptr(), count, &mut copy));
        let (other, _) = c_scene();
        ok(bs_world_step(other.0, 1.0 / 60.0));
        ok(bs_world_restore(other.0, copy));
        steps(&other, 30);
        assert_eq!(hash(&other), first);
        bs_snapshot_destroy(copy);
        bs_snapshot_destroy(snapshot);
    }
}

#[test]
fn joints_and_ragdolls_move_alike() {
    let mut rust = backstop::World::new(Settings::default()).unwrap();
    let c = world();
    let ball = Geometry::Sphere { radius: 0.2 };
    let anchor = BodyDesc::fixed().with_shape(ShapeDesc::new(ball.clone()));
    let mut last = rust.add_body(&anchor).unwrap();
    let mut last_c = add(&c, BS_BODY_STATIC, bs_sphere(0.2), dvec3(0.0, 0.0, 0.0));
    for i in 0..7 {
        let at = DVec3::new(i as f64 + 1.0, 0.0, 0.0);
        let desc = BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(ball.clone()));
        let next = rust.add_body(&desc).unwrap();
        let next_c = add(&c, BS_BODY_DYNAMIC, bs_sphere(0.2), at.into());
        let turn = Quat::from_xyzw(0.0, 0.8, 0.0, 0.6);
        let frames = rust.frames_at([last, next], at - DVec3::new(0.5, 0.0, 0.0), turn).unwrap();
        rust.add_joint(&joint(i, [last, next], frames)).unwrap();
        let mut desc = bs_joint_desc_default(i, last_c, next_c);
        let point = dvec3(at.x - 0.5, 0.0, 0.0);
        let limit = bs_limit_desc(BS_MOTION_ANGULAR, BS_AXIS_X, -0.5, 0.5);
        let motor = bs_motor_desc(BS_MOTION_ANGULAR, BS_AXIS_X, 1.0, 5.0);
        (desc.range_min, desc.range_max) = (0.5, 1.0);
        desc.spring = BsSpring { kind: BS_SPRING_FREQUENCY, stiffness: 5.0, damping: 1.0 };
        (desc.limits, desc.limit_count) = (&limit, (i == BS_JOINT_HINGE).into());
        (desc.motors, desc.motor_count) = (&motor, (i == BS_JOINT_HINGE).into());
        // SAFETY: the world is alive, and pointers are to what lives here.
        unsafe {
            ok(bs_joint_frames_at(c.0, last_c, next_c, point, turn.into(), desc.frames.as_mut_ptr()));
            ok(bs_world_add_joint(c.0, &desc, null_mut()));
        }
        (last, last_c) = (next, next_c);
    }
    let mut skeleton = Skeleton::humanoid();
    skeleton.friction = 2.0;
    let at = DVec3::new(0.0, 3.0, 5.0);
    let ragdoll = skeleton.add_to(&mut rust, at, Quat::IDENTITY, Vec3::X).unwrap();
    let (bodies, joints) = add_ragdoll(&c, at.into());
    assert!(ragdoll.bodies.iter().copied().eq(bodies.iter().map(|&b| b.into())));
    assert_eq!(ragdoll.joints.len(), joints.len());
    for step in 0..60 {
        rust.step(1.0 / 60.0).unwrap();
        steps(&c, 1);
        assert_eq!(hash(&c), rust.state_hash(), "step {step}");
    }
    let (mut force, mut torque) = (vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0));
    // SAFETY: the world is alive.
    ok(unsafe { bs_joint_force(c.0, joints[0], &mut force, &mut torque) });
    let engine = rust.joint_force(ragdoll.joints[0]).unwrap();
    assert_eq!((force, torque), (engine.0.into(), engine.1.into()));
    // SAFETY: the world is alive.
    unsafe {
        let free = bs_joint_desc_default(BS_JOINT_FREE, NO_BODY, NO_BODY);
        ok(bs_joint_set(c.0, joints[0], &free));
        rust.set_joint_limits(ragdoll.joints[0], &[]).unwrap();
        rust.set_joint_motors(ragdoll.joints[0], &[]).unwrap();
        ok(bs_world_remove_joint(c.0, joints[1]));
        rust.remove_joint(ragdoll.joints[1]).unwrap();
        assert_eq!(bs_world_contains_joint(c.0, joints[1]), 0);
    }
    rust.step(1.0 / 60.0).unwrap();
    steps(&c, 1);
    assert_eq!(hash(&c), rust.state_hash());
}

fn joint(kind: BsJointKind, bodies: [BodyHandle; 2], frames: [backstop::Frame; 2]) -> JointDesc {
    let about_x = Axes::One(Axis::X);
    match kind {
        BS_JOINT_FREE => JointDesc::new(bodies, frames),
        BS_JOINT_FIXED => JointDesc::fixed(bodies, frames),
        BS_JOINT_BALL => JointDesc::ball(bodies, frames),
        BS_JOINT_HINGE => JointDesc::hinge(bodies, frames)
            .with_limit(Limit::new(Motion::Angular, about_x, -0.5, 0.5))
            .with_motor(Motor::velocity(Motion::Angular, Axis::X, 1.0, 5.0)),
        BS_JOINT_SLIDER => JointDesc::slider(bodies, frames),
        BS_JOINT_DISTANCE => JointDesc::distance(bodies, frames, 0.5, 1.0),
        _ => JointDesc::wheel(bodies, frames, 1.0, Spring::Frequency { hertz: 5.0, ratio: 1.0 }),
    }
}

fn add_ragdoll(c: &World, at: BsDVec3) -> (Vec<BsBody>, Vec<BsJoint>) {
    let (mut bones, mut count) = ([bs_bone_desc_default(); 16], 0);
    let mut desc = bs_skeleton_desc_default();
    desc.friction = 2.0;
    let mut bodies = [NO_BODY; 16];
    let mut joints = [BsJoint { slot: 0, generation: 0 }; 16];
    let (pose, velocity) = (BsPose { position: at, rotation: UPRIGHT }, vec3(1.0, 0.0, 0.0));
    let mut joint_count = 0;
    // SAFETY: the world is alive, and buffers are as long as they are said to be.
    unsafe {
        ok(bs_humanoid_bones(bones.as_mut_ptr(), 16, &mut count));
        (desc.bones, desc.bone_count) = (bones.as_ptr(), count);
        let (b, j) = (bodies.as_mut_ptr(), joints.as_mut_ptr());
        let before = hash(c);
        let short = bs_world_add_ragdoll(c.0, &desc, pose, velocity, b, j, 3, &mut joint_count);
        assert_eq!((short, joint_count, hash(c)), (BS_ERROR_BUFFER, count - 1, before));
        ok(bs_world_add_ragdoll(c.0, &desc, pose, velocity, b, j, 16, &mut joint_count));
    }
    (bodies[..count].into(), joints[..joint_count].into())
}
