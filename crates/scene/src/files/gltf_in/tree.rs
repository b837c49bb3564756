//! The nodes of the scene with their transforms in the world.

use super::file::Parts;
use crate::SceneError;
use backstop::{LimitExceeded, Tally};
use glam::{DAffine3, DMat3, DQuat, DVec3, Quat, Vec3};

/// Nodes reachable from the scene.
pub(crate) struct Tree {
    /// Parents before children, in the order of the file.
    pub(crate) order: Vec<usize>,
    /// Per node of the file; `None` for roots and for nodes outside the scene.
    pub(crate) parent: Vec<Option<usize>>,
    /// Node to world; identity for nodes outside the scene.
    pub(crate) global: Vec<DAffine3>,
    /// How each node is turned in the world, without scale.
    pub(crate) rotation: Vec<DQuat>,
    /// Per node of the file: whether it is in the scene.
    pub(crate) in_scene: Vec<bool>,
}

impl Tree {
    pub(crate) fn new(parts: &Parts, tally: &mut Tally) -> Result<Tree, SceneError> {
        let beyond = |source: LimitExceeded| SceneError::Limit { file: parts.path.clone(), source };
        let document = &parts.document;
        let count = document.nodes().len();
        tally.nodes.take(count).map_err(beyond)?;
        let locals: Vec<Local> =
            document.nodes().map(|n| Local::of(parts, &n)).collect::<Result<_, SceneError>>()?;
        let mut tree = Tree {
            order: Vec::new(),
            parent: vec![None; count],
            global: vec![DAffine3::IDENTITY; count],
            rotation: vec![DQuat::IDENTITY; count],
            in_scene: vec![false; count],
        };
        let mut stack: Vec<(usize, usize)> = roots(document).into_iter().map(|root| (root, 1)).collect();
        stack.reverse();
        while let Some((index, depth)) = stack.pop() {
            tally.depth.allow(depth).map_err(beyond)?;
            if std::mem::replace(&mut tree.in_scene[index], true) {
                let what = format!("node {index} has two parents, or is its own ancestor");
                return Err(SceneError::Malformed { file: parts.path.clone(), what });
            }
            tree.place(index, &locals[index]);
            tree.order.push(index);
            let Some(node) = document.nodes().nth(index) else { continue };
            let children: Vec<usize> = node.children().map(|c| c.index()).collect();
            for &child in children.iter().rev() {
                tree.parent[child] = Some(index);
                stack.push((child, depth + 1));
            }
        }
        Ok(tree)
    }

    /// Whether a node of the scene is below another.
    pub(super) fn is_below(&self, node: usize, above: usize) -> bool {
        std::iter::successors(self.parent[node], |&n| self.parent[n]).any(|n| n == above)
    }

    fn place(&mut self, index: usize, local: &Local) {
        let (above, turned) = match self.parent[index] {
            Some(p) => (self.global[p], self.rotation[p]),
            None => (DAffine3::IDENTITY, DQuat::IDENTITY),
        };
        self.global[index] = above * local.affine;
        // Below a uniform scale rotations just multiply, to the last bit; elsewhere they come out of the
        // matrix.
        let (x, y, z) = (above.matrix3.x_axis, above.matrix3.y_axis, above.matrix3.z_axis);
        let (s, uneven) = (x.length(), 1e-6);
        let uniform = (y.length() - s).abs() <= uneven * s
            && (z.length() - s).abs() <= uneven * s
            && x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs()) <= uneven * s * s
            && above.matrix3.determinant() > 0.0;
        self.rotation[index] = match local.rotation {
            Some(rotation) if uniform => turned * rotation,
            _ => rotation_of(self.global[index].matrix3).unwrap_or(turned),
        };
    }
}

/// The roots of the default scene, or of the first, or all nodes that are nobody's child.
fn roots(document: &gltf::Document) -> Vec<usize> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().map(|n| n.index()).collect();
    }
    let mut is_child = vec![false; document.nodes().len()];
    for node in document.nodes() {
        node.children().for_each(|c| is_child[c.index()] = true);
    }
    (0..is_child.len()).filter(|&i| !is_child[i]).collect()
}

struct Local {
    affine: DAffine3,
    /// Unless it was given as a matrix.
    rotation: Option<DQuat>,
}

impl Local {
    fn of(parts: &Parts, node: &gltf::Node) -> Result<Local, SceneError> {
        let local = match node.transform() {
            gltf::scene::Transform::Matrix { matrix } => {
                let [x, y, z, t] = matrix.map(|c| DVec3::new(c[0].into(), c[1].into(), c[2].into()));
                let affine = DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: t };
                Local { affine, rotation: None }
            }
            gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
                let raw = Quat::from_array(rotation).as_dquat();
                let length = raw.length();
                if !(0.9..=1.1).contains(&length) {
                    let what = format!("its rotation has length {length} instead of 1");
                    return Err(SceneError::Node { file: parts.path.clone(), node: label(node), what });
                }
                // A quaternion that is unit to f32 stays as it is.
                let unit = if (length - 1.0).abs() < 1e-6 { raw } else { raw / length };
                let scale = Vec3::from(scale).as_dvec3();
                let turned = DMat3::from_quat(unit / unit.length());
                let matrix3 = DMat3::from_cols(
                    turned.x_axis * scale.x,
                    turned.y_axis * scale.y,
                    turned.z_axis * scale.z,
                );
                let translation = Vec3::from(translation).as_dvec3();
                Local { affine: DAffine3 { matrix3, translation }, rotation: Some(unit) }
            }
        };
        match local.affine.is_finite() {
            true => Ok(local),
            false => Err(SceneError::Node {
                file: parts.path.clone(),
                node: label(node),
                what: "its transform is not finite".into(),
            }),
        }
    }
}

/// The rotation in a matrix with scale, mirroring and shear: its x axis, and y as near as can be
/// (Gram-Schmidt). `None` if it flattens.
pub(crate) fn rotation_of(m: DMat3) -> Option<DQuat> {
    let mirrored = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let x = (m.x_axis * mirrored).try_normalize()?;
    let y = (m.y_axis - x * x.dot(m.y_axis)).try_normalize()?;
    Some(DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))))
}

/// Name and index of a node, as messages show it.
pub(crate) fn label(node: &gltf::Node) -> String {
    match node.name() {
        Some(name) => format!("{name:?} ({})", node.index()),
        None => node.index().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_comes_out_of_a_scaled_and_mirrored_matrix() {
        let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
        let m = DMat3::from_quat(turned) * DMat3::from_diagonal(DVec3::new(-2.0, 3.0, 0.5));
        let out = rotation_of(m).unwrap();
        assert!(out.dot(turned).abs() > 1.0 - 1e-12);
        assert!(rotation_of(DMat3::ZERO).is_none());
    }
}
