//! The testbed's session for JavaScript: a request goes in as text, a frame comes out as bytes.

use backstop_testbed::Session;
use std::cell::RefCell;

#[link(wasm_import_module = "testbed")]
unsafe extern "C" {
    safe fn now() -> f64;
}

struct Page {
    session: Session,
    request: Vec<u8>,
    answer: Vec<u8>,
}

fn clock() -> f64 {
    now()
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::new(Page {
        session: Session::new().with_clock(clock),
        request: Vec::new(),
        answer: Vec::new(),
    });
}

/// Room for a request of so many bytes, until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.request.clear();
        page.request.resize(length, 0);
        page.request.as_mut_ptr()
    })
}

/// Answers the request that was written; the length of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> usize {
    PAGE.with_borrow_mut(|Page { session, request, answer }| {
        let text = String::from_utf8_lossy(request.get(..length).unwrap_or_default());
        session.request(&text, answer);
        answer.len()
    })
}

/// Where the answer is, until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    PAGE.with_borrow(|page| page.answer.as_ptr())
}
