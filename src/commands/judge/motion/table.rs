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
        "over rest",
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

fn figures_of(row: &MotionRow) -> [String; 8] {
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
        row.over_rest.map_or_else(dash, |over| format!("{over:.2}")),
        format!("{:.5}", row.mean(|moment| moment.full.rel_mse)),
        ratio(row.mean(|moment| moment.full.energy_ratio)),
        ratio(row.mean(|moment| moment.indirect.energy_ratio)),
        each.join("/"),
    ]
}

/// Seconds since things began to move.
fn seconds(moment: &Moment) -> String {
    let text = format!(
        "{:.2}",
        f64::from(moment.frame) / super::super::super::dynamics::RATE
    );
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The legend of the columns, in Markdown that is also valid in HTML.
pub const LEGEND: &str = "In motion: world time runs at 60 frames per second, and each judged frame is compared \
with a reference of that very moment. Lamps: only the lamps move. Camera: only the camera moves; it flies and \
turns, and is back at its place at each judged moment. Both: lamps and camera move. Edits: whatever moves in the \
other rows, with a ball dug or built every tenth frame. Rest: the start and the same moments, each with the world \
at rest and settled probes. Figures are means over the moments; the last column has the FLIP of each. Over rest \
is the mean FLIP over that of the same moments at rest.";

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
        let rest = vec![moment(0, 0.1), moment(30, 0.1)];
        let moved = MotionRow::new(
            Motion::Both,
            moves(true, true),
            vec![moment(30, 0.25)],
            &rest,
        );
        let cells = figures_of(&moved);
        assert_eq!(cells[..4], ["both", "0.2500", "0.2500", "2.50"]);
        assert_eq!(cells[7], "–/0.2500");
        let rest = MotionRow::new(Motion::Rest, moves(false, false), rest, &[]);
        assert_eq!(figures_of(&rest)[7], "0.1000/0.1000");
        assert_eq!(seconds(&moment(30, 0.0)), "0.5");
        assert_eq!(seconds(&moment(120, 0.0)), "2");
    }
}
