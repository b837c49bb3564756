//! Descriptions from one list of their fields.

/// A field of a description, as an editor shows it: [`Material::FIELDS`](crate::Material::FIELDS) and others
/// are made of the same list as the fields themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Field {
    /// Its name in Rust, in C and in JSON.
    pub name: &'static str,
    /// Its description in Markdown: a paragraph, and others with details.
    pub about: &'static str,
    /// Which values it may have, in the words of the error that refuses others.
    pub range: Option<&'static str>,
    /// Its default, as an expression in Rust.
    pub default: Option<&'static str>,
}

impl Field {
    /// Its unit, if it has one.
    pub fn unit(&self) -> Option<&'static str> {
        // A bracket before a parenthesis or a backquote is a link.
        let mut rest = self.about;
        while let Some((unit, after)) = rest.split_once('[').and_then(|(_, rest)| rest.split_once(']')) {
            if !unit.starts_with('`') && !after.starts_with('(') {
                return Some(unit);
            }
            rest = after;
        }
        None
    }
}

/// Makes a struct of a list of its fields: itself, its default, a method `with_FIELD` for each, a check of
/// all ranges, and the table `FIELDS`.
///
/// An entry has the field's sentences, then `with_FIELD(FIELD: TYPE) = DEFAULT`, and for numbers its name in
/// errors, the least and the greatest value, and the range in words. After `TYPE, into` the method takes any
/// value that converts to the type: three numbers make a vector. `_` for its name: there is none.
macro_rules! fields {
    ($(#[$meta:meta])* pub struct $of:ident { $(
        $(#[doc = $doc:literal])+
        $(#[cfg_attr($($attr:tt)+)])?
        $(_)? $($with:ident)? ($field:ident: $kind:ty $(, $into:ident)?) = $default:expr
            $(, $what:literal [$low:expr, $high:expr] $range:literal)?;
    )+ }) => {
        $(#[$meta])*
        pub struct $of {
            $(
                $(#[doc = $doc])+
                ///
                #[doc = concat!($("Must be ", $range, ". ",)? "Default: `", stringify!($default), "`.")]
                $(#[cfg_attr($($attr)+)])?
                pub $field: $kind,
            )+
        }

        impl Default for $of {
            fn default() -> Self {
                $of { $($field: $default),+ }
            }
        }

        $crate::config::fields! { @table $of $(
            $field, concat!($($doc, "\n"),+), [$($range)?], [stringify!($default)];
        )+ }

        impl $of {
            $($crate::config::fields! { @with [$($with)?] $field: $kind $(, $into)? })+

            /// Checks all ranges of the list.
            #[allow(dead_code, reason = "not every list has ranges")]
            pub(crate) fn check_ranges(&self) -> Result<(), $crate::error::Error> {
                $($($crate::limits::Ranged::check(self.$field, $what, [$low, $high], $range)?;)?)+
                Ok(())
            }
        }
    };
    // For reports only: no defaults, no ranges, no methods.
    ($(#[$meta:meta])* pub struct $of:ident {
        $($(#[doc = $doc:literal])+ pub $field:ident: $kind:ty,)+
    }) => {
        $(#[$meta])*
        pub struct $of { $($(#[doc = $doc])+ pub $field: $kind,)+ }

        $crate::config::fields! { @table $of $($field, concat!($($doc, "\n"),+), [], [];)+ }
    };
    (@table $of:ident $($field:ident, $about:expr, [$($range:expr)?], [$($default:expr)?];)+) => {
        impl $of {
            /// Its fields, in this order.
            pub const FIELDS: &'static [$crate::Field] = &[$($crate::Field {
                name: stringify!($field),
                about: $about,
                range: $crate::config::fields!(@maybe $($range)?),
                default: $crate::config::fields!(@maybe $($default)?),
            }),+];
        }
    };
    (@maybe) => { None };
    (@maybe $text:expr) => { Some($text) };
    // Methods alone.
    ($of:ident { $($with:ident($field:ident: $kind:ty $(, $into:ident)?)),+ $(,)? }) => {
        impl $of {
            $($crate::config::fields! { @with [$with] $field: $kind $(, $into)? })+
        }
    };
    (@with [] $field:ident: $kind:ty) => {};
    (@with [$with:ident] $field:ident: $kind:ty, into) => {
        $crate::config::fields! { @method $with $field (impl Into<$kind>) $field.into() }
    };
    (@with [$with:ident] $field:ident: $kind:ty) => {
        $crate::config::fields! { @method $with $field ($kind) $field }
    };
    (@method $with:ident $field:ident ($($kind:tt)+) $value:expr) => {
        #[doc = concat!(
            "The same with another [`",
            stringify!($field),
            "`](Self#structfield.",
            stringify!($field),
            ")."
        )]
        #[must_use]
        pub fn $with(mut self, $field: $($kind)+) -> Self {
            self.$field = $value;
            self
        }
    };
}
pub(crate) use fields;

#[cfg(test)]
mod tests {
    use super::Field;
    use crate::shape::RareMaterial;
    use crate::{Material, Settings, StepReport};

    fn named<'a>(fields: &'a [Field], name: &str) -> &'a Field {
        fields.iter().find(|field| field.name == name).unwrap()
    }

    #[test]
    fn a_field_says_unit_range_and_default() {
        let field = named(Material::FIELDS, "rolling_friction");
        assert_eq!(
            (field.unit(), field.range, field.default),
            (Some("m"), Some("in 0..=1e6 m"), Some("0.0"))
        );
        // Its first bracket is a link.
        assert_eq!(named(Settings::FIELDS, "contact_hertz").unit(), Some("Hz"));
        assert_eq!(named(StepReport::FIELDS, "faulted").unit(), None);
    }

    /// The pages have each setting, and each part of a material that glTF has no name for, with its unit.
    #[test]
    fn no_field_is_missing_in_the_pages() {
        let page = include_str!("../../docs/json.md");
        for field in Settings::FIELDS {
            let unit = field.unit().map_or(String::new(), |unit| format!(" [{unit}]"));
            assert!(page.contains(&format!("`{}`{unit}", field.name)), "docs/json.md lacks {}", field.name);
        }
        let page = include_str!("../../docs/levels.md");
        for name in RareMaterial::NAMES {
            let mut words = name.split('_');
            let first = words.next().unwrap_or_default().to_owned();
            let name = words.fold(first, |all, word| all + &word[..1].to_uppercase() + &word[1..]);
            assert!(page.contains(&format!("`{name}`")), "docs/levels.md lacks {name}");
        }
    }
}
