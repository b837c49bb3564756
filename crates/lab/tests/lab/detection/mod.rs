//! Which contact points there are, and when.

mod reduction;
mod retroactive;
