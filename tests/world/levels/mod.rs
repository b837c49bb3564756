//! Parts of levels: shapes from bytes, at another scale and with holes, descriptions from files.

use super::common;

mod baked;
mod descriptions;
mod heights;
mod holes;
mod materials;
mod scaled;
mod soft;
mod triggers;
