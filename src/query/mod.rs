//! Questions about shapes that change nothing.

mod segment;
