#![allow(unused)]
use backstop::glam::*;
use backstop::*;
use std::sync::Arc;
fn b(g: Geometry) -> ShapeDesc {
    ShapeDesc::new(g)
}
#[test]
fn slide() {
    for (dt, y) in [(1.0 / 60.0f32, 0.05f64), (1.0 / 240.0, 0.05), (1.0 / 240.0, 0.0495)] {
        let mut w = World::new(Settings::default()).unwrap();
        w.add_body(
            &BodyDesc::fixed().at(DVec3::new(0.0, -0.5, 0.0)).with_shape(b(Geometry::cuboid(50.0, 0.5, 5.0))),
        )
        .unwrap();
        let h = w
            .add_body(
                &BodyDesc::dynamic()
                    .at(DVec3::new(0.0, y, 0.0))
                    .moving(Vec3::X * 4.0, Vec3::ZERO)
                    .with_shape(b(Geometry::cuboid(0.5, 0.05, 0.5))),
            )
            .unwrap();
        for i in 0..(1.2 / dt) as u32 {
            w.step(dt).unwrap();
            let r = w.report();
            if i < 8 || i % (0.1 / dt) as u32 == 0 {
                println!(
                    "slide dt {dt} {i}: x {:.4} y {:.6} v {} real {} pot {} pushed {} man {} expected v {}",
                    w.position(h).unwrap().x,
                    w.position(h).unwrap().y,
                    w.linear_velocity(h).unwrap(),
                    r.real,
                    r.potential,
                    r.pushed,
                    r.manifolds,
                    4.0 - 0.6 * 9.81 * dt * (i + 1) as f32
                );
            }
        }
    }
}
#[test]
fn push() {
    for (dt, m) in [(1.0 / 30.0f32, 1000.0), (1.0 / 60.0, 1000.0), (1.0 / 240.0, 1.0)] {
        let mut w = World::new(Settings { gravity: Vec3::ZERO, ..Default::default() }).unwrap();
        let mut k = BodyDesc::kinematic()
            .at(DVec3::new(-3.0, 0.0, 0.0))
            .moving(Vec3::X * 2.0, Vec3::ZERO)
            .with_shape(b(Geometry::cuboid(0.5, 0.5, 0.5)));
        w.add_body(&k).unwrap();
        let mut s = b(Geometry::cuboid(0.5, 0.5, 0.5));
        s.density = m;
        let h = w.add_body(&BodyDesc::dynamic().with_shape(s)).unwrap();
        for i in 0..(3.0 / dt) as u32 {
            w.step(dt).unwrap();
            let r = w.report();
            let t = (i + 1) as f32 * dt;
            if (0.96..1.2).contains(&t) && i % (1.0f32 / 60.0 / dt).max(1.0) as u32 == 0 || t > 2.99 {
                println!(
                    "push dt {dt} {i}: p {} v {} w {} q {} real {} pot {} pushed {}",
                    w.position(h).unwrap(),
                    w.linear_velocity(h).unwrap(),
                    w.angular_velocity(h).unwrap(),
                    w.rotation(h).unwrap(),
                    r.real,
                    r.potential,
                    r.pushed
                );
            }
        }
    }
}
fn prism(sides: u32, radius: f32, half_height: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let ring = |y: f32| {
        (0..sides).map(move |i| {
            let (s, c) = (std::f32::consts::TAU * i as f32 / sides as f32).sin_cos();
            Vec3::new(radius * c, y, radius * s)
        })
    };
    let points: Vec<Vec3> = ring(-half_height).chain(ring(half_height)).collect();
    let mut triangles = Vec::new();
    for i in 0..sides {
        let j = (i + 1) % sides;
        triangles.extend([[i, i + sides, j], [j, i + sides, j + sides]]);
        if i > 0 && j > 0 {
            triangles.extend([[0, i, j], [sides, sides + j, sides + i]]);
        }
    }
    (points, triangles)
}
fn drop_on(name: &str, ground: Geometry, top: f64, g: Geometry, y: f64, dt: f32, n: u32, q: Quat) {
    let mut w = World::new(Settings::default()).unwrap();
    w.add_body(&BodyDesc::fixed().at(DVec3::new(0.0, -top, 0.0)).with_shape(b(ground))).unwrap();
    let h = w.add_body(&BodyDesc::dynamic().at(DVec3::new(0.0, y, 0.0)).rotated(q).with_shape(b(g))).unwrap();
    for i in 0..n {
        w.step(dt).unwrap();
        let r = w.report();
        let t = i as f32 * dt;
        if r.manifolds > 0 && (t < 0.6 && i % (1.0f32 / 120.0 / dt).max(1.0) as u32 == 0)
            || i % (0.5 / dt) as u32 == 0
        {
            println!(
                "{name} {i}: p {} v {} w {} real {} pot {} pushed {} casts {} held {} E {}",
                w.position(h).unwrap(),
                w.linear_velocity(h).unwrap(),
                w.angular_velocity(h).unwrap(),
                r.real,
                r.potential,
                r.pushed,
                r.casts,
                r.held,
                w.energy()
            );
        }
    }
}
#[test]
fn mesh_ball() {
    let (p, t) = prism(12, 10.0, 5.0);
    drop_on(
        "mesh_ball",
        Geometry::Mesh(Arc::new(TriangleMesh::new(p, t).unwrap())),
        5.0,
        Geometry::Sphere { radius: 0.5 },
        1.5,
        1.0 / 60.0,
        60,
        Quat::IDENTITY,
    );
}
#[test]
fn hull_ball() {
    let h = Geometry::Hull(Arc::new(ConvexHull::new(&prism(6, 0.5, 0.25).0).unwrap()));
    drop_on("hull_ball", Geometry::Sphere { radius: 10.0 }, 10.0, h, 1.25, 1.0 / 60.0, 600, Quat::IDENTITY);
}
#[test]
fn taper_cylinder() {
    let g = Geometry::Capsule { half_height: 0.25, radius_bottom: 0.3, radius_top: 0.2 };
    drop_on(
        "taper_cyl",
        Geometry::cylinder(5.0, 10.0),
        5.0,
        g,
        0.3,
        1.0 / 60.0,
        600,
        Quat::from_rotation_x(1.5),
    );
}
#[test]
fn tower() {
    let d = Settings::default();
    for (name, s) in [
        ("default", d.clone()),
        ("no recycle", Settings { recycling: false, ..d.clone() }),
        ("point friction", Settings { friction_model: FrictionModel::Point, ..d.clone() }),
        ("iter 4", Settings { iterations: 4, ..d.clone() }),
        ("sub 8", Settings { substeps: 8, ..d.clone() }),
        ("no warm", Settings { warm_starting: false, ..d.clone() }),
        ("slop 0", Settings { slop: 0.0, ..d.clone() }),
        ("norec slop0", Settings { slop: 0.0, recycling: false, ..d.clone() }),
    ] {
        for n in [10, 30] {
            let mut w = World::new(s.clone()).unwrap();
            w.add_body(
                &BodyDesc::fixed()
                    .at(DVec3::new(0.0, -0.5, 0.0))
                    .with_shape(b(Geometry::cuboid(50.0, 0.5, 50.0))),
            )
            .unwrap();
            let mut h = None;
            for i in 0..n {
                h = Some(
                    w.add_body(
                        &BodyDesc::dynamic()
                            .at(DVec3::new(0.0, 0.5 + i as f64, 0.0))
                            .with_shape(b(Geometry::cuboid(0.5, 0.5, 0.5))),
                    )
                    .unwrap(),
                );
            }
            let start = w.position(h.unwrap()).unwrap();
            for i in 0..1200 {
                w.step(1.0 / 60.0).unwrap();
                if i == 399 || i == 1199 {
                    let d = w.position(h.unwrap()).unwrap() - start;
                    println!(
                        "tower {name} {n} {i}: side {:.4} mm down {:.3} mm v {}",
                        d.x.hypot(d.z) * 1e3,
                        -d.y * 1e3,
                        w.linear_velocity(h.unwrap()).unwrap().length()
                    );
                }
            }
        }
    }
}
#[test]
fn norec() {
    for s in [Settings::default(), Settings { recycling: false, ..Default::default() }] {
        let mut w = World::new(s).unwrap();
        w.add_body(
            &BodyDesc::fixed()
                .at(DVec3::new(0.0, -10.0, 0.0))
                .with_shape(b(Geometry::Sphere { radius: 10.0 })),
        )
        .unwrap();
        let hu = Geometry::Hull(Arc::new(ConvexHull::new(&prism(6, 0.5, 0.25).0).unwrap()));
        let h = w
            .add_body(
                &BodyDesc::dynamic()
                    .at(DVec3::new(0.0, 0.25, 0.0))
                    .rotated(Quat::from_rotation_x(1e-3))
                    .with_shape(b(hu)),
            )
            .unwrap();
        for i in 0..60 {
            w.step(1.0 / 60.0).unwrap();
            if i % 3 == 0 {
                println!(
                    "norec {i} p {} q {} w {} rec {}",
                    w.position(h).unwrap(),
                    w.rotation(h).unwrap(),
                    w.angular_velocity(h).unwrap(),
                    w.report().recycled
                )
            };
        }
    }
}
