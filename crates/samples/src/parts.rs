//! Parts of many samples: a level ground, bodies of one shape, and worlds with a function that acts before
//! each step.

use crate::{Running, Tick};
use backstop::{
    BodyDesc, BodyHandle, ContactHooks, Error, Geometry, Material, NoHooks, Settings, ShapeDesc, World,
};
use std::{any::Any, fmt, rc::Rc};

/// A world with a level ground at y = 0, and the body of the ground.
///
/// # Errors
///
/// Those of [`World::new`] and [`World::add_body`].
pub fn level_world() -> Result<(World, BodyHandle), Error> {
    level_world_with(Settings::default())
}

/// The same with settings.
///
/// # Errors
///
/// Those of [`World::new`] and [`World::add_body`].
pub fn level_world_with(settings: Settings) -> Result<(World, BodyHandle), Error> {
    let mut world = World::new(settings)?;
    let ground = world.add_body(&fixed(Geometry::plane()))?;
    Ok((world, ground))
}

/// A world with a lawn at y = 0, on which rolling bodies come to rest, and the body of the lawn.
///
/// # Errors
///
/// Those of [`World::new`] and [`World::add_body`].
pub fn lawn() -> Result<(World, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let grass = Material::default().with_rolling_friction(0.03);
    let ground = ShapeDesc::new(Geometry::plane()).with_material(grass);
    let ground = world.add_body(&BodyDesc::fixed().with_shape(ground))?;
    Ok((world, ground))
}

/// A dynamic body of one shape, of the density of water.
pub fn solid(geometry: Geometry) -> BodyDesc {
    BodyDesc::dynamic().with_shape(ShapeDesc::new(geometry))
}

/// A body of one shape that nothing moves.
pub fn fixed(geometry: Geometry) -> BodyDesc {
    BodyDesc::fixed().with_shape(ShapeDesc::new(geometry))
}

/// A number in 0..1 for each index. Numbers of neighbours are far apart, so that places by them are
/// spread evenly.
pub fn spread(index: usize) -> f32 {
    (index as f32 * 0.618_034).fract()
}

/// Steps without a user, for some time [s].
///
/// # Errors
///
/// Those of [`Running::step`].
pub fn run(sample: &mut impl Running, seconds: f64) -> Result<(), Error> {
    Tick::during(seconds).try_for_each(|tick| sample.step(&tick))
}

type Act<S> = dyn Fn(&mut World, &mut S, &Tick) -> Result<(), Error>;

/// A world in which something acts before each step, with a state of its own beside it.
pub struct Driven<S = ()> {
    world: World,
    state: S,
    act: Box<Act<S>>,
    hooks: Box<dyn ContactHooks>,
}

impl Driven {
    /// Calls a function before each step.
    pub fn new(world: World, act: impl Fn(&mut World, &Tick) -> Result<(), Error> + 'static) -> Driven {
        Driven::with_state(world, (), move |world, (), tick| act(world, tick))
    }

    /// A world in which hooks see contacts, and nothing else acts.
    pub fn hooked(world: World, hooks: impl ContactHooks + 'static) -> Driven {
        Driven { hooks: Box::new(hooks), ..Driven::new(world, |_, _| Ok(())) }
    }
}

impl<S> Driven<S> {
    /// Calls a function before each step that changes a state, such as a vehicle's, of which copies go with
    /// snapshots of the world.
    pub fn with_state(
        world: World,
        state: S,
        act: impl Fn(&mut World, &mut S, &Tick) -> Result<(), Error> + 'static,
    ) -> Driven<S> {
        Driven { world, state, act: Box::new(act), hooks: Box::new(NoHooks) }
    }
}

impl<S> fmt::Debug for Driven<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Driven").field("world", &self.world).finish_non_exhaustive()
    }
}

impl<S: Clone + 'static> Running for Driven<S> {
    fn world(&self) -> &World {
        &self.world
    }

    fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    fn step(&mut self, tick: &Tick) -> Result<(), Error> {
        (self.act)(&mut self.world, &mut self.state, tick)?;
        self.world.step_with(tick.dt, &*self.hooks)?;
        Ok(())
    }

    fn state(&self) -> Option<Rc<dyn Any>> {
        Some(Rc::new(self.state.clone()))
    }

    fn set_state(&mut self, state: &dyn Any) {
        if let Some(state) = state.downcast_ref::<S>() {
            self.state.clone_from(state);
        }
    }
}
