//! The sample scenes: 20 s without a NaN, nothing lost, and the end that they are made for.

use super::*;

fn sample(name: &str) -> Option<(Scene, Run)> {
    let path = data("gltf/samples")?.join(name);
    let scene = load(&path, &LoadOptions { skip_joints: true }).unwrap();
    let run = Run::new(&scene);
    Some((scene, run))
}

fn print(scene: &Scene, run: &Run) {
    for note in &scene.notes {
        println!("{note}");
    }
    for i in run.dynamic() {
        let is = run.body(i);
        println!(
            "{:26} {:.4} v {:.4} w {:.4}",
            scene.bodies[i].name,
            is.position,
            is.linear.length(),
            is.angular.length()
        );
    }
}

#[test]
fn filtering() {
    let Some((scene, mut run)) = sample("Filtering.glb") else { return };
    for _ in 0..20 {
        run.for_seconds(1.0, 1.0 / 60.0);
        run.dynamic().into_iter().for_each(|i| assert!(run.body(i).position.is_finite()));
    }
    print(&scene, &run);
}

#[test]
fn shape_types() {
    let Some((scene, mut run)) = sample("ShapeTypes.glb") else { return };
    for _ in 0..20 {
        run.for_seconds(1.0, 1.0 / 60.0);
        run.dynamic().into_iter().for_each(|i| assert!(run.body(i).position.is_finite()));
    }
    print(&scene, &run);
}

#[test]
fn restitution() {
    let Some((scene, mut run)) = sample("Materials_Restitution.gltf") else { return };
    for _ in 0..20 {
        run.for_seconds(1.0, 1.0 / 60.0);
        print(&scene, &run);
    }
}

#[test]
fn joint_types_without_joints() {
    let Some((scene, mut run)) = sample("JointTypes.glb") else { return };
    for _ in 0..20 {
        run.for_seconds(1.0, 1.0 / 60.0);
        run.dynamic().into_iter().for_each(|i| assert!(run.body(i).position.is_finite()));
    }
    print(&scene, &run);
}
