//! Contact hooks that read the app: system parameters which the step calls about contacts.

use crate::world::{EntityTable, PhysicsHooks, ShapeState};
use backstop::{ContactHook, ContactHooks};
use bevy_ecs::entity::Entity;
use std::ops::{Deref, DerefMut};

/// Callbacks on contacts of shapes with [`ContactHooked`](crate::ContactHooked) that read the app: a type
/// that derives `SystemParam`, of queries and resources, given to
/// [`BackstopPlugin::with_hooks`](crate::BackstopPlugin::with_hooks). It may veto a contact, or change its
/// friction, restitution and surface velocity, in each step anew.
///
/// It is called by the thread that steps, always in the same order, while the world is being stepped: it has
/// no access to [`PhysicsWorld`](crate::PhysicsWorld), which Bevy refuses when the app starts. Poses and
/// velocities are those of the last step, in the components.
///
/// ```
/// use backstop_bevy::prelude::*;
/// use bevy_ecs::prelude::*;
/// use bevy_ecs::system::SystemParam;
///
/// #[derive(Component)]
/// struct Ghost;
///
/// #[derive(SystemParam)]
/// struct Ghosts<'w, 's> {
///     ghosts: Query<'w, 's, (), With<Ghost>>,
/// }
///
/// impl CollisionHooks for Ghosts<'_, '_> {
///     fn contact(&self, contact: &mut HookedContact<'_, '_>) {
///         if contact.bodies().into_iter().flatten().any(|body| self.ghosts.contains(body)) {
///             contact.veto();
///         }
///     }
/// }
///
/// let plugin = BackstopPlugin::default().with_hooks::<Ghosts>();
/// ```
pub trait CollisionHooks: Sync {
    /// Called for each manifold that is about to be solved.
    fn contact(&self, contact: &mut HookedContact<'_, '_>);
}

/// No hooks.
impl CollisionHooks for () {
    fn contact(&self, _: &mut HookedContact<'_, '_>) {}
}

/// A [`ContactHook`] with entities. It derefs to that; the normal points from the first to the second.
#[derive(Debug)]
pub struct HookedContact<'a, 'b> {
    contact: &'a mut ContactHook<'b>,
    shapes: [Option<Entity>; 2],
    bodies: [Option<Entity>; 2],
}

impl HookedContact<'_, '_> {
    /// The entities of the two shapes; none of what was added to the world directly.
    pub fn shapes(&self) -> [Option<Entity>; 2] {
        self.shapes
    }
    /// The entities of their bodies.
    pub fn bodies(&self) -> [Option<Entity>; 2] {
        self.bodies
    }
}

impl<'b> Deref for HookedContact<'_, 'b> {
    type Target = ContactHook<'b>;
    fn deref(&self) -> &ContactHook<'b> {
        self.contact
    }
}

impl DerefMut for HookedContact<'_, '_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.contact
    }
}

/// The hooks of an app: those of the plugin, then those of the resource.
pub(crate) struct Called<'a, H> {
    pub(crate) hooks: &'a H,
    pub(crate) boxed: Option<&'a PhysicsHooks>,
    pub(crate) shapes: &'a EntityTable<ShapeState>,
}

impl<H: CollisionHooks> ContactHooks for Called<'_, H> {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let handles = contact.shapes();
        let mut shapes = contact.user_data().map(Entity::try_from_bits);
        let mut bodies = [None; 2];
        for (place, shape) in shapes.iter_mut().enumerate() {
            let known = shape.and_then(|shape| self.shapes.get(&shape));
            let known = known.filter(|state| state.handle == handles[place]);
            bodies[place] = known.map(|state| state.body);
            *shape = shape.filter(|_| known.is_some());
        }
        self.hooks.contact(&mut HookedContact { contact, shapes, bodies });
        if let Some(boxed) = self.boxed {
            boxed.0.contact(contact);
        }
    }
}
