//! The table of docs/coming-from.md: each of our names in it compiles, and is there as it stands here.

use backstop::debug::{DebugDraw, DrawOptions};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Aabb, Axes, Axis, BodyDesc, BodyHandle, BodyKind, Character, CharacterSettings, ContinuousMode,
    CouplingDesc, Decomposition, Filter, Frame, Geometry, JointDesc, JointHandle, Limit, Material, Motion,
    Motor, NoHooks, Overlap, QueryFilter, Ray, Settings, ShapeCast, ShapeDesc, ShapeHandle, Snapshot,
    TriangleMesh, World,
};

/// Objects that the rows of the table use.
struct AtHand<'a> {
    world: &'a mut World,
    desc: BodyDesc,
    shape_desc: ShapeDesc,
    joint_desc: JointDesc,
    bodies: [BodyHandle; 2],
    body: BodyHandle,
    shape: ShapeHandle,
    joint: JointHandle,
    frames: [Frame; 2],
    geometry: Geometry,
    mesh: TriangleMesh,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    ice: Material,
    cast: ShapeCast<'a>,
    overlaps: Vec<Overlap>,
    area: Aabb,
    character: Character,
    snapshot: Snapshot,
    drawing: &'a mut dyn DebugDraw,
}

macro_rules! rows {
    ($at_hand:pat => $($row:expr;)*) => {
        /// Never called: that it compiles is the test.
        #[allow(dead_code, unused, clippy::all, reason = "only compiled")]
        fn compiles($at_hand: AtHand<'_>) {
            $(let _ = $row;)*
        }

        const ROWS: &[&str] = &[$(stringify!($row)),*];
    };
}

rows! {
    AtHand {
        world, desc, shape_desc, joint_desc, bodies, body, shape, joint, frames, geometry, mesh, vertices,
        triangles, ice, cast,
        mut overlaps, area, character, mut snapshot, drawing,
    } =>
    World::new(Settings::default());
    world.step(1.0 / 60.0);
    world.settings().substeps;
    BodyDesc::dynamic();
    BodyDesc::kinematic();
    BodyDesc::fixed();
    world.add_body(&desc);
    world.remove_body(body);
    world.set_enabled(body, false);
    world.set_kind(body, BodyKind::Kinematic);
    world.position(body);
    world.rotation(body);
    world.set_pose(body, DVec3::Y, Quat::IDENTITY);
    world.move_kinematic_and_stop(body, DVec3::Y, Quat::IDENTITY, 1.0 / 60.0);
    world.move_kinematic(body, DVec3::Y, Quat::IDENTITY, 1.0 / 60.0);
    world.linear_velocity(body);
    world.set_linear_velocity(body, Vec3::X);
    world.velocity_at(body, DVec3::Y);
    world.add_force(body, Vec3::X);
    world.add_force_at(body, Vec3::X, DVec3::Y);
    world.apply_impulse_at(body, Vec3::X, DVec3::Y);
    world.apply_angular_impulse(body, Vec3::Y);
    world.set_damping(body, 0.1, 0.1);
    world.set_max_speeds(body, Some(50.0), None);
    world.set_gravity_scale(body, 0.5);
    world.set_locked_axes(body, [false; 3], [true; 3]);
    world.set_continuous(body, ContinuousMode::Segment);
    world.wake(body);
    world.is_sleeping(body);
    world.body_moves();
    Geometry::Sphere { radius: 0.5 };
    Geometry::cuboid(0.5, 0.5, 0.5);
    Geometry::capsule(0.5, 0.2);
    mesh.scaled(Vec3::new(-1.0, 2.0, 1.0));
    Decomposition::default().run(&vertices, &triangles);
    world.set_heights(shape, [2, 3], [1, 1], &[0.5]);
    world.set_holes(shape, [2, 3], [1, 1], &[true]);
    TriangleMesh::with_materials(vertices, triangles, &[1, 0], &[ice]);
    world.add_shape(body, &shape_desc);
    world.body_of(shape);
    world.set_material(shape, Material::default().with_friction(0.3));
    world.set_material(shape, Material::default().with_rolling_friction(0.01));
    world.set_material(shape, Material::default().with_surface_velocity(Vec3::X));
    world.set_material(shape, Material::default().with_contact_hertz(8.0));
    world.set_filter(shape, Filter::default());
    world.set_sensor(shape, true);
    world.set_senses_static(shape, true);
    world.shape_aabb(shape);
    JointDesc::hinge(bodies, frames);
    JointDesc::slider(bodies, frames);
    JointDesc::ball(bodies, frames);
    JointDesc::fixed(bodies, frames);
    JointDesc::distance(bodies, frames, 0.0, 2.0);
    world.add_coupling(&CouplingDesc::gear([joint; 2], [20.0, 31.0]));
    world.add_coupling(&CouplingDesc::rack(joint, joint, 0.05));
    world.add_coupling(&CouplingDesc::pulley([joint; 2], 1.0, 4.0));
    world.add_joint(&joint_desc);
    world.set_joint_motor(joint, Motor::velocity(Motion::Angular, Axis::X, 1.0, 10.0));
    world.set_joint_limit(joint, Limit::new(Motion::Angular, Axes::One(Axis::X), -1.0, 1.0));
    world.joint_position(joint, Motion::Angular, Axes::One(Axis::X));
    world.joints_of(body);
    world.cast_ray(&Ray::new(DVec3::Y, -Vec3::Y), &QueryFilter::default());
    world.cast_shape(&cast, &QueryFilter::default());
    world.cast_shape(&cast.with_spin(Vec3::Y), &QueryFilter::default());
    world.overlap_aabb(&area, &QueryFilter::default(), &mut overlaps);
    world.cast_ray(&Ray::new(DVec3::Y, -Vec3::Y), &QueryFilter::only(body));
    world.overlap(&geometry, DVec3::Y, Quat::IDENTITY, &QueryFilter::default(), &mut overlaps);
    world.closest_point(DVec3::Y, 2.0, &QueryFilter::default());
    world.contact_begins();
    world.contact_hits();
    world.sensor_begins();
    world.contacts_of(body);
    world.step_with(1.0 / 60.0, &NoHooks);
    Character::new(CharacterSettings::default(), DVec3::Y);
    world.add_character(&character);
    world.snapshot(&mut snapshot);
    world.restore(&snapshot);
    world.draw(&DrawOptions::default(), drawing);
}

/// Without white space: the compiler's own rendering breaks lines and sets spaces as it likes.
fn dense(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

#[test]
fn the_table_has_what_compiles() {
    let page = include_str!("../docs/coming-from.md");
    let cells = page.lines().filter(|line| line.starts_with("| ") && line.contains("` |"));
    let ours: Vec<String> = cells
        .filter_map(|line| line.trim_end_matches(" |").rsplit_once("| ").map(|(_, cell)| dense(cell)))
        .collect();
    let expected: Vec<String> = ROWS.iter().map(|row| format!("`{}`", dense(row))).collect();
    assert_eq!(ours, expected);
}
