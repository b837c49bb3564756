//! A row type, a shape pair, a gather at a time: `cargo bench --features internals --bench kernels [FILTER]`.
//!
//! Criterion prints the throughput in elements: boxes tested, pairs or contacts. 500 Melem/s are 2 ns each.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use backstop::TriangleMesh;
use backstop::bench::{self, Kernel};
use backstop::scene::Terrain;
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

fn kernels(c: &mut Criterion) {
    measure(c, "broad phase", bench::boxes());
    measure(c, "broad phase", bench::updates());
    measure(c, "records", vec![bench::records()]);
    measure(c, "rows", bench::rows());
    measure(c, "rows", vec![bench::preparing()]);
    measure(c, "lanes", bench::lanes());
    measure(c, "convex", bench::convex());
    measure(c, "mesh", bench::mesh());
    measure(c, "mesh", vec![build()]);
    measure(c, "distance", bench::distance());
    measure(c, "cast", bench::cast());
}

criterion_group!(benches, kernels);
criterion_main!(benches);
