//! A body that slides over a flat mesh feels no edge in it, at any speed; a wall in the same mesh stops it.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, Combine, ConvexHull, Geometry, HeightField, Material, Settings, ShapeDesc, TriangleMesh, World,
};
use std::sync::Arc;

/// Height of every form's centre when it lies on the ground [m].
const HEIGHT: f64 = 0.25;
const LONG: f32 = 60.0;
const WIDE: f32 = 6.0;

/// A frustum with two polygons of so many corners as its faces, the larger one below.
fn frustum(corners: usize) -> Geometry {
    let corners: Vec<Vec3> = (0..2 * corners)
        .map(|i| {
            let (s, c) = (std::f32::consts::TAU * (i / 2) as f32 / corners as f32).sin_cos();
            let (r, y) = if i % 2 == 0 { (0.5, -0.25) } else { (0.35, 0.25) };
            Vec3::new(r * c, y, r * s)
        })
        .collect();
    Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap()))
}

/// Shapes that slide on a face.
fn forms() -> Vec<(&'static str, Geometry)> {
    vec![
        ("box", Geometry::cuboid(0.5, 0.25, 0.4)),
        ("cylinder", Geometry::cylinder(0.25, 0.5)),
        ("hull of 12", frustum(6)),
        ("hull of 20", frustum(10)),
    ]
}

/// Shapes that touch in a point or a line, with their rotation and the height of their centre.
fn round_forms() -> Vec<(&'static str, Geometry, Quat, f64)> {
    let capsule = Geometry::capsule(0.5, 0.25);
    let across = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    vec![
        ("sphere", Geometry::Sphere { radius: 0.25 }, Quat::IDENTITY, 0.25),
        ("standing capsule", capsule.clone(), Quat::IDENTITY, 0.75),
        ("capsule across", capsule.clone(), across, 0.25),
        ("slanting capsule", capsule.clone(), Quat::from_rotation_y(0.5) * across, 0.25),
        ("capsule along", capsule, Quat::from_rotation_y(std::f32::consts::FRAC_PI_2) * across, 0.25),
    ]
}

/// A strip of `nx` by `nz` cells from -LONG to LONG and -WIDE to WIDE, shaken sideways by a share of a cell.
fn strip(nx: usize, nz: usize, shake: f32, height: impl Fn(f32, f32) -> f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut random = Random(7);
    let mut random = || random.range(-0.5, 0.5);
    let (dx, dz) = (2.0 * LONG / nx as f32, 2.0 * WIDE / nz as f32);
    let mut vertices = Vec::new();
    for i in 0..=nx {
        for k in 0..=nz {
            let x = i as f32 * dx - LONG + dx * shake * random();
            let z = k as f32 * dz - WIDE + dz * shake * random();
            vertices.push(Vec3::new(x, height(x, z), z));
        }
    }
    let at = |i: usize, k: usize| (i * (nz + 1) + k) as u32;
    let mut triangles = Vec::new();
    for i in 0..nx {
        for k in 0..nz {
            let [a, b, c, d] = [at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)];
            if (i + k) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    (vertices, triangles)
}

fn mesh((vertices, triangles): (Vec<Vec3>, Vec<[u32; 3]>)) -> Geometry {
    Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
}

fn grounds() -> Vec<(&'static str, Geometry)> {
    let flat = |_: f32, _: f32| 0.0;
    let cells = 121;
    let field = HeightField::new(cells, 13, Vec2::splat(1.0), vec![0.0; cells * 13]).unwrap();
    vec![
        ("regular", mesh(strip(240, 24, 0.0, flat))),
        ("irregular", mesh(strip(200, 20, 0.6, flat))),
        ("fine", mesh(strip(1000, 100, 0.4, flat))),
        ("long and thin", mesh(strip(2000, 2, 0.0, flat))),
        ("lengthwise", mesh(strip(4, 120, 0.3, flat))),
        ("height field", Geometry::HeightField(Arc::new(field))),
    ]
}

fn world(ground: &Geometry, friction: f32) -> World {
    let mut world = World::new(Settings::default()).unwrap();
    let (low, _) = match ground {
        Geometry::HeightField(field) => field.aabb(),
        Geometry::Mesh(mesh) => mesh.aabb(),
        _ => (Vec3::ZERO, Vec3::ZERO),
    };
    // A height field may begin at its corner.
    let at = DVec3::new(f64::from(-LONG - low.x), 0.0, f64::from(-WIDE - low.z));
    let at = if matches!(ground, Geometry::HeightField(_)) { at } else { DVec3::ZERO };
    world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape(ground, friction))).unwrap();
    world
}

fn shape(geometry: &Geometry, friction: f32) -> ShapeDesc {
    let mut shape = ShapeDesc::new(geometry.clone());
    shape.material = Material::default().with_friction(friction);
    shape.material.friction_combine = Combine::Minimum;
    shape
}

#[test]
fn nothing_feels_the_edges_of_a_flat_mesh() {
    let mut failed = Vec::new();
    for (on, ground) in grounds() {
        for (what, form) in forms() {
            for speed in [1.0f32, 10.0, 50.0, 100.0] {
                for friction in [0.0, 0.5] {
                    let mut world = world(&ground, friction);
                    let dt = 1.0 / 60.0;
                    let start = DVec3::new(-50.0, HEIGHT, 0.13);
                    let way = Vec3::new(1.0, 0.0, 0.02).normalize();
                    let body = BodyDesc::dynamic()
                        .with_position(start)
                        .with_velocity(way * speed, Vec3::ZERO)
                        .with_shape(shape(&form, friction));
                    let body = world.add_body(&body).unwrap();
                    let (mut up, mut aside, mut turned, mut lost): (f32, f32, f32, f32) = Default::default();
                    for step in 1..=60 {
                        world.step(dt).unwrap();
                        let v = world.linear_velocity(body).unwrap();
                        if world.position(body).unwrap().x > 50.0 {
                            break;
                        }
                        up = up.max(v.y.abs());
                        let along = v.dot(way);
                        aside = aside.max((v - way * along - Vec3::Y * v.y).length() / speed);
                        turned = turned.max(world.angular_velocity(body).unwrap().length());
                        let braked = (speed - friction * 9.81 * step as f32 * dt).max(0.0);
                        lost = lost.max((along - braked).abs() / speed);
                    }
                    // Friction acts off the centre: a body that it brakes leans on its front, by nature.
                    // Where it turns a little on the way, friction turns it too.
                    let (straight, most) = if friction == 0.0 { (0.001, 0.004) } else { (0.001, 0.005) };
                    if up > 0.001 || aside > straight || lost > 0.02 || turned > most {
                        failed.push(format!(
                            "{what} on {on}, {speed} m/s, friction {friction}: up {up:.5} m/s, aside {aside:.5}, lost {lost:.4}, turning {turned:.4}"
                        ));
                    }
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
}

/// Without friction nothing turns a round body, lifts it or takes any of its speed.
#[test]
fn nothing_round_feels_the_edges_of_a_flat_mesh() {
    let mut failed = Vec::new();
    for (on, ground) in grounds() {
        for (what, form, turn, height) in round_forms() {
            for speed in [1.0f32, 10.0, 50.0, 100.0] {
                let mut world = world(&ground, 0.0);
                let body = BodyDesc::dynamic()
                    .with_position(DVec3::new(-50.0, height, 0.13))
                    .with_rotation(turn)
                    .with_velocity(Vec3::X * speed, Vec3::ZERO)
                    .with_shape(shape(&form, 0.0));
                let body = world.add_body(&body).unwrap();
                let (mut up, mut turned): (f32, f32) = Default::default();
                for _ in 0..60 {
                    world.step(1.0 / 60.0).unwrap();
                    if world.position(body).unwrap().x > 50.0 {
                        break;
                    }
                    up = up.max(world.linear_velocity(body).unwrap().y.abs());
                    turned = turned.max(world.angular_velocity(body).unwrap().length());
                }
                let now = world.linear_velocity(body).unwrap();
                if up > 0.001 || turned > 0.005 || (now.x / speed - 1.0).abs() > 1e-5 {
                    failed
                        .push(format!("{what} on {on}, {speed} m/s: up {up:.5}, turning {turned:.4}, {now}"));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
}

/// A ball and a capsule that roll from the start (angular velocity v / r) have no slip, so that friction does
/// nothing, and they go on as they are. Where the ground has more triangles under them than one, none may
/// push them from aside.
#[test]
fn what_rolls_over_a_flat_mesh_does_not_hop() {
    let mut failed = Vec::new();
    for (on, ground) in grounds() {
        for (what, form, turn, height) in
            round_forms().into_iter().filter(|f| ["sphere", "capsule across"].contains(&f.0))
        {
            for speed in [1.0f32, 3.0, 10.0] {
                let mut world = world(&ground, 0.5);
                let body = BodyDesc::dynamic()
                    .with_position(DVec3::new(-50.0, height, 0.13))
                    .with_rotation(turn)
                    .with_velocity(Vec3::X * speed, Vec3::NEG_Z * (speed / 0.25))
                    .with_shape(shape(&form, 0.5));
                let body = world.add_body(&body).unwrap();
                let mut up: f32 = 0.0;
                for _ in 0..120 {
                    world.step(1.0 / 60.0).unwrap();
                    up = up.max(world.linear_velocity(body).unwrap().y.abs());
                }
                let now = world.linear_velocity(body).unwrap();
                if up > 0.001 || (now.x / speed - 1.0).abs() > 1e-3 || now.z.abs() > 1e-3 * speed {
                    failed.push(format!("{what} on {on}, {speed} m/s: up {up:.5}, {now}"));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} failed:\n{}", failed.len(), failed.join("\n"));
}

#[test]
fn no_inner_edge_of_bumpy_ground_stops_a_body_dead() {
    let ground = mesh(strip(240, 24, 0.3, |x, z| 0.15 * (0.5 * x).sin() * (0.4 * z).cos()));
    for (what, form) in forms() {
        for speed in [1.0f32, 10.0, 50.0] {
            let mut world = world(&ground, 0.0);
            let body = BodyDesc::dynamic()
                .with_position(DVec3::new(-50.0, HEIGHT + 0.3, 0.0))
                .with_velocity(Vec3::X * speed, Vec3::ZERO)
                .with_shape(shape(&form, 0.0));
            let body = world.add_body(&body).unwrap();
            let mut before = world.linear_velocity(body).unwrap();
            for step in 0..90 {
                world.step(1.0 / 60.0).unwrap();
                if world.position(body).unwrap().x > 50.0 {
                    break;
                }
                let now = world.linear_velocity(body).unwrap();
                // The steepest slope is 0.075: a landing takes at most about that share.
                let lost = before.x - now.x;
                assert!(lost < 0.35 * speed + 0.5, "{what} at {speed} m/s, step {step}: {before} {now}");
                before = now;
            }
        }
    }
}

#[test]
fn a_wall_in_the_same_mesh_stops_what_slides() {
    let (mut vertices, mut triangles) = strip(240, 24, 0.3, |_, _| 0.0);
    let first = vertices.len() as u32;
    vertices.extend(
        [(0.0, -WIDE), (0.0, WIDE), (3.0, WIDE), (3.0, -WIDE)].map(|(y, z)| Vec3::new(10.3, y - 0.01, z)),
    );
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    let ground = mesh((vertices, triangles));
    for (what, form) in forms() {
        for speed in [1.0f32, 10.0, 50.0, 100.0, 400.0] {
            let mut world = world(&ground, 0.0);
            let body = BodyDesc::dynamic()
                .with_position(
                    DVec3::new(10.3 - 0.6 - f64::from(speed) * 0.51, HEIGHT, 0.0).max(DVec3::X * -55.0),
                )
                .with_velocity(Vec3::X * speed, Vec3::ZERO)
                .with_shape(shape(&form, 0.0));
            let body = world.add_body(&body).unwrap();
            for step in 0..90 {
                world.step(1.0 / 60.0).unwrap();
                let p = world.position(body).unwrap();
                assert!(p.x < 10.3, "{what} at {speed} m/s, step {step}: {p}");
            }
            let v = world.linear_velocity(body).unwrap().x;
            assert!(v < 0.3 * speed, "{what} at {speed} m/s is not stopped: {v}");
        }
    }
}
