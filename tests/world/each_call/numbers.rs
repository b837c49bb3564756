//! Every number of every call: too large, too small, negative, NaN.
//!
//! Seen: `add_body` took a centre of mass of 3.4e38 and left a position of NaN. Expected: each call refuses a
//! number that is out of its range and changes nothing, or it is taken and steps leave finite numbers.

use super::tables::{drives, forms, limits, masses, materials, settings, walkers};
use crate::common;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    Aabb, Axis, BodyDesc, BodyHandle, Character, CharacterHandle, CharacterSettings, ContactHook,
    ContactHooks, ConvexHull, CouplingDesc, CouplingHandle, Error, Explosion, Frame, Geometry, HeightField,
    JointDesc, JointHandle, Motion, Motor, QueryFilter, Ray, Settings, ShapeCast, ShapeDesc, ShapeHandle,
    Skeleton, Snapshot, TriangleMesh, World,
};
use std::sync::Mutex;

/// Beyond any range, at the end of some, and the smallest that there are.
const VALUES: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    3.4e38,
    -3.4e38,
    1e30,
    1e18,
    1e9,
    -1e9,
    1e6,
    -1e6,
    1e-40,
    -1e-40,
    1e-6,
];

/// A world of a few things, with a handle of each.
struct Content {
    world: World,
    body: BodyHandle,
    fixed: BodyHandle,
    platform: BodyHandle,
    shape: ShapeHandle,
    field: ShapeHandle,
    hinge: JointHandle,
    gear: CouplingHandle,
    character: CharacterHandle,
}

fn block(at: DVec3) -> BodyDesc {
    let mut desc =
        BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::cuboid(0.3, 0.3, 0.3)));
    desc.shapes[0].hooks = true;
    desc
}

impl Content {
    fn new() -> Content {
        let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
        let field = HeightField::new(9, 9, Vec2::splat(1.0), vec![0.0; 81]).unwrap();
        let ground = ShapeDesc::new(Geometry::height_field(field)).with_position(Vec3::new(-4.0, 0.0, -4.0));
        let fixed = world.add_body(&BodyDesc::fixed().with_shape(ground)).unwrap();
        let field = world.shapes(fixed).unwrap().next().unwrap();
        let body = world.add_body(&block(DVec3::new(0.0, 0.31, 0.0))).unwrap();
        let shape = world.shapes(body).unwrap().next().unwrap();
        let mut plate = block(DVec3::new(3.0, 1.0, 0.0));
        plate.kind = backstop::BodyKind::Kinematic;
        let platform = world.add_body(&plate).unwrap();
        let hinges = [2.0, 3.0].map(|y| {
            let wheel = world.add_body(&block(DVec3::new(-2.0, y, 0.0))).unwrap();
            let at = DVec3::new(-2.0, y + 0.2, 0.0);
            let frames = world.frames_at([fixed, wheel], at, Quat::IDENTITY).unwrap();
            let drive = Motor::velocity(Motion::Angular, Axis::X, 1.0, 10.0);
            world.add_joint(&JointDesc::hinge([fixed, wheel], frames).with_motor(drive)).unwrap()
        });
        let gear = world.add_coupling(&CouplingDesc::gear(hinges, [1.0, 2.0])).unwrap();
        let walker = Character::new(CharacterSettings::default(), DVec3::new(0.0, 1.0, 3.0)).unwrap();
        let character = world.add_character(&walker).unwrap();
        common::steps(&mut world, 3, 1.0 / 60.0);
        let [hinge, _] = hinges;
        Content { world, body, fixed, platform, shape, field, hinge, gear, character }
    }

    /// Hash and bytes of its state.
    fn state(&self) -> (u64, Vec<u8>) {
        let mut snapshot = Snapshot::new();
        self.world.snapshot(&mut snapshot);
        (self.world.state_hash(), snapshot.to_whole_bytes())
    }
}

/// Calls with one number at a place of one of them; they may have returned numbers that are not finite.
type Call = Box<dyn Fn(&mut Content, f64) -> Result<bool, Error>>;

/// Calls by name.
#[derive(Default)]
struct Calls(Vec<(String, Call)>);

impl Calls {
    fn add(&mut self, name: &str, call: impl Fn(&mut Content, f64) -> Result<(), Error> + 'static) {
        self.0.push((name.into(), Box::new(move |content, x| call(content, x).map(|()| true))));
    }

    /// A call that answers, with whether the answer is finite.
    fn ask(&mut self, name: &str, call: impl Fn(&World, f64) -> Result<bool, Error> + 'static) {
        self.0.push((name.into(), Box::new(move |content, x| call(&content.world, x))));
    }

    /// A number along each axis.
    fn along(
        &mut self,
        name: &str,
        call: impl Fn(&mut Content, DVec3) -> Result<(), Error> + Clone + 'static,
    ) {
        for (axis, unit) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)] {
            let call = call.clone();
            // Not a product: infinity times zero is NaN along the other axes.
            self.add(&format!("{name}.{axis}"), move |content, x| {
                call(content, DVec3::select(unit.cmpgt(DVec3::ZERO), DVec3::splat(x), DVec3::ZERO))
            });
        }
    }

    /// A change of a description that is then added.
    fn desc(&mut self, name: &str, change: impl Fn(&mut BodyDesc, f64) + 'static) {
        self.add(name, move |content, x| {
            let mut desc = block(DVec3::new(2.0, 3.0, 2.0));
            change(&mut desc, x);
            content.world.add_body(&desc).map(drop)
        });
    }
}

/// Numbers of added objects.
fn added(calls: &mut Calls) {
    for axis in 0..3 {
        calls.desc(&format!("position {axis}"), move |desc, x| desc.position[axis] = x);
        calls.desc(&format!("velocity {axis}"), move |desc, x| desc.linear_velocity[axis] = x as f32);
        calls.desc(&format!("spin {axis}"), move |desc, x| desc.angular_velocity[axis] = x as f32);
        calls.desc(&format!("shape at {axis}"), move |desc, x| desc.shapes[0].position[axis] = x as f32);
    }
    calls.desc("rotation", |desc, x| desc.rotation.x = x as f32);
    calls.desc("shape rotation", |desc, x| desc.shapes[0].rotation.w = x as f32);
    calls.desc("gravity scale", |desc, x| desc.gravity_scale = x as f32);
    calls.desc("linear damping", |desc, x| desc.linear_damping = x as f32);
    calls.desc("angular damping", |desc, x| desc.angular_damping = x as f32);
    calls.desc("linear cap", |desc, x| desc.max_linear_speed = Some(x as f32));
    calls.desc("angular cap", |desc, x| desc.max_angular_speed = Some(x as f32));
    calls.desc("density", |desc, x| desc.shapes[0].density = x as f32);
    for (name, mass) in masses() {
        calls.desc(&format!("desc {name}"), move |desc, x| {
            desc.mass = Some(mass(x as f32));
            // Not about its principal axes, and moving.
            desc.rotation = Quat::from_xyzw(0.5, -0.5, 0.5, 0.5);
            desc.angular_velocity = Vec3::new(-1.0, 31.0, -85.0);
        });
        calls.add(&format!("set_mass {name}"), move |c, x| c.world.set_mass(c.body, mass(x as f32)));
        calls.add(&format!("set_mass of a fixed body {name}"), move |c, x| {
            c.world.set_mass(c.fixed, mass(x as f32))
        });
    }
    for (name, material) in materials() {
        calls.desc(name, move |desc, x| desc.shapes[0].material = material(x as f32));
        calls.add(&format!("set_material {name}"), move |c, x| {
            c.world.set_material(c.shape, material(x as f32))
        });
        calls.add(&format!("materials of a mesh {name}"), move |c, x| {
            let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Z];
            let triangles = vec![[0, 2, 1]];
            let mesh = TriangleMesh::with_materials(corners, triangles, &[0], &[material(x as f32)])?;
            let shape = ShapeDesc::new(Geometry::mesh(mesh));
            c.world.add_body(&BodyDesc::fixed().with_shape(shape)).map(drop)
        });
    }
    for (name, form) in forms() {
        calls.desc(name, move |desc, x| desc.shapes[0].geometry = form(x as f32));
        calls.add(&format!("set_geometry {name}"), move |c, x| c.world.set_geometry(c.shape, form(x as f32)));
        calls.add(&format!("add_shape {name}"), move |c, x| {
            c.world.add_shape(c.body, &ShapeDesc::new(form(x as f32))).map(drop)
        });
    }
    for (name, walker) in walkers() {
        calls.add(&format!("character {name}"), move |c, x| {
            let settings = walker(CharacterSettings::default(), x as f32);
            let walker = Character::new(settings, DVec3::new(1.0, 2.0, 1.0))?;
            c.character = c.world.add_character(&walker)?;
            Ok(())
        });
    }
    calls.along("character at", |c, at| {
        let walker = Character::new(CharacterSettings::default(), at)?;
        c.character = c.world.add_character(&walker)?;
        Ok(())
    });
}

/// Numbers of geometry.
fn geometry(calls: &mut Calls) {
    calls.along("hull", |c, at| {
        let hull = ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, at.as_vec3()])?;
        c.world.set_geometry(c.shape, Geometry::hull(hull))
    });
    calls.along("scaled hull", |c, at| {
        let hull = ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z])?;
        let scale = Vec3::select(at.as_vec3().cmpeq(Vec3::ZERO), Vec3::ONE, at.as_vec3());
        c.world.set_geometry(c.shape, Geometry::hull(hull.scaled(scale)?))
    });
    calls.along("mesh", |c, at| {
        let mesh =
            TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Z, at.as_vec3()], vec![[0, 2, 1], [1, 2, 3]])?;
        c.world.add_shape(c.fixed, &ShapeDesc::new(Geometry::mesh(mesh))).map(drop)
    });
    calls.along("scaled mesh", |c, at| {
        let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Z], vec![[0, 2, 1]])?;
        let scale = Vec3::select(at.as_vec3().cmpeq(Vec3::ZERO), Vec3::ONE, at.as_vec3());
        c.world.add_shape(c.fixed, &ShapeDesc::new(Geometry::mesh(mesh.scaled(scale)?))).map(drop)
    });
    calls.along("scaled field", |c, at| {
        let field = HeightField::new(3, 3, Vec2::ONE, vec![0.5; 9])?;
        let scale = Vec3::select(at.as_vec3().cmpeq(Vec3::ZERO), Vec3::ONE, at.as_vec3());
        c.world.add_shape(c.fixed, &ShapeDesc::new(Geometry::height_field(field.scaled(scale)?))).map(drop)
    });
    calls.add("height", |c, x| {
        let field = HeightField::new(2, 2, Vec2::ONE, vec![0.0, x as f32, 0.0, 0.0])?;
        c.world.add_shape(c.fixed, &ShapeDesc::new(Geometry::height_field(field))).map(drop)
    });
    calls.add("cell", |c, x| {
        let field = HeightField::new(2, 2, Vec2::new(x as f32, 1.0), vec![0.0; 4])?;
        c.world.add_shape(c.fixed, &ShapeDesc::new(Geometry::height_field(field))).map(drop)
    });
    calls.add("set_heights", |c, x| c.world.set_heights(c.field, [4, 4], [1, 1], &[x as f32]));
}

/// Numbers of calls on bodies and shapes.
fn changed(calls: &mut Calls) {
    calls.along("set_pose", |c, at| c.world.set_pose(c.body, at, Quat::IDENTITY));
    calls.along("set_pose of a fixed body", |c, at| c.world.set_pose(c.fixed, at, Quat::IDENTITY));
    calls.add("set_pose rotation", |c, x| {
        c.world.set_pose(c.body, DVec3::Y, Quat::from_xyzw(0.0, x as f32, 0.0, 1.0))
    });
    calls.along("set_velocity", |c, v| c.world.set_velocity(c.body, v.as_vec3(), Vec3::ZERO));
    calls.along("set_velocity, spin", |c, v| c.world.set_velocity(c.platform, Vec3::ZERO, v.as_vec3()));
    calls.along("set_linear_velocity", |c, v| c.world.set_linear_velocity(c.platform, v.as_vec3()));
    calls.along("set_angular_velocity", |c, v| c.world.set_angular_velocity(c.body, v.as_vec3()));
    for moves in [World::move_kinematic, World::move_kinematic_and_stop] {
        calls.along("move_kinematic", move |c, at| {
            moves(&mut c.world, c.platform, at, Quat::IDENTITY, 1.0 / 60.0)
        });
        calls.along("move_kinematic of a dynamic body", move |c, at| {
            moves(&mut c.world, c.body, at, Quat::IDENTITY, 10.0)
        });
        calls.add("move_kinematic rotation", move |c, x| {
            moves(&mut c.world, c.platform, DVec3::Y, Quat::from_xyzw(x as f32, 0.0, 0.0, 1.0), 0.1)
        });
        calls.add("move_kinematic dt", move |c, x| {
            moves(&mut c.world, c.platform, DVec3::Y, Quat::IDENTITY, x as f32)
        });
    }
    calls.add("set_gravity_scale", |c, x| c.world.set_gravity_scale(c.body, x as f32));
    calls.add("set_damping", |c, x| c.world.set_damping(c.body, x as f32, 0.0));
    calls.add("set_damping, angular", |c, x| c.world.set_damping(c.body, 0.0, x as f32));
    calls.add("set_max_speeds", |c, x| c.world.set_max_speeds(c.body, Some(x as f32), None));
    calls.add("set_max_speeds, angular", |c, x| c.world.set_max_speeds(c.body, None, Some(x as f32)));
    calls.add("set_density", |c, x| c.world.set_density(c.shape, x as f32));
    calls.along("set_shape_pose", |c, at| c.world.set_shape_pose(c.shape, at.as_vec3(), Quat::IDENTITY));
    calls.add("set_shape_pose rotation", |c, x| {
        c.world.set_shape_pose(c.shape, Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, x as f32))
    });
    calls.along("set_origin", |c, at| c.world.set_origin(at));
    calls.add("step", |c, x| c.world.step(x as f32).map(drop));
    for (name, change) in settings() {
        calls.add(name, move |c, x| {
            let new = change(c.world.settings().clone(), x as f32);
            assert_eq!(World::new(new.clone()).is_ok(), new.validate().is_ok());
            c.world.set_settings(new)
        });
    }
    for (name, walker) in walkers() {
        calls.add(&format!("set_settings of a character, {name}"), move |c, x| {
            let mut character = c.world.character(c.character)?;
            character.set_settings(walker(CharacterSettings::default(), x as f32))?;
            c.world.set_character(c.character, &character)
        });
    }
    calls.along("walk", |c, v| {
        c.world.walk_character(c.character, &QueryFilter::new(), v.as_vec3(), 1.0 / 60.0).map(drop)
    });
    calls.add("walk, dt", |c, x| {
        c.world.walk_character(c.character, &QueryFilter::new(), Vec3::X, x as f32).map(drop)
    });
    calls.along("place", |c, at| {
        let mut character = c.world.character(c.character)?;
        character.set_position(at)?;
        c.world.set_character(c.character, &character)
    });
}

/// Numbers of forces, impulses and explosions.
fn pushed(calls: &mut Calls) {
    calls.along("force", |c, v| c.world.add_force(c.body, v.as_vec3()));
    calls.along("torque", |c, v| c.world.add_torque(c.body, v.as_vec3()));
    calls.along("force and torque", |c, v| c.world.add_force_and_torque(c.body, v.as_vec3(), Vec3::ZERO));
    calls.along("torque with a force", |c, v| c.world.add_force_and_torque(c.body, Vec3::ZERO, v.as_vec3()));
    calls.along("impulse at the centre", |c, v| c.world.apply_impulse(c.body, v.as_vec3()));
    calls.along("force at", |c, at| c.world.add_force_at(c.body, Vec3::ONE, at));
    calls.along("force there", |c, v| c.world.add_force_at(c.body, v.as_vec3(), DVec3::splat(100.0)));
    calls.along("impulse", |c, v| c.world.apply_impulse_at(c.body, v.as_vec3(), DVec3::ZERO));
    calls.along("impulse at", |c, at| c.world.apply_impulse_at(c.body, Vec3::ONE, at));
    calls.along("angular impulse", |c, v| c.world.apply_angular_impulse(c.body, v.as_vec3()));
    calls.along("explosion at", |c, at| {
        c.world.apply_explosion(&Explosion::default().with_position(at)).map(drop)
    });
    calls.add("explosion radius", |c, x| {
        c.world.apply_explosion(&Explosion::default().with_radius(x as f32)).map(drop)
    });
    calls.add("explosion falloff", |c, x| {
        c.world.apply_explosion(&Explosion::default().with_falloff(x as f32)).map(drop)
    });
    calls.add("explosion impulse", |c, x| {
        c.world.apply_explosion(&Explosion::default().with_impulse_per_area(x as f32)).map(drop)
    });
}

/// Numbers of joints.
fn joined(calls: &mut Calls) {
    let free = |c: &Content| JointDesc::new([c.fixed, c.body], [Frame::at(Vec3::Y), Frame::default()]);
    for (name, drive) in drives() {
        calls.add(&format!("drive {name}"), move |c, x| {
            c.world.add_joint(&free(c).with_motor(drive(x as f32))).map(drop)
        });
        calls.add(&format!("set_joint_motor {name}"), move |c, x| {
            c.world.set_joint_motor(c.hinge, drive(x as f32))
        });
        calls.add(&format!("set_joint_motors {name}"), move |c, x| {
            c.world.set_joint_motors(c.hinge, &[drive(x as f32)])
        });
    }
    for (name, limit) in limits() {
        calls.add(&format!("limit {name}"), move |c, x| {
            c.world.add_joint(&free(c).with_limit(limit(x as f32))).map(drop)
        });
        calls.add(&format!("set_joint_limit {name}"), move |c, x| {
            c.world.set_joint_limit(c.hinge, limit(x as f32))
        });
        calls.add(&format!("set_joint_limits {name}"), move |c, x| {
            c.world.set_joint_limits(c.hinge, &[limit(x as f32)])
        });
    }
    calls.along("frame", move |c, at| {
        let frames = [Frame::at(at.as_vec3()), Frame::default()];
        c.world.add_joint(&JointDesc::ball([c.fixed, c.body], frames)).map(drop)
    });
    calls.along("set_joint_frames", |c, at| {
        c.world.set_joint_frames(c.hinge, [Frame::default(), Frame::at(at.as_vec3())])
    });
    calls.add("frame rotation", |c, x| {
        let turned = Frame::default().with_rotation(Quat::from_xyzw(x as f32, 0.0, 0.0, 1.0));
        c.world.set_joint_frames(c.hinge, [Frame::default(), turned])
    });
    calls.add("set_joint_target", |c, x| {
        c.world.set_joint_target(c.hinge, Motion::Angular, Axis::X, x as f32, 0.0)
    });
    calls.add("set_joint_target, velocity", |c, x| {
        c.world.set_joint_target(c.hinge, Motion::Angular, Axis::X, 0.0, x as f32)
    });
    calls.add("set_joint_break_force", |c, x| c.world.set_joint_break_force(c.hinge, x as f32, x as f32));
    calls.add("set_joint_thresholds", |c, x| c.world.set_joint_thresholds(c.hinge, x as f32, x as f32));
}

/// Numbers of couplings and ragdolls.
fn coupled(calls: &mut Calls) {
    calls.add("set_coupling_factors", |c, x| c.world.set_coupling_factors(c.gear, [x, 1.0]));
    calls.add("set_coupling_range", |c, x| c.world.set_coupling_range(c.gear, Some([x, x])));
    calls.add("set_coupling_range, max", |c, x| {
        c.world.set_coupling_range(c.gear, Some([f64::NEG_INFINITY, x]))
    });
    calls.add("set_coupling_break_force", |c, x| c.world.set_coupling_break_force(c.gear, [x as f32, 1.0]));
    calls.add("add_coupling", |c, x| {
        let desc = c.world.coupling(c.gear)?;
        c.world.remove_coupling(c.gear)?;
        let [mut one, other] = desc.motions;
        one.factor = x;
        let range = Some([-1.0, x]);
        // A refused number leaves the old one.
        let new = CouplingDesc::new([one, other]).with_range(range);
        let added = c.world.add_coupling(&new);
        if added.is_err() {
            *c = Content::new();
        }
        added.map(drop)
    });
    calls.along("frames_at", |c, at| {
        let frames = c.world.frames_at([c.fixed, c.body], at, Quat::IDENTITY)?;
        c.world.add_joint(&JointDesc::ball([c.fixed, c.body], frames)).map(drop)
    });
    calls.add("skeleton density", |c, x| {
        let doll = Skeleton::humanoid().with_density(x as f32);
        doll.add_to(&mut c.world, DVec3::Y * 2.0, Quat::IDENTITY, Vec3::ZERO).map(drop)
    });
    calls.add("skeleton friction", |c, x| {
        let doll = Skeleton::humanoid().with_friction(x as f32);
        doll.add_to(&mut c.world, DVec3::Y * 2.0, Quat::IDENTITY, Vec3::ZERO).map(drop)
    });
    calls.along("ragdoll", |c, at| {
        Skeleton::humanoid().add_to(&mut c.world, at, Quat::IDENTITY, Vec3::ZERO).map(drop)
    });
    calls.along("ragdoll, velocity", |c, v| {
        Skeleton::humanoid().add_to(&mut c.world, DVec3::Y, Quat::IDENTITY, v.as_vec3()).map(drop)
    });
    calls.add("ragdoll, rotation", |c, x| {
        let turned = Quat::from_xyzw(0.0, x as f32, 0.0, 1.0);
        Skeleton::humanoid().add_to(&mut c.world, DVec3::Y, turned, Vec3::ZERO).map(drop)
    });
}

/// Numbers of queries.
fn asked(calls: &mut Calls) {
    for axis in 0..3 {
        let at = move |x: f64| {
            let mut at = DVec3::Y;
            at[axis] = x;
            at
        };
        calls.ask("cast_ray", move |w, x| {
            let hit = w.cast_ray(&Ray::new(at(x), Vec3::NEG_Y * 9.0), &QueryFilter::new())?;
            Ok(hit.is_none_or(|hit| hit.point.is_finite() && hit.normal.is_finite()))
        });
        calls.ask("cast_ray, path", move |w, x| {
            let hit = w.cast_ray(&Ray::new(DVec3::Y * 5.0, at(x).as_vec3()), &QueryFilter::new())?;
            Ok(hit.is_none_or(|hit| hit.point.is_finite() && hit.normal.is_finite()))
        });
        calls.ask("cast_shape", move |w, x| {
            let (ball, filter) = (Geometry::sphere(0.2), QueryFilter::new());
            let casts = [
                ShapeCast::new(&ball, at(x), Vec3::NEG_Y),
                ShapeCast::new(&ball, DVec3::Y * 5.0, at(x).as_vec3()),
                ShapeCast::new(&ball, DVec3::Y * 5.0, Vec3::NEG_Y * 6.0).with_spin(at(x).as_vec3()),
                ShapeCast::new(&ball, DVec3::Y * 5.0, Vec3::NEG_Y * 6.0)
                    .with_spin(Vec3::X)
                    .with_pivot(at(x).as_vec3()),
            ];
            let mut sound = true;
            for cast in casts {
                sound &= w.cast_shape(&cast, &filter)?.is_none_or(|hit| hit.point.is_finite());
            }
            Ok(sound)
        });
        calls.ask("overlap", move |w, x| {
            let (mut found, ball) = (vec![], Geometry::sphere(0.2));
            w.overlap(&ball, at(x), Quat::IDENTITY, &QueryFilter::new(), &mut found).map(|()| true)
        });
        calls.ask("overlap_aabb", move |w, x| {
            let area = Aabb { min: DVec3::NEG_ONE, max: at(x) };
            w.overlap_aabb(&area, &QueryFilter::new(), &mut vec![]).map(|()| true)
        });
        calls.ask("closest_point", move |w, x| {
            let found = w.closest_point(at(x), 100.0, &QueryFilter::new())?;
            Ok(found.is_none_or(|found| found.point.is_finite() && found.distance.is_finite()))
        });
        calls.ask("velocity_at", move |w, x| {
            let body = w.bodies().next().unwrap();
            Ok(w.velocity_at(body, at(x))?.is_finite())
        });
    }
    for (_, form) in forms() {
        calls.ask("overlap, form", move |w, x| {
            let form = form(x as f32);
            w.overlap(&form, DVec3::Y, Quat::IDENTITY, &QueryFilter::new(), &mut vec![]).map(|()| true)
        });
    }
    calls.ask("closest_point, distance", |w, x| {
        let found = w.closest_point(DVec3::Y, x as f32, &QueryFilter::new())?;
        Ok(found.is_none_or(|found| found.point.is_finite() && found.distance.is_finite()))
    });
}

/// Has hooks say the same number of each contact.
struct Says(f64, Mutex<Result<(), Error>>);

impl ContactHooks for Says {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let x = self.0 as f32;
        let said = [
            contact.set_friction(x, 0.5),
            contact.set_friction(0.5, x),
            contact.set_restitution(x),
            contact.set_surface_velocity(0, Vec3::new(x, 0.0, 0.0)),
        ];
        *self.1.lock().unwrap() = said.into_iter().collect();
    }
}

#[test]
fn each_number_of_each_call_is_refused_or_steps_leave_numbers() {
    let mut calls = Calls::default();
    added(&mut calls);
    geometry(&mut calls);
    changed(&mut calls);
    pushed(&mut calls);
    joined(&mut calls);
    coupled(&mut calls);
    asked(&mut calls);
    // Hooks: a refused number has no effect.
    calls.add("hooks", |c, x| {
        let says = Says(x, Mutex::new(Ok(())));
        c.world.step_with(1.0 / 60.0, &says).map(drop)
    });
    let (mut wrong, mut refused) = (Vec::new(), 0);
    for (name, call) in &calls.0 {
        for value in VALUES {
            let mut content = Content::new();
            let before = content.state();
            match call(&mut content, value) {
                Err(_) => {
                    refused += 1;
                    if content.state() != before {
                        wrong.push(format!("{name} {value:e}: refused, and changed the world"));
                    }
                }
                Ok(false) => wrong.push(format!("{name} {value:e}: answered what is not finite")),
                Ok(true) => {
                    if let Some(what) = run(&mut content) {
                        wrong.push(format!("{name} {value:e}: {what}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    // NaN and infinities, and more: of the 14 values at least these two, but where infinity means never.
    assert!(refused > 2 * calls.0.len(), "{refused} of {} calls", calls.0.len());
}

/// Thirty steps, with a walk in each; returns the first error.
fn run(content: &mut Content) -> Option<String> {
    for step in 0..30 {
        if !common::all_finite(&content.world) {
            return Some(format!("not finite after {step} steps"));
        }
        if let Err(error) = content.world.step(1.0 / 60.0) {
            return Some(error.to_string());
        }
        let (wish, filter) = (Vec3::new(1.0, -1.0, 0.0), QueryFilter::new());
        let _ = content.world.walk_character(content.character, &filter, wish, 1.0 / 60.0);
        if !content.world.character(content.character).unwrap().position().is_finite() {
            return Some(format!("a character is nowhere after {step} steps"));
        }
    }
    (!common::all_finite(&content.world)).then(|| "not finite in the end".into())
}
