//! The page's files, each as it is served.

/// Name, media type and bytes of each file. The first is the page itself.
pub const FILES: &[(&str, &str, &[u8])] = &[];

/// The file of a name; the page itself for an empty one.
pub fn file(name: &str) -> Option<&'static (&'static str, &'static str, &'static [u8])> {
    if name.is_empty() { FILES.first() } else { FILES.iter().find(|file| file.0 == name) }
}
