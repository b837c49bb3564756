//! The obstacles that a character touches, as planes that its path must not enter.

use glam::DVec3;

/// The most planes: a character does not touch more at once in any relevant way.
const MAX_PLANES: usize = 12;

/// Directions `d` with `n · d >= 0` for all of some normals: a cone.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Planes {
    normals: [DVec3; MAX_PLANES],
    count: usize,
}

impl Planes {
    pub(super) fn as_slice(&self) -> &[DVec3] {
        &self.normals[..self.count]
    }

    /// Adds a normal; false if it was there already, up to rounding.
    pub(super) fn add(&mut self, normal: DVec3) -> bool {
        // Half a milliradian, more than normals differ from cast to cast.
        let same = self.as_slice().iter().position(|n| n.dot(normal) > 1.0 - 1e-7);
        if let Some(same) = same {
            self.normals[same] = normal;
        } else {
            // Replaces the last one: the present touch counts.
            self.count = (self.count + 1).min(MAX_PLANES);
            self.normals[self.count - 1] = normal;
        }
        same.is_none()
    }

    /// The direction in the cone that is nearest to `d`: `d` itself, along one plane, along the crease of
    /// two, or none. All candidates are tried, so the result does not depend on the order of planes and does
    /// not jitter.
    pub(super) fn clip(&self, d: DVec3) -> DVec3 {
        let normals = self.as_slice();
        let slack = -1e-9 * d.length();
        let allowed = |x: DVec3| normals.iter().all(|n| n.dot(x) >= slack);
        if allowed(d) {
            return d;
        }
        let mut best = (d.length_squared(), DVec3::ZERO);
        let mut try_one = |x: DVec3| {
            let off = (x - d).length_squared();
            if off < best.0 && allowed(x) {
                best = (off, x);
            }
        };
        for (i, a) in normals.iter().enumerate() {
            try_one(d - *a * a.dot(d));
            for b in &normals[..i] {
                let along = a.cross(*b);
                let squared = along.length_squared();
                if squared > 1e-12 {
                    try_one(along * (along.dot(d) / squared));
                }
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planes(normals: &[DVec3]) -> Planes {
        let mut planes = Planes::default();
        normals.iter().for_each(|n| {
            planes.add(n.normalize());
        });
        planes
    }

    #[test]
    fn the_way_out_of_planes_is_the_nearest_that_there_is() {
        let d = DVec3::new(1.0, -2.0, 3.0);
        assert_eq!(planes(&[]).clip(d), d);
        assert_eq!(planes(&[DVec3::Y]).clip(d), DVec3::new(1.0, 0.0, 3.0));
        assert_eq!(planes(&[DVec3::Y, DVec3::NEG_Z]).clip(d), DVec3::X);
        assert_eq!(planes(&[DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X]).clip(d), DVec3::ZERO);
        // In an acute corner neither side is possible, in an obtuse one the flatter.
        let acute = planes(&[DVec3::new(-1.0, 0.0, 0.3), DVec3::new(-1.0, 0.0, -0.3)]);
        assert_eq!(acute.clip(DVec3::X), DVec3::ZERO);
        assert!(!planes(&[DVec3::Y]).add(DVec3::Y));
        // By dense samples.
        let three = [DVec3::new(0.2, 1.0, 0.1), DVec3::new(-1.0, 0.4, 0.3), DVec3::new(0.1, 0.2, -1.0)];
        let (cone, three) = (planes(&three), three.map(DVec3::normalize));
        for i in 0..40 {
            let d = DVec3::new(f64::from(i % 5) - 2.0, f64::from(i % 7) - 3.0, f64::from(i % 3) - 1.0);
            let x = cone.clip(d);
            assert!(three.iter().all(|n| n.dot(x) >= -1e-8));
            for k in 0..8000 {
                let at = |n: i32| f64::from(n % 20 - 10) * 0.4;
                let y = DVec3::new(at(k), at(k / 20), at(k / 400));
                if three.iter().all(|n| n.dot(y) >= 0.0) {
                    assert!((x - d).length() <= (y - d).length() + 1e-9, "{d} {x} {y}");
                }
            }
        }
    }
}
