use super::*;

/// Three vertices, one with y = 1e-45, kept a loader busy for ever: times 1.001 the least number stays the
/// same.
///
/// Expected: as for any grid, lines 0 and 255 enclose the range, and so do the boxes made of them.
#[test]
fn boxes_enclose_their_triangles_at_any_extent() {
    let scales = [0.0, f32::from_bits(1), 1e-43, 1e-40, f32::MIN_POSITIVE, 1e-20, 1.0, 1e6, 1e30, f32::MAX];
    for size in scales {
        for from in [0.0, -size, 1.0, -1e3, 1e9] {
            let to = from + size;
            let step = step_of(from, to);
            assert!(step.is_finite() && from + 255.0 * step >= to, "{from} + {size}: {step}");
            let item = |i: u32, at: f32| Item {
                min: Vec3::new(from, at, from),
                max: Vec3::new(to, at, at.max(from)),
                triangle: i,
            };
            let mut items: Vec<Item> = (0..20).map(|i| item(i, from + size * (i as f32 / 19.0))).collect();
            let tree = MeshBvh::build(&mut items);
            for node in &tree.nodes {
                for (lane, &child) in node.child.iter().enumerate() {
                    if child == NO_CHILD || child & IS_LEAF == 0 {
                        continue;
                    }
                    let (first, count) = triangles(child & !IS_LEAF);
                    let (min, max) = union(&items[first as usize..][..count as usize]);
                    for axis in 0..3 {
                        let low = node.at(axis, node.low[axis][lane]);
                        let high = node.at(axis, node.high[axis][lane]);
                        assert!(low <= min[axis] && high >= max[axis], "{from} + {size}: {low}..{high}");
                    }
                }
            }
        }
    }
}
