//! The player without its window: what it shows, and where it goes.

use super::*;
use backstop::glam::{Vec2, Vec3};
use backstop::{BodyDesc, ConvexHull, Geometry, HeightField, Settings, ShapeDesc, TriangleMesh};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
const SIZE: (usize, usize) = (320, 240);

/// A red ball of 0.5 m at rest without gravity, 1 m to the right of what is looked at, level, from 12 m.
fn player() -> Player {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
    let body = BodyDesc::dynamic().with_position(DVec3::new(1.0, 4.0, 0.0)).with_shape(ball);
    world.add_body(&body.with_linear_velocity(Vec3::X)).unwrap();
    let wanted = Wanted { eye: Some(DVec3::new(0.0, 4.0, 12.0)), target: Some(DVec3::Y * 4.0) };
    Player::new(Viewer::new(wanted, Look::parse("shapes").unwrap(), SIZE, 1), world, DT, false)
}

/// Middle of the pixels that are redder than blue by much, above the scrubber, and how many there are.
fn ball_on(picture: &[u32]) -> (f64, f64, f64) {
    let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
    for (i, &pixel) in picture.iter().enumerate().take(SIZE.0 * 210) {
        let [r, _, b] = canvas::unpack(pixel);
        if r > b + 0.12 {
            x += (i % SIZE.0) as f64 + 0.5;
            y += (i / SIZE.0) as f64 + 0.5;
            count += 1.0;
        }
    }
    (x / count, y / count, count)
}

/// Expected: by the pinhole, 120 pixels for 12 m times the tangent of half the angle of view.
#[test]
fn a_ball_is_shown_where_it_is_also_after_going_back() {
    let mut player = player();
    let scale = 120.0 / (12.0 * f64::from(libm::tanf(0.38)));
    let near = |player: &mut Player, x: f64| {
        let (column, row, count) = ball_on(&player.picture());
        assert!((column - (160.0 + scale * x)).abs() < 1.5 && (row - 120.0).abs() < 1.5, "{column} {row}");
        assert!((count / (std::f64::consts::PI * 0.25 * scale * scale) - 1.0).abs() < 0.1, "{count}");
    };
    near(&mut player, 1.0);
    // At 1 m/s.
    player.go_to(90).unwrap();
    near(&mut player, 2.5);
    player.go_to(0).unwrap();
    near(&mut player, 1.0);
    // The middle of the scrubber is the middle of what was shown.
    assert!(player.scrub(160.0, 230.0, false).unwrap());
    near(&mut player, 1.75);
    assert!(!player.scrub(160.0, 100.0, false).unwrap());
    player.skip(-15).unwrap();
    near(&mut player, 1.5);
}

#[test]
fn time_passes_unless_it_is_stopped_and_steps_stay_behind_rather_than_pile_up() {
    let mut player = player();
    let reached = |player: &Player| player.figures()[0].clone();
    player.pass(2.5 * DT).unwrap();
    assert_eq!(reached(&player), "step 2 of 2, 0.03 s");
    player.pass(100.0).unwrap();
    assert_eq!(reached(&player), "step 6 of 6, 0.10 s");
    player.skip(-4).unwrap();
    player.pass(1.0).unwrap();
    assert_eq!(reached(&player), "step 2 of 6, 0.03 s, paused");
    assert_eq!(player.figures()[1..3], ["1 body, 0 asleep", "0 contact points, 0 potential"]);
}

/// The text has pale pixels on a darkened corner, the knob of the scrubber is where the share is.
#[test]
fn figures_and_scrubber_are_over_the_picture() {
    let mut player = player();
    let bare = player.viewer.picture(&World::new(Settings::default()).unwrap());
    player.go_to(40).unwrap();
    player.go_to(10).unwrap();
    let picture = player.picture();
    let pale = picture[..SIZE.0 * 70].iter().filter(|&&p| p == 0xe1_e6_ee).count();
    // 74 characters of 10 to 30 pixels each.
    assert!((500..2500).contains(&pale), "{pale}");
    assert!(picture[0] < bare[0]);
    let middle = &picture[SIZE.0 * 226..][..SIZE.0];
    let bright = middle.iter().rposition(|&p| p == 0xf0_a0_3c).unwrap();
    // A quarter of the way, and half of the knob.
    assert!((bright as i32 - (10 + 300 / 4 + 5)).abs() <= 1, "{bright}");
    assert!(middle.iter().skip(bright + 3).take(200).all(|&p| p == 0x6e_76_82));
}

/// Expected: what moves fills four fifths of the picture and stays in it, however far it goes.
#[test]
fn the_camera_follows_what_moves() {
    let mut player = player();
    player.follows = true;
    player.viewer = Viewer::new(Wanted::default(), Look::parse("shapes").unwrap(), SIZE, 1);
    player.go_to(1200).unwrap();
    for _ in 0..100 {
        player.pass(0.1).unwrap();
    }
    let (column, row, count) = ball_on(&player.picture());
    // Its box's outer ball has 0.87 m, the ball itself 0.5 m.
    assert!((column - 160.0).abs() < 3.0 && (row - 120.0).abs() < 3.0, "{column} {row}");
    let radius = 0.8 * 120.0 * 0.5 / 0.87;
    assert!((count / (std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.15, "{count}");
}

/// At the middle of every fourth pixel both ways: the depth [m] at which something is drawn, and those at
/// which a ray through that pixel enters and leaves the world; nothing for the sky.
fn depths(geometry: &Geometry, eye: DVec3) -> Vec<[Option<f64>; 3]> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let body = BodyDesc::kinematic().with_shape(ShapeDesc::new(geometry.clone()));
    world.add_body(&body).unwrap();
    let wanted = Wanted { eye: Some(eye), target: Some(DVec3::ZERO) };
    let mut viewer = Viewer::new(wanted, Look::parse("shapes").unwrap(), SIZE, 1);
    viewer.frame(&world);
    viewer.picture(&world);
    let ahead = -eye.normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let up = right.cross(ahead);
    let scale = f64::from(libm::tanf(0.38)) / 120.0;
    let pixel = |(column, row): (usize, usize)| {
        let (x, y) = (column as f64 + 0.5 - 160.0, 120.0 - (row as f64 + 0.5));
        let to = (ahead + right * (x * scale) + up * (y * scale)) * 20.0;
        let met = |from: DVec3, way: DVec3| {
            let hit = world.cast_ray(&Ray::new(from, way.as_vec3()), &QueryFilter::default()).unwrap();
            hit.map(|hit| (hit.point - eye).dot(ahead))
        };
        let drawn = Some(f64::from(viewer.canvas.nearness_at(column, row))).filter(|n| *n > 0.0);
        [drawn.map(|nearness| 1.0 / nearness), met(eye, to), met(eye + to, -to)]
    };
    let rows = (0..SIZE.1).step_by(4);
    rows.flat_map(|row| (0..SIZE.0).step_by(4).map(move |column| (column, row))).map(pixel).collect()
}

/// Every solid was drawn inside out: its far faces, through the near ones. Expected: at each pixel the
/// surface that a ray from the eye meets first; on the axis of a box of 2 m from 5 m, 4 m away and not 6 m.
/// The facets of a round shape of 1 m lie up to 1 - cos(pi / 16) within it, several times as far along a ray
/// that grazes it: where it is less than 1 m thick, somewhere between where the ray enters and leaves it.
#[test]
fn the_face_of_a_solid_that_is_nearest_is_seen() {
    let corners = [[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0], [1.0, 1.0, 1.0]].map(Vec3::from);
    let hull = Arc::new(ConvexHull::new(&corners).unwrap());
    let mesh = TriangleMesh::new(corners.to_vec(), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    let heights = [0.0, 0.4, 0.0, 0.3, 0.0, -0.4, 0.2, 0.5, 0.1];
    let field = HeightField::new(3, 3, Vec2::ONE, heights.to_vec()).unwrap();
    let flat = [
        Geometry::cuboid(1.0, 1.0, 1.0),
        Geometry::cuboid(1.5, 0.2, 0.7),
        Geometry::Hull(hull),
        Geometry::Mesh(Arc::new(mesh)),
        Geometry::HeightField(Arc::new(field)),
    ];
    let round = [
        Geometry::Sphere { radius: 1.0 },
        Geometry::Capsule { half_height: 0.5, radius_bottom: 0.6, radius_top: 0.6 },
        Geometry::Capsule { half_height: 0.5, radius_bottom: 0.8, radius_top: 0.4 },
        Geometry::Cylinder { half_height: 0.5, radius_bottom: 0.9, radius_top: 0.9 },
        Geometry::Cylinder { half_height: 0.5, radius_bottom: 0.9, radius_top: 0.0 },
    ];
    let eyes = [DVec3::Z * 5.0, DVec3::X * -5.0, DVec3::new(2.0, 4.0, -3.0), DVec3::new(-3.0, -3.0, 3.0)];
    let cases = flat.iter().map(|g| (g, 1e-3)).chain(round.iter().map(|g| (g, 0.12)));
    for ((geometry, off), eye) in cases.flat_map(|case| eyes.map(|eye| (case, eye))) {
        let depths = depths(geometry, eye);
        let all: Vec<_> = depths.iter().filter_map(|&[a, b, c]| Some([a?, b?, c?])).collect();
        let one = depths.iter().filter(|[a, b, _]| a.is_some() != b.is_some()).count();
        assert!(all.len() > 60 && one < all.len() / 8, "{geometry:?} from {eye}: {} {one}", all.len());
        for [drawn, enters, leaves] in all {
            let thick = leaves - enters;
            let off = if off > 0.1 && thick < 1.0 { thick + 0.02 } else { off };
            assert!((drawn - enters).abs() < off, "{geometry:?} from {eye}: {drawn} {enters} {leaves}");
        }
    }
    let middle = SIZE.0 / 4 * (SIZE.1 / 8) + SIZE.0 / 8;
    let [drawn, enters, _] = depths(&flat[0], DVec3::Z * 5.0)[middle].map(Option::unwrap);
    assert!((drawn - 4.0).abs() < 1e-4 && (enters - 4.0).abs() < 1e-4, "{drawn} {enters}");
}
