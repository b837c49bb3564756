//! Points and lines are where they should be.

use super::test_scenes::{add_chain, bumps, dynamic, fixed, pyramid};
use super::*;
use crate::body::{BodyDesc, BodyKind};
use crate::config::{ContinuousMode, Settings};
use crate::handle::BodyHandle;
use crate::joint::{Axes, Axis, Frame, JointDesc, Limit, Motion};
use crate::math::Quat;
use crate::narrow_phase::segment_hits;
use crate::shape::{ConvexHull, Geometry, HeightField, ShapeDesc, TriangleMesh};
use crate::world::World;
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Keeps all that is drawn.
#[derive(Default)]
struct Sketch {
    lines: Vec<(Element, DVec3, DVec3, Colour)>,
    points: Vec<(Element, DVec3, Colour)>,
}

impl DebugDraw for Sketch {
    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        self.lines.push((ink.element, from, to, ink.colour));
    }
    fn point(&mut self, at: DVec3, ink: Ink) {
        self.points.push((ink.element, at, ink.colour));
    }
}

impl Sketch {
    fn of(world: &World, options: &DrawOptions) -> Sketch {
        let mut sketch = Sketch::default();
        world.draw(options, &mut sketch);
        sketch
    }
    fn lines(&self, element: Element) -> Vec<(DVec3, DVec3)> {
        self.lines.iter().filter(|l| l.0 == element).map(|l| (l.1, l.2)).collect()
    }
    fn points(&self, element: Element) -> Vec<DVec3> {
        self.points.iter().filter(|p| p.0 == element).map(|p| p.1).collect()
    }
}

fn world() -> World {
    World::new(Settings::default()).unwrap()
}

fn steps(world: &mut World, count: usize) {
    (0..count).for_each(|_| assert!(world.step(1.0 / 60.0).is_ok()));
}

fn near(a: DVec3, b: DVec3, within: f64) -> bool {
    (a - b).length() <= within
}

/// One of each shape, with the origin inside (or above) its surface.
fn shapes() -> Vec<Geometry> {
    let corner = |i: i32| {
        let i = i as f32;
        Vec3::new((i * 0.77) % 1.7 - 0.8, (i * 1.9) % 1.3 - 0.6, (i * 0.31) % 2.0 - 0.9)
    };
    let hull = ConvexHull::new(&(0..30).map(corner).collect::<Vec<_>>()).unwrap();
    let heights: Vec<f32> = (0..30).map(|i| (i * i % 7) as f32 * 0.2).collect();
    let field = HeightField::new(6, 5, Vec2::new(0.5, 0.7), heights).unwrap();
    let mut corners = Vec::new();
    triangles(&Geometry::HeightField(Arc::new(field.clone())), None, &mut |t| corners.extend(t));
    let indices = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    vec![
        Geometry::Sphere { radius: 0.7 },
        Geometry::capsule(0.5, 0.3),
        Geometry::Capsule { half_height: 0.5, radius_bottom: 0.6, radius_top: 0.2 },
        Geometry::Capsule { half_height: 0.5, radius_bottom: 0.1, radius_top: 0.4 },
        Geometry::Capsule { half_height: 0.1, radius_bottom: 0.5, radius_top: 0.2 },
        Geometry::cuboid(0.3, 0.5, 0.7),
        Geometry::cylinder(0.4, 0.5),
        Geometry::Cylinder { half_height: 0.6, radius_bottom: 0.5, radius_top: 0.0 },
        Geometry::Cylinder { half_height: 0.6, radius_bottom: 0.2, radius_top: 0.7 },
        Geometry::Hull(Arc::new(hull)),
        Geometry::Plane,
        Geometry::Mesh(Arc::new(TriangleMesh::new(corners, indices).unwrap())),
        Geometry::HeightField(Arc::new(field)),
    ]
}

/// How far a point is from where a segment to it from outside enters the shape [m].
fn off_surface(world: &World, shape: u32, point: Vec3) -> f32 {
    let collider = &world.colliders.all[shape as usize];
    let (from, to) = if collider.kind.is_convex() {
        (point * 3.0, Vec3::ZERO)
    } else {
        // A little inside: by rounding, a point on the border of a mesh may miss all triangles.
        let (x, z) = (point.x.clamp(1e-4, 2.4999), point.z.clamp(1e-4, 2.7999));
        let (x, z) = if collider.radius.is_finite() { (x, z) } else { (point.x, point.z) };
        (Vec3::new(x, point.y + 3.0, z), Vec3::new(x, point.y - 3.0, z))
    };
    match segment_hits(collider, from, to) {
        Some(hit) => (from + (to - from) * hit.fraction - point).length(),
        None => f32::INFINITY,
    }
}

#[test]
fn wireframes_and_triangles_lie_on_the_surface_of_their_shape() {
    let mut world = world();
    for (shape, geometry) in shapes().into_iter().enumerate() {
        world.add_body(&fixed(geometry.clone(), DVec3::ZERO)).unwrap();
        let mut worst = 0.0f32;
        let mut lines = 0;
        wireframe(&geometry, None, &mut |from, to| {
            lines += 1;
            for end in [from, to] {
                worst = worst.max(off_surface(&world, shape as u32, end));
            }
            assert!(from != to, "{geometry:?}: a line without length");
        });
        // The steepest triangles rise by three times the tenth of a millimetre that the test point is moved.
        assert!(worst < 5e-4, "{geometry:?}: a line ends {worst} m off the surface");
        assert!(lines >= 12, "{geometry:?}");
        let mut count = 0;
        triangles(&geometry, None, &mut |corners| {
            count += 1;
            for corner in corners {
                let off = off_surface(&world, shape as u32, corner);
                // The centre of a cap.
                let inside = corner.x == 0.0 && corner.z == 0.0;
                assert!(off < 5e-4 || inside, "{geometry:?}: {corner} is {off} m off");
            }
        });
        assert!(count >= 2, "{geometry:?}");
    }
}

#[test]
fn shapes_are_drawn_where_they_are_and_in_the_colour_of_their_kind() {
    // Far out: a millimetre is less than the resolution of f32 there.
    let at = DVec3::new(1e7 + 0.125, -3.25, 2e6);
    let turn = Quat::from_rotation_z(0.3);
    let mut world = world();
    let ball = ShapeDesc { position: Vec3::X, ..ShapeDesc::new(Geometry::Sphere { radius: 0.5 }) };
    world.add_body(&BodyDesc::kinematic().with_position(at).with_rotation(turn).with_shape(ball)).unwrap();
    let options = DrawOptions { centres: true, ..DrawOptions::default() };
    let sketch = Sketch::of(&world, &options);
    let centre = at + (turn * Vec3::X).as_dvec3();
    let lines = sketch.lines(Element::Shape);
    assert_eq!(lines.len(), 3 * 32);
    for (from, to) in lines {
        assert!(((from - centre).length() - 0.5).abs() < 1e-6 && ((to - centre).length() - 0.5).abs() < 1e-6);
    }
    assert!(sketch.lines.iter().all(|l| l.3 == options.palette.kinematic_body));
    assert!(near(sketch.points(Element::CentreOfMass)[0], centre, 1e-6));
}

#[test]
fn contacts_of_a_resting_box_are_at_its_corners_and_real() {
    for ground in [fixed(Geometry::Plane, DVec3::ZERO), fixed(Geometry::cuboid(9.0, 1.0, 9.0), -DVec3::Y)] {
        let mut world = world();
        world.add_body(&ground).unwrap();
        let at = DVec3::new(0.7, 0.5, -0.3);
        let body = world.add_body(&dynamic(Geometry::cuboid(0.4, 0.5, 0.6), at)).unwrap();
        steps(&mut world, 60);
        let options = DrawOptions { normals: true, impulses: true, ..DrawOptions::default() };
        let sketch = Sketch::of(&world, &options);
        let points = sketch.points(Element::RealPoint);
        assert_eq!((points.len(), sketch.points.len()), (4, 4));
        for corner in [(-0.4, -0.6), (-0.4, 0.6), (0.4, -0.6), (0.4, 0.6)] {
            let corner = DVec3::new(at.x + corner.0, 0.0, at.z + corner.1);
            assert!(points.iter().any(|p| near(*p, corner, 2e-3)), "{corner}: {points:?}");
        }
        assert!(sketch.points.iter().all(|p| p.2 == options.palette.real_point));
        for (from, to) in sketch.lines(Element::Normal) {
            assert!(near((to - from).abs(), DVec3::Y * 0.2, 1e-4), "{from} {to}");
        }
        // Together they carry the weight for a substep.
        let impulses: f64 = sketch.lines(Element::Impulse).iter().map(|l| (l.1 - l.0).length()).sum();
        let weight = f64::from(world.mass(body).unwrap()) * 9.81 / 240.0;
        assert!((impulses / (weight * f64::from(options.impulse_scale)) - 1.0).abs() < 0.01, "{impulses}");
    }
}

#[test]
fn a_potential_point_is_where_a_fast_ball_will_touch_and_where_it_has_touched() {
    let mut world = World::new(Settings { gravity: Vec3::ZERO, ..Settings::default() }).unwrap();
    world.add_body(&fixed(Geometry::cuboid(0.01, 5.0, 5.0), DVec3::ZERO)).unwrap();
    let velocity = Vec3::new(120.0, 30.0, 0.0);
    let ball = dynamic(Geometry::Sphere { radius: 0.1 }, DVec3::new(-1.5, 0.0, 0.0))
        .with_velocity(velocity, Vec3::ZERO);
    let ball = world.add_body(&ball).unwrap();
    world.step(1.0 / 60.0).unwrap();
    let options = DrawOptions { motion: true, normals: true, ..DrawOptions::default() };
    let sketch = Sketch::of(&world, &options);
    // It was stopped at the wall, and did touch it: no ghost.
    let centre = world.position(ball).unwrap();
    assert!((centre.x + 0.11).abs() < 5e-3, "{centre}");
    let points = sketch.points(Element::PotentialPoint);
    assert_eq!((points.len(), sketch.points.len()), (1, 1));
    assert!(near(points[0], DVec3::new(-0.01, centre.y, 0.0), 5e-3), "{points:?} {centre}");
    assert_eq!(sketch.points[0].2, options.palette.potential_point);
    // Two metres to the right and half a metre up, if the wall were not there.
    let way = sketch.lines(Element::Motion);
    assert_eq!(way.len(), 1);
    assert!(
        near(way[0].0, DVec3::new(-1.5, 0.0, 0.0), 1e-6) && near(way[0].1, DVec3::new(0.5, 0.5, 0.0), 1e-5)
    );
    // From then on it touches.
    world.set_velocity(ball, Vec3::X, Vec3::ZERO).unwrap();
    world.step(1.0 / 60.0).unwrap();
    assert_eq!(Sketch::of(&world, &options).points(Element::RealPoint).len(), 1);
}

#[test]
fn points_follow_a_body_that_turned_within_the_step() {
    // A spinning cube hits a wall with a corner or an edge: the point is on the cube and on the wall.
    let mut world = World::new(Settings { gravity: Vec3::ZERO, ..Settings::default() }).unwrap();
    world.add_body(&fixed(Geometry::cuboid(5.0, 0.5, 5.0), -0.5 * DVec3::Y)).unwrap();
    let desc = dynamic(Geometry::cuboid(0.3, 0.3, 0.3), DVec3::new(0.0, 1.2, 0.0));
    let desc = desc.with_velocity(Vec3::new(0.0, -30.0, 0.0), Vec3::new(3.0, 1.0, 2.0));
    let cube = world.add_body(&desc).unwrap();
    for _ in 0..3 {
        world.step(1.0 / 60.0).unwrap();
        let sketch = Sketch::of(&world, &DrawOptions { normals: true, ..DrawOptions::default() });
        let (at, turn) = (world.position(cube).unwrap(), world.rotation(cube).unwrap());
        for (from, to) in sketch.lines(Element::Gap) {
            // One end on the cube, the other on the ground.
            let local = |p: DVec3| (turn.conjugate() * (p - at).as_vec3()).abs().max_element() - 0.3;
            let (high, low) = if from.y > to.y { (from, to) } else { (to, from) };
            let off = low.y.abs().min(high.y.abs());
            assert!(off < 0.02, "{from} {to}");
            assert!(local(high).abs().min(local(low).abs()) < 0.02, "{} {}", local(high), local(low));
        }
    }
}

#[test]
fn what_pushed_without_a_touch_is_a_ghost() {
    // On its way to a plate a ball is struck from below and flies over the plate, whose plane has no end.
    let mut world = World::new(Settings { gravity: Vec3::ZERO, ..Settings::default() }).unwrap();
    world.add_body(&fixed(Geometry::cuboid(0.01, 0.2, 0.2), DVec3::ZERO)).unwrap();
    let ball = |at: DVec3, velocity: Vec3| {
        dynamic(Geometry::Sphere { radius: 0.1 }, at).with_velocity(velocity, Vec3::ZERO)
    };
    let struck = world.add_body(&ball(DVec3::new(-1.5, 0.0, 0.0), Vec3::X * 120.0)).unwrap();
    world.add_body(&ball(DVec3::new(-0.9, -0.5, 0.0), Vec3::Y * 60.0)).unwrap();
    world.step(1.0 / 60.0).unwrap();
    let options = DrawOptions { normals: true, ..DrawOptions::default() };
    let sketch = Sketch::of(&world, &options);
    let ghosts = sketch.points(Element::GhostPoint);
    // The two balls touched, too, but parted again within the step.
    assert_eq!(ghosts.len(), 2, "{:?}", sketch.points);
    let colour = options.palette.ghost_point;
    assert!(sketch.points.iter().all(|p| (p.0 == Element::GhostPoint) == (p.2 == colour)));
    // On the ball, in the plane of the plate.
    let centre = world.position(struck).unwrap();
    assert!(centre.y > 0.31, "{centre}");
    let on_ball = |p: &DVec3| near(*p, centre + DVec3::X * 0.1, 0.02) && p.x.abs() < 0.02;
    assert_eq!(ghosts.iter().filter(|p| on_ball(p)).count(), 1, "{ghosts:?} {centre}");
    world.step(1.0 / 60.0).unwrap();
    assert_eq!(world.report().ghosts, 2, "the next step counts them");
}

#[test]
fn boxes_hold_their_shapes_and_fat_ones_hold_the_tight() {
    let mut world = world();
    world.add_body(&fixed(Geometry::Plane, DVec3::ZERO)).unwrap();
    let turned = dynamic(Geometry::cuboid(0.2, 0.5, 0.1), DVec3::new(3.0, 2.0, 1.0));
    let body = world.add_body(&turned.with_rotation(Quat::from_rotation_z(0.5))).unwrap();
    world.step(1.0 / 60.0).unwrap();
    let options = DrawOptions { aabbs: true, fat_aabbs: true, ..DrawOptions::nothing() };
    let sketch = Sketch::of(&world, &options);
    let bounds = |element| {
        let lines = sketch.lines(element);
        // The plane's has no end.
        assert_eq!(lines.len(), 12);
        let ends = || lines.iter().flat_map(|l| [l.0, l.1]);
        (ends().reduce(DVec3::min).unwrap(), ends().reduce(DVec3::max).unwrap())
    };
    let (tight, fat) = (bounds(Element::Aabb), bounds(Element::FatAabb));
    let middle = world.position(body).unwrap();
    let (sin, cos) = (f64::from(libm::sinf(0.5)), f64::from(libm::cosf(0.5)));
    let half = DVec3::new(0.2 * cos + 0.5 * sin, 0.5 * cos + 0.2 * sin, 0.1);
    assert!(near(tight.0, middle - half, 1e-4) && near(tight.1, middle + half, 1e-4), "{tight:?}");
    assert!(fat.0.cmplt(tight.0).all() && fat.1.cmpgt(tight.1).all());
}

fn joined(
    desc: impl Fn([crate::handle::BodyHandle; 2], [Frame; 2]) -> JointDesc,
    at: DVec3,
    turn: Quat,
) -> World {
    let mut world = world();
    let hook = world.add_body(&BodyDesc::fixed().with_position(DVec3::new(1.0, 2.0, 3.0))).unwrap();
    let box_ = dynamic(Geometry::cuboid(0.1, 0.2, 0.3), DVec3::new(1.0, 2.0, 3.0) + at).with_rotation(turn);
    let body = world.add_body(&box_).unwrap();
    world.add_joint(&desc([hook, body], [Frame::default(); 2])).unwrap();
    world
}

/// Expected: both ropes of a pulley, from pulley to weight, and the rope between the pulleys.
#[test]
fn a_pulley_shows_its_rope() {
    let mut world = world();
    let hook = world.add_body(&BodyDesc::fixed()).unwrap();
    let ropes = [Vec3::ZERO, Vec3::X].map(|at| {
        let ball = dynamic(Geometry::Sphere { radius: 0.1 }, (at - Vec3::Y).as_dvec3());
        let weight = world.add_body(&ball).unwrap();
        world.add_joint(&JointDesc::new([hook, weight], [Frame::at(at), Frame::default()])).unwrap()
    });
    world.add_coupling(&crate::joint::CouplingDesc::pulley(ropes, 1.0, 2.0)).unwrap();
    let lines = Sketch::of(&world, &DrawOptions::default()).lines(Element::Coupling);
    let (x, y) = (DVec3::X, DVec3::Y);
    assert_eq!(lines, [(DVec3::ZERO, -y), (x, x - y), (DVec3::ZERO, x)]);
}

#[test]
fn the_gap_of_a_joint_runs_from_frame_to_frame() {
    let apart = DVec3::new(0.0, -0.4, 0.3);
    let world = joined(JointDesc::ball, apart, Quat::from_rotation_x(FRAC_PI_2));
    let options = DrawOptions::default();
    let sketch = Sketch::of(&world, &options);
    let anchor = DVec3::new(1.0, 2.0, 3.0);
    let gap = sketch.lines(Element::JointGap);
    assert!(gap.len() == 1 && near(gap[0].0, anchor, 1e-6) && near(gap[0].1, anchor + apart, 1e-6));
    // Two frames, three axes each; y of the second is turned to z.
    let axes = sketch.lines(Element::JointFrame);
    assert_eq!(axes.len(), 6);
    assert!(near(axes[1].1 - axes[1].0, DVec3::Y * 0.2, 1e-6), "{axes:?}");
    assert!(near(axes[4].1 - axes[4].0, DVec3::Z * 0.2, 1e-6), "{axes:?}");
    assert!(sketch.lines(Element::JointLimit).is_empty());
}

#[test]
fn limits_are_drawn_where_they_end() {
    let anchor = DVec3::new(1.0, 2.0, 3.0);
    let limit = |motion, axes, min, max| {
        move |bodies, frames| JointDesc {
            limits: vec![Limit::new(motion, axes, min, max)],
            ..JointDesc::new(bodies, frames)
        }
    };
    let ends = |world: &World| -> Vec<DVec3> {
        let lines = Sketch::of(world, &DrawOptions::default()).lines(Element::JointLimit);
        lines.iter().flat_map(|l| [l.0 - anchor, l.1 - anchor]).collect()
    };
    // A rope of 2 m: three circles of that radius.
    let rope = joined(limit(Motion::Linear, Axes::All, 0.0, 2.0), DVec3::X, Quat::IDENTITY);
    let all = ends(&rope);
    assert!(all.len() == 3 * 2 * 32 && all.iter().all(|p| (p.length() - 2.0).abs() < 1e-5));
    // A rail from -1 to 3 along y, with a tick at each end.
    let rail = joined(limit(Motion::Linear, Axes::One(Axis::Y), -1.0, 3.0), DVec3::Y, Quat::IDENTITY);
    let all = ends(&rail);
    assert!(all.len() == 6 && near(all[0], -DVec3::Y, 1e-6) && near(all[1], DVec3::Y * 3.0, 1e-6));
    // A hinge about x that may turn by half a radian: at its end the second frame's y is the end of the arc.
    let most = 0.5;
    let hinge = joined(
        limit(Motion::Angular, Axes::One(Axis::X), -0.1, most),
        DVec3::ZERO,
        Quat::from_rotation_x(most),
    );
    let tip = Sketch::of(&hinge, &DrawOptions::default()).lines(Element::JointFrame)[4].1 - anchor;
    assert!(ends(&hinge).iter().any(|p| near(*p, tip, 1e-5)), "{tip}");
    assert!(ends(&hinge).iter().all(|p| p.x.abs() < 1e-6 && p.length() < 0.2 + 1e-5));
    // A cone of 1 rad around z: at its end the second frame's z touches the rim.
    let cone =
        joined(limit(Motion::Angular, Axes::Perpendicular(Axis::Z), 0.0, 1.0), DVec3::ZERO, Quat::IDENTITY);
    let rim = f64::from(libm::cosf(1.0)) * 0.2;
    assert!(ends(&cone).iter().all(|p| (p.z - rim).abs() < 1e-6 || p.length() < 1e-6));
    // Free within a turn: no ends.
    let free = joined(limit(Motion::Angular, Axes::One(Axis::X), -PI, PI), DVec3::ZERO, Quat::IDENTITY);
    assert!(ends(&free).iter().all(|p| p.length() > 0.1));
}

/// Rows of a later step named contacts and points that the restored world had not: `draw` panicked.
#[test]
fn a_restored_world_has_no_solver_colours_until_it_steps() {
    let mut world = world();
    pyramid(&mut world, 4);
    steps(&mut world, 1);
    let mut saved = crate::snapshot::Snapshot::new();
    world.snapshot(&mut saved);
    steps(&mut world, 5);
    world.restore(&saved).unwrap();
    let options = DrawOptions { solver_colours: true, ..DrawOptions::nothing() };
    assert_eq!(Sketch::of(&world, &options).lines.len(), 0);
    steps(&mut world, 1);
    assert!(!Sketch::of(&world, &options).lines.is_empty());
}

#[test]
fn no_two_lines_of_a_solver_colour_end_at_one_dynamic_body() {
    let mut world = world();
    pyramid(&mut world, 8);
    world.add_body(&fixed(Geometry::Plane, DVec3::new(0.0, -50.0, 0.0))).unwrap();
    steps(&mut world, 5);
    let options = DrawOptions { solver_colours: true, ..DrawOptions::nothing() };
    let sketch = Sketch::of(&world, &options);
    let colours: Vec<Colour> = sketch.lines.iter().map(|l| l.3).collect();
    let mut different = colours.clone();
    different.sort_unstable_by_key(|c| (c.red, c.green, c.blue));
    different.dedup();
    assert!(different.len() > 2 && !different.contains(&Colour::new(255, 255, 255)));
    for colour in different {
        let of_it: Vec<_> = sketch.lines.iter().filter(|l| l.3 == colour).collect();
        let ends = || of_it.iter().flat_map(|l| [l.1, l.2]);
        for body in world.bodies() {
            let centre = world.centre_of_mass(body).unwrap();
            assert!(ends().filter(|end| *end == centre).count() <= 1, "{colour:?} {centre}");
        }
    }
    // Each box of a row but the lowest stands on two, each of the lowest on the floor.
    assert_eq!(sketch.lines.len(), world.report().manifolds as usize);
    // A contact that lost a body since the step is no longer drawn.
    let top = world.bodies().next().unwrap();
    world.remove_body(top).unwrap();
    assert!(Sketch::of(&world, &options).lines.len() < sketch.lines.len());
    let _ = Sketch::of(&world, &DrawOptions::everything());
}

#[test]
fn a_region_limits_what_is_drawn() {
    let mut world = world();
    world.add_body(&fixed(bumps(), DVec3::ZERO)).unwrap();
    world.add_body(&fixed(Geometry::Plane, DVec3::new(0.0, -3.0, 0.0))).unwrap();
    world.add_body(&dynamic(Geometry::Sphere { radius: 0.1 }, DVec3::new(6.0, 2.0, 0.0))).unwrap();
    let all = Sketch::of(&world, &DrawOptions::default());
    assert_eq!(all.lines.len(), 3 * 2 * 40 * 40 + 2 * 21 + 3 * 32);
    let region = Region::around(DVec3::new(1.0, 0.0, 1.0), 2.0);
    let part = Sketch::of(&world, &DrawOptions::default().within(region));
    assert!(!part.lines.is_empty() && part.lines.len() < 1000);
    for (_, from, to, _) in &part.lines {
        // A triangle whose box meets the region is at most its own size away.
        assert!(region.meets(from.min(*to) - 1.0, from.max(*to) + 1.0), "{from} {to}");
    }
    let below = Region::around(DVec3::new(50.0, -3.0, 50.0), 2.0);
    let plane = Sketch::of(&world, &DrawOptions::default().within(below));
    assert_eq!(plane.lines.len(), 2 * 21);
    assert!(plane.lines.iter().all(|l| below.holds(l.1) && below.holds(l.2)));
}

#[test]
fn drawing_changes_nothing_and_an_empty_world_draws_nothing() {
    let empty = Sketch::of(&world(), &DrawOptions::everything());
    assert!(empty.lines.is_empty() && empty.points.is_empty());
    let run = |draw: bool| {
        let mut world =
            World::new(Settings { continuous: ContinuousMode::Volume, ..Settings::default() }).unwrap();
        world.add_body(&fixed(bumps(), DVec3::ZERO)).unwrap();
        for i in 0..24 {
            let at = DVec3::new(f64::from(i % 6) - 3.0, 10.0 + f64::from(i / 6), f64::from(i / 6) - 2.0);
            let body = dynamic(shapes()[i as usize % 10].clone(), at);
            world.add_body(&body.with_velocity(Vec3::NEG_Y * 60.0, Vec3::X * 9.0)).unwrap();
        }
        let mut drawn = 0;
        for _ in 0..30 {
            world.step(1.0 / 60.0).unwrap();
            if draw {
                let region = Region::around(DVec3::ZERO, 20.0);
                drawn += Sketch::of(&world, &DrawOptions::everything().within(region)).lines.len();
            }
        }
        assert!(drawn > 0 || !draw);
        (world.state_hash(), world.memory().total())
    };
    assert_eq!(run(true), run(false));
    // A renderer that implements nothing is one too.
    struct Nothing;
    impl DebugDraw for Nothing {}
    world().draw(&DrawOptions::everything(), &mut Nothing);
}

/// Hinges between bodies far apart contradict each other; once the closing rows of their tree became NaN, and
/// poses with them.
#[test]
fn a_world_can_be_drawn_after_any_change() {
    (0..24).for_each(|n| draw_after_changes(7 + 1000 * n));
}

fn draw_after_changes(seed: u64) {
    let mut world = world();
    add_chain(&mut world, 16);
    for i in 0..40 {
        let at = DVec3::new(f64::from(i % 7), 1.0 + f64::from(i / 7), 0.3 * f64::from(i % 3));
        let body = dynamic(shapes()[i as usize % 10].clone(), at);
        world.add_body(&body.with_velocity(Vec3::new(0.0, -20.0 * (i % 4) as f32, 0.0), Vec3::ONE)).unwrap();
    }
    for (n, ground) in shapes().into_iter().skip(10).enumerate() {
        world.add_body(&fixed(ground, DVec3::new(2.0 * n as f64, -1.0, 0.0))).unwrap();
    }
    let mut random = crate::random::Random(seed);
    let mut below = |n| random.below(n);
    for _ in 0..40 {
        world.step(1.0 / 60.0).unwrap();
        for _ in 0..6 {
            let bodies: Vec<_> = world.bodies().collect();
            let body = bodies[below(bodies.len())];
            let shapes: Vec<_> = world.shapes(body).unwrap().collect();
            // A refused call changes nothing.
            let done = match below(7) {
                0 if bodies.len() > 20 => world.remove_body(body),
                1 => world.set_pose(body, DVec3::new(below(9) as f64, 2.0, 0.0), glam::Quat::IDENTITY),
                2 if !shapes.is_empty() => world.remove_shape(shapes[0]),
                3 => world.add_shape(body, &ShapeDesc::new(Geometry::cuboid(0.2, 0.3, 0.4))).map(drop),
                4 => world.set_mass(
                    body,
                    crate::shape::MassProperties::of(&Geometry::cuboid(0.5, 0.1, 0.2), 900.0),
                ),
                5 => world.add_body(&dynamic(Geometry::Sphere { radius: 0.2 }, DVec3::Y * 3.0)).map(drop),
                _ => world
                    .add_joint(&JointDesc::hinge([body, bodies[below(bodies.len())]], [Frame::default(); 2]))
                    .map(drop),
            };
            drop(done);
            for body in world.bodies() {
                let v = world.linear_velocity(body).unwrap() + world.angular_velocity(body).unwrap();
                let at = (world.position(body).unwrap(), world.rotation(body).unwrap());
                assert!(v.is_finite() && at.0.is_finite() && at.1.is_finite(), "seed {seed}: {v} {at:?}");
            }
            let sketch = Sketch::of(&world, &DrawOptions::everything());
            let line = sketch.lines.iter().find(|l| !(l.1.is_finite() && l.2.is_finite()));
            assert_eq!(line, None, "seed {seed}");
            assert!(sketch.points.iter().all(|p| p.1.is_finite()));
        }
    }
}

/// Two stacks: bodies of one have one colour, of the other another; asleep too, and then by default a colour
/// of their own.
#[test]
fn islands_and_sleepers_have_colours() {
    let mut world = World::new(Settings { sleeping: true, ..Settings::default() }).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    for at in [[0.0, 0.5], [0.0, 1.5], [9.0, 0.5], [9.0, 1.5]] {
        world
            .add_body(
                &BodyDesc::dynamic().with_position(DVec3::new(at[0], at[1], 0.0)).with_shape(cube.clone()),
            )
            .unwrap();
    }
    #[derive(Default)]
    struct Colours(Vec<(BodyHandle, Colour)>);
    impl DebugDraw for Colours {
        fn shape(&mut self, shape: &DrawnShape<'_>) {
            if shape.kind == BodyKind::Dynamic {
                self.0.push((shape.body, shape.ink.colour));
            }
        }
    }
    let colours = |world: &World, options: DrawOptions| {
        let mut out = Colours::default();
        world.draw(&options, &mut out);
        out.0.sort_by_key(|(body, _)| *body);
        out.0.iter().map(|(_, colour)| *colour).collect::<Vec<_>>()
    };
    let by_island = DrawOptions { shapes: true, islands: true, ..DrawOptions::nothing() };
    let by_kind = DrawOptions { shapes: true, ..DrawOptions::nothing() };
    for asleep in [0, 4] {
        for _ in 0..if asleep == 0 { 2 } else { 120 } {
            world.step(1.0 / 60.0).unwrap();
        }
        assert_eq!(world.sleeping_body_count(), asleep);
        let of = colours(&world, by_island.clone());
        assert!(of[0] == of[1] && of[2] == of[3] && of[0] != of[2], "{of:?}");
        let palette = Palette::default();
        let expected = if asleep == 0 { palette.dynamic_body } else { palette.sleeping_body };
        assert_eq!(colours(&world, by_kind.clone()), [expected; 4]);
    }
}
