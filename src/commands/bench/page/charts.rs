//! Plots of a suite: frame rates side by side, and the passes that make up a frame.

use std::collections::BTreeMap;

use super::{
    super::model::Row,
    html::plot,
    names::{card, differing, distinct, names},
};
use crate::measure::plot::{self, Bar, BarGroup, Stack};

/// Frames per second of rows whose suite varies only names: a group for each layout, a bar for each condition.
pub fn rates(title: &str, rows: &[&Row]) -> String {
    let rows: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| row.fps.is_some())
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let cards = distinct(rows.iter().map(|row| card(row)));
    let series_of = |row: &Row| match cards.len() {
        1 => row.condition.clone(),
        _ => format!("{} {}", row.condition, card(row)),
    };
    let series = distinct(rows.iter().map(|row| series_of(row)));
    let labels = names(&rows, &["condition", "card"]);
    let groups = distinct(labels.iter());
    let groups: Vec<BarGroup> = groups
        .into_iter()
        .map(|name| {
            let members = rows.iter().zip(&labels).filter(|(_, label)| *label == name);
            let bar = |(row, _): (&&Row, &String)| {
                let fps = row.fps?;
                let relative = row.timing.as_ref().map(|timing| timing.interval.relative());
                Some(Bar {
                    series: series.iter().position(|known| *known == series_of(row))?,
                    value: fps,
                    half_width: relative.map(|relative| relative * fps),
                })
            };
            BarGroup {
                name: name.clone(),
                bars: members.filter_map(bar).collect(),
            }
        })
        .collect();
    let svg = plot::bars(&format!("{title}, frames per second"), &groups);
    let key: Vec<(usize, String)> = series.into_iter().enumerate().collect();
    let words = match &key[..] {
        [(_, only)] => vec![format!(
            "Condition: {only}. Lines are 95 % intervals of the median."
        )],
        _ => vec!["Lines are 95 % intervals of the median.".to_owned()],
    };
    plot(&format!("{title}: frames per second"), &svg, &key, &words)
}

/// Passes with a colour of their own; all others are grey.
const MOST_PASSES: usize = 8;
const GREY: usize = 8;

/// The passes that make up the frame of each row.
pub fn passes(title: &str, rows: &[&Row]) -> String {
    let rows: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| !row.passes.is_empty())
        .collect();
    let mut totals: BTreeMap<&str, f64> = BTreeMap::new();
    for row in &rows {
        for (pass, ms) in &row.passes {
            *totals.entry(pass).or_default() += ms;
        }
    }
    if totals.is_empty() {
        return String::new();
    }
    let mut largest: Vec<(&str, f64)> = totals.into_iter().collect();
    largest.sort_by(|a, b| b.1.total_cmp(&a.1));
    let others = largest.split_off(largest.len().min(MOST_PASSES));
    let stacks: Vec<Stack> = rows
        .iter()
        .zip(names(&rows, &[]))
        .map(|(row, name)| {
            let part =
                |(index, (pass, _)): (usize, &(&str, f64))| Some((index, *row.passes.get(*pass)?));
            let mut parts: Vec<(usize, f64)> =
                largest.iter().enumerate().filter_map(part).collect();
            let rest: f64 = others
                .iter()
                .filter_map(|(pass, _)| row.passes.get(*pass))
                .sum();
            parts.push((GREY, rest));
            Stack { name, parts }
        })
        .collect();
    let mut key: Vec<(usize, String)> = largest
        .iter()
        .enumerate()
        .map(|(index, (pass, _))| (index, (*pass).to_owned()))
        .collect();
    if !others.is_empty() {
        key.push((GREY, format!("{} others", others.len())));
    }
    let svg = plot::stacks(&format!("{title}, milliseconds of each pass"), &stacks);
    let named = differing(&rows, &[]);
    let words = match named[..] {
        [] => Vec::new(),
        _ => vec![format!(
            "Rows are named by {}. A pass that runs only in some frames, such as after an edit, is \
             drawn with its time in those frames.",
            named.join(", ")
        )],
    };
    plot(
        &format!("{title}: milliseconds by pass"),
        &svg,
        &key,
        &words,
    )
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn every_layout_and_condition_has_its_bar() {
        let report = made_up::report();
        let rows: Vec<&Row> = report
            .rows
            .iter()
            .filter(|row| row.suite == "layouts")
            .collect();
        let text = rates("cave", &rows);
        assert_eq!(text.matches("<rect").count(), 8, "{text}");
        for part in ["layout3", ">still<", ">moving<", "1250"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(rates("cave", &[]), "");
    }

    #[test]
    fn small_passes_share_a_colour() {
        let mut row = made_up::row("layouts/cave/layout1/moving", 1.0);
        row.passes = (0..12)
            .map(|index| (format!("pass{index:02}"), 12.0 - f64::from(index)))
            .collect();
        let text = passes("cave", &[&row]);
        assert_eq!(text.matches("<rect").count(), 9, "{text}");
        assert!(text.contains("4 others"), "{text}");
        assert!(
            text.contains("pass00") && !text.contains("pass11"),
            "{text}"
        );
        row.passes.clear();
        assert_eq!(passes("cave", &[&row]), "");
    }
}
