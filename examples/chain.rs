//! What each setting reaches, and in which time: twenty links with a ball a thousand times as heavy at their
//! end.
//!
//!     cargo run --release --example chain
//!
//! Prints a table: time of a step, and the widest joint within 5 s, hanging still and swinging down from
//! level. Hung up seven times at the same point, the chain has more loops than are cut, and is solved row by
//! row.

use backstop::{Error, Settings, World};
use backstop_scene::builtin;
use std::time::Instant;

/// Substeps and iterations.
const SETTINGS: [(u32, u32); 9] = [(1, 1), (1, 4), (1, 8), (1, 20), (2, 1), (4, 1), (4, 2), (8, 1), (16, 1)];
const STEPS: u32 = 300;
/// Each setting is timed so often, in turn with the others.
const ROUNDS: usize = 9;

/// Time of a step [us], and the widest joint ever [m].
fn swing(level: bool, (substeps, iterations): (u32, u32), rows: bool) -> Result<(f64, f64), Error> {
    let mut world = World::new(Settings::default().with_substeps(substeps).with_iterations(iterations))?;
    let mut scene = builtin::chain(level);
    if rows {
        // Six loops are more than are cut.
        scene.joints.extend(std::iter::repeat_n(scene.joints[0].clone(), 6));
    }
    let joints = scene.add_to(&mut world)?.joints;
    let (mut taken, mut widest) = (0.0, 0.0_f64);
    for _ in 0..STEPS {
        let start = Instant::now();
        world.step(1.0 / 60.0)?;
        taken += start.elapsed().as_secs_f64();
        for &joint in &joints {
            let [(a, _), (b, _)] = world.joint_frames(joint)?;
            let gap = (b - a).length();
            // No number is worse than any.
            widest = if gap.is_nan() { f64::INFINITY } else { widest.max(gap) };
        }
    }
    Ok((1e6 * taken / f64::from(STEPS), widest))
}

fn length(metres: f64) -> String {
    match metres {
        m if m > 100.0 => "apart".into(),
        m if m >= 1.0 => format!("{m:.1} m"),
        m if m >= 0.01 => format!("{:.0} mm", 1e3 * m),
        m if m < 5e-6 => "below 0.01 mm".into(),
        m => format!("{:.2} mm", 1e3 * m),
    }
}

fn main() -> Result<(), Error> {
    // Time, hanging, swinging; by setting, as a tree and row by row.
    let mut times = vec![[Vec::new(), Vec::new()]; SETTINGS.len()];
    let mut gaps = [[[0.0; 2]; 2]; SETTINGS.len()];
    for _ in 0..ROUNDS {
        for (i, setting) in SETTINGS.into_iter().enumerate() {
            for rows in [false, true] {
                for level in [false, true] {
                    let (time, gap) = swing(level, setting, rows)?;
                    times[i][usize::from(rows)].push(time);
                    gaps[i][usize::from(rows)][usize::from(level)] = gap;
                }
            }
        }
    }
    println!("| substeps x iterations | step | hanging | swinging | row by row: step | hanging | swinging |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (i, (substeps, iterations)) in SETTINGS.into_iter().enumerate() {
        print!("| {substeps} x {iterations}");
        for (times, gaps) in times[i].iter_mut().zip(gaps[i]) {
            times.sort_by(f64::total_cmp);
            let median = times[times.len() / 2];
            print!(" | {median:.0} µs | {} | {}", length(gaps[0]), length(gaps[1]));
        }
        println!(" |");
    }
    Ok(())
}
