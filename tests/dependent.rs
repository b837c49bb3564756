//! A program that depends on backstop keeps its own glam: Cargo unifies the features of a dependency over the
//! whole program, so a feature that the engine asked for would change the caller's types too.

use backstop::glam;

/// Data that a renderer hands to the GPU as they are.
#[repr(C)]
struct Uniforms {
    view: glam::Mat4,
    light: glam::Vec4,
    turn: glam::Quat,
    scale: f32,
}

/// glam's documentation: these are SIMD types, aligned to 16 bytes, where the target has SSE2, NEON or
/// SIMD128.
#[cfg(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128"))]
#[test]
fn glam_keeps_its_alignment() {
    assert_eq!([align_of::<glam::Vec4>(), align_of::<glam::Quat>(), align_of::<glam::Mat4>()], [16; 3]);
    assert_eq!((align_of::<Uniforms>(), size_of::<Uniforms>()), (16, 112));
}

/// Features of glam that change its types or its arithmetic, by its manifest.
#[test]
fn no_feature_of_glam_is_asked_for_that_changes_it() {
    let manifest = include_str!("../Cargo.toml");
    let asked: Vec<&str> = manifest.lines().filter(|line| line.contains("glam")).collect();
    assert!(asked.iter().any(|line| line.starts_with("glam = ")), "{asked:?}");
    for feature in ["scalar-math", "libm", "fast-math", "core-simd", "cuda", "glam-assert"] {
        assert!(asked.iter().all(|line| !line.contains(feature)), "{feature}: {asked:?}");
    }
}

/// A debug build of a caller's may not make hooks need more, or less, than a release build or one without
/// threads.
#[test]
fn worlds_go_to_other_threads() {
    fn sends<T: Send + Sync>() {}
    sends::<backstop::World>();
    sends::<backstop::Snapshot>();
    sends::<&dyn backstop::ContactHooks>();
}
