//! Guides: the pages of `docs/` for users of the engine. They are part of its documentation only;
//! `tests/lib.rs` compiles their code.
//!
//! On their own the pages refer to each other by file name. Here the same references are defined as links to
//! modules and to sources, and those to pictures as the pictures themselves, which rustdoc copies nowhere;
//! the first definition of a reference is the one that counts.

macro_rules! links {
    () => {
        concat!(
            "[characters.md]: self::characters\n",
            "[determinism.md]: self::determinism\n",
            "[events.md]: self::events\n",
            "[joints.md]: self::joints\n",
            "[levels.md]: self::levels\n",
            "[memory.md]: self::memory\n",
            "[memory.md#the-budget]: self::memory#the-budget\n",
            "[queries.md]: self::queries\n",
            "[replay.md]: self::replay\n",
            "[snapshots.md]: self::snapshots\n",
            "[images/debug-drawing.png]: ",
            include_str!("../docs/images/debug-drawing.png.uri"),
            "[images/orders.svg]: ",
            include_str!("../docs/images/orders.svg.uri"),
        )
    };
}

/// A module for each page: its text, with its references to sources.
macro_rules! pages {
    ($($name:ident $file:literal [$($source:literal)*],)*) => {
        $(
            #[doc = links!()]
            $(
                #[doc = concat!("[../src/", $source, "]: ../../../src/backstop/", $source, ".html\n")]
            )*
            #[doc = "\n"]
            #[doc = include_str!(concat!("../docs/", $file))]
            pub mod $name {}
        )*
    };
}

pages! {
    characters "characters.md" [],
    coming_from "coming-from.md" [],
    debug_drawing "debug-drawing.md" [],
    determinism "determinism.md" ["lanes/mod.rs" "math.rs" "threads.rs"],
    events "events.md" ["events/mod.rs"],
    joints "joints.md" ["constraint/schedule/order.rs"],
    levels "levels.md" [],
    memory "memory.md" [
        "world/memory/budget.rs" "shape/mesh/bvh.rs" "narrow_phase/contacts/store.rs" "world/memory/needs.rs"
        "memory/allowance.rs" "memory/slab.rs" "constraint/contact/crowd.rs" "memory/allowances.rs"
        "narrow_phase/contacts/weight.rs" "narrow_phase/contacts/admit.rs"
    ],
    queries "queries.md" ["query/mod.rs" "broad_phase/query_tree.rs"],
    replay "replay.md" [
        "replay/file.rs" "load_limits.rs" "world/step/observers.rs" "replay/call.rs" "replay/play.rs"
    ],
    sleeping "sleeping.md" [],
    snapshots "snapshots.md" [],
}
