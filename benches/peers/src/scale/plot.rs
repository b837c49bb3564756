//! Curves over two logarithmic axes, as SVG.

use std::fmt::{self, Write};

/// A curve and its name.
pub(super) struct Curve {
    pub(super) name: String,
    /// Both above zero.
    pub(super) points: Vec<(f64, f64)>,
}

/// Width and height of the picture, and of its margins: left, right, top, bottom.
const SIZE: (f64, f64) = (760.0, 440.0);
const MARGINS: (f64, f64, f64, f64) = (70.0, 140.0, 40.0, 50.0);
/// Colours that are told apart without seeing red or green (Okabe and Ito).
const COLOURS: [&str; 7] = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];
/// The least distance of two names [px].
const APART: f64 = 15.0;

/// A logarithmic axis: from a range of numbers to one of the picture.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn at(&self, value: f64) -> f64 {
        let share = (value.log10() - self.low.log10()) / (self.high.log10() - self.low.log10());
        self.from + (self.to - self.from) * share
    }

    /// Powers of ten, and with few of them twice and five times these.
    fn ticks(&self) -> Vec<f64> {
        let powers = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let wide = self.high / self.low > 500.0;
        let parts: &[f64] = if wide { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = powers.flat_map(|power| parts.iter().map(move |part| part * 10f64.powi(power)));
        all.filter(|tick| (self.low * 0.999..=self.high * 1.001).contains(tick)).collect()
    }
}

/// The picture; nothing in it if there are no points.
pub(super) fn page(title: &str, axes: (&str, &str), curves: &[Curve]) -> Result<String, fmt::Error> {
    let (left, right, top, bottom) = MARGINS;
    let (width, height) = SIZE;
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>"
    )?;
    let all: Vec<(f64, f64)> = curves.iter().flat_map(|curve| curve.points.iter().copied()).collect();
    let range = |of: fn(&(f64, f64)) -> f64| {
        let values = all.iter().map(of).filter(|value| *value > 0.0);
        values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)))
    };
    let (xs, ys) = (range(|point| point.0), range(|point| point.1));
    if xs.0.is_finite() && ys.0.is_finite() {
        let x = Axis { low: xs.0, high: xs.1.max(xs.0 * 1.01), from: left, to: width - right };
        let y = Axis { low: ys.0 * 0.8, high: ys.1 * 1.25, from: height - bottom, to: top };
        grid(&mut svg, &x, &y)?;
        draw(&mut svg, &x, &y, curves)?;
    }
    let middle = 0.5 * (left + width - right);
    text(&mut svg, (left, top - 16.0), "start", title)?;
    text(&mut svg, (middle, height - 12.0), "middle", axes.0)?;
    let half = 0.5 * height;
    let upright = format!("transform=\"rotate(-90 18 {half})\"");
    writeln!(svg, "<text x=\"18\" y=\"{half}\" text-anchor=\"middle\" {upright}>{}</text>", axes.1)?;
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn text(svg: &mut String, at: (f64, f64), anchor: &str, what: &str) -> fmt::Result {
    writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{what}</text>", at.0, at.1)
}

fn grid(svg: &mut String, x: &Axis, y: &Axis) -> fmt::Result {
    let mut line = |(x1, y1): (f64, f64), (x2, y2): (f64, f64)| {
        writeln!(svg, "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"#ddd\"/>")
    };
    for tick in x.ticks() {
        line((x.at(tick), y.from), (x.at(tick), y.to))?;
    }
    for tick in y.ticks() {
        line((x.from, y.at(tick)), (x.to, y.at(tick)))?;
    }
    for tick in x.ticks() {
        text(svg, (x.at(tick), y.from + 18.0), "middle", &short(tick))?;
    }
    for tick in y.ticks() {
        text(svg, (x.from - 6.0, y.at(tick) + 4.0), "end", &short(tick))?;
    }
    Ok(())
}

fn draw(svg: &mut String, x: &Axis, y: &Axis, curves: &[Curve]) -> fmt::Result {
    let mut names: Vec<(f64, &str, &str)> = Vec::new();
    for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
        let points: Vec<(f64, f64)> =
            curve.points.iter().filter(|p| p.1 > 0.0).map(|p| (x.at(p.0), y.at(p.1))).collect();
        let path: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p.0, p.1)).collect();
        let path = path.join(" ");
        writeln!(svg, "<polyline points=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>")?;
        for (px, py) in &points {
            writeln!(svg, "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3\" fill=\"{colour}\"/>")?;
        }
        if let Some(last) = points.last() {
            names.push((last.1, &curve.name, colour));
        }
    }
    // Names stand at the ends of their curves, pushed apart.
    names.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = f64::NEG_INFINITY;
    for (at, name, colour) in names {
        let at = at.max(free);
        free = at + APART;
        let (px, py) = (x.to + 10.0, at + 4.0);
        writeln!(svg, "<text x=\"{px:.1}\" y=\"{py:.1}\" fill=\"{colour}\">{name}</text>")?;
    }
    Ok(())
}

fn short(value: f64) -> String {
    match value {
        v if v >= 1e6 => format!("{}M", v / 1e6),
        v if v >= 1e3 => format!("{}k", v / 1e3),
        v if v >= 1.0 => format!("{v:.0}"),
        v => format!("{v:.4}").trim_end_matches('0').to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_its_curves_and_their_names() {
        let curve = |name: &str, y: f64| Curve {
            name: name.into(),
            points: vec![(1e3, y), (1e4, 2.0 * y), (1e5, 3.0 * y)],
        };
        let svg = page("title", ("bodies", "cost"), &[curve("one", 1.0), curve("two", 1.01)]).unwrap();
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert!(svg.contains(">one</text>") && svg.contains(">two</text>") && svg.contains(">100k</text>"));
        assert!(page("nothing", ("x", "y"), &[]).unwrap().ends_with("</svg>\n"));
    }
}
