//! A collider's geometry at the size that its node gives it.
//!
//! A shape is baked with its node's scale, because bodies have none. Scale applies to the parameters of an
//! implicit shape, by its absolute value as the specification asks. Where that doesn't give the same kind of
//! shape - an uneven sphere, a cylinder that is not round, anything sheared - its surface is sampled and the
//! convex hull taken.

use super::super::assets;
use super::accessor::{self, Positions};
use super::extension;
use super::file::Parts;
use super::problem::{Problem, text};
use crate::weld::Welded;
use backstop::{Count, Tally};
use backstop::{Decomposition, Geometry};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use gltf::mesh::Mode;
use std::f64::consts::{PI, TAU};

/// A geometry and where its frame is in the frame of the node.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) geometry: Geometry,
    /// The others that a mesh was decomposed into.
    pub(super) more: Vec<Geometry>,
    /// Along the node's axes [m].
    pub(super) offset: Vec3,
    /// What was approximated, as the rest of a sentence.
    pub(super) note: Option<&'static str>,
}

impl From<Geometry> for Placed {
    fn from(geometry: Geometry) -> Self {
        Placed { geometry, more: Vec::new(), offset: Vec3::ZERO, note: None }
    }
}

/// An implicit shape under the linear map `scale`: scale in the node's axes, and shear if a turned ancestor
/// is scaled.
pub(super) fn implicit(shape: &extension::Shape, scale: DMat3, tally: &mut Tally) -> Result<Placed, Problem> {
    let s = DVec3::new(scale.x_axis.x, scale.y_axis.y, scale.z_axis.z).abs();
    let aside =
        [scale.x_axis.y, scale.x_axis.z, scale.y_axis.x, scale.y_axis.z, scale.z_axis.x, scale.z_axis.y];
    let sheared = aside.iter().any(|a| a.abs() > 1e-4 * s.max_element());
    let even = |a: f64, b: f64| (a - b).abs() <= 1e-4 * a.max(b);
    // An exact 1 stays exact: most nodes have no scale.
    let by = |value: f32, factor: f64| (f64::from(value) * factor) as f32;
    let around = (s.x * s.z).sqrt();
    match shape.kind.as_str() {
        "sphere" => {
            let radius = positive("sphere radius", shape.sphere.radius)?;
            if !sheared && even(s.x, s.y) && even(s.y, s.z) {
                return Ok(Geometry::Sphere { radius: by(radius, s.x) }.into());
            }
            let note = "a sphere with uneven scale is a hull of points on it";
            sampled(scale, capsule_points(0.0, radius, radius), note, tally)
        }
        "box" => {
            let half = Vec3::from(shape.cuboid.size) * 0.5;
            positive("box size", half.min_element())?;
            if !sheared {
                return Ok(Geometry::cuboid(by(half.x, s.x), by(half.y, s.y), by(half.z, s.z)).into());
            }
            let corner = |i: u32| {
                Vec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { -half[a] } else { half[a] }))
            };
            sampled(scale, (0..8).map(corner).collect(), "a sheared box is a hull of its corners", tally)
        }
        "capsule" => {
            let (half, bottom, top) = round("capsule", &shape.capsule)?;
            if sheared || !even(s.x, s.z) {
                let note = "a capsule that is not round is a hull of points on it";
                return sampled(scale, capsule_points(half, bottom, top), note, tally);
            }
            Ok(capsule(by(half, s.y), by(bottom, around), by(top, around)))
        }
        "cylinder" => {
            let (half, bottom, top) = round("cylinder", &shape.cylinder)?;
            if sheared || !even(s.x, s.z) {
                let rings = [(-half, bottom), (half, top)];
                let note = "a cylinder that is not round is a hull of points on it";
                let points = rings.iter().flat_map(|&(y, r)| ring(y, r, 32)).collect();
                return sampled(scale, points, note, tally);
            }
            let (radius_bottom, radius_top) = (by(bottom, around), by(top, around));
            Ok(Geometry::Cylinder { half_height: by(half, s.y), radius_bottom, radius_top }.into())
        }
        "plane" => plane(&shape.plane, scale),
        other => text(format!("shapes of type {other:?} are not known")),
    }
}

fn plane(plane: &extension::Plane, scale: DMat3) -> Result<Placed, Problem> {
    /// Where only one size is given, the other one ends here [m].
    const FAR: f32 = 10_000.0;
    if plane.size_x.is_none() && plane.size_z.is_none() {
        let note = plane.double_sided.then_some("a double-sided infinite plane holds bodies from above only");
        return Ok(Placed { note, ..Geometry::Plane.into() });
    }
    let half = |size: Option<f32>| size.map_or(Ok(FAR), |s| positive("plane size", s)).map(|s| s * 0.5);
    let (x, z) = (half(plane.size_x)?, half(plane.size_z)?);
    let corners = [(-x, -z), (-x, z), (x, z), (x, -z)].map(|(x, z)| transform(scale, Vec3::new(x, 0.0, z)));
    let mesh = assets::mesh(&corners, &[[0, 1, 2], [0, 2, 3]])?;
    let note =
        (!plane.double_sided).then_some("a plane with a size is two triangles, which hold from both sides");
    Ok(Placed { note, ..Geometry::Mesh(mesh).into() })
}

/// A capsule, or the one ball that is left when the other lies within it.
fn capsule(half_height: f32, radius_bottom: f32, radius_top: f32) -> Placed {
    let larger = radius_bottom.max(radius_top);
    if (radius_bottom - radius_top).abs() >= 2.0 * half_height {
        let y = if radius_bottom > radius_top { -half_height } else { half_height };
        let geometry = Geometry::Sphere { radius: larger };
        return Placed { offset: Vec3::new(0.0, y, 0.0), ..geometry.into() };
    }
    // Ends without radius are allowed in files but not in the engine.
    let least = larger * 1e-3;
    let note = (radius_bottom.min(radius_top) < least)
        .then_some("a pointed capsule is rounded a little at its point");
    let (radius_bottom, radius_top) = (radius_bottom.max(least), radius_top.max(least));
    Placed { note, ..Geometry::Capsule { half_height, radius_bottom, radius_top }.into() }
}

/// The hull of the triangles below a node, several hulls, or the triangles themselves.
pub(super) fn of_mesh(
    parts: &Parts,
    node: usize,
    stop_at: &dyn Fn(usize) -> bool,
    form: Form,
    scale: DMat3,
) -> Result<Placed, Problem> {
    let (mut welded, mut note) = (Welded::default(), None);
    walk(parts, node, (stop_at, &mut |_| Ok(())), DAffine3::from_mat3(scale), &mut |node, to_root| {
        if node.skin().is_some() || node.weights().is_some() {
            note = Some("skins and morph targets of collision meshes are ignored");
        }
        let mut primitives = node.mesh().into_iter().flat_map(|m| m.primitives());
        primitives.try_for_each(|primitive| add_primitive(parts, &primitive, to_root, &mut welded))
    })?;
    if welded.vertices.is_empty() {
        return text(format!("its geometry, node {node}, has no triangles"));
    }
    let mut geometries = match form {
        Form::Hull => vec![Geometry::Hull(assets::hull(&welded.vertices)?)],
        Form::Mesh => vec![Geometry::Mesh(assets::mesh(&welded.vertices, &welded.triangles)?)],
        Form::Pieces(settings) => {
            let pieces = settings.run(&welded.vertices, &welded.triangles)?;
            pieces.hulls().iter().map(|hull| Geometry::hull(hull.clone())).collect()
        }
    };
    let more = geometries.split_off(1);
    let geometry = geometries.swap_remove(0);
    Ok(Placed { more, note, ..geometry.into() })
}

/// What becomes of the triangles of a mesh.
pub(super) enum Form {
    Hull,
    Mesh,
    Pieces(Decomposition),
}

/// Counts the vertices and triangles of [`of_mesh`] before they are read.
pub(super) fn charge_mesh(
    parts: &Parts,
    node: usize,
    stop_at: &dyn Fn(usize) -> bool,
    tally: &mut Tally,
) -> Result<(), Problem> {
    let Tally { nodes, depth: deepest, vertices, triangles, .. } = tally;
    let mut count = |depth| {
        nodes.take(1)?;
        Ok(deepest.allow(depth)?)
    };
    walk(parts, node, (stop_at, &mut count), DAffine3::IDENTITY, &mut |node, _| {
        let mut primitives = node.mesh().into_iter().flat_map(|m| m.primitives());
        primitives.try_for_each(|primitive| charge(&primitive, vertices, triangles))
    })
}

/// Counts a node at a depth.
type CountNode<'a> = &'a mut dyn FnMut(usize) -> Result<(), Problem>;

/// Calls `f` for a node and its descendants, with the transform from there to the frame of the node and then
/// through
/// `start`. The node's own transform and descendants with motion are ignored. `count` is called before, with
/// the depth, for those with motion too.
fn walk<'a>(
    parts: &'a Parts,
    node: usize,
    (stop_at, count): (&dyn Fn(usize) -> bool, CountNode<'_>),
    start: DAffine3,
    f: &mut dyn FnMut(&gltf::Node<'a>, &DAffine3) -> Result<(), Problem>,
) -> Result<(), Problem> {
    let Some(root) = parts.document.nodes().nth(node) else {
        return text(format!("its geometry, node {node}, does not exist"));
    };
    let mut stack = vec![(root, start, 0)];
    // Nodes outside the scene were not checked for cycles.
    let mut visited = 0;
    while let Some((node, to_root, depth)) = stack.pop() {
        visited += 1;
        if visited > parts.document.nodes().len() {
            return text("the nodes of its geometry form a cycle");
        }
        count(depth)?;
        if depth > 0 && stop_at(node.index()) {
            continue;
        }
        f(&node, &to_root)?;
        for child in node.children() {
            let m = child.transform().matrix().map(|c| c.map(f64::from));
            let [x, y, z, t] = m.map(|c| DVec3::new(c[0], c[1], c[2]));
            let local = DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: t };
            stack.push((child, to_root * local, depth + 1));
        }
    }
    Ok(())
}

/// The triangles of a primitive; points and lines have none.
pub(super) fn add_primitive(
    parts: &Parts,
    primitive: &gltf::Primitive,
    transform: &DAffine3,
    welded: &mut Welded,
) -> Result<(), Problem> {
    let Some((accessor, corners)) = corners_of(primitive) else { return Ok(()) };
    let exact = *transform == DAffine3::IDENTITY;
    let through = |p: Vec3| if exact { p } else { transform.transform_point3(p.as_dvec3()).as_vec3() };
    let positions = Positions::new(&accessor, &parts.buffers).map_err(Problem::Text)?;
    let position = |i: u32| positions.get(i).map(through).filter(|p| p.is_finite());
    let indices = match primitive.indices() {
        Some(accessor) => Some(accessor::indices(&accessor, &parts.buffers).map_err(Problem::Text)?),
        None => None,
    };
    // Vertices in the order of the file: a hull written and read again is the same to the bit.
    let mut weld = |i: u32| {
        if let Some(p) = position(i) {
            welded.vertex(p);
        }
    };
    match &indices {
        Some(indices) => {
            let mut used = indices[..corners].to_vec();
            used.sort_unstable();
            used.dedup();
            used.into_iter().for_each(weld);
        }
        None => (0..corners as u32).for_each(&mut weld),
    }
    let mirrored = transform.matrix3.determinant() < 0.0;
    for triangle in 0..triangle_count(primitive.mode(), corners) {
        let corner = |k: usize| position(indices.as_ref().map_or(k as u32, |indices| indices[k]));
        let [Some(a), Some(b), Some(c)] = places_of(primitive.mode(), triangle).map(corner) else {
            return text("an index of a mesh is out of range, or a position is not finite");
        };
        welded.triangle(if mirrored { [a, c, b] } else { [a, b, c] });
    }
    Ok(())
}

/// Counts the vertices and triangles of a primitive before they are read.
pub(super) fn charge(
    primitive: &gltf::Primitive,
    vertices: &mut Count,
    triangles: &mut Count,
) -> Result<(), Problem> {
    let Some((accessor, corners)) = corners_of(primitive) else { return Ok(()) };
    vertices.take(accessor.count())?;
    Ok(triangles.take(triangle_count(primitive.mode(), corners))?)
}

/// The positions of a primitive of triangles, and how many of its corners are a triangle's; points and lines
/// have none.
fn corners_of<'a>(primitive: &gltf::Primitive<'a>) -> Option<(gltf::Accessor<'a>, usize)> {
    let accessor = primitive.get(&gltf::Semantic::Positions)?;
    let corners = primitive.indices().map_or(accessor.count(), |indices| indices.count());
    let used = match primitive.mode() {
        Mode::Triangles => corners / 3 * 3,
        Mode::TriangleStrip | Mode::TriangleFan if corners >= 3 => corners,
        Mode::TriangleStrip | Mode::TriangleFan => 0,
        _ => return None,
    };
    Some((accessor, used))
}

fn triangle_count(mode: Mode, corners: usize) -> usize {
    if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) }
}

/// Which of the corners are those of a triangle (glTF 2.0, section 3.7.2.1).
fn places_of(mode: Mode, triangle: usize) -> [usize; 3] {
    let t = triangle;
    match mode {
        Mode::Triangles => [3 * t, 3 * t + 1, 3 * t + 2],
        Mode::TriangleStrip if t.is_multiple_of(2) => [t, t + 1, t + 2],
        Mode::TriangleStrip => [t + 1, t, t + 2],
        _ => [0, t + 1, t + 2],
    }
}

fn sampled(
    scale: DMat3,
    points: Vec<Vec3>,
    note: &'static str,
    tally: &mut Tally,
) -> Result<Placed, Problem> {
    tally.vertices.take(points.len())?;
    let points: Vec<Vec3> = points.into_iter().map(|p| transform(scale, p)).collect();
    Ok(Placed { note: Some(note), ..Geometry::Hull(assets::hull(&points)?).into() })
}

/// Rings on both balls of a capsule: for a sphere 14 rings of 16 and two poles, within the 256 that a hull
/// keeps. The points lie on the surface, so the hull is smaller by 1 - cos(pi/16), 2 % of the radius.
fn capsule_points(half_height: f32, bottom: f32, top: f32) -> Vec<Vec3> {
    let mut points = vec![Vec3::new(0.0, -half_height - bottom, 0.0), Vec3::new(0.0, half_height + top, 0.0)];
    for i in 1..8 {
        let latitude = PI / 2.0 * (f64::from(i) - 0.5) / 7.5;
        let (up, out) = (libm::sin(latitude) as f32, libm::cos(latitude) as f32);
        points.extend(ring(-half_height - bottom * up, bottom * out, 16));
        points.extend(ring(half_height + top * up, top * out, 16));
    }
    points
}

fn ring(y: f32, radius: f32, count: u32) -> Vec<Vec3> {
    let point = |i: u32| {
        let angle = TAU * f64::from(i) / f64::from(count);
        Vec3::new(radius * libm::cos(angle) as f32, y, radius * libm::sin(angle) as f32)
    };
    (0..count).map(point).collect()
}

fn transform(m: DMat3, p: Vec3) -> Vec3 {
    (m * p.as_dvec3()).as_vec3()
}

fn positive(what: &'static str, value: f32) -> Result<f32, Problem> {
    Ok(backstop::limits::positive(what, value)?)
}

/// Half height, radius at the bottom and at the top.
fn round(what: &str, shape: &extension::Round) -> Result<(f32, f32, f32), Problem> {
    let [height, bottom, top] = [shape.height, shape.radius_bottom, shape.radius_top];
    match height > 0.0 && bottom >= 0.0 && top >= 0.0 && bottom.max(top) > 0.0 {
        true => Ok((height * 0.5, bottom, top)),
        false => text(format!("a {what} of height {height} and radii {bottom} and {top}")),
    }
}
