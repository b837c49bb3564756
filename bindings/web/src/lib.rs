//! The testbed in a browser: a session, for JavaScript. A request goes in as text, and a frame comes out as
//! bytes; both lie in linear memory until the next call.

use backstop_testbed::Session;
use std::cell::RefCell;

#[link(wasm_import_module = "testbed")]
unsafe extern "C" {
    /// `performance.now()` [ms]: WebAssembly has no clock.
    safe fn now() -> f64;
}

fn clock() -> f64 {
    now()
}

struct Page {
    session: Session,
    request: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::new(Page {
        session: Session::new().with_clock(clock),
        request: Vec::new(),
        answer: Vec::new(),
    });
}

/// Room for a request of so many bytes.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.request.clear();
        page.request.resize(length, 0);
        page.request.as_mut_ptr()
    })
}

/// Answers the request that was written there; the length of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> usize {
    PAGE.with_borrow_mut(|Page { session, request, answer }| {
        let text = String::from_utf8_lossy(request.get(..length).unwrap_or_default());
        session.request(&text, answer);
        answer.len()
    })
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    PAGE.with_borrow(|page| page.answer.as_ptr())
}
