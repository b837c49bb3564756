//! Figures and the scrubber, over a picture.

use embedded_graphics::Pixel;
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_7X13;
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::primitives::{Circle, PrimitiveStyle, Rectangle};
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;

const PALE: Rgb888 = Rgb888::new(225, 230, 238);
const DULL: Rgb888 = Rgb888::new(110, 118, 130);
const BRIGHT: Rgb888 = Rgb888::new(240, 160, 60);
/// Pixels from the edges.
const MARGIN: i32 = 10;
/// Pixels between lines of text.
const LINE: i32 = 16;
/// Pixels above the lower edge in which a click is on the scrubber.
const BAR: i32 = 28;

/// A picture as a target of drawing.
pub(super) struct Overlay<'a> {
    pub(super) pixels: &'a mut [u32],
    pub(super) width: usize,
    pub(super) height: usize,
}

impl OriginDimensions for Overlay<'_> {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Overlay<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let inside = self.bounding_box();
        for Pixel(at, colour) in pixels {
            if inside.contains(at) {
                self.pixels[at.y as usize * self.width + at.x as usize] = colour.into_storage();
            }
        }
        Ok(())
    }
}

impl Overlay<'_> {
    /// Lines of text in the upper left corner.
    pub(super) fn lines(&mut self, lines: &[String]) -> Result<(), Infallible> {
        let longest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
        self.darken(2 * MARGIN + 7 * longest as i32, MARGIN + LINE * lines.len() as i32);
        let style = MonoTextStyle::new(&FONT_7X13, PALE);
        for (line, row) in lines.iter().zip(0..) {
            let at = Point::new(MARGIN, MARGIN / 2 + LINE * row);
            Text::with_baseline(line, at, style, Baseline::Top).draw(self)?;
        }
        Ok(())
    }

    /// How far the run is, of what can be gone to.
    pub(super) fn scrubber(&mut self, share: f32) -> Result<(), Infallible> {
        let (width, height) = (self.width as i32, self.height as i32);
        let (long, middle) = ((width - 2 * MARGIN).max(1), height - BAR / 2);
        let reached = (share.clamp(0.0, 1.0) * long as f32) as i32;
        for (length, colour) in [(long, DULL), (reached, BRIGHT)] {
            let line = Rectangle::new(Point::new(MARGIN, middle - 1), Size::new(length as u32, 3));
            line.into_styled(PrimitiveStyle::with_fill(colour)).draw(self)?;
        }
        let knob = Circle::with_center(Point::new(MARGIN + reached, middle), 11);
        knob.into_styled(PrimitiveStyle::with_fill(BRIGHT)).draw(self)
    }

    /// What is behind text.
    fn darken(&mut self, width: i32, height: i32) {
        let (width, height) = ((width as usize).min(self.width), (height as usize).min(self.height));
        for row in self.pixels.chunks_mut(self.width).take(height) {
            row[..width].iter_mut().for_each(|pixel| *pixel = (*pixel >> 1) & 0x7f_7f_7f);
        }
    }
}

/// Whether a click at this height is on the scrubber.
pub(super) fn is_scrubber(y: f32, height: usize) -> bool {
    y >= height as f32 - BAR as f32
}

/// The share of the run that a place on the scrubber stands for.
pub(super) fn share_at(x: f32, width: usize) -> f32 {
    ((x - MARGIN as f32) / (width as f32 - 2.0 * MARGIN as f32).max(1.0)).clamp(0.0, 1.0)
}
