//! What the page asks for.

use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

/// Steps of one request, at most: a page asks for a frame at a time.
pub(crate) const MOST_STEPS: u32 = 1000;

/// One request. What is left out is not asked for.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) commands: Vec<Command>,
    pub(crate) steps: u32,
    pub(crate) layers: Vec<Layer>,
    pub(crate) want: Vec<Want>,
    /// An opening, and how many of its meshes the page has.
    pub(crate) meshes: [u64; 2],
}

/// A part of the answer that not every frame has.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Want {
    Scene,
    Ledger,
    Catalogue,
    Fields,
}

/// What can be drawn over the shapes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Layer {
    Contacts,
    Normals,
    Impulses,
    Joints,
    Aabbs,
    FatAabbs,
    Motion,
    Centres,
    Islands,
    Colours,
    Trees,
    Sleep,
}

/// Something to be done before the steps.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Command {
    Open {
        name: String,
        size: Option<u32>,
    },
    Restart,
    Back {
        steps: u64,
    },
    Seek {
        step: u64,
    },
    Grab(Sight),
    Drag {
        to: Triple,
    },
    Release,
    Shoot {
        origin: Triple,
        direction: Triple,
        speed: f32,
        shape: Option<Form>,
        size: Option<f32>,
    },
    Spawn {
        shape: Form,
        position: Option<Triple>,
        sight: Option<Sight>,
        distance: Option<f32>,
        size: Option<f32>,
    },
    Remove(Sight),
    Explode {
        position: Option<Triple>,
        sight: Option<Sight>,
        distance: Option<f32>,
        radius: f32,
        impulse: Option<f32>,
        speed: Option<f32>,
    },
    Inspect(Sight),
    Controls {
        #[serde(default)]
        forward: f32,
        #[serde(default)]
        right: f32,
        #[serde(default)]
        jump: bool,
        #[serde(default)]
        action: bool,
    },
    Settings(Map<String, Value>),
}

/// A ray from the eye.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sight {
    pub(crate) origin: Triple,
    pub(crate) direction: Triple,
}

/// A place: a point, or else what a ray from the eye hits first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) position: Option<Triple>,
    pub(crate) sight: Option<Sight>,
    /// How far along a ray that hits nothing [m].
    pub(crate) distance: Option<f32>,
}

/// What can be made.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Form {
    Box,
    Sphere,
    Capsule,
    TaperedCapsule,
    Cylinder,
    TaperedCylinder,
    Cone,
    Hull,
    Ragdoll,
}

/// Three finite numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple(pub(crate) [f64; 3]);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Triple, D::Error> {
        // JSON has no number that is not finite.
        <[f64; 3]>::deserialize(from).map(Triple)
    }
}
