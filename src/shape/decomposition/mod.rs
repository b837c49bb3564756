//! Convex decomposition: a solid as a few convex hulls, so that a dynamic body can have its form.
//!
//! The box around a solid is cut by planes across its axes, always the piece whose hull has most volume
//! beyond the solid's, and there where the hulls of both sides become smallest ([`cut`]). The part of the
//! solid in a box is found exactly, without voxels ([`part`]), so hulls touch the surface, leave out nothing,
//! and can't overlap while they stay within their boxes. Then pieces are joined again where that costs least
//! ([`join`]). The order of work and the measure are those of V-HACD (Mamou, *Volumetric hierarchical
//! approximate convex decomposition*, 2016).

mod cut;
mod frame;
mod join;
mod part;
mod solid;

use super::mass::Moments;
use super::{ConvexHull, Geometry, MassProperties, ShapeDesc};
use crate::config::fields;
use crate::error::Error;
use glam::Vec3;
use part::Part;
use solid::Solid;
use std::sync::Arc;

fields! {
    /// How a closed triangle mesh is made of convex hulls, so that a dynamic body can have its form.
    ///
    /// ```
    /// use backstop::{BodyDesc, Decomposition, glam::Vec3};
    ///
    /// // An L: six corners at the front, six at the back.
    /// let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    /// let corners: Vec<Vec3> =
    ///     [1.0, 0.0].iter().flat_map(|&z| outline.map(|[x, y]| Vec3::new(x, y, z))).collect();
    /// let front = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    /// let back = front.map(|[a, b, c]| [a + 6, c + 6, b + 6]);
    /// let sides = (0..6).flat_map(|i| {
    ///     let next = (i + 1) % 6;
    ///     [[i, i + 6, next + 6], [i, next + 6, next]]
    /// });
    /// let triangles: Vec<[u32; 3]> = front.into_iter().chain(back).chain(sides).collect();
    ///
    /// let pieces = Decomposition::default().run(&corners, &triangles)?;
    /// let body = BodyDesc::dynamic().with_shapes(pieces.shapes()).with_mass(pieces.mass_properties(1000.0));
    /// assert_eq!((body.shapes.len(), pieces.volume()), (2, 5.0));
    /// assert!(pieces.excess() < 1e-6);
    /// # Ok::<(), backstop::Error>(())
    /// ```
    ///
    /// Equal input gives equal hulls, on every machine. A torus of 1000 triangles takes about half a second,
    /// one of 32,000, the most, half a minute. Keep hulls of levels as bytes (feature `bake`).
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct Decomposition {
        /// The most hulls.
        with_max_hulls(max_hulls: u32) = 32, "most hulls" [1.0, 256.0] "in 1..=256";
        /// Volume that the hulls may have beyond the solid's, as a share of it: while there is more, and
        /// fewer than the most hulls, there are more cuts.
        with_concavity(concavity: f32) = 0.02, "concavity" [0.0, 10.0] "in 0..=10";
        /// Planes that are tried along each axis of a piece.
        with_resolution(resolution: u32) = 16, "resolution" [1.0, 64.0] "in 1..=64";
    }
}

impl Decomposition {
    /// The most triangles.
    pub const MAX_TRIANGLES: usize = solid::MAX_TRIANGLES;

    /// Decomposes the solid that triangles enclose [m]; they wind counter-clockwise seen from outside, or all
    /// the other way round. It may be in several parts. Parts that overlap count twice in
    /// [`Pieces::volume`], and so does their mass.
    ///
    /// # Errors
    /// A number of these settings is out of its range; a coordinate is not finite or beyond 1e6; an index has
    /// no vertex; there are no triangles or too many; an edge does not have as many triangles on one side as
    /// on the other, so that the mesh is open or wound both ways; or it encloses no volume, or is thinner
    /// than a millionth of its size.
    pub fn run(&self, vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Pieces, Error> {
        self.check_ranges()?;
        let solid = Solid::new(vertices, triangles)?;
        let allowed = f64::from(self.concavity) * solid.volume();
        let most = self.max_hulls as usize;
        let parts = self.cut(&solid, allowed, 2 * most);
        let parts = join::join(parts, most, allowed, solid.volume());
        // A part that is thinner than the noise of its coordinates has no hull.
        let hulls: Vec<Arc<ConvexHull>> = parts
            .iter()
            .filter_map(|part| ConvexHull::new(&solid.frame.out_of(&part.points)).ok())
            .map(Arc::new)
            .collect();
        if hulls.is_empty() {
            return Err(Error::Degenerate("the mesh is too thin for a hull".into()));
        }
        Ok(Pieces { hulls, moments: solid.moments })
    }

    /// At least two and at most `most` parts of the solid, unless their hulls have no more than `allowed`
    /// beyond its volume with fewer.
    fn cut(&self, solid: &Solid, allowed: f64, most: usize) -> Vec<Part> {
        let (mut open, mut whole) = (vec![Part::whole(solid)], Vec::new());
        loop {
            let excess: f64 = open.iter().chain(&whole).map(Part::excess).sum();
            if excess <= allowed || open.len() + whole.len() >= most {
                break;
            }
            let worst = (0..open.len()).max_by(|&a, &b| open[a].excess().total_cmp(&open[b].excess()));
            let Some(worst) = worst else { break };
            let part = open.swap_remove(worst);
            match cut::best(solid, &part, self.resolution) {
                Some(plane) => open.extend(part.split(solid, plane)),
                None => whole.push(part),
            }
        }
        open.append(&mut whole);
        open
    }
}

/// What a [`Decomposition`] made of a mesh.
#[derive(Clone, Debug)]
pub struct Pieces {
    hulls: Vec<Arc<ConvexHull>>,
    /// Mass, centre and inertia of the mesh at a density of one.
    moments: Moments,
}

impl Pieces {
    /// The hulls, in the frame of the mesh.
    pub fn hulls(&self) -> &[Arc<ConvexHull>] {
        &self.hulls
    }

    /// A shape for each hull, with default material and density. The density of a body of these is that of
    /// the mesh only with [`Pieces::mass_properties`]: the sum of the hulls is heavier by
    /// [`Pieces::excess`].
    pub fn shapes(&self) -> impl ExactSizeIterator<Item = ShapeDesc> {
        self.hulls.iter().map(|hull| ShapeDesc::new(Geometry::Hull(hull.clone())))
    }

    /// Mass properties of the mesh itself at an even density [kg/m³]: for [`BodyDesc::with_mass`].
    ///
    /// [`BodyDesc::with_mass`]: crate::BodyDesc::with_mass
    pub fn mass_properties(&self, density: f32) -> MassProperties {
        MassProperties::of_moments(self.moments, density)
    }

    /// Volume of the mesh [m³].
    pub fn volume(&self) -> f32 {
        self.moments.mass as f32
    }

    /// Volume of all hulls together beyond that of the mesh, as a share of it. Where hulls overlap their
    /// union has less.
    pub fn excess(&self) -> f32 {
        let all: f64 = self.hulls.iter().map(|hull| hull.moments.mass).sum();
        (all / self.moments.mass - 1.0) as f32
    }
}
