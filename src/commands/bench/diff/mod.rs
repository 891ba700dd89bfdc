//! `grotto bench diff`: two runs, row by row.

mod compare;
mod obstacles;
mod text;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use self::compare::{Comparison, Verdict, compare};
use super::{
    super::{Failure, options::RunOptions, output},
    model::{Build, Report},
};

/// Compare two results row by row: what has changed, and what is noise
///
/// A difference is real when Welch's t-test on the medians of the runs says so and it is larger than 1 % (2 %
/// for a pass). Passes that have changed are named. Results of other machines, suites, worlds or parameters are
/// refused without --anyway.
#[derive(Args)]
pub struct Arguments {
    /// The earlier result: a folder, or its bench.json
    #[arg(value_name = "A")]
    before: PathBuf,
    /// The later result
    #[arg(value_name = "B")]
    after: PathBuf,
    /// End with exit code 4 when a row has become slower by more than this share, as in 3%
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    fail_over: Option<f64>,
    /// Compare results that are not comparable, and say so
    #[arg(long)]
    anyway: bool,
    #[command(flatten)]
    run: RunOptions,
}

/// Reads `3%` or `0.03` as 0.03.
fn share(text: &str) -> Result<f64, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => number(percent).map(|percent| percent / 100.0),
        None => number(text),
    };
    share
        .filter(|share| (0.0..=10.0).contains(share))
        .ok_or_else(|| "write a share, as in 3% or 0.03, from 0 to 1000%".to_owned())
}

/// What `--json` prints.
#[derive(Serialize)]
struct Record<'a> {
    before: Side<'a>,
    after: Side<'a>,
    /// Why the two reports are not comparable, where `--anyway` compared them.
    obstacles: &'a [String],
    /// The limit as a share; `null` without `--fail-over`.
    fail_over: Option<f64>,
    /// Ids of the rows that exceed the limit.
    failed: Vec<&'a str>,
    #[serde(flatten)]
    comparison: &'a Comparison,
}

#[derive(Serialize)]
struct Side<'a> {
    started: &'a str,
    build: &'a Build,
    complete: bool,
}

impl<'a> Side<'a> {
    fn of(report: &'a Report) -> Self {
        Self {
            started: &report.started,
            build: &report.build,
            complete: report.complete,
        }
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let run = &arguments.run;
    let before = Report::read(&arguments.before)?;
    let after = Report::read(&arguments.after)?;
    let obstacles = obstacles::between(&before, &after);
    if !obstacles.is_empty() && !arguments.anyway {
        return Err(Failure::bad_input(format!(
            "{} and {} do not compare:\n  {}\nadd --anyway to compare them nevertheless",
            arguments.before.display(),
            arguments.after.display(),
            obstacles.join("\n  ")
        )));
    }
    for obstacle in &obstacles {
        output::note(run, &format!("warning: {obstacle}"));
    }
    for (path, report) in [(&arguments.before, &before), (&arguments.after, &after)] {
        if !report.complete {
            output::note(run, &format!("warning: {} is partial", path.display()));
        }
    }
    let comparison = compare(&before, &after);
    if comparison.rows.is_empty() {
        return Err(Failure::bad_input(format!(
            "{} and {} have no row in common",
            arguments.before.display(),
            arguments.after.display()
        )));
    }
    let past = |threshold: f64| -> Vec<&str> {
        let slower = comparison.rows.iter().filter(|row| {
            row.headline.verdict == Verdict::Slower && row.headline.change > threshold
        });
        slower.map(|row| row.id.as_str()).collect()
    };
    let failed = arguments.fail_over.map_or(Vec::new(), past);
    if run.json {
        output::print_json(&Record {
            before: Side::of(&before),
            after: Side::of(&after),
            obstacles: &obstacles,
            fail_over: arguments.fail_over,
            failed: failed.clone(),
            comparison: &comparison,
        })?;
    } else {
        output::print(&text::text(&comparison))?;
    }
    match (arguments.fail_over, failed.len()) {
        (Some(threshold), 1..) => Err(Failure::gate(format!(
            "{} of {} rows are slower by more than {:.1} %: {}",
            failed.len(),
            comparison.rows.len(),
            100.0 * threshold,
            failed.join(", ")
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_read_and_garbage_is_refused() {
        assert_eq!(share("3%"), Ok(0.03));
        assert_eq!(share(" 2.5 % "), Ok(0.025));
        assert_eq!(share("0.1"), Ok(0.1));
        assert_eq!(share("0"), Ok(0.0));
        for garbage in ["", "%", "3 percent", "-1%", "nan", "inf", "1001%", "3%%"] {
            let message = share(garbage).expect_err(garbage);
            assert!(message.contains("3%"), "{message}");
        }
    }
}
