//! Numbers of a pass over the rows that follow from the settings and the length of a substep.

use crate::config::tuning::{
    JOINT_DAMPING, JOINT_HERTZ, JOINT_PUSH_SPEED, LOAD_SHIFT_SPEED, STIFFEST_SPRING_SHARE,
};
use crate::config::{FrictionCone, Settings};
use crate::constraint::Recovery;
use crate::constraint::contact::row::Softness;

/// Numbers that all passes of a step share.
pub(super) struct PassParameters {
    /// 1 / substep [1/s].
    pub(super) inverse_h: f32,
    /// Springs of contacts between dynamic bodies, and of those with static ones.
    pub(super) dynamic: Softness,
    pub(super) fixed: Softness,
    /// See [`Pass`](crate::constraint::contact::row::Pass) for the next four.
    pub(super) push_speed: f32,
    pub(super) load_shift_speed: f32,
    pub(super) touch_distance: f32,
    pub(super) friction_box: bool,
    /// Spring of locked directions of joints.
    pub(super) joint: Softness,
    pub(super) recovery: Recovery,
}

impl PassParameters {
    /// For substeps of `h`, and springs tuned for those of `usual_h` [s].
    pub(super) fn new(settings: &Settings, usual_h: f32, h: f32) -> PassParameters {
        let (count, measures) = (settings.iterations + 1, settings.measures());
        let hertz = settings.contact_hertz.min(STIFFEST_SPRING_SHARE * Softness::stiffest(count, usual_h));
        // Contacts with static bodies are twice as stiff; both are too stiff for a substep, or none is.
        let spring = Softness::for_substep(hertz, settings.contact_damping, count, h);
        let fixed = Softness::new(2.0 * hertz, settings.contact_damping, h);
        let fixed = if spring.bias_rate > 0.0 { fixed } else { fixed.locked() };
        PassParameters {
            inverse_h: 1.0 / h,
            dynamic: spring,
            fixed,
            push_speed: measures.push_speed,
            load_shift_speed: LOAD_SHIFT_SPEED * measures.unit,
            touch_distance: measures.touch,
            friction_box: settings.friction_cone == FrictionCone::Box,
            joint: Softness::new(JOINT_HERTZ.min(Softness::stiffest(count, h)), JOINT_DAMPING, h),
            recovery: Recovery { linear: JOINT_PUSH_SPEED * measures.unit, angular: JOINT_PUSH_SPEED },
        }
    }
}
