//! Settings and tunables in length units, converted to metres.

use super::Settings;
use super::tuning::{CONTACT_MARGIN, STATIC_SLIP_SPEED, TOUCH_DISTANCE};

/// Lengths and speeds of a world that several stages need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    /// The length unit [m].
    pub(crate) unit: f32,
    /// A point with a separation up to this touches [m].
    pub(crate) touch: f32,
    /// Points nearer than this are always found [m].
    pub(crate) margin: f32,
    /// Overlap that is left as it is [m].
    pub(crate) slop: f32,
    /// Slip speed below which friction is static [m/s].
    pub(crate) static_slip_speed: f32,
    /// The speed at which overlap is pushed apart, at most [m/s].
    pub(crate) push_speed: f32,
    /// Impacts slower than this do not bounce [m/s].
    pub(crate) bounce_speed: f32,
}

impl Settings {
    pub(crate) fn measures(&self) -> Measures {
        let unit = self.length_unit;
        Measures {
            unit,
            touch: TOUCH_DISTANCE * unit,
            margin: CONTACT_MARGIN * unit,
            slop: self.slop * unit,
            static_slip_speed: STATIC_SLIP_SPEED * unit,
            push_speed: self.push_speed * unit,
            bounce_speed: self.restitution_threshold * unit,
        }
    }
}
