//! Scenes: bodies and joints described without an engine, from code or from files, and files made from them.
//!
//! [`builtin`] has the scenes that tests, benches and the command share. With the feature `gltf`, `load` reads
//! glTF 2.0 with `KHR_physics_rigid_bodies` and `KHR_implicit_shapes`, plain glTF and OBJ; `write_scene` writes a scene
//! with both extensions, and `write_animation` writes what a [`Recorder`] saw as a `.glb` that any viewer plays.

pub mod builtin;
pub mod comparison;
mod crowd;
pub(crate) mod joined;
mod plan;
mod rain;
mod record;
pub(crate) mod rng;
pub mod shots;
mod standing;
mod terrain;
mod weld;

#[cfg(feature = "gltf")]
mod assets;
#[cfg(feature = "gltf")]
mod atomic;
#[cfg(feature = "gltf")]
mod error;
#[cfg(feature = "gltf")]
mod generate;
#[cfg(feature = "gltf")]
mod gltf_in;
#[cfg(feature = "gltf")]
mod gltf_out;
#[cfg(feature = "gltf")]
mod obj;
#[cfg(feature = "gltf")]
mod resolve;

pub use plan::Plan;
pub use record::Recorder;
pub use standing::Standing;
pub use terrain::Terrain;

#[cfg(feature = "gltf")]
pub use atomic::{AtomicFile, refuse_input, write_file};
#[cfg(feature = "gltf")]
pub use error::SceneError;
#[cfg(feature = "gltf")]
pub use generate::{SHIPPED, shipped, write_shipped};
#[cfg(feature = "gltf")]
pub use gltf_out::{write_animation, write_animation_with, write_scene};
#[cfg(feature = "gltf")]
pub use resolve::{Resolver, scene_folder};

use crate::body::{BodyDesc, BodyKind};
use crate::error::Error;
use crate::handle::{BodyHandle, JointHandle};
use crate::joint::{Drive, Frame, JointDesc, Limit};
#[cfg(feature = "gltf")]
use crate::load_limits::{LoadLimits, Tally};
use crate::world::World;
use glam::Vec3;
use std::path::PathBuf;

/// Bodies and what else a world needs to start.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Of the builtin scene, or of the file without its ending.
    pub name: String,
    /// [m/s²]. Files have none, so it is (0, -9.81, 0) for them.
    pub gravity: Vec3,
    /// In the order in which a world should add them.
    pub bodies: Vec<SceneBody>,
    /// Between these bodies.
    pub joints: Vec<SceneJoint>,
    /// Steps of 1/60 s after which there is nothing new to see.
    pub steps: u32,
    /// The file that it is from.
    pub source: Option<PathBuf>,
    /// The files that this one refers to, buffers and images, as far as they are there.
    pub parts: Vec<PathBuf>,
    /// What of the file was left out or approximated, in sentences.
    pub notes: Vec<String>,
}

/// A body of a scene.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// Of the node, or of the kind of body.
    pub name: String,
    /// The glTF node whose pose is the body's pose.
    pub node: Option<usize>,
    /// What a world adds.
    pub desc: BodyDesc,
}

/// A joint of a scene: [`JointDesc`] with bodies by their indices.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneJoint {
    /// Of the node that has it.
    pub name: String,
    /// Indices in [`Scene::bodies`], at least one of them of a dynamic body.
    pub bodies: [usize; 2],
    /// Where it sits on each.
    pub frames: [Frame; 2],
    /// What is kept within a range.
    pub limits: Vec<Limit>,
    /// What is driven.
    pub drives: Vec<Drive>,
    /// Whether the two bodies collide with each other.
    pub collide: bool,
}

impl SceneJoint {
    /// What a world adds, given the handles of all bodies of the scene; `None` if an index is beyond them.
    pub fn desc(&self, bodies: &[BodyHandle]) -> Option<JointDesc> {
        let [a, b] = self.bodies.map(|i| bodies.get(i).copied());
        Some(JointDesc {
            limits: self.limits.clone(),
            drives: self.drives.clone(),
            collide: self.collide,
            ..JointDesc::new([a?, b?], self.frames)
        })
    }
}

/// Handles of what a scene has, in its order.
#[derive(Clone, Debug, Default)]
pub struct Added {
    /// Of [`Scene::bodies`].
    pub bodies: Vec<BodyHandle>,
    /// Of [`Scene::joints`].
    pub joints: Vec<JointHandle>,
}

impl Scene {
    /// An empty scene with the earth's gravity.
    pub fn new(name: impl Into<String>) -> Self {
        Scene {
            name: name.into(),
            gravity: Vec3::new(0.0, -9.81, 0.0),
            bodies: Vec::new(),
            joints: Vec::new(),
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

    /// How many bodies contacts can move.
    pub fn dynamic_bodies(&self) -> usize {
        self.bodies.iter().filter(|b| b.desc.kind == BodyKind::Dynamic).count()
    }

    /// The descriptions of the bodies alone, as a world takes them.
    pub fn descs(&self) -> Vec<BodyDesc> {
        self.bodies.iter().map(|b| b.desc.clone()).collect()
    }

    /// Adds all bodies and then all joints to a world, or none of them. Gravity is the world's.
    ///
    /// # Errors
    /// If the world refuses one, or a joint's index is beyond the bodies.
    pub fn add_to(&self, world: &mut World) -> Result<Added, Error> {
        let bodies = world.add_bodies(&self.descs())?;
        let joints = self.joints.iter().map(|joint| match joint.desc(&bodies) {
            Some(desc) => Ok(desc),
            None => {
                let value = joint.bodies[0].max(joint.bodies[1]) as f64;
                Err(Error::OutOfRange {
                    what: "joint body",
                    expected: "an index of the scene's bodies",
                    value,
                })
            }
        });
        let joints = joints.collect::<Result<Vec<_>, _>>().and_then(|joints| world.add_joints(&joints));
        match joints {
            Ok(joints) => Ok(Added { bodies, joints }),
            Err(error) => {
                // Their joints go with them.
                bodies.into_iter().try_for_each(|body| world.remove_body(body))?;
                Err(error)
            }
        }
    }
}

/// Reads a scene: `.gltf` and `.glb` with or without physics, `.obj` as one static mesh. What a glTF file refers to by
/// `uri` must be a regular file in its own folder or below, see [`scene_folder`].
///
/// # Errors
/// Names the file, the node if it is about one, and what is wrong with it.
#[cfg(feature = "gltf")]
pub fn load(path: impl AsRef<std::path::Path>) -> Result<Scene, SceneError> {
    load_limited(path, &LoadLimits::default())
}

/// The same within other limits.
///
/// # Errors
/// As [`load`].
#[cfg(feature = "gltf")]
pub fn load_limited(path: impl AsRef<std::path::Path>, limits: &LoadLimits) -> Result<Scene, SceneError> {
    let path = path.as_ref();
    load_with(path, &scene_folder(path), limits)
}

/// The same with another [`Resolver`] for the uris of a glTF file; data URIs are read without it.
///
/// # Errors
/// As [`load`].
#[cfg(feature = "gltf")]
pub fn load_with(
    path: impl AsRef<std::path::Path>,
    resolve: &Resolver<'_>,
    limits: &LoadLimits,
) -> Result<Scene, SceneError> {
    let path = path.as_ref();
    let load = parser(path)?;
    let mut tally = Tally::new(limits);
    let bytes = read_file(path, &mut tally.bytes)?;
    let mut scene = load(path, &bytes, resolve, tally)?;
    scene.source = Some(path.into());
    Ok(scene)
}

/// The same of a file that is in memory. Its name says of what sort it is, and names it in errors.
///
/// # Errors
/// As [`load`].
#[cfg(feature = "gltf")]
pub fn from_bytes(
    name: impl AsRef<std::path::Path>,
    bytes: &[u8],
    resolve: &Resolver<'_>,
    limits: &LoadLimits,
) -> Result<Scene, SceneError> {
    let name = name.as_ref();
    let mut tally = Tally::new(limits);
    tally.bytes.take(bytes.len()).map_err(|source| SceneError::Limit { file: name.into(), source })?;
    parser(name)?(name, bytes, resolve, tally)
}

#[cfg(feature = "gltf")]
type Parser = fn(&std::path::Path, &[u8], &Resolver<'_>, Tally) -> Result<Scene, SceneError>;

/// What reads files with the ending of a path.
#[cfg(feature = "gltf")]
fn parser(path: &std::path::Path) -> Result<Parser, SceneError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "gltf" | "glb" => Ok(gltf_in::read),
        "obj" => Ok(|path, bytes, _, tally| obj::read(path, bytes, tally)),
        _ => Err(SceneError::UnknownFormat { file: path.into() }),
    }
}

/// A builtin scene by its name, or else a file.
///
/// # Errors
/// As [`load`].
#[cfg(feature = "gltf")]
pub fn open(name: &str) -> Result<Scene, SceneError> {
    open_limited(name, &LoadLimits::default())
}

/// The same within other limits.
///
/// # Errors
/// As [`load`].
#[cfg(feature = "gltf")]
pub fn open_limited(name: &str, limits: &LoadLimits) -> Result<Scene, SceneError> {
    match builtin::build(name) {
        Some(scene) => Ok(scene),
        None => load_limited(name, limits),
    }
}

/// Reads a whole file, if that is no more than its limit.
#[cfg(feature = "gltf")]
fn read_file(path: &std::path::Path, bytes: &mut crate::load_limits::Count) -> Result<Vec<u8>, SceneError> {
    use std::io::Read;
    let failed = |source| SceneError::Read { file: path.into(), source };
    let file = std::fs::File::open(path).map_err(failed)?;
    let mut content = Vec::new();
    // One more, to see that there is more.
    let most = bytes.left().saturating_add(1);
    file.take(most).read_to_end(&mut content).map_err(failed)?;
    bytes.take(content.len()).map_err(|source| SceneError::Limit { file: path.into(), source })?;
    Ok(content)
}

#[cfg(all(test, feature = "gltf"))]
mod testing {
    //! Where tests find data and put files.

    use std::path::PathBuf;

    /// A folder of the data beside the project; says so if there is none.
    pub(super) fn data(folder: &str) -> Option<PathBuf> {
        match std::env::var_os("BACKSTOP_DATA") {
            Some(root) => Some(PathBuf::from(root).join(folder)),
            None => {
                println!("skipped: BACKSTOP_DATA is not set");
                None
            }
        }
    }

    /// A folder for one test's files.
    pub(super) fn scratch(test: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("backstop_{}_{test}", std::process::id()));
        std::fs::create_dir_all(&dir).expect("a temporary folder");
        dir
    }
}
