//! The code blocks of README and of the guides, compiled and run.

macro_rules! pages {
    ($($name:ident $file:literal,)*) => {
        $(
            #[cfg(doctest)]
            #[doc = include_str!(concat!("../", $file))]
            mod $name {}
        )*
    };
}

pages! {
    readme "README.md",
    characters "docs/characters.md",
    coming_from "docs/coming-from.md",
    debug_drawing "docs/debug-drawing.md",
    determinism "docs/determinism.md",
    events "docs/events.md",
    games "docs/games.md",
    joints "docs/joints.md",
    levels "docs/levels.md",
    memory "docs/memory.md",
    queries "docs/queries.md",
    replay "docs/replay.md",
    sleeping "docs/sleeping.md",
    snapshots "docs/snapshots.md",
}
