//! Keys of earlier versions, and their replacements.

/// A removed key, and what replaces it.
const REMOVED: [(&str, &str); 26] = [
    (
        "probes.asking",
        "use probes.states=off to update all probes",
    ),
    ("probes.restless", "it is called probes.variability now"),
    ("probes.twin_share", FIXED),
    ("probes.contact", NO_GAIN),
    ("probes.near_hits", NO_GAIN),
    (
        "probes.budget",
        "use fewer probes.rays, or a coarser layout",
    ),
    (
        "probes.weights",
        "use probes.method=source and source.weights",
    ),
    (
        "probes.long_rays",
        "use probes.method=source and source.depth",
    ),
    ("probes.stone_hysteresis", FIXED),
    ("probes.stone_threshold", FIXED),
    (
        "probes.clearance",
        "use probes.method=source and source.relocation=clear",
    ),
    ("probes.indirect_interval", FIXED),
    ("probes.still_interval", FIXED),
    ("probes.asleep_interval", FIXED),
    ("probes.still_hysteresis", FIXED),
    ("probes.move_reach", FIXED),
    ("probes.distance_sharpness", FIXED),
    ("probes.distance_clamp", FIXED),
    ("probes.view_bias", FIXED),
    ("probes.wrap_offset", FIXED),
    ("probes.crush", FIXED),
    ("probes.chebyshev_power", FIXED),
    ("probes.chebyshev_floor", FIXED),
    ("probes.least_weight", FIXED),
    ("probes.cascade_fade", FIXED),
    ("probes.change_unrest", FIXED),
];

const FIXED: &str = "its default is a constant now";
const NO_GAIN: &str = "the final gather made it unnecessary, so leave it out";

/// What to write in place of a removed key.
pub fn instead_of(name: &str) -> Option<&'static str> {
    let found = REMOVED.iter().find(|(removed, _)| *removed == name);
    found.map(|(_, instead)| *instead)
}

/// The same for a removed value of a key that still exists.
pub fn instead_of_value(name: &str, value: &str) -> Option<&'static str> {
    match (name, value) {
        ("probes.relocation", "statistical") => {
            Some("use probes.method=source and source.relocation=surface")
        }
        ("probes.visibility", "none") => {
            Some("use probes.method=source and source.weights=direction")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{KEYS, Parameters};

    #[test]
    fn replacements_of_old_keys_are_keys() {
        for (removed, instead) in REMOVED {
            assert!(KEYS.iter().all(|key| key.name != removed), "{removed}");
            for word in instead
                .split([' ', '=', ','])
                .filter(|word| word.contains('.'))
            {
                assert!(KEYS.iter().any(|key| key.name == word), "{removed}: {word}");
            }
        }
    }

    #[test]
    fn old_keys_and_values_name_their_replacements() {
        for (assignment, expected) in [
            ("probes.weights=adjusted", "source.weights"),
            ("probes.crush=0.1", FIXED),
            ("probes.relocation=statistical", "source.relocation=surface"),
            ("probes.visibility=none", "source.weights=direction"),
        ] {
            let refused = Parameters::default().set(assignment).expect_err("no key");
            let message = refused.to_string();
            assert!(message.contains(expected), "{assignment}: {message}");
        }
    }
}
