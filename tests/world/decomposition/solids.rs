//! Solids that are not convex, as closed triangle meshes, and which points are in them.

use super::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// A closed mesh, its triangles counter-clockwise from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn quad(&mut self, corners: [u32; 4]) {
        let [a, b, c, d] = corners;
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// A closed outline in x and y, counter-clockwise, turned around y.
    pub(super) fn revolved(outline: &[Vec2], count: u32) -> Mesh {
        let mut mesh = Mesh::default();
        let n = outline.len() as u32;
        for i in 0..count {
            let angle = TAU * i as f32 / count as f32;
            let (sin, cos) = (libm::sinf(angle), libm::cosf(angle));
            mesh.vertices.extend(outline.iter().map(|p| Vec3::new(p.x * cos, p.y, p.x * sin)));
            for j in 0..n {
                let at = |i: u32, j: u32| i % count * n + j % n;
                mesh.quad([at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
            }
        }
        mesh
    }

    pub(super) fn torus(ring: f32, tube: f32, around: u32, across: u32) -> Mesh {
        let outline: Vec<Vec2> = (0..across)
            .map(|j| {
                let angle = TAU * j as f32 / across as f32;
                Vec2::new(ring + tube * libm::cosf(angle), tube * libm::sinf(angle))
            })
            .collect();
        Mesh::revolved(&outline, around)
    }

    /// Half of a hollow ball, open at the top.
    pub(super) fn bowl(outer: f32, inner: f32, around: u32) -> Mesh {
        let arc = |radius: f32, j: u32| {
            let angle = -TAU / 4.0 * (1.0 - j as f32 / 8.0);
            // Not at the pole, where all would be one vertex.
            Vec2::new((radius * libm::cosf(angle)).max(0.02 * radius), radius * libm::sinf(angle))
        };
        let mut outline: Vec<Vec2> = (0..=8).map(|j| arc(outer, j)).collect();
        outline.extend((0..=8).rev().map(|j| arc(inner, j)));
        Mesh::revolved(&outline, around)
    }

    /// A prism of half height 0.5 on an outline that its centre sees, counter-clockwise in x and y.
    pub(super) fn star(outline: &[Vec2]) -> Mesh {
        let n = outline.len() as u32;
        let mut mesh = Mesh::default();
        for z in [0.5, -0.5] {
            mesh.vertices.extend(outline.iter().map(|p| p.extend(z)));
        }
        mesh.vertices.extend([Vec3::Z * 0.5, Vec3::Z * -0.5]);
        for i in 0..n {
            let next = (i + 1) % n;
            mesh.triangles.extend([[2 * n, i, next], [2 * n + 1, n + next, n + i]]);
            mesh.quad([i, n + i, n + next, next]);
        }
        mesh
    }

    pub(super) fn gear(teeth: u32, depth: f32) -> Mesh {
        let outline: Vec<Vec2> = (0..4 * teeth)
            .map(|i| {
                let angle = TAU * i as f32 / (4 * teeth) as f32;
                let radius = if i % 4 < 2 { 1.0 } else { 1.0 - depth };
                radius * Vec2::new(libm::cosf(angle), libm::sinf(angle))
            })
            .collect();
        Mesh::star(&outline)
    }

    /// The cells of a grid of planes that are filled.
    pub(super) fn cells(planes: [&[f32]; 3], filled: impl Fn([usize; 3]) -> bool) -> Mesh {
        let counts = planes.map(|p| p.len());
        let mut mesh = Mesh::default();
        for z in planes[2] {
            for y in planes[1] {
                mesh.vertices.extend(planes[0].iter().map(|&x| Vec3::new(x, *y, *z)));
            }
        }
        let vertex = |c: [usize; 3]| (c[0] + counts[0] * (c[1] + counts[1] * c[2])) as u32;
        let is_filled = |c: [usize; 3]| (0..3).all(|a| c[a] < counts[a] - 1) && filled(c);
        for i in 0..counts.iter().map(|n| n - 1).product() {
            let c = [
                i % (counts[0] - 1),
                i / (counts[0] - 1) % (counts[1] - 1),
                i / (counts[0] - 1) / (counts[1] - 1),
            ];
            if !is_filled(c) {
                continue;
            }
            for a in 0..3 {
                let (u, v) = ((a + 1) % 3, (a + 2) % 3);
                for up in [false, true] {
                    let mut beyond = c;
                    beyond[a] = if up { c[a] + 1 } else { c[a].wrapping_sub(1) };
                    if is_filled(beyond) {
                        continue;
                    }
                    let corner = |du: usize, dv: usize| {
                        let mut at = c;
                        (at[a], at[u], at[v]) = (c[a] + usize::from(up), c[u] + du, c[v] + dv);
                        vertex(at)
                    };
                    let (b, d) = if up { ((1, 0), (0, 1)) } else { ((0, 1), (1, 0)) };
                    mesh.quad([corner(0, 0), corner(b.0, b.1), corner(1, 1), corner(d.0, d.1)]);
                }
            }
        }
        mesh
    }

    /// A seat, four legs and a back.
    pub(super) fn chair() -> Mesh {
        let across = [-0.5, -0.4, 0.4, 0.5];
        Mesh::cells([&across, &[0.0, 0.9, 1.0, 2.0], &across], |[x, y, z]| match y {
            0 => x != 1 && z != 1,
            1 => true,
            _ => z == 0,
        })
    }

    /// One of every kind, with random proportions.
    pub(super) fn random(kind: usize, random: &mut Random) -> Mesh {
        let mut number = |low: f32, high: f32| low + (high - low) * random.unit();
        let thin = number(0.1, 0.6);
        let (a, b, c) = (number(0.5, 2.0), number(0.5, 2.0), number(0.2, 1.0));
        let three = [0.0, thin, thin + a, 2.0 * thin + a];
        let up = [0.0, thin, thin + b];
        match kind % KINDS {
            0 => Mesh::torus(1.0, number(0.1, 0.7), number(8.0, 40.0) as u32, number(4.0, 16.0) as u32),
            1 => Mesh::cells([&three[..3], &up, &[0.0, c]], |[x, y, _]| x == 0 || y == 0),
            2 => Mesh::cells([&three, &up, &[0.0, c]], |[x, y, _]| x != 1 || y == 0),
            3 => Mesh::cells([&three, &up, &[0.0, c]], |[x, y, _]| x == 1 || y == 1),
            4 => Mesh::gear(number(5.0, 12.0) as u32, number(0.1, 0.4)),
            5 => Mesh::bowl(1.0, number(0.6, 0.9), number(8.0, 24.0) as u32),
            _ => Mesh::chair(),
        }
    }

    /// Scaled, turned and moved.
    pub(super) fn placed(mut self, scale: f32, turn: Quat, by: Vec3) -> Mesh {
        self.vertices.iter_mut().for_each(|v| *v = turn * (*v * scale) + by);
        self
    }

    /// Those that triangles use.
    pub(super) fn corners(&self) -> impl Iterator<Item = Vec3> {
        self.triangles.iter().flatten().map(|&v| self.vertices[v as usize])
    }

    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let (low, high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        self.corners().fold((low, high), |(low, high), v| (low.min(v), high.max(v)))
    }

    pub(super) fn volume(&self) -> f64 {
        let corners = self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize].as_dvec3()));
        let middle = self.vertices[0].as_dvec3();
        corners.map(|[a, b, c]| (a - middle).dot((b - middle).cross(c - middle)) / 6.0).sum()
    }

    /// How often the surface winds around a point: the sum of the solid angles of its triangles (Van Oosterom
    /// and Strackee, *The solid angle of a plane triangle*, 1983).
    pub(super) fn winding(&self, point: DVec3) -> f64 {
        let angle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.vertices[v as usize].as_dvec3() - point);
            let (x, y, z) = (a.length(), b.length(), c.length());
            let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
            2.0 * libm::atan2(a.dot(b.cross(c)), below)
        };
        self.triangles.iter().map(angle).sum::<f64>() / (2.0 * std::f64::consts::TAU)
    }
}

/// Of [`Mesh::random`].
pub(super) const KINDS: usize = 7;
