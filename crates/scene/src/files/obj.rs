//! OBJ: all groups of a file as one static mesh.

use super::assets;
use crate::weld::Welded;
use crate::{Scene, SceneError};
use backstop::BodyDesc;
use backstop::{Geometry, ShapeDesc};
use backstop::{LimitExceeded, Tally};
use glam::Vec3;
use std::path::Path;

pub(super) fn read(path: &Path, mut bytes: &[u8], mut tally: Tally) -> Result<Scene, SceneError> {
    let malformed = |what: String| SceneError::Malformed { file: path.into(), what };
    let beyond = |source: LimitExceeded| SceneError::Limit { file: path.into(), source };
    // Before any memory is taken for them: a corner takes two bytes of a file, and fifty of memory.
    tally.triangles.take(triangles_of(bytes)).map_err(beyond)?;
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    // Materials say nothing about contacts: don't look for their files.
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut bytes, &options, no_materials)
        .map_err(|e| malformed(format!("not an OBJ file: {e}")))?;
    for model in &models {
        tally.vertices.take(model.mesh.positions.len() / 3).map_err(beyond)?;
    }
    let mut welded = Welded::default();
    for model in &models {
        let corner = |i: &u32| {
            let at = *i as usize * 3;
            let p = model.mesh.positions.get(at..at + 3)?;
            Some(Vec3::new(p[0], p[1], p[2])).filter(|p| p.is_finite())
        };
        for triangle in model.mesh.indices.chunks_exact(3) {
            let [Some(a), Some(b), Some(c)] =
                [corner(&triangle[0]), corner(&triangle[1]), corner(&triangle[2])]
            else {
                return Err(malformed(format!(
                    "object {}: a coordinate is missing or not finite",
                    model.name
                )));
            };
            welded.triangle([a, b, c]);
        }
    }
    if welded.triangles.is_empty() {
        return Err(malformed("it has no triangle with an area".into()));
    }
    let name = path.file_stem().and_then(|s| s.to_str()).unwrap_or("mesh");
    let mesh = assets::mesh(&welded.vertices, &welded.triangles).map_err(|source| SceneError::Body {
        file: path.into(),
        node: name.into(),
        source,
    })?;
    let mut scene = Scene::new(name);
    scene.add(name, BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Mesh(mesh))));
    Ok(scene)
}

/// How many triangles the faces of a file make, each a fan. A line that is not UTF-8 is refused later.
fn triangles_of(bytes: &[u8]) -> usize {
    let of_line = |line: &[u8]| {
        let mut words = std::str::from_utf8(line).unwrap_or_default().split_whitespace();
        if words.next() == Some("f") { words.count().saturating_sub(2) } else { 0 }
    };
    bytes.split(|&b| b == b'\n').map(of_line).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::testing::{data, scratch};
    use crate::load;

    #[test]
    fn polygons_become_triangles_of_one_mesh() {
        let dir = scratch("obj_quad");
        let path = dir.join("quad.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\no a\nf 1 2 3 4\n").unwrap();
        let scene = load(&path).unwrap();
        let Geometry::Mesh(mesh) = &scene.bodies[0].desc.shapes[0].geometry else { panic!("not a mesh") };
        assert_eq!(assets::mesh_triangles(mesh).1.len(), 2);
        assert_eq!(scene.name, "quad");
    }

    #[test]
    fn broken_files_are_refused() {
        let dir = scratch("obj_broken");
        for text in
            ["", "f 1 2 3\n", "v 0 0\nf 1 1 1\n", "v a b c\n", "v 0 0 0\nv 1 0 0\nv 0 1e39 0\nf 1 2 3\n"]
        {
            let path = dir.join("broken.obj");
            std::fs::write(&path, text).unwrap();
            assert!(load(&path).is_err(), "{text:?}");
        }
    }

    #[test]
    fn mutated_files_never_panic() {
        let text =
            b"mtllib a.mtl\no cube\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvt 0 1\nvn 0 0 1\nusemtl a\n\
            f 1/1/1 2/1/1 3/1/1 4/1/1\ng two\nf 1//1 2//1 3//1\nf -1 -2 -3\nl 1 2\np 1\n";
        let path = scratch("obj_mutated").join("mutated.obj");
        let mut random = crate::random::Random(5);
        for i in 0..1000 {
            let mut broken = text[..text.len() - i % text.len()].to_vec();
            for _ in 0..random.below(4) {
                let at = random.below(broken.len());
                broken[at] = b"0123456789-/. \nvfnte"[random.below(20)];
            }
            std::fs::write(&path, &broken).unwrap();
            // Either result is fine, as long as it returns.
            let _ = load(&path);
        }
    }

    #[test]
    fn level_meshes_load_whole() {
        let Some(data) = data("meshes") else { return };
        for file in ["collision_mesh_01.obj", "voxel_mesh_01.obj"] {
            let path = data.join(file);
            let text = std::fs::read_to_string(&path).unwrap();
            // Fans: a polygon of n corners is n - 2 triangles.
            let faces = text.lines().filter(|l| l.starts_with("f "));
            let expected: usize = faces.map(|l| l.split_whitespace().count() - 3).sum();
            let scene = load(&path).unwrap();
            let Geometry::Mesh(mesh) = &scene.bodies[0].desc.shapes[0].geometry else { panic!("not a mesh") };
            let loaded = assets::mesh_triangles(mesh).1.len();
            assert!(loaded <= expected && loaded * 100 >= expected * 99, "{file}: {loaded} of {expected}");
        }
    }
}
