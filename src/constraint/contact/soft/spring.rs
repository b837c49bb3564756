//! The impulse of a one-sided damped spring over a substep, from where the surfaces are at its ends.

use crate::lanes::Lanes;

/// A spring along the normal of a point.
#[derive(Clone, Copy)]
pub(super) struct Spring<L> {
    /// Impulse in a substep per depth [N s/m].
    pub(super) rate: L,
    /// Force per speed [N s/m].
    pub(super) drag: L,
}

/// How a separation changes in a substep, without an impulse and with one.
#[derive(Clone, Copy)]
pub(super) struct Course<L> {
    /// At the start of the substep [m].
    pub(super) from: L,
    /// Its change without an impulse [m].
    pub(super) free_way: L,
    /// And by one [m/(N s)].
    pub(super) gain: L,
}

impl<L: Lanes> Spring<L> {
    /// The impulse [N s], at least zero.
    ///
    /// Over a way `d` from depth to depth, the spring takes as much energy as the potential of its ends says:
    /// its mean force is the change of that potential by `d`, a discrete gradient (Gonzalez, *Time
    /// Integration and Discrete Hamiltonian Systems*, 1996), which conserves energy if bodies move by the
    /// mean of their velocities at both ends. Where both ends are below the surface this is the implicit
    /// midpoint rule. Where the surface is crossed, only the way below it counts. The way depends on the
    /// impulse, so it is the root of a quadratic equation.
    #[inline(always)]
    pub(super) fn impulse(&self, course: &Course<L>) -> L {
        let (k, c) = (self.rate, self.drag);
        let &Course { from: x, free_way: way, gain } = course;
        let (half, zero, two) = (L::splat(0.5), L::zero(), L::splat(2.0));
        let both = half * k + c;
        let (square, yields) = (gain * k * x * x, L::one() + gain * both);
        // Below the surface all the way.
        let below = -(k * x + both * way) / yields;
        let leaves = (x + way + gain * below).gt(zero);
        // Out of it.
        let out = way + gain * c * x;
        let d = half * (out + (out * out + two * square).sqrt());
        let leaving = half * k * x * x / d + c * x;
        // Into it.
        let into = way - gain * x * (k + c);
        let d = half * (into - (into * into - two * yields * square).max(zero).sqrt()) / yields;
        let depth = (x + d).min(zero);
        let entering = -depth * (half * k * depth / d + c);
        let touches = x.le(zero);
        let inside = L::select(touches & leaves, leaving, below);
        let above = L::select((x + way).lt(zero), entering, zero);
        L::select(touches, inside, above).max(zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of 1 kg thrown at a spring of `hertz`, with substeps of `h`: its greatest depth, and its speed
    /// once it left.
    fn bounce(hertz: f32, zeta: f32, speed: f32, gap: f32, h: f32) -> (f32, f32) {
        let omega = std::f32::consts::TAU * hertz;
        let spring = Spring { rate: h * omega * omega, drag: (2.0 * zeta * omega).min(2.0 / h) };
        let (mut x, mut v, mut deepest) = (gap, -speed, 0.0_f32);
        while v < 0.0 || x < 0.0 {
            let course = Course { from: x, free_way: h * v, gain: 0.5 * h };
            let impulse = spring.impulse(&course);
            x += h * (v + 0.5 * impulse);
            v += impulse;
            deepest = deepest.min(x);
        }
        (-deepest, v)
    }

    /// By energy: the depth is v / omega, and the speed comes back, wherever in a substep the ball meets the
    /// surface.
    #[test]
    fn a_spring_without_damping_gives_back_what_it_took() {
        for h in [1.0 / 960.0, 1.0 / 240.0, 1.0 / 120.0] {
            for i in 0..50 {
                let gap = 1e-4 * i as f32;
                let (depth, speed) = bounce(10.0, 0.0, 3.0, gap, h);
                let expected = 3.0 / (std::f32::consts::TAU * 10.0);
                let within = 0.2 * (std::f32::consts::TAU * 10.0 * h).powi(2) + 1e-4;
                assert!((speed - 3.0).abs() < 2e-5, "{h} {gap}: {speed}");
                assert!((depth - expected).abs() < within * expected, "{h} {gap}: {depth} for {expected}");
                // Damping only takes.
                let damped = [0.1, 0.5, 1.0, 3.0].map(|zeta| bounce(10.0, zeta, 3.0, gap, h).1);
                assert!(damped[0] < 2.6 && damped.is_sorted_by(|a, b| a > b), "{h} {gap}: {damped:?}");
            }
        }
    }
}
