//! Energy of dynamic bodies, from masses by their shapes and densities.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyKind, MassProperties};
use backstop_lab::envelope::State;
use backstop_scene::Scene;

/// Mass properties of the bodies of a scene; none of bodies that aren't dynamic.
pub(super) struct Masses(Vec<Option<MassProperties>>);

impl Masses {
    pub(super) fn of(scene: &Scene) -> Masses {
        let of = |desc: &backstop::BodyDesc| {
            let parts: Vec<MassProperties> = desc
                .shapes
                .iter()
                .map(|s| MassProperties::of(&s.geometry, s.density).transformed(s.position, s.rotation))
                .collect();
            (desc.kind == BodyKind::Dynamic).then(|| MassProperties::combine(&parts))
        };
        Masses(scene.bodies.iter().map(|body| of(&body.desc)).collect())
    }

    /// Mass of all dynamic bodies [kg].
    pub(super) fn mass(&self) -> f64 {
        self.0.iter().flatten().map(|m| f64::from(m.mass)).sum()
    }

    /// Kinetic energy, and potential energy from y = 0 [J].
    pub(super) fn energy(&self, scene: &Scene, states: &[State]) -> f64 {
        let bodies = self.0.iter().zip(states).filter_map(|(mass, state)| Some((mass.as_ref()?, state)));
        bodies
            .map(|(m, state)| {
                let centre: DVec3 = state.position + (state.rotation * m.centre_of_mass).as_dvec3();
                let spin: Vec3 = state.rotation.conjugate() * state.angular;
                let moving = 0.5 * f64::from(m.mass) * state.linear.as_dvec3().length_squared();
                let turning = 0.5 * f64::from(spin.dot(m.inertia * spin));
                moving + turning - f64::from(m.mass) * scene.gravity.as_dvec3().dot(centre)
            })
            .sum()
    }
}
