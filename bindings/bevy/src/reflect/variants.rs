//! Components that hold enums of the engine, as enums whose variants and numbers an inspector can show and
//! set. Hulls, meshes and fields of heights are shown without their contents and can't be chosen.

use super::fields::by_hand;
use crate::components::body::{Continuous, SolvedAfter};
use crate::components::shape::Shape;
use backstop::{ContinuousMode, Geometry, RowGroup, glam};
use bevy_ecs::prelude::ReflectComponent;
use bevy_reflect::enums::*;
use bevy_reflect::utility::NonGenericTypeInfoCell;
use bevy_reflect::*;
use std::any::Any;

/// A number, or a vector of the engine as an array.
trait Part {
    fn shown(&self) -> &dyn PartialReflect;
    fn shown_mut(&mut self) -> &mut dyn PartialReflect;
}

impl Part for f32 {
    fn shown(&self) -> &dyn PartialReflect {
        self
    }
    fn shown_mut(&mut self) -> &mut dyn PartialReflect {
        self
    }
}

impl Part for glam::Vec3 {
    fn shown(&self) -> &dyn PartialReflect {
        let numbers: &[f32; 3] = self.as_ref();
        numbers
    }
    fn shown_mut(&mut self) -> &mut dyn PartialReflect {
        let numbers: &mut [f32; 3] = self.as_mut();
        numbers
    }
}

/// Implements reflection for a component as the enum that it holds: of each variant its name and pattern, the
/// value that it has when it is chosen, if it can be, and its fields.
macro_rules! chosen {
    ($name:ident, $engine:ident:
        $($variant:ident $pattern:pat, $new:expr, [$($field:ident: $kind:ty),*];)*
    ) => {
        #[allow(
            unused_variables,
            unreachable_patterns,
            reason = "a pattern serves for its name and its fields, and some enums may grow"
        )]
        impl $name {
            fn of(variant: &str) -> Option<Self> {
                let new: Option<$engine> = match variant {
                    $(stringify!($variant) => $new,)*
                    _ => None,
                };
                new.map($name)
            }
            fn names(&self) -> &'static [&'static str] {
                match &self.0 {
                    $($pattern => &[$(stringify!($field)),*],)*
                    _ => &[],
                }
            }
            fn place(&self) -> usize {
                let mut place = 0;
                $(
                    if matches!(&self.0, $pattern) {
                        return place;
                    }
                    place += 1;
                )*
                place
            }
            fn apply_parts(&mut self, value: &dyn PartialReflect) -> Result<(), ApplyError> {
                let value = value.reflect_ref().as_enum()?;
                let variant = value.variant_name();
                let own = (variant == self.variant_name()).then(|| self.clone());
                let mut new = own.or_else(|| Self::of(variant)).ok_or(ApplyError::UnknownVariant {
                    enum_name: Self::type_path().into(),
                    variant_name: variant.into(),
                })?;
                for field in value.iter_fields() {
                    if let VariantField::Struct(name, value) = field
                        && let Some(field) = new.field_mut(name)
                    {
                        field.try_apply(value)?;
                    }
                }
                *self = new;
                Ok(())
            }
        }
        #[allow(
            unused_variables,
            unreachable_patterns,
            reason = "a pattern serves for its name and its fields, and some enums may grow"
        )]
        impl Enum for $name {
            fn field(&self, name: &str) -> Option<&dyn PartialReflect> {
                match &self.0 {
                    $($pattern => {
                        $(if name == stringify!($field) { return Some($field.shown()); })*
                    })*
                    _ => {}
                }
                None
            }
            fn field_mut(&mut self, name: &str) -> Option<&mut dyn PartialReflect> {
                match &mut self.0 {
                    $($pattern => {
                        $(if name == stringify!($field) { return Some($field.shown_mut()); })*
                    })*
                    _ => {}
                }
                None
            }
            fn field_at(&self, index: usize) -> Option<&dyn PartialReflect> {
                self.field(self.names().get(index)?)
            }
            fn field_at_mut(&mut self, index: usize) -> Option<&mut dyn PartialReflect> {
                self.field_mut(self.names().get(index)?)
            }
            fn index_of(&self, name: &str) -> Option<usize> {
                self.names().iter().position(|field| *field == name)
            }
            fn name_at(&self, index: usize) -> Option<&str> {
                self.names().get(index).copied()
            }
            fn iter_fields(&self) -> VariantFieldIter<'_> {
                VariantFieldIter::new(self)
            }
            fn field_len(&self) -> usize {
                self.names().len()
            }
            fn variant_name(&self) -> &str {
                [$(stringify!($variant)),*].get(self.place()).copied().unwrap_or_default()
            }
            fn variant_index(&self) -> usize {
                self.place()
            }
            fn variant_type(&self) -> VariantType {
                if self.names().is_empty() { VariantType::Unit } else { VariantType::Struct }
            }
        }
        impl Typed for $name {
            fn type_info() -> &'static TypeInfo {
                static CELL: NonGenericTypeInfoCell = NonGenericTypeInfoCell::new();
                CELL.get_or_set(|| {
                    let variants = [$({
                        let fields: &[NamedField] = &[$(NamedField::new::<$kind>(stringify!($field))),*];
                        match fields {
                            [] => VariantInfo::Unit(UnitVariantInfo::new(stringify!($variant))),
                            fields => {
                                VariantInfo::Struct(StructVariantInfo::new(stringify!($variant), fields))
                            }
                        }
                    }),*];
                    TypeInfo::Enum(EnumInfo::new::<Self>(&variants))
                })
            }
        }
        by_hand! { $name as Enum, [f32, [f32; 3]] }
        impl FromReflect for $name {
            fn from_reflect(value: &dyn PartialReflect) -> Option<Self> {
                if let Some(whole) = value.try_downcast_ref::<Self>() {
                    return Some(whole.clone());
                }
                let mut new = Self::of(value.reflect_ref().as_enum().ok()?.variant_name())?;
                new.try_apply(value).ok()?;
                Some(new)
            }
        }
    };
}

chosen! { Continuous, ContinuousMode:
    Discrete ContinuousMode::Discrete, Some(ContinuousMode::Discrete), [];
    Segment ContinuousMode::Segment, Some(ContinuousMode::Segment), [];
    Volume ContinuousMode::Volume, Some(ContinuousMode::Volume), [];
}

chosen! { SolvedAfter, RowGroup:
    SoftJoints RowGroup::SoftJoints, Some(RowGroup::SoftJoints), [];
    JointLimits RowGroup::JointLimits, Some(RowGroup::JointLimits), [];
    Joints RowGroup::Joints, Some(RowGroup::Joints), [];
    Contacts RowGroup::Contacts, Some(RowGroup::Contacts), [];
    PotentialContacts RowGroup::PotentialContacts, Some(RowGroup::PotentialContacts), [];
    StaticContacts RowGroup::StaticContacts, Some(RowGroup::StaticContacts), [];
    PotentialStaticContacts RowGroup::PotentialStaticContacts, Some(RowGroup::PotentialStaticContacts), [];
}

chosen! { Shape, Geometry:
    Sphere Geometry::Sphere { radius }, Some(Geometry::sphere(0.5)), [radius: f32];
    Capsule Geometry::Capsule { half_height, radius_bottom, radius_top },
        Some(Geometry::capsule(0.5, 0.5)), [half_height: f32, radius_bottom: f32, radius_top: f32];
    Box Geometry::Box { half_extents }, Some(Geometry::cuboid(0.5, 0.5, 0.5)), [half_extents: [f32; 3]];
    Cylinder Geometry::Cylinder { half_height, radius_bottom, radius_top },
        Some(Geometry::cylinder(0.5, 0.5)), [half_height: f32, radius_bottom: f32, radius_top: f32];
    Hull Geometry::Hull(_), None, [];
    Plane Geometry::Plane, Some(Geometry::Plane), [];
    Mesh Geometry::Mesh(_), None, [];
    HeightField Geometry::HeightField(_), None, [];
}
