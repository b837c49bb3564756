//! Parsers of option values.

use backstop::glam::Vec3;
use backstop_lab::WorldMethod;
use backstop_lab::impacts::Law;
use backstop_lab::methods::{Friction, Method};
use backstop_lab::simbench::Test;
use backstop_lab::structures::Structure;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub(crate) fn number(text: &str) -> Result<f32, String> {
    let value: f32 = text.trim().parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("\"{text}\" is not finite")) }
}

pub(crate) fn positive(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if value > 0.0 { Ok(value) } else { Err("must be above zero".into()) }
}

pub(crate) fn hertz(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if (1.0..=1e6).contains(&value) { Ok(value) } else { Err("must be in 1..=1000000".into()) }
}

/// Values of a setting, by the names that its type has in JSON.
pub(crate) fn named<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_value(Value::from(text)).map_err(|error| {
        // "unknown variant `x`, expected one of `a`, `b`, `c`"
        let error = error.to_string();
        let names: Vec<&str> = error.split('`').skip(3).step_by(2).collect();
        match names.split_last() {
            Some((last, others)) if !others.is_empty() => format!("must be {} or {last}", others.join(", ")),
            _ => error,
        }
    })
}

/// A setting by its name: its value in JSON, without the quotes of names.
pub(crate) fn setting(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| "must be like slop=0.01".to_owned())?;
    Ok((name.into(), serde_json::from_str(value).unwrap_or_else(|_| Value::from(value))))
}

pub(crate) fn solver(text: &str) -> Result<&'static Method, String> {
    let names = || Method::ALL.iter().map(|method| method.name).collect::<Vec<_>>().join(", ");
    Method::by_name(text).ok_or_else(|| format!("must be one of {}", names()))
}

pub(crate) fn structure(text: &str) -> Result<Structure, String> {
    let names = || Structure::ALL.map(Structure::name).join(", ");
    Structure::named(text).ok_or_else(|| format!("must be one of {}", names()))
}

/// A method of the lab, or the engine's own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnyMethod(pub(crate) Option<WorldMethod>);

impl AnyMethod {
    /// Name of the engine's own solver.
    pub(crate) const OWN: &str = "backstop";

    pub(crate) fn name(self) -> &'static str {
        self.0.map_or(AnyMethod::OWN, |method| method.name())
    }
}

pub(crate) fn any_method(text: &str) -> Result<AnyMethod, String> {
    if text == AnyMethod::OWN {
        Ok(AnyMethod(None))
    } else {
        let method = world_method(text).map_err(|why| why.replacen("one of", "backstop or one of", 1))?;
        Ok(AnyMethod(Some(method)))
    }
}

pub(crate) fn simbench_test(text: &str) -> Result<Test, String> {
    let names = || Test::ALL.map(Test::name).join(", ");
    Test::named(text).ok_or_else(|| format!("must be one of {}", names()))
}

pub(crate) fn law(text: &str) -> Result<Law, String> {
    let names = || Law::ALL.map(Law::name).join(", ");
    Law::by_name(text).ok_or_else(|| format!("must be one of {}", names()))
}

pub(crate) fn world_method(text: &str) -> Result<WorldMethod, String> {
    let names = || WorldMethod::names().collect::<Vec<_>>().join(", ");
    WorldMethod::by_name(text).ok_or_else(|| format!("must be one of {}", names()))
}

pub(crate) fn friction(text: &str) -> Result<Friction, String> {
    match text {
        "cone" => Ok(Friction::Cone),
        "pyramid" => Ok(Friction::Pyramid),
        "box" => Ok(Friction::Box),
        _ => Err("must be cone, pyramid or box".into()),
    }
}

pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|x: &f64| *x >= 0.0 && x.is_finite())
        .ok_or_else(|| "must be a number that is at least 0".into())
}

pub(crate) fn relaxation(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| (0.01..=1.99).contains(x)).ok_or_else(|| "must be in 0.01..=1.99".into())
}

pub(crate) fn seconds(text: &str) -> Result<f32, String> {
    let value = match text.split_once('/') {
        Some((over, under)) => number(over)? / number(under)?,
        None => number(text)?,
    };
    // A step of more than a second is useless, one below a microsecond never gets anywhere.
    if (1e-6..=1.0).contains(&value) { Ok(value) } else { Err("must be in 0.000001..=1".into()) }
}

pub(crate) fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=1024) => Ok(n),
        _ => Err("must be a whole number in 1..=1024".into()),
    }
}

/// A number of bodies: as many as a file may have (`LoadLimits`).
pub(crate) fn crowd(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 0..=1_000_000) => Ok(n),
        _ => Err("must be a whole number in 0..=1000000".into()),
    }
}

/// So many that a million a second take a quarter of an hour.
pub(crate) fn shots(text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(n @ 0..=1_000_000_000) => Ok(n),
        _ => Err("must be a whole number in 0..=1000000000".into()),
    }
}

pub(crate) fn gravity(text: &str) -> Result<Vec3, String> {
    let parts: Vec<f32> = text.split(',').map(number).collect::<Result<_, _>>()?;
    match parts[..] {
        // A single number is the strength of gravity, with either sign.
        [down] => Ok(Vec3::new(0.0, -down.abs(), 0.0)),
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err("wants one number or three, with commas between them".into()),
    }
}

pub(crate) fn bytes(text: &str) -> Result<usize, String> {
    let text = text.trim();
    let units = [("KiB", 10), ("MiB", 20), ("GiB", 30)];
    let unit = units.into_iter().find_map(|(name, shift)| text.strip_suffix(name).map(|rest| (rest, shift)));
    let (number, shift) = unit.unwrap_or((text, 0));
    let number = number.trim();
    let wrong = || format!("\"{text}\" is no number of bytes, like 4096, 512KiB or 1.5MiB");
    if shift == 0 {
        return number.parse().map_err(|_| wrong());
    }
    let value: f64 = number.parse().map_err(|_| wrong())?;
    let value = value * f64::from(1u32 << shift);
    if (0.0..=1e15).contains(&value) { Ok(value as usize) } else { Err(wrong()) }
}

/// One of some names.
pub(crate) fn named_of<T: Copy>(text: &str, all: &[(&str, T)]) -> Result<T, String> {
    let names = || all.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    all.iter()
        .find(|(name, _)| *name == text)
        .map(|one| one.1)
        .ok_or_else(|| format!("must be one of {}", names()))
}

/// A number of at least zero, which is finite.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0).ok_or_else(|| "must be at least 0".into())
}

/// A number above zero, which is finite.
pub(crate) fn positive_f64(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0).ok_or_else(|| "must be above 0".into())
}
