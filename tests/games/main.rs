//! What games write again and again: explosions, grabs, cars, forces of fluids, levels of detail.

mod explosion;
mod grab;
