//! A level that loads without building: a mesh of 100,352 triangles, a height field of as many and a hull,
//! and how long each takes to build and to load.
//!
//!     cargo run --release --example bake

use backstop::glam::{Vec2, Vec3};
use backstop::{ConvexHull, Error, HeightField, TriangleMesh};
use backstop_scene::Terrain;
use std::time::Instant;

const CELLS: usize = 224;
const ROUNDS: usize = 15;

/// The median time [ms].
fn time<T>(mut run: impl FnMut() -> Result<T, Error>) -> Result<(f64, T), Error> {
    let mut result = run()?;
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let start = Instant::now();
        result = run()?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok((times[ROUNDS / 2], result))
}

fn compare<T>(
    name: &str,
    build: impl Fn() -> Result<T, Error>,
    bake: impl Fn(&T) -> Vec<u8>,
    load: impl Fn(&[u8]) -> Result<T, Error>,
) -> Result<(), Error> {
    let (to_build, built) = time(build)?;
    let bytes = bake(&built);
    let (to_load, loaded) = time(|| load(&bytes))?;
    assert_eq!(bake(&loaded), bytes);
    println!(
        "{name:12} {:8} bytes, build {to_build:7.3} ms, load {to_load:7.3} ms: 1/{:.1}",
        bytes.len(),
        to_build / to_load
    );
    Ok(())
}

fn main() -> Result<(), Error> {
    let (vertices, triangles) = Terrain::bumpy(CELLS, 1.0).mesh();
    let side = CELLS + 1;
    let heights: Vec<f32> = vertices.iter().map(|v| v.y).collect();
    // The corners of a ball.
    let points: Vec<Vec3> = vertices.iter().take(4000).map(|v| v.normalize_or(Vec3::Y)).collect();
    compare(
        "mesh",
        || TriangleMesh::new(vertices.clone(), triangles.clone()),
        TriangleMesh::to_bytes,
        TriangleMesh::from_bytes,
    )?;
    compare(
        "height field",
        || HeightField::new(side, side, Vec2::ONE, heights.clone()),
        HeightField::to_bytes,
        HeightField::from_bytes,
    )?;
    compare("hull", || ConvexHull::new(&points), ConvexHull::to_bytes, ConvexHull::from_bytes)
}
