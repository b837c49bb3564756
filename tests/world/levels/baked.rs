//! Hulls, meshes and height fields as bytes: loaded shapes equal built ones, and no bytes do harm.

use super::common::random::Random;
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{
    BodyDesc, ConvexHull, Error, Geometry, HeightField, QueryFilter, Ray, Settings, ShapeDesc, TriangleMesh,
    World,
};
use backstop_scene::Terrain;

/// A rock, hills of triangles, and hills of heights beside them.
struct Level {
    rock: ConvexHull,
    hills: TriangleMesh,
    field: HeightField,
}

impl Level {
    fn built(cells: usize) -> Level {
        let mut random = Random(11);
        let points: Vec<Vec3> = (0..60).map(|_| random.cube().normalize_or(Vec3::X) * 0.5).collect();
        let (vertices, triangles) = Terrain::bumpy(cells, 1.0).mesh();
        let side = cells + 1;
        let heights = (0..side * side).map(|_| random.range(-0.4, 0.4)).collect();
        Level {
            rock: ConvexHull::new(&points).unwrap(),
            hills: TriangleMesh::new(vertices, triangles).unwrap(),
            field: HeightField::new(side, side, Vec2::ONE, heights).unwrap().with_holes([[2, 3]]).unwrap(),
        }
    }

    fn bytes(&self) -> [Vec<u8>; 3] {
        [self.rock.to_bytes(), self.hills.to_bytes(), self.field.to_bytes()]
    }

    fn loaded([rock, hills, field]: &[Vec<u8>; 3]) -> Result<Level, Error> {
        Ok(Level {
            rock: ConvexHull::from_bytes(rock)?,
            hills: TriangleMesh::from_bytes(hills)?,
            field: HeightField::from_bytes(field)?,
        })
    }

    /// Rocks and boxes that fall on both kinds of hills.
    fn world(&self, bodies: u32, threads: usize) -> World {
        let settings = Settings::default().with_threads(threads).with_sleeping(true);
        let mut world = World::new(settings).unwrap();
        let (rock, hills) = (Geometry::hull(self.rock.clone()), Geometry::mesh(self.hills.clone()));
        let field = Geometry::height_field(self.field.clone());
        let size = self.field.aabb().1;
        for (geometry, x) in [(hills, 0.5 * size.x + 1.0), (field, -size.x - 1.0)] {
            let z = if x < 0.0 { -0.5 * size.z } else { 0.0 };
            world
                .add_body(
                    &BodyDesc::fixed()
                        .with_position(Vec3::new(x, 0.0, z))
                        .with_shape(ShapeDesc::new(geometry)),
                )
                .unwrap();
        }
        let mut random = Random(5);
        for i in 0..bodies {
            let geometry = if i % 2 == 0 { rock.clone() } else { Geometry::cuboid(0.3, 0.2, 0.4) };
            let side = if i % 4 < 2 { 0.5 } else { -0.5 } * size.x;
            let at = Vec3::new(side, 4.0 + 0.05 * i as f32, 0.0)
                + random.cube() * 0.3 * size.x * Vec3::new(1.0, 0.0, 1.0);
            world
                .add_body(&BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry)))
                .unwrap();
        }
        world
    }
}

/// Expected: lists of a text, whose length is not known before its end, hold no spare place.
#[test]
fn shapes_out_of_json_take_the_memory_of_built_ones() {
    fn read<T: serde::Serialize + serde::de::DeserializeOwned>(shape: &T) -> T {
        serde_json::from_str(&serde_json::to_string(shape).unwrap()).unwrap()
    }
    let Level { rock, hills, field } = Level::built(40);
    assert_eq!(read(&rock).bytes(), rock.bytes());
    assert_eq!(read(&hills).bytes(), hills.bytes());
    assert_eq!(read(&field).bytes(), field.bytes());
}

/// Expected: not a bit differs in ten seconds, on one thread and on two, and no byte of memory.
#[test]
fn a_world_with_loaded_shapes_has_the_bits_of_one_with_built_ones() {
    let built = Level::built(40);
    let bytes = built.bytes();
    let loaded = Level::loaded(&bytes).unwrap();
    assert_eq!(loaded.bytes(), bytes);
    assert_eq!(loaded.rock.bytes(), built.rock.bytes());
    assert_eq!(loaded.hills.bytes(), built.hills.bytes());
    assert_eq!(loaded.field.bytes(), built.field.bytes());
    let (mut one, mut other, mut third) = (built.world(200, 1), loaded.world(200, 1), loaded.world(200, 2));
    for step in 0..600 {
        for world in [&mut one, &mut other, &mut third] {
            world.step(1.0 / 60.0).unwrap();
        }
        assert_eq!(
            (one.state_hash(), one.state_hash()),
            (other.state_hash(), third.state_hash()),
            "step {step}"
        );
    }
    assert!(one.memory().total() == other.memory().total());
}

/// Expected: `BrokenShape`, by the checksum or the kind; `ShapeVersion` for another version.
#[test]
fn bytes_that_were_cut_off_or_changed_are_refused() {
    let level = Level::built(6);
    let good = level.bytes();
    let broken = |kind: usize, bytes: &[u8]| {
        let mut all = good.clone();
        all[kind] = bytes.to_vec();
        Level::loaded(&all).err()
    };
    for (kind, bytes) in good.iter().enumerate() {
        for end in 0..bytes.len() {
            assert!(matches!(broken(kind, &bytes[..end]), Some(Error::BrokenShape { .. })), "{kind} {end}");
        }
        for bit in 0..8 * bytes.len() {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let error = broken(kind, &flipped);
            assert!(
                matches!(error, Some(Error::BrokenShape { .. } | Error::ShapeVersion { .. })),
                "{kind} {bit} {error:?}"
            );
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(broken(kind, &longer).is_some());
        assert!(broken((kind + 1) % 3, bytes).is_some());
    }
}

/// With the checksum put right whatever the bytes say is refused, or a shape that a world steps with and that
/// queries end in.
#[test]
fn changed_bytes_with_a_right_checksum_are_refused_or_do_no_harm() {
    let good = Level::built(6).bytes();
    let mut random = Random(3);
    let (mut refused, mut taken) = ([0; 3], [0; 3]);
    for round in 0..9000 {
        let kind = round % 3;
        let mut all = good.clone();
        let bytes = &mut all[kind];
        bytes.truncate(bytes.len() - 4);
        for _ in 0..1 + random.below(3) {
            let place = 18 + random.below(bytes.len() - 18);
            match random.below(5) {
                0 => bytes[place] ^= 1 << random.below(8),
                1 => bytes[place] = random.below(256) as u8,
                2 => bytes[place] = 0xff,
                3 => bytes[place] = bytes[place].wrapping_add(1),
                _ if round % 7 == 0 => bytes.truncate(place.max(19)),
                _ => bytes[place] = 0,
            }
        }
        bytes.extend(crc32fast::hash(bytes).to_le_bytes());
        let Ok(level) = Level::loaded(&all) else {
            refused[kind] += 1;
            continue;
        };
        taken[kind] += 1;
        let mut world = level.world(6, 1);
        for _ in 0..3 {
            world.step(1.0 / 60.0).unwrap();
        }
        for x in [-4.5, 4.3] {
            let down = Ray::new(DVec3::new(x, 50.0, 0.3), Vec3::new(0.0, -100.0, 0.0));
            world.cast_ray(&down, &QueryFilter::default()).unwrap();
        }
    }
    println!("refused {refused:?}, taken {taken:?}");
    assert!(refused.iter().all(|&count| count > 300) && taken.iter().all(|&count| count > 100));
}

/// Expected: by hand, trees that a walk would not end in, miss triangles with or read beyond.
#[test]
fn a_tree_that_is_none_is_refused() {
    let mesh = Level::built(6).hills;
    let json = serde_json::to_value(&mesh).unwrap();
    let with = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut changed = json.clone();
        change(&mut changed);
        serde_json::from_value::<TriangleMesh>(changed).map_err(|error| error.to_string())
    };
    assert_eq!(with(&|_| ()).unwrap().to_bytes(), mesh.to_bytes());
    let refused = |change: &dyn Fn(&mut serde_json::Value), why: &str| {
        let error = with(change).unwrap_err();
        assert!(error.contains(why), "{error}");
    };
    refused(&|mesh| mesh["nodes"][0]["child"][0] = 0.into(), "circles");
    refused(&|mesh| mesh["nodes"] = serde_json::json!([]), "no tree");
    refused(&|mesh| mesh["nodes"][0]["boxes"][1] = serde_json::to_value([[0; 4]; 3]).unwrap(), "too small");
    refused(&|mesh| mesh["nodes"][0]["child"] = serde_json::to_value([u32::MAX; 4]).unwrap(), "none");
    refused(&|mesh| mesh["corners"][5] = 1000.into(), "no vertex");
    refused(&|mesh| mesh["vertices"][0][1] = 1e9.into(), "1e7");
    refused(&|mesh| mesh["more"] = 1.into(), "unknown field");
}
