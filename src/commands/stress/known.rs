//! Known failures: reported as known, and as cured when one of them passes.

use serde::Deserialize;

use super::checks::Check;

/// `tests/cli/stress/known.ron`, the only list.
const LIST: &str = include_str!("../../../tests/cli/stress/known.ron");

/// Scenes that fail, and why they are not fixed yet.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    failures: Vec<Entry>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// `scene-17` is made from seed 17.
    scene: String,
    check: Check,
    reason: String,
}

impl Known {
    /// The list of this build.
    ///
    /// # Panics
    /// When the list cannot be read. A test ensures that it can.
    pub fn list() -> Self {
        ron::from_str(LIST).expect("the list of known failures is valid")
    }

    /// A list of one failure, for tests.
    pub fn of(scene: &str, check: Check, reason: &str) -> Self {
        Self {
            failures: vec![Entry {
                scene: scene.to_owned(),
                check,
                reason: reason.to_owned(),
            }],
        }
    }

    /// Why a scene is known to fail a check.
    pub fn reason(&self, scene: &str, check: Check) -> Option<&str> {
        let mut entries = self.failures.iter();
        let found = entries.find(|entry| entry.scene == scene && entry.check == check);
        found.map(|entry| entry.reason.as_str())
    }

    /// The checks that a scene is known to fail.
    pub fn checks(&self, scene: &str) -> impl Iterator<Item = (Check, &str)> {
        let entries = self
            .failures
            .iter()
            .filter(move |entry| entry.scene == scene);
        entries.map(|entry| (entry.check, entry.reason.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_can_be_read_and_gives_reasons() {
        for entry in Known::list().failures {
            assert!(!entry.reason.is_empty(), "{entry:?}");
        }
    }

    #[test]
    fn a_failure_is_known_by_scene_and_check() {
        let known = Known::of("scene-3", Check::Dark, "why");
        assert_eq!(known.reason("scene-3", Check::Dark), Some("why"));
        assert_eq!(known.reason("scene-3", Check::Band), None);
        assert_eq!(known.reason("scene-4", Check::Dark), None);
    }
}
