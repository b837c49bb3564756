//! What can be opened: samples, builtin scenes of a size that can be chosen, and the file of the command
//! line.

use crate::Refusal;
use backstop::{BodyDesc, BodyHandle, BodyKind, Error, Geometry, Settings, ShapeDesc, TriangleMesh, World};
use backstop_samples::{Running, SAMPLES, Sample};
use backstop_scene::{Scene, Standing, Terrain, builtin};
use serde_json::{Value, json};
use std::sync::Arc;

/// The group of builtin scenes in the catalogue.
const SCENES: &str = "scenes";
/// The name under which the file of the command line is opened.
const FILE: &str = "file";

/// A world that is made anew whenever its scene is opened, such as that of a file.
pub struct FileScene {
    /// Shown to the user.
    pub title: String,
    /// A sentence for the catalogue.
    pub about: String,
    /// Length of its steps [s].
    pub dt: f32,
    /// Makes it, with the names of its bodies.
    #[allow(clippy::type_complexity, reason = "the type of one closure")]
    pub start: Box<dyn Fn() -> Result<(World, Vec<(BodyHandle, String)>), Error>>,
}

/// A scene from its start.
pub(crate) struct Opened {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) size: Option<u32>,
    pub(crate) running: Box<dyn Running>,
    pub(crate) names: Vec<(BodyHandle, String)>,
    /// Length of its steps, unless it is 1/60 s [s].
    pub(crate) dt: Option<f32>,
}

/// A builtin scene whose size can be chosen. With their first size they are those of
/// `examples/same_bits.rs`, where that has them.
struct Offer {
    name: &'static str,
    about: &'static str,
    /// What its size counts.
    unit: &'static str,
    /// The first size, the smallest and the greatest.
    sizes: [u32; 3],
    build: fn(usize) -> Result<Scene, Error>,
}

const OFFERS: [Offer; 7] = [
    Offer {
        name: "talk",
        about: "Fast, spinning bodies of every shape onto a terrain of 100,352 triangles",
        unit: "bodies",
        sizes: [11, 11, 411],
        build: |size| {
            let mut scene = builtin::talk();
            scene.rain(size.saturating_sub(scene.dynamic_bodies()), 1);
            Ok(scene)
        },
    },
    Offer {
        name: "bullets",
        about: "Bullets and spinning blades at 50 to 500 m/s onto plates 2 cm thick",
        unit: "bodies",
        sizes: [1000, 10, 1000],
        build: |size| Ok(with_dynamic(builtin::bullets(true), size)),
    },
    Offer {
        name: "large_pyramid",
        about: "A wall of unit boxes that has to stand still",
        unit: "rows",
        sizes: [12, 3, 40],
        build: |size| Ok(builtin::large_pyramid(size)),
    },
    Offer {
        name: "joint_grid",
        about: "A net of balls and joints, held in the middle of its upper edge",
        unit: "balls a side",
        sizes: [10, 4, 40],
        build: |size| Ok(builtin::joint_grid(size)),
    },
    Offer {
        name: "ragdolls",
        about: "Figures of bones and joints fall among boxes, cylinders and balls",
        unit: "figures",
        sizes: [6, 1, 30],
        build: |size| Ok(builtin::ragdolls(size)),
    },
    Offer {
        name: "pile",
        about: "Boxes, balls, capsules and hulls into an open box",
        unit: "bodies",
        sizes: [768, 64, 2048],
        build: |size| Ok(with_dynamic(builtin::pile(), size)),
    },
    Offer {
        name: "rain",
        about: "Everything there is, compounds and cones too, rains onto hills",
        unit: "bodies",
        sizes: [300, 10, 1500],
        build: |size| {
            let mut scene = Scene::new("rain");
            let (vertices, triangles) = Terrain::bumpy(96, 0.25).mesh();
            let ground = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles)?));
            scene.add("terrain", BodyDesc::fixed().with_shape(ShapeDesc::new(ground)));
            scene.rain(size, 1);
            Ok(scene)
        },
    },
];

/// Opens what has this name: a sample, a builtin scene, or `file`. The size is brought into its range.
pub(crate) fn open(name: &str, size: Option<u32>, file: Option<&FileScene>) -> Result<Opened, Refusal> {
    if let (FILE, Some(file)) = (name, file) {
        let (world, names) = (file.start)()?;
        let (running, title) = (Box::new(world), file.title.clone());
        return Ok(Opened { name: FILE.into(), title, size: None, running, names, dt: Some(file.dt) });
    }
    if let Some(sample) = Sample::named(name) {
        let (running, title) = ((sample.start)()?, sample.title().into());
        return Ok(Opened { name: name.into(), title, size: None, running, names: Vec::new(), dt: None });
    }
    let (scene, size) = match OFFERS.iter().find(|offer| offer.name == name) {
        Some(offer) => {
            let [usual, least, most] = offer.sizes;
            let size = size.unwrap_or(usual).clamp(least, most);
            ((offer.build)(size as usize)?, Some(size))
        }
        None => {
            let none =
                || Refusal::told(format!("there is no sample or scene \"{}\"", backstop::Escaped(name)));
            (builtin::build(name).ok_or_else(none)?, None)
        }
    };
    let mut world = World::new(Settings::default().with_gravity(scene.gravity))?;
    let bodies = scene.add_to(&mut world)?.bodies;
    let names = bodies.into_iter().zip(scene.bodies.into_iter().map(|body| body.name)).collect();
    Ok(Opened { name: name.into(), title: title_of(name), size, running: Box::new(world), names, dt: None })
}

/// Whether a session opens something by this name: a sample or a builtin scene.
pub fn knows(name: &str) -> bool {
    Sample::named(name).is_some()
        || OFFERS.iter().any(|offer| offer.name == name)
        || builtin::NAMES.contains(&name)
        || Standing::named(name, None).is_some()
}

/// All of it, for the page.
pub(crate) fn list(file: Option<&FileScene>) -> Value {
    let of_file =
        file.map(|file| json!({ "name": FILE, "title": file.title, "group": FILE, "about": file.about }));
    let samples = SAMPLES.iter().map(|sample| {
        let mut entry = json!({
            "name": sample.name, "title": sample.title(), "group": sample.group, "about": sample.about(),
            "source": sample.source, "path": sample.path(),
        });
        if !sample.keys().is_empty() {
            entry["controls"] = sample.keys().into();
        }
        entry
    });
    let scenes = OFFERS.iter().map(|offer| {
        let [size, least, most] = offer.sizes;
        json!({
            "name": offer.name, "title": title_of(offer.name), "group": SCENES, "about": offer.about,
            "unit": offer.unit, "size": size, "least": least, "most": most,
        })
    });
    of_file.into_iter().chain(samples).chain(scenes).collect()
}

/// A name as a title: "Large pyramid".
fn title_of(name: &str) -> String {
    let mut letters = name.chars().map(|letter| if letter == '_' { ' ' } else { letter });
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// What is fixed and the first dynamic bodies; for scenes without joints.
fn with_dynamic(mut scene: Scene, count: usize) -> Scene {
    let mut left = count;
    scene.bodies.retain(|body| {
        let fixed = body.desc.kind != BodyKind::Dynamic;
        let kept = fixed || left > 0;
        left -= usize::from(kept && !fixed);
        kept
    });
    scene
}
