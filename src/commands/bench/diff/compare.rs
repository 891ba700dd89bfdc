//! Which differences between two reports are real, and which are noise.

use serde::Serialize;

use super::super::model::{Figure, Report, Row};
use crate::measure::welch::{discoveries, welch};

/// Smallest relative change of a row that counts: two runs of one build on an idle machine agree to about this.
pub const FLOOR: f64 = 0.01;
/// The same for a pass. Short passes vary more from run to run than whole frames do.
pub const PASS_FLOOR: f64 = 0.02;
/// A pass whose change is a smaller share of the frame than this is left out, however large its relative change
/// is.
const PASS_SHARE: f64 = 5e-4;
/// Share of the reported changes that may be due to chance.
const FALSE_SHARE: f64 = 0.05;

/// The verdict on a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Real, and better.
    Faster,
    /// Real, and worse.
    Slower,
    /// Real, in a figure where neither more nor less is better.
    Changed,
    /// Not distinguishable from chance, or below the floor.
    Noise,
    /// Measured once on one side, so that its spread is unknown.
    Unknown,
}

impl Verdict {
    pub fn is_real(self) -> bool {
        matches!(self, Self::Faster | Self::Slower | Self::Changed)
    }

    pub fn in_words(self) -> &'static str {
        match self {
            Self::Faster => "faster",
            Self::Slower => "SLOWER",
            Self::Changed => "changed",
            Self::Noise => "noise",
            Self::Unknown => "measured once",
        }
    }
}

/// One quantity in both reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// `frame_ms`, or the name of a figure or a pass.
    pub name: String,
    pub before: Figure,
    pub after: Figure,
    /// Relative to `before`: 0.03 is 3 % more.
    pub change: f64,
    /// Probability of such a difference by chance alone; `null` where the spread is unknown.
    pub p: Option<f64>,
    pub verdict: Verdict,
}

/// A row that is in both reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowDifference {
    pub id: String,
    pub headline: Difference,
    /// Differences of the passes, longest first.
    pub passes: Vec<Difference>,
}

/// The change of a pass over all rows that have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassChange {
    pub pass: String,
    /// Rows in which the pass has really changed, in the direction of the majority.
    pub rows: usize,
    /// Rows that have the pass.
    pub of: usize,
    /// Median of the relative changes of those rows.
    pub change: f64,
    pub verdict: Verdict,
}

/// Two reports, compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub rows: Vec<RowDifference>,
    pub passes: Vec<PassChange>,
    /// Ids of rows that only one side has.
    pub only_before: Vec<String>,
    pub only_after: Vec<String>,
}

/// Compares row by row.
///
/// A difference is real when Welch's t-test on the medians of the runs says so, and when it is larger than a
/// floor of 1 % (2 % for a pass). The test needs few assumptions: runs are independent of each other (the
/// frames within one run are not), and the spreads of two builds may differ. It is sharper than overlapping
/// intervals: two intervals may overlap although the means differ. There are hundreds of rows and thousands of
/// passes, so each family is held to a false discovery rate of 5 % (Benjamini & Hochberg). Without that, one in
/// twenty comparisons of equal runs would report a change. The floor covers what the spread within one call
/// cannot show: clocks, temperature and the placement of memory differ from call to call.
///
/// Figures without runs are compared by their intervals, which are assumed to be normal.
pub fn compare(before: &Report, after: &Report) -> Comparison {
    let pairs: Vec<(&Row, &Row)> = before
        .rows
        .iter()
        .filter_map(|a| Some((a, after.rows.iter().find(|b| b.id == a.id)?)))
        .collect();
    let headlines: Vec<Option<Difference>> = pairs.iter().map(|(a, b)| headline(a, b)).collect();
    let passes: Vec<Vec<Difference>> = pairs.iter().map(|(a, b)| pass_differences(a, b)).collect();
    let mut rows: Vec<RowDifference> = pairs
        .iter()
        .zip(headlines)
        .zip(passes)
        .filter_map(|(((row, _), headline), passes)| {
            Some(RowDifference {
                id: row.id.clone(),
                headline: headline?,
                passes,
            })
        })
        .collect();
    judge(
        rows.iter_mut()
            .map(|row| (&mut row.headline, None))
            .collect(),
        FLOOR,
    );
    let of_passes = rows.iter_mut().flat_map(|row| {
        let frame = row.headline.before.value;
        row.passes.iter_mut().map(move |pass| (pass, Some(frame)))
    });
    judge(of_passes.collect(), PASS_FLOOR);
    let only = |these: &Report, those: &Report| {
        let alone = these
            .rows
            .iter()
            .filter(|row| those.rows.iter().all(|other| other.id != row.id));
        alone.map(|row| row.id.clone()).collect()
    };
    Comparison {
        passes: pass_changes(&rows),
        rows,
        only_before: only(before, after),
        only_after: only(after, before),
    }
}

/// The difference of a row's main quantity, still without a verdict. `None` where the rows have no quantity in
/// common.
fn headline(a: &Row, b: &Row) -> Option<Difference> {
    let (name, before) = a.headline()?;
    let (other, after) = b.headline()?;
    let p = match (&a.timing, &b.timing) {
        (Some(a), Some(b)) => welch(&a.runs_ms, &b.runs_ms),
        _ => by_intervals(before, after),
    };
    (name == other).then(|| difference(name, before, after, p))
}

fn pass_differences(a: &Row, b: &Row) -> Vec<Difference> {
    let runs = |row: &Row, pass: &str| -> Vec<f64> {
        let timing = row.timing.as_ref();
        let runs = timing.and_then(|timing| timing.pass_runs_ms.get(pass));
        runs.cloned().unwrap_or_default()
    };
    let mut all: Vec<Difference> = a
        .passes
        .iter()
        .filter_map(|(pass, before)| {
            let once = |value: f64| Figure {
                value,
                half_width: None,
            };
            let after = once(*b.passes.get(pass)?);
            let p = welch(&runs(a, pass), &runs(b, pass));
            Some(difference(pass, once(*before), after, p))
        })
        .collect();
    all.sort_by(|a, b| b.before.value.total_cmp(&a.before.value));
    all
}

/// The half widths are of 95 % intervals: 1.96 standard errors of many values.
fn by_intervals(before: Figure, after: Figure) -> Option<f64> {
    let (a, b) = (before.half_width?, after.half_width?);
    let error = a.hypot(b) / 1.96;
    let distance = (after.value - before.value).abs();
    if error > 0.0 {
        // Twice the tail of the normal distribution (Abramowitz & Stegun 7.1.26, good to 1.5e-7).
        let x = distance / error / std::f64::consts::SQRT_2;
        let t = 1.0 / (1.0 + 0.327_591_1 * x);
        let series = [
            1.061_405_429,
            -1.453_152_027,
            1.421_413_741,
            -0.284_496_736,
            0.254_829_592,
        ];
        let sum = series.iter().fold(0.0, |sum, factor| sum * t + factor);
        Some((sum * t * (-x * x).exp()).clamp(0.0, 1.0))
    } else {
        Some(if distance > 0.0 { 0.0 } else { 1.0 })
    }
}

fn difference(name: &str, before: Figure, after: Figure, p: Option<f64>) -> Difference {
    let change = if before.value == after.value {
        0.0
    } else {
        (after.value - before.value) / before.value.abs()
    };
    Difference {
        name: name.to_owned(),
        before,
        after,
        change,
        p,
        verdict: Verdict::Noise,
    }
}

/// Gives each difference of a family its verdict. Passes come with the milliseconds of their frame.
fn judge(family: Vec<(&mut Difference, Option<f64>)>, floor: f64) {
    let probabilities: Vec<Option<f64>> =
        family.iter().map(|(difference, _)| difference.p).collect();
    let found = discoveries(&probabilities, FALSE_SHARE);
    for ((difference, frame_ms), found) in family.into_iter().zip(found) {
        let moved = (difference.after.value - difference.before.value).abs();
        let counts = frame_ms.is_none_or(|frame_ms| moved >= PASS_SHARE * frame_ms);
        difference.verdict = if difference.change.abs() <= floor || !counts {
            Verdict::Noise
        } else if difference.p.is_none() {
            Verdict::Unknown
        } else if !found {
            Verdict::Noise
        } else if frame_ms.is_none() && !less_is_better(&difference.name) {
            Verdict::Changed
        } else if difference.change > 0.0 {
            Verdict::Slower
        } else {
            Verdict::Faster
        };
    }
}

/// Times and sizes are better when they are smaller.
fn less_is_better(name: &str) -> bool {
    ["_ms", "_s", "_bytes", "_mb"]
        .iter()
        .any(|unit| name.ends_with(unit))
        && !name.ends_with("_per_s")
}

/// Passes that have changed in one direction in at least half of the rows that have them.
fn pass_changes(rows: &[RowDifference]) -> Vec<PassChange> {
    let all = || rows.iter().flat_map(|row| &row.passes);
    let mut names: Vec<&str> = all().map(|pass| pass.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let of_pass = |name: &str| {
        let members: Vec<&Difference> = all().filter(|pass| pass.name == name).collect();
        let count = |verdict| {
            members
                .iter()
                .filter(|pass| pass.verdict == verdict)
                .count()
        };
        let (slower, faster) = (count(Verdict::Slower), count(Verdict::Faster));
        let verdict = if slower >= faster {
            Verdict::Slower
        } else {
            Verdict::Faster
        };
        let rows = slower.max(faster);
        let agreeing = members.iter().filter(|pass| pass.verdict == verdict);
        let changes: Vec<f64> = agreeing.map(|pass| pass.change).collect();
        (rows > 0 && 2 * rows >= members.len()).then(|| PassChange {
            pass: name.to_owned(),
            rows,
            of: members.len(),
            change: crate::measure::statistics::median(&changes).unwrap_or(0.0),
            verdict,
        })
    };
    let mut changes: Vec<PassChange> = names.into_iter().filter_map(of_pass).collect();
    changes.sort_by(|a, b| b.change.abs().total_cmp(&a.change.abs()));
    changes
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    /// The report with every time of one pass multiplied by `factor`, and the frame longer by the same amount.
    fn with_slower_pass(pass: &str, factor: f64) -> Report {
        let mut report = made_up::report();
        for row in &mut report.rows {
            let Some(ms) = row.passes.get_mut(pass) else {
                continue;
            };
            let more = *ms * (factor - 1.0);
            *ms *= factor;
            let (timing, frame) = (row.timing.as_mut(), row.frame_ms.as_mut());
            let (timing, frame) = (timing.expect("timed"), frame.expect("timed"));
            for ms in timing.pass_runs_ms.get_mut(pass).expect("runs") {
                *ms *= factor;
            }
            for ms in &mut timing.runs_ms {
                *ms += more;
            }
            frame.median += more;
        }
        report
    }

    #[test]
    fn equal_runs_have_no_change() {
        let report = made_up::report();
        let comparison = compare(&report, &report);
        assert_eq!(comparison.rows.len(), report.rows.len());
        for row in &comparison.rows {
            assert_eq!(row.headline.verdict, Verdict::Noise, "{row:?}");
            assert_eq!(row.headline.change, 0.0);
        }
        assert!(comparison.passes.is_empty());
        assert!(comparison.only_before.is_empty() && comparison.only_after.is_empty());
        // A drift below the floor is no change either, however certain it is.
        let drifted = with_slower_pass("probe_trace", 1.015);
        let comparison = compare(&report, &drifted);
        assert!(comparison.passes.is_empty(), "{:?}", comparison.passes);
        assert!(
            comparison
                .rows
                .iter()
                .all(|row| !row.headline.verdict.is_real())
        );
    }

    #[test]
    fn a_slowdown_of_three_percent_of_one_pass_is_found_and_named() {
        let report = made_up::report();
        for (before, after, verdict) in [
            (
                &report,
                &with_slower_pass("view/shade", 1.03),
                Verdict::Slower,
            ),
            (
                &with_slower_pass("view/shade", 1.03),
                &report,
                Verdict::Faster,
            ),
        ] {
            let comparison = compare(before, after);
            let [change] = &comparison.passes[..] else {
                panic!("one pass, not {:?}", comparison.passes);
            };
            assert_eq!(change.pass, "view/shade");
            assert_eq!(change.verdict, verdict);
            assert_eq!((change.rows, change.of), (11, 11));
            assert!((change.change.abs() - 0.03).abs() < 0.001, "{change:?}");
            // The pass takes a quarter of the frame: 0.75 % of it, below the floor of rows.
            assert!(
                comparison
                    .rows
                    .iter()
                    .all(|row| !row.headline.verdict.is_real())
            );
        }
    }

    #[test]
    fn a_row_is_real_only_beyond_chance_and_the_floor() {
        let before = made_up::report();
        let verdict = |after: &Report| compare(&before, after).rows[1].headline.verdict;
        let mut after = made_up::report();
        let changed = made_up::row("layouts/cave/layout1/moving", 0.8 * 1.04);
        after.rows[1].timing.clone_from(&changed.timing);
        after.rows[1].frame_ms = changed.frame_ms;
        assert_eq!(verdict(&after), Verdict::Slower);
        let timing = after.rows[1].timing.as_mut().expect("timed");
        timing.runs_ms = vec![0.5, 1.1, 0.83, 0.6, 1.2];
        assert_eq!(verdict(&after), Verdict::Noise);
        timing_of(&mut after).runs_ms.truncate(1);
        assert_eq!(verdict(&after), Verdict::Unknown);
    }

    fn timing_of(report: &mut Report) -> &mut super::super::super::model::Timing {
        report.rows[1].timing.as_mut().expect("timed")
    }

    #[test]
    fn figures_are_compared_by_their_intervals() {
        let figure = |value, half_width| Figure { value, half_width };
        // Two half widths of 1.96 each: the difference of 5.43 is 1.96 standard errors of both together.
        let a = figure(100.0, Some(1.96));
        let distance = 1.96 * 2f64.sqrt();
        let p = by_intervals(a, figure(100.0 + distance, Some(1.96))).expect("intervals");
        assert!((p - 0.05).abs() < 1e-3, "{p}");
        assert_eq!(by_intervals(a, figure(101.0, None)), None);
        assert_eq!(
            by_intervals(figure(1.0, Some(0.0)), figure(2.0, Some(0.0))),
            Some(0.0)
        );
        assert!(less_is_better("first_frame_ms") && less_is_better("total_bytes"));
        assert!(!less_is_better("mrays_per_s") && !less_is_better("flip"));
    }

    #[test]
    fn rows_of_one_side_are_listed() {
        let before = made_up::report();
        let mut after = made_up::report();
        after.rows[0].id = "layouts/cave/layout9/still".to_owned();
        let comparison = compare(&before, &after);
        assert_eq!(comparison.only_before, [before.rows[0].id.clone()]);
        assert_eq!(comparison.only_after, ["layouts/cave/layout9/still"]);
        assert_eq!(comparison.rows.len(), before.rows.len() - 1);
    }
}
