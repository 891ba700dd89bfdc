//! `index.html`: a report as one page without other files.

mod beside;
mod charts;
mod growth;
mod heading;
pub mod html;
pub mod names;
mod published;
mod quality;
mod tables;

pub use self::heading::adapter_words;
use super::model::{Report, Row};
use crate::measure::plot::escaped;

/// The whole page.
pub fn page(report: &Report) -> String {
    let mut body = heading::heading(report);
    let of = |software| -> Vec<&Row> {
        let rows = report.rows.iter();
        rows.filter(|row| row.is_software() == software).collect()
    };
    let (hardware, software) = (of(false), of(true));
    body += &sections(&hardware);
    body += &beside::beside(&hardware);
    if !software.is_empty() {
        body += "<h2>Software adapters</h2>\n<p class=\"loud\">A CPU does the work of the GPU here. These \
                 figures say nothing about any GPU.</p>\n";
        body += &sections(&software);
    }
    if !report.missing.is_empty() {
        let lines: Vec<(&str, String)> = (report.missing.iter())
            .map(|missing| (missing.id.as_str(), missing.reason.clone()))
            .collect();
        body += "<h2>Missing</h2>\n";
        body += &html::facts(&lines);
    }
    html::document(&format!("grotto bench {}", report.suite), &body)
}

/// Plots and tables of rows of one kind of adapter.
fn sections(rows: &[&Row]) -> String {
    let mut text = String::new();
    for suite in names::distinct(rows.iter().map(|row| row.suite.as_str())) {
        let rows: Vec<&Row> = rows
            .iter()
            .copied()
            .filter(|row| row.suite == suite)
            .collect();
        text += &format!("<h2>{}</h2>\n", escaped(suite));
        let mut plots = String::new();
        for world in names::distinct(rows.iter().map(|row| row.world.as_str())) {
            let rows: Vec<&Row> = rows
                .iter()
                .copied()
                .filter(|row| row.world == world)
                .collect();
            let keys = growth::varied_numbers(&rows);
            if keys.is_empty() {
                plots += &charts::rates(world, &rows);
            }
            for key in &keys {
                plots += &growth::growth(world, &rows, key);
            }
            // One plot for each card: with the cards in the names of the rows, the names would not fit.
            let cards = names::distinct(rows.iter().map(|row| names::card(row)));
            for card in &cards {
                let of_card = rows.iter().filter(|row| names::card(row) == *card);
                let title = match cards.len() {
                    1 => world.to_owned(),
                    _ => format!("{world}, {card}"),
                };
                plots += &charts::passes(&title, &of_card.copied().collect::<Vec<_>>());
            }
        }
        text += &html::plots(&plots);
        text += &tables::tables(suite, &rows);
        text += &tables::frames(&rows);
    }
    text + &quality::quality(rows)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{made_up, model::Missing},
        *,
    };

    #[test]
    fn the_page_needs_nothing_else_and_holds_every_row() {
        let report = made_up::report();
        let text = page(&report);
        for row in &report.rows {
            let within = format!("{}/", row.suite);
            let name = row.id.strip_prefix(&within).unwrap_or(&row.id);
            assert!(text.contains(&format!("<td>{name}</td>")), "{name}");
        }
        for outside in ["http:", "https:", "<link", "<script", "url("] {
            assert!(!text.contains(outside), "{outside}");
        }
        for part in [
            "Card 9000",
            "0123456789ab",
            "CPU 64",
            "Linux 6.1",
            "1980 MHz",
            "312 W",
            "Seed",
        ] {
            assert!(text.contains(part), "{part}");
        }
        assert!(!text.contains("class=\"warn\""), "nothing to warn of");
        assert!(!text.contains("NaN") && !text.contains("inf"), "no NaN");
    }

    #[test]
    fn software_rows_stand_apart_and_warnings_are_said() {
        let mut report = made_up::report();
        report.complete = false;
        report.quick = true;
        report.build.profile = "debug".to_owned();
        for row in &mut report.rows[8..] {
            row.adapter.kind = "software".to_owned();
        }
        report.rows[0].timing.as_mut().expect("frames").noisy = true;
        report.missing.push(Missing {
            id: "lights/cave/64".to_owned(),
            reason: "<no> such preset".to_owned(),
        });
        let text = page(&report);
        for part in [
            "Partial:",
            "--quick",
            "debug build",
            "4 of 12 rows ran on a software adapter",
            "1 rows are noisy",
            "&lt;no&gt; such preset",
        ] {
            assert!(text.contains(part), "{part}");
        }
        let (hardware, software) = text
            .split_once("<h2>Software adapters</h2>")
            .expect("a heading");
        assert!(hardware.contains("<h2>layouts</h2>") && !software.contains("<h2>layouts</h2>"));
        assert!(software.contains("<h2>rays</h2>") && !hardware.contains("<h2>rays</h2>"));
    }

    #[test]
    fn names_cannot_become_markup() {
        let mut report = made_up::report();
        for row in &mut report.rows {
            row.layout = Some("<b>".to_owned());
            row.condition = "<i>".to_owned();
            row.id = format!("<u>{}", row.id);
            row.suite = "<s>".to_owned();
        }
        let text = page(&report);
        for tag in ["<b>", "<i>", "<u>", "<s>"] {
            assert!(!text.contains(tag), "{tag}");
        }
    }

    #[test]
    fn a_hundred_and_fifty_rows_stay_below_a_megabyte() {
        let mut report = made_up::report();
        report.rows = (0..150)
            .map(|index| {
                made_up::row(
                    &format!("suite{}/cave/layout{index}/moving", index / 15),
                    1.0,
                )
            })
            .collect();
        let bytes = page(&report).len();
        assert!(bytes < 1_000_000, "{bytes} bytes");
    }
}
