//! How frame times and figures grow with the value that a suite varies.

use super::{
    super::model::{Figure, Row, Varied},
    html::plot,
    names::{distinct, names_with_keys, short},
};
use crate::measure::{
    plot::{self, Curve, Curves, Mark, Scale},
    scaling::PowerLaw,
};

/// Fewest different numbers that make a curve.
const FEWEST: usize = 3;

/// The numbers that these rows vary, each by its key: those with at least three values.
pub fn varied_numbers(rows: &[&Row]) -> Vec<String> {
    let keys = distinct(rows.iter().flat_map(|row| row.varied.keys()));
    let wide =
        |key: &&String| distinct(rows.iter().filter_map(|row| number(row, key))).len() >= FEWEST;
    keys.into_iter().filter(wide).cloned().collect()
}

/// The value that a row varies, as a number: for a size, its pixels.
pub fn number(row: &Row, key: &str) -> Option<f64> {
    match row.varied.get(key)? {
        Varied::Number(number) => Some(*number),
        Varied::Text(text) => {
            let (width, height) = text.split_once(['x', '×'])?;
            let edge = |text: &str| text.trim().parse::<u32>().ok();
            Some(f64::from(edge(width)?) * f64::from(edge(height)?))
        }
    }
}

/// A quantity of rows that may grow: its name, and its value in a row.
type Quantity = (String, Box<dyn Fn(&Row) -> Option<Figure>>);

fn quantities(rows: &[&Row]) -> Vec<Quantity> {
    let mut all: Vec<Quantity> = Vec::new();
    if rows.iter().any(|row| row.frame_ms.is_some()) {
        let frame = |row: &Row| {
            row.timing.as_ref()?;
            row.headline().map(|(_, figure)| figure)
        };
        all.push(("frame_ms".to_owned(), Box::new(frame)));
    }
    for name in distinct(rows.iter().flat_map(|row| row.figures.keys())) {
        let key = name.clone();
        all.push((
            name.clone(),
            Box::new(move |row| row.figures.get(&key).copied()),
        ));
    }
    all
}

/// A plot for each quantity over the number under `key`, with a curve for each set of rows that differ in
/// nothing else.
pub fn growth(title: &str, rows: &[&Row], key: &str) -> String {
    let rows: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| number(row, key).is_some())
        .collect();
    let labels = names_with_keys(&rows, &[key, "picture size"]);
    let curve_names = distinct(labels.iter());
    let is_size = rows
        .iter()
        .any(|row| matches!(row.varied.get(key), Some(Varied::Text(_))));
    let axis = if is_size { "pixels" } else { short(key) };
    let mut text = String::new();
    for (quantity, value) in quantities(&rows) {
        let points = |name: &String| {
            let members = rows.iter().zip(&labels).filter(|(_, label)| *label == name);
            let mut points: Vec<(f64, f64, Option<f64>)> = members
                .filter_map(|(row, _)| {
                    let figure = value(row)?;
                    Some((number(row, key)?, figure.value, figure.half_width))
                })
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points
        };
        let all: Vec<(&String, Vec<_>)> = curve_names
            .iter()
            .map(|name| (*name, points(name)))
            .collect();
        let all: Vec<_> = all
            .into_iter()
            .filter(|(_, points)| points.len() > 1)
            .collect();
        if all.is_empty() {
            continue;
        }
        let what = spoken(&quantity);
        let words = all.iter().filter_map(|(name, points)| {
            let plain: Vec<(f64, f64)> = points.iter().map(|(x, y, _)| (*x, *y)).collect();
            let law = PowerLaw::fit(&plain)?.in_words(&what, axis);
            Some(match all.len() {
                1 => sentence(&law),
                _ => format!("{name}: {law}."),
            })
        });
        let words: Vec<String> = words.collect();
        let flat = all.iter().flat_map(|(_, points)| points);
        let xs: Vec<f64> = flat.clone().map(|(x, ..)| *x).collect();
        let svg = plot::curves(&Curves {
            label: &format!("{title}: {what} over {key}"),
            x: Scale::at_values(&xs),
            y: Scale::spanning(flat.map(|(_, y, _)| *y), 6),
            x_name: if is_size { axis } else { key },
            y_name: &quantity,
            curves: all
                .iter()
                .enumerate()
                .map(|(series, (_, points))| Curve {
                    series,
                    points: points.clone(),
                    mark: Mark::Line,
                })
                .collect(),
            notes: Vec::new(),
        });
        let legend: Vec<(usize, String)> = all
            .iter()
            .map(|(name, _)| (*name).clone())
            .enumerate()
            .collect();
        text += &plot(
            &format!("{title}: {what} over {axis}"),
            &svg,
            &legend,
            &words,
        );
    }
    text
}

/// A quantity in words: `first_frame_ms` → `first frame`.
fn spoken(quantity: &str) -> String {
    if quantity == "frame_ms" {
        return "frame time".to_owned();
    }
    let units = ["_ms", "_s", "_bytes", "_mb"];
    let bare = units.iter().find_map(|unit| quantity.strip_suffix(unit));
    let word = bare.unwrap_or(quantity).replace('_', " ");
    if quantity.ends_with("_bytes") {
        format!("{word} bytes")
    } else {
        word
    }
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    format!("{}{}.", first.unwrap_or_default(), letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn the_exponent_is_said_in_words() {
        let report = made_up::report();
        let rows: Vec<&Row> = report
            .rows
            .iter()
            .filter(|row| row.suite == "rays")
            .collect();
        assert_eq!(varied_numbers(&rows), ["probes.rays"]);
        let text = growth("cave", &rows, "probes.rays");
        assert!(text.contains("Frame time grows as rays^0.50."), "{text}");
        assert_eq!(text.matches("<circle").count(), 3);
    }

    #[test]
    fn each_condition_and_figure_has_its_curve() {
        let mut rows = Vec::new();
        for world_size in [32.0, 64.0, 128.0] {
            for condition in ["still", "moving"] {
                let id = format!("world/cave/layout1/{condition}");
                let row = made_up::figure_row(&id, "voxelise_ms", f64::powi(world_size, 3));
                rows.push(made_up::varied(row, "world.size", world_size));
            }
        }
        let rows: Vec<&Row> = rows.iter().collect();
        let text = growth("cave", &rows, "world.size");
        assert!(
            text.contains("still: voxelise grows as world.size^3.00."),
            "{text}"
        );
        assert!(
            text.contains("moving: voxelise grows as world.size^3.00."),
            "{text}"
        );
        assert!(
            varied_numbers(&rows[..4]).is_empty(),
            "two sizes are no curve"
        );
    }

    #[test]
    fn sizes_are_pixels() {
        let mut row = made_up::row("resolution/cave/layout1/moving", 1.0);
        row.varied
            .insert("size".to_owned(), Varied::Text("640x352".to_owned()));
        assert_eq!(number(&row, "size"), Some(640.0 * 352.0));
        row.varied
            .insert("states".to_owned(), Varied::Text("on".to_owned()));
        assert_eq!(number(&row, "states"), None);
    }
}
