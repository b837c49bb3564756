//! Level ground, walls and corners.

use super::*;

#[test]
fn on_level_ground_it_walks_just_as_far_as_it_wants() {
    let field =
        Geometry::HeightField(Arc::new(HeightField::new(41, 41, Vec2::ONE, vec![0.0; 1681]).unwrap()));
    let floors = Floor::ALL.map(|floor| floor.desc(Material::default()));
    let field =
        BodyDesc::fixed().with_position(DVec3::new(-20.0, 0.0, -20.0)).with_shape(ShapeDesc::new(field));
    for floor in floors.into_iter().chain([field]) {
        let mut world = world();
        world.add_body(&floor).unwrap();
        let start = DVec3::new(-4.03, 0.0, -2.01);
        let mut character = standing(&world, start, CharacterSettings::default());
        let velocity = Vec3::new(4.0, -0.1, 1.7);
        for step in 1..=120 {
            let report = walk(&mut character, &world, velocity);
            let way = DVec3::new(4.0, 0.0, f64::from(1.7_f32)) * f64::from(DT) * f64::from(step);
            near((character.feet() - start).with_y(0.0).distance(way), 0.0, 1e-7);
            near(character.feet().y, 0.0, GAP);
            let ground = report.ground.unwrap();
            assert!(ground.normal.distance(Vec3::Y) < 1e-4 && ground.velocity == Vec3::ZERO);
            assert_eq!(report.velocity, Vec3::new(4.0, 0.0, 1.7));
            assert_eq!(report.hits().count(), 0);
        }
    }
}

#[test]
fn along_a_wall_it_goes_as_far_as_its_wish_points_along_it() {
    let wall = mesh(
        &[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, y]| Vec3::new(x, y, 0.0)),
        &[[0, 1, 2], [0, 2, 3]],
    );
    for geometry in [Geometry::cuboid(9.0, 9.0, 0.5), wall] {
        let depth = if matches!(geometry, Geometry::Mesh(_)) { 0.0 } else { 0.5 };
        for degrees in [0.0_f32, 20.0, 45.0, 70.0, 133.0] {
            let mut world = world();
            floor(&mut world);
            let turn = common::turned(Vec3::Y, degrees);
            fixed(&mut world, DVec3::ZERO, turn, geometry.clone());
            let (along, out) = ((turn * Vec3::X).as_dvec3(), (turn * Vec3::Z).as_dvec3());
            let start = out * (depth + 0.32 + 0.001) - along * 2.0;
            let mut character = standing(&world, start, CharacterSettings::default());
            let wish = (along * 2.0 - out * 3.0).as_vec3();
            walk(&mut character, &world, wish);
            let first = character.position();
            let mut last = first;
            for step in 1..=60 {
                let report = walk(&mut character, &world, wish);
                near((character.position() - first).dot(along), f64::from(step) / 30.0, 1e-4);
                near(character.position().dot(out), depth + 0.32, GAP);
                // Each step alike.
                near((character.position() - last).length(), 1.0 / 30.0, 1e-5);
                assert!(report.velocity.distance((along * 2.0).as_vec3()) < 1e-3, "{report:?}");
                assert!(report.hits().all(|hit| hit.impulse == Vec3::ZERO));
                last = character.position();
            }
        }
    }
}

#[test]
fn a_corner_stops_it_without_jitter() {
    for degrees in [90.0_f32, 60.0, 120.0, 20.0] {
        for as_mesh in [false, true] {
            let mut world = world();
            floor(&mut world);
            let half = 0.5 * degrees.to_radians();
            // Two walls that open towards -x, by so many degrees.
            let sides = [half, -half].map(|a| Vec3::new(-a.cos(), 0.0, a.sin()) * 8.0);
            if as_mesh {
                let (down, up) = (Vec3::NEG_Y, Vec3::Y * 4.0);
                let [a, b] = sides;
                let corners = [down, up, a + down, a + up, b + down, b + up];
                let walls = mesh(&corners, &[[0, 2, 1], [2, 3, 1], [0, 1, 4], [4, 1, 5]]);
                fixed(&mut world, DVec3::ZERO, Quat::IDENTITY, walls);
            } else {
                for (side, out) in sides.into_iter().zip([1.0, -1.0]) {
                    let turn = Quat::from_rotation_arc(Vec3::NEG_X, side.normalize());
                    let beside = turn * Vec3::new(0.0, 0.0, 0.5 * out);
                    let at = (0.5 * side + beside).as_dvec3();
                    fixed(&mut world, at, turn, Geometry::cuboid(6.0, 4.0, 0.5));
                }
            }
            let mut character = standing(&world, DVec3::new(-5.0, 0.0, 0.1), CharacterSettings::default());
            let mut last = Vec3::ZERO;
            for _ in 0..180 {
                go(&mut character, &world, Vec3::new(5.0, 0.0, -0.4), &mut last);
            }
            let rest = character.position();
            // As deep as a circle of its radius gets.
            near(rest.x, -0.32 / f64::from(half.sin()), 3e-3);
            for _ in 0..120 {
                let report = go(&mut character, &world, Vec3::new(5.0, 0.0, -0.4), &mut last);
                near(character.position().distance(rest), 0.0, 1e-4);
                assert!(report.ground.is_some() && report.velocity.length() < 1e-3, "{report:?}");
            }
            // And it gets out again.
            let report = go(&mut character, &world, Vec3::new(-3.0, 0.0, 0.0), &mut last);
            near(report.moved.x.into(), -0.05, 1e-5);
        }
    }
}
