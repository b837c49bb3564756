//! A pass over the rows of contacts.

use super::friction::RollingRow;
use super::rows::Surface;
use super::soft::SoftRow;
use super::softness::Softness;
use crate::threads::Shared;

/// Parameters of a pass over the rows.
#[derive(Clone, Copy)]
pub(crate) struct Pass<'a> {
    /// 1 / substep [1/s].
    pub(crate) inverse_h: f32,
    pub(crate) softness: Softness,
    /// Maximum speed at which overlap is pushed apart [m/s].
    pub(crate) push_speed: f32,
    /// Friction of an impact that changes the slip by more than this shifts loads [m/s].
    pub(crate) load_shift_speed: f32,
    /// A point with a separation up to this touches: its impulse bounds friction [m].
    pub(crate) touch_distance: f32,
    /// Friction as a box instead of a cone.
    pub(crate) friction_box: bool,
    /// Remove the velocities that pushing overlap apart added.
    pub(crate) relax: bool,
    /// See [`Rows::surfaces`](crate::constraint::Rows::surfaces).
    pub(crate) surfaces: &'a [Surface],
    /// See [`Rows::rolling`](crate::constraint::Rows::rolling).
    pub(crate) rolling: &'a Shared<'a, RollingRow>,
    /// See [`Rows::soft`](crate::constraint::Rows::soft).
    pub(crate) soft: &'a Shared<'a, SoftRow>,
}
