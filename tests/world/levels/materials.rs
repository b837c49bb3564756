//! Materials for each triangle of a mesh and each cell of a height field.

use super::common;
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Combine, ContinuousMethod, Error, Geometry, HeightField, Material, QueryFilter,
    Ray, Settings, ShapeDesc, ShapeHandle, Snapshot, TriangleMesh, World,
};

const DT: f32 = 1.0 / 60.0;
/// Cells of half a metre along each side.
const SIDE: usize = 40;

/// The other surface decides: whichever is larger counts.
fn smooth() -> Material {
    let material = Material::default().with_friction(0.0).with_friction_combine(Combine::Maximum);
    material.with_restitution_combine(Combine::Maximum)
}

fn rubber() -> Material {
    smooth().with_friction(0.5)
}

/// Flat, from -10 m to 10 m along x and z; `of` gives the number of a cell's material by its middle.
pub(super) fn grounds(of: impl Fn(f32, f32) -> u8, table: &[Material]) -> [(Geometry, DVec3); 2] {
    let middle = |i: usize| 0.5 * i as f32 - 9.75;
    let cells = (0..SIDE * SIDE).map(|i| of(middle(i % SIDE), middle(i / SIDE)));
    let cells: Vec<u8> = cells.collect();
    let at = |i: usize| 0.5 * i as f32 - 10.0;
    let side = SIDE + 1;
    let vertices = (0..side * side).map(|i| Vec3::new(at(i % side), 0.0, at(i / side))).collect();
    let quad = |i: usize| {
        let first = (i / SIDE * side + i % SIDE) as u32;
        let below = first + side as u32;
        [[first, below, first + 1], [first + 1, below, below + 1]]
    };
    let triangles = (0..SIDE * SIDE).flat_map(quad).collect();
    let twice: Vec<u8> = cells.iter().flat_map(|&cell| [cell; 2]).collect();
    let mesh = TriangleMesh::with_materials(vertices, triangles, &twice, table).unwrap();
    let field = HeightField::new(side, side, Vec2::splat(0.5), vec![0.0; side * side]).unwrap();
    let field = field.with_materials(&cells, table).unwrap();
    [(Geometry::mesh(mesh), DVec3::ZERO), (Geometry::height_field(field), DVec3::new(-10.0, 0.0, -10.0))]
}

/// A world with a ground whose own material is smooth.
pub(super) fn world_of((ground, at): &(Geometry, DVec3), settings: Settings) -> (World, ShapeHandle) {
    let mut world = World::new(settings).unwrap();
    let ground = ShapeDesc::new(ground.clone()).with_material(smooth());
    let ground = world.add_body(&BodyDesc::fixed().with_position(*at).with_shape(ground)).unwrap();
    let shape = world.shapes(ground).unwrap().next().unwrap();
    (world, shape)
}

/// A flat box that slides along x at 4 m/s.
fn slider(x: f32, z: f32) -> BodyDesc {
    let shape = ShapeDesc::new(Geometry::cuboid(0.05, 0.02, 0.05)).with_material(smooth());
    BodyDesc::dynamic()
        .with_position(Vec3::new(x, 0.02, z))
        .with_shape(shape)
        .with_velocity(Vec3::X * 4.0, Vec3::ZERO)
}

/// Ice up to x = 0 and rubber beyond it. Expected: 4 m/s on ice; it stops v² / (2 mu g) = 1.631 m past the
/// seam, where friction begins no sooner than with its front and no later than with its rear, 5 cm before and
/// behind its middle. One that begins on rubber goes 1.631 m from there.
#[test]
fn a_box_slides_over_ice_and_stops_on_rubber() {
    for ground in &grounds(|x, _| u8::from(x > 0.0), &[rubber()]) {
        let (mut world, _) = world_of(ground, Settings::default());
        let far = world.add_body(&slider(-4.0, 0.3)).unwrap();
        let near = world.add_body(&slider(2.1, 3.3)).unwrap();
        common::steps(&mut world, 57, DT);
        let velocity = world.linear_velocity(far).unwrap();
        assert!((velocity - Vec3::X * 4.0).length() < 1e-3, "{velocity}");
        common::steps(&mut world, 180, DT);
        let way = 16.0 / (2.0 * 0.5 * 9.81);
        let [far, near] = [far, near].map(|body| world.position(body).unwrap());
        println!("stops at {} and {}, not {way} and {}", far.x, near.x, way + 2.1);
        assert!((far.x - way).abs() < 0.055 && (near.x - 2.1 - way).abs() < 0.02);
        assert!((far.y - 0.02).abs() < 2e-3 && (far.z - 0.3).abs() < 0.01);
    }
}

/// A box that can't yaw slides along the seam between ice and rubber. Expected: a manifold for each material,
/// both of which bear, and friction of the rubber alone: with its share of the load it goes v² / (2 share mu
/// g).
#[test]
fn a_box_astride_of_two_materials_has_a_manifold_on_each() {
    for ground in &grounds(|_, z| u8::from(z > 0.0), &[rubber()]) {
        let (mut world, _) = world_of(ground, Settings::default());
        let body = world.add_body(&slider(-5.0, 0.0).with_lock_rotation([false, true, false])).unwrap();
        let mut loads = [0.0; 2];
        while world.linear_velocity(body).unwrap().x > 0.01 {
            common::steps(&mut world, 1, DT);
            assert_eq!(world.contacts_of(body).unwrap().count(), 2);
            for contact in world.contacts_of(body).unwrap() {
                let middle: f64 = contact.points().iter().map(|point| point.position.z).sum();
                let load: f32 = contact.points().iter().map(|point| point.impulse).sum();
                loads[usize::from(middle > 0.0)] += load;
            }
        }
        let share = loads[1] / (loads[0] + loads[1]);
        let (way, expected) = (world.position(body).unwrap().x + 5.0, 16.0 / (2.0 * share * 0.5 * 9.81));
        println!("{way} m, not {expected}, with {share} of the load on rubber");
        assert!((way / f64::from(expected) - 1.0).abs() < 0.03 && (0.1..0.9).contains(&share));
    }
}

/// A strip whose surface moves at 2 m/s, with friction 0.5. Expected: a box on it is pulled up to that speed
/// within v / (mu g) = 0.41 s and goes on with it; one beside it stays where it is.
#[test]
fn a_strip_of_a_ground_is_a_conveyor() {
    let belt = rubber().with_surface_velocity(Vec3::X * 2.0);
    for ground in &grounds(|_, z| u8::from(z.abs() < 1.0), &[belt]) {
        let (mut world, _) = world_of(ground, Settings::default());
        let place = |z: f32| slider(-6.0, z).with_velocity(Vec3::ZERO, Vec3::ZERO);
        let [on, beside] = [0.1, 3.1].map(|z| world.add_body(&place(z)).unwrap());
        common::steps(&mut world, 24, DT);
        assert!(world.linear_velocity(on).unwrap().x > 1.7);
        common::steps(&mut world, 216, DT);
        let velocity = world.linear_velocity(on).unwrap();
        assert!((velocity - Vec3::X * 2.0).length() < 0.02, "{velocity}");
        // The way of an even pull, then an even speed.
        let way = world.position(on).unwrap().x + 6.0;
        let expected = 2.0 * (4.0 - 0.5 * 2.0 / (0.5 * 9.81));
        assert!((way - expected).abs() < 0.1, "{way}, not {expected}");
        assert!((world.position(beside).unwrap().x + 6.0).abs() < 1e-3);
    }
}

/// Balls that fall by 2 m onto a triangle of restitution 0.8 and onto one of 0; and bullets at 60 m/s, 1 m a
/// step, whichever way they are kept from passing. Expected: up to 0.8² h; off at 0.8 v.
#[test]
fn a_ball_bounces_at_the_restitution_of_its_triangle() {
    for ground in &grounds(|x, _| u8::from(x > 0.0), &[smooth().with_restitution(0.8)]) {
        let (mut world, _) = world_of(ground, Settings::default());
        let shape = ShapeDesc::new(Geometry::sphere(0.1)).with_material(smooth());
        let ball = |x: f32, y: f32| {
            BodyDesc::dynamic().with_position(Vec3::new(x, y, 0.2)).with_shape(shape.clone())
        };
        let [bounces, stays] = [2.1, -2.1].map(|x| world.add_body(&ball(x, 2.1)).unwrap());
        let mut highest = [0.0f64; 2];
        for step in 0..100 {
            common::steps(&mut world, 1, DT);
            if step > 40 {
                for (most, body) in highest.iter_mut().zip([bounces, stays]) {
                    *most = most.max(world.position(body).unwrap().y);
                }
            }
        }
        assert!((highest[0] - 0.1 - 1.28).abs() < 0.03 && highest[1] < 0.11, "{highest:?}");
        for method in [
            ContinuousMethod::OnePass,
            ContinuousMethod::LinearCast,
            ContinuousMethod::ConservativeAdvancement,
        ] {
            let settings = Settings::default().with_continuous_method(method).with_gravity(Vec3::ZERO);
            let (mut world, _) = world_of(ground, settings);
            let bullet = |x: f32| ball(x, 4.45).with_velocity(Vec3::NEG_Y * 60.0, Vec3::ZERO);
            let [bounces, stays] = [2.1, -2.1].map(|x| world.add_body(&bullet(x)).unwrap());
            common::steps(&mut world, 10, DT);
            let [up, none] = [bounces, stays].map(|body| world.linear_velocity(body).unwrap().y);
            assert!((up - 48.0).abs() < 0.5 && none.abs() < 0.5, "{method:?}: {up}, {none}");
        }
    }
}

/// Expected: on the strip that resists rolling by b = 5 mm a ball of 0.2 m slows down by (5/7) g b / r, also
/// if nothing else in the world resists; beside it the ball keeps its speed.
#[test]
fn a_ball_rolls_to_rest_on_the_triangles_that_resist() {
    for ground in &grounds(|_, z| 1 + u8::from(z > 0.0), &[rubber(), rubber().with_rolling_friction(5e-3)]) {
        let (mut world, _) = world_of(ground, Settings::default());
        let shape = ShapeDesc::new(Geometry::sphere(0.2)).with_material(smooth());
        let ball = |z: f32| {
            let ball = BodyDesc::dynamic().with_position(Vec3::new(-8.0, 0.2, z)).with_shape(shape.clone());
            ball.with_velocity(Vec3::X * 2.0, Vec3::NEG_Z * 10.0)
        };
        let [free, slows] = [-1.1, 1.1].map(|z| world.add_body(&ball(z)).unwrap());
        common::steps(&mut world, 120, DT);
        let [free, slows] = [free, slows].map(|body| world.linear_velocity(body).unwrap().x);
        let expected = 2.0 - 5.0 / 7.0 * 9.81 * 5e-3 / 0.2 * 2.0;
        assert!((free - 2.0).abs() < 0.01 && (slows - expected).abs() < 0.01, "{free}, {slows}");
    }
}

/// Boxes and balls that slide, bounce and ride over a ground of four materials.
fn crowd(world: &mut World) -> Vec<BodyHandle> {
    let place = |i: usize| {
        let [x, y, z] = [i % 6, i / 36, i / 6 % 6].map(|k| k as f32);
        let geometry = [Geometry::cuboid(0.3, 0.2, 0.3), Geometry::sphere(0.25)][i % 2].clone();
        let shape = ShapeDesc::new(geometry).with_material(smooth());
        let at = Vec3::new(1.5 * x - 4.0, 1.0 + y, 1.5 * z - 4.0);
        BodyDesc::dynamic()
            .with_position(at)
            .with_shape(shape)
            .with_velocity(Vec3::new(2.0, 0.0, 1.0), Vec3::ZERO)
    };
    (0..72).map(|i| world.add_body(&place(i)).unwrap()).collect()
}

fn four() -> [(Geometry, DVec3); 2] {
    let table = [rubber(), smooth().with_restitution(0.7), rubber().with_surface_velocity(Vec3::Z)];
    grounds(|x, z| (x > 0.0) as u8 + 2 * (z > 0.0) as u8, &table)
}

/// Expected: the same bits on one thread and two, from the bytes of a snapshot, and if heights are written
/// anew; other bits than with the shape's own material alone; and bytes of one ground are none of the other.
#[test]
fn materials_of_triangles_give_the_same_bits_everywhere() {
    let plain = grounds(|_, _| 0, &[]);
    for (ground, plain) in four().iter().zip(&plain) {
        let run = |ground: &(Geometry, DVec3), threads: usize, restored: bool| {
            let settings = Settings::default().with_threads(threads).with_sleeping(true);
            let (mut world, shape) = world_of(ground, settings);
            crowd(&mut world);
            common::steps(&mut world, 90, DT);
            if restored {
                let mut snapshot = Snapshot::new();
                world.snapshot(&mut snapshot);
                common::steps(&mut world, 30, DT);
                let bytes = snapshot.to_whole_bytes();
                world.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
                if let Geometry::HeightField(field) = &ground.0 {
                    assert!(!field.materials().is_empty());
                }
            }
            common::steps(&mut world, 240, DT);
            (world.state_hash(), world, shape)
        };
        let (hash, mut world, shape) = run(ground, 1, false);
        assert_eq!((run(ground, 2, false).0, run(ground, 1, true).0), (hash, hash));
        let (other, without, _) = run(plain, 1, false);
        assert_ne!(other, hash);
        let mut snapshot = Snapshot::new();
        without.snapshot(&mut snapshot);
        assert!(world.restore(&Snapshot::from_bytes(&snapshot.to_bytes()).unwrap()).is_err());
        if let Geometry::HeightField(_) = world.geometry(shape).unwrap() {
            world.set_heights(shape, [3, 3], [2, 2], &[0.1; 4]).unwrap();
            let Geometry::HeightField(field) = world.geometry(shape).unwrap() else { panic!() };
            assert_eq!((field.materials().len(), field.material_of(2 * 40 * 30)), (3, 2));
        }
    }
}

/// Expected: the numbers by which cells were given, wherever the tree put the triangles; so too of a mesh
/// that is scaled and mirrored, and of one that was read from bytes.
#[test]
fn hits_name_the_triangle_and_so_its_material() {
    let number = |x: f32, z: f32| ((x + 10.0) as u8 + (z + 10.0) as u8) % 5;
    let table = [rubber(), smooth(), rubber(), smooth().with_restitution(0.3)];
    let numbers = |ground: &(Geometry, DVec3), scale: f32| {
        let (world, _) = world_of(ground, Settings::default());
        for i in 0..400 {
            let at = Vec2::new((i % 20) as f32 - 9.75, (i / 20) as f32 - 9.75);
            let from = DVec3::new((at.x * scale).into(), 5.0, at.y.into());
            let hit = world.cast_ray(&Ray::new(from, Vec3::NEG_Y * 10.0), &QueryFilter::default()).unwrap();
            let triangle = hit.unwrap().triangle.unwrap();
            let found = match &ground.0 {
                Geometry::Mesh(mesh) => mesh.material_of(triangle),
                Geometry::HeightField(field) => field.material_of(triangle),
                _ => unreachable!(),
            };
            assert_eq!(found, number(at.x, at.y), "{at}");
        }
    };
    let both = grounds(number, &table);
    both.iter().for_each(|ground| numbers(ground, 1.0));
    let [(Geometry::Mesh(mesh), _), (Geometry::HeightField(field), at)] = &both else { unreachable!() };
    numbers(&(Geometry::mesh(mesh.scaled(Vec3::new(-2.0, 1.0, 1.0)).unwrap()), DVec3::ZERO), -2.0);
    let wide = field.scaled(Vec3::new(2.0, 1.0, 1.0)).unwrap();
    numbers(&(Geometry::height_field(wide), *at + DVec3::NEG_X * 10.0), 2.0);
    assert_eq!((mesh.materials(), field.materials()), (&table[..], &table[..]));
    {
        let read = TriangleMesh::from_bytes(&mesh.to_bytes()).unwrap();
        assert_eq!((read.materials(), read.bytes()), (&table[..], mesh.bytes()));
        numbers(&(Geometry::mesh(read), DVec3::ZERO), 1.0);
        let read = HeightField::from_bytes(&field.to_bytes()).unwrap();
        assert_eq!((read.materials(), read.bytes()), (&table[..], field.bytes()));
        numbers(&(Geometry::height_field(read), *at), 1.0);
    }
    // A byte a triangle or cell, and the table.
    let [(Geometry::Mesh(plain), _), (Geometry::HeightField(flat), _)] = grounds(|_, _| 0, &[]) else {
        unreachable!()
    };
    let table = 4 * size_of::<Material>();
    assert_eq!(mesh.bytes().0 - plain.bytes().0, table);
    let without = HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap();
    assert_eq!(field.bytes().0 - flat.bytes().0, table);
    assert!(flat.bytes().0 - without.bytes().0 < SIDE * SIDE + 64);
}

/// A ground that is exchanged for one with rubber, and a shape whose own material changes. Expected: what
/// slides is slowed down by 0.5 g from then on; triangles of number zero have the shape's own.
#[test]
fn materials_may_change() {
    let [ice, _] = grounds(|_, _| 0, &[]);
    let [(stops, _), _] = grounds(|_, _| 1, &[rubber()]);
    let slows = |change: &dyn Fn(&mut World, ShapeHandle)| {
        let (mut world, shape) = world_of(&ice, Settings::default());
        let body = world.add_body(&slider(-5.0, 0.0)).unwrap();
        common::steps(&mut world, 20, DT);
        change(&mut world, shape);
        common::steps(&mut world, 31, DT);
        let before = world.linear_velocity(body).unwrap().x;
        common::steps(&mut world, 12, DT);
        (before - world.linear_velocity(body).unwrap().x) / 0.2
    };
    assert!(slows(&|_, _| ()).abs() < 1e-3);
    let exchanged = slows(&|world, shape| world.set_geometry(shape, stops.clone()).unwrap());
    let own = slows(&|world, shape| world.set_material(shape, rubber()).unwrap());
    assert!((exchanged - 4.905).abs() < 0.05 && (own - 4.905).abs() < 0.05, "{exchanged} {own}");
}

#[test]
fn tables_that_do_not_fit_are_refused() {
    let mesh = |of: &[u8], table: &[Material]| {
        let corners = vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0)];
        TriangleMesh::with_materials(corners, vec![[0, 1, 2], [2, 1, 3]], of, table)
    };
    let field = |of: &[u8], table: &[Material]| {
        HeightField::new(3, 2, Vec2::ONE, vec![0.0; 6]).unwrap().with_materials(of, table)
    };
    let wrong = Material::default().with_restitution(2.0);
    for (of, table) in [
        (&[0, 2][..], &[rubber()][..]),
        (&[1, 0], &[]),
        (&[0], &[rubber()]),
        (&[0, 0, 0], &[rubber()]),
        (&[0, 0], &[wrong]),
    ] {
        let is_told = |error: &Error| matches!(error, Error::Count { .. } | Error::OutOfRange { .. });
        assert!(mesh(of, table).is_err_and(|error| is_told(&error)), "{of:?}");
        assert!(field(of, table).is_err_and(|error| is_told(&error)), "{of:?}");
    }
    assert!(matches!(mesh(&[0, 0], &[rubber(); 256]), Err(Error::TooMany { .. })));
    assert!(mesh(&[255, 0], &[rubber(); 255]).is_ok() && field(&[1, 0], &[rubber()]).is_ok());
    // A triangle without area is dropped with its number.
    let corners = vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0)];
    let triangles = vec![[0, 1, 1], [0, 1, 2], [2, 1, 3], [0, 1, 2]];
    let mesh = TriangleMesh::with_materials(corners, triangles, &[1, 2, 3, 1], &[rubber(); 3]).unwrap();
    let mut numbers = [0, 1].map(|i| mesh.material_of(i));
    numbers.sort_unstable();
    assert_eq!((numbers, mesh.triangle_count()), ([2, 3], 2));
}

/// Expected: a replay without divergence, at the hash of the run.
#[test]
fn a_recording_holds_the_materials() {
    for ground in &four() {
        let buffer = backstop::replay::RecordingBuffer::default();
        let mut world = World::new(Settings::default()).unwrap();
        world.start_recording(buffer.clone()).unwrap();
        let shape = ShapeDesc::new(ground.0.clone()).with_material(smooth());
        world.add_body(&BodyDesc::fixed().with_position(ground.1).with_shape(shape)).unwrap();
        crowd(&mut world);
        common::steps(&mut world, 120, DT);
        world.stop_recording().unwrap();
        let bytes = buffer.bytes();
        let mut replay = backstop::replay::Replay::open(&bytes[..]).unwrap();
        assert_eq!(replay.run().unwrap().divergence, None);
        assert_eq!(replay.world().state_hash(), world.state_hash());
    }
}

/// A ground as text and back. Expected: the same materials.
#[test]
fn descriptions_hold_the_materials() {
    for (ground, _) in four() {
        let text = serde_json::to_string(&ground).unwrap();
        let read: Geometry = serde_json::from_str(&text).unwrap();
        let tables = [&ground, &read].map(|geometry| match geometry {
            Geometry::Mesh(mesh) => (mesh.materials().to_vec(), mesh.material_of(900)),
            Geometry::HeightField(field) => (field.materials().to_vec(), field.material_of(900)),
            _ => unreachable!(),
        });
        assert_eq!(tables[0], tables[1]);
        assert_eq!(tables[0].0.len(), 3);
    }
}
