//! The sources' published curves next to our rows.

use super::{
    super::model::Row,
    growth::number,
    html,
    names::{card, distinct},
    published::{COMPARISONS, Comparison, FIGURES, Unit},
};
use crate::measure::plot::{self, Curve, Curves, Mark, Scale, figure};

/// The axis of layouts, numbered 1 to 4.
const LAYOUT: &str = "layout";

/// Empty where nothing is published next to any of our rows.
pub fn beside(rows: &[&Row]) -> String {
    let all: String = COMPARISONS
        .iter()
        .map(|comparison| compared(comparison, rows))
        .collect();
    if all.is_empty() {
        return all;
    }
    let figures: Vec<Vec<String>> = FIGURES
        .iter()
        .map(|line| line.map(str::to_owned).to_vec())
        .collect();
    format!(
        "<h2>Beside what the sources published</h2>\n{}{}<details><summary>Further figures of the sources</summary>\n{}\
         </details>\n",
        html::paragraph(
            "Their cards, scenes and programs differ from ours: compare the shapes of the curves, not their heights. \
             Hollow circles are theirs."
        ),
        html::plots(&all),
        html::table(&["table", "what", "values"], &figures)
    )
}

fn compared(comparison: &Comparison, rows: &[&Row]) -> String {
    let mut ours: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| row.suite == comparison.suite && row.world == comparison.world)
        .filter(|row| row.fps.is_some() && place(comparison, row).is_some())
        .collect();
    let wanted = ours
        .iter()
        .find(|row| row.condition == comparison.condition);
    let Some(condition) = wanted.or(ours.first()).map(|row| row.condition.clone()) else {
        return String::new();
    };
    ours.retain(|row| row.condition == condition);
    let value = |row: &Row| {
        let fps = row.fps.unwrap_or(f64::NAN);
        match comparison.unit {
            Unit::Fps => fps,
            Unit::Ms => 1e3 / fps,
        }
    };
    let mut curves = Vec::new();
    let mut key = Vec::new();
    for name in distinct(ours.iter().map(|row| card(row))) {
        let of_card = ours.iter().filter(|row| card(row) == name);
        let point = |row: &&Row| Some((place(comparison, row)?, value(row), None));
        let mut points: Vec<(f64, f64, Option<f64>)> = of_card.filter_map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        key.push((key.len(), format!("ours, {condition}: {name}")));
        curves.push(Curve {
            series: curves.len(),
            points,
            mark: Mark::Line,
        });
    }
    for published in comparison.published {
        key.push((key.len(), published.source.to_owned()));
        curves.push(Curve {
            series: curves.len(),
            points: published
                .points
                .iter()
                .map(|(x, y)| (*x, *y, None))
                .collect(),
            mark: Mark::Hollow,
        });
    }
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let xs: Vec<f64> = points().map(|point| point.0).collect();
    let unit = match comparison.unit {
        Unit::Fps => "FPS",
        Unit::Ms => "ms",
    };
    let svg = plot::curves(&Curves {
        label: comparison.title,
        x: match comparison.x_name {
            LAYOUT => Scale::linear(0.7, 4.3, 4),
            _ => Scale::at_values(&xs),
        },
        y: Scale::spanning(points().map(|point| point.1), 6),
        x_name: comparison.x_name,
        y_name: unit,
        notes: Vec::new(),
        curves: curves.clone(),
    });
    let lines: Vec<Vec<String>> = curves
        .iter()
        .zip(&key)
        .flat_map(|(curve, (_, name))| {
            curve
                .points
                .iter()
                .map(|(x, y, _)| vec![name.clone(), figure(*x), figure(*y)])
        })
        .collect();
    let numbers = html::table(&["", comparison.x_name, unit], &lines);
    let numbers = format!("<details><summary>Numbers</summary>{numbers}</details>\n");
    let drawn = html::plot(comparison.title, &svg, &key, &[]);
    drawn.replace("</figure>\n", &format!("{numbers}</figure>\n"))
}

/// The position of a row on the axis: the number of its layout, or the value that its suite varies.
fn place(comparison: &Comparison, row: &Row) -> Option<f64> {
    if comparison.x_name == LAYOUT {
        let name = row.layout.as_deref()?;
        let digits = name.trim_start_matches(|c: char| !c.is_ascii_digit());
        return digits.parse().ok();
    }
    row.varied.keys().find_map(|key| number(row, key))
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn published_curves_stand_beside_ours() {
        let report = made_up::report();
        let rows: Vec<&Row> = report.rows.iter().collect();
        let text = beside(&rows);
        for part in [
            "Cave: frames per second by layout",
            "ours, moving: Card 9000",
            "Fibix, Table 4.6",
            "<td>140</td>",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(!text.contains("Cornell box"), "not measured");
        assert_eq!(beside(&rows[11..]), "");
    }
}
