//! Numbers that may be infinite, for serde: formats of text such as JSON have no word for infinity.

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serializer};
use std::fmt;

const INFINITY: &str = "infinity";
const NEGATIVE: &str = "-infinity";

pub(crate) fn serialize<S: Serializer>(number: &f32, to: S) -> Result<S::Ok, S::Error> {
    match *number {
        f32::INFINITY if to.is_human_readable() => to.serialize_str(INFINITY),
        f32::NEG_INFINITY if to.is_human_readable() => to.serialize_str(NEGATIVE),
        number => to.serialize_f32(number),
    }
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    if from.is_human_readable() { from.deserialize_any(NumberOrWord) } else { f32::deserialize(from) }
}

struct NumberOrWord;

impl Visitor<'_> for NumberOrWord {
    type Value = f32;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number, \"{INFINITY}\" or \"{NEGATIVE}\"")
    }
    fn visit_f64<E: Error>(self, number: f64) -> Result<f32, E> {
        Ok(number as f32)
    }
    fn visit_i64<E: Error>(self, number: i64) -> Result<f32, E> {
        Ok(number as f32)
    }
    fn visit_u64<E: Error>(self, number: u64) -> Result<f32, E> {
        Ok(number as f32)
    }
    fn visit_str<E: Error>(self, word: &str) -> Result<f32, E> {
        match word {
            INFINITY => Ok(f32::INFINITY),
            NEGATIVE => Ok(f32::NEG_INFINITY),
            _ => Err(E::invalid_value(serde::de::Unexpected::Str(word), &self)),
        }
    }
}
