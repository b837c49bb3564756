//! Reads problems from text: linear complementarity problems and contact problems as Siconos writes them.
//!
//! Both begin with sizes and the matrix W, then q, and for contacts the coefficients of friction; any text
//! may follow. A matrix is dense (storage 0) or made of blocks (storage 1), and either way goes column by
//! column, or it is sparse (storage 2), as CSparse prints it. Five dimensions are those of a contact with
//! rolling friction, which has a second coefficient. A square matrix of another size than the contacts have
//! rows is the mass matrix of a global problem; the matrix H follows.

use super::global::{Sparse, eliminate};
use super::{Law, Matrix, Problem};
use std::fmt::Display;

/// Why a text could not be read as a problem.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct ReadError {
    /// Line of the text, from 1.
    pub line: usize,
    /// The error there.
    pub what: String,
}

/// Which kind of problem a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A linear complementarity problem.
    Complementarity,
    /// Contacts in a plane: one tangent. Each gets a second tangent in the problem, on which nothing acts.
    PlaneContacts,
    /// Contacts in space.
    Contacts,
    /// Contacts in space with rolling friction: beside normal and tangents, moments about both tangents, at
    /// most `mu_r` [m] times the normal impulse. In the problem each is a normal with two patches without
    /// arm, one for the tangents and one for the moments: seven rows, on two of which nothing acts.
    RollingContacts,
}

/// A problem out of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// The problem to be solved.
    pub problem: Problem,
    /// The kind of problem in the file.
    pub form: Form,
}

impl File {
    /// The values of those rows that the file has.
    pub fn unknowns(&self, r: &[f64]) -> Vec<f64> {
        match self.form {
            Form::PlaneContacts => r.chunks(3).flat_map(|contact| &contact[..2]).copied().collect(),
            Form::RollingContacts => {
                r.chunks(7).flat_map(|contact| contact[..3].iter().chain(&contact[4..6])).copied().collect()
            }
            Form::Complementarity | Form::Contacts => r.to_vec(),
        }
    }

    /// A value for each row of the problem, zero for those that the file has not: the way back from
    /// [`File::unknowns`]. None if there is another number of them, or one is not finite.
    pub fn rows_of(&self, unknowns: &[f64]) -> Option<Vec<f64>> {
        let rows: Vec<f64> = match self.form {
            Form::PlaneContacts => unknowns.chunks(2).flat_map(|c| c.iter().copied().chain([0.0])).collect(),
            Form::RollingContacts => unknowns
                .chunks(5)
                .flat_map(|c| {
                    let (point, moments) = c.split_at(c.len().min(3));
                    point.iter().copied().chain([0.0]).chain(moments.iter().copied()).chain([0.0])
                })
                .collect(),
            Form::Complementarity | Form::Contacts => unknowns.to_vec(),
        };
        (rows.len() == self.problem.rows() && rows.iter().all(|r| r.is_finite())).then_some(rows)
    }

    /// Contacts of a file: `w` and `q` have `dimensions` rows for each coefficient of `mu`, normal first.
    pub fn of_contacts(
        dimensions: usize,
        w: Matrix,
        q: Vec<f64>,
        mu: &[f64],
    ) -> Result<File, backstop::Error> {
        let laws = mu.iter().map(|&mu| Law::Contact { mu }).collect();
        if dimensions == 3 {
            return Ok(File { problem: Problem::new(laws, w, q)?, form: Form::Contacts });
        }
        let rows = mu.len() * 2;
        if w.size() != rows || q.len() != rows {
            return Err(backstop::Error::Incomplete {
                what: "W and q",
                expected: "two rows for each contact",
            });
        }
        let place = |row: usize| row / 2 * 3 + row % 2;
        let own = (0..rows).flat_map(|i| w.row(i).map(move |(j, value)| (place(i), place(j), value)));
        // The second tangent gets the mass of the first, so that the contact's block is regular; its impulse
        // is zero.
        let second = (0..mu.len()).map(|c| (3 * c + 2, 3 * c + 2, w.at(2 * c + 1, 2 * c + 1)));
        let w = Matrix::from_entries(3 * mu.len(), own.chain(second));
        let q = q.chunks(2).flat_map(|contact| [contact[0], contact[1], 0.0]).collect();
        Ok(File { problem: Problem::new(laws, w, q)?, form: Form::PlaneContacts })
    }

    /// Contacts with rolling friction: `w` and `q` have five rows for each coefficient of friction `mu` and
    /// of rolling friction `mu_r` [m]: normal, two tangents, and rotations about these.
    pub fn of_rolling_contacts(
        w: Matrix,
        q: Vec<f64>,
        mu: &[f64],
        mu_r: &[f64],
    ) -> Result<File, backstop::Error> {
        let (contacts, rows) = (mu.len(), mu.len() * 5);
        if w.size() != rows || q.len() != rows || mu_r.len() != contacts {
            return Err(backstop::Error::Incomplete {
                what: "W, q and mu_r",
                expected: "five rows and a coefficient of rolling friction for each contact",
            });
        }
        let place = |row: usize| row / 5 * 7 + [0, 1, 2, 4, 5][row % 5];
        let own = (0..rows).flat_map(|i| w.row(i).map(move |(j, value)| (place(i), place(j), value)));
        // The twist of either patch, on which nothing acts, gets the mass of a row beside it.
        let twist = (0..contacts).flat_map(|c| [(7 * c + 3, 5 * c + 2), (7 * c + 6, 5 * c + 4)]);
        let twist = twist.map(|(to, from)| (to, to, w.at(from, from)));
        let mut all = vec![0.0; 7 * contacts];
        q.iter().enumerate().for_each(|(row, &q)| all[place(row)] = q);
        let patch = |c: usize, mu: f64| Law::Patch { mu, arm: 0.0, first: 7 * c, count: 1 };
        let laws = (0..contacts).flat_map(|c| [Law::AT_LEAST_ZERO, patch(c, mu[c]), patch(c, mu_r[c])]);
        let w = Matrix::from_entries(7 * contacts, own.chain(twist));
        Ok(File { problem: Problem::new(laws.collect(), w, all)?, form: Form::RollingContacts })
    }
}

/// The storage of a matrix that is neither dense (0) nor made of blocks (1).
const SPARSE: usize = 2;
/// Dimensions of contacts with rolling friction.
const ROLLING: usize = 5;

/// Reads a linear complementarity problem or a contact problem: whichever the sizes at the beginning say. A
/// text that is too short for its sizes is refused before anything is allocated.
pub fn read_problem(text: &str) -> Result<File, ReadError> {
    let mut words = Words::new(text);
    let first = words.clone().sizes()?;
    // A contact problem has one size more before the matrix: dimension, contacts, storage, rows, columns.
    if first[1] <= SPARSE && first[2] == first[0] && first[3] == first[0] {
        read_complementarity(&mut words)
    } else if matches!(first[0], 2 | 3 | ROLLING) {
        read_contacts(&mut words)
    } else {
        Err(words
            .error("neither the sizes of a linear complementarity problem nor those of a contact problem"))
    }
}

fn read_complementarity(words: &mut Words) -> Result<File, ReadError> {
    let n = words.size("the number of unknowns")?;
    let (storage, size) = read_sizes(words)?;
    if size != [n; 2] {
        return Err(words.error(format!("{n} rows and columns of the matrix expected")));
    }
    let entries = read_matrix(words, storage, size)?;
    words.room_for(n, "q")?;
    let w = Matrix::from_entries(n, entries);
    let q = words.numbers(n, "q")?;
    let problem = Problem::lcp(w, q).map_err(|error| words.error(error))?;
    Ok(File { problem, form: Form::Complementarity })
}

fn read_contacts(words: &mut Words) -> Result<File, ReadError> {
    let dimensions = words.size("the number of dimensions")?;
    let contacts = words.size("the number of contacts")?;
    let rows = contacts.saturating_mul(dimensions);
    let (storage, [size, columns]) = read_sizes(words)?;
    if size != columns {
        return Err(words.error(format!("a square matrix expected, but found {size}-by-{columns}")));
    }
    let entries = read_matrix(words, storage, [size; 2])?;
    // Sizes of another matrix, and no numbers of q, which could be the same by a rare chance only.
    let h_follows = read_sizes(&mut words.clone()).is_ok_and(|(_, found)| found == [size, rows]);
    let (w, q) = if h_follows {
        read_global(words, Sparse { rows: size, columns: size, entries }, rows)?
    } else if size == rows {
        // Blocks may be of any size and stay empty; q has a number for each row.
        words.room_for(rows, "q")?;
        (Matrix::from_entries(rows, entries), words.numbers(rows, "q")?)
    } else {
        return Err(words.error(format!("{rows} rows of the matrix expected, but found {size}")));
    };
    let mu = words.numbers(contacts, "mu")?;
    let mu_r = if dimensions == ROLLING { words.numbers(contacts, "mu_r")? } else { Vec::new() };
    if mu.iter().chain(&mu_r).any(|&mu| mu < 0.0) {
        return Err(words.error("a coefficient of friction is negative"));
    }
    if dimensions == ROLLING {
        return File::of_rolling_contacts(w, q, &mu, &mu_r).map_err(|error| words.error(error));
    }
    File::of_contacts(dimensions, w, q, &mu).map_err(|error| words.error(error))
}

/// The rest of a global problem, `M v = q + H r` and `u = Hᵀ v + b`, of which the velocities v of bodies are
/// eliminated.
fn read_global(words: &mut Words, mass: Sparse, rows: usize) -> Result<(Matrix, Vec<f64>), ReadError> {
    let (storage, size) = read_sizes(words)?;
    let h = Sparse { rows: mass.rows, columns: rows, entries: read_matrix(words, storage, size)? };
    let (forces, offset) = (words.numbers(mass.rows, "q")?, words.numbers(rows, "b")?);
    eliminate(&mass, &h, &forces, offset).map_err(|error| words.error(error))
}

/// The storage of a matrix, its rows and its columns.
fn read_sizes(words: &mut Words) -> Result<(usize, [usize; 2]), ReadError> {
    let storage = words.size("the storage of the matrix")?;
    if storage > SPARSE {
        return Err(words.error(format!(
            "storage {storage} of the matrix is not known: 0 is dense, 1 has blocks, 2 is sparse"
        )));
    }
    Ok((storage, [words.size("the rows of the matrix")?, words.size("the columns of the matrix")?]))
}

fn read_matrix(words: &mut Words, storage: usize, size: [usize; 2]) -> Result<Entries, ReadError> {
    match storage {
        0 => read_dense(words, size),
        SPARSE => read_sparse(words, size),
        _ => read_blocks(words, size),
    }
}

type Entries = Vec<(usize, usize, f64)>;

fn read_dense(words: &mut Words, [rows, columns]: [usize; 2]) -> Result<Entries, ReadError> {
    words.exactly(rows, "rows of the dense matrix")?;
    words.exactly(columns, "columns of the dense matrix")?;
    words.room_for(rows.saturating_mul(columns), "the entries of the matrix")?;
    let mut entries = Vec::new();
    read_block(words, &mut entries, 0..rows, 0..columns)?;
    Ok(entries)
}

/// Entries of a block, column by column.
fn read_block(
    words: &mut Words,
    entries: &mut Entries,
    rows: std::ops::Range<usize>,
    columns: std::ops::Range<usize>,
) -> Result<(), ReadError> {
    for column in columns {
        for row in rows.clone() {
            entries.push((row, column, words.number("an entry of the matrix")?));
        }
    }
    Ok(())
}

fn read_blocks(words: &mut Words, size: [usize; 2]) -> Result<Entries, ReadError> {
    let blocks = words.size("the number of blocks")?;
    let rows = words.size("the number of rows of blocks")?;
    let columns = words.size("the number of columns of blocks")?;
    let row_ends = read_ends(words, rows, size[0])?;
    let column_ends = read_ends(words, columns, size[1])?;
    let pointers = words.size("the length of the row pointer")?;
    if pointers != rows.saturating_add(1) {
        return Err(words
            .error(format!("the row pointer must have {} numbers, not {pointers}", rows.saturating_add(1))));
    }
    words.exactly(blocks, "column indices of blocks")?;
    let pointers = words.sizes_of(pointers, "the row pointer")?;
    if pointers.first() != Some(&0) || pointers.last() != Some(&blocks) || !pointers.is_sorted() {
        return Err(words.error("the row pointer must rise from 0 to the number of blocks"));
    }
    let indices = words.sizes_of(blocks, "the column index")?;
    if indices.iter().any(|&column| column >= columns) {
        return Err(words.error("a column index is too great"));
    }
    let range = |ends: &[usize], i: usize| (if i == 0 { 0 } else { ends[i - 1] })..ends[i];
    let mut entries = Vec::new();
    for row in 0..rows {
        let blocks = pointers[row]..pointers[row + 1];
        for (block, &column) in blocks.clone().zip(&indices[blocks]) {
            words.exactly(block, "as the number of the block")?;
            read_block(words, &mut entries, range(&row_ends, row), range(&column_ends, column))?;
        }
    }
    Ok(entries)
}

/// Entries as CSparse prints them: by columns, by rows, or one by one.
fn read_sparse(words: &mut Words, [rows, columns]: [usize; 2]) -> Result<Entries, ReadError> {
    // How the matrix was made, which the text says again.
    words.size("the origin of the sparse matrix")?;
    if !words.line().starts_with("CSparse") {
        return Err(words.error("a line of CSparse's version expected"));
    }
    let header = words.line();
    let (kind, header) = match header.split_once("-by-").map(|(rows, _)| rows.split_once(": ")) {
        Some(Some(("triplet", _))) => ("", &header["triplet: ".len()..]),
        Some(Some(("csr", _))) => ("row", &header["csr: ".len()..]),
        Some(None) => ("col", header),
        _ => return Err(words.error("the sizes of the sparse matrix expected")),
    };
    if !header.starts_with(&format!("{rows}-by-{columns},")) {
        return Err(words.error(format!("a matrix of {rows}-by-{columns} expected")));
    }
    let number = header.split_once("nnz: ").map(|(_, rest)| rest.split(',').next().unwrap_or(rest).trim());
    let Some(number) = number.and_then(|number| number.parse().ok()) else {
        return Err(words.error("the number of entries (nnz) expected"));
    };
    words.room_for(number, "the entries of the matrix")?;
    let mut entries = Vec::new();
    let index = |words: &mut Words, size: usize| match words.size("an index of the matrix")? {
        index if index < size => Ok(index),
        index => Err(words.error(format!("index {index} is outside of the matrix"))),
    };
    if kind.is_empty() {
        for _ in 0..number {
            let (row, column) = (index(words, rows)?, index(words, columns)?);
            words.literal(":")?;
            entries.push((row, column, words.number("an entry of the matrix")?));
        }
        return Ok(entries);
    }
    let (lines, others) = if kind == "col" { (columns, rows) } else { (rows, columns) };
    for line in 0..lines {
        words.literal(kind)?;
        words.exactly(line, if kind == "col" { "as the column" } else { "as the row" })?;
        [":", "locations"].iter().try_for_each(|word| words.literal(word))?;
        words.exactly(entries.len(), "as the first location")?;
        words.literal("to")?;
        // Of an empty column that begins at 0 the last location is -1.
        let last = words.number("the last location")?;
        while (entries.len() as f64) <= last {
            if entries.len() == number {
                return Err(words.error("there are more locations than entries"));
            }
            let other = index(words, others)?;
            words.literal(":")?;
            let value = words.number("an entry of the matrix")?;
            entries.push(if kind == "col" { (other, line, value) } else { (line, other, value) });
        }
    }
    Ok(entries)
}

/// Where each row or column of blocks ends.
fn read_ends(words: &mut Words, count: usize, size: usize) -> Result<Vec<usize>, ReadError> {
    let ends = words.sizes_of(count, "the sizes of blocks")?;
    if !ends.is_sorted() || ends.last().copied().unwrap_or(0) != size {
        return Err(words.error(format!("the sizes of blocks must rise to {size}, the size of the matrix")));
    }
    Ok(ends)
}

/// The words of a text with their lines.
#[derive(Clone)]
struct Words<'a> {
    /// The text that is not read yet.
    rest: &'a str,
    line: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Words<'a> {
        Words { rest: text, line: 1 }
    }

    fn error(&self, what: impl Display) -> ReadError {
        ReadError { line: self.line, what: what.to_string() }
    }

    fn word(&mut self, what: &str) -> Result<&'a str, ReadError> {
        let start = self.rest.trim_start();
        self.line += self.rest[..self.rest.len() - start.len()].matches('\n').count();
        let end = start.find(char::is_whitespace).unwrap_or(start.len());
        let word;
        (word, self.rest) = start.split_at(end);
        if word.is_empty() { Err(self.error(format!("the text ends before {what}"))) } else { Ok(word) }
    }

    /// The rest of a line, or the next line if nothing is left of it.
    fn line(&mut self) -> &'a str {
        let start = self.rest.trim_start();
        self.line += self.rest[..self.rest.len() - start.len()].matches('\n').count();
        let line;
        (line, self.rest) = start.split_at(start.find('\n').unwrap_or(start.len()));
        line
    }

    fn literal(&mut self, expected: &str) -> Result<(), ReadError> {
        match self.word(expected)? {
            word if word == expected => Ok(()),
            word => Err(self.error(format!("\"{expected}\" expected, but found \"{}\"", shown(word)))),
        }
    }

    fn size(&mut self, what: &str) -> Result<usize, ReadError> {
        let word = self.word(what)?;
        word.parse()
            .map_err(|_| self.error(format!("{what} must be a whole number, not \"{}\"", shown(word))))
    }

    /// The first four.
    fn sizes(mut self) -> Result<[usize; 4], ReadError> {
        let mut sizes = [0; 4];
        for size in &mut sizes {
            *size = self.size("a size of the problem")?;
        }
        Ok(sizes)
    }

    fn exactly(&mut self, expected: usize, what: &str) -> Result<(), ReadError> {
        let found = self.size(what)?;
        if found == expected {
            Ok(())
        } else {
            Err(self.error(format!("{expected} {what} expected, but found {found}")))
        }
    }

    fn number(&mut self, what: &str) -> Result<f64, ReadError> {
        let word = self.word(what)?;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.error(format!("{what} must be a finite number, not \"{}\"", shown(word)))),
        }
    }

    /// Each number takes a digit and a space.
    fn room_for(&self, count: usize, what: &str) -> Result<(), ReadError> {
        if count <= self.rest.len() / 2 {
            Ok(())
        } else {
            Err(self.error(format!("the text is too short for {what}")))
        }
    }

    fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, ReadError> {
        self.room_for(count, what)?;
        (0..count).map(|_| self.number(what)).collect()
    }

    fn sizes_of(&mut self, count: usize, what: &str) -> Result<Vec<usize>, ReadError> {
        self.room_for(count, what)?;
        (0..count).map(|_| self.size(what)).collect()
    }
}

/// The beginning of a word, for an error message.
fn shown(word: &str) -> String {
    word.chars().take(20).collect()
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
