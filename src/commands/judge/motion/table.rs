//! The rows of motion as a table.

use super::{
    super::{
        super::dynamics::RATE,
        row::Row,
        table::{NAMES, Table, dash, ratio},
    },
    row::{Moment, MotionRow},
};

/// One row in one line, for output while the run is in progress.
pub fn line(row: &MotionRow) -> String {
    let over = row.over_rest.map_or(String::new(), |over| {
        format!(", {over:.2} times that at rest")
    });
    format!(
        "  {}: FLIP {:.4}{over}, indirect energy {:.3}",
        row.motion.name(),
        row.mean(|moment| moment.full.flip.mean),
        row.mean(|moment| moment.indirect.energy_ratio),
    )
}

/// A line for each motion of each row; `None` if nothing was judged in motion.
pub fn of_rows(rows: &[Row], varied: &[&'static str]) -> Option<Table> {
    let longest = rows.iter().flat_map(|row| &row.motion);
    let times = longest.max_by_key(|motion| motion.moments.len())?;
    let times: Vec<String> = times.moments.iter().map(seconds).collect();
    let names = NAMES.iter().map(|(name, _)| *name);
    let figures = [
        "motion",
        "FLIP",
        "worst FLIP",
        "at rest",
        "over rest",
        "noise",
        "relative MSE",
        "energy",
        "indirect energy",
    ];
    let heads = names.chain(varied.iter().copied()).chain(figures);
    let mut heads: Vec<String> = heads.map(str::to_owned).collect();
    heads.push(format!("FLIP after {} s", times.join("/")));
    let lines = rows.iter().flat_map(|row| {
        let mut names: Vec<String> = NAMES.iter().map(|(_, cell)| cell(row)).collect();
        let of_key = |key: &&'static str| row.settings.value(key).unwrap_or_else(dash);
        names.extend(varied.iter().map(of_key));
        let cells = |motion| [&names[..], &figures_of(motion)].concat();
        row.motion.iter().map(cells).collect::<Vec<_>>()
    });
    let lines = lines.collect();
    Some(Table::new(heads, lines, NAMES.len() + varied.len() + 1))
}

fn figures_of(row: &MotionRow) -> [String; 10] {
    let flip = |moment: &Moment| moment.full.flip.mean;
    let mut each: Vec<String> = row
        .moments
        .iter()
        .map(|moment| format!("{:.4}", flip(moment)))
        .collect();
    if row.moments.first().is_none_or(|first| first.frame > 0) {
        // What moves has no picture at the start.
        each.insert(0, dash());
    }
    [
        row.motion.name().to_owned(),
        format!("{:.4}", row.mean(flip)),
        format!("{:.4}", row.worst_flip()),
        format!("{:.4}", row.mean(|moment| moment.rest_flip)),
        row.over_rest.map_or_else(dash, |over| format!("{over:.2}")),
        row.noise().map_or_else(dash, |flip| format!("{flip:.4}")),
        format!("{:.5}", row.mean(|moment| moment.full.rel_mse)),
        ratio(row.mean(|moment| moment.full.energy_ratio)),
        ratio(row.mean(|moment| moment.indirect.energy_ratio)),
        each.join("/"),
    ]
}

/// Seconds since things began to move.
fn seconds(moment: &Moment) -> String {
    let text = format!("{:.2}", f64::from(moment.frame) / RATE);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The legend of the columns, in Markdown that is also valid in HTML.
pub const LEGEND: &str = "In motion: each judged frame is compared with a reference of that very moment. Rest: \
the world stands still at the first moment. Lamps: world time runs at 60 frames per second, and the lamps move. \
Camera: the camera flies and turns, and is back at its place at each judged moment. Both: lamps and camera move. \
Edits: whatever moves in the other rows, with a ball dug or built every tenth frame. Figures are means over the \
moments; the last column has the FLIP of each. At rest is the FLIP of as many frames of a world that stands \
still as at that moment; over rest is FLIP over that. Noise is the FLIP that a picture without any error would have \
against these references: more --spp lowers it.";

#[cfg(test)]
mod tests {
    use super::{
        super::{
            options::Motion,
            row::tests::{moment, moves},
        },
        *,
    };

    #[test]
    fn rows_that_move_have_no_picture_at_the_start() {
        let moved = vec![moment(30, 0.25, 0.1)];
        let moved = MotionRow::new(Motion::Both, moves(true, true), moved);
        let cells = figures_of(&moved);
        assert_eq!(
            cells[..6],
            ["both", "0.2500", "0.2500", "0.1000", "2.50", "0.1250"]
        );
        assert_eq!(cells[9], "–/0.2500");
        let rest = vec![moment(0, 0.1, 0.1), moment(30, 0.2, 0.2)];
        let rest = MotionRow::new(Motion::Rest, moves(false, false), rest);
        let cells = figures_of(&rest);
        assert_eq!(cells[1..5], ["0.2000", "0.2000", "0.2000", "–"]);
        assert_eq!(cells[9], "0.1000/0.2000");
        assert_eq!(seconds(&moment(30, 0.0, 0.0)), "0.5");
        assert_eq!(seconds(&moment(120, 0.0, 0.0)), "2");
    }
}
