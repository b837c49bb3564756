//! Estimates how many pairs and contacts a scene will have, before anything moves.
//!
//! The larger of two estimates counts. *At the start*: boxes that touch are pairs, and if shapes touch there,
//! contacts with all their points; stacks stay about like that. *Once all is down*: dynamic bodies that no
//! joint holds up come down on the static ground. If their footprints would cover it, they lie on each other
//! and have the contacts that bodies have in a pile; if they cover little of it, each has its contact with
//! the ground.

use super::Scene;
use backstop::{
    Aabb, BodyDesc, BodyHandle, BodyKind, ContentForecast, ContinuousMode, Geometry, Plan, Settings,
    ShapeDesc,
};
use glam::{DVec3, Vec3};

/// Pairs and contacts of each body with others in a pile that has come down (builtin scene `pile`: 10.9 and
/// 2.6 with the ground's).
const PILE: [f32; 2] = [10.0, 2.4];
/// The same with the ground, for scattered bodies (`bullets`: 1.8 and 0.7; `talk`, on bumps: 1.0 and 2.9).
const GROUND: [f32; 2] = [1.2, 0.8];
/// On a mesh that is not flat a body touches several patches.
const BUMPY: f32 = 3.5;
/// Share of the pairs of convex shapes without a contact whose bounding balls are near enough to be examined.
const NEAR: f32 = 0.6;
/// Widening of the boxes of bodies at rest [length units].
const FAT: f32 = 0.1;
/// Shapes this near touch [length units].
const CLOSE: f32 = 0.01;
/// Share of the contacts of fast bodies that discrete physics would not find yet.
const AHEAD: f32 = 0.5;
/// A step [s].
const STEP: f32 = 1.0 / 60.0;
/// Buffers that grow on demand end about this factor larger than needed.
const SLACK: f32 = 1.12;

/// The kind of a shape's contacts.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Sphere,
    Capsule,
    /// Any other that is convex, or a plane.
    Faces,
    /// A mesh or a height field.
    Mesh,
}

impl Kind {
    fn of(geometry: &Geometry) -> Kind {
        match geometry {
            Geometry::Sphere { .. } => Kind::Sphere,
            Geometry::Capsule { .. } => Kind::Capsule,
            Geometry::Mesh(_) | Geometry::HeightField(_) => Kind::Mesh,
            _ => Kind::Faces,
        }
    }
}

/// A shape that may move.
struct Shape {
    body: usize,
    bounds: Aabb,
    kind: Kind,
    dynamic: bool,
    moves: bool,
}

impl Scene {
    /// Bytes that a world with a budget will hold at most while the scene runs in it; the budget of the
    /// settings does not matter. Nothing is built, nothing steps.
    ///
    /// Buffers with an entry for each body, shape or joint are exact. Pairs, contacts and their rows are an
    /// estimate: their number at the start of the scene, or, if that is more, the usual number where so many
    /// bodies come down on so much ground (docs/memory.md says how good it is).
    pub fn plan(&self, settings: &Settings) -> Plan {
        let nobody = vec![BodyHandle::from_bits(0); self.bodies.len()];
        let joints: Vec<_> = self.joints.iter().filter_map(|joint| joint.desc(&nobody)).collect();
        let bodies = self.bodies.iter().map(|body| &body.desc);
        Plan::new(settings, bodies, &joints, self.couplings.len(), &expect(self, settings))
    }
}

/// How many of each there will be.
fn expect(scene: &Scene, settings: &Settings) -> ContentForecast {
    let start = at_start(scene, settings);
    let down = once_down(scene, settings);
    let most = |a: usize, b: usize| if b > a { (b as f32 * SLACK) as usize } else { a };
    let contacts = |crowd: &ContentForecast| crowd.contacts.iter().flatten().sum::<usize>();
    let mut crowd = if contacts(&down) > contacts(&start) {
        let contacts = down.contacts.map(|side| side.map(|n| (n as f32 * SLACK) as usize));
        ContentForecast { contacts, ..down }
    } else {
        start
    };
    crowd.pairs = most(start.pairs, down.pairs);
    crowd.fresh = most(start.fresh, down.fresh);
    crowd.of_meshes = most(start.of_meshes, down.of_meshes);
    crowd.ahead = ahead(scene, settings);
    crowd.branches = if settings.joint_trees { branches(scene) } else { 0 };
    crowd
}

fn shapes(scene: &Scene) -> Vec<Shape> {
    let of_body = |(body, desc): (usize, &BodyDesc)| {
        let (dynamic, moves) = (desc.kind == BodyKind::Dynamic, desc.kind != BodyKind::Static);
        let shape = move |shape: &ShapeDesc| {
            let bounds = shape.aabb(desc.position, desc.rotation);
            Shape { body, bounds, kind: Kind::of(&shape.geometry), dynamic, moves }
        };
        desc.shapes.iter().map(shape).collect::<Vec<_>>()
    };
    scene.bodies.iter().map(|body| &body.desc).enumerate().flat_map(of_body).collect()
}

/// Index of the class of a contact with all its points: their number minus one.
fn full(a: Kind, b: Kind) -> usize {
    match (a.min(b), a.max(b)) {
        (Kind::Sphere, _) => 0,
        (Kind::Capsule, _) => 1,
        _ => 3,
    }
}

/// Pairs and contacts where the scene begins.
fn at_start(scene: &Scene, settings: &Settings) -> ContentForecast {
    let mut all = shapes(scene);
    let mut joined: Vec<[usize; 2]> = scene
        .joints
        .iter()
        .filter(|j| !j.collide)
        .map(|j| [j.bodies[0].min(j.bodies[1]), j.bodies[0].max(j.bodies[1])])
        .collect();
    joined.sort_unstable();
    // Along the axis on which boxes are apart most.
    let axis = widest(&all);
    all.sort_by(|a, b| a.bounds.min[axis].total_cmp(&b.bounds.min[axis]));
    let [fat, close] = [FAT, CLOSE].map(|gap| f64::from(gap * settings.length_unit));
    let mut crowd = ContentForecast::default();
    let mut open: Vec<usize> = Vec::new();
    for i in 0..all.len() {
        let a = &all[i];
        open.retain(|&k| all[k].bounds.max[axis] + fat >= a.bounds.min[axis]);
        for b in open.iter().map(|&k| &all[k]) {
            let meet = |gap: f64| {
                let gap = DVec3::splat(gap);
                Aabb { min: a.bounds.min - gap, max: a.bounds.max + gap }.overlaps(&b.bounds)
            };
            let bodies = [a.body.min(b.body), a.body.max(b.body)];
            if a.body == b.body
                || !(a.dynamic || b.dynamic)
                || !meet(fat)
                || joined.binary_search(&bodies).is_ok()
            {
                continue;
            }
            crowd.pairs += 1;
            let of_mesh = a.kind == Kind::Mesh || b.kind == Kind::Mesh;
            *if of_mesh { &mut crowd.of_meshes } else { &mut crowd.fresh } += 1;
            // The box of a mesh is too coarse.
            if !of_mesh && meet(close) {
                let one_is_static = !(a.moves && b.moves);
                crowd.contacts[usize::from(one_is_static)][full(a.kind, b.kind)] += 1;
            }
        }
        open.push(i);
    }
    crowd
}

fn widest(all: &[Shape]) -> usize {
    let finite = all.iter().map(|s| s.bounds.min).filter(|v| v.is_finite());
    let low = finite.clone().fold(DVec3::INFINITY, DVec3::min);
    let size = finite.fold(DVec3::NEG_INFINITY, DVec3::max) - low;
    (0..3).fold(0, |a, b| if size[b] > size[a] { b } else { a })
}

/// Pairs and contacts once all has come down.
fn once_down(scene: &Scene, settings: &Settings) -> ContentForecast {
    if scene.gravity == Vec3::ZERO && settings.gravity == Vec3::ZERO {
        return ContentForecast::default();
    }
    let hangs = hanging(scene);
    let (mut footprints, mut falling) = (0.0, 0.0);
    // Spheres, capsules, others.
    let mut kinds = [0.0f32; 3];
    let mut ground: Option<Aabb> = None;
    let (mut of_meshes, mut bumpy, mut endless) = (false, false, false);
    for shape in shapes(scene) {
        let size = (shape.bounds.max - shape.bounds.min).as_vec3();
        match scene.bodies[shape.body].desc.kind {
            BodyKind::Dynamic if !hangs[shape.body] => {
                footprints += size.x * size.z;
                falling += 1.0;
                kinds[match shape.kind {
                    Kind::Sphere => 0,
                    Kind::Capsule => 1,
                    _ => 2,
                }] += 1.0;
            }
            BodyKind::Static if !size.is_finite() => endless = true,
            BodyKind::Static => {
                let all = ground.get_or_insert(shape.bounds);
                *all = Aabb { min: all.min.min(shape.bounds.min), max: all.max.max(shape.bounds.max) };
                if shape.kind == Kind::Mesh {
                    of_meshes = true;
                    bumpy |= size.y > 0.01 * size.x.max(size.z);
                }
            }
            _ => {}
        }
    }
    let area = match ground {
        _ if endless => f32::INFINITY,
        Some(box_of_all) => {
            let size = (box_of_all.max - box_of_all.min).as_vec3();
            size.x * size.z
        }
        None => return ContentForecast::default(),
    };
    // How many layers there would be.
    let layers = footprints / area.max(f32::MIN_POSITIVE);
    let piled = 1.0 - libm::expf(-layers);
    let on_ground = falling * if layers > 1.0 { 1.0 / layers } else { 1.0 };
    let bumps = if bumpy { BUMPY } else { 1.0 };
    let [pairs, contacts] = [0, 1].map(|i| (falling * piled * PILE[i], on_ground * GROUND[i]));
    let contacts = [contacts.0, contacts.1 * bumps];

    // A share of the shapes, whose contacts have few points unless they lie on a face.
    let [sphere, capsule, _] = kinds.map(|n| n / falling.max(1.0));
    let mut by_points = [[0.0f32; 4]; 2];
    let mut add = |side: usize, share: f32, parts: [f32; 4]| {
        by_points[side].iter_mut().zip(parts).for_each(|(n, part)| *n += contacts[side] * share * part);
    };
    let (round, other) = (1.0 - sphere, 1.0 - sphere - capsule);
    add(0, 1.0 - round * round, [1.0, 0.0, 0.0, 0.0]);
    add(0, round * round - other * other, [0.7, 0.3, 0.0, 0.0]);
    add(0, other * other, [0.4, 0.2, 0.1, 0.3]);
    add(1, sphere, [1.0, 0.0, 0.0, 0.0]);
    add(1, capsule, [0.4, 0.6, 0.0, 0.0]);
    add(1, other, [0.2, 0.3, 0.1, 0.4]);
    let all = pairs.0 + pairs.1;
    let with_meshes = if of_meshes { pairs.1 } else { 0.0 };
    let bare = (all - with_meshes - contacts[0]).max(0.0);
    ContentForecast {
        pairs: all as usize,
        of_meshes: with_meshes as usize,
        fresh: (bare * NEAR) as usize,
        contacts: by_points.map(|side| side.map(|n| n as usize)),
        ..ContentForecast::default()
    }
}

/// The share of contacts that exist for continuous collision only: those of bodies that are fast at the
/// start.
fn ahead(scene: &Scene, settings: &Settings) -> f32 {
    let dynamic = scene.bodies.iter().map(|body| &body.desc).filter(|desc| desc.kind == BodyKind::Dynamic);
    let is_fast = |desc: &&BodyDesc| {
        let way = desc.linear_velocity.length() * STEP;
        way > FAT * settings.length_unit
            && settings.continuous.of(desc.continuous) != ContinuousMode::Discrete
    };
    let (all, fast) = (dynamic.clone().count(), dynamic.filter(is_fast).count());
    AHEAD * fast as f32 / all.max(1) as f32
}

/// For each body the lowest index among the bodies that joints connect it to.
fn islands(scene: &Scene) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..scene.bodies.len()).collect();
    let root = |parent: &mut Vec<usize>, mut i: usize| {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    };
    let is_dynamic = |i: usize| scene.bodies.get(i).is_some_and(|b| b.desc.kind == BodyKind::Dynamic);
    for joint in &scene.joints {
        let [a, b] = joint.bodies;
        if is_dynamic(a) && is_dynamic(b) {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b)] = a.min(b);
        }
    }
    (0..parent.len()).map(|i| root(&mut parent, i)).collect()
}

/// Whether each body hangs, by joints, on something that does not fall.
fn hanging(scene: &Scene) -> Vec<bool> {
    let of = islands(scene);
    let mut held = vec![false; of.len()];
    for [a, b] in scene.joints.iter().map(|joint| joint.bodies) {
        for (i, other) in [(a, b), (b, a)] {
            let still = scene.bodies.get(other).is_some_and(|b| b.desc.kind != BodyKind::Dynamic);
            if still && i < held.len() {
                held[of[i]] = true;
            }
        }
    }
    of.iter().map(|&root| held[root]).collect()
}

/// Bodies in joint trees of unique shape: such a tree has a lane of its own.
fn branches(scene: &Scene) -> usize {
    let of = islands(scene);
    let (mut bodies, mut joints) = (vec![0usize; of.len()], vec![0usize; of.len()]);
    let mut collides = vec![false; of.len()];
    of.iter().for_each(|&root| bodies[root] += 1);
    for (joint, [a, b]) in scene.joints.iter().map(|joint| (joint, joint.bodies)) {
        let dynamic = [a, b]
            .into_iter()
            .find(|&i| scene.bodies.get(i).is_some_and(|body| body.desc.kind == BodyKind::Dynamic));
        dynamic.into_iter().for_each(|i| joints[of[i]] += 1);
        dynamic.into_iter().for_each(|i| collides[of[i]] |= joint.collide);
    }
    // No loop, attached to one fixed body at most, and no bodies that are joined and collide.
    let is_tree = |&i: &usize| joints[i] > 0 && joints[i] <= bodies[i] && !collides[i];
    let sizes: Vec<usize> = (0..of.len()).filter(is_tree).map(|i| bodies[i]).collect();
    let alone = |&&size: &&usize| sizes.iter().filter(|&&other| other == size).count() == 1;
    if sizes.len() > MANY { 0 } else { sizes.iter().filter(alone).sum() }
}

/// With more trees than this, some have the same shape.
const MANY: usize = 64;
