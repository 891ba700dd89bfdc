//! Conditions that must hold for every scene. `docs/stress.md` gives each check's bound and its origin.

pub mod darkness;
pub mod energy;
pub mod finite;
pub mod marching;
pub mod memory;
pub mod reference;
pub mod voxels;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A check, with its name in reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// `grotto check` accepts the generated world.
    Loads,
    /// Everything is built and rendered without an error or a panic.
    Runs,
    /// No validation error of wgpu.
    Validation,
    /// The GPU's voxels equal the CPU's, except for rounding.
    Voxels,
    /// The brick map keeps its invariants: octant distances equal those of a fresh build.
    Distances,
    /// Marching finds the same hits as steps of one voxel.
    Marching,
    /// After edits the GPU's voxels equal the CPU's copy.
    Edits,
    /// No NaN, no infinity and no negative light.
    Finite,
    /// No light above the furnace bound.
    Energy,
    /// No light where none can arrive.
    Dark,
    /// The picture is near a path-traced reference.
    Band,
    /// A second rendering gives the same bytes.
    Repeat,
    /// All memory is released.
    Memory,
    /// No more memory than predicted.
    Predicted,
    /// No dispatch holds a GPU for long.
    Dispatch,
    /// The scene takes no longer than the limit.
    Time,
}

impl Check {
    pub const ALL: [Self; 16] = [
        Self::Loads,
        Self::Runs,
        Self::Validation,
        Self::Voxels,
        Self::Distances,
        Self::Marching,
        Self::Edits,
        Self::Finite,
        Self::Energy,
        Self::Dark,
        Self::Band,
        Self::Repeat,
        Self::Memory,
        Self::Predicted,
        Self::Dispatch,
        Self::Time,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Loads => "loads",
            Self::Runs => "runs",
            Self::Validation => "validation",
            Self::Voxels => "voxels",
            Self::Distances => "distances",
            Self::Marching => "marching",
            Self::Edits => "edits",
            Self::Finite => "finite",
            Self::Energy => "energy",
            Self::Dark => "dark",
            Self::Band => "band",
            Self::Repeat => "repeat",
            Self::Memory => "memory",
            Self::Predicted => "predicted",
            Self::Dispatch => "dispatch",
            Self::Time => "time",
        }
    }
}

/// The verdicts of a scene's checks; checks that do not apply to the scene are missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings(pub BTreeMap<Check, Result<(), String>>);

impl Findings {
    /// Adds a verdict; the first failure of a check is kept.
    pub fn note(&mut self, check: Check, verdict: Result<(), String>) {
        let known = self.0.entry(check).or_insert(Ok(()));
        if known.is_ok() {
            *known = verdict;
        }
    }

    /// Why a check failed, if it did.
    pub fn failure(&self, check: Check) -> Option<&str> {
        self.0.get(&check)?.as_ref().err().map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_file_and_unique() {
        for check in Check::ALL {
            let json = serde_json::to_string(&check).expect("JSON");
            assert_eq!(json, format!("\"{}\"", check.name()));
            assert_eq!(
                Check::ALL
                    .iter()
                    .filter(|other| other.name() == check.name())
                    .count(),
                1
            );
        }
    }

    #[test]
    fn the_first_bad_verdict_stays() {
        let mut findings = Findings::default();
        for verdict in [
            Ok(()),
            Err("first".to_owned()),
            Ok(()),
            Err("second".to_owned()),
        ] {
            findings.note(Check::Finite, verdict);
        }
        assert_eq!(findings.failure(Check::Finite), Some("first"));
        assert_eq!(findings.failure(Check::Dark), None);
    }
}
