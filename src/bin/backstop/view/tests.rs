//! The player without its window: what it shows, and where it goes.

use super::*;
use backstop::glam::Vec3;
use backstop::{BodyDesc, Settings, ShapeDesc};

const DT: f32 = 1.0 / 60.0;
const SIZE: (usize, usize) = (320, 240);

/// A red ball of 0.5 m at rest without gravity, 1 m to the right of what is looked at, level, from 12 m.
fn player() -> Player {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
    let body = BodyDesc::dynamic().at(DVec3::new(1.0, 4.0, 0.0)).with_shape(ball);
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
