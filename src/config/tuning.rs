//! Numbers that are chosen once for all worlds, each with its unit and with what it balances.
//!
//! Lengths are shares of [`Settings::length_unit`](super::Settings::length_unit). A number that one stage
//! alone reads stands in that stage.

/// Below this many bodies that can move, handing work to threads costs more than it saves (benches/steps.rs).
pub(crate) const MIN_THREADED_BODIES: usize = if cfg!(miri) { 2 } else { 128 };

/// A separation up to this counts as touching [length units]. It covers the gaps that springs of contacts at rest leave: less,
/// and what rests would count as apart; more, and what hovers would rub, carry loads and be heard of.
pub(crate) const TOUCH_DISTANCE: f32 = 0.002;

/// Contact points nearer than this are always kept [length units]: more costs rows that never push, less has slow bodies meet
/// without a row.
pub(crate) const CONTACT_MARGIN: f32 = 0.01;

/// Relative motion in a step above which a pair that is apart is cast [length units]: what moves less is within the margin at
/// the start of the step, and a cast would cost more than the points that it spares.
pub(crate) const CAST_MOTION: f32 = 0.01;

/// How far a pair may move before its contact is looked for again [length units]: further saves narrow phases and leaves
/// normals and points that are older.
pub(crate) const RECYCLE_DISTANCE: f32 = 0.005;

/// Slip speed below which friction is static [m/s per length unit]: above what the solver leaves of what rests, below what
/// anyone sees slide.
pub(crate) const STATIC_SLIP_SPEED: f32 = 0.01;

/// Time in which a load of a joint becomes one that it bears rigidly [s]: shorter, and the load of a passing impact counts;
/// longer, and a chain that is hung up stretches for longer.
pub(crate) const JOINT_HOLD_TIME: f32 = 1.0;

/// Friction of an impact that changes the slip by more than this shifts the load that a contact is taken to bear
/// [m/s per length unit]: less, and what rests and rattles loses its load; more, and what an impact pushed aside keeps one that
/// it no longer bears.
pub(crate) const LOAD_SHIFT_SPEED: f32 = 0.25;
