//! Joins the parts of `grotto stress --shard I/N` into the report that one run would have written, byte for
//! byte.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    super::{Failure, out_file::OutFile, shard::Shard},
    report::{FAILURES, Report},
};

/// Joins these parts in a folder.
///
/// # Errors
/// For parts that are not reports, or that are incomplete, missing or given twice (with their number); for
/// parts of different runs; and for a folder that is not empty.
pub fn join(parts: &[PathBuf], out: &Path) -> Result<(), Failure> {
    let reports: Vec<Report> = parts
        .iter()
        .map(|part| Report::read(part))
        .collect::<Result<_, _>>()?;
    let shards: Vec<Shard> = reports
        .iter()
        .map(|report| report.shard.unwrap_or(Shard::WHOLE))
        .collect();
    Shard::check_complete(&shards).map_err(Failure::bad_input)?;
    let mut whole = Report {
        shard: None,
        examined: 0,
        checks: Default::default(),
        failures: Vec::new(),
        known: Vec::new(),
        cured: Vec::new(),
        ..reports[0].clone()
    };
    for (path, report) in parts.iter().zip(&reports) {
        if !report.complete {
            return Err(Failure::bad_input(format!(
                "{}: this part was stopped before its end; run it again",
                path.display()
            )));
        }
        let frame = Report {
            shard: None,
            examined: 0,
            checks: Default::default(),
            failures: Vec::new(),
            known: Vec::new(),
            cured: Vec::new(),
            ..report.clone()
        };
        let first = Report {
            examined: 0,
            checks: Default::default(),
            failures: Vec::new(),
            known: Vec::new(),
            cured: Vec::new(),
            ..whole.clone()
        };
        if frame != first {
            return Err(Failure::bad_input(format!(
                "{} and {} are parts of different runs: adapter, version, seed, scenes and parameters must be the same",
                parts[0].display(),
                path.display()
            )));
        }
        whole.examined += report.examined;
        for (check, count) in &report.checks {
            let sum = whole.checks.entry(*check).or_default();
            sum.passed += count.passed;
            sum.failed += count.failed;
            sum.known += count.known;
        }
        whole.failures.extend(report.failures.iter().cloned());
        whole.known.extend(report.known.iter().cloned());
        whole.cured.extend(report.cured.iter().cloned());
    }
    whole.sort();
    super::scenes::refuse_results(out)?;
    for (path, report) in parts.iter().zip(&reports) {
        for file in report.failures.iter().filter_map(|row| row.file.as_ref()) {
            let from = path.join(file);
            let text =
                fs::read_to_string(&from).map_err(|reason| Failure::unread(&from, reason))?;
            let name = file.strip_prefix(&format!("{FAILURES}/")).unwrap_or(file);
            OutFile::new(&out.join(FAILURES), name)?.write(&text)?;
        }
    }
    whole.write(out)
}
