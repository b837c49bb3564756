//! The name by which programs find the shared library: with the version of the interface that it keeps.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = |what: &str| std::env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default();
    if target("OS") == "linux" && target("ENV") != "msvc" {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libbackstop_c.so.{INTERFACE}");
    }
}

/// Grows only when what was there changes, unlike `BS_ABI_VERSION`, which grows with each addition.
const INTERFACE: u32 = 1;
