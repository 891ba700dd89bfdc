//! How much work a picture gets: presets, and the control that holds a frame time.
//!
//! A [`Preset`] is a choice of parameters, the picture's scale among them. [`Auto`] works below it: it chooses an
//! [`Effort`], a share of the preset's scale, rays and faces, from the times of frames. An effort is no parameter and no
//! input of a run: neither saves nor records know it.

mod auto;
mod effort;
mod preset;

use std::{fmt, str::FromStr};

pub use auto::Auto;
pub use effort::Effort;
pub use preset::Preset;

use serde::{Deserialize, Serialize};

/// What a user chose, as `--quality` and the settings write it: `low`, `auto`, `low+auto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Quality {
    /// `None`: by the adapter.
    pub preset: Option<Preset>,
    /// Whether to do less than the preset where frames would take too long.
    pub auto: bool,
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            preset: None,
            auto: true,
        }
    }
}

impl Quality {
    /// The preset on an adapter.
    pub fn preset_on(self, is_software: bool) -> Preset {
        self.preset.unwrap_or(if is_software {
            Preset::Low
        } else {
            Preset::High
        })
    }
}

impl From<Quality> for String {
    fn from(quality: Quality) -> Self {
        quality.to_string()
    }
}

impl TryFrom<String> for Quality {
    type Error = UnknownQuality;

    fn try_from(text: String) -> Result<Self, UnknownQuality> {
        text.parse()
    }
}

const AUTO: &str = "auto";

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.preset, self.auto) {
            // Without either, the adapter decides on the preset alone: no text of its own is needed for that.
            (None, _) => f.write_str(AUTO),
            (Some(preset), false) => f.write_str(preset.name()),
            (Some(preset), true) => write!(f, "{}+{AUTO}", preset.name()),
        }
    }
}

/// A text that names no quality.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no quality is called `{0}`; there are low, medium, high, ultra, auto, and low+auto")]
pub struct UnknownQuality(String);

impl FromStr for Quality {
    type Err = UnknownQuality;

    fn from_str(text: &str) -> Result<Self, UnknownQuality> {
        if text == AUTO {
            return Ok(Self::default());
        }
        let (name, auto) = match text.strip_suffix("+auto") {
            Some(name) => (name, true),
            None => (text, false),
        };
        let mut presets = Preset::ALL.into_iter();
        let preset = presets
            .find(|preset| preset.name() == name)
            .ok_or_else(|| UnknownQuality(text.to_owned()))?;
        Ok(Self {
            preset: Some(preset),
            auto,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_can_be_read() {
        let mut all = vec![Quality::default()];
        for preset in Preset::ALL.map(Some) {
            all.extend([false, true].map(|auto| Quality { preset, auto }));
        }
        for quality in all {
            assert_eq!(quality.to_string().parse(), Ok(quality));
        }
    }

    #[test]
    fn what_names_nothing_is_refused_with_what_would() {
        for text in ["hihg", "auto+low", "low+", "Low", ""] {
            let error = text.parse::<Quality>().expect_err(text).to_string();
            assert!(error.contains(&format!("`{text}`")), "{error}");
            assert!(error.contains("medium"), "{error}");
        }
    }

    #[test]
    fn the_adapter_chooses_where_nobody_did() {
        let quality = Quality::default();
        assert_eq!(quality.preset_on(true), Preset::Low);
        assert_eq!(quality.preset_on(false), Preset::High);
    }
}
