//! Contacts of the last step for the caller, in world space.

use super::World;
use crate::body::{Pose, exp_map};
use crate::broad_phase::{Pair, Places};
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::math::Quat;
use crate::narrow_phase::{ContactRef, MAX_POINTS, NO_CONTACT, Point, Relative};
use glam::{DVec3, Vec3};

/// A contact of a body with another one: up to four points with one normal. Two shapes may have several, if
/// one is a mesh or a height field.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BodyContact {
    /// The shape of the body that was asked for, and the other one.
    pub shapes: [ShapeHandle; 2],
    /// The body that was asked for, and the other one.
    pub bodies: [BodyHandle; 2],
    /// Unit, from the first shape to the second: the contact pushes the body that was asked for against it.
    pub normal: Vec3,
    points: [ContactPoint; MAX_POINTS],
    count: u8,
}

/// A point of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactPoint {
    /// Midway between the two surfaces, where the bodies are now, in the world [m].
    pub position: DVec3,
    /// Distance of the surfaces along the normal where the bodies are now, negative in overlap [m].
    pub separation: f32,
    /// Normal impulse of the last substep, at least zero [N s]: divided by the length of the substep, the
    /// normal force.
    pub impulse: f32,
}

impl BodyContact {
    /// Its points: at least one.
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..usize::from(self.count)]
    }

    /// Sum of the normal impulses of its points in the last substep, at least zero [N s].
    pub fn impulse(&self) -> f32 {
        self.points().iter().map(|point| point.impulse).sum()
    }
}

/// # Contacts
impl World {
    /// Contacts of a body in the last step: with shapes that it touched or that pushed it, none that hooks
    /// vetoed; those with static geometry among them. Sensors have none. In the order of the world's pairs,
    /// which depends only on the past, those of sleeping islands last.
    ///
    /// Takes time with the body's neighbours, not with the world: 0.5 µs for one of 2000 boxes on a floor,
    /// where a look through all pairs took 3 to 5 µs (tests/world/reading.rs). All pairs are looked through
    /// for a plane and for a body with very many neighbours, such as a floor; all of the island for a body
    /// that sleeps, and all that sleep for static and kinematic ones. Allocates nothing. For the contacts of
    /// most bodies go once through [`World::contacts`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// for _ in 0..180 {
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// // In each of a step's four substeps it bears a quarter of the weight's impulse.
    /// let impulse: f32 = world.contacts_of(body)?.map(|contact| contact.impulse()).sum();
    /// let weight = 9.81 * world.mass(body)? / 60.0 / 4.0;
    /// assert!((impulse - weight).abs() < 0.02 * weight, "{impulse} N s, not {weight}");
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn contacts_of(&self, body: BodyHandle) -> Result<impl Iterator<Item = BodyContact> + '_, Error> {
        let index = self.index(body)?;
        let shapes = self.bodies.colliders[index].as_slice();
        // With one shape, as most have, a pair is told without a look at its colliders.
        let own = move |c: u32| match shapes {
            [one] => c == *one,
            _ => self.colliders.summaries[c as usize].body as usize == index,
        };
        // An awake dynamic body has none with islands that sleep.
        let slot = self.bodies.slot[index];
        let asleep = (index >= self.bodies.dynamic()).then(|| self.sleep.sleeping_pairs_for(slot));
        let all = &self.broad.pairs;
        let places = self.broad.places_of(shapes);
        let rest = if places.is_none() { all.as_slice() } else { &[] };
        let few = places.into_iter().flat_map(Places::into_iter).map(|place| &all[place]);
        let pairs = few.chain(rest).chain(asleep.into_iter().flatten());
        let met = pairs.filter(move |pair| {
            pair.contact != NO_CONTACT
                && (own(pair.a) || own(pair.b))
                && self.events.vetoed.binary_search(&(pair.a, pair.b)).is_err()
        });
        Ok(met.flat_map(move |pair| self.contacts_of_pair(pair, own(pair.b))))
    }

    /// All contacts of the last step, each once, by the rules of [`World::contacts_of`]; which of its two
    /// bodies comes first only the past decides.
    pub fn contacts(&self) -> impl Iterator<Item = BodyContact> + '_ {
        let pairs = self.broad.pairs.iter().chain(self.sleep.sleeping_pairs());
        let met = pairs.filter(|pair| {
            pair.contact != NO_CONTACT && self.events.vetoed.binary_search(&(pair.a, pair.b)).is_err()
        });
        met.flat_map(|pair| self.contacts_of_pair(pair, false))
    }

    /// The contacts of a pair that touch or pushed; `turned`: with the second shape as the first.
    fn contacts_of_pair(&self, pair: &Pair, turned: bool) -> impl Iterator<Item = BodyContact> + '_ {
        let touch = self.settings.measures().touch;
        let met = self.contacts.chain(pair.contact).filter(move |(_, contact)| contact.touches(touch));
        met.map(move |(_, contact)| self.body_contact(contact, turned))
    }

    fn body_contact(&self, contact: ContactRef<'_>, turned: bool) -> BodyContact {
        let now = relative_now(self, contact);
        let bodies = [contact.a, contact.b].map(|c| self.colliders.summaries[c as usize].body as usize);
        let mut found = BodyContact {
            shapes: [contact.a, contact.b].map(|c| self.shape_handle(c)),
            bodies: bodies.map(|index| self.handle_of(index)),
            normal: Vec3::ZERO,
            points: Default::default(),
            count: contact.points().len() as u8,
        };
        let gaps = contact.separations(&now);
        for ((to, point), gap) in found.points.iter_mut().zip(contact.points()).zip(gaps) {
            let Place { on_a, normal, gap } = place_of(self, contact, point, gap, &now);
            let position = on_a + (normal * (0.5 * gap)).as_dvec3();
            *to = ContactPoint { position, separation: gap, impulse: point.impulse };
            found.normal = normal;
        }
        if turned {
            found.shapes.reverse();
            found.bodies.reverse();
            found.normal = -found.normal;
        }
        found
    }
}

/// Pose of the second shape in the frame of the first, now.
pub(crate) fn relative_now(world: &World, contact: ContactRef<'_>) -> Relative {
    let [a, b] = [contact.a, contact.b].map(|c| world.collider_pose(c));
    let back = a.rotation.conjugate();
    Relative { position: back * (b.position - a.position).as_vec3(), rotation: back * b.rotation }
}

/// A point of contact where the bodies are now.
pub(crate) struct Place {
    /// On the surface of the first shape [m].
    pub(crate) on_a: DVec3,
    /// Unit, from the first shape to the second.
    pub(crate) normal: Vec3,
    /// From there to the surface of the second, negative in overlap [m].
    pub(crate) gap: f32,
}

/// Where a point of contact is now. `gap`: its separation now, if the bodies did not roll; `now`: the pose of
/// the second shape in the frame of the first.
pub(crate) fn place_of(
    world: &World,
    contact: ContactRef<'_>,
    point: &Point,
    gap: f32,
    now: &Relative,
) -> Place {
    if contact.fraction > 0.0 {
        ahead(world, contact, point)
    } else {
        at_start(world, contact, point, gap, now)
    }
}

/// A point that was found at the poses of the start of a step.
fn at_start(world: &World, contact: ContactRef<'_>, point: &Point, gap: f32, now: &Relative) -> Place {
    let a = world.collider_pose(contact.a);
    if is_round(world, contact) {
        // The point does not rotate with a rolling shape.
        let start = world.colliders.poses[contact.a as usize].rotation;
        let normal = start * contact.normal;
        let on_a = start * point.position - normal * (0.5 * point.found);
        return Place { on_a: a.position + on_a.as_dvec3(), normal, gap };
    }
    // The point moves with both bodies. Midway between its two positions is midway between the surfaces.
    let turn = now.rotation * contact.found_at.rotation.conjugate();
    let on_b = now.position + turn * (point.position - contact.found_at.position);
    let on_a = (point.position + on_b) * 0.5 - contact.normal * (0.5 * gap);
    Place { on_a: a.position + (a.rotation * on_a).as_dvec3(), normal: a.rotation * contact.normal, gap }
}

/// Whether the first shape touches with a round side.
fn is_round(world: &World, contact: ContactRef<'_>) -> bool {
    let kind = world.colliders.all[contact.a as usize].kind;
    kind.is_round() && (kind.is_smooth() || contact.count < 3)
}

/// A point that was found at a first touch within the step. Its separation was extrapolated back from there
/// along the predicted motion, to first order; here it is carried forward along the actual motion.
fn ahead(world: &World, contact: ContactRef<'_>, point: &Point) -> Place {
    let [a, b] = [contact.a, contact.b].map(|c| Way::of(world, c));
    let normal = a.shape * contact.normal;
    let arm_a = a.lever + a.shape * point.position;
    let between = (a.start.position - b.start.position).as_vec3();
    let arm_b = arm_a + between + (a.predicted.0 - b.predicted.0) * contact.fraction;
    let closing = |(moved_a, turn_a): (Vec3, Vec3), (moved_b, turn_b): (Vec3, Vec3)| {
        normal.dot(moved_a - moved_b + turn_a.cross(arm_a) - turn_b.cross(arm_b))
    };
    // Other points than those that touched first were still apart there.
    let apart = point.found - (contact.fraction * closing(a.predicted, b.predicted)).max(0.0);
    let gap = point.found - closing(a.gone, b.gone);
    let on_a = arm_a - normal * (0.5 * apart);
    let rest = if is_round(world, contact) { 0.0 } else { 1.0 - contact.fraction };
    Place { on_a: a.end + (exp_map(a.gone.1 * rest) * on_a).as_dvec3(), normal, gap }
}

/// The motion of a collider's body in the last step: displacements [m] and rotation vectors [rad].
struct Way {
    start: Pose,
    /// Rotation of the shape at the start.
    shape: Quat,
    /// From the body's centre of mass to the shape's origin at the start [m].
    lever: Vec3,
    end: DVec3,
    predicted: (Vec3, Vec3),
    gone: (Vec3, Vec3),
}

impl Way {
    fn of(world: &World, c: u32) -> Way {
        let collider = &world.colliders.all[c as usize];
        let (placed, end) = (&world.colliders.poses[c as usize], &world.bodies.pose[collider.body as usize]);
        let rotation = placed.rotation * collider.rotation.conjugate();
        let lever = rotation * collider.position;
        let start = Pose { position: placed.position - lever.as_dvec3(), rotation };
        let motion = world.buffers.forces.motion.get(collider.body as usize);
        Way {
            shape: placed.rotation,
            lever,
            end: end.position,
            predicted: motion.map_or((Vec3::ZERO, Vec3::ZERO), |m| (m.linear, m.angular)),
            gone: ((end.position - start.position).as_vec3(), rotation.turn_to(end.rotation)),
            start,
        }
    }
}
