//! A picture with depth: flat triangles, lines, discs.
//!
//! A software rasteriser, because it is small and independent of the machine: pictures are the same with and
//! without a display or a graphics driver.

use backstop::glam::Vec3;

/// Red, green and blue, 0..=1, as screens have them.
pub(crate) type Rgb = [f32; 3];

/// A point on the picture: pixels right and down, and one over its distance from the eye's plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) nearness: f32,
}

/// How lines and discs are drawn where they are hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Behind {
    Hidden,
    Faint,
}

/// Pixels and their depth. Drawn with `scale` times as many pixels each way as the picture has in the end.
#[derive(Debug)]
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    scale: usize,
    colour: Vec<u32>,
    nearness: Vec<f32>,
}

/// Factor by which lines are drawn nearer, so that edges of a solid are not hidden by it.
const LIFT: f32 = 1.002;

impl Canvas {
    pub(crate) fn new(width: usize, height: usize, scale: usize) -> Canvas {
        let (width, height, scale) = (width.max(1), height.max(1), scale.max(1));
        let pixels = width * height * scale * scale;
        Canvas { width, height, scale, colour: vec![0; pixels], nearness: vec![0.0; pixels] }
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Pixels drawn across and down, and how many of them make one of the picture.
    pub(crate) fn drawn(&self) -> (usize, usize, f32) {
        (self.width * self.scale, self.height * self.scale, self.scale as f32)
    }

    /// One over the depth of the solid that is seen at a pixel, of a picture without a scale; zero for the
    /// sky.
    #[cfg(test)]
    pub(crate) fn nearness_at(&self, column: usize, row: usize) -> f32 {
        self.nearness[row * self.width + column]
    }

    /// A sky from one colour at the top to another at the bottom.
    pub(crate) fn clear(&mut self, top: Rgb, bottom: Rgb) {
        self.nearness.fill(0.0);
        let (width, height, _) = self.drawn();
        for (y, row) in self.colour.chunks_mut(width).enumerate() {
            let share = y as f32 / height as f32;
            row.fill(pack([0, 1, 2].map(|c| top[c] + (bottom[c] - top[c]) * share)));
        }
    }

    /// A triangle of one colour. Corners may lie far outside of the picture.
    pub(crate) fn triangle(&mut self, corners: [Spot; 3], colour: Rgb) {
        let (width, height, _) = self.drawn();
        let [a, b, c] = corners.map(|s| [f64::from(s.x), f64::from(s.y), f64::from(s.nearness)]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if !area.is_normal() {
            return;
        }
        // Nearness is linear on the picture.
        let (ab, ac) = (b[2] - a[2], c[2] - a[2]);
        let along_x = (ab * (c[1] - a[1]) - ac * (b[1] - a[1])) / area;
        let along_y = (ac * (b[0] - a[0]) - ab * (c[0] - a[0])) / area;
        let low = a[1].min(b[1]).min(c[1]);
        let high = a[1].max(b[1]).max(c[1]);
        let colour = pack(colour);
        // Pixels whose centre is inside.
        for row in pixels(low, high, height) {
            let y = row as f64 + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if (p[1] <= y) != (q[1] <= y) {
                    let x = p[0] + (q[0] - p[0]) * ((y - p[1]) / (q[1] - p[1]));
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let columns = pixels(left, right, width);
            let start = row * width;
            let mut nearness = a[2] + along_x * (columns.start as f64 + 0.5 - a[0]) + along_y * (y - a[1]);
            for i in start + columns.start..start + columns.end {
                if nearness as f32 > self.nearness[i] {
                    self.nearness[i] = nearness as f32;
                    self.colour[i] = colour;
                }
                nearness += along_x;
            }
        }
    }

    /// A line, `thick` pixels of the picture wide.
    pub(crate) fn line(&mut self, from: Spot, to: Spot, thick: f32, colour: Rgb, behind: Behind) {
        let (width, height, scale) = self.drawn();
        let Some((from, to)) = within(from, to, width as f32, height as f32) else { return };
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let steps = dx.abs().max(dy.abs()).ceil().max(1.0);
        let wide = ((thick * scale).round() as i32).max(1);
        for i in 0..=steps as usize {
            let share = i as f32 / steps;
            let (x, y) = ((from.x + dx * share).floor() as i32, (from.y + dy * share).floor() as i32);
            let nearness = (from.nearness + (to.nearness - from.nearness) * share) * LIFT;
            for k in -(wide / 2)..wide - wide / 2 {
                // Wide across the direction in which the line runs more.
                let (x, y) = if dx.abs() > dy.abs() { (x, y + k) } else { (x + k, y) };
                self.dot(x, y, nearness, colour, behind);
            }
        }
    }

    /// A disc with a dark rim, so many pixels of the picture in radius.
    pub(crate) fn disc(&mut self, at: Spot, radius: f32, colour: Rgb, behind: Behind) {
        let scale = self.scale as f32;
        let (reach, inner) = ((radius + 1.0) * scale, radius * scale);
        let (width, height, _) = self.drawn();
        let rows = pixels(f64::from(at.y - reach), f64::from(at.y + reach), height);
        for y in rows {
            for x in pixels(f64::from(at.x - reach), f64::from(at.x + reach), width) {
                let away = (x as f32 + 0.5 - at.x).hypot(y as f32 + 0.5 - at.y);
                if away <= reach {
                    let colour = if away <= inner { colour } else { colour.map(|c| c * 0.25) };
                    self.dot(x as i32, y as i32, at.nearness * LIFT, colour, behind);
                }
            }
        }
    }

    /// A pixel, which leaves depth as it is: lines don't hide each other.
    fn dot(&mut self, x: i32, y: i32, nearness: f32, colour: Rgb, behind: Behind) {
        let (width, height, _) = self.drawn();
        if x < 0 || y < 0 || x as usize >= width || y as usize >= height {
            return;
        }
        let i = y as usize * width + x as usize;
        if nearness >= self.nearness[i] {
            self.colour[i] = pack(colour);
        } else if behind == Behind::Faint {
            let under = unpack(self.colour[i]);
            self.colour[i] = pack([0, 1, 2].map(|c| under[c] + (colour[c] - under[c]) * 0.4));
        }
    }

    /// The picture, row by row from the top, each pixel as 0x00RRGGBB.
    pub(crate) fn picture(&self) -> Vec<u32> {
        if self.scale == 1 {
            return self.colour.clone();
        }
        let (wide, _, _) = self.drawn();
        let share = 1.0 / (self.scale * self.scale) as f32;
        let mut out = Vec::with_capacity(self.width * self.height);
        for (row, column) in (0..self.height).flat_map(|row| (0..self.width).map(move |c| (row, c))) {
            let mut sum = [0.0; 3];
            for y in row * self.scale..(row + 1) * self.scale {
                let first = y * wide + column * self.scale;
                for &pixel in &self.colour[first..first + self.scale] {
                    sum.iter_mut().zip(unpack(pixel)).for_each(|(sum, c)| *sum += c);
                }
            }
            out.push(pack(sum.map(|c| c * share)));
        }
        out
    }
}

/// Indices of the pixels whose centres are between two places, of so many.
fn pixels(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    let clamp = |v: f64| (v - 0.5).ceil().clamp(0.0, count as f64) as usize;
    if low < high { clamp(low)..clamp(high) } else { 0..0 }
}

/// The part of a line that is on the picture (Liang and Barsky, 1984).
fn within(from: Spot, to: Spot, width: f32, height: f32) -> Option<(Spot, Spot)> {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let (mut start, mut end) = (0.0f32, 1.0f32);
    for (step, room) in [(-dx, from.x), (dx, width - from.x), (-dy, from.y), (dy, height - from.y)] {
        let at = room / step;
        if step == 0.0 && room < 0.0 {
            return None;
        } else if step < 0.0 {
            start = start.max(at);
        } else if step > 0.0 {
            end = end.min(at);
        }
    }
    let at = |t: f32| Spot {
        x: from.x + dx * t,
        y: from.y + dy * t,
        nearness: from.nearness + (to.nearness - from.nearness) * t,
    };
    (start <= end).then(|| (at(start), at(end)))
}

fn pack(colour: Rgb) -> u32 {
    let [r, g, b] = colour.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u32);
    r << 16 | g << 8 | b
}

pub(crate) fn unpack(pixel: u32) -> Rgb {
    [pixel >> 16, pixel >> 8, pixel].map(|c| (c & 255) as f32 / 255.0)
}

/// A shaded colour: faces that look up and a little to one side are brightest.
pub(crate) fn lit(colour: Rgb, normal: Vec3) -> Rgb {
    const LIGHT: Vec3 = Vec3::new(0.40, 0.82, 0.41);
    let light = 0.42 + 0.58 * (0.5 + 0.5 * normal.dot(LIGHT));
    colour.map(|c| c * light)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(x: f32, y: f32, nearness: f32) -> Spot {
        Spot { x, y, nearness }
    }

    fn count(canvas: &Canvas, colour: Rgb) -> usize {
        canvas.picture().iter().filter(|p| **p == pack(colour)).count()
    }

    const RED: Rgb = [1.0, 0.0, 0.0];
    const BLUE: Rgb = [0.0, 0.0, 1.0];

    #[test]
    fn two_triangles_of_a_square_fill_it_once_and_the_nearer_one_wins() {
        let mut canvas = Canvas::new(40, 30, 1);
        let corners =
            [spot(5.0, 5.0, 0.5), spot(25.0, 5.0, 0.5), spot(25.0, 15.0, 0.5), spot(5.0, 15.0, 0.5)];
        canvas.triangle([corners[0], corners[1], corners[2]], RED);
        canvas.triangle([corners[0], corners[2], corners[3]], RED);
        assert_eq!(count(&canvas, RED), 20 * 10);
        // Behind at the left, in front at the right.
        canvas.triangle([spot(0.0, 0.0, 0.0), spot(30.0, 0.0, 1.0), spot(30.0, 30.0, 1.0)], BLUE);
        let picture = canvas.picture();
        assert_eq!((picture[10 * 40 + 12], picture[10 * 40 + 20]), (pack(RED), pack(BLUE)));
    }

    #[test]
    fn what_reaches_far_out_of_the_picture_is_cut() {
        let mut canvas = Canvas::new(20, 10, 2);
        canvas.triangle([spot(-1e7, -1e7, 1.0), spot(3e7, -1e7, 1.0), spot(-1e7, 3e7, 1.0)], RED);
        assert_eq!(count(&canvas, RED), 200);
        canvas.line(spot(-1e5, 11.0, 1.0), spot(1e5, 11.0, 1.0), 1.0, BLUE, Behind::Hidden);
        assert_eq!(count(&canvas, BLUE), 20);
        canvas.disc(spot(-500.0, 3.0, 1.0), 4.0, BLUE, Behind::Faint);
        canvas.triangle([spot(f32::NAN, 0.0, 1.0); 3], BLUE);
        assert_eq!(count(&canvas, BLUE), 20);
    }

    #[test]
    fn a_line_behind_something_is_hidden_or_faint() {
        for (behind, expected) in [(Behind::Hidden, RED), (Behind::Faint, [0.6, 0.0, 0.4])] {
            let mut canvas = Canvas::new(20, 20, 1);
            canvas.triangle([spot(-50.0, -50.0, 1.0), spot(99.0, -50.0, 1.0), spot(-50.0, 99.0, 1.0)], RED);
            canvas.line(spot(0.5, 10.5, 0.5), spot(19.0, 10.5, 0.5), 1.0, BLUE, behind);
            assert_eq!(canvas.picture()[10 * 20 + 9], pack(expected));
        }
    }
}
