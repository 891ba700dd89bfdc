//! The rows as CSV, and as readable tables: on a terminal, in a page, in Markdown.

use std::fmt::Write as _;

use super::{super::dynamics::Responses, page::escaped, row::Row, summary::Summary};

/// A column's name and the text of its cells.
pub type Column = (&'static str, fn(&Row) -> String);

/// The columns that name a row.
pub const NAMES: [Column; 3] = [
    ("world", |row| row.world.clone()),
    ("camera", |row| row.camera.clone()),
    ("layout", |row| row.layout.clone()),
];

const FIGURES: [Column; 18] = [
    ("rays", |row| row.rays.to_string()),
    ("hysteresis", |row| row.hysteresis.to_string()),
    ("frames", |row| row.frames.to_string()),
    ("flip_mean", |row| row.full.flip.mean.to_string()),
    ("flip_p99", |row| row.full.flip.p99.to_string()),
    ("noise_flip", |row| {
        optional(row.noise.map(|noise| noise.full))
    }),
    ("abs_sum_mean", |row| row.full.abs_sum.mean.to_string()),
    ("abs_sum_max", |row| row.full.abs_sum.max.to_string()),
    ("energy_ratio", |row| row.full.energy_ratio.to_string()),
    ("indirect_flip_mean", |row| {
        row.indirect.flip.mean.to_string()
    }),
    ("indirect_noise_flip", |row| {
        optional(row.noise.map(|noise| noise.indirect))
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
    ("probe_bytes", |row| row.probe_bytes.to_string()),
];

/// CSV by RFC 4180, with a header and a column for each key that varies; empty where nothing was measured.
pub fn csv(rows: &[Row], varied: &[&'static str]) -> String {
    let names = |columns: &[Column]| -> Vec<String> {
        columns.iter().map(|(name, _)| (*name).to_owned()).collect()
    };
    let mut heads = names(&NAMES);
    heads.extend(varied.iter().map(|&key| key.to_owned()));
    heads.extend(names(&FIGURES));
    for name in Responses::NAMES {
        heads.extend([format!("{name}_to_90"), format!("{name}_to_99")]);
    }
    let mut text = heads.join(",") + "\r\n";
    for row in rows {
        let mut cells: Vec<String> = NAMES.iter().map(|(_, cell)| cell(row)).collect();
        cells.extend(varied.iter().map(|key| optional(row.settings.value(key))));
        cells.extend(FIGURES.iter().map(|(_, cell)| cell(row)));
        for response in row.response.unwrap_or_default().all() {
            cells.push(optional(response.and_then(|r| r.to_90)));
            cells.push(optional(response.and_then(|r| r.to_99)));
        }
        let cells: Vec<String> = cells.iter().map(|cell| quoted(cell)).collect();
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

/// One row in one line, for output while the run is in progress.
pub fn line(row: &Row) -> String {
    format!(
        "{} · {} · {} · {} rays{}: FLIP {:.4}, absolute {:.4}, indirect energy {:.3}",
        row.world,
        row.camera,
        row.layout,
        row.rays,
        row.settings.note(),
        row.full.flip.mean,
        row.full.abs_sum.mean,
        row.indirect.energy_ratio
    )
}

/// Headings and the cells under them, for display.
pub struct Table {
    heads: Vec<String>,
    lines: Vec<Vec<String>>,
    /// Number of columns with names, which are on the left; columns of numbers follow.
    names: usize,
}

/// A line for each row.
pub fn of_rows(rows: &[Row], varied: &[&'static str]) -> Table {
    let heads = NAMES
        .iter()
        .map(|(name, _)| *name)
        .chain(varied.iter().copied());
    let figures = [
        "rays",
        "FLIP",
        "noise",
        "absolute",
        "energy",
        "indirect energy",
        "leak",
        "stability",
        "lamp on/off/moved 90 %",
        "wall opened/closed 90 %",
    ];
    let lines = rows.iter().map(|row| {
        let mut cells: Vec<String> = NAMES.iter().map(|(_, cell)| cell(row)).collect();
        cells.extend(
            varied
                .iter()
                .map(|key| row.settings.value(key).unwrap_or_else(dash)),
        );
        cells.extend(figures_of(row));
        cells
    });
    Table {
        heads: heads.chain(figures).map(str::to_owned).collect(),
        lines: lines.collect(),
        names: NAMES.len() + varied.len(),
    }
}

/// The cell of a figure that was not measured.
pub fn dash() -> String {
    "–".to_owned()
}

fn figures_of(row: &Row) -> [String; 10] {
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
        row.rays.to_string(),
        format!("{:.4}", row.full.flip.mean),
        row.noise
            .map_or_else(dash, |noise| format!("{:.4}", noise.full)),
        format!("{:.4}", row.full.abs_sum.mean),
        format!("{:.3}", row.full.energy_ratio),
        ratio(row.indirect.energy_ratio),
        row.leak_ratio
            .map_or_else(dash, |leak| format!("{leak:.5}")),
        row.stability
            .map_or_else(dash, |s| format!("{:.5}", s.mean)),
        joined(0..3),
        joined(3..5),
    ]
}

/// A dash where a reference has no light to compare with.
pub fn ratio(value: f64) -> String {
    match value.is_finite() {
        true => format!("{value:.3}"),
        false => dash(),
    }
}

/// A line for each setting, with average and maximum as in the source's tables 4.2 to 4.5.
pub fn of_settings(settings: &[Summary], varied: &[&'static str]) -> Table {
    let figures = [
        "pictures",
        "FLIP",
        "absolute: average",
        "maximum",
        "indirect energy off by",
        "leak",
        "stability: average",
        "maximum",
        "probes, kB",
    ];
    let optional = |value: Option<f64>| value.map_or_else(dash, |value| format!("{value:.5}"));
    let lines = settings.iter().map(|summary| {
        let of_key = |key: &&'static str| summary.settings.value(key).unwrap_or_else(dash);
        let mut cells: Vec<String> = varied.iter().map(of_key).collect();
        if summary.direct_alone {
            cells.insert(0, "direct light alone".to_owned());
        } else {
            cells.insert(0, "DDGI".to_owned());
        }
        cells.extend([
            summary.rows.to_string(),
            format!("{:.4}", summary.flip_mean),
            format!("{:.4}", summary.abs_sum_mean),
            format!("{:.3}", summary.abs_sum_max),
            ratio(summary.indirect_energy_error),
            optional(summary.leak_ratio),
            optional(summary.stability_mean),
            optional(summary.stability_max),
            format!("{:.0}", summary.probe_bytes / 1e3),
        ]);
        cells
    });
    let heads = std::iter::once("light").chain(varied.iter().copied());
    Table {
        heads: heads.chain(figures).map(str::to_owned).collect(),
        lines: lines.collect(),
        names: 1 + varied.len(),
    }
}

impl Table {
    /// `names`: number of columns with names, which are the first. Each line has a cell for each heading.
    pub fn new(heads: Vec<String>, lines: Vec<Vec<String>>, names: usize) -> Self {
        Self {
            heads,
            lines,
            names,
        }
    }

    /// For a terminal: names are aligned to the left, numbers to the right.
    pub fn text(&self) -> String {
        let lines = || std::iter::once(&self.heads).chain(&self.lines);
        let mut widths = vec![0; self.heads.len()];
        for line in lines() {
            for (width, cell) in widths.iter_mut().zip(line) {
                *width = (*width).max(cell.chars().count());
            }
        }
        let mut text = String::new();
        for line in lines() {
            let mut padded = String::new();
            for (index, (cell, &width)) in line.iter().zip(&widths).enumerate() {
                // Writing to a String cannot fail.
                let _ = match index < self.names {
                    true => write!(padded, "{cell:<width$}  "),
                    false => write!(padded, "{cell:>width$}  "),
                };
            }
            text += padded.trim_end();
            text.push('\n');
        }
        text
    }

    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let columns = 0..self.heads.len();
        let rule = columns.map(|index| if index < self.names { "---" } else { "---:" });
        let rule: Vec<&str> = rule.collect();
        let mut text = line(&self.heads) + &format!("|{}|\n", rule.join("|"));
        for cells in &self.lines {
            text += &line(cells);
        }
        text
    }

    pub fn html(&self) -> String {
        let line = |tag: &str, cells: &[String]| {
            let cell = |(index, text): (usize, &String)| {
                let class = if index < self.names {
                    " class=\"name\""
                } else {
                    ""
                };
                format!("<{tag}{class}>{}</{tag}>", escaped(text))
            };
            let cells: String = cells.iter().enumerate().map(cell).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let body: String = self.lines.iter().map(|cells| line("td", cells)).collect();
        format!(
            "<div class=\"scroll\"><table>\n<thead>{}</thead>\n<tbody>\n{body}</tbody></table></div>\n",
            line("th", &self.heads)
        )
    }
}

/// The legend of the columns, in Markdown that is also valid in HTML.
pub const LEGEND: &str = "FLIP (mean; 0 is no visible difference) and absolute (sum over RGB of the absolute \
difference, 0 to 3; mean over the pixels) compare the tone-mapped pictures. Noise is the FLIP that a picture without \
any error would have against the reference: more --spp lowers it. Energy is the light of DDGI over that \
of the reference. Leak is the light that DDGI adds where the reference has none, over the light of the world's \
brightest camera. Stability is the mean change of a pixel between consecutive frames of the still scene, sum over \
RGB. The last two columns count frames until 90 % of a change of the indirect light are there.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_commas_and_quotes_stay_one_cell() {
        assert_eq!(quoted("plain name"), "plain name");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
        let csv = csv(&[], &["probes.relocation"]);
        assert_eq!(csv.lines().count(), 1);
        assert_eq!(csv.trim_end().split(',').count(), 3 + 1 + 18 + 10);
        let table = Table {
            heads: vec!["a".to_owned(), "b".to_owned()],
            lines: vec![vec!["x|y".to_owned(), "<1>".to_owned()]],
            names: 1,
        };
        assert_eq!(table.markdown(), "| a | b |\n|---|---:|\n| x\\|y | <1> |\n");
        assert!(
            table
                .html()
                .contains("<td class=\"name\">x|y</td><td>&lt;1&gt;</td>")
        );
        assert_eq!(table.text(), "a      b\nx|y  <1>\n");
    }
}
