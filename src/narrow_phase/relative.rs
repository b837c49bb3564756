//! Poses of one shape in the frame of another. From here on nothing knows where in the world a pair is.

use crate::body::Pose;
use crate::broad_phase::Pair;
use crate::lanes::{Lanes, Quat, Vec3};
use crate::shape::support;
use glam::DMat3;

/// Pose of shape `b` in the frame of shape `a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relative {
    pub(crate) position: glam::Vec3,
    pub(crate) rotation: crate::math::Quat,
}

impl Relative {
    /// Of a shape in its own frame.
    pub(crate) const IDENTITY: Relative =
        Relative { position: glam::Vec3::ZERO, rotation: crate::math::Quat::IDENTITY };

    /// Pose of `a` in the frame of `b`.
    #[inline]
    pub(crate) fn inverse(&self) -> Relative {
        let rotation = self.rotation.conjugate();
        Relative { position: -(rotation * self.position), rotation }
    }

    /// The same in `f64`.
    #[inline]
    pub(crate) fn exact(&self) -> support::Pose {
        let rotation = DMat3::from_quat(self.rotation.as_dquat().normalize());
        support::Pose { rotation, position: self.position.as_dvec3() }
    }
}

/// Pose of `b` in `a` for `L::N` pairs: lane `i` of `pair(i)`.
#[inline(always)]
pub(crate) fn relative_poses<L: Lanes>(pair: &impl Fn(usize) -> Pair, poses: &[Pose]) -> (Vec3<L>, Quat<L>) {
    let a = |i: usize| &poses[pair(i).a as usize];
    let b = |i: usize| &poses[pair(i).b as usize];
    let qa = Quat::<L>::from_fn(|i| a(i).rotation).conjugate();
    let qb = Quat::<L>::from_fn(|i| b(i).rotation);
    // The difference is taken in f64 and then rounded: exact for near pairs wherever in the world they are.
    let position = qa.rotate(Vec3::from_fn(|i| (b(i).position - a(i).position).as_vec3()));
    (position, qa.compose(qb))
}

/// The lanes, as single poses.
#[inline(always)]
pub(crate) fn lanes_of<L: Lanes>((position, rotation): &(Vec3<L>, Quat<L>)) -> [Relative; 8] {
    let mut columns = [[0.0; 8]; 7];
    let lanes = [position.x, position.y, position.z, rotation.v.x, rotation.v.y, rotation.v.z, rotation.w];
    for (column, lanes) in columns.iter_mut().zip(lanes) {
        lanes.store(column);
    }
    let [x, y, z, i, j, k, w] = columns;
    std::array::from_fn(|n| Relative {
        position: glam::Vec3::new(x[n], y[n], z[n]),
        rotation: crate::math::Quat::from_xyzw(i[n], j[n], k[n], w[n]),
    })
}

/// Pose of `b` in `a`.
pub(crate) fn relative_pose(pair: &Pair, poses: &[Pose]) -> Relative {
    let (position, rotation) = relative_poses::<f32>(&|_| *pair, poses);
    let glam::Vec3 { x, y, z } = rotation.v.lane(0);
    Relative { position: position.lane(0), rotation: crate::math::Quat::from_xyzw(x, y, z, rotation.w) }
}
