//! Ground truth of a scene: which bodies have got through.

use super::entrant::Entrant;
use backstop::Geometry;
use backstop::observe::BodyState;
use backstop::observe::paths::got_through;
use backstop_scene::builtin;
use backstop_scene::builtin::continuous::{DT, RAGDOLL_WALL, blade_times};
use backstop_scene::{Scene, SceneBody, Terrain};
use glam::{DVec3, Vec3};

/// The criterion by which a body got through.
#[derive(Debug)]
pub(super) enum Truth {
    /// Its centre is below the ground.
    Above(Terrain),
    /// Its centre is behind a wall: by body.
    Before(Vec<Wall>),
    /// It spins undisturbed although its post stood in its way; by step, counted from 1.
    Blades(Vec<u32>),
    /// Its centre went into or through the shape of another body in a step in which neither was pushed, so
    /// that both paths were straight; or it ends within another's shape.
    Way,
}

/// A wall that no body may get behind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    middle: DVec3,
    /// Unit vector from its front to its back.
    behind: DVec3,
    /// A body further from its middle than this went around it [m].
    half: f64,
}

/// A blade that lost less of its spin was not stopped.
const UNTOUCHED: f32 = 0.005;

impl Truth {
    pub(super) fn of(scene: &Scene) -> Truth {
        match scene.name.as_str() {
            "talk" => Truth::Above(builtin::talk_terrain()),
            "ragdoll_wall" => {
                let middle = DVec3::X * f64::from(RAGDOLL_WALL);
                let wall = Wall { middle, behind: DVec3::X, half: 19.0 };
                Truth::Before(vec![wall; scene.dynamic_bodies()])
            }
            "deflector" => Truth::Before(deflector_walls(scene)),
            "blades" => Truth::Blades(blade_times().map(|time| (time / DT) as u32 + 1).to_vec()),
            _ => Truth::Way,
        }
    }

    /// Adds the bodies that have got through by the end of a step to `through`, by their indices among
    /// dynamic bodies. `spins`: the spin of each at the start of the scene.
    pub(super) fn look(
        &self,
        step: u32,
        entrant: &Entrant,
        dynamic: &[usize],
        spins: &[Vec3],
        through: &mut [bool],
    ) {
        let world = &entrant.world;
        for (k, &body) in dynamic.iter().enumerate() {
            let handle = entrant.bodies[body];
            let Ok(BodyState { centre: at, angular, .. }) = BodyState::of(world, handle) else { continue };
            through[k] |= match self {
                Truth::Above(ground) => {
                    let Vec3 { x, y, z } = at.as_vec3();
                    ground.contains(x, z) && y < ground.height(x, z)
                }
                Truth::Before(walls) => {
                    let Wall { middle, behind, half } = walls[k];
                    let off = at - middle;
                    off.dot(behind) > 0.0 && (off - behind * off.dot(behind)).abs().max_element() < half
                }
                Truth::Blades(steps) => {
                    let now = angular.as_vec3();
                    steps[k] == step && (now - spins[k]).length() < UNTOUCHED * spins[k].length()
                }
                Truth::Way => got_through(world, handle, DT).unwrap_or(false),
            };
        }
    }
}

/// The wall of each ball, which it is not to get behind: bodies come as deflector, wall, ball.
fn deflector_walls(scene: &Scene) -> Vec<Wall> {
    let one = |three: &[SceneBody]| {
        let wall = &three[1].desc;
        let thin = match wall.shapes[0].geometry {
            Geometry::Box { half_extents } if half_extents.x < half_extents.y => DVec3::X,
            _ => DVec3::Y,
        };
        // They are 3.5 m to each side.
        Wall { middle: wall.position, behind: thin, half: 3.4 }
    };
    scene.bodies.chunks_exact(3).map(one).collect()
}
