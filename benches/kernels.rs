//! A row type, a shape pair, a gather at a time: `cargo bench --features internals --bench kernels [FILTER]`.
//!
//! Criterion prints the throughput in elements: boxes tested, pairs or contacts. 500 Melem/s are 2 ns each.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use backstop::bench::{self, Ground, Kernel};
use backstop::{Settings, TriangleMesh, World};
use backstop_scene::{Terrain, builtin};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

fn measure(c: &mut Criterion, group: &str, kernels: Vec<Kernel>) {
    let mut group = c.benchmark_group(group);
    for mut kernel in kernels {
        group.throughput(Throughput::Elements(kernel.elements));
        group.bench_function(&kernel.name, |b| b.iter(&mut kernel.run));
    }
}

/// A mesh out of the 100,352 triangles of a terrain; an element is a triangle.
fn build() -> Kernel {
    let (vertices, triangles) = Terrain::bumpy(224, 0.5).mesh();
    Kernel::new("build", triangles.len(), move || {
        let mesh = TriangleMesh::new(vertices.clone(), triangles.clone());
        black_box(mesh.expect("a terrain has triangles"));
    })
}

/// Shapes on a terrain of 8192 triangles half a metre long.
fn on_ground() -> Vec<Kernel> {
    let terrain = Terrain::bumpy(64, 0.5);
    let (vertices, triangles) = terrain.mesh();
    let mesh = TriangleMesh::new(vertices, triangles).expect("a terrain has cells");
    bench::mesh(&Ground { mesh, half: terrain.half(), height: &|x, z| terrain.height(x, z) })
}

/// A wall of boxes after a few steps, with contacts of faces, four points each.
fn wall() -> World {
    let scene = builtin::large_pyramid(24);
    let mut world = World::new(Settings::default().with_gravity(scene.gravity))
        .expect("the default settings are in range");
    scene.add_to(&mut world).expect("a builtin scene is valid");
    for _ in 0..8 {
        world.step(1.0 / 60.0).expect("dt is above zero");
    }
    world
}

fn kernels(c: &mut Criterion) {
    measure(c, "broad phase", bench::boxes());
    measure(c, "broad phase", bench::updates());
    measure(c, "records", vec![bench::records()]);
    measure(c, "rows", bench::rows(&wall));
    measure(c, "rows", vec![bench::preparing(wall())]);
    measure(c, "lanes", bench::lanes());
    measure(c, "convex", bench::convex());
    measure(c, "mesh", on_ground());
    measure(c, "mesh", vec![build()]);
    measure(c, "distance", bench::distance());
    measure(c, "cast", bench::cast());
}

criterion_group!(benches, kernels);
criterion_main!(benches);
