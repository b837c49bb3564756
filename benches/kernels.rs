//! A row type, a shape pair, a gather at a time: `cargo bench --features internals --bench kernels [FILTER]`.
//!
//! Criterion prints the throughput in elements: boxes tested, pairs or contacts. 500 Melem/s are 2 ns each.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use backstop::bench::{self, Kernel};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn measure(c: &mut Criterion, group: &str, kernels: Vec<Kernel>) {
    let mut group = c.benchmark_group(group);
    for mut kernel in kernels {
        group.throughput(Throughput::Elements(kernel.elements));
        group.bench_function(&kernel.name, |b| b.iter(&mut kernel.run));
    }
}

fn kernels(c: &mut Criterion) {
    measure(c, "broad phase", bench::broad_phase());
    measure(c, "records", vec![bench::records()]);
    measure(c, "rows", bench::rows());
    measure(c, "rows", vec![bench::preparing()]);
    measure(c, "lanes", bench::lanes());
    measure(c, "convex", bench::convex());
    measure(c, "mesh", bench::mesh());
    measure(c, "distance", bench::distance());
    measure(c, "cast", vec![bench::cast()]);
}

criterion_group!(benches, kernels);
criterion_main!(benches);
