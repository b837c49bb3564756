//! Values out of bytes: usual ones most of the time, so that what is behind a check is reached too.

use arbitrary::Unstructured;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{ConvexHull, Geometry, TriangleMesh};
use std::sync::Arc;

/// Bytes that are read as values; zeros when they have ended.
pub struct Input<'a>(pub Unstructured<'a>);

impl Input<'_> {
    pub fn new(bytes: &[u8]) -> Input<'_> {
        Input(Unstructured::new(bytes))
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or_default()
    }

    pub fn bool(&mut self) -> bool {
        self.byte() & 1 != 0
    }

    /// Below `end`, which is at least one.
    pub fn below(&mut self, end: usize) -> usize {
        self.0.arbitrary::<u32>().unwrap_or_default() as usize % end
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[usize::from(self.byte()) % from.len()]
    }

    /// Any bits once in a while, an extreme one now and then, else within ±8.
    pub fn number(&mut self) -> f32 {
        const EXTREMES: [f32; 16] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            1e-45,
            1e-38,
            1e-6,
            1e6,
            -1e6,
            1e9,
            1e18,
            f32::MAX,
            f32::INFINITY,
            f32::NAN,
            f32::NEG_INFINITY,
        ];
        match self.byte() {
            0..=3 => f32::from_bits(self.0.arbitrary().unwrap_or_default()),
            4..=11 => self.pick(&EXTREMES),
            _ => f32::from(self.0.arbitrary::<i16>().unwrap_or_default()) / 4096.0,
        }
    }

    /// The same above zero, if it is usual.
    pub fn size(&mut self) -> f32 {
        match self.byte() {
            0..=11 => self.number(),
            byte => 0.02 + f32::from(byte) / 128.0,
        }
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    pub fn place(&mut self) -> DVec3 {
        match self.byte() {
            0 => DVec3::splat(f64::from_bits(self.0.arbitrary().unwrap_or_default())),
            _ => self.vector().as_dvec3(),
        }
    }

    pub fn rotation(&mut self) -> Quat {
        let q = Quat::from_xyzw(self.number(), self.number(), self.number(), self.number());
        match self.byte() {
            0..=3 => q,
            _ if q.is_finite() && q.length() > 1e-3 && q.length() < 1e18 => q.normalize(),
            _ => Quat::IDENTITY,
        }
    }

    pub fn points(&mut self, most: usize) -> Vec<Vec3> {
        (0..self.below(most)).map(|_| self.vector()).collect()
    }

    pub fn geometry(&mut self) -> Geometry {
        match self.below(9) {
            0 => Geometry::Sphere { radius: self.size() },
            1 => Geometry::Capsule {
                half_height: self.size(),
                radius_bottom: self.size(),
                radius_top: self.size(),
            },
            2 | 3 => Geometry::cuboid(self.size(), self.size(), self.size()),
            4 => Geometry::Cylinder {
                half_height: self.size(),
                radius_bottom: self.size(),
                radius_top: self.size(),
            },
            5 => Geometry::Plane,
            6 => match ConvexHull::new(&self.points(20)) {
                Ok(hull) => Geometry::Hull(Arc::new(hull)),
                Err(_) => Geometry::cuboid(0.5, 0.5, 0.5),
            },
            7 => {
                let vertices = self.points(12);
                let corner = |input: &mut Self| input.below(vertices.len().max(1)) as u32;
                let triangles = (0..self.below(12)).map(|_| [corner(self), corner(self), corner(self)]);
                match TriangleMesh::new(vertices.clone(), triangles.collect()) {
                    Ok(mesh) => Geometry::Mesh(Arc::new(mesh)),
                    Err(_) => Geometry::Plane,
                }
            }
            _ => Geometry::capsule(self.size(), self.size()),
        }
    }
}
