//! Descriptions through serde: there and back in text and in bytes, optional fields, and refused ones.

use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::*;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::fmt::Debug;

/// The same from JSON and from postcard. Debug shows every field, and a number by digits that tell it from
/// all others.
fn there_and_back<T: Serialize + DeserializeOwned + Debug>(all: &T) -> T {
    let text = serde_json::to_string(all).unwrap();
    let bytes = postcard::to_stdvec(all).unwrap();
    let of_text: T = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    let of_bytes: T = postcard::from_bytes(&bytes).unwrap();
    let expected = format!("{all:?}");
    assert_eq!(format!("{of_text:?}"), expected, "{text}");
    assert_eq!(format!("{of_bytes:?}"), expected);
    of_text
}

fn refused<T: DeserializeOwned + Debug>(text: &str, why: &str) {
    let error = serde_json::from_str::<T>(text).unwrap_err().to_string();
    assert!(error.contains(why), "{error}");
}

fn bodies() -> [BodyHandle; 2] {
    [BodyHandle::from_bits(0x1_0000_0000), BodyHandle::from_bits(0x3_0000_0007)]
}

/// One of each kind of geometry.
fn geometries() -> Vec<Geometry> {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let heights = vec![0.0, 0.1, 0.2, 0.7, -0.3, 0.5];
    vec![
        Geometry::sphere(0.1),
        Geometry::tapered_capsule(0.3, 0.2, 0.1),
        Geometry::cuboid(0.1, 0.2, 0.3),
        Geometry::cone(0.7, 0.3),
        Geometry::plane(),
        Geometry::hull(ConvexHull::new(&corners).unwrap()),
        Geometry::mesh(TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2], [2, 1, 3]]).unwrap()),
        Geometry::height_field(HeightField::new(3, 2, Vec2::new(0.5, 0.3), heights).unwrap()),
    ]
}

/// A body with no field at its default.
fn body() -> BodyDesc {
    let rotation = Quat::from_xyzw(0.6, 0.0, 0.0, 0.8);
    let shapes = geometries().into_iter().map(|geometry| {
        ShapeDesc::new(geometry)
            .with_position([0.1, -0.2, 0.3])
            .with_rotation(rotation)
            .with_density(1234.5)
            .with_material(Material::default().with_friction(0.3).with_friction_combine(Combine::Maximum))
            .with_filter(Filter::default().with_category(6).with_mask(u64::MAX - 1).with_group(-3))
            .with_events()
            .with_hooks()
            .with_user_data(u64::MAX)
    });
    BodyDesc::kinematic()
        .with_position(DVec3::new(1e6 + 0.1, -0.25, 3.0))
        .with_rotation(rotation)
        .with_velocity(Vec3::new(0.1, 0.2, 0.3), Vec3::NEG_ONE)
        .with_shapes(shapes)
        .with_mass(MassProperties::of(&Geometry::cuboid(0.1, 0.2, 0.3), 700.0))
        .with_gravity_scale(-0.5)
        .with_linear_damping(0.1)
        .with_angular_damping(0.2)
        .with_lock_translation([true, false, true])
        .with_lock_rotation([false, true, false])
        .with_continuous(ContinuousMode::Volume)
        .with_solved_after(RowGroup::StaticContacts)
        .with_can_sleep(false)
        .with_user_data(7)
}

/// A joint with no field at its default, of every kind of limit, motor and spring.
fn joint() -> JointDesc {
    let frames = [
        Frame::at(Vec3::new(0.1, 0.2, 0.3)),
        Frame::default().with_rotation(Quat::from_xyzw(0.0, 1.0, 0.0, 0.0)),
    ];
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.7 };
    let pull = Spring::Acceleration { stiffness: 0.1, damping: f32::INFINITY };
    JointDesc::wheel(bodies(), frames, 0.3, spring)
        .with_limit(Limit::new(Motion::Angular, Axes::All, f32::NEG_INFINITY, 0.1).with_spring(spring))
        .with_limit(Limit::new(Motion::Linear, Axes::One(Axis::Z), -3.0, f32::INFINITY))
        .with_motor(Motor::velocity(Motion::Angular, Axis::X, 3.0, 100.0))
        .with_motor(Motor::position(Motion::Angular, Axis::Y, 0.3, pull).with_max_force(5.5))
        .with_collide(true)
        .with_break_force(1e6, f32::INFINITY)
        .with_thresholds(f32::INFINITY, 0.1)
        .with_solved_after(RowGroup::Contacts)
        .with_user_data(9)
}

/// Open and closed ranges and none, strengths finite and not.
fn couplings() -> [CouplingDesc; 5] {
    let joints = [JointHandle::from_bits(0x1_0000_0002), JointHandle::from_bits(0x5_0000_0000)];
    [
        CouplingDesc::gear(joints, [20.0, -31.0]),
        CouplingDesc::pulley(joints, 2.1, 4.1).with_break_force([0.1, f32::INFINITY]),
        CouplingDesc::screw(joints[1], 1e-4).with_range(Some([-0.1, f64::INFINITY])),
        CouplingDesc::rack(joints[0], joints[1], 0.3).with_range(Some([f64::NEG_INFINITY, f64::INFINITY])),
        CouplingDesc::gear(joints, [1.0, 0.1]).with_break_force([7.0, 0.3]).with_user_data(u64::MAX),
    ]
}

#[test]
fn every_description_comes_back_from_text_and_from_bytes() {
    there_and_back(&body());
    there_and_back(&BodyDesc::default());
    there_and_back(&joint());
    there_and_back(&JointDesc::hinge(bodies(), [Frame::default(); 2]));
    for coupling in couplings() {
        assert_eq!(there_and_back(&coupling), coupling);
    }
    there_and_back(&Skeleton::humanoid());
    there_and_back(&CharacterSettings::default());
    there_and_back(&Settings::default());
}

/// Expected: the defaults that the types document.
#[test]
fn what_is_the_default_may_be_left_out() {
    let body: BodyDesc =
        serde_json::from_str(r#"{"shapes": [{"geometry": {"sphere": {"radius": 0.5}}}]}"#).unwrap();
    let expected = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::sphere(0.5)));
    assert_eq!(format!("{body:?}"), format!("{expected:?}"));
    let both = serde_json::to_string(&bodies()).unwrap();
    let text = format!(
        r#"{{"bodies": {both}, "motors": [{{"motion": "angular", "axis": "x",
             "spring": {{"frequency": {{"hertz": 2, "ratio": 1}}}}}}]}}"#
    );
    let joint: JointDesc = serde_json::from_str(&text).unwrap();
    let spring = Spring::Frequency { hertz: 2.0, ratio: 1.0 };
    let motor = Motor::position(Motion::Angular, Axis::X, 0.0, spring);
    assert_eq!(joint, JointDesc::new(bodies(), [Frame::default(); 2]).with_motor(motor));
    let Value::Object(mut text) = serde_json::to_value(couplings()[0]).unwrap() else { panic!() };
    text.retain(|name, _| name == "motions");
    assert_eq!(serde_json::from_value::<CouplingDesc>(text.into()).unwrap(), couplings()[0]);
    // The heights of a field are enough; the rest is found.
    let field: HeightField =
        serde_json::from_str(r#"{"columns": 2, "rows": 2, "cell": [1, 1], "heights": [0, 1, 0, 0]}"#)
            .unwrap();
    let built = HeightField::new(2, 2, Vec2::ONE, vec![0.0, 1.0, 0.0, 0.0]).unwrap();
    assert_eq!(format!("{field:?}"), format!("{built:?}"));
}

#[test]
fn unknown_fields_and_values_that_cant_be_are_refused() {
    refused::<BodyDesc>(r#"{"positoin": [0, 1, 0]}"#, "unknown field `positoin`");
    refused::<BodyDesc>(r#"{"kind": "movable"}"#, "unknown variant `movable`");
    refused::<BodyDesc>(r#"{"position": [0, 1]}"#, "invalid length 2");
    refused::<ShapeDesc>(r#"{"density": 3}"#, "missing field `geometry`");
    refused::<ShapeDesc>(r#"{"geometry": {"sphere": {"radius": 1, "height": 2}}}"#, "unknown field `height`");
    refused::<ShapeDesc>(r#"{"geometry": "plane", "material": {"friction": 1}}"#, "unknown field `friction`");
    refused::<CouplingDesc>(r#"{"break_force": [1, "strong"]}"#, "infinity");
    refused::<CouplingDesc>(r#"{"strengths": [1, 2]}"#, "unknown field `strengths`");
    refused::<Limit>(r#"{"motion": "linear", "axes": "all", "min": "low", "max": 1}"#, "infinity");
    let field = r#"{"columns": 2, "rows": 2, "cell": [1, 1], "heights": [0, 1, 0]}"#;
    refused::<HeightField>(field, "columns times rows");
    // A number out of range is refused where it is used, as if it came from a builder.
    let body: BodyDesc =
        serde_json::from_str(r#"{"shapes": [{"geometry": {"sphere": {"radius": -1}}}]}"#).unwrap();
    assert!(matches!(body.validate(), Err(Error::OutOfRange { what: "sphere radius", .. })));
    let mut world = World::new(Settings::default()).unwrap();
    assert_eq!(world.add_body(&body), Err(body.validate().unwrap_err()));
    assert_eq!(world.body_count(), 0);
}
