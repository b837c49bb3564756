//! Newton's methods: on a complementarity function of each row, and on the exact friction cone.

pub(super) mod cone_newton;
mod newton_fb;
mod newton_min;

pub use newton_fb::newton_fb;
pub use newton_min::newton_min;
