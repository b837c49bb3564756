use super::*;

#[test]
fn vectors_turn_as_by_quaternions() {
    let (axis, v) = (glam::vec3(0.6, -0.48, 0.64), glam::vec3(1.0, -2.0, 0.5));
    for angle in [0.0, 1e-4, 0.5, 2.0, 3.1, 6.0, 6.4, 20.0, -100.0] {
        let expected = glam::Quat::from_axis_angle(axis, angle) * v;
        let turned = turned::<f32>(Vec3::splat(axis * angle), Vec3::splat(v)).lane(0);
        // The error of the series, at half a turn of half the angle: 3e-4 in the sine.
        assert!((turned - expected).length() < 3e-3, "{angle}: {turned} {expected}");
    }
}
