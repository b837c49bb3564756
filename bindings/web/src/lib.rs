//! backstop in a browser. JavaScript calls the functions below; what is more than a number lies in linear
//! memory, where [`text`] or [`numbers`] says, until the next call.
//!
//! A function that may be refused returns the length of the error in [`text`], 0 if it was not refused.

mod drawing;
mod run;
mod scenes;

use backstop::{Error, Settings};
use drawing::{Drawing, Points};
use run::Run;
use std::cell::RefCell;
use std::fmt::Write;

/// All that the page has.
#[derive(Default)]
struct Page {
    open: Option<(Run, Drawing)>,
    text: String,
    numbers: Vec<f32>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn page<T>(f: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(f)
}

impl Page {
    /// The length of a refusal, written as text.
    fn told(&mut self, result: Result<(), Error>) -> usize {
        self.text.clear();
        if let Err(error) = result {
            let _ = write!(self.text, "{error}");
        }
        self.text.len()
    }

    /// Does something with the open scene, if there is one.
    fn with(&mut self, f: impl FnOnce(&mut Run) -> Result<(), Error>) -> usize {
        let result = self.open.as_mut().map_or(Ok(()), |(run, _)| f(run));
        self.told(result)
    }

    /// Fills [`numbers`] from the open scene; how many there are.
    fn fill(&mut self, f: impl FnOnce(&Run, &Drawing, &mut Vec<f32>)) -> usize {
        self.numbers.clear();
        if let Some((run, drawing)) = &self.open {
            f(run, drawing, &mut self.numbers);
        }
        self.numbers.len()
    }
}

/// Where the text of the last call is.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    page(|page| page.text.as_ptr())
}

/// Where the numbers of the last call are.
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *const f32 {
    page(|page| page.numbers.as_ptr())
}

/// The scenes, as JSON; the length of the text.
#[unsafe(no_mangle)]
pub extern "C" fn catalogue() -> usize {
    page(|page| {
        page.text.clear();
        for (i, offer) in scenes::OFFERS.iter().enumerate() {
            let begin = if i == 0 { "[" } else { "," };
            let [size, least, most] = offer.sizes;
            let _ = write!(
                page.text,
                r#"{begin}{{"name":"{}","about":"{}","unit":"{}","size":{size},"least":{least},"most":{most}}}"#,
                offer.name, offer.about, offer.unit
            );
        }
        page.text.push(']');
        page.text.len()
    })
}

/// Opens a scene by its index in the catalogue, in place of the one that was open.
#[unsafe(no_mangle)]
pub extern "C" fn open(scene: usize, size: u32, substeps: u32, iterations: u32, sleeping: bool) -> usize {
    page(|page| {
        page.open = None;
        let settings =
            Settings::default().with_substeps(substeps).with_iterations(iterations).with_sleeping(sleeping);
        let opened = Run::open(scene, size, &settings).map(|run| {
            let drawing = Drawing::of(&run.world, &run.joints);
            page.open = Some((run, drawing));
        });
        page.told(opened)
    })
}

/// Changes settings of the open scene.
#[unsafe(no_mangle)]
pub extern "C" fn configure(substeps: u32, iterations: u32, sleeping: bool) -> usize {
    page(|page| page.with(|run| run.configure(substeps, iterations, sleeping)))
}

/// Takes the snapshot that [`back`] needs after the next step.
#[unsafe(no_mangle)]
pub extern "C" fn remember() -> usize {
    page(|page| {
        page.with(|run| {
            run.remember();
            Ok(())
        })
    })
}

/// One step of 1/60 s.
#[unsafe(no_mangle)]
pub extern "C" fn step() -> usize {
    page(|page| page.with(Run::step))
}

/// Back by one step, to the same bits, if it was remembered.
#[unsafe(no_mangle)]
pub extern "C" fn back() -> usize {
    page(|page| page.with(|run| run.back().map(drop)))
}

/// The ledger, as JSON; the length of the text.
#[unsafe(no_mangle)]
pub extern "C" fn report() -> usize {
    page(|page| {
        page.text.clear();
        if let Some((run, _)) = &page.open {
            run.report(&mut page.text);
        }
        page.text.len()
    })
}

/// Number of meshes of the open scene.
#[unsafe(no_mangle)]
pub extern "C" fn meshes() -> usize {
    page(|page| page.open.as_ref().map_or(0, |(_, drawing)| drawing.meshes.len()))
}

/// Corners of the triangles of a mesh, as numbers.
#[unsafe(no_mangle)]
pub extern "C" fn mesh(index: usize) -> usize {
    page(|page| {
        page.fill(|_, drawing, into| {
            into.extend(drawing.meshes.get(index).into_iter().flatten());
        })
    })
}

/// Mesh and tone of each shape, as numbers.
#[unsafe(no_mangle)]
pub extern "C" fn instances() -> usize {
    page(|page| {
        page.fill(|_, drawing, into| {
            into.extend(drawing.instances.iter().flatten().map(|&n| n as f32));
        })
    })
}

/// Pairs of shapes that are joined, as numbers.
#[unsafe(no_mangle)]
pub extern "C" fn links() -> usize {
    page(|page| {
        page.fill(|_, drawing, into| {
            into.extend(drawing.links.iter().flatten().map(|&n| n as f32));
        })
    })
}

/// Eight numbers for each shape: position, rotation, whether it is asleep.
#[unsafe(no_mangle)]
pub extern "C" fn poses() -> usize {
    page(|page| page.fill(|run, drawing, into| drawing.poses(&run.world, into)))
}

/// Four numbers for each point of contact: position, and what it is.
#[unsafe(no_mangle)]
pub extern "C" fn points() -> usize {
    page(|page| page.fill(|run, _, into| Points(into).draw(&run.world)))
}
