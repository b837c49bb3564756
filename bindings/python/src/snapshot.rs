//! Snapshots of worlds.

use crate::convert::refused;
use crate::world::World;
use backstop::BodyHandle;
use pyo3::prelude::*;

/// The state of a world, from which it goes on to the same bits.
#[pyclass(module = "backstop")]
pub(crate) struct Snapshot {
    state: backstop::Snapshot,
    /// Bodies in the order of the rows of arrays, unless it came from bytes.
    order: Option<Vec<BodyHandle>>,
}

#[pymethods]
impl Snapshot {
    /// The snapshot that [`Snapshot::to_bytes`] wrote.
    #[staticmethod]
    fn from_bytes(data: &[u8]) -> PyResult<Snapshot> {
        Ok(Snapshot { state: backstop::Snapshot::from_bytes(data).map_err(refused)?, order: None })
    }

    /// All of it as bytes, for a file.
    fn to_bytes(&self) -> Vec<u8> {
        self.state.to_whole_bytes()
    }

    /// Its size in memory [bytes].
    #[getter]
    fn size(&self) -> usize {
        self.state.size()
    }
}

#[pymethods]
impl World {
    /// The state of the world.
    fn snapshot(&self) -> Snapshot {
        let mut state = backstop::Snapshot::new();
        self.world.snapshot(&mut state);
        Snapshot { state, order: Some(self.order.clone()) }
    }

    /// Takes the world back to a snapshot, of this world or of another.
    fn restore(&mut self, snapshot: &Snapshot) -> PyResult<()> {
        self.world.restore(&snapshot.state).map_err(refused)?;
        match &snapshot.order {
            Some(order) => self.order.clone_from(order),
            None => self.find_order(),
        }
        Ok(())
    }
}
