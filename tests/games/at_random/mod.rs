//! Scenes by seed, and judges that know from physics what has to come out.
//!
//! Each test runs a few seeds. `COUNT=500 cargo test --test games at_random` runs as many of each,
//! from the seed `FIRST` on, and prints what fails.

mod cars;
mod crowds;
mod fields;
mod grabs;
mod ground;
#[path = "../../../src/random.rs"]
mod random;

use random::Random;

/// What a judge says: why a scene fails.
type Verdict = Result<(), Box<dyn std::error::Error>>;

/// Fails with a text unless something holds.
macro_rules! require {
    ($holds:expr, $($text:tt)*) => {
        let holds: bool = $holds;
        if !holds {
            return Err(format!($($text)*).into());
        }
    };
}
use require;

const G: f32 = 9.81;
const RATES: [u32; 3] = [30, 60, 120];

/// Runs a judge on scenes of some seeds. None may fail.
fn judge(usual: u64, one: impl Fn(&mut Random) -> Verdict) {
    let get = |name: &str, usual: u64| std::env::var(name).map_or(usual, |text| text.parse().unwrap());
    let (first, count) = (get("FIRST", 0), get("COUNT", usual));
    let mut failed = 0;
    for seed in first..first + count {
        // Seeds of neighbours have nothing in common.
        if let Err(why) = one(&mut Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))) {
            failed += 1;
            println!("seed {seed}: {why}");
        }
    }
    assert!(failed == 0, "{failed} of {count} fail");
}
