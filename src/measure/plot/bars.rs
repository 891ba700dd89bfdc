//! Horizontal bars: values next to each other, or the parts of a whole.

use plotters::{prelude::*, style::text_anchor::HPos};

use super::{
    AXIS, Drawn, GRID, INK, Root, WIDTH, cut, finished,
    scale::{Scale, figure},
    series, write,
};

/// One value.
#[derive(Clone, Debug)]
pub struct Bar {
    /// Index of its colour.
    pub series: usize,
    pub value: f64,
    /// Half width of its interval.
    pub half_width: Option<f64>,
}

/// Bars under one name.
#[derive(Clone, Debug)]
pub struct BarGroup {
    pub name: String,
    pub bars: Vec<Bar>,
}

/// A whole made of parts: the colour and size of each.
#[derive(Clone, Debug)]
pub struct Stack {
    pub name: String,
    pub parts: Vec<(usize, f64)>,
}

/// Heights in pixels.
const BAR: i32 = 15;
const GAP: i32 = 9;
const BOTTOM: i32 = 18;
/// Most letters of a name.
const MOST_NAME: usize = 19;
/// Room for the values behind the bars, in pixels.
const VALUE: i32 = 40;

/// Groups below each other, each bar with its interval and, behind it, its value. Where the values
/// spread widely the axis is logarithmic, and dots replace the bars, whose length would mean nothing.
pub fn bars(label: &str, groups: &[BarGroup]) -> String {
    let values = groups
        .iter()
        .flat_map(|group| &group.bars)
        .map(|bar| bar.value);
    let scale = Scale::spanning(values, 4);
    let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).collect();
    let heights: Vec<i32> = groups
        .iter()
        .map(|group| BAR * group.bars.len() as i32 + GAP)
        .collect();
    draw(label, &names, &heights, &scale, |plot| {
        for (group, top) in groups.iter().zip(&plot.tops) {
            for (index, bar) in group.bars.iter().enumerate() {
                let top = top + GAP / 2 + BAR * index as i32;
                let middle = top + BAR / 2;
                let end = plot.x(bar.value);
                let colour = series(bar.series);
                if scale.is_log() {
                    plot.root
                        .draw(&Circle::new((end, middle), 4, colour.filled()))?;
                } else {
                    let corners = [(plot.left, top + 2), (end, top + BAR - 2)];
                    plot.root.draw(&Rectangle::new(corners, colour.filled()))?;
                }
                let mut behind = end + 5;
                if let Some(half) = bar.half_width.filter(|half| half.is_finite()) {
                    let (from, to) = (plot.x(bar.value - half), plot.x(bar.value + half));
                    behind = to.max(behind - 5) + 5;
                    let line = vec![(from, middle), (to, middle)];
                    plot.root
                        .draw(&PathElement::new(line, INK.stroke_width(1)))?;
                    for x in [from, to] {
                        let cap = vec![(x, middle - 3), (x, middle + 3)];
                        plot.root
                            .draw(&PathElement::new(cap, INK.stroke_width(1)))?;
                    }
                }
                write(plot.root, &figure(bar.value), (behind, middle), HPos::Left)?;
            }
        }
        Ok(())
    })
}

/// Wholes below each other, each divided into its parts, with the sum behind it.
pub fn stacks(label: &str, stacks: &[Stack]) -> String {
    let sum = |stack: &Stack| stack.parts.iter().map(|(_, value)| value).sum::<f64>();
    let scale = Scale::from_zero(stacks.iter().map(sum), 4);
    let names: Vec<&str> = stacks.iter().map(|stack| stack.name.as_str()).collect();
    let heights = vec![BAR + 5; stacks.len()];
    draw(label, &names, &heights, &scale, |plot| {
        for (stack, top) in stacks.iter().zip(&plot.tops) {
            let mut so_far = 0.0;
            for (colour, value) in &stack.parts {
                let from = plot.x(so_far);
                so_far += value;
                let corners = [(from, top + 3), (plot.x(so_far), top + BAR + 1)];
                plot.root
                    .draw(&Rectangle::new(corners, series(*colour).filled()))?;
            }
            let behind = (plot.x(so_far) + 5, top + 2 + BAR / 2);
            write(plot.root, &figure(so_far), behind, HPos::Left)?;
        }
        Ok(())
    })
}

/// The drawing area of one plot's bars.
struct Plot<'a, 'b> {
    root: &'a Root<'b>,
    scale: &'a Scale,
    left: i32,
    right: i32,
    /// Top of each group.
    tops: Vec<i32>,
}

impl Plot<'_, '_> {
    fn x(&self, value: f64) -> i32 {
        self.left + (self.scale.at(value) * f64::from(self.right - self.left)).round() as i32
    }
}

/// Width of a name in pixels, in fonts that are wider than most.
fn wide(name: &str) -> f64 {
    let letter = |letter: char| match letter {
        'm' | 'w' | 'M' | 'W' | '×' | '@' => 10.5,
        'i' | 'l' | 'j' | 'f' | 't' | '.' | ' ' => 4.5,
        _ => 6.9,
    };
    name.chars().map(letter).sum()
}

/// Draws names at the left, ticks at the bottom, and `content`.
fn draw(
    label: &str,
    names: &[&str],
    heights: &[i32],
    scale: &Scale,
    content: impl FnOnce(&Plot<'_, '_>) -> Drawn,
) -> String {
    let mut svg = String::new();
    let bottom: i32 = heights.iter().sum();
    let widest = names.iter().map(|name| wide(&cut(name, MOST_NAME)));
    let left = widest.fold(0.0, f64::max) as i32 + 10;
    let drawn = || -> Drawn {
        let size = (WIDTH, (bottom + BOTTOM) as u32);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let mut tops = Vec::new();
        let mut top = 0;
        for height in heights {
            tops.push(top);
            top += height;
        }
        let plot = Plot {
            root: &root,
            scale,
            left,
            right: WIDTH as i32 - VALUE,
            tops,
        };
        for (value, text) in &scale.ticks {
            let x = plot.x(*value);
            let line = vec![(x, 0), (x, bottom)];
            root.draw(&PathElement::new(line, GRID.stroke_width(1)))?;
            write(plot.root, text, (x, bottom + BOTTOM / 2), HPos::Center)?;
        }
        content(&plot)?;
        let axis = vec![(left, 0), (left, bottom)];
        root.draw(&PathElement::new(axis, AXIS.stroke_width(1)))?;
        for ((name, top), height) in names.iter().zip(&plot.tops).zip(heights) {
            write(
                plot.root,
                &cut(name, MOST_NAME),
                (left - 6, top + height / 2),
                HPos::Right,
            )?;
        }
        root.present()
    };
    drawn().expect("drawing into a string cannot fail");
    finished(&svg, label)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(name: &str, values: &[f64]) -> BarGroup {
        let bar = |(series, &value): (usize, &f64)| Bar {
            series,
            value,
            half_width: Some(0.05 * value),
        };
        BarGroup {
            name: name.to_owned(),
            bars: values.iter().enumerate().map(bar).collect(),
        }
    }

    /// The x and width of each bar, in order.
    fn widths(svg: &str) -> Vec<i32> {
        let number = |piece: &str, key: &str| -> i32 {
            let (_, rest) = piece.split_once(&format!(" {key}=\"")).expect(key);
            let (text, _) = rest.split_once('"').expect("a quote");
            text.parse().expect("a number")
        };
        svg.split("<rect")
            .skip(1)
            .map(|piece| number(piece, "width"))
            .collect()
    }

    #[test]
    fn bars_are_as_long_as_their_values() {
        let svg = bars("chart", &[group("a", &[100.0, 50.0]), group("b", &[25.0])]);
        let [a, b, c] = widths(&svg)[..] else {
            panic!("three bars: {svg}");
        };
        assert!(
            (a - 2 * b).abs() <= 1 && (a - 4 * c).abs() <= 2,
            "{a} {b} {c}"
        );
        assert!(svg.contains("100") && svg.contains("25"));
    }

    #[test]
    fn widely_spread_values_are_dots() {
        let svg = bars("chart", &[group("a", &[1000.0]), group("b", &[1.0])]);
        assert!(widths(&svg).is_empty());
        assert_eq!(svg.matches("<circle").count(), 2);
    }

    #[test]
    fn parts_add_up() {
        let stack = |parts: &[f64]| Stack {
            name: "row".to_owned(),
            parts: parts.iter().copied().enumerate().collect(),
        };
        let svg = stacks("chart", &[stack(&[1.0, 2.0, 1.0]), stack(&[4.0])]);
        let found = widths(&svg);
        assert_eq!(found.len(), 4);
        assert!(
            (found[..3].iter().sum::<i32>() - found[3]).abs() <= 1,
            "{found:?}"
        );
    }

    #[test]
    fn empty_and_invalid_values_can_be_drawn() {
        assert!(bars("none", &[]).starts_with("<svg"));
        let odd = group("odd", &[f64::NAN, -1.0, 0.0, f64::INFINITY]);
        assert!(bars("odd", &[odd]).contains("odd"));
    }
}
