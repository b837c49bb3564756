//! backstop: rigid-body physics for game runtimes. Nothing gets through, and you know what it costs.
//!
//! Fast bodies are stopped in the same pass that solves all other contacts: the narrow phase finds where they
//! will touch within the step, and the solver removes only the velocity that would cross. There is no second,
//! slower loop for them, and each step reports its times, counts and bytes.
//!
//! ```
//! use backstop::glam::{DVec3, Vec3};
//! use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let mut world = World::new(Settings::default())?;
//!
//! // A floor of 1 cm.
//! let floor = ShapeDesc::new(Geometry::cuboid(5.0, 0.005, 5.0));
//! world.add_body(&BodyDesc::fixed().with_shape(floor))?;
//!
//! // A ball at 400 m/s: almost 7 m in each step.
//! let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.05 });
//! let ball = BodyDesc::dynamic()
//!     .with_position(DVec3::new(0.0, 20.0, 0.0))
//!     .with_velocity(Vec3::new(0.0, -400.0, 0.0), Vec3::ZERO)
//!     .with_shape(ball);
//! let ball = world.add_body(&ball)?;
//!
//! for _ in 0..60 {
//!     world.step(1.0 / 60.0)?;
//! }
//! assert!((world.position(ball)?.y - 0.055).abs() < 0.001);
//! assert!(world.memory().total() > 0);
//! # Ok(())
//! # }
//! ```
//!
//! # Where to start
//!
//! - [`World`]: add, remove, change and look up bodies, by [`BodyHandle`] and [`ShapeHandle`];
//!   [`World::step`].
//! - [`BodyDesc`], [`BodyKind`]: a body to be added; static, kinematic or dynamic, with any number of shapes.
//! - [`ShapeDesc`], [`Geometry`], [`Material`], [`Filter`]: its shapes. [`ConvexHull`], [`TriangleMesh`] and
//!   [`HeightField`] are built once and shared.
//! - [`JointDesc`], [`CouplingDesc`], [`Skeleton`]: joints between bodies, from hinges to gears and ragdolls.
//! - [`MassProperties`]: mass, centre and inertia, from shapes or given.
//! - [`Settings`], [`ContinuousMode`], [`ContinuousMethod`]: gravity, substeps, threads, and continuous
//!   collision.
//! - [`Ray`], [`ShapeCast`], [`QueryFilter`]: queries, [`World::cast_ray`] and others.
//! - [`World::body_moves`], [`World::contacts_of`], [`World::aabb`]: bodies that moved in the last step,
//!   contacts of a body, and the box around it.
//! - [`World::contact_begins`], [`World::sensor_begins`], [`ContactHooks`]: events, and hooks that may veto
//!   or edit contacts.
//! - [`Character`]: a capsule or another convex shape that walks.
//! - [`Explosion`], [`Grab`], [`CharacterBody`], [`LevelOfDetail`]: calls that games write again and again.
//! - [`vehicle`]: cars. [`fields`]: water, wind, attractors.
//! - [`StepReport`], [`MemoryReport`]: counts and times of a step, and the memory of the world by
//!   [`Category`].
//! - [`World::feature_report`]: the parts of the engine that the world's content needs, and their cost, by
//!   [`Feature`].
//! - [`debug`]: debug drawing as shapes, lines and points; [`World::draw`].
//! - [`Snapshot`]: the state of a world, from which it continues to the same bits.
//! - [`Plan`]: the memory that a world will hold, before it exists.
//!
//! Guides: [joints](guide::joints), [queries](guide::queries), [events](guide::events),
//! [characters](guide::characters), [levels](guide::levels), [sleep](guide::sleeping),
//! [snapshots](guide::snapshots), [recordings](guide::replay), [debug drawing](guide::debug_drawing),
//! [memory](guide::memory), [determinism](guide::determinism), and
//! [names of other engines](guide::coming_from).
//!
//! SI units, y up, positions in `f64` and everything else in `f32`; [`limits`] has the ranges. Calls that can
//! be refused return an [`Error`] and have then changed nothing. The same input gives the same bits with any
//! number of threads.
//!
//! # Features
//!
//! - `parallel` (default): a step may use several threads of the caller's rayon pool, see
//!   [`Settings::threads`].
//! - `serde`: settings, descriptions, geometry and reports can be serialised.
//! - `bake`: hulls, meshes and height fields to bytes and back, without building them again.
//! - `mint`: vectors and quaternions of other maths crates, by `.into()`.
//! - `web-time`: step times in a browser, where bare WebAssembly has no clock.
//! - `replay`: a run can be recorded and replayed, see `replay`.
//! - `methods`: methods of continuous collision that exist to be compared with.
//! - `observe`: the inside of a step, for measurements, see `observe`.
//!
//! Scenes, builtin ones and glTF files, are a crate of their own, `backstop-scene`; measures of stability and
//! accuracy, and other methods of contact resolution, are `backstop-lab`.

// The documentation of `World` lists its methods in this order.
mod world;

mod step;

mod query;

mod snapshot;

#[cfg(feature = "replay")]
pub mod replay;

pub mod debug;

pub mod fields;

pub mod vehicle;

mod extra;

#[cfg(feature = "observe")]
pub mod observe;

#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod bench;
mod body;
mod broad_phase;
mod character;
mod clock;
mod config;
mod constraint;
mod error;
mod events;
mod faults;
mod finish;
mod forces;
#[cfg(all(doc, not(doctest)))]
pub mod guide;
mod handle;
mod joint;
mod lanes;
pub mod limits;
mod load_limits;
pub mod math;
mod memory;
mod movers;
mod narrow_phase;
#[cfg(any(test, feature = "internals"))]
mod random;

mod shape;
mod sleep;
mod solver;
mod statics;
mod threads;
mod time_of_impact;
mod words;

pub use body::{BodyDesc, BodyKind};
pub use character::{Character, CharacterHit, CharacterReport, CharacterSettings, Ground};
pub use config::{
    ContinuousMethod, ContinuousMode, Field, FrictionCone, FrictionModel, Order, RowGroup, Settings,
};
pub use error::{Error, Escaped};
pub use events::{ContactEnd, ContactEvent, SensorEvent};
pub use extra::{CharacterBody, Grab, GrabSettings, LevelOfDetail};
pub use fields::Explosion;
pub use glam;
pub use handle::{BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};
pub use joint::{
    Axes, Axis, Bone, BoneJoint, CoupledMotion, CouplingDesc, Frame, JointDesc, JointEvent, Limit, Motion,
    Motor, Ragdoll, Skeleton, Spring, SpringCoefficients,
};
pub use load_limits::{Count, LimitExceeded, LoadLimits, Tally};
pub use memory::{Budget, Bytes, Category, MemoryReport};
pub use query::{ClosestPoint, Overlap, QueryFilter, QueryTarget, Ray, RayHit, ShapeCast, ShapeHit};
pub use shape::{
    Combine, ConvexHull, Decomposition, Filter, Geometry, GeometryKey, HeightField, MassProperties, Material,
    Pieces, ShapeDesc, TriangleMesh,
};
pub use snapshot::Snapshot;
pub use world::{
    Aabb, BodyContact, BodyMove, ContactHook, ContactHooks, ContactPoint, ContentForecast, Feature,
    FeatureCost, FeatureReport, NoHooks, Plan, StageTimes, StepReport, World,
};
