//! Recorded poses as an animation of nodes.

use super::super::gltf_in::tree::Tree;
use super::build::{self, Builder};
use super::document::Document;
use crate::files::gltf_in::extension::{RIGID_BODIES, SHAPES};
use crate::files::gltf_in::file::{Parts, read_uri};
use crate::files::resolve::{MAX_IMAGE, Resolver};
use crate::{Recorder, Scene, SceneError};
use backstop::BodyKind;
use backstop::{LoadLimits, Tally};
use glam::{DAffine3, Quat, Vec3};
use serde_json::{Map, Value, json};
use std::path::Path;

/// A node's local poses over time.
struct Track {
    node: usize,
    translations: Vec<Vec3>,
    rotations: Vec<Quat>,
}

pub(super) fn document(
    scene: &Scene,
    recorder: &Recorder,
    resolve: &Resolver<'_>,
) -> Result<Document, SceneError> {
    let is_gltf = |p: &&std::path::PathBuf| {
        p.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf") || e.eq_ignore_ascii_case("glb"))
    };
    let (mut document, tracks) = match scene.source.as_ref().filter(is_gltf) {
        Some(source) => over_source(scene, recorder, source, resolve)?,
        None => {
            let (document, nodes) = build::scene(scene, false);
            (
                document,
                (0..recorder.bodies().len())
                    .map(|s| in_world(recorder, s, nodes[recorder.bodies()[s]]))
                    .collect(),
            )
        }
    };
    animate(&mut document, recorder.times(), &tracks);
    Ok(document)
}

/// A body whose node is a root: its pose in the world is the node's.
fn in_world(recorder: &Recorder, slot: usize, node: usize) -> Track {
    let (translations, rotations) = recorder.track(slot).map(|(p, q)| (p.as_vec3(), q)).unzip();
    Track { node, translations, rotations }
}

/// The file that the scene came from, and tracks for its nodes. Moving bodies that were added to the scene
/// later get nodes and meshes of their own.
fn over_source(
    scene: &Scene,
    recorder: &Recorder,
    source: &Path,
    resolve: &Resolver<'_>,
) -> Result<(Document, Vec<Track>), SceneError> {
    // Its file was read before, within its limits.
    let mut tally = Tally::new(&LoadLimits::NONE);
    let parts = Parts::read(source, resolve, &mut tally)?;
    let tree = Tree::new(&parts, &mut tally)?;
    let mut document =
        Document::from_parts(parts.json.as_object().cloned().unwrap_or_default(), &parts.buffers);
    embed_images(&mut document, source, resolve, &mut Tally::new(&LoadLimits::default()));
    drop_required(&mut document.json);
    // The recorder's slot of the body at each node.
    let mut slots: Vec<Option<usize>> = vec![None; tree.parent.len()];
    for (slot, &body) in recorder.bodies().iter().enumerate() {
        match scene.bodies[body].node {
            Some(node) if node < slots.len() => slots[node] = Some(slot),
            _ => {}
        }
    }
    let mut tracks = Vec::new();
    for (node, &slot) in slots.iter().enumerate() {
        let Some(slot) = slot else { continue };
        plain_transform(&mut document, &parts, node);
        tracks.push(match tree.parent[node] {
            None => in_world(recorder, slot, node),
            Some(parent) => below(recorder, slot, node, parent, &tree, &slots),
        });
    }
    let mut added = Vec::new();
    let mut builder = Builder::new(&mut document, false);
    for (slot, &body) in recorder.bodies().iter().enumerate() {
        let body = &scene.bodies[body];
        if body.node.is_none() && body.desc.kind != BodyKind::Static {
            let node = builder.body(body);
            added.push(node);
            tracks.push(in_world(recorder, slot, node));
        }
    }
    if !added.is_empty() {
        let shown = document.json.get("scene").and_then(Value::as_u64).unwrap_or(0) as usize;
        if document.list("scenes").is_empty() {
            let roots: Vec<usize> =
                tree.order.iter().copied().filter(|&n| tree.parent[n].is_none()).collect();
            document.push("scenes", json!({ "nodes": roots }));
        }
        let scenes = document.list("scenes");
        let index = shown.min(scenes.len() - 1);
        let mut roots = scenes[index]["nodes"].as_array().cloned().unwrap_or_default();
        roots.extend(added.iter().map(|n| json!(n)));
        scenes[index]["nodes"] = json!(roots);
    }
    Ok((document, tracks))
}

/// Poses in the frame of the parent, which itself may ride on another recorded body.
fn below(
    recorder: &Recorder,
    slot: usize,
    node: usize,
    parent: usize,
    tree: &Tree,
    slots: &[Option<usize>],
) -> Track {
    let mut carrier = Some(parent);
    while let Some(n) = carrier.filter(|&n| slots[n].is_none()) {
        carrier = tree.parent[n];
    }
    // The carrier's pose in the file, from which the parent's relative pose follows.
    let carrier = carrier.and_then(|n| {
        let pose =
            DAffine3::from_rotation_translation(tree.rotation[n].normalize(), tree.global[n].translation);
        Some((
            slots[n]?,
            pose.inverse() * tree.global[parent],
            tree.rotation[n].inverse() * tree.rotation[parent],
        ))
    });
    let mut track = Track { node, translations: Vec::new(), rotations: Vec::new() };
    for (frame, (position, rotation)) in recorder.track(slot).enumerate() {
        let (above, turned) = match carrier {
            None => (tree.global[parent], tree.rotation[parent]),
            Some((slot, affine, turned)) => {
                let (p, q) = recorder.pose(slot, frame);
                let q = q.as_dquat().normalize();
                (DAffine3::from_rotation_translation(q, p) * affine, q * turned)
            }
        };
        let local = above.inverse().transform_point3(position);
        let rotation = (turned.inverse() * rotation.as_dquat()).normalize().as_quat();
        let flip = track.rotations.last().is_some_and(|last| last.dot(rotation) < 0.0);
        track.translations.push(local.as_vec3());
        track.rotations.push(if flip { -rotation } else { rotation });
    }
    track
}

/// Animated nodes must not have a matrix (glTF 2.0, section 5.25).
fn plain_transform(document: &mut Document, parts: &Parts, node: usize) {
    let Some(original) = parts.document.nodes().nth(node) else { return };
    let Some(json) = document.list("nodes").get_mut(node).and_then(Value::as_object_mut) else { return };
    if json.remove("matrix").is_some() {
        let (translation, rotation, scale) = original.transform().decomposed();
        json.insert("translation".into(), json!(translation));
        json.insert("rotation".into(), json!(rotation));
        json.insert("scale".into(), json!(scale));
    }
}

/// Adds the animation in front of all others: viewers play the first.
fn animate(document: &mut Document, times: &[f32], tracks: &[Track]) {
    if times.is_empty() || tracks.is_empty() {
        return;
    }
    let input = document.times(times);
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for track in tracks {
        let outputs = [
            ("translation", document.translations(&track.translations)),
            ("rotation", document.rotations(&track.rotations)),
        ];
        for (path, output) in outputs {
            channels
                .push(json!({ "sampler": samplers.len(), "target": { "node": track.node, "path": path } }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
    }
    let animation = json!({ "name": "backstop", "samplers": samplers, "channels": channels });
    document.list("animations").insert(0, animation);
}

/// Embeds images, as relative references would break beside the film. An image that can't be read stays a
/// reference.
fn embed_images(document: &mut Document, source: &Path, resolve: &Resolver<'_>, tally: &mut Tally) {
    for index in 0..document.list("images").len() {
        let Some(uri) = document.list("images")[index]["uri"].as_str().map(str::to_owned) else { continue };
        let kind = match uri.rsplit('.').next().map(str::to_ascii_lowercase).as_deref() {
            Some("png") => "image/png",
            Some("jpg" | "jpeg") => "image/jpeg",
            _ => continue,
        };
        if uri.starts_with("data:") {
            continue;
        }
        if let Ok(bytes) = read_uri(source, &uri, MAX_IMAGE, resolve, tally) {
            let view = document.view(&bytes, None);
            if let Some(image) = document.list("images")[index].as_object_mut() {
                image.remove("uri");
                image.insert("bufferView".into(), json!(view));
                image.insert("mimeType".into(), json!(kind));
            }
        }
    }
}

/// A viewer needs no physics to play a film.
fn drop_required(json: &mut Map<String, Value>) {
    if let Some(list) = json.get_mut("extensionsRequired").and_then(Value::as_array_mut) {
        list.retain(|e| e != RIGID_BODIES && e != SHAPES);
    }
}
