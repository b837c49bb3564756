//! Files with a line of JSON for each result, to which a run appends: the last line may be incomplete.

use anyhow::Context;
use serde::Serialize;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// The complete lines.
pub(crate) fn whole(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    &bytes[..end]
}

/// Opens a file to add to, or makes one. An incomplete last line is removed, or the next line would be
/// appended to it.
pub(crate) fn open(path: &Path) -> anyhow::Result<File> {
    let about = || format!("can't write results to {}", path.display());
    let mut options = OpenOptions::new();
    let mut file =
        options.create(true).truncate(false).read(true).write(true).open(path).with_context(about)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).with_context(about)?;
    file.set_len(whole(&bytes).len() as u64).with_context(about)?;
    file.seek(SeekFrom::End(0)).with_context(about)?;
    Ok(file)
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

    #[test]
    fn a_half_line_is_cut_before_more_is_added() {
        let path = std::env::temp_dir().join(format!("backstop-lines-{}.jsonl", std::process::id()));
        std::fs::write(&path, "1\n2\n3 and a ha").unwrap();
        put(&mut open(&path).unwrap(), &4).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "1\n2\n4\n");
        std::fs::remove_file(&path).unwrap();
        put(&mut open(&path).unwrap(), &5).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "5\n");
        std::fs::remove_file(&path).unwrap();
    }
}
