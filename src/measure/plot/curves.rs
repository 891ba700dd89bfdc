//! Curves over a number, on axes that fit them, and points on a plane.

use plotters::{prelude::*, style::text_anchor::HPos};

use super::{AXIS, Drawn, FONT, GRID, INK, WIDTH, finished, scale::Scale, series, write};

/// One curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Index of its colour.
    pub series: usize,
    /// x, y, and half width of the interval of y.
    pub points: Vec<(f64, f64, Option<f64>)>,
    pub mark: Mark,
}

/// How the points of a curve are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Joined, filled: measured values.
    Line,
    /// Joined, hollow: published values.
    Hollow,
    /// Not joined.
    Dots,
    /// Joined, without dots.
    Front,
}

/// The parts of a plot of curves.
#[derive(Clone, Debug)]
pub struct Curves<'a> {
    /// Text for screen readers.
    pub label: &'a str,
    pub x: Scale,
    pub y: Scale,
    pub x_name: &'a str,
    pub y_name: &'a str,
    pub curves: Vec<Curve>,
    /// Numbers next to points: x, y, text.
    pub notes: Vec<(f64, f64, String)>,
}

const HEIGHT: u32 = 250;
const LEFT: u32 = 44;

/// The plot as SVG.
pub fn curves(plot: &Curves<'_>) -> String {
    let mut svg = String::new();
    draw(&mut svg, plot).expect("drawing into a string cannot fail");
    finished(&svg, plot.label)
}

fn draw(svg: &mut String, plot: &Curves<'_>) -> Drawn {
    let root = SVGBackend::with_string(svg, (WIDTH, HEIGHT)).into_drawing_area();
    let font = || ("sans-serif", FONT).into_font().color(&INK);
    let mut chart = ChartBuilder::on(&root)
        .margin_top(24)
        .margin_right(10)
        .set_label_area_size(LabelAreaPosition::Left, LEFT)
        .set_label_area_size(LabelAreaPosition::Bottom, 42)
        .build_cartesian_2d(plot.x.clone(), plot.y.clone())?;
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(AXIS)
        .label_style(font())
        .x_label_formatter(&|value| plot.x.label(*value))
        .y_label_formatter(&|value| plot.y.label(*value))
        .draw()?;
    for curve in &plot.curves {
        let finite = curve
            .points
            .iter()
            .filter(|(x, y, _)| x.is_finite() && y.is_finite());
        let points: Vec<(f64, f64)> = finite.clone().map(|(x, y, _)| (*x, *y)).collect();
        let colour = series(curve.series);
        if curve.mark != Mark::Dots {
            let width = if curve.mark == Mark::Line { 2 } else { 1 };
            chart.draw_series(LineSeries::new(points.clone(), colour.stroke_width(width)))?;
        }
        for (x, y, half) in finite {
            if let Some(half) = half.filter(|half| half.is_finite()) {
                let ends = vec![(*x, y - half), (*x, y + half)];
                chart.draw_series([PathElement::new(ends, INK.stroke_width(1))])?;
            }
        }
        let (size, style): (u32, ShapeStyle) = match curve.mark {
            Mark::Front => continue,
            Mark::Hollow => (3, colour.stroke_width(1)),
            Mark::Dots => (4, colour.filled()),
            Mark::Line => (3, colour.filled()),
        };
        chart.draw_series(points.iter().map(|point| Circle::new(*point, size, style)))?;
    }
    let mut written: Vec<(i32, i32)> = Vec::new();
    for (x, y, note) in &plot.notes {
        let (x, y) = chart.backend_coord(&(*x, *y));
        // Notes without room are left out: the tables contain them.
        if written
            .iter()
            .all(|(a, b)| (a - x).abs() > 18 || (b - y).abs() > 12)
        {
            write(&root, note, (x + 6, y - 7), HPos::Left)?;
            written.push((x, y));
        }
    }
    let width = WIDTH as i32;
    let middle = (LEFT as i32 + width - 10) / 2;
    write(
        &root,
        plot.x_name,
        (middle, HEIGHT as i32 - 8),
        HPos::Center,
    )?;
    write(&root, plot.y_name, (2, 8), HPos::Left)?;
    root.present()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_has_its_points_notes_and_names() {
        let points = vec![
            (8.0, 1.0, Some(0.1)),
            (64.0, 3.0, None),
            (512.0, f64::NAN, None),
        ];
        let svg = curves(&Curves {
            label: "a plot",
            x: Scale::at_values(&[8.0, 64.0, 512.0]),
            y: Scale::from_zero([3.0].into_iter(), 4),
            x_name: "rays per probe",
            y_name: "ms",
            curves: vec![Curve {
                series: 0,
                points,
                mark: Mark::Line,
            }],
            notes: vec![(8.0, 1.0, "1".to_owned())],
        });
        assert_eq!(svg.matches("<circle").count(), 2, "NaN has no place: {svg}");
        for part in ["rays per probe", ">ms<", ">64<", ">512<"] {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert!(!svg.contains('#'), "{svg}");
    }
}
