//! Whether what stands stays standing: how far the top of a structure has gone, and how fast its bodies are,
//! every 5 s.
//!
//!     cargo run --release --example rest -- tower 30 120 --hz 60 --substeps 4
//!
//! Structure, size and seconds, then `--hz`, `--substeps`, `--iterations`, `--friction patch|point`,
//! `--scale` [m], `--gravity` [m/s²], `--density` [kg/m³], `--steps even|alternating|hitches|random|wild`.
//! What is put up less well: `--gap`, by which bodies are higher, as a share of their height; `--aside`, the
//! furthest that each stands off to a side, in units of length; `--kick`, the fastest that each is pushed to
//! a side after 5 s [m/s]. Without arguments a tower of five stands for 20 s and the example asserts that.

#[path = "../src/random.rs"]
mod random;

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, FrictionModel, Settings, World};
use backstop_scene::Standing;
use random::Random;

/// Root of the mean square, and the greatest, of the speeds [m/s].
fn speeds(world: &World, bodies: &[BodyHandle]) -> Result<[f64; 2], Error> {
    let (mut sum, mut most) = (0.0, 0.0_f64);
    for &body in bodies {
        let square = world.linear_velocity(body)?.as_dvec3().length_squared();
        (sum, most) = (sum + square, most.max(square));
    }
    Ok([(sum / bodies.len() as f64).sqrt(), most.sqrt()])
}

/// How long steps are.
#[derive(Clone, Copy, Debug)]
enum Steps {
    /// All the same [Hz].
    Even(f32),
    /// 1/30 and 1/144 s by turns.
    Alternating,
    /// 60 Hz, and once a second a step of 0.25 s.
    Hitches,
    /// Anything between the two [s].
    Random(f32, f32),
}

impl Steps {
    /// Length of the step with such a number [s].
    fn dt(self, step: u32) -> f32 {
        match self {
            Steps::Even(hz) => 1.0 / hz,
            Steps::Alternating => [1.0 / 30.0, 1.0 / 144.0][step as usize % 2],
            Steps::Hitches => [1.0 / 60.0, 0.25][usize::from(step % 46 == 45)],
            Steps::Random(least, most) => Random(u64::from(step)).range(least, most),
        }
    }
}

/// How a structure is put up badly, and disturbed.
#[derive(Clone, Copy, Debug, Default)]
struct Upset {
    /// By how much bodies are higher, as a share of their height.
    gap: f64,
    /// The furthest that bodies stand off to a side [length units].
    aside: f64,
    /// The fastest that bodies are pushed to a side after 5 s [m/s].
    kick: f32,
}

impl Upset {
    /// To a side, by no more than one along either axis.
    fn sideways(number: usize) -> Vec3 {
        let one = |axis: usize| Random((2 * number + axis) as u64).signed();
        Vec3::new(one(0), 0.0, one(1))
    }

    fn put(&self, world: &mut World, bodies: &[BodyHandle]) -> Result<(), Error> {
        let unit = f64::from(world.settings().length_unit);
        for (i, &body) in bodies.iter().enumerate() {
            let (at, turn) = (world.position(body)?, world.rotation(body)?);
            let way = Self::sideways(i).as_dvec3() * self.aside * unit + DVec3::Y * at.y * self.gap;
            world.set_pose(body, at + way, turn)?;
        }
        Ok(())
    }

    fn kick(&self, world: &mut World, bodies: &[BodyHandle]) -> Result<(), Error> {
        for (i, &body) in bodies.iter().enumerate() {
            world.set_velocity(body, Self::sideways(i) * self.kick, Vec3::ZERO)?;
        }
        Ok(())
    }
}

/// Prints a line every 5 s; the way of the top sideways and down [m], and the speeds, in the end.
fn stand(
    structure: Standing,
    settings: Settings,
    density: f32,
    length: Steps,
    upset: Upset,
    seconds: u32,
) -> Result<[f64; 4], Error> {
    let (mut world, bodies) = structure.build(settings, density)?;
    if upset.gap > 0.0 || upset.aside > 0.0 {
        upset.put(&mut world, &bodies)?;
    }
    let top = *bodies.last().ok_or(Error::StaleBody)?;
    let start = world.position(top)?;
    println!(
        "{}, {} bodies\n  time   top aside    top down   rms speed   top speed",
        structure.name(),
        bodies.len()
    );
    let mut last = [0.0; 4];
    let (mut second, mut step, mut time) = (0, 0_u32, 0.0);
    while second < seconds {
        second = (second + 5).min(seconds);
        // Half a millisecond: where steps add up to a whole second, rounding adds none.
        while time < f64::from(second) - 0.0005 {
            let dt = length.dt(step);
            if upset.kick > 0.0 && time < 5.0 && time + f64::from(dt) >= 5.0 {
                upset.kick(&mut world, &bodies)?;
            }
            world.step(dt)?;
            (time, step) = (time + f64::from(dt), step + 1);
        }
        let way = world.position(top)? - start;
        let [rms, most] = speeds(&world, &bodies)?;
        last = [way.x.hypot(way.z), -way.y, rms, most];
        let [aside, down, ..] = last;
        println!("{second:4} s  {aside:8.2e} m {down:9.2e} m  {rms:8.2e} m/s {most:8.2e} m/s");
    }
    Ok(last)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut settings = Settings::default();
    let (mut steps, mut density, mut plain) = (Steps::Even(60.0), 1000.0, Vec::new());
    let mut upset = Upset::default();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let Some(option) = argument.strip_prefix("--") else {
            plain.push(argument);
            continue;
        };
        let value = arguments.next().ok_or_else(|| format!("--{option} needs a value"))?;
        match option {
            "hz" => steps = Steps::Even(value.parse()?),
            "steps" if value == "even" => {}
            "steps" if value == "alternating" => steps = Steps::Alternating,
            "steps" if value == "hitches" => steps = Steps::Hitches,
            "steps" if value == "random" => steps = Steps::Random(1.0 / 144.0, 1.0 / 30.0),
            "steps" if value == "wild" => steps = Steps::Random(1.0 / 240.0, 1.0 / 15.0),
            "substeps" => settings.substeps = value.parse()?,
            "iterations" => settings.iterations = value.parse()?,
            "friction" if value == "point" => settings.friction_model = FrictionModel::Point,
            "friction" if value == "patch" => settings.friction_model = FrictionModel::Patch,
            "scale" => settings.length_unit = value.parse()?,
            "gap" => upset.gap = value.parse()?,
            "aside" => upset.aside = value.parse()?,
            "kick" => upset.kick = value.parse()?,
            "gravity" => settings.gravity.y = -value.parse::<f32>()?,
            "density" => density = value.parse()?,
            _ => return Err(format!("--{option} {value}: no such option").into()),
        }
    }
    let number = |i: usize| plain.get(i).map(|text: &String| text.parse::<u32>()).transpose();
    let Some(name) = plain.first() else {
        let [aside, down, rms, _] = stand(Standing::Tower(5), settings, density, steps, upset, 20)?;
        assert!(aside < 1e-4 && down < 0.005 && rms < 1e-4, "{aside} m aside, {down} m down, {rms} m/s");
        return Ok(());
    };
    let structure = Standing::named(name, number(1)?.map(|n| n as usize)).ok_or("no such structure")?;
    stand(structure, settings, density, steps, upset, number(2)?.unwrap_or(60))?;
    Ok(())
}
