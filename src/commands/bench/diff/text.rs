//! A comparison as a terminal shows it.

use std::fmt::Write as _;

use super::compare::{Comparison, Difference, RowDifference};
use crate::measure::plot::figure;

/// The table of rows, the passes that have changed, rows that only one side has, and a summary.
pub fn text(comparison: &Comparison) -> String {
    let mut text = String::new();
    let lines: Vec<[String; 6]> = comparison.rows.iter().map(cells).collect();
    let header = ["row", "", "before", "after", "change", ""].map(str::to_owned);
    let all = || [&header].into_iter().chain(&lines);
    let width = |column: usize| {
        all()
            .map(|line| line[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let [id, name, before, after, change] = [0, 1, 2, 3, 4].map(width);
    for line in all() {
        let [a, b, c, d, e, f] = line;
        let line = format!("{a:<id$}  {b:<name$}  {c:>before$}  {d:>after$}  {e:>change$}  {f}");
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", line.trim_end());
    }
    for row in &comparison.rows {
        let changed = row.passes.iter().filter(|pass| pass.verdict.is_real());
        let changed: Vec<String> = changed.map(pass_words).collect();
        if !changed.is_empty() {
            let _ = writeln!(text, "passes of {}: {}", row.id, changed.join(", "));
        }
    }
    for (ids, side) in [
        (&comparison.only_before, "before"),
        (&comparison.only_after, "after"),
    ] {
        for id in ids {
            let _ = writeln!(text, "only {side}: {id}");
        }
    }
    for pass in &comparison.passes {
        let _ = writeln!(
            text,
            "pass {}: {} by {:.1} % (median) in {} of {} rows",
            pass.pass,
            pass.verdict.in_words(),
            100.0 * pass.change.abs(),
            pass.rows,
            pass.of
        );
    }
    let real = comparison
        .rows
        .iter()
        .filter(|row| row.headline.verdict.is_real())
        .count();
    let _ = match (real, comparison.passes.len()) {
        (0, 0) => writeln!(text, "no change in {} rows", comparison.rows.len()),
        (real, passes) => writeln!(
            text,
            "{real} of {} rows and {passes} passes have changed",
            comparison.rows.len()
        ),
    };
    text
}

fn cells(row: &RowDifference) -> [String; 6] {
    let Difference {
        name,
        before,
        after,
        change,
        verdict,
        ..
    } = &row.headline;
    let with_interval = |value: f64, half: Option<f64>| match half {
        Some(half) => format!("{} ± {}", figure(value), figure(half)),
        None => figure(value),
    };
    [
        row.id.clone(),
        name.clone(),
        with_interval(before.value, before.half_width),
        with_interval(after.value, after.half_width),
        percent(*change),
        verdict.in_words().to_owned(),
    ]
}

fn pass_words(pass: &Difference) -> String {
    let (before, after) = (figure(pass.before.value), figure(pass.after.value));
    format!(
        "{} {} ({before} → {after} ms)",
        pass.name,
        percent(pass.change)
    )
}

fn percent(change: f64) -> String {
    format!("{:+.2} %", 100.0 * change)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{super::made_up, compare::compare},
        *,
    };

    #[test]
    fn the_text_says_what_has_changed() {
        let before = made_up::report();
        let mut after = made_up::report();
        let row = made_up::row("layouts/cave/layout1/moving", 0.8 * 1.04);
        after.rows[1] = row;
        after.rows[0].id = "layouts/cave/new/still".to_owned();
        let text = text(&compare(&before, &after));
        for part in [
            "SLOWER",
            "+4.00 %",
            "passes of layouts/cave/layout1/moving: probe_trace +4.00 % (0.4 → 0.416 ms)",
            "only before: layouts/cave/layout1/still",
            "only after: layouts/cave/new/still",
            "1 of 11 rows and 0 passes have changed",
        ] {
            assert!(text.contains(part), "{part}:\n{text}");
        }
        let same = super::text(&compare(&before, &before));
        assert!(same.ends_with("no change in 12 rows\n"), "{same}");
    }
}
