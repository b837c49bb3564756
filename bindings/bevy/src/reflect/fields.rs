//! Components that hold structs of the engine, which know nothing of Bevy's reflection, as structs of the
//! fields that an inspector can show and set. What can't be shown, such as limits and motors, is not among
//! them; a scene has it all the same, by serde.

use crate::components::body::Mass;
use crate::components::character::Character;
use crate::components::coupling::Coupling;
use crate::components::joint::Joint;
use crate::components::shape::{ShapeFilter, ShapeMaterial};
use backstop::{Filter, MassProperties, Material};
use bevy_ecs::prelude::{Entity, ReflectComponent};
use bevy_math::{Quat, Vec3};
use bevy_reflect::structs::{FieldIter, Struct, StructInfo};
use bevy_reflect::utility::NonGenericTypeInfoCell;
use bevy_reflect::*;
use std::any::Any;

/// What all components have in common that implement reflection by hand: a form, Struct or Enum, and the
/// types of its parts.
macro_rules! by_hand {
    ($name:ident as $form:ident, [$($part:ty),* $(,)?]) => {
        impl PartialReflect for $name {
            fn get_represented_type_info(&self) -> Option<&'static TypeInfo> {
                Some(Self::type_info())
            }
            fn into_partial_reflect(self: Box<Self>) -> Box<dyn PartialReflect> {
                self
            }
            fn as_partial_reflect(&self) -> &dyn PartialReflect {
                self
            }
            fn as_partial_reflect_mut(&mut self) -> &mut dyn PartialReflect {
                self
            }
            fn try_into_reflect(self: Box<Self>) -> Result<Box<dyn Reflect>, Box<dyn PartialReflect>> {
                Ok(self)
            }
            fn try_as_reflect(&self) -> Option<&dyn Reflect> {
                Some(self)
            }
            fn try_as_reflect_mut(&mut self) -> Option<&mut dyn Reflect> {
                Some(self)
            }
            fn try_apply(&mut self, value: &dyn PartialReflect) -> Result<(), ApplyError> {
                if let Some(whole) = value.try_downcast_ref::<Self>() {
                    *self = whole.clone();
                    return Ok(());
                }
                self.apply_parts(value)
            }
            fn reflect_ref(&self) -> ReflectRef<'_> {
                ReflectRef::$form(self)
            }
            fn reflect_mut(&mut self) -> ReflectMut<'_> {
                ReflectMut::$form(self)
            }
            fn reflect_owned(self: Box<Self>) -> ReflectOwned {
                ReflectOwned::$form(self)
            }
            fn reflect_clone(&self) -> Result<Box<dyn Reflect>, ReflectCloneError> {
                Ok(Box::new(self.clone()))
            }
        }
        impl Reflect for $name {
            fn into_any(self: Box<Self>) -> Box<dyn Any> {
                self
            }
            fn as_any(&self) -> &dyn Any {
                self
            }
            fn as_any_mut(&mut self) -> &mut dyn Any {
                self
            }
            fn into_reflect(self: Box<Self>) -> Box<dyn Reflect> {
                self
            }
            fn as_reflect(&self) -> &dyn Reflect {
                self
            }
            fn as_reflect_mut(&mut self) -> &mut dyn Reflect {
                self
            }
            fn set(&mut self, value: Box<dyn Reflect>) -> Result<(), Box<dyn Reflect>> {
                *self = value.take()?;
                Ok(())
            }
        }
        impl GetTypeRegistration for $name {
            fn get_type_registration() -> TypeRegistration {
                let mut registration = TypeRegistration::of::<Self>();
                registration.register_type_data::<ReflectFromPtr, Self>();
                registration.register_type_data::<ReflectFromReflect, Self>();
                registration.register_type_data::<ReflectComponent, Self>();
                registration.register_type_data::<ReflectSerialize, Self>();
                registration.register_type_data::<ReflectDeserialize, Self>();
                registration
            }
            fn register_type_dependencies(registry: &mut TypeRegistry) {
                $(registry.register::<$part>();)*
            }
        }
    };
}
pub(super) use by_hand;

/// Implements reflection for a component as a struct: its fields by name, type and place in the component,
/// and vectors and matrices of the engine as arrays of numbers. After the name stands how a value is made of
/// some of the fields only.
macro_rules! shown {
    ($name:ident, $new:expr;
        { $($field:ident: $kind:ty = $($place:tt).+;)* }
        { $($array:ident: $length:literal = $($at:tt).+;)* }
    ) => {
        impl $name {
            const FIELDS: &'static [&'static str] = &[$(stringify!($field),)* $(stringify!($array)),*];
        }
        impl Struct for $name {
            fn field(&self, name: &str) -> Option<&dyn PartialReflect> {
                $(if name == stringify!($field) { return Some(&self.$($place).+); })*
                $(if name == stringify!($array) {
                    let numbers: &[f32; $length] = self.$($at).+.as_ref();
                    return Some(numbers);
                })*
                None
            }
            fn field_mut(&mut self, name: &str) -> Option<&mut dyn PartialReflect> {
                $(if name == stringify!($field) { return Some(&mut self.$($place).+); })*
                $(if name == stringify!($array) {
                    let numbers: &mut [f32; $length] = self.$($at).+.as_mut();
                    return Some(numbers);
                })*
                None
            }
            fn field_at(&self, index: usize) -> Option<&dyn PartialReflect> {
                self.field(Self::FIELDS.get(index)?)
            }
            fn field_at_mut(&mut self, index: usize) -> Option<&mut dyn PartialReflect> {
                self.field_mut(Self::FIELDS.get(index)?)
            }
            fn name_at(&self, index: usize) -> Option<&str> {
                Self::FIELDS.get(index).copied()
            }
            fn index_of_name(&self, name: &str) -> Option<usize> {
                Self::FIELDS.iter().position(|field| *field == name)
            }
            fn field_len(&self) -> usize {
                Self::FIELDS.len()
            }
            fn iter_fields(&self) -> FieldIter<'_> {
                FieldIter::new(self)
            }
        }
        impl Typed for $name {
            fn type_info() -> &'static TypeInfo {
                static CELL: NonGenericTypeInfoCell = NonGenericTypeInfoCell::new();
                CELL.get_or_set(|| {
                    let fields = [
                        $(NamedField::new::<$kind>(stringify!($field)),)*
                        $(NamedField::new::<[f32; $length]>(stringify!($array)),)*
                    ];
                    TypeInfo::Struct(StructInfo::new::<Self>(&fields))
                })
            }
        }
        by_hand! { $name as Struct, [$($kind,)* $([f32; $length]),*] }
        impl $name {
            fn apply_parts(&mut self, value: &dyn PartialReflect) -> Result<(), ApplyError> {
                for (name, value) in value.reflect_ref().as_struct()?.iter_fields() {
                    if let Some(field) = self.field_mut(name) {
                        field.try_apply(value)?;
                    }
                }
                Ok(())
            }
        }
        impl FromReflect for $name {
            fn from_reflect(value: &dyn PartialReflect) -> Option<Self> {
                if let Some(whole) = value.try_downcast_ref::<Self>() {
                    return Some(whole.clone());
                }
                let new: Option<Self> = $new;
                let mut new = new?;
                new.try_apply(value).ok()?;
                Some(new)
            }
        }
    };
}

shown! { Mass, Some(Mass(MassProperties::ZERO));
    { mass: f32 = 0.mass; }
    { centre_of_mass: 3 = 0.centre_of_mass; inertia: 9 = 0.inertia; }
}

shown! { ShapeMaterial, Some(ShapeMaterial(Material::default()));
    {
        static_friction: f32 = 0.static_friction;
        dynamic_friction: f32 = 0.dynamic_friction;
        restitution: f32 = 0.restitution;
        rolling_friction: f32 = 0.rolling_friction;
        spinning_friction: f32 = 0.spinning_friction;
        contact_hertz: f32 = 0.contact_hertz;
        contact_damping: f32 = 0.contact_damping;
    }
    { surface_velocity: 3 = 0.surface_velocity; }
}

shown! { ShapeFilter, Some(ShapeFilter(Filter::default()));
    { category: u64 = 0.category; mask: u64 = 0.mask; group: i32 = 0.group; }
    {}
}

shown! { Character, Some(Character::default());
    {
        radius: f32 = settings.radius;
        half_height: f32 = settings.half_height;
        skin: f32 = settings.skin;
        max_slope: f32 = settings.max_slope;
        step_height: f32 = settings.step_height;
        snap: f32 = settings.snap;
        iterations: u32 = settings.iterations;
        mass: f32 = settings.mass;
        strength: f32 = settings.strength;
        air_acceleration: f32 = air_acceleration;
    }
    { up: 3 = settings.up; }
}

shown! { Joint, None;
    {
        bodies: [Entity; 2] = bodies;
        anchor: Option<(Vec3, Quat)> = anchor;
        collide: bool = desc.collide;
        break_force: f32 = desc.break_force;
        break_torque: f32 = desc.break_torque;
        force_threshold: f32 = desc.force_threshold;
        torque_threshold: f32 = desc.torque_threshold;
    }
    {}
}

shown! { Coupling, None;
    { joints: [Entity; 2] = joints; break_force: [f32; 2] = desc.break_force; }
    {}
}
