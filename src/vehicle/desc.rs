//! What a vehicle is made of.

use crate::config::fields;
use crate::error::{Error, each};
use crate::limits;
use crate::shape::Filter;
use glam::Vec3;

fields! {
    /// An engine: its torque by its speed.
    #[derive(Clone, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct EngineDesc {
        /// Points of the curve at full throttle, rising: speed [rpm] and torque [N m]. Between them it is
        /// linear; below the first the torque is that of the first, above the last there is none.
        with_torque(torque: Vec<[f32; 2]>) =
            vec![[1000.0, 200.0], [2500.0, 280.0], [4500.0, 300.0], [6500.0, 240.0]];
        /// The speed that it does not fall below [rpm].
        with_idle(idle: f32) = 800.0, "engine idle" [0.0, 1e6] "in 0..=1e6";
        /// Its drag without throttle from twice the idle speed on, none at idle [N m].
        with_braking(braking: f32) = 40.0, "engine braking" [0.0, 1e12] "in 0..=1e12";
    }
}

fields! {
    /// Gears, and when they are shifted.
    #[derive(Clone, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct GearboxDesc {
        /// Turns of the shaft before the final drive per turn after it, for each forward gear; above zero.
        with_ratios(ratios: Vec<f32>) = vec![3.6, 2.1, 1.4, 1.0, 0.8];
        /// The same of the reverse gear.
        with_reverse(reverse: f32) = 3.3, "reverse gear" [1e-3, 1e3] "in 0.001..=1000";
        /// Turns before the final drive per turn of a wheel.
        with_final_drive(final_drive: f32) = 3.7, "final drive" [1e-3, 1e3] "in 0.001..=1000";
        /// Above this the next gear is taken [rpm].
        with_shift_up(shift_up: f32) = 5500.0, "shift up" [0.0, 1e6] "in 0..=1e6";
        /// Below this the gear before is taken [rpm].
        with_shift_down(shift_down: f32) = 2200.0, "shift down" [0.0, 1e6] "in 0..=1e6";
        /// How long a shift takes, without torque [s].
        with_shift_time(shift_time: f32) = 0.2, "shift time" [0.0, 60.0] "in 0..=60";
    }
}

fields! {
    /// A wheel with its spring and brakes.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct WheelDesc {
        /// Where its hub is while the spring is extended, in the axes of the chassis and from its origin [m].
        with_position(position: Vec3, into) = Vec3::ZERO;
        /// Its radius [m].
        with_radius(radius: f32) = 0.35, "wheel radius" [limits::MIN_LENGTH, limits::MAX_LENGTH]
            "in 1e-6..=1e6";
        /// Its width [m]: of wheels that are bodies.
        with_width(width: f32) = 0.2, "wheel width" [limits::MIN_LENGTH, limits::MAX_LENGTH]
            "in 1e-6..=1e6";
        /// Its mass [kg]: as its inertia in turning, which is that of a disc, and of wheels that are bodies.
        with_mass(mass: f32) = 20.0, "wheel mass" [1e-6, 1e12] "in 1e-6..=1e12";
        /// How far the hub can rise from where it is while the spring is extended [m].
        with_travel(travel: f32) = 0.3, "wheel travel" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// Force of the spring per compression [N/m]; beyond the travel ten times that.
        with_stiffness(stiffness: f32) = 30_000.0, "wheel stiffness" [0.0, 1e12] "in 0..=1e12";
        /// Force of the damper per speed of the hub [N s/m].
        with_damping(damping: f32) = 3_500.0, "wheel damping" [0.0, 1e12] "in 0..=1e12";
        /// Grip: the most force along the ground per load.
        with_friction(friction: f32) = 1.0, "wheel friction" [0.0, 1e6] "in 0..=1e6";
        /// Share of the grip that a tyre keeps while it slides.
        with_sliding(sliding: f32) = 0.85, "wheel sliding" [0.0, 1.0] "in 0..=1";
        /// The angle between where the wheel points and where it goes at which the sideways force is
        /// greatest [rad]. Up to it the force rises linearly; from there it falls to the share that slides at
        /// three times the angle.
        with_slip_angle(slip_angle: f32) = 0.12, "wheel slip angle" [1e-3, 1.5] "in 0.001..=1.5";
        /// Resistance to rolling per load.
        with_rolling_resistance(rolling_resistance: f32) = 0.01, "rolling resistance" [0.0, 1.0]
            "in 0..=1";
        /// Whether it is steered.
        with_steered(steered: bool) = false;
        /// Its part of the engine's torque: shares of all wheels are divided by their sum.
        with_drive(drive: f32) = 0.0, "wheel drive" [0.0, 1e6] "in 0..=1e6";
        /// Torque of the brake at full pedal [N m].
        with_brake(brake: f32) = 2_500.0, "wheel brake" [0.0, 1e12] "in 0..=1e12";
        /// Torque of the hand brake [N m].
        with_hand_brake(hand_brake: f32) = 0.0, "wheel hand brake" [0.0, 1e12] "in 0..=1e12";
    }
}

impl WheelDesc {
    /// Moment of a disc about the axle [kg m²].
    pub(super) fn inertia(&self) -> f32 {
        0.5 * self.mass * self.radius * self.radius
    }
}

/// How wheels touch the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum WheelKind {
    /// By a ray down through the middle of the wheel: the cheapest, and sharp at the edges of steps.
    #[default]
    Ray,
    /// By a ball of the wheel's radius that is cast down: it rolls over steps.
    Sphere,
    /// Wheels are bodies on joints, which collide as others do. Their grip is the friction of their material
    /// with that of the ground; [`WheelDesc::sliding`], [`WheelDesc::slip_angle`] and
    /// [`VehicleDesc::anti_lock`] mean nothing.
    Body,
}

/// A bar that keeps two wheels from springing apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AntiRollBar {
    /// Which wheels, by their places in [`VehicleDesc::wheels`].
    pub wheels: [usize; 2],
    /// Force on each per difference of their compressions [N/m], at least zero.
    pub stiffness: f32,
}

fields! {
    /// A vehicle on wheels: [`Vehicle::new`](super::Vehicle::new). Its front is along z of the chassis, up is
    /// y, left is x.
    #[derive(Clone, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct VehicleDesc {
        /// Its wheels, at least one.
        with_wheels(wheels: Vec<WheelDesc>) = Vec::new();
        /// How they touch the ground.
        with_wheel_kind(wheel_kind: WheelKind) = WheelKind::Ray;
        /// Its engine.
        with_engine(engine: EngineDesc) = EngineDesc::default();
        /// Its gears.
        with_gearbox(gearbox: GearboxDesc) = GearboxDesc::default();
        /// Bars between wheels.
        with_anti_roll(anti_roll: Vec<AntiRollBar>) = Vec::new();
        /// The most steering angle [rad]: that of a wheel in the middle; the inner wheel turns more and the
        /// outer less, so that all go around one centre (Ackermann).
        with_max_steer(max_steer: f32) = 0.6, "steering angle" [0.0, 1.5] "in 0..=1.5";
        /// Drag of the air: force per square of the speed [N s²/m²].
        with_drag(drag: f32) = 0.4, "vehicle drag" [0.0, 1e12] "in 0..=1e12";
        /// Whether the foot brake keeps wheels from sliding.
        with_anti_lock(anti_lock: bool) = true;
        /// The ground that wheels see: only shapes that would collide with one of this filter; with none, all
        /// but sensors and the chassis. Also the filter of wheels that are bodies.
        with_filter(filter: Option<Filter>, into) = None;
    }
}

impl VehicleDesc {
    /// A car with four wheels: `half_track` to either side and `half_base` to the front and to the back of a
    /// point of the chassis [m]. Front wheels are steered, rear ones driven and on the hand brake. Springs
    /// yield by 40 % of their travel under a chassis of the mass [kg] and are damped by 40 % of what is
    /// critical.
    pub fn car(hubs: Vec3, [half_track, half_base]: [f32; 2], mass: f32) -> VehicleDesc {
        let wheel = WheelDesc::default();
        let stiffness = 0.25 * mass * 9.81 / (0.4 * wheel.travel);
        let damping = 0.8 * (stiffness * 0.25 * mass).sqrt();
        let wheel =
            wheel.with_stiffness(stiffness).with_damping(damping).with_brake(0.6 * mass * 9.81 * 0.35);
        let at = |side: f32, end: f32| hubs + Vec3::new(side * half_track, 0.0, end * half_base);
        let front = wheel.with_steered(true);
        let rear = wheel.with_drive(1.0).with_hand_brake(2.0 * wheel.brake);
        VehicleDesc::default().with_wheels(vec![
            front.with_position(at(1.0, 1.0)),
            front.with_position(at(-1.0, 1.0)),
            rear.with_position(at(1.0, -1.0)),
            rear.with_position(at(-1.0, -1.0)),
        ])
    }

    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range, or the list that is empty or refers to no
    /// wheel.
    pub fn validate(&self) -> Result<(), Error> {
        self.check_ranges()?;
        if self.wheels.is_empty() {
            return Err(Error::Incomplete { what: "a vehicle", expected: "a wheel" });
        }
        each("wheel", &self.wheels, |wheel| {
            limits::offset("wheel position", wheel.position)?;
            wheel.check_ranges()
        })?;
        self.engine.validate()?;
        self.gearbox.check_ranges()?;
        each("gear", &self.gearbox.ratios, |&ratio| {
            crate::error::within("gear ratio", ratio, 1e-3, 1e3, "in 0.001..=1000").map(drop)
        })?;
        each("anti-roll bar", &self.anti_roll, |bar| {
            limits::amount("anti-roll stiffness", bar.stiffness)?;
            let count = self.wheels.len();
            match bar.wheels.into_iter().find(|&wheel| wheel >= count) {
                Some(index) => Err(Error::Index { what: "index of a wheel", index, count }),
                None => Ok(()),
            }
        })
    }
}

impl EngineDesc {
    fn validate(&self) -> Result<(), Error> {
        self.check_ranges()?;
        let mut last = -1.0;
        each("point of the torque curve", &self.torque, |&[rpm, torque]| {
            limits::amount("engine torque", torque)?;
            crate::error::within("engine speed", rpm, 0.0, 1e6, "in 0..=1e6")?;
            if rpm <= last {
                return Err(Error::OutOfRange {
                    what: "engine speed",
                    expected: "above that of the point before",
                    value: rpm.into(),
                });
            }
            last = rpm;
            Ok(())
        })
    }

    /// Torque at full throttle [N m].
    pub(super) fn torque_at(&self, rpm: f32) -> f32 {
        let above = self.torque.iter().position(|point| point[0] >= rpm);
        match above {
            None => 0.0,
            Some(0) => self.torque[0][1],
            Some(i) => {
                let ([x0, y0], [x1, y1]) = (self.torque[i - 1], self.torque[i]);
                y0 + (y1 - y0) * (rpm - x0) / (x1 - x0)
            }
        }
    }
}

/// What the driver does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Controls {
    /// From 0 to 1. Below zero, to -1: brakes while the vehicle goes forward, and then drives backward.
    pub throttle: f32,
    /// From 0 to 1.
    pub brake: f32,
    /// From -1, all to the right, to 1, all to the left.
    pub steer: f32,
    /// From 0 to 1.
    pub hand_brake: f32,
}

impl Controls {
    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        crate::error::within("throttle", self.throttle, -1.0, 1.0, "in -1..=1")?;
        crate::error::within("brake", self.brake, 0.0, 1.0, "in 0..=1")?;
        crate::error::within("steer", self.steer, -1.0, 1.0, "in -1..=1")?;
        crate::error::within("hand brake", self.hand_brake, 0.0, 1.0, "in 0..=1").map(drop)
    }
}
