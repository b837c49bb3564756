//! A camera that orbits a target point.

use super::canvas::Spot;
use backstop::glam::{DVec3, Mat3, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Half of the vertical field of view [rad].
const HALF_ANGLE: f32 = 0.38;
/// Near plane as a share of the distance to the target.
const NEAR: f64 = 1e-3;
/// Share of the picture that is filled with what is fitted in.
const FILLED: f64 = 0.8;
/// Limits of the distance to the target [m].
const LEAST: f64 = 1e-2;
const MOST: f64 = 1e7;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    /// What it looks at [m].
    pub(crate) target: DVec3,
    /// From there to the eye [m].
    pub(crate) distance: f64,
    /// Angle about the upright axis, from z towards x [rad].
    pub(crate) yaw: f32,
    /// Angle of the eye above the target [rad].
    pub(crate) pitch: f32,
}

impl Camera {
    /// Looks at a point from a distance [m], obliquely from above.
    pub(crate) fn above(target: DVec3, distance: f64) -> Camera {
        Camera { target, distance, yaw: 0.6, pitch: 0.35 }
    }

    /// As near as it sees all of these balls, centre and radius [m], in a picture of this aspect (width over
    /// height), without turning.
    pub(crate) fn fitting(self, balls: &[(DVec3, f64)], aspect: f32) -> Camera {
        let axes = self.axes();
        let [right, up, ahead] = [axes.x_axis, axes.y_axis, axes.z_axis].map(Vec3::as_dvec3);
        let half = f64::from(libm::tanf(HALF_ANGLE)) * FILLED;
        let mut eye = DVec3::new(0.0, 0.0, f64::INFINITY);
        for (i, (across, slope)) in [(right, half * f64::from(aspect)), (up, half)].into_iter().enumerate() {
            // How far the planes of the frustum on either side must be out, where they leave the eye.
            let stretch = (1.0 + slope * slope).sqrt();
            let reach = |side: f64| {
                let of = |(at, radius): &(DVec3, f64)| {
                    let from = *at - self.target;
                    side * from.dot(across) + radius * stretch - slope * from.dot(ahead)
                };
                balls.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
            };
            let (high, low) = (reach(1.0), reach(-1.0));
            eye[i] = 0.5 * (high - low);
            eye.z = eye.z.min(-0.5 * (high + low) / slope);
        }
        if !eye.is_finite() {
            return self;
        }
        let depths = balls.iter().map(|(at, _)| (*at - self.target).dot(ahead));
        let depth = depths.sum::<f64>() / balls.len() as f64;
        let target = self.target + right * eye.x + up * eye.y + ahead * depth;
        Camera { target, distance: (depth - eye.z).clamp(LEAST, MOST), ..self }
    }

    /// A share of the way to where another is.
    pub(crate) fn towards(self, other: Camera, share: f64) -> Camera {
        Camera {
            target: self.target.lerp(other.target, share),
            distance: self.distance + (other.distance - self.distance) * share,
            ..self
        }
    }

    /// From one point to another.
    pub(crate) fn between(eye: DVec3, target: DVec3) -> Camera {
        let away = eye - target;
        let distance = away.length().max(1e-3);
        let to = (away / distance).as_vec3();
        let camera = Camera { target, distance, yaw: libm::atan2f(to.x, to.z), pitch: libm::asinf(to.y) };
        camera.turned(0.0, 0.0)
    }

    /// Orbits the target by these angles [rad].
    pub(crate) fn turned(self, yaw: f32, pitch: f32) -> Camera {
        // Straight up and down, right and left would be undefined.
        let most = FRAC_PI_2 - 0.01;
        let yaw = (self.yaw + yaw) % (2.0 * PI);
        Camera { yaw, pitch: (self.pitch + pitch).clamp(-most, most), ..self }
    }

    /// Goes nearer or away by a factor.
    pub(crate) fn zoomed(self, factor: f64) -> Camera {
        Camera { distance: (self.distance * factor).clamp(LEAST, MOST), ..self }
    }

    /// Moves right and up, by shares of the visible height.
    pub(crate) fn shifted(self, right: f32, up: f32) -> Camera {
        let axes = self.axes();
        let seen = self.distance * 2.0 * f64::from(libm::tanf(HALF_ANGLE));
        let way = (axes.x_axis * right + axes.y_axis * up).as_dvec3() * seen;
        Camera { target: self.target + way, ..self }
    }

    pub(crate) fn eye(&self) -> DVec3 {
        self.target - self.axes().z_axis.as_dvec3() * self.distance
    }

    /// Right, up and ahead.
    fn axes(&self) -> Mat3 {
        let (sin, cos) = (libm::sinf(self.yaw), libm::cosf(self.yaw));
        let (rise, flat) = (libm::sinf(self.pitch), libm::cosf(self.pitch));
        let ahead = Vec3::new(-sin * flat, -rise, -cos * flat);
        let right = Vec3::new(cos, 0.0, -sin);
        Mat3::from_cols(right, right.cross(ahead), ahead)
    }

    /// The view for a picture of this size in pixels.
    pub(crate) fn view(&self, width: f32, height: f32) -> View {
        View {
            eye: self.eye(),
            back: self.axes().transpose(),
            focal: 0.5 * height / libm::tanf(HALF_ANGLE),
            middle: (0.5 * width, 0.5 * height),
            near: (self.distance * NEAR) as f32,
        }
    }
}

/// From the world to a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    eye: DVec3,
    /// World axes to right, up and ahead: left-handed, so it turns cross products round.
    back: Mat3,
    focal: f32,
    middle: (f32, f32),
    near: f32,
}

impl View {
    /// A point in the eye's frame: right, up, ahead [m].
    pub(crate) fn see(&self, point: DVec3) -> Vec3 {
        // The difference is taken in f64; after that f32 suffices, anywhere in the world.
        self.back * (point - self.eye).as_vec3()
    }

    /// A direction of the world in the eye's frame.
    pub(crate) fn direction(&self, v: Vec3) -> Vec3 {
        self.back * v
    }

    /// Where a point in front of the eye is on the picture.
    pub(crate) fn spot(&self, seen: Vec3) -> Option<Spot> {
        (seen.z >= self.near).then(|| self.project(seen))
    }

    fn project(&self, seen: Vec3) -> Spot {
        let nearness = 1.0 / seen.z;
        Spot {
            x: self.middle.0 + self.focal * seen.x * nearness,
            y: self.middle.1 - self.focal * seen.y * nearness,
            nearness,
        }
    }

    /// The part of a line that is in front of the eye.
    pub(crate) fn line(&self, from: Vec3, to: Vec3) -> Option<(Spot, Spot)> {
        let cut = |a: Vec3, b: Vec3| {
            if a.z >= self.near { a } else { a + (b - a) * ((self.near - a.z) / (b.z - a.z)) }
        };
        let seen = from.z >= self.near || to.z >= self.near;
        seen.then(|| (self.project(cut(from, to)), self.project(cut(to, from))))
    }

    /// The part of a triangle that is in front of the eye, as up to two triangles.
    pub(crate) fn triangle(&self, corners: [Vec3; 3], f: &mut dyn FnMut([Spot; 3])) {
        if corners.iter().all(|c| c.z >= self.near) {
            return f(corners.map(|c| self.project(c)));
        }
        let mut kept = [Vec3::ZERO; 4];
        let mut count = 0;
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if a.z >= self.near {
                kept[count] = a;
                count += 1;
            }
            if (a.z >= self.near) != (b.z >= self.near) {
                kept[count] = a + (b - a) * ((self.near - a.z) / (b.z - a.z));
                count += 1;
            }
        }
        for i in 2..count {
            f([kept[0], kept[i - 1], kept[i]].map(|c| self.project(c)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_looked_at_is_in_the_middle_and_right_is_right() {
        let far = DVec3::new(4e6, -7.0, 1e5);
        for camera in [Camera::above(far, 8.0), Camera::between(far + DVec3::new(3.0, 4.0, -5.0), far)] {
            let view = camera.view(640.0, 400.0);
            let middle = view.spot(view.see(far)).unwrap();
            assert!((middle.x - 320.0).abs() < 1e-2 && (middle.y - 200.0).abs() < 1e-2, "{middle:?}");
            assert!((camera.eye() - far).length() - camera.distance < 1e-6);
            let above = view.spot(view.see(far + DVec3::Y)).unwrap();
            assert!(above.y < middle.y && (above.x - middle.x).abs() < 1e-2);
            let moved = camera.shifted(0.5, 0.0).view(640.0, 400.0);
            assert!((moved.spot(moved.see(far)).unwrap().x - 120.0).abs() < 1.0);
        }
        // From in front, x goes right.
        let view = Camera::between(DVec3::Z * 5.0, DVec3::ZERO).view(100.0, 100.0);
        assert!(view.spot(view.see(DVec3::X)).unwrap().x > 50.0);
    }

    /// Expected: the outermost balls reach four fifths of the picture's half, on at least one axis and on no
    /// axis further.
    #[test]
    fn balls_are_fitted_in() {
        let far = DVec3::new(-3e5, 20.0, 7e4);
        let places = [DVec3::ZERO, DVec3::new(4.0, 1.0, -2.0), DVec3::new(-3.0, 5.0, 6.0)];
        for (aspect, balls) in
            [(1.0, &places[..1]), (2.0, &places[..]), (0.5, &places[..])].map(|(a, p)| (a, p.to_vec()))
        {
            let balls: Vec<_> = balls.into_iter().map(|p| (far + p, 0.5)).collect();
            let camera = Camera::above(far, 100.0).fitting(&balls, aspect);
            let view = camera.view(100.0 * aspect, 100.0);
            let outermost = balls.iter().fold(0.0f32, |most, &(at, radius)| {
                let seen = view.see(at);
                let edge = |across: f32, half: f32| {
                    // The tangent from the eye to the ball.
                    let angle = libm::atan2f(across.abs(), seen.z)
                        + libm::asinf(radius as f32 / across.hypot(seen.z));
                    libm::tanf(angle) / half
                };
                let half = libm::tanf(HALF_ANGLE);
                most.max(edge(seen.x, half * aspect)).max(edge(seen.y, half))
            });
            assert!((outermost - 0.8).abs() < 1e-2, "{outermost} at {aspect}");
        }
        assert_eq!(Camera::above(far, 7.0).fitting(&[], 1.0), Camera::above(far, 7.0));
    }

    #[test]
    fn what_is_behind_the_eye_is_cut_off() {
        let view = Camera::between(DVec3::Z * 5.0, DVec3::ZERO).view(100.0, 100.0);
        let see = |z: f64| view.see(DVec3::new(0.5, 0.0, z));
        assert!(view.spot(see(6.0)).is_none() && view.line(see(6.0), see(7.0)).is_none());
        let (near, far) = view.line(see(0.0), see(7.0)).unwrap();
        assert!(near.x.is_finite() && far.nearness > near.nearness);
        let mut parts = 0;
        view.triangle([see(0.0), see(1.0), see(7.0)], &mut |_| parts += 1);
        assert_eq!(parts, 2);
    }
}
