//! Plots as SVG, drawn by plotters. Each is a fragment of a page: sized for a phone's width, with its
//! colours from the page's style sheet, so that light and dark schemes are both readable.

mod bars;
mod curves;
mod frames;
mod scale;

pub use self::{
    bars::{Bar, BarGroup, Stack, bars, stacks},
    curves::{Curve, Curves, Mark, curves},
    frames::{frame_curve, histogram},
    scale::{Scale, figure},
};

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

/// Width of a plot in pixels: a narrow phone without its margins.
pub const WIDTH: u32 = 344;
/// Number of distinct series colours; further series repeat them.
pub const SERIES: usize = 10;

/// Style sheet that the page needs to show plots: sizes, and the colours of both schemes.
pub const STYLE: &str = "\
:root{--ink:#222;--grid:#0001;--axis:#888;\
--s0:#1f6fb4;--s1:#c75000;--s2:#2a8a3a;--s3:#b5308f;--s4:#8a6d00;--s5:#0a8a90;--s6:#7350c0;--s7:#c02b3a;--s8:#5f6b76;--s9:#5a8a00}\
@media(prefers-color-scheme:dark){:root{--ink:#ddd;--grid:#fff2;--axis:#999;\
--s0:#6cb2f0;--s1:#ff9a4d;--s2:#6ccf7d;--s3:#f08ad0;--s4:#e0c040;--s5:#4fd0d5;--s6:#b79cf5;--s7:#ff8088;--s8:#b0bac4;--s9:#b0dc50}}\
svg{display:block;max-width:100%;height:auto}svg text{font:11px system-ui,sans-serif}\
";

// Placeholders for the variables of `STYLE` while plotters draws, because it supports only fixed
// colours.
const INK: RGBColor = RGBColor(0, 0, 1);
const GRID: RGBColor = RGBColor(0, 0, 2);
const AXIS: RGBColor = RGBColor(0, 0, 3);

fn series(index: usize) -> RGBColor {
    RGBColor(0, 1, (index % SERIES) as u8)
}

/// The name of a series' colour in the style sheet.
pub fn colour(index: usize) -> String {
    format!("var(--s{})", index % SERIES)
}

/// A surface that becomes an SVG.
type Root<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Writes a label that starts, ends or is centred at a point; its vertical middle is at the point.
fn write(root: &Root<'_>, text: &str, at: (i32, i32), anchor: HPos) -> Drawn {
    let style = ("sans-serif", FONT).into_font().color(&INK);
    let style = style.pos(Pos::new(anchor, VPos::Center));
    root.draw(&Text::new(text.to_owned(), at, style))
}

/// Replaces the fixed colours by the page's, and removes what the style sheet sets.
fn finished(svg: &str, label: &str) -> String {
    let mut text = svg
        .replace(" opacity=\"1\"", "")
        .replace(" font-family=\"sans-serif\"", "")
        .replace(" stroke=\"none\"", "")
        .replace(" xmlns=\"http://www.w3.org/2000/svg\"", "")
        .replace("#000001", "var(--ink)")
        .replace("#000002", "var(--grid)")
        .replace("#000003", "var(--axis)");
    for index in 0..SERIES {
        text = text.replace(&format!("#0001{index:02X}"), &colour(index));
    }
    let size = format!(" font-size=\"{}\"", f64::from(FONT) / 1.24);
    text = text.replace(&size, "");
    let role = format!("<svg role=\"img\" aria-label=\"{}\"", escaped(label));
    text.replacen("<svg", &role, 1).replace('\n', "")
}

/// Size of the labels for plotters' layout; `STYLE` has the real one.
const FONT: i32 = 11;

/// Text escaped for HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// The start of a name that is longer than `most`.
fn cut(name: &str, most: usize) -> String {
    if name.chars().count() <= most {
        return name.to_owned();
    }
    let start: String = name.chars().take(most - 1).collect();
    format!("{}…", start.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_cut_and_short_ones_kept() {
        assert_eq!(cut("layout1", 7), "layout1");
        assert_eq!(cut("ünïcödé", 4), "ünï…");
    }

    #[test]
    fn no_fixed_colour_is_left() {
        let group = BarGroup {
            name: "a <b>".to_owned(),
            bars: (0..SERIES)
                .map(|series| Bar {
                    series,
                    value: 10.0 + series as f64,
                    half_width: Some(1.0),
                })
                .collect(),
        };
        let text = bars("a \"chart\"", &[group]);
        assert!(!text.contains('#'), "{text}");
        assert!(
            text.contains("aria-label=\"a &quot;chart&quot;\""),
            "{text}"
        );
        assert!(text.contains("a &lt;b&gt;"), "{text}");
        assert!(text.contains("var(--s9)") && text.contains("var(--ink)"));
        assert!(!text.contains("font-size"), "{text}");
    }
}
