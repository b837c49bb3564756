//! Scenes: bodies and joints described without an engine, from code or from files, and files made from them.
//!
//! [`builtin`] has the scenes that tests, benches and the command share. With the feature `gltf`, `load`
//! reads glTF 2.0 with `KHR_physics_rigid_bodies` and `KHR_implicit_shapes`, plain glTF and OBJ;
//! `write_scene` writes a scene with both extensions, and `write_animation` writes what a [`Recorder`] saw as
//! a `.glb` that any viewer plays.

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

pub mod builtin;
mod coupling;
mod crowd;
#[cfg(feature = "gltf")]
mod files;
mod joined;
#[cfg(test)]
#[path = "../../../src/random.rs"]
mod random;
mod record;
mod rng;
pub mod shots;
mod weld;

pub use builtin::standing::Standing;
pub use builtin::terrain::Terrain;
pub use coupling::SceneCoupling;
pub use joined::{join, throw};
pub use record::Recorder;
pub use rng::{Rng, axis_angle};

#[cfg(feature = "gltf")]
pub use builtin::shipped::{SHIPPED, shipped, write_shipped};
#[cfg(feature = "gltf")]
pub use files::{
    AtomicFile, Resolver, SceneError, from_bytes, load, load_limited, load_with, open, open_limited,
    refuse_input, scene_folder, write_animation, write_animation_with, write_file, write_scene,
};

use backstop::Error;
use backstop::World;
use backstop::{BodyDesc, BodyKind};
use backstop::{BodyHandle, CouplingHandle, JointHandle};
use backstop::{Frame, JointDesc, Limit, Motor};
use glam::Vec3;
use std::path::PathBuf;

/// Bodies, joints and settings with which a world starts.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the builtin scene, or of the file without its extension.
    pub name: String,
    /// Gravity [m/s²]. Files have none, so it is (0, -9.81, 0) for them.
    pub gravity: Vec3,
    /// The bodies, in the order in which a world should add them.
    pub bodies: Vec<SceneBody>,
    /// The joints between these bodies.
    pub joints: Vec<SceneJoint>,
    /// The couplings of these joints.
    pub couplings: Vec<SceneCoupling>,
    /// Steps of 1/60 s after which there is nothing new to see.
    pub steps: u32,
    /// The file that it is from.
    pub source: Option<PathBuf>,
    /// The existing files that this one refers to: buffers and images.
    pub parts: Vec<PathBuf>,
    /// Properties that were left out or approximated when the file was read, in sentences.
    pub notes: Vec<String>,
}

/// A body of a scene.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// Name of the node, or of the kind of body.
    pub name: String,
    /// The glTF node whose pose is the body's pose.
    pub node: Option<usize>,
    /// What a world adds.
    pub desc: BodyDesc,
}

/// A joint of a scene: [`JointDesc`] with bodies by their indices.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneJoint {
    /// Name of the node that has it.
    pub name: String,
    /// Indices in [`Scene::bodies`], at least one of them of a dynamic body.
    pub bodies: [usize; 2],
    /// Its frame on each body.
    pub frames: [Frame; 2],
    /// Its limits.
    pub limits: Vec<Limit>,
    /// Its motors.
    pub motors: Vec<Motor>,
    /// Whether the two bodies collide with each other.
    pub collide: bool,
}

impl SceneJoint {
    /// What a world adds, given the handles of all bodies of the scene; `None` if an index is beyond them.
    pub fn desc(&self, bodies: &[BodyHandle]) -> Option<JointDesc> {
        let [a, b] = self.bodies.map(|i| bodies.get(i).copied());
        let mut desc = JointDesc::new([a?, b?], self.frames);
        (desc.limits, desc.motors) = (self.limits.clone(), self.motors.clone());
        desc.collide = self.collide;
        Some(desc)
    }
}

/// Handles of a scene's contents, in its order.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Added {
    /// Handles of [`Scene::bodies`].
    pub bodies: Vec<BodyHandle>,
    /// Handles of [`Scene::joints`].
    pub joints: Vec<JointHandle>,
    /// Handles of [`Scene::couplings`].
    pub couplings: Vec<CouplingHandle>,
}

impl Scene {
    /// An empty scene with the earth's gravity.
    pub fn new(name: impl Into<String>) -> Self {
        Scene {
            name: name.into(),
            gravity: Vec3::new(0.0, -9.81, 0.0),
            bodies: Vec::new(),
            joints: Vec::new(),
            couplings: Vec::new(),
            steps: 300,
            source: None,
            parts: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Adds a body, returns its index.
    pub fn add(&mut self, name: impl Into<String>, desc: BodyDesc) -> usize {
        self.bodies.push(SceneBody { name: name.into(), node: None, desc });
        self.bodies.len() - 1
    }

    /// Number of dynamic bodies.
    pub fn dynamic_bodies(&self) -> usize {
        self.bodies.iter().filter(|b| b.desc.kind == BodyKind::Dynamic).count()
    }

    /// The descriptions of the bodies alone, as a world takes them.
    pub fn descs(&self) -> Vec<BodyDesc> {
        self.bodies.iter().map(|b| b.desc.clone()).collect()
    }

    /// Adds all bodies, then all joints and then all couplings to a world, or none of them. Gravity is the
    /// world's.
    ///
    /// # Errors
    /// If the world refuses one, an index of a joint is beyond the bodies, or one of a coupling beyond the
    /// joints.
    pub fn add_to(&self, world: &mut World) -> Result<Added, Error> {
        let descs = self.descs();
        // How many rows a joint has does not depend on its bodies.
        let nobody = vec![BodyHandle::from_bits(0); descs.len()];
        let joints: Vec<_> = self.joints.iter().filter_map(|joint| joint.desc(&nobody)).collect();
        world.allow(&descs, &joints, self.couplings.len())?;
        let bodies = world.add_bodies(&descs)?;
        match self.add_joints(world, &bodies) {
            Ok((joints, couplings)) => Ok(Added { bodies, joints, couplings }),
            Err(error) => {
                // This removes their joints and couplings too.
                bodies.into_iter().try_for_each(|body| world.remove_body(body))?;
                Err(error)
            }
        }
    }

    /// Adds the joints and the couplings.
    fn add_joints(
        &self,
        world: &mut World,
        bodies: &[BodyHandle],
    ) -> Result<(Vec<JointHandle>, Vec<CouplingHandle>), Error> {
        let beyond = |what, count, indices: [usize; 2]| Error::Index {
            what,
            index: indices[0].max(indices[1]),
            count,
        };
        let joints = self.joints.iter().map(|joint| {
            let beyond = || beyond("index of a joint's body", bodies.len(), joint.bodies);
            joint.desc(bodies).ok_or_else(beyond)
        });
        let joints = world.add_joints(&joints.collect::<Result<Vec<_>, _>>()?)?;
        let couplings = self.couplings.iter().map(|coupling| {
            let beyond = || beyond("index of a coupled joint", joints.len(), coupling.joints);
            world.add_coupling(&coupling.desc(&joints).ok_or_else(beyond)?)
        });
        let couplings = couplings.collect::<Result<_, _>>()?;
        Ok((joints, couplings))
    }
}
