//! The laws of contacts, friction and joints.

/// A relation that has to hold between impulse and velocity of one or more rows in sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// One row, `min <= r <= max` [N s]: `u = 0` between the bounds, `u >= 0` at `min`, `u <= 0` at `max`.
    /// Both infinite: a joint.
    Bounds {
        /// The least impulse; may be -inf.
        min: f64,
        /// The greatest impulse; may be inf.
        max: f64,
    },
    /// Three rows, normal and two tangents, with Coulomb's law on the exact cone (De Saxcé 1992): `r` in
    /// `K = {|r_t| <= mu r_n}`, `u + (mu |u_t|, 0, 0)` in its dual cone, and both perpendicular.
    Contact {
        /// Coefficient of friction, at least 0.
        mu: f64,
    },
    /// Two tangent rows and one of twist that share the friction of several normals, as the engine's friction
    /// patches do: `|r_t| <= mu N` against `u_t`, `|r_s| <= mu arm N` against `u_s`, where `N` is the sum of
    /// the normal impulses.
    Patch {
        /// Coefficient of friction, at least 0.
        mu: f64,
        /// Mean distance of the points from their middle [m].
        arm: f64,
        /// The first row of the normals, which are one row each, [`Law::AT_LEAST_ZERO`].
        first: usize,
        /// How many normals.
        count: usize,
    },
}

impl Law {
    /// `0 <= r`, `0 <= u`, `r u = 0`: a contact without friction, or a row of a linear complementarity
    /// problem.
    pub const AT_LEAST_ZERO: Law = Law::Bounds { min: 0.0, max: f64::INFINITY };
    /// `u = 0`, with any impulse.
    pub const LOCKED: Law = Law::Bounds { min: f64::NEG_INFINITY, max: f64::INFINITY };

    /// How many rows it takes.
    pub fn rows(&self) -> usize {
        match self {
            Law::Bounds { .. } => 1,
            Law::Contact { .. } | Law::Patch { .. } => 3,
        }
    }
}
