//! Errors name the refused object: which of many, how many there must be, in short numbers.

use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, ConvexHull, Error, Frame, Geometry, HeightField, JointDesc, Limit, Motion, Ray,
    Settings, ShapeDesc, Skeleton, TriangleMesh, World,
};

fn ball(radius: f32) -> ShapeDesc {
    ShapeDesc::new(Geometry::Sphere { radius })
}

#[track_caller]
fn told<T>(found: Result<T, Error>, expected: &str) {
    match found {
        Ok(_) => panic!("accepted"),
        Err(error) => assert_eq!(error.to_string(), expected),
    }
}

/// "position must be finite, but is NaN", of one of 200 bodies. Expected: which of them, and which number.
#[test]
fn one_of_many_is_named_by_its_place() {
    let mut world = World::new(Settings::default()).unwrap();
    let at = |i: i32| BodyDesc::dynamic().with_position(DVec3::X * f64::from(i)).with_shape(ball(0.1));
    let mut descs: Vec<BodyDesc> = (0..200).map(at).collect();
    let bodies = world.add_bodies(&descs).unwrap();
    descs[137].position.y = f64::NAN;
    told(world.add_bodies(&descs), "body 137: position must be finite, but is NaN");
    descs[137] = at(0).with_shape(ball(-0.3));
    told(world.add_bodies(&descs), "body 137: shape 1: sphere radius must be above zero, but is -0.3");
    // There is only one, so none has to be named.
    told(world.add_body(&at(0).with_shapes([ball(0.0)])), "sphere radius must be above zero, but is 0");

    let joint = |i: usize| JointDesc::ball([bodies[i], bodies[i + 1]], [Frame::default(); 2]);
    let mut joints: Vec<JointDesc> = (0..20).map(joint).collect();
    let limit = |min, max| Limit::new(Motion::Angular, Axes::One(Axis::X), min, max);
    joints[3] = joint(3).with_limit(limit(-1.0, 1.0)).with_limit(limit(1.0, 0.5));
    let last = joints[3].limits.len() - 1;
    told(
        world.add_joints(&joints),
        &format!("joint 3: limit {last}: joint limit max must be at least min, but is 0.5"),
    );
    world.remove_body(bodies[50]).unwrap();
    told(world.remove_bodies(&bodies), "body 50: the body handle is stale: its body was removed");

    let rays = [Ray::new(DVec3::ZERO, Vec3::Y), Ray::new(DVec3::ZERO, Vec3::NAN)];
    let found = world.cast_rays(&rays, &Default::default(), &mut [None; 2]);
    assert!(found.unwrap_err().to_string().starts_with("ray 1: "));
    let mut figure = Skeleton::humanoid();
    figure.bones[4].radius = 0.0;
    told(figure.validate(), "bone 4: bone radius must be above zero, but is 0");
}

/// "heights must be columns times rows, but is 8". Expected: how many that is.
#[test]
fn a_list_of_another_length_says_which_it_must_have() {
    let field = |count| HeightField::new(12, 9, Vec2::ONE, vec![0.0; count]);
    told(field(8), "there must be 108 heights, columns times rows, but there are 8");
    let mut field = field(108).unwrap();
    told(
        field.set_heights([0, 0], [3, 2], &[0.0; 5]),
        "there must be 6 heights, columns times rows of the region, but there are 5",
    );
    told(
        field.set_heights([10, 0], [3, 2], &[0.0; 6]),
        "the region's last column must be below 12, but is 12",
    );
    told(
        field.with_materials(&[0; 7], &[]),
        "there must be 88 numbers of materials, one for each triangle or cell, but there are 7",
    );
    let world = World::new(Settings::default()).unwrap();
    let rays = [Ray::new(DVec3::ZERO, Vec3::Y); 3];
    told(
        world.cast_rays(&rays, &Default::default(), &mut [None; 2]),
        "there must be 3 places for hits, one for each ray, but there are 2",
    );
}

#[test]
fn points_and_indices_are_named() {
    let mut corners = vec![Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::ONE];
    told(
        TriangleMesh::new(corners.clone(), vec![[0, 1, 2], [0, 1, 7]]),
        "triangle 1: mesh index must be below 4, but is 7",
    );
    corners[2].y = f32::INFINITY;
    told(
        TriangleMesh::new(corners.clone(), vec![[0, 1, 2]]),
        "vertex 2: mesh vertex must be finite, but is inf",
    );
    told(ConvexHull::new(&corners), "point 2: hull point must be finite, but is inf");
    // "within 0e0 m" said nothing.
    told(ConvexHull::new(&[Vec3::ONE; 5]), "the shape is degenerate: the 5 points of a hull are all equal");
    let flat = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::X + Vec3::Z];
    told(ConvexHull::new(&flat), "the shape is degenerate: the 4 points of a hull are all in a plane");
}
