//! What games write again and again: explosions, grabs, cars, forces of fluids, levels of detail.

mod at_random;
mod character_body;
mod explosion;
mod fields;
mod grab;
mod level_of_detail;
mod torque;
mod vehicle;
