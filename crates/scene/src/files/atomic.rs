//! Files that are written whole or not at all.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file that appears under its name, or replaces the present one, once it is complete.
///
/// Until [`AtomicFile::commit`] all goes into a temporary file beside the target; without it, on an error or
/// when the value is dropped, the temporary file is removed and the target stays as it was. A target that is
/// not a regular file, a pipe or a device, can't be replaced and is written directly. A link stays a link:
/// its target is replaced. Permissions are kept.
#[derive(Debug)]
pub struct AtomicFile {
    file: BufWriter<File>,
    /// The temporary file and the one it becomes.
    paths: Option<(PathBuf, PathBuf)>,
}

impl AtomicFile {
    /// Begins a file.
    ///
    /// # Errors
    /// If the folder is not there or can't be written to, or the target is a folder.
    pub fn create(target: impl AsRef<Path>) -> io::Result<AtomicFile> {
        let target = target.as_ref();
        let old = match target.metadata() {
            Ok(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(old) if !old.is_file() => {
                let file = BufWriter::new(OpenOptions::new().write(true).open(target)?);
                return Ok(AtomicFile { file, paths: None });
            }
            // A rename would replace it although it is read-only.
            Ok(old) if old.permissions().readonly() => return Err(ErrorKind::PermissionDenied.into()),
            Ok(old) => Some(old),
            Err(_) => None,
        };
        let target = if old.is_some() { target.canonicalize()? } else { target.to_path_buf() };
        let (temporary, file) = temporary_beside(&target)?;
        let made = AtomicFile { file: BufWriter::new(file), paths: Some((temporary, target)) };
        if let Some(old) = old {
            made.file.get_ref().set_permissions(old.permissions())?;
        }
        Ok(made)
    }

    /// Flushes, syncs the data to disk, and gives the file its name.
    ///
    /// # Errors
    /// If one of these fails, for instance because the disk is full; the target is then unchanged.
    pub fn commit(mut self) -> io::Result<()> {
        self.file.flush()?;
        let Some((temporary, target)) = &self.paths else { return Ok(()) };
        self.file.get_ref().sync_all()?;
        std::fs::rename(temporary, target)?;
        self.paths = None;
        Ok(())
    }

    /// A second handle to the same file, for code that keeps its writer: write to one of the two only. Flush
    /// it before [`AtomicFile::commit`].
    ///
    /// # Errors
    /// If the system has no handle left.
    pub fn writer(&self) -> io::Result<BufWriter<File>> {
        Ok(BufWriter::new(self.file.get_ref().try_clone()?))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some((temporary, _)) = &self.paths {
            // Errors can't be reported from here.
            let _ = std::fs::remove_file(temporary);
        }
    }
}

/// Writes a whole file by [`AtomicFile`].
///
/// # Errors
/// Errors of the closure or the system; the target is then unchanged.
pub fn write_file(
    target: impl AsRef<Path>,
    write: impl FnOnce(&mut AtomicFile) -> io::Result<()>,
) -> io::Result<()> {
    let mut file = AtomicFile::create(target)?;
    write(&mut file)?;
    file.commit()
}

/// Refuses an output that would replace an input, however the two are spelled.
///
/// # Errors
/// If both name the same file.
pub fn refuse_input(output: &Path, input: &Path) -> io::Result<()> {
    let same = match (output.canonicalize(), input.canonicalize()) {
        // A device has nothing to lose.
        (Ok(a), Ok(b)) => a == b && a.is_file(),
        _ => false,
    };
    let what = || format!("it would replace {}, which is read", input.display());
    if same { Err(io::Error::new(ErrorKind::InvalidInput, what())) } else { Ok(()) }
}

/// A new file in the same folder, so that a rename needs no copy.
fn temporary_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = target.file_name().ok_or(ErrorKind::InvalidInput)?;
    loop {
        let mut own = std::ffi::OsString::from(".");
        own.push(name);
        own.push(format!(".{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
        let path = target.with_file_name(own);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((path, file)),
            // Left by a killed process with the same id; try the next number.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::scratch;
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let name = |f: io::Result<std::fs::DirEntry>| f.unwrap().file_name().into_string().unwrap();
        std::fs::read_dir(folder).unwrap().map(name).collect()
    }

    /// A disk that is full halfway left half a file. Expected: the old content, and nothing beside it.
    #[test]
    fn a_write_that_fails_leaves_what_was_there() {
        let folder = scratch("atomic");
        let target = folder.join("out.bin");
        let fail = |file: &mut AtomicFile| {
            file.write_all(&[1; 100_000])?;
            file.flush()?;
            Err(ErrorKind::StorageFull.into())
        };
        let _ = std::fs::remove_file(&target);
        assert_eq!(write_file(&target, fail).unwrap_err().kind(), ErrorKind::StorageFull);
        assert_eq!(names(&folder), Vec::<String>::new());
        std::fs::write(&target, "old").unwrap();
        assert!(write_file(&target, fail).is_err());
        assert_eq!((std::fs::read(&target).unwrap(), names(&folder).len()), (b"old".to_vec(), 1));
        write_file(&target, |file| file.write_all(b"new")).unwrap();
        assert_eq!((std::fs::read(&target).unwrap(), names(&folder).len()), (b"new".to_vec(), 1));
        assert!(
            refuse_input(&folder.join("..").join(folder.file_name().unwrap()).join("out.bin"), &target)
                .is_err()
        );
        assert!(refuse_input(&folder.join("other.bin"), &target).is_ok());
    }

    /// Renaming would put a file in the place of a device. Expected: it is written to, and says that it is
    /// full.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_stays_a_device_and_a_link_a_link() {
        let full = write_file("/dev/full", |file| file.write_all(&[1; 100_000]));
        assert_eq!(full.unwrap_err().kind(), ErrorKind::StorageFull);
        write_file("/dev/null", |file| file.write_all(b"gone")).unwrap();
        let folder = scratch("atomic_link");
        let (target, link) = (folder.join("target"), folder.join("link"));
        std::fs::write(&target, "old").unwrap();
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write_file(&link, |file| file.write_all(b"new")).unwrap();
        assert!(link.is_symlink() && std::fs::read(&target).unwrap() == b"new");
    }
}
