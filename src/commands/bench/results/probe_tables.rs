//! What the terminal shows of the suites `probes` and `hits`: one line for each way of placing probes.

use super::super::model::Row;
use crate::measure::plot::figure;

/// The columns of the suite `probes` after the name.
pub const PROBES: [&str; 12] = [
    "probes", "alive", "MB", "update", "gather", "FPS", "FLIP", "energy", "alone:", "FPS", "FLIP",
    "energy",
];

/// The cells of a row of the suite `probes`. After `alone:`, which has the time of its gather, are the figures without the
/// final gather.
pub fn probe_cells(row: &Row) -> Vec<Vec<String>> {
    let own = |name: &str| row.figures.get(name).map(|figure| figure.value);
    let shown = |value: Option<f64>| value.map_or(String::new(), figure);
    let fixed = |value: Option<f64>, digits: usize| {
        value.map_or(String::new(), |value| format!("{value:.digits$}"))
    };
    let quality = row.quality.as_ref();
    let bytes = row.memory_bytes.get("probes");
    vec![vec![
        row.probes
            .map_or(String::new(), |probes| probes.total.to_string()),
        row.probes
            .map_or(String::new(), |probes| probes.alive.to_string()),
        fixed(bytes.map(|bytes| *bytes as f64 / 1e6), 1),
        fixed(own("update_ms"), 3),
        fixed(own("gather_ms"), 3),
        shown(row.fps),
        fixed(quality.map(|quality| quality.flip), 4),
        fixed(quality.and_then(|quality| quality.energy), 3),
        fixed(own("alone_gather_ms"), 3),
        shown(own("alone_fps")),
        fixed(own("alone_flip"), 4),
        fixed(own("alone_energy"), 3),
    ]]
}

/// The columns of the suite `hits` after the name: a sample each.
pub const HITS: [&str; 7] = ["0", "100", "200", "300", "400", "500", "600"];

/// Probes and the shares of their rays that hit anything and their own leaf, by frame.
pub fn hit_cells(row: &Row) -> Vec<Vec<String>> {
    let sample = |frame: &&str| {
        let own = |what: &str| {
            let found = row.figures.get(&format!("{what}_{frame:0>3}"));
            found.map(|figure| figure.value)
        };
        // With --quick there are fewer samples.
        match (own("probes"), own("hits"), own("leaf_hits")) {
            (Some(probes), Some(hits), Some(leaf)) => format!("{probes} {hits:.3} {leaf:.3}"),
            _ => String::new(),
        }
    };
    vec![HITS.iter().map(sample).collect()]
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn every_figure_has_its_column() {
        let mut row = made_up::row("probes/cornell/layout1/moving", 2.0);
        for (name, value) in [("update_ms", 0.25), ("alone_flip", 0.0625)] {
            let figure = made_up::figure_row("a/b/c/d", name, value).figures[name];
            row.figures.insert(name.to_owned(), figure);
        }
        let [cells] = &probe_cells(&row)[..] else {
            panic!("one line")
        };
        assert_eq!(cells.len(), PROBES.len());
        let of = |column: usize| (PROBES[column], cells[column].as_str());
        assert_eq!((of(3), of(4)), (("update", "0.250"), ("gather", "")));
        assert_eq!((of(5), of(10)), (("FPS", "500"), ("FLIP", "0.0625")));
    }

    #[test]
    fn samples_stand_below_their_frames() {
        let mut row = made_up::figure_row("hits/cornell/depth 2/kept", "probes_100", 64.0);
        for (name, value) in [("hits_100", 0.75), ("leaf_hits_100", 0.5)] {
            let figure = made_up::figure_row("a/b/c/d", name, value).figures[name];
            row.figures.insert(name.to_owned(), figure);
        }
        let cells = &hit_cells(&row)[0];
        assert_eq!(cells.len(), HITS.len());
        assert_eq!(cells[0..3], ["", "64 0.750 0.500", ""]);
    }
}
