//! Components through the type registry (feature `reflect`).

use crate::common::*;
use backstop_bevy::backstop::{self, ContinuousMode, Filter, MassProperties, RowGroup};
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::enums::DynamicEnum;
use bevy_reflect::serde::{TypedReflectDeserializer, TypedReflectSerializer};
use bevy_reflect::structs::DynamicStruct;
use bevy_reflect::{FromReflect, PartialReflect, Reflect, ReflectMut, TypeRegistration, TypeRegistry};
use bevy_transform::components::Transform;
use serde::de::DeserializeSeed;

/// Two balls with all that a body and a shape may have, a joint, a lift, a gate and a character.
fn spawn(app: &mut App) -> Vec<Entity> {
    let all = floor(app);
    let (a, b) = (ball(app, 3.0), ball(app, 5.0));
    let mass = MassProperties::of(&backstop::Geometry::sphere(0.5), 700.0);
    app.world_mut().entity_mut(a).insert((
        (Mass(mass), GravityScale(0.5), Damping { linear: 0.1, angular: 0.2 }, LockedAxes::ROTATION),
        (Continuous(ContinuousMode::Volume), SolvedAfter(RowGroup::Joints), NeverSleeps, NoInterpolation),
        (ShapeMaterial(backstop::Material::default().with_rolling_friction(0.01)), Density(500.0)),
        (ShapeFilter(Filter::default().with_category(4)), ContactMessages, ContactHooked),
        MaxSpeeds { linear: Some(20.0), angular: Some(9.0) },
        (ConstantForce { force: Vec3::X, torque: Vec3::Y }, Extrapolation, ShapeOffset::at(0.1 * Vec3::X)),
    ));
    let joint = app.world_mut().spawn(Joint::distance([a, b], 0.0, 3.0).with_break_force(1e6, 1e6)).id();
    app.world_mut().entity_mut(joint).insert(Coupling::screw(joint, 0.1).with_break_force([1e6; 2]));
    let lift = (RigidBody::Kinematic, Shape::cuboid(1.0, 0.1, 1.0), Velocity::linear(Vec3::Y));
    let lift = app.world_mut().spawn((lift, Transform::from_xyz(6.0, 0.1, 0.0))).id();
    let gate = (RigidBody::Static, BodyDisabled, Shape::cuboid(1.0, 1.0, 1.0), SensesStatic);
    let gate = app.world_mut().spawn((gate, Transform::from_xyz(-6.0, 1.0, 0.0))).id();
    let long = Character::default().with_shape(Shape::cuboid(0.3, 0.9, 0.3)).with_air_acceleration(5.0);
    let walks = CharacterInput { velocity: Vec3::new(1.0, 0.0, 0.0), jump: 2.0 };
    let walker = app.world_mut().spawn((long, walks, Transform::from_xyz(-3.0, 1.0, 0.0))).id();
    vec![all, a, b, joint, lift, gate, walker]
}

/// All registrations of the plugin's components.
fn components(registry: &TypeRegistry) -> Vec<&TypeRegistration> {
    let own = |registration: &&TypeRegistration| {
        let ours = registration.type_info().type_path().starts_with("backstop_bevy");
        ours && registration.data::<ReflectComponent>().is_some()
    };
    registry.iter().filter(own).collect()
}

/// Every component that an entity has, as JSON with its type.
fn saved(app: &App, entity: Entity) -> Vec<(String, String)> {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let mut all = Vec::new();
    for registration in components(&registry) {
        let part = registration.data::<ReflectComponent>().unwrap();
        let Some(value) = part.reflect(app.world().entity(entity)) else { continue };
        let json = serde_json::to_string(&TypedReflectSerializer::new(value.as_partial_reflect(), &registry));
        all.push((registration.type_info().type_path().to_string(), json.expect("it can be written")));
    }
    all.sort();
    all
}

/// Gives an entity of another app what was saved.
fn load(app: &mut App, entity: Entity, parts: &[(String, String)]) {
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    for (path, json) in parts {
        let registration = registry.get_with_type_path(path).expect("it is registered");
        let seed = TypedReflectDeserializer::new(registration, &registry);
        let value = seed.deserialize(&mut serde_json::Deserializer::from_str(json)).expect("it can be read");
        let part = registration.data::<ReflectComponent>().unwrap();
        part.insert(&mut app.world_mut().entity_mut(entity), value.as_ref(), &registry);
    }
}

/// Every component of a scene to JSON and into another app by way of the type registry. Expected: each of
/// them is there on some entity, is the same when it is written again, and both worlds have the same bits in
/// each of three seconds' steps.
#[test]
fn a_scene_goes_through_the_type_registry() {
    let (mut one, mut other) = (app(), app());
    let entities = spawn(&mut one);
    let mut met = std::collections::BTreeSet::new();
    for &entity in &entities {
        let parts = saved(&one, entity);
        met.extend(parts.iter().map(|(path, _)| path.clone()));
        let transform = one.world().get::<Transform>(entity).copied().unwrap_or_default();
        let same = other.world_mut().spawn(transform).id();
        assert_eq!(same, entity, "joints name it");
        load(&mut other, same, &parts);
        assert_eq!(saved(&other, same), parts);
    }
    let count = components(&one.world().resource::<AppTypeRegistry>().read()).len();
    assert_eq!((met.len(), count), (30, 30), "{met:?}");
    log::<PhysicsError>(&mut other);
    for step in 0..180 {
        one.update();
        other.update();
        assert_eq!(physics(&one).state_hash(), physics(&other).state_hash(), "step {step}");
    }
    assert_eq!(logged::<PhysicsError>(&other), []);
    assert_eq!((physics(&other).body_count(), physics(&other).joint_count()), (5, 1));
    assert_eq!(saved(&one, entities[6]), saved(&other, entities[6]));
}

/// Expected: numbers and flags are fields, which an inspector can show and set; and messages are registered.
#[test]
fn plain_components_show_their_fields() {
    let mut app = app();
    let body = ball(&mut app, 3.0);
    {
        let mut velocity = app.world_mut().get_mut::<Velocity>(body).unwrap();
        let part = velocity.as_reflect_mut().reflect_mut();
        let bevy_reflect::ReflectMut::Struct(part) = part else { panic!("it is a struct") };
        let linear = part.field_mut("linear").unwrap();
        *linear.try_downcast_mut::<Vec3>().unwrap() = Vec3::X;
    }
    run(&mut app, 60);
    assert!((get::<PhysicsPose>(&app, body).position.x - 1.0).abs() < 1e-4);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let message = registry.get_with_short_type_path("ContactHit").expect("it is registered");
    assert!(message.data::<ReflectMessage>().is_some());
}

/// Expected: components that hold types of the engine show the numbers in these, by a path as an inspector
/// has it, and a change of one reaches the world; a struct of some fields makes a component with the defaults
/// of the others.
#[test]
fn components_of_the_engine_show_their_fields() {
    let mut app = app();
    let (a, b) = (ball(&mut app, 3.0), ball(&mut app, 6.0));
    let mass = MassProperties::of(&backstop::Geometry::sphere(0.5), 700.0);
    app.world_mut().entity_mut(a).insert((
        Mass(mass),
        ShapeMaterial::friction(0.4),
        ShapeFilter(Filter::default()),
    ));
    let joint = app.world_mut().spawn(Joint::distance([a, b], 0.0, 5.0)).id();
    app.update();
    let set = |app: &mut App, entity: Entity, component: &str, field: &str, value: &dyn PartialReflect| {
        let registry = app.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let registration = registry.get_with_short_type_path(component).expect("it is registered");
        let part = registration.data::<ReflectComponent>().unwrap();
        let mut part = part.reflect_mut(app.world_mut().entity_mut(entity)).expect("the entity has it");
        let ReflectMut::Struct(part) = part.reflect_mut() else { panic!("{component} is a struct") };
        let names: Vec<_> = (0..part.field_len()).filter_map(|i| part.name_at(i)).map(String::from).collect();
        assert!(names.iter().any(|name| name == field), "{names:?}");
        part.field_mut(field).expect("it is there").try_apply(value).expect("it is of that type");
    };
    set(&mut app, a, "ShapeMaterial", "restitution", &0.7_f32);
    set(&mut app, a, "ShapeMaterial", "surface_velocity", &[1.0_f32, 0.0, 2.0]);
    set(&mut app, a, "ShapeFilter", "mask", &6_u64);
    set(&mut app, a, "Mass", "mass", &12.0_f32);
    set(&mut app, joint, "Joint", "break_force", &5e5_f32);
    app.update();
    let world = physics(&app);
    let (body, shape) = (world.body(a).unwrap(), world.shape(a).unwrap());
    let material = world.material(shape).unwrap();
    assert_eq!((material.static_friction, material.restitution), (0.4, 0.7));
    assert_eq!(material.surface_velocity, backstop::glam::Vec3::new(1.0, 0.0, 2.0));
    assert_eq!((world.filter(shape).unwrap().mask, world.mass(body).unwrap()), (6, 12.0));
    assert_eq!(get::<Joint>(&app, joint).desc.break_force, 5e5);
    assert!(app.world_mut().entity_mut(a).contains::<ShapeMaterial>());

    let mut some = DynamicStruct::default();
    some.insert("dynamic_friction", 0.25_f32);
    let made = ShapeMaterial::from_reflect(&some).expect("it can be made");
    assert_eq!((made.0.dynamic_friction, made.0.static_friction), (0.25, 0.6));
    let whole = get::<Joint>(&app, joint);
    assert_eq!(Joint::from_reflect(whole.as_partial_reflect()), Some(whole.clone()));
}

/// Expected: a shape shows its form and its numbers, a new number reaches the world, and another form can be
/// chosen, with numbers for what is not given; modes are enums too. A hull has no value to be made of.
#[test]
fn forms_and_modes_are_enums() {
    let mut app = app();
    let body = ball(&mut app, 3.0);
    app.world_mut().entity_mut(body).insert(Continuous(ContinuousMode::Segment));
    app.update();
    {
        let mut shape = app.world_mut().get_mut::<Shape>(body).unwrap();
        let ReflectMut::Enum(form) = shape.as_reflect_mut().reflect_mut() else { panic!("it is an enum") };
        assert_eq!((form.variant_name(), form.name_at(0)), ("Sphere", Some("radius")));
        form.field_mut("radius").unwrap().try_apply(&0.25_f32).unwrap();
    }
    app.update();
    let of = |app: &App| {
        let world = physics(app);
        format!("{:?}", world.geometry(world.shape(body).unwrap()).unwrap())
    };
    assert_eq!(of(&app), format!("{:?}", backstop::Geometry::sphere(0.25)));

    let mut numbers = DynamicStruct::default();
    numbers.insert("half_extents", [0.5_f32, 1.0, 2.0]);
    let cuboid = DynamicEnum::new("Box", numbers);
    app.world_mut().get_mut::<Shape>(body).unwrap().try_apply(&cuboid).unwrap();
    let volume = DynamicEnum::new("Volume", ());
    app.world_mut().get_mut::<Continuous>(body).unwrap().try_apply(&volume).unwrap();
    app.update();
    assert_eq!(of(&app), format!("{:?}", backstop::Geometry::cuboid(0.5, 1.0, 2.0)));
    let world = physics(&app);
    assert_eq!(world.continuous(world.body(body).unwrap()), Ok(ContinuousMode::Volume));
    assert!(Shape::from_reflect(&DynamicEnum::new("Hull", ())).is_none());
    let made = SolvedAfter::from_reflect(&DynamicEnum::new("Joints", ()));
    assert_eq!(made, Some(SolvedAfter(RowGroup::Joints)));
}
