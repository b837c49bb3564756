//! `include/backstop.h` is what cbindgen makes of the sources. After a change of the interface:
//! `BS_WRITE_HEADER=1 cargo test --test header`, which writes it anew.

use std::{env, fs, path::Path};

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = env!("CARGO_MANIFEST_DIR");
    let mut made = Vec::new();
    cbindgen::generate(folder).expect("sources that cbindgen reads").write(&mut made);
    let made = String::from_utf8(made).expect("a header in UTF-8");
    let path = Path::new(folder).join("include/backstop.h");
    if env::var_os("BS_WRITE_HEADER").is_some() {
        fs::write(&path, &made).expect("a header that can be written");
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    let first = made.lines().zip(kept.lines()).find(|(made, kept)| made != kept);
    assert!(made == kept, "include/backstop.h is of other sources; the first line that differs: {first:?}");
}
