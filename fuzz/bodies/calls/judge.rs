//! What must hold of a sequence of calls, whatever they are.
//!
//! - Nothing panics, and what a world tells are numbers.
//! - A call that is refused has changed nothing.
//! - A snapshot, taken at any moment, is never refused, and a world that it was restored to tells the same as
//!   the original, call by call and step by step: hash, events, what joints bear, contacts.
//! - With a budget no more bytes are held than it allows.
//! - Drawing and queries work at any moment.

use super::budget::{adds, grown, over, rearranges};
use super::call::{Call, Query, Sequence, Ways};
use super::play::{Handles, step};
use super::told::{OfStep, Told, difference, different_state, not_finite};
use backstop::debug::{DebugDraw, DrawOptions, Ink};
use backstop::glam::DVec3;
use backstop::{
    Aabb, BodyDesc, Budget, Error, Geometry, MemoryReport, QueryFilter, Ray, Settings, ShapeCast, ShapeDesc,
    Snapshot, World,
};
use std::cell::Cell;

/// What did not hold.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The same for findings of the same sort.
    pub kind: String,
    pub text: String,
}

fn finding(kind: impl Into<String>, text: impl Into<String>) -> Finding {
    Finding { kind: kind.into(), text: text.into() }
}

/// A moment to which worlds are restored.
struct Mark {
    snapshot: Snapshot,
    handles: Handles,
    /// The call after it, and what was told before it.
    next: usize,
    told: usize,
    ways: Ways,
    /// What a new world has to have for a snapshot from bytes.
    assets: Vec<Geometry>,
    budget: Budget,
    additions: u32,
}

/// A world with the calls that it is made.
struct Player {
    world: World,
    handles: Handles,
    /// Whether the budget left anything out or refused anything: what is restored may then fare otherwise.
    tight: bool,
    /// Whether a new budget may be less than what bodies can't do without, or a call had joints arranged
    /// anew, whose batches no budget limits then (docs/memory.md).
    lowered: bool,
    /// What was held after the last call.
    held: MemoryReport,
    /// Calls after which the world may hold more.
    additions: u32,
    strict: bool,
}

/// Where a player's snapshots are: taken by it, or by the one that it follows.
enum Marks<'a> {
    Own(&'a mut Vec<Mark>),
    /// With the number of those that were passed.
    Known(&'a [Mark], usize),
}

impl Marks<'_> {
    fn back(&self, count: u8) -> Option<&Mark> {
        let known = match self {
            Marks::Own(marks) => &marks[..],
            Marks::Known(marks, passed) => &marks[..*passed],
        };
        known.len().checked_sub(1 + usize::from(count)).map(|place| &known[place])
    }
}

type Hear<'a> = dyn FnMut(Told) -> Result<(), Finding> + 'a;

/// Plays a sequence and judges it.
pub fn judge(sequence: &Sequence) -> Result<(), Finding> {
    let settings = sequence.settings.clone();
    let Ok(world) = World::new(settings.clone()) else { return Ok(()) };
    let mut original = Player::new(world, sequence.strict);
    let (mut marks, mut told) = (Vec::new(), Vec::new());
    original.play(&sequence.calls, &mut Marks::Own(&mut marks), 0, &mut |new| {
        told.push(new);
        Ok(())
    })?;
    for i in 0..marks.len() {
        let Mark { ways, .. } = marks[i];
        if ways.fresh {
            let world = fresh(&marks[i].assets)?;
            follow("new", Player::new(world, false), sequence, &marks, i, &told, original.tight)?;
        }
        if ways.other {
            follow(
                "other",
                Player::new(elsewhere(sequence), false),
                sequence,
                &marks,
                i,
                &told,
                original.tight,
            )?;
        }
        if ways.same {
            let mut same = std::mem::replace(&mut original, Player::new(World::default(), false));
            let tight = same.tight;
            same.strict = false;
            original = follow("same", same, sequence, &marks, i, &told, tight)?;
            original.tight = tight;
        }
    }
    if original.tight {
        return Ok(());
    }
    let large = sequence.calls.iter().any(|(_, call)| matches!(call, Call::AddBodies(_, b) if b.len() > 100));
    if large {
        twin("two threads", sequence, &told, &|settings| settings.threads = 2)?;
    }
    let limits = |call: &Call| matches!(call, Call::Settings(settings) if !settings.budget.is_none());
    if !sequence.settings.budget.is_none() || sequence.calls.iter().any(|(_, call)| limits(call)) {
        twin("without a budget", sequence, &told, &|settings| settings.budget = Budget::NONE)?;
    }
    Ok(())
}

/// The same with other settings on which nothing depends.
fn twin(
    name: &str,
    sequence: &Sequence,
    told: &[Told],
    change: &dyn Fn(&mut Settings),
) -> Result<(), Finding> {
    let mut settings = sequence.settings.clone();
    change(&mut settings);
    let Ok(world) = World::new(settings) else { return Ok(()) };
    let calls = sequence.calls.iter().cloned().map(|(place, mut call)| {
        if let Call::Settings(settings) = &mut call {
            change(settings);
        }
        (place, call)
    });
    let calls: Vec<_> = calls.collect();
    let mut place = 0;
    let mut marks = Vec::new();
    let mut two = Player::new(world, false);
    let mut compared = Compared::new(name);
    two.play(&calls, &mut Marks::Own(&mut marks), 0, &mut |new| {
        place += 1;
        compared.compare(&told[place - 1], &new)
    })?;
    compared.end()
}

/// A new world with the geometry that a snapshot needs.
fn fresh(assets: &[Geometry]) -> Result<World, Finding> {
    let mut world = World::default();
    let shapes = assets.iter().cloned().map(ShapeDesc::new);
    let body = BodyDesc::fixed().with_position(DVec3::Y * -1000.0).with_shapes(shapes);
    world.add_body(&body).map_err(|error| finding("geometry refused", error.to_string()))?;
    Ok(world)
}

/// A world in which something else happened: some of the calls, with other settings.
fn elsewhere(sequence: &Sequence) -> World {
    let settings = Settings::default().with_sleeping(!sequence.settings.sleeping).with_substeps(3);
    let calls = sequence.calls.iter().enumerate().filter(|(i, _)| i % 3 != 1).map(|(_, c)| c.clone());
    let calls: Vec<_> =
        calls.filter(|(_, call)| !matches!(call, Call::Settings(_) | Call::Twice(_))).collect();
    let mut player = Player::new(World::new(settings).expect("usual settings"), false);
    let mut marks = Vec::new();
    // What is wrong there was told by the original.
    drop(player.play(&calls[..calls.len() / 2], &mut Marks::Own(&mut marks), 0, &mut |_| Ok(())));
    player.world
}

/// Restores a mark, makes the calls that followed, and compares what is told.
fn follow(
    way: &str,
    mut player: Player,
    sequence: &Sequence,
    marks: &[Mark],
    which: usize,
    told: &[Told],
    tight: bool,
) -> Result<Player, Finding> {
    let mark = &marks[which];
    let kept = match way {
        "new" => Snapshot::from_bytes(&mark.snapshot.to_whole_bytes())
            .map_err(|error| finding(format!("own bytes refused ({way}): {error}"), ""))?,
        _ => mark.snapshot.clone(),
    };
    match player.world.restore(&kept) {
        Err(Error::Budget { .. })
            if player.world.settings().budget != mark.budget || player.additions != mark.additions =>
        {
            return Ok(player);
        }
        Err(error) => return Err(refused(way, &error)),
        Ok(()) => player.handles = mark.handles.clone(),
    }
    player.assert_is(&kept)?;
    if way != "same" {
        // Its own was endless, so that it had room for what is restored.
        let settings = player.world.settings().clone().with_budget(mark.budget);
        player
            .world
            .set_settings(settings)
            .map_err(|error| finding("settings refused", error.to_string()))?;
        player.lowered = true;
    }
    draw(&player.world);
    player.tight |= tight;
    let unlimited = player.world.settings().budget == mark.budget || !player.tight;
    let mut compared = Compared::new(format!("restored ({way})"));
    let mut place = mark.told;
    let calls = &sequence.calls[mark.next..];
    player.play(calls, &mut Marks::Known(marks, which + 1), mark.next, &mut |new| {
        place += 1;
        let known = told.get(place - 1).ok_or_else(|| finding("more is told than was", ""))?;
        // Once the budget has left something out, the two may fare otherwise.
        if tight || !unlimited { Ok(()) } else { compared.compare(known, &new) }
    })?;
    compared.end()?;
    Ok(player)
}

/// What two worlds told, call by call.
struct Compared {
    way: String,
    /// Where first the states differed although nothing else did. It counts if nothing else ever does.
    state: Option<Finding>,
    /// The budget refused one of them something: from then on they may fare otherwise.
    tight: bool,
}

impl Compared {
    fn new(way: impl Into<String>) -> Compared {
        Compared { way: way.into(), state: None, tight: false }
    }

    fn compare(&mut self, known: &Told, new: &Told) -> Result<(), Finding> {
        self.tight |= [known, new].iter().any(|told| told.is_tight());
        if self.tight {
            return Ok(());
        }
        if let Some(text) = difference(known, new) {
            let kind = format!("{}: {} differ", self.way, text.split(" differ").next().unwrap_or_default());
            let before = self.state.take().map(|state| format!("; before that, {}", state.text));
            return Err(finding(kind, text + &before.unwrap_or_default()));
        }
        if self.state.is_none()
            && let Some((part, text)) = different_state(known, new)
        {
            self.state =
                Some(finding(format!("{}: only the {part} of a later snapshot differ", self.way), text));
        }
        Ok(())
    }

    fn end(self) -> Result<(), Finding> {
        self.state.map_or(Ok(()), Err)
    }
}

impl Player {
    fn new(world: World, strict: bool) -> Player {
        Player {
            world,
            handles: Handles::default(),
            tight: false,
            lowered: false,
            held: MemoryReport::default(),
            additions: 0,
            strict,
        }
    }

    /// Makes calls, the first of which is call number `first`; `hear` is told what the world tells after each
    /// call and step.
    fn play(
        &mut self,
        calls: &[(usize, Call)],
        marks: &mut Marks<'_>,
        first: usize,
        hear: &mut Hear<'_>,
    ) -> Result<(), Finding> {
        let heard = Cell::new(match marks {
            Marks::Own(_) => 0,
            Marks::Known(known, passed) => known[*passed - 1].told,
        });
        for (i, (place, call)) in calls.iter().enumerate() {
            let made = match call {
                Call::Save(ways) => {
                    self.save(*ways, marks, first + i + 1, heard.get());
                    Ok(())
                }
                call => self.make(call, marks, &mut |told| {
                    heard.set(heard.get() + 1);
                    hear(told)
                }),
            };
            made.map_err(|f| Finding { text: format!("at call {place}: {}", f.text), ..f })?;
        }
        Ok(())
    }

    fn make(&mut self, call: &Call, marks: &Marks<'_>, hear: &mut Hear<'_>) -> Result<(), Finding> {
        match call {
            Call::Step { dt, times, hooks } => {
                for i in 0..*times {
                    let told = self.step(*dt, *hooks)?;
                    hear(told).map_err(|f| Finding { text: format!("step {i}: {}", f.text), ..f })?;
                }
            }
            Call::Twice(steps) => self.twice(*steps, hear)?,
            Call::GoBack(count) => {
                if let Some(mark) = marks.back(*count) {
                    let result = self.restore(&mark.snapshot, mark.budget, mark.additions)?;
                    if result.is_ok() {
                        self.handles = mark.handles.clone();
                    }
                    hear(Told { result, hash: self.world.state_hash(), step: None })?;
                }
            }
            Call::Query(query, geometry) => {
                let before = self.world.state_hash();
                let answered = ask(&self.world, query, geometry);
                self.note(&answered);
                if self.world.state_hash() != before {
                    return Err(finding("a query changed the world", ""));
                }
                self.check("a query")?;
            }
            Call::Draw => draw(&self.world),
            call => {
                let before = self.strict.then(|| bytes(&self.world));
                let result = self.handles.call(&mut self.world, call);
                self.note(&result);
                if let (Err(error), Some(before)) = (&result, before)
                    && bytes(&self.world) != before
                {
                    let kind = format!("what was refused changed the world: {}", name(call));
                    return Err(finding(kind, error.to_string()));
                }
                let loosens =
                    matches!(call, Call::Settings(_)) || (rearranges(call) && self.world.joint_count() > 0);
                self.lowered |= result.is_ok() && loosens;
                self.additions += u32::from(result.is_ok() && adds(call));
                self.check(&name(call))?;
                hear(Told {
                    result: result.map_err(|e| e.to_string()),
                    hash: self.world.state_hash(),
                    step: None,
                })?;
            }
        }
        Ok(())
    }

    fn step(&mut self, dt: f32, hooks: Option<u8>) -> Result<Told, Finding> {
        let result = step(&mut self.world, dt, hooks);
        self.note(&result);
        let report = self.world.report();
        self.tight |= report.shed > 0 || (report.events_lost > 0 && !self.world.settings().budget.is_none());
        self.check(if result.is_ok() { "a step" } else { "a refused step" })?;
        let step = result.is_ok().then(|| OfStep::of(&self.world, &self.handles));
        Ok(Told { result: result.map_err(|e| e.to_string()), hash: self.world.state_hash(), step })
    }

    /// A snapshot, some steps, and the same steps again after it was restored.
    fn twice(&mut self, steps: u8, hear: &mut Hear<'_>) -> Result<(), Finding> {
        let mut snapshot = Snapshot::new();
        self.world.snapshot(&mut snapshot);
        let handles = self.handles.clone();
        let mut first = Vec::new();
        for _ in 0..steps {
            first.push(self.step(1.0 / 60.0, None)?);
        }
        drop(self.restore(&snapshot, self.world.settings().budget, self.additions)?);
        self.handles = handles;
        draw(&self.world);
        let mut compared = Compared::new("restored (twice)");
        for known in &first {
            let new = self.step(1.0 / 60.0, None)?;
            if !self.tight {
                compared.compare(known, &new)?;
            }
        }
        compared.end()?;
        first.into_iter().try_for_each(hear)
    }

    /// Back to a snapshot, which nothing but the budget may refuse, and that only where something was added:
    /// then the inner result is the error.
    fn restore(
        &mut self,
        snapshot: &Snapshot,
        budget: Budget,
        additions: u32,
    ) -> Result<Result<(), String>, Finding> {
        let result = self.world.restore(snapshot);
        match &result {
            Err(Error::Budget { .. })
                if self.world.settings().budget != budget || self.additions != additions =>
            {
                self.tight = true;
            }
            Err(error) => return Err(refused("same", error)),
            Ok(()) => {}
        }
        if result.is_ok() {
            self.assert_is(snapshot)?;
        }
        self.check("restore")?;
        Ok(result.map_err(|error| error.to_string()))
    }

    /// What was saved was restored: another snapshot is the same.
    fn assert_is(&self, snapshot: &Snapshot) -> Result<(), Finding> {
        let mut again = Snapshot::new();
        self.world.snapshot(&mut again);
        let same = again.hash() == snapshot.hash();
        if same { Ok(()) } else { Err(finding("a snapshot was not restored whole", "")) }
    }

    fn save(&mut self, ways: Ways, marks: &mut Marks<'_>, next: usize, told: usize) {
        match marks {
            Marks::Known(_, passed) => *passed += 1,
            Marks::Own(marks) => {
                let mut snapshot = Snapshot::new();
                self.world.snapshot(&mut snapshot);
                let (handles, budget) = (self.handles.clone(), self.world.settings().budget);
                let assets = assets(&self.world);
                let additions = self.additions;
                marks.push(Mark { snapshot, handles, next, told, ways, assets, budget, additions });
            }
        }
    }

    fn note<T>(&mut self, result: &Result<T, Error>) {
        self.tight |= matches!(result, Err(Error::Budget { .. }));
    }

    fn check(&mut self, after: &str) -> Result<(), Finding> {
        if let Some(what) = not_finite(&self.world, &self.handles) {
            return Err(finding(format!("no number after {after}"), what));
        }
        let before = std::mem::replace(&mut self.held, self.world.memory());
        match over(&self.world, 0) {
            // What is promised may be more than a budget that was lowered allows.
            None if after == "a step" => {
                self.lowered &= over(&self.world, self.world.memory_promised()).is_some();
            }
            Some(what) if !self.lowered => {
                let grew = grown(&before, &self.held);
                return Err(finding(format!("over budget after {after}"), format!("{what}; {grew}")));
            }
            _ => {}
        }
        Ok(())
    }
}

/// The world's own snapshot was; the kind has no numbers.
fn refused(way: &str, error: &Error) -> Finding {
    let plain = error.to_string().replace(|c: char| c.is_ascii_digit(), "");
    finding(format!("own snapshot refused ({way}): {plain}"), error.to_string())
}

/// What a call is, without its numbers.
fn name(call: &Call) -> String {
    let text = format!("{call:?}");
    let text = match call {
        Call::Body(..) | Call::Shape(..) | Call::Joint(..) | Call::Coupling(..) | Call::Character(..) => text
            .splitn(3, ['(', ','])
            .filter(|part| part.parse::<u16>().is_err())
            .collect::<Vec<_>>()
            .join(" "),
        _ => text,
    };
    let words = text.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| !word.is_empty());
    let words: Vec<_> = words.filter(|word| !matches!(*word, "ShapeId" | "body" | "place")).take(2).collect();
    words.join(" ")
}

fn bytes(world: &World) -> Vec<u8> {
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    snapshot.to_whole_bytes()
}

/// Hulls, meshes and height fields of a world.
fn assets(world: &World) -> Vec<Geometry> {
    let shapes = world.bodies().filter_map(|body| world.shapes(body).ok()).flatten();
    let of_shapes = shapes.filter_map(|shape| world.geometry(shape).ok().cloned());
    let characters = world.characters().filter_map(|character| world.character(character).ok());
    let all = of_shapes.chain(characters.map(|character| character.shape().0));
    all.filter(|form| matches!(form, Geometry::Hull(_) | Geometry::Mesh(_) | Geometry::HeightField(_)))
        .collect()
}

/// Draws nothing.
struct Blank;

impl DebugDraw for Blank {
    fn line(&mut self, from: DVec3, to: DVec3, _: Ink) {
        std::hint::black_box((from, to));
    }
}

fn draw(world: &World) {
    world.draw(&DrawOptions::everything(), &mut Blank);
    let islands = DrawOptions { islands: true, ..DrawOptions::default() };
    world.draw(&islands, &mut Blank);
}

/// Every query about a place.
fn ask(world: &World, query: &Query, geometry: &Geometry) -> Result<(), Error> {
    let Query { at, path, spin, distance, rotation, sensors } = *query;
    let mut filter = QueryFilter::new();
    filter.sensors = sensors;
    let ray = Ray::new(at, path);
    let (mut rays, mut shapes, mut overlaps, mut points) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let cast = ShapeCast::new(geometry, at, path).with_rotation(rotation);
    let first = world.cast_ray(&ray, &filter)?;
    let mut many = [None; 40];
    let all_rays: Vec<Ray> = (0..40).map(|i| Ray::new(at + DVec3::X * f64::from(i) * 0.05, path)).collect();
    world.cast_rays(&all_rays, &filter, &mut many)?;
    world.cast_ray_all(&ray, &filter, &mut rays)?;
    assert_eq!(many[0], first, "one ray and many");
    assert_eq!(rays.is_empty(), first.is_none(), "one ray and all that it hits");
    assert_eq!(world.cast_ray_any(&ray, &filter)?, first.is_some(), "whether and what a ray hits");
    for hit in &rays {
        assert!(
            hit.point.is_finite() && hit.normal.is_finite() && (0.0..=1.0).contains(&hit.fraction),
            "{hit:?}"
        );
    }
    world.closest_point_all(at, distance, &filter, &mut points)?;
    world.closest_point_any(at, distance, &filter)?;
    world.closest_point(at, distance, &filter)?;
    for found in &points {
        assert!(
            found.point.is_finite() && found.normal.is_finite() && found.distance.is_finite(),
            "{found:?}"
        );
    }
    let half = DVec3::splat(f64::from(distance.abs().min(1e6)));
    world.overlap_aabb(&Aabb { min: at - half, max: at + half }, &filter, &mut overlaps)?;
    world.overlap(geometry, at, rotation, &filter, &mut overlaps)?;
    world.overlap_any(geometry, at, rotation, &filter)?;
    world.cast_shape_all(&cast, &filter, &mut shapes)?;
    world.cast_shape_any(&cast, &filter)?;
    world.cast_shape(&cast, &filter)?;
    world.cast_shape_all(&cast.with_spin(spin), &filter, &mut shapes)?;
    for hit in &shapes {
        let finite = hit.point.is_finite() && hit.normal.is_finite() && hit.depth.is_finite();
        assert!(finite && (0.0..=1.0).contains(&hit.fraction), "{hit:?}");
    }
    Ok(())
}
