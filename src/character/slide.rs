//! Collide and slide: straight to the first obstacle, on along it, and so on until the way is used up.
//!
//! The obstacles met stay in mind as planes, and what is left of the wish is fitted between all of them at once
//! (`planes.rs`), so that a corner stops what runs into it where it stands.

use super::planes::Planes;
use super::shape::Shape;
use super::step::step_up;
use crate::error::Error;
use crate::query::ShapeHit;
use glam::DVec3;

/// A walk or a flight, under way.
pub(super) struct Slide {
    pub(super) at: DVec3,
    /// What is left of the wish [m]: across `up`, and along it.
    pub(super) across: DVec3,
    pub(super) rise: f64,
    /// Whether it keeps to the ground: slopes cost it nothing, and what is steep is a wall.
    pub(super) walks: bool,
    /// All that was met.
    pub(super) planes: Planes,
    /// What is too steep to walk on, upright.
    walls: Planes,
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
            walks: false,
            planes: Planes::default(),
            walls: Planes::default(),
            floors: Planes::default(),
            stepped: 0.0,
        }
    }

    /// On ground with such a normal.
    pub(super) fn on(mut self, normal: DVec3) -> Slide {
        self.walks = true;
        self.floors.add(normal);
        self
    }

    /// The way that is wished for, as far as planes allow it.
    fn path(&self, up: DVec3) -> DVec3 {
        if !self.walks {
            return self.planes.clip(self.across + up * self.rise);
        }
        let across = self.walls.clip(self.across);
        // As far across as on level ground, however it slopes.
        let rise = |n: &DVec3| -n.dot(across) / n.dot(up);
        let rise = self.floors.as_slice().iter().map(rise).reduce(f64::max).unwrap_or(0.0);
        self.planes.clip(across + up * rise)
    }

    /// Goes on until nothing is left, at most past `most` obstacles; climbs steps of up to `step` [m]. `heard` is told of
    /// each obstacle.
    pub(super) fn run(
        &mut self,
        shape: &Shape<'_>,
        most: u32,
        step: f64,
        heard: &mut dyn FnMut(&ShapeHit),
    ) -> Result<(), Error> {
        let mut tries = 2;
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
            heard(&hit);
            let normal = hit.normal.as_dvec3();
            let wall = self.meet(shape, &hit);
            // What should have been slid along is in the way by its rounding.
            if normal.dot(path) > -1e-5 * length {
                self.at += normal * shape.tiny;
            }
            if let Some(wall) = wall
                && self.walks
                && step > 0.0
                && tries > 0
            {
                tries -= 1;
                if let Some(climbed) = step_up(shape, self, wall, step)? {
                    self.stepped += climbed;
                    break;
                }
            }
        }
        Ok(())
    }

    /// Keeps an obstacle in mind. If it is a wall, returns its normal upright.
    fn meet(&mut self, shape: &Shape<'_>, hit: &ShapeHit) -> Option<DVec3> {
        let normal = hit.normal.as_dvec3().normalize();
        self.planes.add(normal);
        if shape.is_floor(hit.normal) {
            self.floors.add(normal);
            if !self.walks && self.rise <= 0.0 {
                // It lands, and what is left of the fall does not slide downhill.
                self.walks = true;
                self.rise = 0.0;
            }
            return None;
        }
        let (rise, across) = shape.split(normal);
        let wall = across.try_normalize()?;
        self.walls.add(wall);
        // Nobody gets up a steep slope by running or jumping at it.
        if rise > 0.0 {
            self.planes.add(wall);
        }
        Some(wall)
    }

    /// What planes leave of a velocity.
    pub(super) fn clip(&self, velocity: DVec3) -> DVec3 {
        if self.walks { self.walls.clip(velocity) } else { self.planes.clip(velocity) }
    }
}
