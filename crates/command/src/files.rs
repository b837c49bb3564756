//! Files that the command reads within a limit, and those that it replaces: only what it may have written
//! itself.

use anyhow::{Context, anyhow, bail, ensure};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a file of at most so many bytes. What the system says of a size is not asked: a device has none, and
/// a file may grow.
pub(crate) fn read(path: &Path, most: u64) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        bail!("it has more than {most} bytes");
    }
    Ok(bytes)
}

/// The same of text.
pub(crate) fn read_text(path: &Path, most: u64) -> anyhow::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|_| anyhow!("it is not text in UTF-8"))
}

/// Reads the numbers of a CSV file with a line of headings, at least `columns` in each line.
pub(crate) fn numbers(path: &Path, most: u64, columns: usize) -> anyhow::Result<Vec<Vec<f64>>> {
    let bytes = read(path, most)?;
    let line = |(line, row): (usize, csv::Result<csv::StringRecord>)| {
        let numbers: Result<Vec<f64>, _> = row?.iter().map(|number| number.trim().parse()).collect();
        let numbers = numbers.with_context(|| format!("line {}", line + 2))?;
        ensure!(numbers.len() >= columns, "line {} has {} numbers, not {columns}", line + 2, numbers.len());
        Ok(numbers)
    };
    csv::Reader::from_reader(&bytes[..]).records().enumerate().map(line).collect()
}

/// Mark of written pages and pictures of charts: a file with it may be replaced.
pub(crate) const MARK: &str = "<!-- by backstop -->\n";

/// The first bytes of a recording.
const REPLAY: &[u8] = b"backstop replay\n";
/// Bytes at the start of a file by which its kind is told.
const HEAD: u64 = 256;

/// The kind of file to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A scene or film.
    Gltf,
    /// A recording.
    Replay,
    /// A page or a chart of it.
    Page,
    /// Frames of a profile.
    Csv,
    /// A contact problem.
    Problem,
    /// Settings of a world.
    Settings,
}

impl Kind {
    /// What it is, and the extensions that it may have; none: any.
    fn format(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Kind::Gltf => ("glTF", &["glb", "gltf"]),
            Kind::Replay => ("a recording", &[]),
            Kind::Page => ("HTML", &["html", "htm", "svg"]),
            Kind::Csv => ("CSV", &["csv"]),
            Kind::Problem => ("a contact problem", &["dat"]),
            Kind::Settings => ("settings as JSON", &["json"]),
        }
    }

    /// Whether a file that begins like this may be of this kind.
    fn begins(self, head: &[u8]) -> bool {
        let has = |text: &str| head.windows(text.len()).any(|part| part == text.as_bytes());
        match self {
            Kind::Gltf => head.starts_with(b"glTF") || head.starts_with(b"{"),
            Kind::Replay => head.starts_with(REPLAY),
            Kind::Page => has(MARK.trim_end()),
            Kind::Csv => head.starts_with(b"threads,step,"),
            Kind::Problem => head.iter().all(|b| b.is_ascii_digit() || b" \n+-.eE".contains(b)),
            Kind::Settings => head.starts_with(b"{") && has("\"about\":"),
        }
    }
}

/// Refuses to write a file of this kind to a path whose extension says another one, or where something else
/// is. Devices and pipes take anything.
pub(crate) fn expect_place(path: &Path, kind: Kind) -> anyhow::Result<()> {
    let about = || format!("can't write {}", path.display());
    let there = path.metadata().ok();
    if there.as_ref().is_some_and(|there| !there.is_file() && !there.is_dir()) {
        return Ok(());
    }
    let (name, endings) = kind.format();
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if !endings.is_empty() && !endings.iter().any(|one| ending.eq_ignore_ascii_case(one)) {
        let endings = endings.iter().map(|one| format!(".{one}")).collect::<Vec<_>>().join(" or ");
        return Err(anyhow!("it will be {name}, so its name must end in {endings}")).with_context(about);
    }
    let Some(there) = there else { return Ok(()) };
    if there.is_dir() {
        return Err(anyhow!("it is a folder")).with_context(about);
    }
    let mut head = Vec::new();
    File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head)).with_context(about)?;
    if !head.is_empty() && !kind.begins(&head) {
        let what =
            "there is a file of something else, which would be lost: remove it, or choose another name";
        return Err(anyhow!(what)).with_context(about);
    }
    Ok(())
}

/// [`expect_place`] for each of these in a folder that may be there.
pub(crate) fn expect_places<'a>(
    folder: &Path,
    names: impl IntoIterator<Item = &'a str>,
    kind: Kind,
) -> anyhow::Result<()> {
    names.into_iter().try_for_each(|name| expect_place(&folder.join(name), kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_may_be_its_own_is_replaced() {
        let folder = std::env::temp_dir().join(format!("backstop-files-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let refused =
            |name: &str, kind: Kind| expect_place(&folder.join(name), kind).err().map(|e| format!("{e:#}"));
        for (name, own, kind) in [
            ("a.glb", &b"glTF\x02\0\0\0"[..], Kind::Gltf),
            ("a.gltf", b"{\n  \"accessors\": [", Kind::Gltf),
            ("a", REPLAY, Kind::Replay),
            ("a.html", b"<!doctype html>\n<!-- by backstop -->\n<html", Kind::Page),
            ("a.csv", b"threads,step,discrete_us", Kind::Csv),
            ("a.dat", b"3\n20\n1.5e-3 -2\n", Kind::Problem),
            ("a.json", b"{\n  \"about\": \"talk\"", Kind::Settings),
        ] {
            assert_eq!(refused(name, kind), None, "nothing is there");
            for (content, is_own) in
                [(own, true), (b"", true), (b"precious", false), (b"\x89PNG\r\n\x1a\n", false)]
            {
                std::fs::write(folder.join(name), content).unwrap();
                assert_eq!(refused(name, kind).is_none(), is_own, "{name} {content:?}");
            }
            assert!(refused(name, kind).unwrap().contains("would be lost"));
        }
        assert!(refused("a.obj", Kind::Gltf).unwrap().contains(".glb or .gltf"));
        assert!(refused("a", Kind::Csv).unwrap().contains(".csv"));
        std::fs::create_dir_all(folder.join("b.glb")).unwrap();
        assert!(refused("b.glb", Kind::Gltf).unwrap().contains("a folder"));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_an_end_is_read_to_the_limit() {
        let error = read(Path::new("/dev/zero"), 1000).unwrap_err();
        assert_eq!(error.to_string(), "it has more than 1000 bytes");
        assert!(expect_place(Path::new("/dev/null"), Kind::Gltf).is_ok());
    }
}
