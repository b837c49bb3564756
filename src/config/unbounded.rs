//! Numbers that may be infinite, for serde: formats of text such as JSON have no word for infinity.

use serde::de::{DeserializeOwned, Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

const INFINITY: &str = "infinity";
const NEGATIVE: &str = "-infinity";

/// A float of either width.
pub(crate) trait Number: Copy + Into<f64> + Serialize + DeserializeOwned {
    fn of(number: f64) -> Self;
}

impl Number for f32 {
    fn of(number: f64) -> f32 {
        number as f32
    }
}

impl Number for f64 {
    fn of(number: f64) -> f64 {
        number
    }
}

pub(crate) fn serialize<N: Number, S: Serializer>(number: &N, to: S) -> Result<S::Ok, S::Error> {
    match (*number).into() {
        f64::INFINITY if to.is_human_readable() => to.serialize_str(INFINITY),
        f64::NEG_INFINITY if to.is_human_readable() => to.serialize_str(NEGATIVE),
        _ => number.serialize(to),
    }
}

pub(crate) fn deserialize<'de, N: Number, D: Deserializer<'de>>(from: D) -> Result<N, D::Error> {
    if from.is_human_readable() {
        from.deserialize_any(NumberOrWord).map(N::of)
    } else {
        N::deserialize(from)
    }
}

/// One number of several.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
struct One<N: Number>(#[serde(with = "self")] N);

/// Two such numbers.
pub(crate) mod pair {
    use super::{Deserialize, Deserializer, Number, One, Serialize, Serializer};

    pub(crate) fn serialize<N: Number, S: Serializer>(pair: &[N; 2], to: S) -> Result<S::Ok, S::Error> {
        pair.map(One).serialize(to)
    }

    pub(crate) fn deserialize<'de, N: Number, D: Deserializer<'de>>(from: D) -> Result<[N; 2], D::Error> {
        Ok(<[One<N>; 2]>::deserialize(from)?.map(|one| one.0))
    }
}

/// Both ends of a range that need not be there.
pub(crate) mod range {
    use super::{Deserialize, Deserializer, Number, One, Serialize, Serializer};

    pub(crate) fn serialize<N: Number, S: Serializer>(
        range: &Option<[N; 2]>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        range.map(|ends| ends.map(One)).serialize(to)
    }

    pub(crate) fn deserialize<'de, N: Number, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<[N; 2]>, D::Error> {
        Ok(Option::<[One<N>; 2]>::deserialize(from)?.map(|ends| ends.map(|one| one.0)))
    }
}

struct NumberOrWord;

impl Visitor<'_> for NumberOrWord {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number, \"{INFINITY}\" or \"{NEGATIVE}\"")
    }
    fn visit_f64<E: Error>(self, number: f64) -> Result<f64, E> {
        Ok(number)
    }
    fn visit_i64<E: Error>(self, number: i64) -> Result<f64, E> {
        Ok(number as f64)
    }
    fn visit_u64<E: Error>(self, number: u64) -> Result<f64, E> {
        Ok(number as f64)
    }
    fn visit_str<E: Error>(self, word: &str) -> Result<f64, E> {
        match word {
            INFINITY => Ok(f64::INFINITY),
            NEGATIVE => Ok(f64::NEG_INFINITY),
            _ => Err(E::invalid_value(serde::de::Unexpected::Str(word), &self)),
        }
    }
}
