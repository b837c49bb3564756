//! Balls inside of bodies: what they overlap by, bodies overlap by at least.

use super::measures::State;
use backstop::{BodyDesc, BodyKind, Geometry};
use glam::{DVec3, Vec3};

/// A ball in the axes of a body.
#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: Vec3,
    radius: f32,
}

/// The balls inside of dynamic bodies, and the static boxes of a scene.
#[derive(Clone, Debug)]
pub(super) struct Insides {
    /// Those of each body; static ones have none.
    balls: Vec<Vec<Ball>>,
    /// Radius of a ball about the origin of each body that has its balls inside.
    around: Vec<f64>,
    /// Half extents of bodies that are one static box.
    boxes: Vec<(usize, DVec3)>,
}

impl Insides {
    pub(super) fn of(bodies: &[BodyDesc]) -> Insides {
        let balls: Vec<_> = bodies.iter().map(balls_of).collect();
        let reach = |ball: &Ball| f64::from(ball.centre.length() + ball.radius);
        let around = balls.iter().map(|balls| balls.iter().map(reach).fold(0.0, f64::max)).collect();
        let boxes = bodies.iter().enumerate().filter_map(|(i, body)| match &body.shapes[..] {
            [shape] if body.kind == BodyKind::Static => match shape.geometry {
                Geometry::Box { half_extents } => Some((i, half_extents.as_dvec3())),
                _ => None,
            },
            _ => None,
        });
        Insides { around, boxes: boxes.collect(), balls }
    }

    /// The deepest overlap [m] with a static box, and between two bodies if `pairs` count.
    pub(super) fn deepest(&self, states: &[State], pairs: bool) -> f64 {
        let placed: Vec<Vec<(DVec3, f64)>> = self.balls.iter().zip(states).map(placed).collect();
        let mut deepest = 0.0_f64;
        for (&(centre, radius), &(body, half)) in
            placed.iter().flatten().flat_map(|ball| self.boxes.iter().map(move |at| (ball, at)))
        {
            deepest = deepest.max(radius - from_box(centre, &states[body], half));
        }
        let moving: Vec<usize> = (0..placed.len()).filter(|&i| pairs && !placed[i].is_empty()).collect();
        for (n, &a) in moving.iter().enumerate() {
            for &b in &moving[..n] {
                let most = self.around[a] + self.around[b] - deepest;
                if (states[a].position - states[b].position).length_squared() > most * most {
                    continue;
                }
                for &(p, r) in &placed[a] {
                    let depth = |&(q, s): &(DVec3, f64)| r + s - (p - q).length();
                    deepest = placed[b].iter().map(depth).fold(deepest, f64::max);
                }
            }
        }
        deepest
    }

    /// Whether a point is in a static box.
    pub(super) fn holds(&self, point: DVec3, states: &[State]) -> bool {
        self.boxes.iter().any(|&(body, half)| from_box(point, &states[body], half) < 0.0)
    }
}

fn placed((balls, state): (&Vec<Ball>, &State)) -> Vec<(DVec3, f64)> {
    let one =
        |ball: &Ball| (state.position + (state.rotation * ball.centre).as_dvec3(), f64::from(ball.radius));
    balls.iter().map(one).collect()
}

/// Distance of a point from the surface of a box [m], negative inside.
fn from_box(point: DVec3, state: &State, half: DVec3) -> f64 {
    let beyond = (state.rotation.as_dquat().inverse() * (point - state.position)).abs() - half;
    beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
}

fn balls_of(body: &BodyDesc) -> Vec<Ball> {
    let mut balls = Vec::new();
    for shape in body.shapes.iter().filter(|_| body.kind == BodyKind::Dynamic) {
        let (along, reach, radius) = match shape.geometry {
            Geometry::Sphere { radius } => (Vec3::ZERO, 0.0, radius),
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                (Vec3::Y, half_height, radius_bottom.min(radius_top))
            }
            // In a row along its longest axis.
            Geometry::Box { half_extents } => {
                let radius = half_extents.min_element();
                let longest = half_extents.max_element();
                let axis = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().find(|a| a.dot(half_extents) == longest);
                (axis.unwrap_or(Vec3::X), longest - radius, radius)
            }
            _ => continue,
        };
        let count = (reach / radius).ceil() as i32;
        for i in -count..=count {
            let way = along * (reach * i as f32 / count.max(1) as f32);
            balls.push(Ball { centre: shape.position + shape.rotation * way, radius });
        }
    }
    balls
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::glam::Quat;
    use backstop_scene::Rng;
    use backstop_scene::builtin::{dynamic, fixed};

    /// A ball within a box is as deep as the distances to six planes say, and two balls overlap by the sum of
    /// their radii less their distance, wherever both are.
    #[test]
    fn depths_are_those_of_planes_and_of_distances() {
        let mut rng = Rng::new(5);
        for _ in 0..1000 {
            let half = Vec3::new(rng.range(0.5, 2.0), rng.range(0.5, 2.0), rng.range(0.5, 2.0));
            let radius = rng.range(0.01, 0.4);
            let bodies = [
                fixed(Geometry::Box { half_extents: half }, Vec3::ZERO),
                dynamic(Geometry::Sphere { radius }, Vec3::ZERO),
                dynamic(Geometry::Sphere { radius }, Vec3::ZERO),
            ];
            let mut states = bodies.each_ref().map(State::of);
            let turn = Quat::from(rng.rotation());
            let at = rng.direction() * 1000.0;
            let within = Vec3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)) * half;
            (states[0].rotation, states[0].position) = (turn, at.as_dvec3());
            states[1].position = at.as_dvec3() + (turn * within).as_dvec3();
            let apart = rng.direction() * rng.range(0.0, 0.3);
            states[2].position = states[1].position + apart.as_dvec3();
            let insides = Insides::of(&bodies);
            let depth = |p: Vec3| radius + (half - p.abs()).min_element();
            let second = within + turn.inverse() * apart;
            if second.abs().cmplt(half).all() {
                let boxed = depth(within).max(depth(second));
                assert!((insides.deepest(&states, false) - f64::from(boxed)).abs() < 1e-4);
                let both = boxed.max(2.0 * radius - apart.length());
                assert!((insides.deepest(&states, true) - f64::from(both)).abs() < 1e-4);
            }
            assert!(insides.holds(states[1].position, &states));
        }
    }
}
