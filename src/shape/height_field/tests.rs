use super::*;
use crate::random::Random;
use crate::shape::mesh::testing::{bumpy, grid};
use crate::shape::{Ground, TriangleMesh};

fn field(columns: usize, rows: usize, cell: Vec2) -> HeightField {
    let heights = (0..columns * rows)
        .map(|i| bumpy((i % columns) as f32 * cell.x, (i / columns) as f32 * cell.y))
        .collect();
    HeightField::new(columns, rows, cell, heights).unwrap()
}

#[test]
fn a_field_refuses_bad_numbers() {
    let cell = Vec2::ONE;
    assert!(HeightField::new(2, 2, cell, vec![0.0; 3]).is_err());
    assert!(HeightField::new(1, 4, cell, vec![0.0; 4]).is_err());
    assert!(HeightField::new(2, 2, cell, vec![0.0, 0.0, f32::NAN, 0.0]).is_err());
    assert!(HeightField::new(2, 2, Vec2::new(1.0, 0.0), vec![0.0; 4]).is_err());
    assert!(HeightField::new(usize::MAX, 3, cell, vec![0.0; 4]).is_err());
    let flat = HeightField::new(2, 2, cell, vec![0.0; 4]).unwrap();
    assert_eq!(flat.aabb(), (Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)));
}

/// Expected: no spare place, for heights that had some, a copy and a stored field.
#[test]
fn a_field_takes_the_same_memory_however_it_was_made() {
    for (columns, rows) in [(2, 2), (9, 9), (18, 70)] {
        let mut heights = Vec::with_capacity(4 * columns * rows);
        heights.resize(columns * rows, 1.0);
        let field = HeightField::new(columns, rows, Vec2::ONE, heights).unwrap();
        let (live, reserved) = field.bytes();
        assert_eq!(reserved, live, "{columns} x {rows}");
        assert_eq!(field.clone().bytes(), field.bytes());
        #[cfg(feature = "serde")]
        assert_eq!(HeightField::from_stored(field.stored()).unwrap().bytes(), field.bytes());
    }
}

#[test]
fn boxes_and_paths_find_what_a_search_of_all_finds() {
    let mut random = Random(5);
    for (columns, rows, cell) in [(30, 41, Vec2::new(0.7, 0.5)), (2, 2, Vec2::ONE), (5, 90, Vec2::splat(0.3))]
    {
        let field = field(columns, rows, cell);
        let (low, high) = field.aabb();
        let anywhere = |r: &mut Random| low + (high - low) * (r.cube() * 0.7 + 0.5);
        let bounds = |t: u32| {
            let [a, b, c] = field.triangle(t);
            (a.min(b).min(c), a.max(b).max(c))
        };
        for _ in 0..400 {
            let (centre, half) = (anywhere(&mut random), random.cube().abs() * 2.0);
            let (min, max) = (centre - half, centre + half);
            let mut found = Vec::new();
            field.visit_box(min, max, &mut |t, _| found.push(t));
            let mut expected: Vec<u32> = (0..field.triangle_count() as u32).collect();
            expected.retain(|&t| bounds(t).0.cmple(max).all() && bounds(t).1.cmpge(min).all());
            assert_eq!(found, expected);

            let to = anywhere(&mut random);
            let mut found = Vec::new();
            field.visit_segment(centre, to, half * 0.2, &mut |t, _, _| {
                found.push(t);
                1.0
            });
            found.sort_unstable();
            let path = Path::new(centre, to, half * 0.2, 0.0);
            let all = 0..field.triangle_count() as u32;
            for t in all.filter(|&t| path.meets_one(bounds(t).0, bounds(t).1).is_some()) {
                assert!(found.binary_search(&t).is_ok(), "missed {t}");
            }
        }
    }
}

#[test]
fn a_field_has_the_folds_of_the_same_mesh() {
    let field = field(25, 25, Vec2::splat(0.5));
    let (vertices, triangles) = grid(24, 0.5, |x, z| bumpy(x + 6.0, z + 6.0));
    let edges = crate::shape::mesh::edges::find_edges(&vertices, &triangles);
    for (t, edges) in edges.iter().enumerate() {
        let corners = triangles[t].map(|v| vertices[v as usize] + Vec3::new(6.0, 0.0, 6.0));
        for (a, b) in corners.iter().zip(field.triangle(t as u32)) {
            assert!((*a - b).length() < 1e-5);
        }
        assert_eq!(field.edges(t as u32), *edges);
    }
}

#[test]
fn paths_hit_a_field_where_they_hit_the_same_mesh() {
    let field = field(33, 33, Vec2::splat(0.5));
    let corners: Vec<Vec3> = (0..33 * 33).map(|i| field.corner(i % 33, i / 33)).collect();
    let (_, triangles) = grid(32, 0.5, |_, _| 0.0);
    let mesh = TriangleMesh::new(corners.clone(), triangles).unwrap();
    let mut random = Random(6);
    for i in 0..20_000 {
        let mut through = corners[random.below(corners.len())];
        if i % 2 == 0 {
            through.x = (through.x + random.range(0.0, 0.5)).min(16.0);
        }
        let from =
            through + Vec3::new(random.range(-9.0, 9.0), random.range(8.0, 40.0), random.range(-9.0, 9.0));
        let to = through + (through - from) * 0.5;
        let (one, other) =
            (Ground::Field(&field).segment_hit(from, to), Ground::Mesh(&mesh).segment_hit(from, to));
        assert_eq!(one.map(|h| h.0), other.map(|h| h.0));
        // Between samples the surface is elsewhere than `through`, by up to the slope.
        let inside = Vec2::new(through.x - 8.0, through.z - 8.0).abs().max_element() < 6.0;
        assert!(one.is_some() || !inside);
    }
}

#[test]
fn a_sample_takes_less_than_6_bytes() {
    let field = field(225, 225, Vec2::splat(0.5));
    let each = field.bytes().1 as f32 / (225.0 * 225.0);
    println!("{each:.2} bytes a sample");
    assert!(each < 6.0);
}
