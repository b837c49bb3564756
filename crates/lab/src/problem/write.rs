//! Writes problems as text that [`read_problem`](super::read_problem) reads, to the last bit of each number.

use super::{Law, Matrix, Problem};
use backstop::Error;
use std::fmt::Write;

/// The text of a linear complementarity problem, or of a contact problem: storage by blocks if most blocks
/// are empty, else dense. Refuses laws that the format does not have: bounds other than
/// [`Law::AT_LEAST_ZERO`], patches, or both kinds together.
pub fn write_problem(problem: &Problem) -> Result<String, Error> {
    let mu = problem.laws().map(|(_, law)| match law {
        Law::Contact { mu } => Some(mu),
        _ => None,
    });
    let mut text = String::new();
    if problem.laws().all(|(_, law)| law == Law::AT_LEAST_ZERO) {
        let _ = writeln!(text, "{}", problem.rows());
        write_matrix(&mut text, problem.w(), 1);
        write_numbers(&mut text, problem.q().iter().copied());
    } else if mu.clone().all(|mu| mu.is_some()) {
        let _ = writeln!(text, "3\n{}", problem.laws().len());
        write_matrix(&mut text, problem.w(), 3);
        write_numbers(&mut text, problem.q().iter().copied());
        write_numbers(&mut text, mu.flatten());
    } else {
        return Err(Error::Incomplete {
            what: "a problem that is written",
            expected: "contacts only, or rows that are at least zero only",
        });
    }
    Ok(text)
}

fn write_matrix(text: &mut String, w: &Matrix, block: usize) {
    let (size, blocks) = (w.size(), w.size() / block);
    // The columns of blocks that each row of blocks has.
    let columns: Vec<Vec<usize>> = (0..blocks)
        .map(|row| {
            let rows = row * block..(row + 1) * block;
            let mut columns: Vec<usize> = rows.flat_map(|i| w.row(i).map(|(j, _)| j / block)).collect();
            columns.sort_unstable();
            columns.dedup();
            columns
        })
        .collect();
    let stored: usize = columns.iter().map(Vec::len).sum();
    if stored * 2 > blocks * blocks {
        let _ = writeln!(text, "0\n{size}\n{size}\n{size} {size}");
        for j in 0..size {
            write_numbers(text, (0..size).map(|i| w.at(i, j)));
        }
        return;
    }
    let _ = writeln!(text, "1\n{size}\n{size}\n{stored}\n{blocks}\n{blocks}");
    for _ in ["rows", "columns"] {
        write_sizes(text, (1..=blocks).map(|i| i * block));
    }
    let _ = writeln!(text, "{}\n{stored}", blocks + 1);
    let ends = columns.iter().scan(0, |end, columns| {
        *end += columns.len();
        Some(*end)
    });
    write_sizes(text, std::iter::once(0).chain(ends));
    write_sizes(text, columns.iter().flatten().copied());
    let places = columns
        .iter()
        .enumerate()
        .flat_map(|(row, columns)| columns.iter().map(move |&column| (row, column)));
    for (number, (row, column)) in places.enumerate() {
        let _ = writeln!(text, "{number}");
        for j in 0..block {
            write_numbers(text, (0..block).map(|i| w.at(row * block + i, column * block + j)));
        }
    }
}

/// A line of numbers, each with as few digits as tell it from its neighbours.
fn write_numbers(text: &mut String, numbers: impl Iterator<Item = f64>) {
    numbers.for_each(|number| {
        let _ = write!(text, "{number:?} ");
    });
    text.push('\n');
}

fn write_sizes(text: &mut String, sizes: impl Iterator<Item = usize>) {
    sizes.for_each(|size| {
        let _ = write!(text, "{size} ");
    });
    text.push('\n');
}
