//! What a `uri` of a scene may name. A scene may come from an untrusted source, so its uris must not read
//! files that do not belong to it.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// Most bytes of an image beside a scene that a film takes in; glTF states no length for it.
pub(super) const MAX_IMAGE: u64 = 1 << 28;

/// Maps a `uri` of a scene to its bytes: the uri as it stands in the file, never a data URI, and the most
/// bytes that are used of it. An error says why not; it must not quote the content.
///
/// [`scene_folder`] is the default. `|_, _| Err("this application reads no files".into())` refuses all.
pub type Resolver<'a> = dyn Fn(&str, u64) -> Result<Vec<u8>, String> + 'a;

/// The default [`Resolver`] of the scene at `path`: regular files in the scene's folder or below it.
///
/// A uri is a relative path, percent-encoded. It may neither lead out of the folder by `..` nor by a symbolic
/// link, nor name a device, a pipe or a folder.
pub fn scene_folder(path: &Path) -> impl Fn(&str, u64) -> Result<Vec<u8>, String> + use<> {
    let folder = folder_of(path);
    move |uri, most| {
        let file = find(&folder, uri)?;
        let mut bytes = Vec::new();
        let file = File::open(file).map_err(|e| e.to_string())?;
        // Checked again after opening: it may have been replaced meanwhile.
        if !file.metadata().is_ok_and(|m| m.is_file()) {
            return Err("not a regular file".into());
        }
        file.take(most).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
        Ok(bytes)
    }
}

/// The folder of a file.
pub(super) fn folder_of(file: &Path) -> PathBuf {
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new(".")).to_path_buf()
}

/// The file that a uri names in a folder.
pub(super) fn find(folder: &Path, uri: &str) -> Result<PathBuf, String> {
    const OUTSIDE: &str = "it leads out of the scene's folder";
    let scheme = uri.split(['/', '?', '#']).next().is_some_and(|start| start.contains(':'));
    if scheme {
        return Err("only data URIs and relative paths are read".into());
    }
    let relative = percent_decode(uri).ok_or("not a valid URI")?;
    if relative.contains('\0') {
        return Err("not a valid URI".into());
    }
    // Before the file system is accessed, so as not to reveal whether a file outside exists.
    let mut depth = 0i32;
    for part in Path::new(&relative).components() {
        depth += match part {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::RootDir | Component::Prefix(_) => return Err("an absolute path".into()),
        };
        if depth < 0 {
            return Err(OUTSIDE.into());
        }
    }
    let real = |path: &Path| path.canonicalize().map_err(|e| e.to_string());
    let (folder, file) = (real(folder)?, real(&folder.join(&relative))?);
    if !file.starts_with(&folder) {
        return Err(OUTSIDE.into());
    }
    // Checked before opening: opening a pipe may block for ever.
    match file.metadata() {
        Ok(m) if m.is_file() => Ok(file),
        Ok(_) => Err("not a regular file".into()),
        Err(error) => Err(error.to_string()),
    }
}

fn percent_decode(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        rest = after;
        if first == b'%' {
            let digit = |at: usize| char::from(*rest.get(at)?).to_digit(16);
            bytes.push((digit(0)? * 16 + digit(1)?) as u8);
            rest = &rest[2..];
        } else {
            bytes.push(first);
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::super::testing::scratch;
    use super::*;

    #[test]
    fn uris_are_decoded() {
        assert_eq!(percent_decode("a%20b.bin").as_deref(), Some("a b.bin"));
        for bad in ["a%2", "%zz", "%+1", "%", "%ff"] {
            assert_eq!(percent_decode(bad), None, "{bad}");
        }
    }

    /// A scene read any file of the system. Expected: only files in its folder are read.
    #[test]
    fn only_regular_files_in_the_folder_of_the_scene_are_read() {
        let outer = scratch("resolve");
        let folder = outer.join("scene");
        std::fs::create_dir_all(folder.join("parts")).unwrap();
        std::fs::write(outer.join("secret.bin"), "secret").unwrap();
        std::fs::write(folder.join("a b.bin"), "inside").unwrap();
        let read = scene_folder(&folder.join("scene.gltf"));
        for uri in ["a b.bin", "a%20b.bin", "./a%20b.bin", "parts/../a%20b.bin"] {
            assert_eq!(read(uri, 100).unwrap(), b"inside", "{uri}");
        }
        assert_eq!(read("a%20b.bin", 3).unwrap(), b"ins", "no more than is asked for");
        let absolute = outer.join("secret.bin");
        let mut refused =
            vec!["../secret.bin", "%2e%2e/secret.bin", "parts/../../secret.bin", "..%2Fsecret.bin"];
        refused.extend(["file:///etc/passwd", "https://example.org/a.bin", "/dev/stdin", "%2Fdev%2Fzero"]);
        refused.extend([absolute.to_str().unwrap(), "parts", "", ".", "none.bin", "a%00b", "a b.bin/x"]);
        #[cfg(unix)]
        {
            let link = |to: &Path, name: &str| {
                let _ = std::fs::remove_file(folder.join(name));
                std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
            };
            link(&absolute, "link.bin");
            link(&outer, "out");
            link(Path::new("/dev/zero"), "zero.bin");
            link(&folder.join("a b.bin"), "inner.bin");
            assert_eq!(read("inner.bin", 100).unwrap(), b"inside", "a link within the folder");
            refused.extend(["link.bin", "out/secret.bin", "zero.bin"]);
            let pipe = folder.join("pipe.bin");
            let _ = std::fs::remove_file(&pipe);
            if std::process::Command::new("mkfifo").arg(&pipe).status().is_ok_and(|s| s.success()) {
                refused.push("pipe.bin");
            }
        }
        for uri in refused {
            let reason = read(uri, 100).expect_err(uri);
            assert!(!reason.contains("secret"), "{uri}: {reason}");
        }
    }
}
