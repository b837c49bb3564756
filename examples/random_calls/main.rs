//! Worlds of everything under calls drawn at random, judged as `fuzz/README.md` says: nothing panics, what is
//! refused changes nothing, restored worlds tell the same as the original, budgets hold.
//!
//!     cargo run --example random_calls -- 100000          so many sequences, on all processors
//!     cargo run --example random_calls -- 1000 5000       from this seed on
//!     cargo run --example random_calls -- seed 5017       one of them, with the fewest calls that go wrong
//!     cargo run --example random_calls -- seed 5017 0,3,9 of these calls alone
//!
//! Without arguments 200 sequences. The development profile has assertions on, and is optimised.

#[path = "../../fuzz/bodies/calls/mod.rs"]
#[allow(dead_code, unreachable_pub, reason = "of the package of fuzz targets")]
mod calls;
#[path = "../../fuzz/bodies/input.rs"]
#[allow(dead_code, unreachable_pub, reason = "of the package of fuzz targets")]
mod input;

use calls::{bytes_of, outcome, sequence, shrink};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::panic;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

thread_local! {
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

fn last_panic() -> String {
    LAST_PANIC.with(|last| last.borrow().clone())
}

fn main() {
    // Panics are findings: they are told once, with their calls.
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if std::env::var_os("TELL_PANICS").is_some() {
            usual(info);
        }
        let place = info.location().map(|at| format!("at {}:{}", at.file(), at.line()));
        LAST_PANIC.with(|last| *last.borrow_mut() = place.unwrap_or_default());
    }));
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize| arguments.get(place).and_then(|text| text.parse::<u64>().ok());
    if arguments.first().is_some_and(|first| first == "seed") {
        let only = arguments.get(2).map(|list| list.split(',').filter_map(|n| n.parse().ok()).collect());
        one(number(1).expect("a seed"), only);
    } else {
        many(number(0).unwrap_or(200), number(1).unwrap_or(0));
    }
}

/// The findings of many seeds, by kind: how many, and the first seed.
fn many(count: u64, first: u64) {
    let (next, start) = (AtomicU64::new(first), Instant::now());
    let found: Mutex<BTreeMap<String, (u64, u64, String)>> = Mutex::new(BTreeMap::new());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count {
                        return;
                    }
                    if let Some(finding) = outcome(&sequence(&bytes_of(seed)), &last_panic) {
                        let mut found = found.lock().expect("no panic meanwhile");
                        if !found.contains_key(&finding.kind) {
                            println!("{:.0?}, seed {seed}: {}", start.elapsed(), finding.kind);
                        }
                        let entry = found.entry(finding.kind.clone()).or_insert((0, seed, finding.text));
                        entry.0 += 1;
                        entry.1 = entry.1.min(seed);
                    }
                }
            });
        }
    });
    let found = found.into_inner().expect("no panic meanwhile");
    println!(
        "{count} sequences from seed {first} in {:.0?}: {} kinds of findings",
        start.elapsed(),
        found.len()
    );
    for (kind, (times, seed, text)) in &found {
        let text: String = text.chars().take(200).collect();
        println!("{times:6} times, seed {seed}: {kind}\n       {text}");
    }
    if !found.is_empty() {
        std::process::exit(1);
    }
}

/// One seed, or some of its calls, shrunk.
fn one(seed: u64, only: Option<Vec<usize>>) {
    let mut sequence = sequence(&bytes_of(seed));
    if let Some(only) = &only {
        sequence.calls.retain(|(place, _)| only.contains(place));
    }
    let Some(finding) = outcome(&sequence, &last_panic) else {
        println!("{sequence}nothing is wrong");
        return;
    };
    println!("{}: {}", finding.kind, finding.text);
    let least = shrink(&sequence, &finding.kind, &last_panic);
    if let Some(finding) = outcome(&least, &last_panic) {
        println!("{least}{}: {}", finding.kind, finding.text);
    }
    let places: Vec<String> = least.calls.iter().map(|(place, _)| place.to_string()).collect();
    println!("cargo run --example random_calls -- seed {seed} {}", places.join(","));
}
