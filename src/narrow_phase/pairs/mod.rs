//! Kernels of pairs of shapes, in lanes: a file a pair.

pub(crate) mod box_apart;
pub(crate) mod box_box;
pub(crate) mod box_face;
pub(crate) mod capsule_box;
pub(crate) mod capsule_capsule;
pub(crate) mod lanes_io;
pub(crate) mod sphere_box;
pub(crate) mod sphere_capsule;
pub(crate) mod sphere_sphere;
