//! Convex decomposition: hulls of random solids against the solids, and bodies that are made of them.

use super::common::{self, Floor, random::Random};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, ConvexHull, Decomposition, Geometry, Material, Pieces, Settings, ShapeDesc, World};
use solids::{KINDS, Mesh};

mod refused;
mod solids;

/// Distance from a hull, as far as its planes tell: below zero inside.
struct Planes(Vec<(DVec3, f64)>);

impl Planes {
    fn of(hull: &ConvexHull) -> Planes {
        let at = |i: u16| hull.vertices()[usize::from(i)].as_dvec3();
        let plane = |face: &[u16]| {
            let first = at(face[0]);
            let area: DVec3 =
                face.windows(2).map(|pair| (at(pair[0]) - first).cross(at(pair[1]) - first)).sum();
            let normal = area.normalize();
            (normal, normal.dot(first))
        };
        Planes(hull.faces().map(plane).collect())
    }

    fn distance(&self, point: DVec3) -> f64 {
        self.0.iter().map(|(normal, offset)| normal.dot(point) - offset).fold(f64::MIN, f64::max)
    }
}

fn decomposed(mesh: &Mesh, settings: Decomposition) -> Pieces {
    settings.run(&mesh.vertices, &mesh.triangles).unwrap()
}

/// Of 0.05 to 20 m, anywhere within ten times that, turned anyhow or not at all.
fn random_solid(kind: usize, random: &mut Random) -> Mesh {
    let scale = random.log_range(0.05, 20.0);
    let turn = if random.chance(0.3) { Quat::IDENTITY } else { random.rotation() };
    Mesh::random(kind, random).placed(scale, turn, random.cube() * scale * 10.0)
}

fn random_settings(random: &mut Random) -> Decomposition {
    Decomposition::default()
        .with_max_hulls(random.log_range(1.0, 100.0) as u32)
        .with_concavity(random.log_range(0.005, 0.5))
        .with_resolution(random.range(4.0, 32.0) as u32)
}

/// Expected: every vertex and every point of the solid is in a hull, to 1e-5 of its size (f32 at ten times
/// its size from the origin) and what hulls of too many vertices left out; points of hulls outside of the
/// solid are at most as many as the excess says, within four deviations of their number; and the excess is
/// within the concavity or the hulls are as many as may be. The mesh says what is inside by winding numbers.
#[test]
fn hulls_cover_a_solid_and_hardly_more() {
    let mut random = Random(60);
    for round in 0..KINDS * if crate::common::wide() { 12 } else { 5 } {
        let (mesh, settings) = (random_solid(round, &mut random), random_settings(&mut random));
        let pieces = decomposed(&mesh, settings);
        let hulls: Vec<Planes> = pieces.hulls().iter().map(|hull| Planes::of(hull)).collect();
        let (low, high) = mesh.bounds();
        let left_out = pieces.hulls().iter().map(|hull| hull.left_out()).fold(0.0, f32::max);
        let near = 1e-5 * f64::from((high - low).max_element()) + f64::from(left_out);
        let distance = |p: DVec3| hulls.iter().map(|hull| hull.distance(p)).fold(f64::MAX, f64::min);
        let what = format!("round {round}, {} hulls, {settings:?}", hulls.len());
        for v in mesh.corners() {
            let outside = distance(v.as_dvec3());
            assert!(outside < near, "{what}: a vertex is {outside} m outside of {near}");
        }
        let volume = mesh.volume();
        assert!((f64::from(pieces.volume()) / volume - 1.0).abs() < 1e-5, "{what}");
        let few = hulls.len() < settings.max_hulls as usize;
        assert!(hulls.len() <= settings.max_hulls as usize, "{what}");
        assert!(pieces.excess() > -0.02, "{what}: {}", pieces.excess());
        assert!(!few || pieces.excess() <= settings.concavity + 1e-4, "{what}: {}", pieces.excess());

        let (mut beyond, tries) = (0, 1500);
        let size = (high - low).as_dvec3();
        for _ in 0..tries {
            let point = low.as_dvec3() + size * (random.cube64() + 1.0) * 0.5;
            let (apart, inside) = (distance(point), mesh.winding(point) > 0.5);
            assert!(!inside || apart < near, "{what}: a point of the solid is {apart} m outside");
            beyond += u32::from(!inside && apart < -near);
        }
        let share = f64::from(pieces.excess().max(0.0)) * volume / (size.x * size.y * size.z);
        let expected = share * f64::from(tries);
        assert!(
            f64::from(beyond) <= expected + 4.0 * expected.sqrt() + 4.0,
            "{what}: {beyond} of {expected}"
        );
    }
}

/// Expected: boxes at right angles need no more hulls than boxes, and leave no volume over, however they are
/// turned: two for an L, two or three for a T, three for a U, six for a chair.
#[test]
fn boxes_become_boxes() {
    let mut random = Random(61);
    for _ in 0..10 {
        for (kind, most) in [(1, 2), (2, 3), (3, 3), (6, 6)] {
            let mesh = random_solid(kind, &mut random);
            let pieces = decomposed(&mesh, Decomposition::default().with_concavity(1e-4));
            let (found, excess) = (pieces.hulls().len(), pieces.excess());
            assert!(found <= most && excess.abs() < 2e-4, "kind {kind}: {found} hulls, {excess}");
        }
    }
}

/// Expected: of a torus, V = 2 π² R r², and about its axis m (R² + 3/4 r²); a mesh of it has 2 % less.
#[test]
fn mass_is_that_of_the_mesh() {
    let pieces = decomposed(&Mesh::torus(1.0, 0.3, 64, 32), Decomposition::default());
    let mass = pieces.mass_properties(2.0);
    let exact = 4.0 * std::f32::consts::PI.powi(2) * 0.09;
    assert!((mass.mass / exact - 1.0).abs() < 0.02, "{} kg of {exact}", mass.mass);
    let axial = mass.mass * (1.0 + 0.75 * 0.09);
    assert!((mass.inertia.y_axis.y / axial - 1.0).abs() < 0.02, "{} of {axial}", mass.inertia.y_axis.y);
    assert!(mass.centre_of_mass.length() < 1e-5);
    let shapes = BodyDesc::dynamic().with_shapes(pieces.shapes());
    let mut world = World::new(Settings::default()).unwrap();
    let body = world.add_body(&shapes).unwrap();
    let heavier = world.mass_properties(body).unwrap().mass / (1000.0 * pieces.volume());
    assert!((heavier - 1.0 - pieces.excess()).abs() < 1e-3, "{heavier}");
}

/// Expected: pinned bits, for every machine and every optimisation.
#[test]
fn hulls_have_the_same_bits_everywhere() {
    let mesh = Mesh::torus(1.0, 0.3, 24, 12).placed(0.7, Random(9).rotation(), Vec3::new(3.0, -1.0, 0.2));
    let pieces = decomposed(&mesh, Decomposition::default());
    let mut hash = crc32fast::Hasher::new();
    for vertex in pieces.hulls().iter().flat_map(|hull| hull.vertices()) {
        vertex.to_array().iter().for_each(|x| hash.update(&x.to_bits().to_le_bytes()));
    }
    assert_eq!((pieces.hulls().len(), hash.finalize()), (17, 3_302_055_698));
}

fn torus_on_blocks(shapes: impl IntoIterator<Item = ShapeDesc>) -> f64 {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shapes(shapes)).unwrap();
    let ball = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::sphere(0.5)));
    let ball = world.add_body(&ball.with_position(DVec3::new(0.0, 3.0, 0.0))).unwrap();
    common::steps(&mut world, 120, 1.0 / 60.0);
    world.position(ball).unwrap().y
}

/// Expected: the hole of a torus of 1 m and 0.3 m is 0.7 m wide, so a ball of 0.5 m falls through; on the
/// hull of all it stays on top, at 0.3 + 0.5 m.
#[test]
fn a_hole_stays_open() {
    let mesh = Mesh::torus(1.0, 0.3, 32, 16);
    let through = torus_on_blocks(decomposed(&mesh, Decomposition::default()).shapes());
    assert!(through < -5.0, "the ball is at {through} m");
    let on = torus_on_blocks(decomposed(&mesh, Decomposition::default().with_max_hulls(1)).shapes());
    assert!((on - 0.8).abs() < 0.05, "the ball is at {on} m");
}

/// Expected: a solid that fell onto a floor stays there, with its lowest vertex on the floor to 1 % of its
/// size. Tori and gears may roll; so all have rolling friction. It should not slide either: an L that stands
/// on two short edges, one of each hull, rocks within each step, and slides by 0.8 mm/s at 30 Hz.
#[test]
fn bodies_of_hulls_come_to_rest_and_stay() {
    let rough = Material::default().with_rolling_friction(0.05);
    for rate in [30, 60, 120] {
        let mut random = Random(62);
        for kind in 0..KINDS {
            let mesh = Mesh::random(kind, &mut random).placed(0.5, random.rotation(), Vec3::ZERO);
            let pieces = decomposed(&mesh, Decomposition::default());
            let mut world = World::new(Settings::default()).unwrap();
            world.add_body(&Floor::Plane.desc(rough)).unwrap();
            let shapes = pieces.shapes().map(|shape| shape.with_material(rough));
            let body = BodyDesc::dynamic().with_shapes(shapes).with_mass(pieces.mass_properties(800.0));
            let body = world.add_body(&body.with_position(DVec3::Y * 2.0)).unwrap();
            let lowest = |world: &World| {
                let (turn, at) = (world.rotation(body).unwrap(), world.position(body).unwrap());
                mesh.corners().map(|v| f64::from((turn * v).y) + at.y).fold(f64::MAX, f64::min)
            };
            common::steps(&mut world, 12 * rate, 1.0 / rate as f32);
            let (at, turn) = (world.position(body).unwrap(), world.rotation(body).unwrap());
            for second in 0..30 {
                common::steps(&mut world, rate, 1.0 / rate as f32);
                let (moved, low) = ((world.position(body).unwrap() - at).length(), lowest(&world));
                let what = format!("kind {kind} at {rate} Hz, second {second}");
                assert!(low.abs() < 0.01, "{what}: the lowest vertex is at {low} m");
                assert!(moved < 0.03, "{what}: it moved by {moved} m");
                let turned = world.rotation(body).unwrap().angle_between(turn);
                assert!(turned < 0.01, "{what}: it turned by {turned} rad");
            }
        }
    }
}
