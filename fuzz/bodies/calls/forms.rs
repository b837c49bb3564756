//! Shapes of every form, with every material.

use super::draw::{Draw, Mood};
use backstop::glam::{Vec2, Vec3};
use backstop::{Combine, ConvexHull, Filter, Geometry, HeightField, Material, ShapeDesc, TriangleMesh};
use std::sync::{Arc, OnceLock};

/// Hulls, meshes and height fields: built once, and named by their numbers in what is printed.
pub struct Forms {
    pub hulls: Vec<Geometry>,
    pub meshes: Vec<Geometry>,
    pub fields: Vec<Geometry>,
}

/// Columns and rows of all height fields, and the size of a cell [m].
pub const FIELD: [usize; 2] = [9, 7];
const CELL: Vec2 = Vec2::new(0.9, 1.2);

pub fn forms() -> &'static Forms {
    static FORMS: OnceLock<Forms> = OnceLock::new();
    FORMS.get_or_init(build)
}

fn build() -> Forms {
    // Always the same ones.
    let mut state = 7u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1u32 << 23) as f32 - 1.0
    };
    let mut cloud = |count: usize, size: Vec3| -> Vec<Vec3> {
        (0..count).map(|_| Vec3::new(noise(), noise(), noise()) * size).collect()
    };
    let hull = |points: &[Vec3]| Geometry::Hull(Arc::new(ConvexHull::new(points).expect("points in space")));
    let hulls = [(4, 0.6), (6, 0.5), (12, 0.5), (40, 0.6)];
    let mut hulls: Vec<_> = hulls.map(|(count, size)| hull(&cloud(count, Vec3::splat(size)))).into();
    hulls.push(hull(&cloud(8, Vec3::new(0.9, 0.02, 0.7))));

    let heights = cloud(100, Vec3::ONE);
    let bumps = |k: usize, most: f32| heights[k % 100].x * most;
    let materials: Vec<Material> = vec![
        Material::default().with_friction(0.0),
        Material::default().with_restitution(0.8),
        Material::default().with_rolling_friction(0.1).with_spinning_friction(0.1),
        Material::default().with_surface_velocity(Vec3::new(2.0, 0.0, 0.5)),
        Material::default().with_contact_hertz(8.0).with_contact_damping(0.5),
    ];
    let grid = |side: usize, cell: f32, height: &dyn Fn(usize) -> f32| {
        let half = side as f32 / 2.0;
        let at = |k: usize| (k % (side + 1), k / (side + 1));
        let place =
            |k: usize| Vec3::new((at(k).0 as f32 - half) * cell, height(k), (at(k).1 as f32 - half) * cell);
        let vertices: Vec<Vec3> = (0..(side + 1) * (side + 1)).map(place).collect();
        let corner = |x: usize, z: usize| (z * (side + 1) + x) as u32;
        let cells = (0..side * side).map(|k| (k % side, k / side));
        let two = |(x, z)| {
            let (a, b) = (corner(x, z), corner(x, z + 1));
            [[a, b, a + 1], [a + 1, b, b + 1]]
        };
        (vertices, cells.flat_map(two).collect::<Vec<_>>())
    };
    let mesh = |(vertices, triangles)| {
        Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).expect("triangles")))
    };
    let soup: Vec<Vec3> = cloud(60, Vec3::splat(1.5));
    let soup = (soup, (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
    let (vertices, triangles) = grid(5, 1.0, &|_| 0.0);
    let of: Vec<u8> = (0..triangles.len()).map(|i| (i * 7 % 6) as u8).collect();
    let painted = TriangleMesh::with_materials(vertices, triangles, &of, &materials).expect("materials");
    let meshes = vec![
        mesh(grid(4, 1.5, &|_| 0.0)),
        mesh(grid(6, 0.9, &|k| bumps(k, 0.4))),
        mesh(soup),
        Geometry::Mesh(Arc::new(painted)),
    ];

    let field = |most: f32| {
        let heights = (0..FIELD[0] * FIELD[1]).map(|k| bumps(k, most)).collect();
        HeightField::new(FIELD[0], FIELD[1], CELL, heights).expect("heights")
    };
    let of: Vec<u8> = (0..(FIELD[0] - 1) * (FIELD[1] - 1)).map(|i| (i * 5 % 6) as u8).collect();
    let painted = field(0.3).with_materials(&of, &materials).expect("materials");
    let painted = painted.with_holes([[2, 3], [4, 4], [6, 1]]).expect("holes");
    let fields = [field(0.0), field(0.35), painted].map(|field| Geometry::HeightField(Arc::new(field)));
    Forms { hulls, meshes, fields: fields.into() }
}

/// A form that a dynamic body may have.
pub fn convex(draw: &mut Draw<'_>) -> Geometry {
    match draw.below(8) {
        0 => Geometry::sphere(draw.scale(0.08, 1.0)),
        1 => Geometry::capsule(draw.scale(0.05, 0.8), draw.scale(0.08, 0.5)),
        2 => Geometry::tapered_capsule(draw.scale(0.05, 0.8), draw.scale(0.08, 0.5), draw.scale(0.08, 0.5)),
        3 | 4 => Geometry::cuboid(draw.scale(0.08, 1.2), draw.scale(0.08, 1.2), draw.scale(0.08, 1.2)),
        5 => Geometry::cylinder(draw.scale(0.05, 0.8), draw.scale(0.08, 0.8)),
        6 if draw.bool() => Geometry::cone(draw.scale(0.05, 0.8), draw.scale(0.08, 0.8)),
        6 => Geometry::tapered_cylinder(draw.scale(0.05, 0.8), draw.scale(0.08, 0.8), draw.scale(0.08, 0.8)),
        _ => draw.of(&forms().hulls),
    }
}

/// A form that only what is static or kinematic may have.
pub fn endless(draw: &mut Draw<'_>) -> Geometry {
    match draw.below(4) {
        0 => Geometry::plane(),
        1 | 2 => draw.of(&forms().meshes),
        _ => draw.of(&forms().fields),
    }
}

pub fn form(draw: &mut Draw<'_>) -> Geometry {
    if draw.chance(77) { endless(draw) } else { convex(draw) }
}

pub fn material(draw: &mut Draw<'_>) -> Material {
    let combine = [Combine::Average, Combine::Minimum, Combine::Maximum, Combine::Multiply];
    let mut material = Material::default().with_friction(draw.range(0.0, 1.2));
    if draw.chance(64) {
        material.dynamic_friction = draw.range(0.0, 1.0);
        (material.friction_combine, material.restitution_combine) = (draw.of(&combine), draw.of(&combine));
    }
    if draw.chance(90) {
        material.restitution = draw.range(0.0, 1.0);
    }
    if draw.chance(64) {
        (material.rolling_friction, material.spinning_friction) =
            (draw.range(0.0, 0.2), draw.range(0.0, 0.2));
    }
    if draw.chance(50) {
        material.surface_velocity = draw.vector(4.0);
    }
    if draw.chance(50) {
        (material.contact_hertz, material.contact_damping) = (draw.scale(1.0, 100.0), draw.range(0.0, 2.0));
    }
    material
}

pub fn filter(draw: &mut Draw<'_>) -> Filter {
    let mut filter = Filter::default();
    if draw.chance(40) {
        filter.category = 1 << draw.below(3);
        filter.mask = draw.below(8) as u64;
        filter.group = draw.below(5) as i32 - 2;
    }
    filter
}

pub fn shape(draw: &mut Draw<'_>, geometry: Geometry) -> ShapeDesc {
    let mut shape = ShapeDesc::new(geometry);
    shape.events = draw.chance(120);
    if draw.chance(128) {
        shape.material = material(draw);
    }
    if draw.chance(80) {
        (shape.position, shape.rotation) = (draw.vector(0.7), draw.rotation());
    }
    if draw.chance(100) {
        shape.density = draw.scale(20.0, 8000.0);
    }
    if draw.chance(50) {
        shape.filter = filter(draw);
    }
    if draw.chance(40) && (draw.mood == Mood::Bad || shape.geometry.validate().is_ok()) {
        (shape.sensor, shape.senses_static) = (true, draw.bool());
    }
    shape.hooks = draw.chance(60);
    shape.user_data = draw.below(4) as u64;
    shape
}
