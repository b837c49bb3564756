//! A sequence of calls out of bytes.

use super::call::{
    Call, Id, OfBody, OfCharacter, OfCoupling, OfJoint, OfRagdoll, OfShape, Query, Sequence, ShapeId, Ways,
};
use super::draw::{Draw, Mood};
use super::forms::{self, FIELD};
use super::things;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyKind, Budget, Geometry, ShapeDesc, Skeleton};

/// Calls, bodies and steps that a sequence has at most: it is to be quick.
const MOST_CALLS: usize = 70;
const MOST_BODIES: usize = 20;
const MOST_STEPS: usize = 45;
/// Steps that follow after the last call, so that what differs shows.
const LAST_STEPS: u8 = 20;
/// Bodies of the few worlds that are large enough for a step to be shared by threads.
const CROWD: usize = 140;

struct Generator<'a> {
    draw: Draw<'a>,
    calls: Vec<Call>,
    next: Id,
    bodies: Vec<Id>,
    /// Bodies with a height field.
    fields: Vec<Id>,
    joints: Vec<Id>,
    couplings: Vec<Id>,
    characters: Vec<Id>,
    ragdolls: Vec<(Id, usize)>,
    steps: usize,
}

pub fn sequence(mut draw: Draw<'_>) -> Sequence {
    draw.mood = match draw.below(16) {
        0..=10 => Mood::Tame,
        11..=13 => Mood::Extreme,
        _ => Mood::Bad,
    };
    let mood = std::mem::replace(&mut draw.mood, Mood::Tame);
    let mut settings = things::settings(&mut draw);
    if draw.chance(60) {
        settings.budget = things::budget(&mut draw);
    }
    let (strict, crowded) = (draw.bool(), draw.chance(5));
    let mut generator = Generator {
        draw,
        calls: Vec::new(),
        next: 0,
        bodies: Vec::new(),
        fields: Vec::new(),
        joints: Vec::new(),
        couplings: Vec::new(),
        characters: Vec::new(),
        ragdolls: Vec::new(),
        steps: 0,
    };
    generator.ground();
    if crowded {
        generator.crowd();
    }
    generator.draw.mood = mood;
    while !generator.draw.is_empty() && generator.calls.len() < MOST_CALLS && generator.steps < MOST_STEPS {
        let call = generator.call();
        generator.calls.extend(call);
    }
    generator.calls.push(Call::Step { dt: 1.0 / 60.0, times: LAST_STEPS, hooks: None });
    Sequence { settings, strict, calls: generator.calls.into_iter().enumerate().collect() }
}

impl Generator<'_> {
    fn id(&mut self, count: usize) -> Id {
        let id = self.next;
        self.next += count as Id;
        id
    }

    /// One of what was added, what is new more often; now and then what never was.
    fn known(&mut self, list: fn(&Self) -> &Vec<Id>) -> Id {
        let count = list(self).len();
        if count == 0 || (self.draw.mood == Mood::Bad && self.draw.chance(8)) {
            return Id::MAX;
        }
        let back = if self.draw.chance(150) { self.draw.below(count.min(5)) } else { self.draw.below(count) };
        list(self)[count - 1 - back]
    }

    fn body(&mut self) -> Id {
        self.known(|own| &own.bodies)
    }

    fn two_bodies(&mut self) -> [Id; 2] {
        let first = self.body();
        let mut second = self.body();
        if second == first && !self.bodies.is_empty() && !self.draw.chance(10) {
            second = self.draw.of(&self.bodies.clone());
        }
        [first, second]
    }

    fn two_joints(&mut self) -> [Id; 2] {
        [self.known(|own| &own.joints), self.known(|own| &own.joints)]
    }

    fn ground(&mut self) {
        let form = match self.draw.below(6) {
            0 => return,
            1 => Geometry::plane(),
            2 => self.draw.of(&forms::forms().fields),
            3 => self.draw.of(&forms::forms().meshes),
            _ => Geometry::cuboid(8.0, 0.5, 8.0),
        };
        let mut shape = forms::shape(&mut self.draw, form);
        (shape.sensor, shape.position) = (false, Vec3::ZERO);
        let body = BodyDesc::fixed().with_position(DVec3::Y * -0.5).with_shape(shape);
        self.add_body(body);
    }

    fn crowd(&mut self) {
        let id = self.id(CROWD);
        let at =
            |i: usize| DVec3::new((i % 12) as f64 - 6.0, 0.6 + (i / 12 % 3) as f64, (i / 36) as f64 - 3.0);
        let bodies = (0..CROWD).map(|i| {
            let form = forms::convex(&mut self.draw);
            BodyDesc::dynamic().with_position(at(i)).with_shape(ShapeDesc::new(form))
        });
        let call = Call::AddBodies(id, bodies.collect());
        self.bodies.extend(id..id + CROWD as Id);
        self.calls.push(call);
    }

    fn add_body(&mut self, body: BodyDesc) {
        let id = self.id(1);
        self.bodies.push(id);
        if body.shapes.iter().any(|shape| matches!(shape.geometry, Geometry::HeightField(_))) {
            self.fields.push(id);
        }
        self.calls.push(Call::AddBody(id, body));
    }

    fn call(&mut self) -> Option<Call> {
        let most = MOST_BODIES + if self.bodies.len() >= CROWD { CROWD } else { 0 };
        let room = self.bodies.len() < most;
        Some(match self.draw.below(128) {
            0..=15 if room => {
                let body = things::body(&mut self.draw);
                self.add_body(body);
                return None;
            }
            16 if room => {
                let bodies: Vec<_> =
                    (0..1 + self.draw.below(3)).map(|_| things::body(&mut self.draw)).collect();
                let id = self.id(bodies.len());
                self.bodies.extend(id..id + bodies.len() as Id);
                Call::AddBodies(id, bodies)
            }
            17 => Call::RemoveBodies(self.two_bodies()),
            18..=29 if !self.bodies.is_empty() => {
                let bodies = self.two_bodies();
                let (id, joint) = (self.id(1), things::joint(&mut self.draw, bodies));
                self.joints.push(id);
                Call::AddJoint(id, joint)
            }
            30..=35 if !self.joints.is_empty() => {
                let joints = self.two_joints();
                let (id, coupling) = (self.id(1), things::coupling(&mut self.draw, joints));
                self.couplings.push(id);
                Call::AddCoupling(id, coupling)
            }
            36 if room => self.ragdoll(),
            37 | 38 if !self.ragdolls.is_empty() => self.of_ragdoll(),
            39 => {
                let (id, settings) = (self.id(1), things::character(&mut self.draw));
                self.characters.push(id);
                Call::AddCharacter(id, settings, self.draw.place(), self.character_form())
            }
            40..=42 if !self.characters.is_empty() => self.of_character(),
            43..=61 => Call::Body(self.body(), self.of_body()),
            62..=71 => self.of_shape(),
            72..=78 if !self.joints.is_empty() => Call::Joint(self.known(|own| &own.joints), self.of_joint()),
            79..=82 if !self.couplings.is_empty() => {
                Call::Coupling(self.known(|own| &own.couplings), self.of_coupling())
            }
            83 => self.settings(),
            84 => Call::Origin(self.draw.place() * 10.0),
            85 | 86 => self.query(),
            87 => Call::Draw,
            88..=93 => {
                let (same, fresh, other) = (self.draw.bool(), self.draw.bool(), self.draw.chance(80));
                Call::Save(Ways { same, fresh: fresh || !same, other })
            }
            94..=96 => Call::Twice(self.draw.of(&[1, 2, 3, 6, 20])),
            97 => Call::GoBack(self.draw.below(3) as u8),
            _ => self.step(),
        })
    }

    fn step(&mut self) -> Call {
        let dt = match self.draw.below(16) {
            0 => 1.0 / 240.0,
            1 => 1.0 / 30.0,
            2 => 1.0 / 120.0,
            3 if self.draw.mood == Mood::Bad => self.draw.of(&[f32::NAN, 0.0, -1.0, 1e-30, 1e-5, 1.0, 11.0]),
            _ => 1.0 / 60.0,
        };
        let times = self.draw.of(&[1, 1, 1, 2, 2, 4, 8, 12]);
        self.steps += usize::from(times);
        let hooks = self.draw.chance(50).then(|| self.draw.below(256) as u8);
        Call::Step { dt, times, hooks }
    }

    fn settings(&mut self) -> Call {
        let mut settings = things::settings(&mut self.draw);
        if self.draw.chance(50) {
            settings.budget =
                if self.draw.chance(60) { Budget::NONE } else { things::budget(&mut self.draw) };
        }
        if self.draw.mood == Mood::Bad && self.draw.chance(60) {
            settings.substeps = self.draw.of(&[0, 65, u32::MAX]);
        }
        Call::Settings(settings)
    }

    fn query(&mut self) -> Call {
        let draw = &mut self.draw;
        let query = Query {
            at: draw.place(),
            path: draw.vector(10.0),
            spin: draw.vector(2.0),
            distance: draw.range(0.0, 5.0),
            rotation: draw.rotation(),
            sensors: draw.bool(),
        };
        Call::Query(query, forms::form(draw))
    }

    fn ragdoll(&mut self) -> Call {
        let draw = &mut self.draw;
        let bones = if draw.chance(60) { Skeleton::humanoid().bones.len() } else { 2 + draw.below(4) };
        let (at, rotation, velocity) = (draw.place(), draw.rotation(), draw.vector(5.0));
        let friction = draw.range(0.0, 5.0);
        // Its bodies come first, its joints after them.
        let id = self.id(2 * bones);
        self.bodies.extend(id..id + bones as Id);
        self.joints.extend(id + bones as Id..id + 2 * bones as Id);
        self.ragdolls.push((id, bones));
        Call::AddRagdoll { id, bones, at, rotation, velocity, friction }
    }

    fn of_ragdoll(&mut self) -> Call {
        let (id, bones) = self.draw.of(&self.ragdolls.clone());
        let what = if self.draw.chance(60) {
            OfRagdoll::Relax
        } else {
            let (pose, spring) = (things::pose(&mut self.draw, bones), things::spring(&mut self.draw));
            OfRagdoll::Motor { pose, spring, torque: self.draw.scale(1.0, 1e4) }
        };
        Call::Ragdoll(id, what)
    }

    fn character_form(&mut self) -> Option<Geometry> {
        self.draw.chance(80).then(|| forms::convex(&mut self.draw))
    }

    fn of_character(&mut self) -> Call {
        let id = self.known(|own| &own.characters);
        let what = match self.draw.below(12) {
            0 => OfCharacter::Remove,
            1 => {
                let settings = things::character(&mut self.draw);
                OfCharacter::Set(settings, self.draw.place(), self.character_form())
            }
            _ => {
                let (velocity, dt) = (self.draw.vector(6.0), self.draw.scale(0.008, 0.05));
                OfCharacter::Walk { velocity, dt, push: self.draw.bool() }
            }
        };
        Call::Character(id, what)
    }

    fn of_body(&mut self) -> OfBody {
        let draw = &mut self.draw;
        match draw.below(32) {
            0 | 1 => OfBody::Remove,
            2 | 3 => OfBody::Enable(draw.bool()),
            4 | 5 => OfBody::Pose(draw.place(), draw.rotation()),
            6 => OfBody::SamePose,
            7 | 8 => OfBody::Velocity(draw.vector(30.0), draw.vector(15.0)),
            9 => OfBody::LinearVelocity(draw.vector(10.0)),
            10 => OfBody::AngularVelocity(draw.vector(10.0)),
            11 | 12 => OfBody::MoveKinematic(draw.place(), draw.rotation(), draw.scale(0.01, 0.5)),
            13 => OfBody::Force(draw.vector(500.0), draw.vector(50.0)),
            14 => OfBody::ForceAt(draw.vector(500.0), draw.place()),
            15 => OfBody::Impulse(draw.vector(20.0), draw.place()),
            16 => OfBody::AngularImpulse(draw.vector(5.0)),
            17 => OfBody::Mass(things::mass(draw)),
            18..=20 => OfBody::Kind(draw.of(&[BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static])),
            21 => OfBody::UserData(draw.word()),
            22 => OfBody::GravityScale(draw.range(-1.0, 2.0)),
            23 => OfBody::Damping(draw.range(0.0, 5.0), draw.range(0.0, 5.0)),
            24 => OfBody::MaxSpeeds(
                draw.bool().then(|| draw.range(0.0, 20.0)),
                draw.bool().then(|| draw.range(0.0, 20.0)),
            ),
            25 => OfBody::Locks(draw.flags(80), draw.flags(80)),
            26 => OfBody::Continuous(things::continuous(draw)),
            27 => OfBody::SolvedAfter(things::after(draw)),
            28 => OfBody::Wake,
            29 => OfBody::SendToSleep,
            30 => OfBody::CanSleep(draw.bool()),
            _ => {
                let form = if draw.chance(40) { forms::form(draw) } else { forms::convex(draw) };
                OfBody::AddShape(forms::shape(draw, form))
            }
        }
    }

    fn of_shape(&mut self) -> Call {
        let what = self.draw.below(24);
        if what >= 18 && !self.fields.is_empty() {
            let body = self.draw.of(&self.fields.clone());
            return Call::Shape(ShapeId { body, place: 0 }, self.of_field());
        }
        let shape = ShapeId { body: self.body(), place: self.draw.below(3) as u8 };
        let draw = &mut self.draw;
        let what = match what {
            0 => OfShape::Remove,
            1 | 2 => OfShape::Material(forms::material(draw)),
            3 => OfShape::Filter(forms::filter(draw)),
            4 | 5 => OfShape::Listening(draw.bool(), draw.bool()),
            6 | 7 => OfShape::Sensor(draw.chance(90)),
            8 => OfShape::SensesStatic(draw.bool()),
            9 => OfShape::UserData(draw.word()),
            10..=14 => {
                OfShape::Geometry(if draw.chance(60) { forms::form(draw) } else { forms::convex(draw) })
            }
            15 => OfShape::Density(draw.scale(10.0, 8000.0)),
            _ => OfShape::Pose(draw.vector(0.6), draw.rotation()),
        };
        Call::Shape(shape, what)
    }

    fn of_field(&mut self) -> OfShape {
        let draw = &mut self.draw;
        let first = [draw.below(FIELD[0]), draw.below(FIELD[1])];
        let size = [draw.below(5), draw.below(5)];
        let count = if draw.chance(8) { 3 } else { size[0] * size[1] };
        if draw.bool() {
            OfShape::Heights(first, size, (0..count).map(|_| draw.range(-0.5, 0.5)).collect())
        } else {
            OfShape::Holes(first, size, (0..count).map(|_| draw.chance(100)).collect())
        }
    }

    fn of_joint(&mut self) -> OfJoint {
        let draw = &mut self.draw;
        match draw.below(16) {
            0 => OfJoint::Remove,
            1 => OfJoint::Limits((0..draw.below(3)).map(|_| things::limit(draw)).collect()),
            2 => OfJoint::Drives((0..draw.below(3)).map(|_| things::drive(draw)).collect()),
            3 | 4 => OfJoint::Limit(things::limit(draw)),
            5 | 6 => OfJoint::Motor(things::drive(draw)),
            7 => OfJoint::RemoveLimit(things::motion(draw), things::axes(draw)),
            8 => OfJoint::RemoveDrive(things::motion(draw), things::axis(draw)),
            9 => {
                let (motion, axis) = (things::motion(draw), things::axis(draw));
                OfJoint::Target(motion, axis, draw.range(-1.5, 1.5), draw.range(-5.0, 5.0))
            }
            10 => OfJoint::Frames(things::frames(draw)),
            11 => OfJoint::Collide(draw.bool()),
            12 => OfJoint::Strength(draw.scale(0.1, 1e4), draw.scale(0.1, 1e4)),
            13 => OfJoint::Thresholds(draw.scale(0.1, 1e4), draw.scale(0.1, 1e4)),
            14 => OfJoint::UserData(draw.word()),
            _ => OfJoint::SolvedAfter(things::after(draw)),
        }
    }

    fn of_coupling(&mut self) -> OfCoupling {
        let draw = &mut self.draw;
        match draw.below(8) {
            0 => OfCoupling::Remove,
            1 | 2 => OfCoupling::Factors([things::factor(draw), things::factor(draw)]),
            3 | 4 => OfCoupling::Range(things::range(draw)),
            5 | 6 => OfCoupling::Strength(things::strength(draw)),
            _ => OfCoupling::UserData(draw.word()),
        }
    }
}
