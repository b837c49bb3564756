//! Reads contact problems of FCLIB, the frictional contact library, from HDF5.
//!
//! A local problem gives W and q. A global one gives the mass matrix M of the bodies, forces f, and H that
//! turns velocities of bodies to those of contacts, and G to those of joints: `M v = f + H r + G l`,
//! `u = Hᵀ v + w`, `0 = Gᵀ v + b`. With v eliminated it is `W = [H G]ᵀ M⁻¹ [H G]`, of which the rows of
//! joints are [`Law::LOCKED`].

use super::global::{COUPLED, Sparse, eliminate};
use super::{File, Form, Law, Matrix, Problem};
use hdf5_pure::{File as Hdf5, Group};

/// Why a file could not be read as a problem of FCLIB.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FclibError(String);

fn error<T>(what: impl Into<String>) -> Result<T, FclibError> {
    Err(FclibError(what.into()))
}

/// The end of the names of groups with rolling friction, which has five rows a contact.
const ROLLING: &str = "_rolling";

/// Reads the bytes of an FCLIB file, with `fclib_local` or `fclib_global`.
pub fn read_fclib(bytes: Vec<u8>) -> Result<File, FclibError> {
    let file = Hdf5::from_bytes(bytes).map_err(|e| FclibError(format!("no HDF5 that can be read: {e}")))?;
    let (root, groups) = (file.root(), names(&file.root())?);
    let found = |names: [&'static str; 2]| names.into_iter().find(|name| groups.iter().any(|g| g == name));
    if let Some(name) = found(["fclib_local", "fclib_local_rolling"]) {
        read_local(&group(&root, name)?, name.ends_with(ROLLING))
    } else if let Some(name) = found(["fclib_global", "fclib_global_rolling"]) {
        read_global(&group(&root, name)?, name.ends_with(ROLLING))
    } else {
        error("the file has neither fclib_local nor fclib_global, and neither of them with _rolling")
    }
}

/// Contacts of a file; those with rolling friction have a second coefficient among the vectors.
fn of_contacts(
    dimensions: usize,
    w: Matrix,
    q: Vec<f64>,
    mu: &[f64],
    vectors: &Group,
) -> Result<File, FclibError> {
    let file = if dimensions == 5 {
        File::of_rolling_contacts(w, q, mu, &reals(vectors, "mu_r")?)
    } else {
        File::of_contacts(dimensions, w, q, mu)
    };
    file.map_err(|e| FclibError(e.to_string()))
}

fn read_local(local: &Group, rolling: bool) -> Result<File, FclibError> {
    if names(local)?.iter().any(|name| name == "R" || name == "V") {
        return error(
            "the local problem has joints beside its contacts (matrices V and R), which is not supported",
        );
    }
    let dimensions = if rolling { 5 } else { dimensions(local)? };
    let vectors = group(local, "vectors")?;
    let (q, mu) = (reals(&vectors, "q")?, reals(&vectors, "mu")?);
    let w = Sparse::read(local, "W")?;
    if w.rows != q.len() || w.columns != q.len() {
        return error("W and q must have as many rows");
    }
    let w = Matrix::from_entries(q.len(), w.entries);
    of_contacts(dimensions, w, q, &mu, &vectors)
}

fn read_global(global: &Group, rolling: bool) -> Result<File, FclibError> {
    let dimensions = if rolling { 5 } else { dimensions(global)? };
    let vectors = group(global, "vectors")?;
    let (f, mut offset, mu) = (reals(&vectors, "f")?, reals(&vectors, "w")?, reals(&vectors, "mu")?);
    let (mass, mut jacobian) = (Sparse::read(global, "M")?, Sparse::read(global, "H")?);
    let contact_rows = offset.len();
    let fits = |h: &Sparse, columns: usize| h.rows == f.len() && h.columns == columns;
    if !fits(&mass, f.len()) || !fits(&jacobian, contact_rows) || contact_rows != mu.len() * dimensions {
        return error("M, H, f, w and mu must have sizes that agree");
    }
    if names(global)?.iter().any(|name| name == "G") {
        let (joints, b) = (Sparse::read(global, "G")?, reals(&vectors, "b")?);
        if !fits(&joints, b.len()) {
            return error("M, G and b must have sizes that agree");
        }
        jacobian.entries.extend(joints.entries.iter().map(|&(i, j, x)| (i, contact_rows + j, x)));
        jacobian.columns += b.len();
        offset.extend(b);
    }
    let (w, q) = eliminate(&mass, &jacobian, &f, offset).map_err(FclibError)?;
    if q.len() == contact_rows {
        return of_contacts(dimensions, w, q, &mu, &vectors);
    }
    if dimensions != 3 {
        return error("joints in a plane, or beside rolling friction, are not supported");
    }
    let contacts = mu.iter().map(|&mu| Law::Contact { mu });
    let laws = contacts.chain((contact_rows..q.len()).map(|_| Law::LOCKED)).collect();
    let problem = Problem::new(laws, w, q).map_err(|e| FclibError(e.to_string()))?;
    Ok(File { problem, form: Form::Contacts })
}

// A matrix as FCLIB stores it, and CSparse before it.
impl Sparse {
    fn read(parent: &Group, name: &str) -> Result<Sparse, FclibError> {
        let own = group(parent, name)?;
        let size = |what: &str| {
            let size = integer(&own, what)?;
            usize::try_from(size)
                .map_err(|_| FclibError(format!("{name}/{what} must not be negative, but is {size}")))
        };
        let (rows, columns, storage) = (size("m")?, size("n")?, integer(&own, "nz")?);
        let (p, i, x) = (indices(&own, "p")?, indices(&own, "i")?, reals(&own, "x")?);
        let places: Vec<(usize, usize)> = match storage {
            0.. => p.iter().zip(&i).take(storage as usize).map(|(&column, &row)| (row, column)).collect(),
            -1 => compressed(&p, columns, &i, name)?.map(|(column, row)| (row, column)).collect(),
            -2 => compressed(&p, rows, &i, name)?.collect(),
            _ => return error(format!("{name}/nz must be at least -2, but is {storage}")),
        };
        let short = storage >= 0 && places.len() < storage as usize;
        if short
            || places.len() > x.len()
            || places.iter().any(|&(row, column)| row >= rows || column >= columns)
        {
            return error(format!("entries of {name} are missing or outside of it"));
        }
        if rows > x.len().max(COUPLED) * 64 || columns > x.len().max(COUPLED) * 64 {
            return error(format!("{name} is {rows} by {columns}, but has {} entries only", x.len()));
        }
        Ok(Sparse {
            rows,
            columns,
            entries: places.into_iter().zip(x).map(|((i, j), x)| (i, j, x)).collect(),
        })
    }
}

/// Each entry of a compressed matrix as its major index (column or row, whichever is compressed) and its
/// minor one.
fn compressed<'a>(
    pointer: &'a [usize],
    lines: usize,
    index: &'a [usize],
    name: &str,
) -> Result<impl Iterator<Item = (usize, usize)> + 'a, FclibError> {
    if pointer.len() <= lines
        || !pointer[..=lines].is_sorted()
        || pointer[lines] > index.len()
        || pointer[0] != 0
    {
        return error(format!("{name}/p must rise from 0 to at most the length of {name}/i"));
    }
    Ok((0..lines).flat_map(move |line| (pointer[line]..pointer[line + 1]).map(move |k| (line, index[k]))))
}

fn names(group: &Group) -> Result<Vec<String>, FclibError> {
    group.groups().map_err(|e| FclibError(format!("a group can't be listed: {e}")))
}

fn group(parent: &Group, name: &str) -> Result<Group, FclibError> {
    parent.group(name).map_err(|e| FclibError(format!("{name} can't be read: {e}")))
}

fn integers(parent: &Group, name: &str) -> Result<Vec<i32>, FclibError> {
    parent
        .dataset(name)
        .and_then(|set| set.read_i32())
        .map_err(|e| FclibError(format!("{name} can't be read: {e}")))
}

fn integer(parent: &Group, name: &str) -> Result<i32, FclibError> {
    integers(parent, name)?.first().copied().ok_or_else(|| FclibError(format!("{name} is empty")))
}

fn indices(parent: &Group, name: &str) -> Result<Vec<usize>, FclibError> {
    let negative = |_| FclibError(format!("{name} has a negative index"));
    integers(parent, name)?.into_iter().map(|i| usize::try_from(i).map_err(negative)).collect()
}

fn reals(parent: &Group, name: &str) -> Result<Vec<f64>, FclibError> {
    let reals = parent.dataset(name).and_then(|set| set.read_f64());
    let reals = reals.map_err(|e| FclibError(format!("{name} can't be read: {e}")))?;
    if reals.iter().all(|x| x.is_finite()) {
        Ok(reals)
    } else {
        error(format!("{name} has a number that is not finite"))
    }
}

fn dimensions(parent: &Group) -> Result<usize, FclibError> {
    match integer(parent, "spacedim")? {
        2 => Ok(2),
        3 => Ok(3),
        other => error(format!("spacedim must be 2 or 3, but is {other}")),
    }
}

#[cfg(test)]
#[path = "fclib_tests.rs"]
mod tests;
