//! Why a call is refused, with the numbers that explain it. A refused call changes nothing.

use crate::memory::Category;
use std::fmt::{self, Display, Write};

/// Why a call was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The body was removed. Handles of another world are told from the world's own by nothing but slot and
    /// generation.
    #[error("the body handle is stale: its body was removed")]
    StaleBody,
    /// The shape or its body was removed; see [`Error::StaleBody`] for those of another world.
    #[error("the shape handle is stale: its shape was removed")]
    StaleShape,
    /// The joint broke, or it or one of its bodies was removed; see [`Error::StaleBody`] for those of another
    /// world.
    #[error("the joint handle is stale: its joint broke or was removed")]
    StaleJoint,
    /// The character was removed; see [`Error::StaleBody`] for those of another world.
    #[error("the character handle is stale: its character was removed")]
    StaleCharacter,
    /// A step panicked, in a hook of the caller's or by a defect of this library, and the state of the world
    /// is incomplete.
    #[error(
        "a step panicked in its stage \"{stage}\", so the world can't be stepped any more: restore a snapshot, or make a new one"
    )]
    Poisoned {
        /// Where: broad, narrow, prepare, solve or finish.
        stage: &'static str,
    },
    /// A joint needs two bodies.
    #[error("a joint can't join a body to itself")]
    JointToItself,
    /// A joint between bodies that nothing moves.
    #[error("a joint needs a dynamic body")]
    JointOfStill,
    /// A target for a motor which the joint does not have; see
    /// [`World::set_joint_motor`](crate::World::set_joint_motor).
    #[error("the joint has no motor of this motion along or about this axis")]
    NoMotor,
    /// The coupling broke, or it or one of its joints was removed; see [`Error::StaleBody`] for those of
    /// another world.
    #[error("the coupling handle is stale: its coupling broke or was removed")]
    StaleCoupling,
    /// A motion that can't be coupled, or not with the other one.
    #[error("a coupled motion must be {expected}")]
    CoupledMotion {
        /// The kind of motion that is expected.
        expected: &'static str,
    },
    /// A list that leaves something out.
    #[error("{what} must have {expected}")]
    Incomplete {
        /// Which list.
        what: &'static str,
        /// The missing part.
        expected: &'static str,
    },
    /// A number is NaN or infinite.
    #[error("{what} must be finite, but is {}", Shown(*value))]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number is outside its range.
    #[error("{what} must be {expected}, but is {}", Shown(*value))]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// The range in words.
        expected: &'static str,
        /// Its value.
        value: f64,
    },
    /// A list has the wrong length.
    #[error("there must be {expected} {what}, {each}, but there are {found}")]
    Count {
        /// The elements of the list.
        what: &'static str,
        /// The rule in words.
        each: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An index beyond the last of something.
    #[error("{what} must be below {count}, but is {index}")]
    Index {
        /// Which index.
        what: &'static str,
        /// It.
        index: usize,
        /// The number of elements.
        count: usize,
    },
    /// One of several is refused.
    #[error("{what} {index}: {source}")]
    One {
        /// Which list or array.
        what: &'static str,
        /// Its place among them, from 0.
        index: usize,
        /// Why.
        source: Box<Error>,
    },
    /// Points that span no volume, an empty mesh and the like.
    #[error("the shape is degenerate: {0}")]
    Degenerate(String),
    /// A shape that only a static body may have.
    #[error("a {shape} can only be on a static or kinematic body")]
    StaticOnly {
        /// The kind of shape.
        shape: &'static str,
    },
    /// A shape that a query can't move or place.
    #[error("a query's shape must be convex and bounded, which a {shape} is not")]
    NotConvex {
        /// The kind of shape.
        shape: &'static str,
    },
    /// A dynamic body needs mass: a shape with density, or mass that is given.
    #[error("a dynamic body needs mass: give it a shape with density above zero, or mass properties")]
    NoMass,
    /// Too many of something for its index type.
    #[error("too many {what}: at most {most}")]
    TooMany {
        /// The thing of which there are too many.
        what: &'static str,
        /// The limit.
        most: u64,
    },
    /// Bytes that are no snapshot, or no longer: cut off, changed, or with numbers that can't be.
    #[error("the snapshot is broken: {what}")]
    BrokenSnapshot {
        /// What is wrong.
        what: &'static str,
    },
    /// A snapshot of another version of its format.
    #[error("the snapshot has version {found} of its format, this is {expected}")]
    SnapshotVersion {
        /// The snapshot's.
        found: u32,
        /// What this version of backstop writes and reads.
        expected: u32,
    },
    /// Bytes that are no baked shape of this kind, or no longer: cut off, changed, or with numbers that can't
    /// be.
    #[error("the baked shape is broken: {what}")]
    BrokenShape {
        /// What is wrong.
        what: &'static str,
    },
    /// A baked shape of another version of its format: bake it again.
    #[error("the baked shape has version {found} of its format, this is {expected}")]
    ShapeVersion {
        /// The shape's.
        found: u16,
        /// What this version of backstop writes and reads.
        expected: u16,
    },
    /// A snapshot refers to something that the world does not have.
    #[error("the snapshot is of a world with {what}")]
    ForeignSnapshot {
        /// The difference.
        what: &'static str,
    },
    /// A request does not fit into the memory budget.
    #[error("the budget is exceeded: {asked} bytes are asked for, {left} are left (for {category})")]
    Budget {
        /// The one whose own limit is too low. If it is the limit of the whole: the one that asks for most.
        category: Category,
        /// Bytes asked for: by the category, or, if it is the whole that is short, by all.
        asked: usize,
        /// Bytes left of that limit.
        left: usize,
    },
}

impl Error {
    /// The cause without its place: the innermost of nested [`Error::One`].
    pub fn innermost(&self) -> &Error {
        match self {
            Error::One { source, .. } => source.innermost(),
            error => error,
        }
    }
}

/// A number with as many digits as tell it from its neighbours, in `f32` if it came from there.
struct Shown(f64);

impl Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let narrow = self.0 as f32;
        let text = if f64::from(narrow) == self.0 { format!("{narrow:?}") } else { format!("{:?}", self.0) };
        f.write_str(text.strip_suffix(".0").unwrap_or(&text))
    }
}

/// Checks each of several; an error says which it is about.
pub(crate) fn each<T>(
    what: &'static str,
    list: &[T],
    mut check: impl FnMut(&T) -> Result<(), Error>,
) -> Result<(), Error> {
    let several = list.len() > 1;
    list.iter().enumerate().try_for_each(|(index, one)| {
        check(one).map_err(|error| match several {
            true => Error::One { what, index, source: Box::new(error) },
            false => error,
        })
    })
}

/// Refuses a list that has not as many as it must.
pub(crate) fn count(
    what: &'static str,
    each: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Count { what, each, expected, found }) }
}

/// An index of one of so many, or an error that names it.
pub(crate) fn index(what: &'static str, index: usize, count: usize) -> Result<usize, Error> {
    if index < count { Ok(index) } else { Err(Error::Index { what, index, count }) }
}

/// Text from a file as a message shows it: control characters, line breaks among them, and those that turn
/// the direction of writing appear as `\u{..}`, so that no name can draw on a terminal or forge a line of a
/// log. Escaped text stays as it is when it is escaped again.
#[derive(Clone, Copy, Debug)]
pub struct Escaped<T>(pub T);

impl<T: Display> Display for Escaped<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(EscapingWriter(f), "{}", self.0)
    }
}

struct EscapingWriter<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl fmt::Write for EscapingWriter<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.chars().try_for_each(|c| match c {
            // Marks of direction and separators of lines are no control characters to Unicode.
            '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}' => {
                write!(self.0, "{}", c.escape_unicode())
            }
            c if c.is_control() => write!(self.0, "{}", c.escape_unicode()),
            c => self.0.write_char(c),
        })
    }
}

/// A finite number, or an error that names it.
///
/// # Errors
/// If it is not.
pub fn finite(what: &'static str, value: f32) -> Result<f32, Error> {
    if value.is_finite() { Ok(value) } else { Err(Error::NotFinite { what, value: value.into() }) }
}

/// A number in `low..=high`, or an error that names it.
///
/// # Errors
/// If it is not finite, or outside.
pub fn within(
    what: &'static str,
    value: f32,
    low: f32,
    high: f32,
    expected: &'static str,
) -> Result<f32, Error> {
    finite(what, value)?;
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(Error::OutOfRange { what, expected, value: value.into() })
    }
}

/// A number above zero, or an error that names it.
///
/// # Errors
/// If it is not finite, or not above zero.
pub fn positive(what: &'static str, value: f32) -> Result<f32, Error> {
    finite(what, value)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err(Error::OutOfRange { what, expected: "above zero", value: value.into() })
    }
}

/// A vector of finite numbers, or an error that names it.
///
/// # Errors
/// If one is not.
pub fn finite3(what: &'static str, v: glam::Vec3) -> Result<glam::Vec3, Error> {
    finite(what, v.x)?;
    finite(what, v.y)?;
    finite(what, v.z)?;
    Ok(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: as a person writes them, and no digits that come from a conversion.
    #[test]
    fn numbers_are_as_short_as_tell_them_apart() {
        let shown = [0.1f32.into(), 0.1, 8.0, -2.5, 3.4e38f32.into(), f64::NAN, f64::INFINITY, 1e-20];
        let expected = ["0.1", "0.1", "8", "-2.5", "3.4e38", "NaN", "inf", "1e-20"];
        assert_eq!(shown.map(|value| Shown(value).to_string()), expected);
    }

    #[test]
    fn an_error_about_one_of_several_says_which() {
        let check = |list: &[f32]| each("bone", list, |&radius| positive("radius", radius).map(drop));
        let error = check(&[1.0, 2.0, 0.0]).unwrap_err();
        assert_eq!(error.to_string(), "bone 2: radius must be above zero, but is 0");
        assert_eq!(Some(error.innermost()), check(&[0.0]).as_ref().err());
        let error = count("heights", "columns times rows", 108, 8).unwrap_err();
        assert_eq!(error.to_string(), "there must be 108 heights, columns times rows, but there are 8");
        let error = index("index of a vertex", 9, 9).unwrap_err();
        assert_eq!(error.to_string(), "index of a vertex must be below 9, but is 9");
    }

    /// Expected: by Unicode, U+001B, U+000A, U+0085 and U+202E; all else is as it was, and no digit is added.
    #[test]
    fn control_characters_are_escaped_once() {
        let escaped = Escaped("a\u{1b}[2J\nb\u{85}\u{202e}ä\\").to_string();
        assert_eq!(escaped, r"a\u{1b}[2J\u{a}b\u{85}\u{202e}ä\");
        assert_eq!(Escaped(&escaped).to_string(), escaped);
    }
}
