//! Contacts: bouncing, friction, sliding, parting, and extreme masses.

mod belts;
mod eccentric;
mod elastic;
mod extremes;
mod friction;
mod impact;
mod other_sizes;
mod overlap;
mod restitution;
mod rolling;
mod sliding;
mod soft;
