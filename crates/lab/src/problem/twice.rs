//! Numbers of twice the precision of `f64`, for residuals that rounding must not hide.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The arithmetic in which a residual is computed: `f64`, or [`Twice`].
pub(super) trait Real:
    Copy
    + PartialOrd
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The length of a vector with these two components.
    fn length(self, other: Self) -> Self;

    /// The greater one; the other one of NaN.
    fn most(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    /// The nearest number in a range.
    fn within(self, min: Self, max: Self) -> Self {
        let raised = if self < min { min } else { self };
        if raised > max { max } else { raised }
    }
}

impl Real for f64 {
    fn length(self, other: f64) -> f64 {
        self.hypot(other)
    }
}

/// The unevaluated sum of two `f64`, of which the second is at most half a unit in the last place of the
/// first (Dekker 1971). The operations have errors of a few units in the 104th bit; numbers must lie within
/// 1e-140..1e140 for products to be that exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twice {
    high: f64,
    low: f64,
}

impl Twice {
    /// The sum of two numbers without any error (Knuth).
    fn sum(a: f64, b: f64) -> Twice {
        let high = a + b;
        let part = high - a;
        let low = (a - (high - part)) + (b - part);
        // The sum of an infinite number has no error that could be computed.
        Twice { high, low: if high.is_finite() { low } else { 0.0 } }
    }

    /// The product of two numbers without any error (Dekker, Veltkamp).
    pub(super) fn product(a: f64, b: f64) -> Twice {
        let halves = |x: f64| {
            let scaled = 134_217_729.0 * x;
            let high = scaled - (scaled - x);
            (high, x - high)
        };
        let high = a * b;
        let ((a, c), (b, d)) = (halves(a), halves(b));
        let low = ((a * b - high) + a * d + c * b) + c * d;
        Twice { high, low: if low.is_finite() { low } else { 0.0 } }
    }

    /// The nearest `f64`.
    pub(super) fn rounded(self) -> f64 {
        self.high
    }

    fn square_root(self) -> Twice {
        if self.high <= 0.0 {
            return Twice::from(0.0);
        }
        let root = Twice::from(self.high.sqrt());
        // One step of Newton's method doubles the digits.
        root + (self - root * root) / (root + root)
    }
}

impl From<f64> for Twice {
    fn from(x: f64) -> Twice {
        Twice { high: x, low: 0.0 }
    }
}

impl Add for Twice {
    type Output = Twice;
    fn add(self, other: Twice) -> Twice {
        let (high, low) = (Twice::sum(self.high, other.high), Twice::sum(self.low, other.low));
        let first = Twice::sum(high.high, high.low + low.high);
        Twice::sum(first.high, first.low + low.low)
    }
}

impl Neg for Twice {
    type Output = Twice;
    fn neg(self) -> Twice {
        Twice { high: -self.high, low: -self.low }
    }
}

impl Sub for Twice {
    type Output = Twice;
    fn sub(self, other: Twice) -> Twice {
        self + -other
    }
}

impl Mul for Twice {
    type Output = Twice;
    fn mul(self, other: Twice) -> Twice {
        let product = Twice::product(self.high, other.high);
        Twice::sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Twice {
    type Output = Twice;
    fn div(self, other: Twice) -> Twice {
        let first = self.high / other.high;
        let rest = self - other * Twice::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Twice::from(second);
        Twice::sum(first, second) + Twice::from(rest.high / other.high)
    }
}

impl PartialOrd for Twice {
    fn partial_cmp(&self, other: &Twice) -> Option<Ordering> {
        let high = self.high.partial_cmp(&other.high)?;
        if high.is_eq() { self.low.partial_cmp(&other.low) } else { Some(high) }
    }
}

impl Real for Twice {
    fn length(self, other: Twice) -> Twice {
        (self * self + other * other).square_root()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_f64_loses_is_kept() {
        let big = Twice::from(1e16);
        assert_eq!(((big + Twice::from(1.0)) - big).rounded(), 1.0);
        let third = Twice::from(1.0) / Twice::from(3.0);
        let rest = third + third + third - Twice::from(1.0);
        assert!(rest.rounded().abs() < 1e-31, "{rest:?}");
        let root = Twice::from(2.0).square_root();
        assert!((root * root - Twice::from(2.0)).rounded().abs() < 1e-31);
        // (1 + e)(1 - e) is 1 - e².
        let e = 2.0_f64.powi(-40);
        assert_eq!((Twice::product(1.0 + e, 1.0 - e) - Twice::from(1.0)).rounded(), -e * e);
    }

    #[test]
    fn infinite_bounds_bound_nothing() {
        let (x, most) = (Twice::from(2.0), Twice::from(f64::INFINITY));
        assert_eq!((x - most).rounded(), f64::NEG_INFINITY);
        assert_eq!(Twice::from(3.0).within(x - most, x).rounded(), 2.0);
    }
}
