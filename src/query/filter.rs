//! Which shapes a query sees.

use crate::body::BodyKind;
use crate::broad_phase::Sorts;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::shape::{Collider, Filter};
use crate::world::World;

/// The only shapes that a query may see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum QueryTarget {
    /// All shapes of a body.
    Body(BodyHandle),
    /// One shape.
    Shape(ShapeHandle),
}

impl From<BodyHandle> for QueryTarget {
    fn from(body: BodyHandle) -> QueryTarget {
        QueryTarget::Body(body)
    }
}

impl From<ShapeHandle> for QueryTarget {
    fn from(shape: ShapeHandle) -> QueryTarget {
        QueryTarget::Shape(shape)
    }
}

/// Which shapes a query sees; by default all but sensors.
///
/// ```
/// use backstop::{BodyHandle, Filter, QueryFilter, ShapeHandle};
///
/// # fn with(player: BodyHandle) {
/// // What a bullet of this category would collide with, without whoever shot it.
/// let filter = QueryFilter::new().with_filter(Filter::default().with_category(4)).excluding(player);
/// // Only what stands still, as far as the game agrees.
/// let sees = |body: BodyHandle, _shape: ShapeHandle| body > player;
/// let filter = QueryFilter::only_static().with_predicate(&sees);
/// # }
/// ```
#[derive(Clone, Copy)]
pub struct QueryFilter<'a> {
    /// If set, only shapes that would collide with one of this filter. Default: none, all are seen.
    pub filter: Option<Filter>,
    /// Whether shapes of static bodies are seen. Default: yes.
    pub statics: bool,
    /// Whether shapes of kinematic bodies are seen. Default: yes.
    pub kinematic: bool,
    /// Whether shapes of dynamic bodies are seen. Default: yes.
    pub dynamic: bool,
    /// Whether sensors are seen. Default: no.
    pub sensors: bool,
    /// A body whose shapes are not seen, such as the one that asks. A stale handle excludes nothing.
    pub exclude_body: Option<BodyHandle>,
    /// A shape that is not seen. A stale handle excludes nothing.
    pub exclude_shape: Option<ShapeHandle>,
    /// If set, only the shapes of this body, or this shape, as far as the other fields allow them. The query
    /// then searches no tree, so its time depends on these shapes only. A query refuses a stale handle.
    /// Default: none, all are seen.
    pub only: Option<QueryTarget>,
    /// For rays, solid shapes that contain the start are not seen. For moving shapes, shapes that they
    /// overlap at the start are not seen if the path leads out of them. Default: no.
    pub skip_inside: bool,
    /// The caller's own predicate, evaluated last, in no particular order, and only for shapes whose boxes
    /// the query meets. It may be asked more than once about the same shape in a batch.
    pub predicate: Option<&'a dyn Fn(BodyHandle, ShapeHandle) -> bool>,
}

impl std::fmt::Debug for QueryFilter<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("QueryFilter")
            .field("filter", &self.filter)
            .field("statics", &self.statics)
            .field("kinematic", &self.kinematic)
            .field("dynamic", &self.dynamic)
            .field("sensors", &self.sensors)
            .field("exclude_body", &self.exclude_body)
            .field("exclude_shape", &self.exclude_shape)
            .field("only", &self.only)
            .field("skip_inside", &self.skip_inside)
            .field("predicate", &self.predicate.is_some())
            .finish()
    }
}

impl Default for QueryFilter<'_> {
    fn default() -> Self {
        QueryFilter {
            filter: None,
            statics: true,
            kinematic: true,
            dynamic: true,
            sensors: false,
            exclude_body: None,
            exclude_shape: None,
            only: None,
            skip_inside: false,
            predicate: None,
        }
    }
}

impl<'a> QueryFilter<'a> {
    /// All shapes but sensors.
    pub fn new() -> Self {
        Self::default()
    }
    /// Only shapes of static bodies.
    pub fn only_static() -> Self {
        QueryFilter { kinematic: false, dynamic: false, ..Self::default() }
    }
    /// Only shapes of dynamic bodies.
    pub fn only_dynamic() -> Self {
        QueryFilter { statics: false, kinematic: false, ..Self::default() }
    }
    /// Only a body, or only a shape: all else costs nothing.
    pub fn only(target: impl Into<QueryTarget>) -> Self {
        QueryFilter { only: Some(target.into()), ..Self::default() }
    }
    /// Only shapes that would collide with one of this filter.
    pub fn with_filter(mut self, filter: Filter) -> Self {
        self.filter = Some(filter);
        self
    }
    /// Sensors too.
    pub fn with_sensors(mut self) -> Self {
        self.sensors = true;
        self
    }
    /// Not the shapes of this body.
    pub fn excluding(mut self, body: BodyHandle) -> Self {
        self.exclude_body = Some(body);
        self
    }
    /// Not this shape.
    pub fn excluding_shape(mut self, shape: ShapeHandle) -> Self {
        self.exclude_shape = Some(shape);
        self
    }
    /// Not shapes that a ray starts in, nor shapes that a moving shape overlaps at the start and moves out
    /// of.
    pub fn skipping_inside(mut self) -> Self {
        self.skip_inside = true;
        self
    }
    /// Only shapes for which this is true.
    pub fn with_predicate(mut self, predicate: &'a dyn Fn(BodyHandle, ShapeHandle) -> bool) -> Self {
        self.predicate = Some(predicate);
        self
    }

    /// The trees that the query has to search.
    pub(super) fn sorts(&self) -> Sorts {
        Sorts { statics: self.statics, movers: self.kinematic || self.dynamic }
    }
}

/// A filter with its handles looked up.
pub(super) struct Sees<'a> {
    world: &'a World,
    filter: &'a QueryFilter<'a>,
    exclude_body: usize,
    exclude_shape: u32,
    /// The filter sees every shape.
    all: bool,
}

impl<'a> Sees<'a> {
    pub(super) fn new(world: &'a World, filter: &'a QueryFilter<'a>) -> Sees<'a> {
        let body = filter.exclude_body.and_then(|body| world.index(body).ok());
        let shape = filter.exclude_shape.and_then(|shape| world.collider(shape).ok());
        let kinds = filter.statics && filter.kinematic && filter.dynamic;
        Sees {
            world,
            filter,
            exclude_body: body.unwrap_or(usize::MAX),
            exclude_shape: shape.unwrap_or(u32::MAX),
            all: kinds
                && (filter.sensors || world.needs.sensors == 0)
                && body.is_none()
                && shape.is_none()
                && filter.filter.is_none()
                && filter.predicate.is_none(),
        }
    }

    /// Whether the query sees a collider.
    #[inline]
    pub(super) fn sees(&self, index: u32, collider: &Collider) -> bool {
        self.all || self.looks(index, collider)
    }

    fn looks(&self, index: u32, collider: &Collider) -> bool {
        let (filter, body) = (self.filter, collider.body as usize);
        let kind = match self.world.bodies.kind[body] {
            BodyKind::Static => filter.statics,
            BodyKind::Kinematic => filter.kinematic,
            BodyKind::Dynamic => filter.dynamic,
        };
        kind && (filter.sensors || !collider.is_sensor())
            && body != self.exclude_body
            && index != self.exclude_shape
            && filter.filter.is_none_or(|f| f.allows(&collider.filter))
            && filter
                .predicate
                .is_none_or(|says| says(self.world.handle_of(body), self.world.shape_handle(index)))
    }
}
