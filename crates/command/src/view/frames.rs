//! Pictures as files.

use super::Viewer;
use crate::files::{self, Kind};
use anyhow::Context;
use backstop::World;
use backstop_scene::{self as scene, AtomicFile};
use std::path::{Path, PathBuf};

/// Pixels drawn for each pixel of a picture, each way: edges without steps.
pub(crate) const SCALE: usize = 2;

/// Writes every so many steps a picture into a folder.
pub(crate) struct Frames {
    folder: PathBuf,
    every: u32,
    count: u32,
    viewer: Viewer,
}

impl Frames {
    /// Makes the folder if it is not there. Refuses one with pictures of these names from elsewhere.
    pub(crate) fn new(folder: PathBuf, every: u32, viewer: Viewer) -> anyhow::Result<Frames> {
        crate::report::output::make_folder(&folder)?;
        let entries = folder.read_dir().with_context(|| format!("can't read {}", folder.display()))?;
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let frames: Vec<String> = names.filter(|n| n.starts_with("frame-") && n.ends_with(".png")).collect();
        files::expect_places(&folder, frames.iter().map(String::as_str), Kind::Png)?;
        Ok(Frames { folder, every: every.max(1), count: 0, viewer })
    }

    /// After so many steps.
    pub(crate) fn take(&mut self, world: &World, step: u32) -> anyhow::Result<()> {
        if !step.is_multiple_of(self.every) {
            return Ok(());
        }
        if self.count == 0 {
            self.viewer.frame(world);
        }
        let path = self.folder.join(format!("frame-{:05}.png", self.count));
        self.count += 1;
        let picture = self.viewer.picture(world);
        let size = self.viewer.canvas.size();
        scene::write_file(&path, |file| Ok(write_png(file, &picture, size)?))
            .with_context(|| format!("can't write {}", path.display()))
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }
}

fn write_png(
    file: &mut AtomicFile,
    picture: &[u32],
    (width, height): (usize, usize),
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let (keyword, text) = files::PNG_MARK;
    encoder.add_text_chunk(keyword.into(), text.into())?;
    let bytes: Vec<u8> = picture.iter().flat_map(|p| [p >> 16, p >> 8, *p].map(|c| c as u8)).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()
}
