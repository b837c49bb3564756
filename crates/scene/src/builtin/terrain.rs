//! A grid of heights, its mesh, and the height of that mesh anywhere: the ground truth of "below the
//! terrain".

use glam::Vec3;

/// Square cells around the origin, each cut into two triangles.
#[derive(Clone, Debug)]
pub struct Terrain {
    cells: usize,
    cell: f32,
    heights: Vec<f32>,
}

impl Terrain {
    /// Hills, bumps and sharp ridges, `cells` by `cells` squares of side `cell` [m].
    pub fn bumpy(cells: usize, cell: f32) -> Self {
        use libm::{cosf, sinf};
        Self::from_fn(cells, cell, |x, z| {
            let hills = 1.5 * sinf(0.35 * x) * cosf(0.27 * z);
            let bumps = 0.5 * sinf(0.9 * x + 1.3) * sinf(1.1 * z + 0.7);
            let ridge = 1.0 - sinf(0.21 * x + 0.13 * z).abs();
            hills + bumps + 1.5 * (ridge * ridge * ridge)
        })
    }

    /// A terrain with the given height [m] over x and z.
    pub fn from_fn(cells: usize, cell: f32, height: impl Fn(f32, f32) -> f32) -> Self {
        let half = cells as f32 * cell * 0.5;
        let at = |n: usize| n as f32 * cell - half;
        let heights = (0..=cells).flat_map(|k| (0..=cells).map(move |i| (i, k)));
        Terrain { cells, cell, heights: heights.map(|(i, k)| height(at(i), at(k))).collect() }
    }

    /// Half its side length: it spans x and z in ± this [m].
    pub fn half(&self) -> f32 {
        self.cells as f32 * self.cell * 0.5
    }

    /// Vertices, and triangles counter-clockwise seen from above.
    pub fn mesh(&self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let row = self.cells as u32 + 1;
        let at = |n: usize| n as f32 * self.cell - self.half();
        let grid = (0..=self.cells).flat_map(|k| (0..=self.cells).map(move |i| (i, k)));
        let vertices = grid.map(|(i, k)| Vec3::new(at(i), self.at(i, k), at(k))).collect();
        let mut triangles = Vec::with_capacity(2 * self.cells * self.cells);
        for k in 0..self.cells as u32 {
            for i in 0..self.cells as u32 {
                let (v00, v10) = (k * row + i, k * row + i + 1);
                let (v01, v11) = (v00 + row, v10 + row);
                triangles.push([v00, v01, v10]);
                triangles.push([v10, v01, v11]);
            }
        }
        (vertices, triangles)
    }

    /// Whether (`x`, `z`) is over or under it.
    pub fn contains(&self, x: f32, z: f32) -> bool {
        x.abs() < self.half() && z.abs() < self.half()
    }

    /// Height of the triangle above or below (`x`, `z`) [m]; outside, that of the nearest point of the rim.
    pub fn height(&self, x: f32, z: f32) -> f32 {
        let last = self.cells as f32 - 1e-3;
        let u = ((x + self.half()) / self.cell).clamp(0.0, last);
        let w = ((z + self.half()) / self.cell).clamp(0.0, last);
        let (i, k) = (u as usize, w as usize);
        let (u, w) = (u - i as f32, w - k as f32);
        let (h10, h01) = (self.at(i + 1, k), self.at(i, k + 1));
        if u + w <= 1.0 {
            let h00 = self.at(i, k);
            h00 + (h10 - h00) * u + (h01 - h00) * w
        } else {
            let h11 = self.at(i + 1, k + 1);
            h11 + (h01 - h11) * (1.0 - u) + (h10 - h11) * (1.0 - w)
        }
    }

    fn at(&self, i: usize, k: usize) -> f32 {
        self.heights[k * (self.cells + 1) + i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_height_is_that_of_the_mesh() {
        let terrain = Terrain::bumpy(16, 0.5);
        let (vertices, triangles) = terrain.mesh();
        for triangle in triangles {
            let [a, b, c] = triangle.map(|v| vertices[v as usize]);
            assert!((b - a).cross(c - a).y > 0.0, "triangles face up");
            for (u, v) in [(0.3, 0.3), (0.1, 0.8), (0.5, 0.2)] {
                let p = a + (b - a) * u + (c - a) * v;
                assert!((terrain.height(p.x, p.z) - p.y).abs() < 1e-4);
            }
        }
    }
}
