//! The springs that push overlap apart.

/// A damped spring that pushes overlap apart, solved implicitly so that it is stable at any stiffness (Catto,
/// *Soft Constraints*, GDC 2011).
///
/// Such a spring yields under load: a stack becomes a column of springs, which sinks and, if it is high
/// enough, buckles. So a lasting force acts beside the spring, at each point its share
/// ([`PointRow::lasting`](super::batch::PointRow::lasting), `Contact::lasting_force`): the rest position of
/// the spring is where this force bears the load alone. Only deviations from it act on the springs, and
/// resist leaning. They act at any depth and also over a small gap, or a lean smaller than that would not be
/// corrected. Without a lasting force only overlap beyond the slop is pushed apart, and rows are rigid above
/// it, so that a new load meets no spring that it could press through something thin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Softness {
    /// Speed per overlap [1/s].
    pub(crate) bias_rate: f32,
    pub(crate) mass_scale: f32,
    pub(crate) impulse_scale: f32,
    /// Compression per impulse in a substep, for a row with an effective mass of 1 kg [m/(N s)].
    pub(crate) ease: f32,
}

impl Softness {
    /// Yields to nothing and pushes nothing apart: a spring with infinite damping.
    pub(crate) const RIGID: Softness =
        Softness { bias_rate: 0.0, mass_scale: 1.0, impulse_scale: 0.0, ease: 0.0 };

    /// A spring of `hertz` and damping ratio `zeta`; a rigid one if substeps of `h` seconds with so many
    /// passes are too long for it: see [`Softness::stiffest`], without the margin.
    pub(crate) fn for_substep(hertz: f32, zeta: f32, passes: u32, h: f32) -> Self {
        let spring = Self::new(hertz, zeta, h);
        if hertz > 1.5 * Self::stiffest(passes, h) { spring.locked() } else { spring }
    }

    /// A rigid one whose range ends where that of this one does.
    pub(crate) fn locked(self) -> Self {
        Softness { ease: self.ease, ..Self::RIGID }
    }

    /// The stiffest spring [Hz] for substeps of `h` seconds with so many passes over the rows.
    ///
    /// Gauss-Seidel couples a tall stack as a whole only after many substeps. For its slowest sway, the share
    /// `r` of the velocity error that a pass removes goes to zero; the push removes the share `b` of the
    /// overlap in a substep, and the share `y` of the impulse yields. With `p` passes the sway obeys s³ + (p
    /// r + y) s² + (p + b) r s + b r = 0, which by Routh decays for every r if and only if y > b / (p + b),
    /// and with `b` and `y` as below that is (2 pi hertz h)² < p. Two thirds of that frequency leave a
    /// margin.
    pub(crate) fn stiffest(passes: u32, h: f32) -> f32 {
        0.106 * (passes as f32).sqrt() / h
    }

    /// Spring of `hertz` and damping ratio `zeta`, for a substep of `h` seconds.
    pub(crate) fn new(hertz: f32, zeta: f32, h: f32) -> Self {
        let omega = 2.0 * std::f32::consts::PI * hertz;
        let a1 = 2.0 * zeta + h * omega;
        let a2 = h * omega * a1;
        let a3 = 1.0 / (1.0 + a2);
        let ease = 1.0 / (h * omega * omega);
        Softness { bias_rate: omega / a1, mass_scale: a2 * a3, impulse_scale: a3, ease }
    }
}
