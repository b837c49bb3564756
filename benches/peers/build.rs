//! Notes how the program is built, and compiles Jolt with its shim if the feature `jolt` asks for it.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    println!("cargo:rustc-env=PEERS_RUSTFLAGS={flags}");
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    println!("cargo:rustc-env=PEERS_PROFILE={}, opt-level {}", of("PROFILE"), of("OPT_LEVEL"));
    #[cfg(feature = "jolt")]
    jolt::build();
}

#[cfg(feature = "jolt")]
mod jolt {
    use std::path::{Path, PathBuf};
    use std::process::Command;

    /// Compiles Jolt and the shim, both with the same flags: they change the layout of Jolt's classes.
    pub fn build() {
        println!("cargo:rerun-if-changed=native");
        println!("cargo:rerun-if-env-changed=JOLT_DIR");
        let built = cmake::Config::new("native")
            // Release without profiler and debug renderer; AVX2 and FMA are on by default.
            .profile("Distribution")
            .define("JOLT_SOURCE", sources())
            .define("INTERPROCEDURAL_OPTIMIZATION", "OFF")
            .define("GENERATE_DEBUG_SYMBOLS", "OFF")
            .build();
        println!("cargo:rustc-link-search=native={}/lib", built.display());
        println!("cargo:rustc-link-lib=static=peers_jolt");
        println!("cargo:rustc-link-lib=static=Jolt");
        println!("cargo:rustc-link-lib=stdc++");
    }

    /// `JOLT_DIR`, or the sources in the package `joltc-sys`, which cargo has fetched.
    fn sources() -> PathBuf {
        if let Some(folder) = std::env::var_os("JOLT_DIR") {
            println!("cargo:rustc-env=PEERS_JOLT=of JOLT_DIR");
            return folder.into();
        }
        println!("cargo:rustc-env=PEERS_JOLT=5.0.0 (joltc-sys 0.3.1), AVX2");
        let cargo = std::env::var("CARGO").expect("cargo sets CARGO");
        let output = Command::new(cargo)
            .args(["metadata", "--format-version", "1"])
            .output()
            .expect("cargo metadata runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("metadata is JSON");
        let package = metadata["packages"]
            .as_array()
            .into_iter()
            .flatten()
            .find(|package| package["name"] == "joltc-sys")
            .expect("joltc-sys is among the dependencies");
        let manifest = package["manifest_path"].as_str().expect("a path");
        Path::new(manifest).with_file_name("JoltC").join("JoltPhysics")
    }
}
