//! The scenes of the page. With their first size they are those of `examples/same_bits.rs`, where that has
//! them.

use backstop::{BodyDesc, Error, Geometry, JointHandle, Settings, ShapeDesc, TriangleMesh, World};
use backstop_scene::{Scene, Terrain, builtin};
use std::sync::Arc;

/// A world, and its joints for drawing.
pub(crate) type Built = (World, Vec<JointHandle>);

/// A scene that the page offers.
pub(crate) struct Offer {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    /// What its size counts.
    pub(crate) unit: &'static str,
    /// The first size, the smallest and the greatest.
    pub(crate) sizes: [u32; 3],
    build: fn(&Settings, usize) -> Result<Built, Error>,
}

/// All of them, in the order of the page's list.
pub(crate) const OFFERS: [Offer; 7] = [
    Offer {
        name: "talk",
        about: "Fast, spinning bodies of every shape onto a terrain of 100,352 triangles",
        unit: "bodies",
        sizes: [11, 11, 411],
        build: |settings, size| {
            let mut scene = builtin::talk();
            scene.rain(size.saturating_sub(scene.dynamic_bodies()), 1);
            world(settings, &scene)
        },
    },
    Offer {
        name: "bullets",
        about: "Bullets and spinning blades at 50 to 500 m/s onto plates 2 cm thick",
        unit: "bodies",
        sizes: [1000, 10, 1000],
        build: |settings, size| {
            let mut scene = builtin::bullets(true);
            keep_dynamic(&mut scene, size);
            world(settings, &scene)
        },
    },
    Offer {
        name: "large_pyramid",
        about: "A wall of unit boxes that has to stand still",
        unit: "rows",
        sizes: [12, 3, 40],
        build: |settings, size| world(settings, &builtin::large_pyramid(size)),
    },
    Offer {
        name: "joint_grid",
        about: "A net of balls and joints, held in the middle of its upper edge",
        unit: "balls a side",
        sizes: [10, 4, 40],
        build: |settings, size| world(settings, &builtin::joint_grid(size)),
    },
    Offer {
        name: "ragdolls",
        about: "Figures of bones and joints fall among boxes, cylinders and balls",
        unit: "figures",
        sizes: [6, 1, 30],
        build: |settings, size| world(settings, &builtin::ragdolls(size)),
    },
    Offer {
        name: "pile",
        about: "Boxes, balls, capsules and hulls into an open box",
        unit: "bodies",
        sizes: [768, 64, 2048],
        build: |settings, size| {
            let mut scene = builtin::pile();
            keep_dynamic(&mut scene, size);
            world(settings, &scene)
        },
    },
    Offer {
        name: "rain",
        about: "Everything there is, compounds and cones too, rains onto hills",
        unit: "bodies",
        sizes: [300, 10, 1500],
        build: |settings, size| {
            let mut scene = Scene::new("rain");
            let (vertices, triangles) = Terrain::bumpy(96, 0.25).mesh();
            let ground = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles)?));
            scene.add("terrain", BodyDesc::fixed().with_shape(ShapeDesc::new(ground)));
            scene.rain(size, 1);
            world(settings, &scene)
        },
    },
];

impl Offer {
    /// A world with the scene, of a size within its range.
    pub(crate) fn world(&self, settings: &Settings, size: u32) -> Result<Built, Error> {
        let [_, least, most] = self.sizes;
        (self.build)(settings, size.clamp(least, most) as usize)
    }
}

fn world(settings: &Settings, scene: &Scene) -> Result<Built, Error> {
    let mut world = World::new(settings.clone().with_gravity(scene.gravity))?;
    let added = scene.add_to(&mut world)?;
    Ok((world, added.joints))
}

/// Keeps what is fixed and the first dynamic bodies; for scenes without joints.
fn keep_dynamic(scene: &mut Scene, count: usize) {
    let mut left = count;
    scene.bodies.retain(|body| {
        let fixed = body.desc.kind != backstop::BodyKind::Dynamic;
        let kept = fixed || left > 0;
        left -= usize::from(kept && !fixed);
        kept
    });
}
