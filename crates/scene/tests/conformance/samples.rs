//! The sample scenes: 20 s without a NaN, nothing lost, and the end that they are made for.

use super::*;

fn sample(name: &str) -> Option<(Scene, Run)> {
    let path = data("gltf/samples")?.join(name);
    let scene = load(&path).unwrap();
    let run = Run::new(&scene);
    Some((scene, run))
}

/// 20 s, with a look for NaN every second.
fn run_20_s(run: &mut Run, dt: f32) {
    for _ in 0..20 {
        run.for_seconds(1.0, dt);
        run.dynamic().into_iter().for_each(|i| assert!(run.body(i).position.is_finite()));
    }
}

fn named(scene: &Scene, run: &Run, name: &str) -> Is {
    run.body(scene.bodies.iter().position(|b| b.name == name).unwrap())
}

/// Green cubes rest on green ones, blue ones fall past green ones to the ground, and the compound hangs by
/// its green part. Ground: half of 0.3035 m; static cubes: at 2.2043 m, sides 1 m.
#[test]
fn filtering() {
    for dt in STEPS {
        let Some((scene, mut run)) = sample("Filtering.glb") else { return };
        run_20_s(&mut run, dt);
        let on_ground = 0.5 * 0.303_527_83 + 0.5;
        let on_cube = 2.204_332_6 + 1.0;
        let expected = [
            ("DynamicBlue", on_ground),
            ("DynamicGreen", on_cube),
            ("DynamicGreen.001", on_ground),
            ("DynamicCompound", on_cube - 1.261_108_4),
        ];
        for (name, y) in expected {
            let is = named(&scene, &run, name);
            assert!(is.at_rest() && (is.position.y - y).abs() < 2e-3, "{name} at {dt}: {is:?}, {y}");
        }
    }
}

/// A ramp with every shape on it. Angular bodies come to rest in it; round ones roll, to and fro or out over
/// the rim at z = -3.7 m (1.1 m high), and may then fall.
#[test]
fn shape_types() {
    for dt in STEPS {
        let Some((scene, mut run)) = sample("ShapeTypes.glb") else { return };
        run_20_s(&mut run, dt);
        for i in run.dynamic() {
            let (name, is) = (&scene.bodies[i].name, run.body(i));
            let what = format!("{name} at {dt}: {is:?}");
            let angular = ["DynamicBox", "DynamicConvex", "DynamicCompound"].contains(&name.as_str());
            if !angular {
                assert!(is.position.y > 0.9 || is.position.z < -3.7, "{what}");
                continue;
            }
            let inside = is.position.x.abs() < 6.5 && (-4.0..5.0).contains(&is.position.z);
            assert!(is.at_rest() && inside && (0.9..3.0).contains(&is.position.y), "{what}");
        }
    }
}

/// Basketball and bowling ball, in average with the floor's restitution of 0: e of 0.475 and 0.1017.
#[test]
fn restitution() {
    for dt in STEPS {
        let Some((scene, mut run)) = sample("Materials_Restitution.gltf") else { return };
        let at = |name: &str| scene.bodies.iter().position(|b| b.name == name).unwrap();
        let balls = [at("Basketball"), at("Bowlingball")];
        let floor = 0.5 * 0.340_419_77 * 0.168_444_04;
        let radius = [0.118_205_17, 0.930_880_06 * 0.116_917_41];
        let tops = super::files::rebounds(&mut run, &balls, dt);
        for ((top, radius), e) in tops.iter().zip(radius).zip([0.475, 0.5 * 0.203_386_81]) {
            let rise = (1.5 - radius - floor) * e * e;
            let reached = top - radius - floor;
            assert!((reached - rise).abs() < 0.02 * rise + 1e-3, "{dt}: {reached} instead of {rise}");
        }
        run_20_s(&mut run, dt);
        for (&i, radius) in balls.iter().zip(radius) {
            let is = run.body(i);
            assert!(is.at_rest() && (is.position.y - radius - floor).abs() < 2e-3, "{dt}: {is:?}");
        }
    }
}
