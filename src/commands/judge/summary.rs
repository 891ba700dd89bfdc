//! One line for each setting: the effect of a parameter on all pictures of a table.

use serde::Serialize;

use super::{super::settings::Setting, row::Row};

/// Means over the rows of one setting (maxima of maxima).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    pub settings: Setting,
    /// Whether these are rows of direct light alone.
    pub direct_alone: bool,
    /// Number of pictures that the means are taken over.
    pub rows: usize,
    pub flip_mean: f64,
    /// Sum over RGB of the absolute difference.
    pub abs_sum_mean: f64,
    pub abs_sum_max: f64,
    /// Error of the energy of bounced light: mean of |ratio − 1|. `null` where a reference has no bounced
    /// light.
    pub indirect_energy_error: f64,
    /// Mean over the rows that have a leak ratio.
    pub leak_ratio: Option<f64>,
    pub stability_mean: Option<f64>,
    pub stability_max: Option<f64>,
    /// Bytes of the probes on the adapter.
    pub probe_bytes: f64,
}

/// The settings in order of first appearance; empty if there is only one.
pub fn by_setting(rows: &[Row]) -> Vec<Summary> {
    let mut kinds: Vec<(&Setting, bool)> = Vec::new();
    for row in rows {
        let kind = (&row.settings, row.direct_alone);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    if kinds.len() < 2 {
        return Vec::new();
    }
    kinds.iter().map(|kind| summary(rows, *kind)).collect()
}

fn summary(rows: &[Row], (settings, direct_alone): (&Setting, bool)) -> Summary {
    let of_kind = |row: &&Row| row.settings == *settings && row.direct_alone == direct_alone;
    let rows: Vec<&Row> = rows.iter().filter(of_kind).collect();
    let known = |value: fn(&Row) -> Option<f64>| -> Vec<f64> {
        rows.iter().filter_map(|row| value(row)).collect()
    };
    let mean = |value: fn(&Row) -> Option<f64>| {
        let known = known(value);
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    };
    let most = |value: fn(&Row) -> Option<f64>| known(value).into_iter().reduce(f64::max);
    let always = "every setting has a row, and every row has these figures";
    Summary {
        settings: settings.clone(),
        direct_alone,
        rows: rows.len(),
        flip_mean: mean(|row| Some(row.full.flip.mean)).expect(always),
        abs_sum_mean: mean(|row| Some(row.full.abs_sum.mean)).expect(always),
        abs_sum_max: most(|row| Some(row.full.abs_sum.max)).expect(always),
        indirect_energy_error: mean(|row| Some((row.indirect.energy_ratio - 1.0).abs()))
            .expect(always),
        leak_ratio: mean(|row| row.leak_ratio),
        stability_mean: mean(|row| Some(row.stability?.mean)),
        stability_max: most(|row| Some(row.stability?.max)),
        probe_bytes: mean(|row| Some(row.probe_bytes as f64)).expect(always),
    }
}
