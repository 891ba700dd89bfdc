//! `grotto bench merge`: results of several cards side by side. Also joins the parts of one run, for `grotto
//! merge`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{
    super::{Failure, options::RunOptions, output, shard::Shard},
    model::{Missing, Part, Report, Row, WorldRecord},
    results::{FRAMES, Files, join_logs, summary},
};

/// Put results of several cards or machines side by side on one page
///
/// Every row keeps its adapter. Its id gets the suffix `@CARD`, where CARD is the name of the adapter in small
/// letters, with a number where two results have the same. Parts of one run, made by --shard, are joined by
/// `grotto merge` instead.
#[derive(Args)]
pub struct Arguments {
    /// The folders of the results
    #[arg(value_name = "DIR", required = true, num_args = 2..)]
    results: Vec<PathBuf>,
    /// The folder for the merged result, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace results that the folder holds
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    run: RunOptions,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let reports = read_all(&arguments.results)?;
    for (path, report) in &reports {
        if !report.shard.is_whole() {
            return Err(Failure::bad_input(format!(
                "{} is part {} of a run: join its parts first, with `grotto merge`",
                path.display(),
                report.shard
            )));
        }
        if !report.parts.is_empty() {
            return Err(Failure::bad_input(format!(
                "{} is merged already: name the results that it was made of",
                path.display()
            )));
        }
    }
    refuse_inputs_as_output(&arguments.results, &arguments.out)?;
    let files = Files::new(&arguments.out, arguments.overwrite)?;
    let (merged, suffixes) = side_by_side(reports.iter().map(|(_, report)| report));
    join_frames(&arguments.results, &suffixes, &arguments.out, &merged)?;
    files.write(&merged)?;
    if arguments.run.json {
        return output::print_json(&merged);
    }
    output::print(&summary(&merged))
}

/// Joins the parts of one run, in any order, into the report that the whole run would have written: for `grotto
/// merge`.
///
/// # Errors
/// For parts that are missing or given twice, by their numbers; for parts of different runs; for a folder that
/// already holds results; and for files that cannot be read or written.
pub fn join(parts: &[PathBuf], out: &Path) -> Result<(), Failure> {
    let mut reports = read_all(parts)?;
    reports.sort_by_key(|(_, report)| report.shard.index);
    let shards: Vec<Shard> = reports.iter().map(|(_, report)| report.shard).collect();
    Shard::check_complete(&shards).map_err(Failure::bad_input)?;
    refuse_inputs_as_output(parts, out)?;
    refuse_strangers(&reports)?;
    let files = Files::new(out, false)?;
    let joined = joined(reports.iter().map(|(_, report)| report));
    let folders: Vec<PathBuf> = reports.iter().map(|(path, _)| path.clone()).collect();
    let suffixes = vec![String::new(); folders.len()];
    join_frames(&folders, &suffixes, out, &joined)?;
    files.write(&joined)
}

fn read_all(folders: &[PathBuf]) -> Result<Vec<(PathBuf, Report)>, Failure> {
    let read = |path: &PathBuf| Ok((path.clone(), Report::read(path)?));
    folders.iter().map(read).collect()
}

fn refuse_inputs_as_output(inputs: &[PathBuf], out: &Path) -> Result<(), Failure> {
    let real = |path: &Path| path.canonicalize().ok();
    let same = inputs
        .iter()
        .find(|input| real(input).is_some() && real(input) == real(out));
    match same {
        None => Ok(()),
        Some(input) => Err(Failure::bad_input(format!(
            "--out is {}, one of the results to be merged: name another folder",
            input.display()
        ))),
    }
}

/// Joins the frames of those reports that have them.
fn join_frames(
    folders: &[PathBuf],
    suffixes: &[String],
    out: &Path,
    report: &Report,
) -> Result<(), Failure> {
    let logs: Vec<(PathBuf, String)> = folders
        .iter()
        .zip(suffixes)
        .map(|(path, suffix)| {
            let folder = if path.is_dir() {
                path.as_path()
            } else {
                path.parent().unwrap_or(path)
            };
            (folder.join(FRAMES), suffix.clone())
        })
        .filter(|(log, _)| log.exists())
        .collect();
    let about = format!("grotto bench {}, started {}", report.suite, report.started);
    join_logs(&logs, &out.join(FRAMES), &about)
}

/// # Errors
/// When the parts are not of one run: if suite, build, machine, adapter or world differ.
fn refuse_strangers(reports: &[(PathBuf, Report)]) -> Result<(), Failure> {
    let Some(((first_path, first), others)) = reports.split_first() else {
        return Ok(());
    };
    for (path, other) in others {
        let same_worlds = other.worlds.iter().all(|world| {
            // A suite may have one world at several sizes, with several seeds and with other lamps.
            let is_same = |known: &&WorldRecord| {
                (&known.name, known.size, known.seed) == (&world.name, world.size, world.seed)
            };
            let mut known = first.worlds.iter().filter(is_same).peekable();
            known.peek().is_none() || known.any(|known| known.hash == world.hash)
        });
        let adapter = |report: &Report| report.rows.first().map(|row| row.adapter.clone());
        let same_adapter = match (adapter(first), adapter(other)) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        };
        let differences = [
            (
                first.suite == other.suite && first.quick == other.quick,
                "another suite",
            ),
            (first.build == other.build, "another build"),
            (first.machine.cpu == other.machine.cpu, "another CPU"),
            (same_adapter, "another adapter"),
            (same_worlds, "other worlds"),
        ];
        if let Some((_, what)) = differences.iter().find(|(same, _)| !same) {
            return Err(Failure::bad_input(format!(
                "{} and {} are not parts of one run: {what}; `grotto bench merge` puts different results side by \
                 side",
                first_path.display(),
                path.display()
            )));
        }
        if let Some(row) = other
            .rows
            .iter()
            .find(|row| first.rows.iter().any(|known| known.id == row.id))
        {
            return Err(Failure::bad_input(format!(
                "{} and {} both have the row {}: they are not parts of one run",
                first_path.display(),
                path.display(),
                row.id
            )));
        }
    }
    Ok(())
}

/// One report from parts that are sorted by number.
fn joined<'a>(parts: impl Iterator<Item = &'a Report> + Clone) -> Report {
    let mut whole = parts
        .clone()
        .next()
        .expect("checked to be complete")
        .clone();
    whole.shard = Shard::WHOLE;
    whole.complete = parts.clone().all(|part| part.complete);
    whole.elapsed_s = parts.clone().map(|part| part.elapsed_s).sum();
    // The option that selected a part does not belong to the whole.
    whole.command = without_shard(&whole.command);
    whole.machine.gpu_after = parts.clone().last().and_then(|part| part.machine.gpu_after);
    if let Some(earliest) = parts.clone().map(|part| &part.started).min() {
        whole.started.clone_from(earliest);
    }
    whole.rows = dealt(parts.clone().map(|part| part.rows.clone()).collect());
    whole.rows.sort_by_key(|row| row.place);
    // What could not be measured in any part is listed in every part.
    whole.missing = dealt(parts.clone().map(|part| part.missing.clone()).collect());
    whole.missing.dedup();
    whole.worlds.clear();
    for world in parts.flat_map(|part| &part.worlds) {
        match whole
            .worlds
            .iter_mut()
            .find(|known| known.hash == world.hash)
        {
            None => whole.worlds.push(world.clone()),
            Some(known) if known.picture.is_none() => known.picture.clone_from(&world.picture),
            Some(_) => {}
        }
    }
    whole
}

/// Takes one item of each part in turn, as `--shard` deals them out.
fn dealt<T>(parts: Vec<Vec<T>>) -> Vec<T> {
    let mut parts: Vec<_> = parts.into_iter().map(Vec::into_iter).collect();
    let mut all = Vec::new();
    loop {
        let before = all.len();
        all.extend(parts.iter_mut().filter_map(Iterator::next));
        if all.len() == before {
            return all;
        }
    }
}

fn without_shard(command: &[String]) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = command.iter();
    while let Some(word) = words.next() {
        if word == "--shard" {
            words.next();
        } else if !word.starts_with("--shard=") {
            kept.push(word.clone());
        }
    }
    kept
}

/// One report from several, and the suffix of the row ids of each.
fn side_by_side<'a>(reports: impl Iterator<Item = &'a Report> + Clone) -> (Report, Vec<String>) {
    let mut merged = reports
        .clone()
        .next()
        .expect("at least two are named")
        .clone();
    let suites: Vec<&str> = reports
        .clone()
        .map(|report| report.suite.as_str())
        .collect();
    if suites.iter().any(|suite| *suite != suites[0]) {
        merged.suite = "merged".to_owned();
    }
    merged.complete = reports.clone().all(|report| report.complete);
    merged.quick = reports.clone().any(|report| report.quick);
    merged.elapsed_s = reports.clone().map(|report| report.elapsed_s).sum();
    (merged.rows, merged.missing, merged.worlds, merged.parts) = Default::default();
    let mut suffixes = Vec::new();
    for report in reports {
        let label = free_label(report, &merged.parts);
        let suffix = format!("@{label}");
        merged.rows.extend(report.rows.iter().map(|row| Row {
            id: format!("{}{suffix}", row.id),
            ..row.clone()
        }));
        merged
            .missing
            .extend(report.missing.iter().map(|missing| Missing {
                id: format!("{}{suffix}", missing.id),
                ..missing.clone()
            }));
        merged.parts.push(part(label, report));
        suffixes.push(suffix);
        for world in &report.worlds {
            let known = merged
                .worlds
                .iter()
                .any(|known| known.name == world.name && known.hash == world.hash);
            if !known {
                merged.worlds.push(world.clone());
            }
        }
    }
    (merged, suffixes)
}

fn part(label: String, report: &Report) -> Part {
    Part {
        label,
        suite: report.suite.clone(),
        complete: report.complete,
        quick: report.quick,
        command: report.command.clone(),
        started: report.started.clone(),
        elapsed_s: report.elapsed_s,
        build: report.build.clone(),
        machine: report.machine.clone(),
    }
}

/// The adapter's name in small letters, with a number if the name is taken.
fn free_label(report: &Report, taken: &[Part]) -> String {
    let name = report
        .rows
        .first()
        .map_or("nothing", |row| &row.adapter.name);
    let words = name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    let plain = words.collect::<Vec<_>>().join("-").to_ascii_lowercase();
    let mut label = plain.clone();
    let mut number = 1;
    while taken.iter().any(|part| part.label == label) {
        number += 1;
        label = format!("{plain}-{number}");
    }
    label
}

#[cfg(test)]
mod tests {
    use super::{super::made_up, *};

    /// The made-up report as `count` parts, in folders.
    fn parts(folder: &Path, count: u32) -> Vec<PathBuf> {
        let whole = numbered();
        (1..=count)
            .map(|index| {
                let shard = Shard { index, count };
                let rows = whole
                    .rows
                    .iter()
                    .enumerate()
                    .filter(|(piece, _)| shard.has(*piece));
                let part = Report {
                    shard,
                    rows: rows.map(|(_, row)| row.clone()).collect(),
                    command: vec![
                        "bench".into(),
                        "all".into(),
                        "--shard".into(),
                        shard.to_string(),
                    ],
                    elapsed_s: 10.0,
                    ..whole.clone()
                };
                let path = folder.join(format!("part{index}"));
                let files = Files::new(&path, false).expect("a new folder");
                files.write(&part).expect("writable");
                let mut log = files.frame_log("").expect("writable");
                for row in &part.rows {
                    log.run(&row.id, 0, &[]).expect("room");
                }
                log.finish().expect("room");
                path
            })
            .collect()
    }

    fn numbered() -> Report {
        let mut whole = made_up::report();
        for (place, row) in whole.rows.iter_mut().enumerate() {
            row.place = place as u32;
        }
        whole.command = vec!["bench".to_owned(), "all".to_owned()];
        whole
    }

    #[test]
    fn parts_become_the_whole_whatever_their_order() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut paths = parts(folder.path(), 3);
        paths.rotate_left(1);
        let out = folder.path().join("whole");
        join(&paths, &out).expect("all parts");
        let expected = Report {
            elapsed_s: 30.0,
            ..numbered()
        };
        // Not `assert_eq`: a report fills screens.
        assert!(Report::read(&out).expect("joined") == expected);
        assert!(out.join(FRAMES).exists());
    }

    fn alter(folder: &Path, change: fn(&mut Report)) {
        let mut report = Report::read(folder).expect("a part");
        change(&mut report);
        let files = Files::new(folder, true).expect("to be overwritten");
        files.write(&report).expect("writable");
    }

    #[test]
    fn missing_doubled_and_foreign_parts_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let paths = parts(folder.path(), 3);
        let out = folder.path().join("whole");
        let refused = |paths: &[PathBuf], part: &str| {
            let failure = join(paths, &out).expect_err(part);
            assert_eq!(failure.exit_code(), 2);
            assert!(failure.reason().contains(part), "{failure}");
            assert!(!out.exists(), "nothing is left");
        };
        refused(&[paths[0].clone(), paths[2].clone()], "2/3 is missing");
        let doubled = [&paths[..], &paths[1..2]].concat();
        refused(&doubled, "2/3 is there 2 times");
        alter(&paths[1], |report| report.build.commit = "else".to_owned());
        refused(&paths, "another build");
        alter(&paths[1], |report| {
            report.build = made_up::report().build;
            report.rows = made_up::report().rows;
        });
        refused(&paths, "both have the row");
        let failure = join(&paths, &paths[0]).expect_err("one of them");
        assert!(failure.reason().contains("--out"), "{failure}");
    }

    /// `bench all` measures the cave as it is, and with lamps of the bench's own.
    #[test]
    fn a_world_is_no_stranger_for_being_there_with_other_lamps() {
        let folder = tempfile::tempdir().expect("a folder");
        let paths = parts(folder.path(), 3);
        for path in &paths {
            alter(path, |report| {
                let mut lit = report.worlds[0].clone();
                lit.hash = "e".repeat(32);
                report.worlds.push(lit);
            });
        }
        let out = folder.path().join("whole");
        join(&paths, &out).expect("parts of one run");
        assert_eq!(Report::read(&out).expect("the whole").worlds.len(), 2);
        alter(&paths[1], |report| report.worlds[0].hash = "f".repeat(32));
        let failure = join(&paths, &folder.path().join("other")).expect_err("an edited world");
        assert!(failure.reason().contains("other worlds"), "{failure}");
    }

    #[test]
    fn one_world_at_two_sizes_is_there_twice() {
        let one = made_up::report();
        let mut two = made_up::report();
        two.worlds[0].size = [1024, 512, 1024];
        two.worlds[0].hash = "e".repeat(32);
        let whole = joined([&one, &two].into_iter());
        assert_eq!(whole.worlds, [one.worlds, two.worlds].concat());
    }

    #[test]
    fn cards_stand_side_by_side_under_names_of_their_own() {
        let mut second = made_up::report();
        second.machine.cpu = "CPU 8".to_owned();
        let mut third = made_up::report();
        for row in &mut third.rows {
            row.adapter.name = "Other (TM) 1".to_owned();
        }
        third.suite = "layouts".to_owned();
        let all = [made_up::report(), second, third];
        let (merged, suffixes) = side_by_side(all.iter());
        assert_eq!(suffixes, ["@card-9000", "@card-9000-2", "@other-tm-1"]);
        assert_eq!(merged.rows.len(), 36);
        let mut ids: Vec<&str> = merged.rows.iter().map(|row| row.id.as_str()).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 36, "no id twice");
        assert_eq!(merged.suite, "merged");
        assert_eq!(merged.worlds.len(), 1);
        let machine = |row: usize| merged.machine_of(&merged.rows[row]).cpu.as_str();
        assert_eq!(
            [machine(0), machine(12), machine(24)],
            ["CPU 64", "CPU 8", "CPU 64"]
        );
    }
}
