//! First signs of life.
#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use backstop::glam::DVec3;
use backstop::*;

fn ball(r: f32) -> ShapeDesc {
    ShapeDesc::new(Geometry::Sphere { radius: r })
}

#[test]
fn a_ball_comes_to_rest_on_a_ball() {
    let mut world = World::new(Settings::default()).unwrap();
    world
        .add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, -100.0, 0.0)).with_shape(ball(100.0)))
        .unwrap();
    let b = world
        .add_body(&BodyDesc::dynamic().with_position(DVec3::new(0.0, 2.0, 0.0)).with_shape(ball(0.5)))
        .unwrap();
    for i in 0..120 {
        world.step(1.0 / 60.0).unwrap();
        if i % 6 == 0 {
            println!("{i} {:?} {:?}", world.position(b).unwrap(), world.linear_velocity(b).unwrap());
        }
    }
    println!("{:?}", world.report());
    assert!((world.position(b).unwrap().y - 0.5).abs() < 1e-3);
    assert!(world.linear_velocity(b).unwrap().length() < 1e-3);
}

#[test]
fn an_elastic_ball_keeps_its_energy() {
    for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0] {
        let mut world = World::new(Settings::default()).unwrap();
        let shape = |r: f32| {
            let mut s = ball(r);
            s.material = Material::default().with_restitution(1.0);
            s
        };
        world
            .add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, -100.0, 0.0)).with_shape(shape(100.0)))
            .unwrap();
        let b = world
            .add_body(&BodyDesc::dynamic().with_position(DVec3::new(0.0, 2.5, 0.0)).with_shape(shape(0.5)))
            .unwrap();
        let mut top: f64 = 0.0;
        let mut bounces = 0;
        let mut v = 0.0;
        let e0 = world.energy();
        while bounces < 20 {
            world.step(dt).unwrap();
            let now = world.linear_velocity(b).unwrap().y;
            if v <= 0.0 && now > 0.0 {
                bounces += 1;
                top = 0.0;
            }
            v = now;
            top = top.max(world.position(b).unwrap().y);
        }
        for _ in 0..(0.63 / dt) as u32 {
            world.step(dt).unwrap();
            top = top.max(world.position(b).unwrap().y);
        }
        println!("dt {dt}: top {top} energy {}", world.energy() / e0);
        assert!((top - 0.5 - 2.0).abs() < 0.02, "{top}");
    }
}
