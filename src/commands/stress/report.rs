//! `stress.json`: which scenes were examined and which failed. Nothing in it depends on time, on chance, or on
//! how the work was divided, so merged parts equal the whole. Times are in `times.json`.

use std::{collections::BTreeMap, fmt::Write as _, fs, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    super::{Failure, out_file::OutFile, shard::Shard},
    checks::{Check, Findings},
    known::Known,
};
use crate::gpu::AdapterSummary;

/// Identifies the kind of file.
pub const KIND: &str = "grotto stress";
/// Raised when a key changes its meaning or is removed.
pub const SCHEMA: u32 = 1;
/// Name of the report in its folder.
pub const FILE: &str = "stress.json";
pub const TIMES: &str = "times.json";
/// Name of the folder for scenes that fail.
pub const FAILURES: &str = "failures";

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    pub kind: String,
    pub schema: u32,
    /// Version of grotto.
    pub version: String,
    pub adapter: Adapter,
    /// Seed of the first scene, and the requested number of scenes.
    pub seed: u32,
    pub scenes: u32,
    /// The world that was examined in place of generated ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<String>,
    /// Parameters that were set in every scene.
    pub set: Vec<String>,
    /// The part of the scenes that was examined; left out if there is only one part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// Whether every scene was examined.
    pub complete: bool,
    /// Examined scenes, including those with known failures.
    pub examined: u32,
    /// Verdicts of each check.
    pub checks: BTreeMap<Check, Count>,
    pub failures: Vec<Row>,
    /// Failures that are on the list of known failures.
    pub known: Vec<Row>,
    /// Entries of that list that pass: remove them from the list.
    pub cured: Vec<Row>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adapter {
    pub name: String,
    pub kind: String,
    pub driver: String,
    pub backend: String,
}

impl From<&AdapterSummary> for Adapter {
    fn from(summary: &AdapterSummary) -> Self {
        Self {
            name: summary.name.clone(),
            kind: summary.kind.to_owned(),
            driver: summary.driver.clone(),
            backend: summary.backend.clone(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Count {
    pub passed: u32,
    pub failed: u32,
    pub known: u32,
}

/// The verdict of one check for one scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Position of the scene in the run.
    pub index: u32,
    pub scene: String,
    pub seed: u32,
    pub check: Check,
    /// The failure of the simplest scene that still fails.
    pub message: String,
    /// The file of that scene, in the folder of the report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The command that reproduces the failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Why the failure is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Report {
    /// Counts the verdicts of a scene, and returns the failed checks that are not known failures.
    pub fn count(
        &mut self,
        index: u32,
        scene: (&str, u32),
        findings: &Findings,
        known: &Known,
    ) -> Vec<Check> {
        self.examined += 1;
        let (name, seed) = scene;
        let row = |check, message: &str, reason: &str| Row {
            index,
            scene: name.to_owned(),
            seed,
            check,
            message: message.to_owned(),
            file: None,
            command: None,
            reason: Some(reason.to_owned()),
        };
        let mut failed = Vec::new();
        for (&check, verdict) in &findings.0 {
            let count = self.checks.entry(check).or_default();
            match (verdict, known.reason(name, check)) {
                (Ok(()), _) => count.passed += 1,
                (Err(message), Some(reason)) => {
                    count.known += 1;
                    self.known.push(row(check, message, reason));
                }
                (Err(_), None) => {
                    count.failed += 1;
                    failed.push(check);
                }
            }
        }
        for (check, reason) in known.checks(name) {
            if findings.failure(check).is_none() {
                self.cured.push(row(check, "passes", reason));
            }
        }
        self.sort();
        failed
    }

    pub fn sort(&mut self) {
        for rows in [&mut self.failures, &mut self.known, &mut self.cured] {
            rows.sort_by_key(|row| (row.index, row.check));
        }
    }

    /// Fails if any failure is not known.
    pub fn verdict(&self) -> Result<(), Failure> {
        if self.failures.is_empty() && self.cured.is_empty() {
            return Ok(());
        }
        let mut message = format!("{} unknown failures", self.failures.len());
        if let Some(row) = self.failures.first() {
            let _ = write!(message, "; {} fails `{}`", row.scene, row.check.name());
        }
        if let Some(row) = self.cured.first() {
            let _ = write!(
                message,
                "; {} known failures pass, {} `{}` first: take them from tests/cli/stress/known.ron",
                self.cured.len(),
                row.scene,
                row.check.name()
            );
        }
        Err(Failure::gate(message))
    }

    /// The report as text for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<12}{:>8}{:>8}{:>8}\n",
            "check", "passed", "failed", "known"
        );
        for (check, count) in &self.checks {
            let Count {
                passed,
                failed,
                known,
            } = count;
            let _ = writeln!(text, "{:<12}{passed:>8}{failed:>8}{known:>8}", check.name());
        }
        for row in &self.failures {
            let _ = writeln!(
                text,
                "\n{} fails `{}`: {}",
                row.scene,
                row.check.name(),
                row.message
            );
            if let Some(command) = &row.command {
                let _ = writeln!(text, "    {command}");
            }
        }
        for row in &self.cured {
            let _ = writeln!(
                text,
                "\n{} passes `{}`, and is listed as known",
                row.scene,
                row.check.name()
            );
        }
        let all = if self.complete { "" } else { ", not all" };
        let adapter = &self.adapter;
        let _ = writeln!(
            text,
            "\n{} scenes{all} on {} ({}): {} failures, {} known, {} of the known pass",
            self.examined,
            adapter.name,
            adapter.kind,
            self.failures.len(),
            self.known.len(),
            self.cured.len()
        );
        text
    }

    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        OutFile::new(folder, FILE)?.write_json(self)
    }

    /// Reads the report of a folder.
    ///
    /// # Errors
    /// For a file that is missing, damaged, of another kind, or newer.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(FILE);
        let unusable = |error: &dyn std::fmt::Display| {
            Failure::bad_input(format!("{}: {error}", path.display()))
        };
        let text = fs::read_to_string(&path).map_err(|reason| Failure::unread(&path, reason))?;
        let value: serde_json::Value = serde_json::from_str(&text)
            .map_err(|error| unusable(&format!("no report of grotto stress: {error}")))?;
        if value["kind"] != KIND {
            return Err(unusable(&"no report of grotto stress"));
        }
        if value["schema"].as_u64() != Some(u64::from(SCHEMA)) {
            return Err(unusable(&format!(
                "its schema is {}, and this grotto reads {SCHEMA}",
                value["schema"]
            )));
        }
        serde_json::from_value(value).map_err(|error| unusable(&format!("damaged: {error}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(verdict: Result<(), String>, known: &Known) -> (Report, Vec<Check>) {
        let mut report = Report {
            kind: KIND.to_owned(),
            schema: SCHEMA,
            version: String::new(),
            adapter: Adapter {
                name: String::new(),
                kind: String::new(),
                driver: String::new(),
                backend: String::new(),
            },
            seed: 0,
            scenes: 1,
            world: None,
            set: Vec::new(),
            shard: None,
            complete: true,
            examined: 0,
            checks: BTreeMap::new(),
            failures: Vec::new(),
            known: Vec::new(),
            cured: Vec::new(),
        };
        let mut findings = Findings::default();
        findings.note(Check::Dark, verdict);
        let failed = report.count(0, ("scene-0", 0), &findings, known);
        (report, failed)
    }

    #[test]
    fn a_known_failure_is_no_failure_until_it_passes() {
        let known = Known::of("scene-0", Check::Dark, "thin shell");
        let (report, failed) = counted(Err("light".to_owned()), &known);
        assert!(failed.is_empty() && report.verdict().is_ok());
        assert_eq!(report.known[0].reason.as_deref(), Some("thin shell"));
        let (report, _) = counted(Ok(()), &known);
        let refused = report.verdict().expect_err("it passes");
        assert_eq!(refused.exit_code(), 4);
        assert!(refused.to_string().contains("known.ron"), "{refused}");
        let (_, failed) = counted(Err("light".to_owned()), &Known::default());
        assert_eq!(failed, [Check::Dark]);
    }
}
