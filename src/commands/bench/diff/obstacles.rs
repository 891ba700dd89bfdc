//! Why two reports are not comparable.

use super::super::{
    model::{Report, Row},
    page::{adapter_words, names::distinct},
};

/// Rows named in one message.
const MOST_NAMED: usize = 3;

/// One sentence for each reason; empty where the reports are comparable.
pub fn between(before: &Report, after: &Report) -> Vec<String> {
    let mut found = Vec::new();
    let mut differs = |what: &str, a: &str, b: &str| {
        if a != b {
            found.push(format!("another {what}: {a}, and {b}"));
        }
    };
    let adapters = |report: &Report| {
        let mut words = distinct(report.rows.iter().map(|row| adapter_words(&row.adapter)));
        words.sort();
        words.join("; ")
    };
    differs("suite", &before.suite, &after.suite);
    differs("adapter or driver", &adapters(before), &adapters(after));
    differs("CPU", &before.machine.cpu, &after.machine.cpu);
    differs(
        "profile of the build",
        &before.build.profile,
        &after.build.profile,
    );
    differs(
        "length of the runs",
        length(before.quick),
        length(after.quick),
    );
    for world in &before.worlds {
        // A suite may have one world at several sizes and with several seeds.
        let mut others = after.worlds.iter().filter(|other| other.name == world.name);
        let is_there = others.clone().any(|other| other.hash == world.hash);
        if let Some(other) = others.next().filter(|_| !is_there) {
            found.push(format!(
                "another world `{}`: hash {}, and {}",
                world.name, world.hash, other.hash
            ));
        }
    }
    let altered: Vec<&str> = before
        .rows
        .iter()
        .filter(|row| {
            let other = after.rows.iter().find(|other| other.id == row.id);
            other.is_some_and(|other| conditions(row) != conditions(other))
        })
        .map(|row| row.id.as_str())
        .collect();
    if !altered.is_empty() {
        let named = &altered[..altered.len().min(MOST_NAMED)];
        let more = if altered.len() > named.len() {
            ", …"
        } else {
            ""
        };
        found.push(format!(
            "other conditions (size, frames, seed, camera, view, clock or parameters) of {} rows: {}{more}",
            altered.len(),
            named.join(", ")
        ));
    }
    found
}

fn length(quick: bool) -> &'static str {
    if quick { "--quick" } else { "in full" }
}

/// The conditions that must be equal for two rows to be the same row.
fn conditions(row: &Row) -> impl PartialEq {
    (
        row.size,
        row.frames,
        row.seed,
        row.camera.clone(),
        row.view.clone(),
        row.clock.clone(),
        row.set.clone(),
        row.varied.clone(),
    )
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn every_obstacle_is_named() {
        let report = made_up::report();
        assert!(between(&report, &report).is_empty());
        type Change = (&'static str, fn(&mut Report));
        let changes: [Change; 8] = [
            ("suite", |report| report.suite = "layouts".to_owned()),
            ("driver", |report| report.rows[0].adapter.driver.push('x')),
            ("CPU", |report| report.machine.cpu.push('x')),
            ("profile", |report| {
                report.build.profile = "debug".to_owned()
            }),
            ("--quick", |report| report.quick = true),
            ("world `cave`", |report| {
                report.worlds[0].hash = "f".repeat(32)
            }),
            ("of 1 rows", |report| report.rows[2].size = [64, 64]),
            ("…", |report| {
                report.rows.iter_mut().for_each(|row| row.seed = 9)
            }),
        ];
        for (part, change) in changes {
            let mut other = made_up::report();
            change(&mut other);
            let found = between(&report, &other);
            assert_eq!(found.len(), 1, "{part}: {found:?}");
            assert!(found[0].contains(part), "{part}: {found:?}");
        }
    }

    #[test]
    fn another_commit_or_another_set_of_rows_is_no_obstacle() {
        let report = made_up::report();
        let mut other = made_up::report();
        other.build.commit = "else".to_owned();
        other.started = "2026-11-23T20:00:00Z".to_owned();
        other.rows.truncate(3);
        assert!(between(&report, &other).is_empty());
    }

    #[test]
    fn one_world_may_be_there_at_several_sizes() {
        let mut report = made_up::report();
        let mut larger = report.worlds[0].clone();
        larger.size = [1024, 512, 1024];
        larger.hash = "e".repeat(32);
        report.worlds.push(larger);
        assert!(between(&report, &report).is_empty());
        let mut other = report.clone();
        other.worlds.last_mut().expect("pushed").hash = "f".repeat(32);
        let found = between(&report, &other);
        assert_eq!(found.len(), 1, "{found:?}");
    }
}
