use super::*;
use crate::math::Quat;
use crate::memory::Allowance;
use crate::narrow_phase::cast::motion::BodyPath;
use crate::narrow_phase::cast::tolerance;
use crate::narrow_phase::distance;
use crate::narrow_phase::fixtures::{CONVEX, collider};
use crate::random::Random;
use crate::shape::{Geometry, HeightField, TriangleMesh, path_in_box};

/// Every triangle, in order, if its box is on the way.
struct Soup(Vec<[Vec3; 3]>);

impl Soup {
    /// The distance of the nearest triangle that is not rested on, by GJK [m].
    fn gap(&self, a: &Collider, motion: &Motion, fraction: f32) -> f32 {
        let shape = a.geometry.support().unwrap();
        let at = |fraction: f32, t: [Vec3; 3]| {
            distance(&shape, &Support::triangle(t), &motion.relative(fraction), Vec3::ZERO).distance
        };
        let far = self.0.iter().filter(|t| at(0.0, **t) > 0.01);
        far.map(|t| at(fraction, *t)).fold(f32::INFINITY, f32::min)
    }
}

impl Soup {
    fn visit_segment(&self, from: Vec3, to: Vec3, inflate: Vec3, f: &mut Visit<'_>) {
        let mut largest = 1.0;
        for (i, [a, b, c]) in self.0.iter().enumerate() {
            let (low, high) = (a.min(*b).min(*c) - inflate, a.max(*b).max(*c) + inflate);
            let (from, low, high) = (from.as_dvec3(), low.as_dvec3(), high.as_dvec3());
            let part = path_in_box(from, to.as_dvec3() - from, low, high);
            if part.is_some_and(|(enter, _)| enter as f32 <= largest) {
                largest = f(i as u32, [*a, *b, *c], largest);
            }
        }
    }
}

fn cast(a: &Collider, soup: &Soup, motion: &Motion, tolerance: f32, resting: f32) -> Option<Touch> {
    let cast = MeshCast::first(tolerance, resting);
    let rel = motion.relative(0.0);
    let path = (motion.b.spin == Vec3::ZERO).then(|| ShapePath::new(a, &rel, motion, &cast));
    let mut search = Search::new(a.geometry.support()?, motion, cast);
    let path = search.prepare(a, &rel, path);
    search.go_along(|f| soup.visit_segment(path.from, path.to, path.inflate, f));
    match search.finish() {
        CastResult::First(touch) => Some(touch),
        _ => None,
    }
}

fn quad(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> [[Vec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A floor of 20 x 20 cells of a metre at y = 0, with a wall across it at x = 5.
fn floor_and_wall() -> Soup {
    let at = |x: i32, z: i32| Vec3::new(x as f32, 0.0, z as f32);
    let mut triangles = Vec::new();
    for x in -10..10 {
        for z in -10..10 {
            triangles.extend(quad(at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z)));
        }
    }
    let up = Vec3::Y * 3.0;
    triangles.extend(quad(at(5, -10), at(5, 10), at(5, 10) + up, at(5, -10) + up));
    Soup(triangles)
}

fn path(centre: Vec3, displacement: Vec3) -> BodyPath {
    BodyPath { centre: centre.as_dvec3(), rotation: Quat::IDENTITY, displacement, spin: Vec3::ZERO }
}

fn mesh() -> Collider {
    collider(Geometry::Plane)
}

#[test]
fn a_box_slides_along_a_floor_up_to_a_wall() {
    let cube = collider(Geometry::cuboid(0.5, 0.5, 0.5));
    let soup = floor_and_wall();
    // Sunk in by a slop, just touching, just above; with the displacement by gravity; turning on its spot as
    // well.
    for height in [-0.0005, 0.0, 0.0005, 0.002] {
        for spin in [0.0, 0.3] {
            let mut pa = path(Vec3::new(-6.3, 0.5 + height, 0.2), Vec3::new(15.0, -0.0027, 0.3));
            pa.spin = Vec3::Y * spin;
            let motion = Motion::new(&cube, &pa, &mesh(), &path(Vec3::ZERO, Vec3::ZERO));
            let touch = cast(&cube, &soup, &motion, 1e-4, 0.006).unwrap();
            assert!((touch.normal - Vec3::X).length() < 0.05, "{height} {touch:?}");
            if spin == 0.0 {
                assert!((touch.fraction - 10.8 / 15.0).abs() < 2e-5, "{height} {touch:?}");
            }
            pa.displacement = Vec3::new(9.0, -0.0027, 0.3);
            let motion = Motion::new(&cube, &pa, &mesh(), &path(Vec3::ZERO, Vec3::ZERO));
            assert!(cast(&cube, &soup, &motion, 1e-4, 0.006).is_none(), "{height}");
        }
    }
}

/// The tree finds the same touch as a search over all triangles, in a mesh and in a height field.
#[test]
fn meshes_and_height_fields_answer_like_their_triangles() {
    let mut random = Random(22);
    let height = |x: u32, z: u32| ((x * 7 + z * 13) % 5) as f32 * 0.2;
    let n = 16;
    let heights: Vec<f32> = (0..n * n).map(|i| height(i % n, i / n)).collect();
    let field = HeightField::new(n as usize, n as usize, glam::Vec2::ONE, heights).unwrap();
    let all: Vec<[Vec3; 3]> = (0..2 * (n - 1) * (n - 1)).map(|i| field.triangle(i)).collect();
    let vertices: Vec<Vec3> = all.iter().flatten().copied().collect();
    let indices = (0..all.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let field = collider(Geometry::HeightField(field.into()));
    let mesh = collider(Geometry::Mesh(TriangleMesh::new(vertices, indices).unwrap().into()));
    let (soup, mut hits) = (Soup(all), 0);
    for i in 0..if cfg!(miri) { 3 } else { 200 } {
        let a = random.shape(CONVEX[i % 5], 0.5);
        let centre = Vec3::new(random.range(0.0, 15.0), random.range(1.5, 4.0), random.range(0.0, 15.0));
        // Long ways go along the tree, short ones have a box.
        let mut pa = path(centre, (random.cube() - Vec3::Y * 0.5) * [8.0, 1.0][i / 2 % 2]);
        pa.spin = random.cube() * [0.0, 2.0][i % 2];
        let b = path(Vec3::ZERO, Vec3::ZERO);
        let motion = Motion::new(&a, &pa, &mesh, &b);
        let expected = cast(&a, &soup, &motion, 1e-4, 0.01).map(|t| t.fraction);
        for other in [&mesh, &field] {
            let mut nearby = Nearby::default();
            assert!(nearby.has_place(&mut Allowance::default()));
            nearby.expect(Some((centre - Vec3::ONE, centre + Vec3::new(0.5, 0.0, 0.1))));
            // From the tree, gathered, and held from before.
            for gathered in 0..3 {
                let nearby = (gathered > 0).then_some(&mut nearby);
                let cast = MeshCast::first(1e-4, 0.01);
                let found = cast_mesh(&a, other, &motion.relative(0.0), &motion, cast, nearby);
                let found = if let CastResult::First(touch) = found { Some(touch.fraction) } else { None };
                assert_eq!(found.is_some(), expected.is_some());
                // The start of a search depends on earlier results, and so, within the tolerance, does its
                // end.
                if let Some(found) = found {
                    let least = soup.gap(&a, &motion, found);
                    assert!(least > 0.0 && least <= 1.01e-4, "{i} {found} {expected:?} {least}");
                }
            }
        }
        hits += u32::from(expected.is_some());
    }
    assert!(cfg!(miri) || (50..150).contains(&hits), "{hits}");
}

#[test]
fn a_box_that_falls_stops_at_the_floor() {
    let cube = collider(Geometry::cuboid(0.5, 0.5, 0.5));
    let pa = path(Vec3::new(-3.0, 3.0, 0.2), Vec3::new(2.0, -10.0, 0.0));
    let motion = Motion::new(&cube, &pa, &mesh(), &path(Vec3::ZERO, Vec3::ZERO));
    let touch = cast(&cube, &floor_and_wall(), &motion, 1e-4, 0.006).unwrap();
    assert!((touch.fraction - 0.25).abs() < 2e-5 && (touch.normal + Vec3::Y).length() < 1e-3, "{touch:?}");
}

#[test]
fn the_first_touch_of_a_soup_is_the_first_of_its_triangles() {
    let mut random = Random(21);
    let (mut hits, mut misses) = (0, 0);
    for i in 0..if cfg!(miri) { 3 } else { 400 } {
        let mut a = random.shape(CONVEX[i % 5], 1.0);
        if i % 2 == 0 {
            a.position = random.cube();
        }
        let soup = Soup((0..20).map(|_| random.triangle(6.0)).collect());
        let (mut pa, pb) =
            (random.body(9.0, [0.0, 1.0, 6.0][i % 3]), random.body(1.0, if i % 4 == 0 { 0.5 } else { 0.0 }));
        pa.displacement = pa.centre.as_vec3() * -2.0 + pb.displacement * 3.0;
        let b = mesh();
        let motion = Motion::new(&a, &pa, &b, &pb);
        let eps = tolerance(&a, &b, 1.0);
        let found = cast(&a, &soup, &motion, eps, 0.0);
        // A triangle with no thickness as a hull can't be; so each by itself, without the walk and its
        // shortcuts.
        let sweeps = soup.0.iter().filter_map(|t| {
            let b = Other::Convex(Support::triangle(*t));
            let sweep = Sweep::new(a.geometry.support().unwrap(), b, &motion, eps);
            let touch = sweep.first_touch(1.0);
            touch.is_none_or(|t| t.fraction > 0.0).then_some((sweep, touch))
        });
        let (mut expected, mut gap) = (false, f64::MAX);
        for (sweep, touch) in sweeps {
            expected |= touch.is_some();
            if let Some(found) = found {
                let placed = sweep.placed(f64::from(found.fraction));
                gap = gap.min(sweep.gap(&placed, &mut Simplex::empty()).lower);
            }
        }
        // A search that begins elsewhere ends elsewhere, but no nearer than a touch, and no further than the
        // tolerance. The fraction is an f32.
        let rounding = 1e-7 * f64::from(motion.displacement.length() + 9.0);
        let touches = gap > -rounding && gap <= f64::from(eps) + rounding;
        let same = found.is_some() == expected && (!expected || touches);
        assert!(same, "{found:?} {expected} {gap} {a:?} {motion:?}");
        hits += u32::from(found.is_some());
        misses += u32::from(found.is_none());
    }
    println!("{hits} hits, {misses} misses");
    assert!(cfg!(miri) || (hits > 50 && misses > 50));
}
