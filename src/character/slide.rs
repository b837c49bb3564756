//! Collide and slide: straight to the first obstacle, then along it, and so on to the end of the path.
//!
//! Obstacles are remembered as planes, and the rest of the desired displacement is clipped against all of
//! them at once (`planes.rs`), so that a character stops in a corner without jitter.

use super::planes::Planes;
use super::shape::Shape;
use super::step::step_up;
use crate::config::tuning::SLIDING_SLOPE;
use crate::error::Error;
use crate::query::ShapeHit;
use glam::DVec3;

/// Steps that a walk tries to climb.
const MAX_STEPS: u32 = 4;

/// A walk or a flight, under way.
pub(super) struct Slide {
    pub(super) at: DVec3,
    /// The rest of the desired displacement [m]: across `up`, and along it.
    pub(super) across: DVec3,
    pub(super) rise: f64,
    /// The point of the ground that it stands or stood on, if it walks; heights of steps are measured from
    /// it, or from the feet if they are higher.
    pub(super) foot: DVec3,
    /// Whether it keeps to the ground: slopes do not slow it, and steep surfaces are walls.
    pub(super) walks: bool,
    /// All obstacles met.
    pub(super) planes: Planes,
    /// Obstacles that are too steep to walk on, with upright normals; and those met from above.
    walls: Planes,
    steep: Planes,
    floors: Planes,
    /// How far steps were climbed [m].
    pub(super) stepped: f64,
}

impl Slide {
    pub(super) fn new(at: DVec3, across: DVec3, rise: f64) -> Slide {
        Slide {
            at,
            across,
            rise,
            foot: DVec3::ZERO,
            walks: false,
            planes: Planes::default(),
            walls: Planes::default(),
            steep: Planes::default(),
            floors: Planes::default(),
            stepped: 0.0,
        }
    }

    /// On ground with such a normal, at a point.
    pub(super) fn on(mut self, normal: DVec3, foot: DVec3) -> Slide {
        self.walks = true;
        self.foot = foot;
        self.floors.add(normal);
        self
    }

    /// The desired displacement, as far as planes allow it.
    fn path(&self, up: DVec3) -> DVec3 {
        if !self.walks {
            return self.fly(self.across, up * self.rise);
        }
        let across = self.walls.clip(self.across);
        // The horizontal distance is that on level ground, for any slope.
        let rise = |n: &DVec3| -n.dot(across) / n.dot(up);
        let rise = self.floors.as_slice().iter().map(rise).reduce(f64::max).unwrap_or(0.0);
        self.planes.clip(across + up * rise)
    }

    /// A character can't climb a steep slope by running or jumping at it, nor hang on it by pressing against
    /// it.
    fn fly(&self, across: DVec3, rise: DVec3) -> DVec3 {
        self.planes.clip(self.steep.clip(across) + rise)
    }

    /// Goes on until nothing is left, at most past `most` obstacles; climbs steps of up to `step` [m].
    /// `heard` is called with each obstacle except floors.
    pub(super) fn run(
        &mut self,
        shape: &Shape<'_>,
        most: u32,
        step: f64,
        heard: &mut dyn FnMut(&ShapeHit),
    ) -> Result<(), Error> {
        let mut tries = MAX_STEPS;
        for _ in 0..most {
            let path = self.path(shape.up);
            let length = path.length();
            if length < 1e-3 * shape.tiny {
                break;
            }
            let Some(hit) = shape.cast(self.at, path)? else {
                self.at += path;
                (self.across, self.rise) = (DVec3::ZERO, 0.0);
                break;
            };
            let fraction = f64::from(hit.fraction);
            self.at += path * fraction;
            self.across *= 1.0 - fraction;
            self.rise *= 1.0 - fraction;
            let normal = hit.normal.as_dvec3();
            if !(self.walks && shape.is_floor(hit.normal)) {
                heard(&hit);
            }
            let wall = self.meet(shape, &hit);
            // By rounding, a plane that the path runs along is in the way.
            if normal.dot(path) > -1e-5 * length {
                self.at += normal * shape.tiny;
            }
            if let Some(wall) = wall
                && self.walks
                && step > 0.0
                && tries > 0
            {
                tries -= 1;
                step_up(shape, self, wall, step)?;
            }
        }
        Ok(())
    }

    /// Remembers an obstacle. If it is a wall, returns its normal upright.
    fn meet(&mut self, shape: &Shape<'_>, hit: &ShapeHit) -> Option<DVec3> {
        let normal = hit.normal.as_dvec3().normalize();
        self.planes.add(normal);
        if shape.is_floor(hit.normal) {
            self.floors.add(normal);
            if !self.walks && self.rise <= 0.0 {
                // It lands, and the rest of the fall does not slide downhill.
                self.walks = true;
                self.rise = 0.0;
                self.foot = hit.point;
            }
            return None;
        }
        let (rise, across) = shape.split(normal);
        let wall = across.try_normalize()?;
        self.walls.add(wall);
        if rise > 0.0 {
            self.steep.add(wall);
        }
        Some(wall)
    }

    /// Continues the walk from another position, where obstacles are found anew.
    pub(super) fn move_to(&mut self, at: DVec3, across: DVec3, floor: DVec3, foot: DVec3) {
        *self = Slide { stepped: self.stepped, ..Slide::new(at, across, 0.0) }.on(floor, foot);
    }

    /// The velocity after obstacles; `moved`: the actual velocity of a fall [m/s].
    pub(super) fn clip(&self, shape: &Shape<'_>, velocity: DVec3, moved: f64) -> DVec3 {
        if self.walks {
            return self.walls.clip(velocity);
        }
        let (rise, across) = shape.split(velocity);
        let (_, left) = shape.split(self.planes.clip(self.steep.clip(across)));
        let rise = if rise > 0.0 {
            shape.split(self.fly(across, shape.up * rise)).0
        } else if moved > SLIDING_SLOPE * rise {
            moved
        } else {
            // Sliding is frictionless: gravity accelerates along a slope by its full component in that
            // direction.
            rise
        };
        left + shape.up * rise
    }
}
