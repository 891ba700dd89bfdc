//! The rows as CSV, and for a terminal.

use std::fmt::Write as _;

use super::{super::dynamics::Responses, row::Row};

/// Column names and what they hold.
type Column = (&'static str, fn(&Row) -> String);

const COLUMNS: [Column; 18] = [
    ("world", |row| quoted(&row.world)),
    ("camera", |row| quoted(&row.camera)),
    ("layout", |row| quoted(&row.layout)),
    ("rays", |row| row.rays.to_string()),
    ("hysteresis", |row| row.hysteresis.to_string()),
    ("frames", |row| row.frames.to_string()),
    ("flip_mean", |row| row.full.flip.mean.to_string()),
    ("flip_p99", |row| row.full.flip.p99.to_string()),
    ("abs_sum_mean", |row| row.full.abs_sum.mean.to_string()),
    ("abs_sum_max", |row| row.full.abs_sum.max.to_string()),
    ("energy_ratio", |row| row.full.energy_ratio.to_string()),
    ("indirect_flip_mean", |row| {
        row.indirect.flip.mean.to_string()
    }),
    ("indirect_energy_ratio", |row| {
        row.indirect.energy_ratio.to_string()
    }),
    ("indirect_rel_mse", |row| row.indirect.rel_mse.to_string()),
    ("leak_ratio", |row| optional(row.leak_ratio)),
    ("stability_mean", |row| {
        optional(row.stability.map(|s| s.mean))
    }),
    ("stability_p99", |row| {
        optional(row.stability.map(|s| s.p99))
    }),
    ("stability_max", |row| {
        optional(row.stability.map(|s| s.max))
    }),
];

/// RFC 4180, with a header; empty where nothing was measured.
pub fn csv(rows: &[Row]) -> String {
    let mut names: Vec<String> = COLUMNS.iter().map(|(name, _)| (*name).to_owned()).collect();
    for name in Responses::NAMES {
        names.extend([format!("{name}_to_90"), format!("{name}_to_99")]);
    }
    let mut text = names.join(",") + "\r\n";
    for row in rows {
        let mut cells: Vec<String> = COLUMNS.iter().map(|(_, cell)| cell(row)).collect();
        for response in row.response.unwrap_or_default().all() {
            cells.push(optional(response.and_then(|r| r.to_90)));
            cells.push(optional(response.and_then(|r| r.to_99)));
        }
        text += &(cells.join(",") + "\r\n");
    }
    text
}

fn optional(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// One row in one line, as it comes.
pub fn line(row: &Row) -> String {
    format!(
        "{} · {} · {} · {} rays: FLIP {:.4}, absolute {:.4}, indirect energy {:.3}",
        row.world,
        row.camera,
        row.layout,
        row.rays,
        row.full.flip.mean,
        row.full.abs_sum.mean,
        row.indirect.energy_ratio
    )
}

/// The table for a terminal.
pub fn text(rows: &[Row]) -> String {
    let heads = HEADS.map(str::to_owned);
    let lines: Vec<[String; 12]> = std::iter::once(heads)
        .chain(rows.iter().map(cells))
        .collect();
    let mut widths = [0; 12];
    for line in &lines {
        for (width, cell) in widths.iter_mut().zip(line) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let mut text = String::new();
    for line in &lines {
        let mut padded = String::new();
        for (index, (cell, width)) in line.iter().zip(widths).enumerate() {
            // Writing to a String cannot fail. Names to the left, numbers to the right.
            let _ = match index {
                0..3 => write!(padded, "{cell:<width$}  "),
                _ => write!(padded, "{cell:>width$}  "),
            };
        }
        text += padded.trim_end();
        text.push('\n');
    }
    text
}

/// Heads of the columns that people read.
pub const HEADS: [&str; 12] = [
    "world",
    "camera",
    "layout",
    "rays",
    "FLIP",
    "absolute",
    "energy",
    "indirect energy",
    "leak",
    "stability",
    "lamp on/off/moved 90 %",
    "wall opened/closed 90 %",
];

/// Under [`HEADS`].
pub fn cells(row: &Row) -> [String; 12] {
    let dash = || "–".to_owned();
    let to_90: Vec<String> = match row.response {
        None => Vec::new(),
        Some(responses) => responses
            .all()
            .iter()
            .map(|response| match response {
                None => dash(),
                Some(response) => response
                    .to_90
                    .map_or_else(|| format!(">{}", response.watched), |n| n.to_string()),
            })
            .collect(),
    };
    let joined = |range: std::ops::Range<usize>| {
        to_90
            .get(range)
            .map_or_else(dash, |frames| frames.join("/"))
    };
    [
        row.world.clone(),
        row.camera.clone(),
        row.layout.clone(),
        row.rays.to_string(),
        format!("{:.4}", row.full.flip.mean),
        format!("{:.4}", row.full.abs_sum.mean),
        format!("{:.3}", row.full.energy_ratio),
        format!("{:.3}", row.indirect.energy_ratio),
        row.leak_ratio
            .map_or_else(dash, |leak| format!("{leak:.5}")),
        row.stability
            .map_or_else(dash, |s| format!("{:.5}", s.mean)),
        joined(0..3),
        joined(3..5),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_commas_and_quotes_stay_one_cell() {
        assert_eq!(quoted("plain name"), "plain name");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
        assert_eq!(csv(&[]).lines().count(), 1);
        assert_eq!(csv(&[]).trim_end().split(',').count(), 18 + 10);
    }
}
