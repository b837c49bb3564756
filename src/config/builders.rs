//! Methods of descriptions that return the same one with another value of a field.

/// Makes a method `with_FIELD` for each field that is listed. A value `into` a type may be whatever converts
/// to it: three numbers make a vector.
macro_rules! with_fields {
    ($of:ident { $($with:ident($field:ident: $($kind:tt)+)),+ $(,)? }) => {
        impl $of {
            $($crate::config::with_fields! { @one $with $field: $($kind)+ })+
        }
    };
    (@one $with:ident $field:ident: into $kind:ty) => {
        #[doc = concat!(
            "The same with another [`",
            stringify!($field),
            "`](Self#structfield.",
            stringify!($field),
            ")."
        )]
        #[must_use]
        pub fn $with(mut self, $field: impl Into<$kind>) -> Self {
            self.$field = $field.into();
            self
        }
    };
    (@one $with:ident $field:ident: $kind:ty) => {
        #[doc = concat!(
            "The same with another [`",
            stringify!($field),
            "`](Self#structfield.",
            stringify!($field),
            ")."
        )]
        #[must_use]
        pub fn $with(mut self, $field: $kind) -> Self {
            self.$field = $field;
            self
        }
    };
}
pub(crate) use with_fields;
