//! The name by which programs find the shared library. Its number grows when linked programs would break.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = |what: &str| std::env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default();
    if target("OS") == "linux" && target("ENV") != "msvc" {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libbackstop_c.so.{INTERFACE}");
    }
}

/// Grows when something is renamed, removed or changed. `BS_ABI_VERSION` grows with additions too.
const INTERFACE: u32 = 2;
