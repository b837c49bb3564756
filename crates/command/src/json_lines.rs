//! Files with a line of JSON for each result, to which a run appends: the last line may be incomplete.

use crate::files;
use anyhow::{Context, anyhow, bail};
use serde::Serialize;
use serde::de::IgnoredAny;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Bytes of the largest file that is read.
const LARGEST: u64 = 1 << 28;

/// The bytes of a file of results.
pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    files::read(path, LARGEST)
}

/// The complete lines, with or without the last line's end.
pub(crate) fn whole(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let is_whole = serde_json::from_slice::<IgnoredAny>(&bytes[end..]).is_ok();
    if is_whole { bytes } else { &bytes[..end] }
}

/// Refuses a file without results, and leaves it as it is: one in which the first or the last line begins in
/// another way than `starts`. Returns how many bytes are complete lines, of a file that is there.
pub(crate) fn expect(path: &Path, starts: &[&str]) -> anyhow::Result<usize> {
    let about = || format!("can't write results to {}", path.display());
    let Ok(there) = path.metadata() else { return Ok(0) };
    // A pipe would keep this waiting, and a device can't be added to.
    if !there.is_file() {
        return Err(anyhow!("it is not a regular file")).with_context(about);
    }
    let bytes = read(path).with_context(about)?;
    let kept = whole(&bytes).len();
    expect_results(&bytes, kept, starts).with_context(about)?;
    Ok(kept)
}

/// Opens a file to add to, or makes one. An incomplete last line is removed, or the next line would be
/// appended to it. `starts`: how lines of results begin; other files are refused by [`expect`].
pub(crate) fn open(path: &Path, starts: &[&str]) -> anyhow::Result<File> {
    let kept = expect(path, starts)?;
    let begin = || {
        let mut file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(path)?;
        file.set_len(kept as u64)?;
        if kept > 0 {
            let mut last = [0];
            file.seek(SeekFrom::End(-1))?;
            file.read_exact(&mut last)?;
            if last != *b"\n" {
                file.write_all(b"\n")?;
            }
        }
        Ok::<_, std::io::Error>(file)
    };
    begin().with_context(|| format!("can't write results to {}", path.display()))
}

/// Refuses bytes whose first line, or whose incomplete last line after so many bytes, can't be one of
/// results.
fn expect_results(bytes: &[u8], whole: usize, starts: &[&str]) -> anyhow::Result<()> {
    // A line may end within its expected beginning.
    let is_own = |line: &[u8]| {
        let begins = |start: &&str| line.iter().zip(start.as_bytes()).all(|(a, b)| a == b);
        starts.iter().any(begins)
    };
    if !is_own(bytes) || !is_own(&bytes[whole..]) {
        bail!("it holds something else, which would be lost: remove it, or choose another name");
    }
    Ok(())
}

/// Adds a line in one write, so that it is written whole or not at all.
pub(crate) fn put(out: &mut impl Write, result: &impl Serialize) -> anyhow::Result<()> {
    let mut line = serde_json::to_string(result)?;
    line.push('\n');
    out.write_all(line.as_bytes()).and_then(|()| out.flush()).context("can't write results")
}

#[cfg(test)]
mod tests {
    use super::*;

    const STARTS: [&str; 2] = ["{\"a\":", "{\"b\":"];

    #[derive(Serialize)]
    struct One {
        b: u32,
    }

    #[test]
    fn a_half_line_is_cut_before_more_is_added() {
        let path = std::env::temp_dir().join(format!("backstop-lines-{}.jsonl", std::process::id()));
        let added = |there: &str| {
            std::fs::write(&path, there).unwrap();
            put(&mut open(&path, &STARTS).unwrap(), &One { b: 4 }).unwrap();
            std::fs::read_to_string(&path).unwrap()
        };
        assert_eq!(added("{\"a\":1}\n{\"b\":2}\n{\"b\":3"), "{\"a\":1}\n{\"b\":2}\n{\"b\":4}\n");
        assert_eq!(added("{\"a\":1}"), "{\"a\":1}\n{\"b\":4}\n");
        for nothing in ["", "{", "{\"a\"", "{\"a\":1"] {
            assert_eq!(added(nothing), "{\"b\":4}\n");
        }
        std::fs::remove_file(&path).unwrap();
        put(&mut open(&path, &STARTS).unwrap(), &One { b: 5 }).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "{\"b\":5}\n");
        std::fs::remove_file(&path).unwrap();
    }

    /// A file without a line break was emptied. Expected: a file that does not have results stays as it is.
    #[test]
    fn what_is_not_of_results_is_refused_untouched() {
        let path = std::env::temp_dir().join(format!("backstop-foreign-{}.txt", std::process::id()));
        for precious in ["precious", "{\"c\": 1}", "precious\n", "{\"a\":1}\nprecious", "\n", "{ \"a\":1}\n"]
        {
            std::fs::write(&path, precious).unwrap();
            assert!(open(&path, &STARTS).is_err(), "{precious:?}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), precious);
        }
        std::fs::remove_file(&path).unwrap();
    }
}
