//! FLIP over time, as a plot in the page.

use super::{
    super::{super::dynamics::RATE, row::Row},
    row::{Moment, MotionRow},
};
use crate::measure::plot::{Curve, Curves, Mark, Scale, colour, curves, escaped};

/// A curve for each motion of the row, and a hollow one for its moments at rest where these are not the row at
/// rest; with the key of their colours. Empty if nothing was judged in motion.
pub fn of_row(row: &Row) -> String {
    if row.motion.is_empty() {
        return String::new();
    }
    let moments = || row.motion.iter().flat_map(|motion| &motion.moments);
    let seconds = |moment: &Moment| f64::from(moment.frame) / RATE;
    let flip: fn(&Moment) -> f64 = |moment| moment.full.flip.mean;
    let rest_flip: fn(&Moment) -> f64 = |moment| moment.rest_flip;
    let title = format!(
        "{}, {}, {}: FLIP over time",
        row.world, row.camera, row.layout
    );
    let each = row.motion.iter().enumerate();
    let curve = |(series, motion): (usize, &MotionRow), mark, flip: fn(&Moment) -> f64| Curve {
        series,
        points: motion
            .moments
            .iter()
            .map(|moment| (seconds(moment), flip(moment), None))
            .collect(),
        mark,
    };
    let in_motion = each.clone().map(|one| curve(one, Mark::Line, flip));
    let has_own_rest = |(_, one): &(usize, &MotionRow)| one.moves.lamps || one.moves.edits;
    let at_rest = each.clone().filter(has_own_rest);
    let at_rest = at_rest.map(|one| curve(one, Mark::Hollow, rest_flip));
    let svg = curves(&Curves {
        label: &title,
        x: Scale::from_zero(moments().map(seconds), 5),
        y: Scale::from_zero(moments().flat_map(|one| [flip(one), rest_flip(one)]), 5),
        x_name: "seconds of world time in motion",
        y_name: "mean FLIP",
        curves: at_rest.chain(in_motion).collect(),
        notes: Vec::new(),
    });
    let key: String = each
        .map(|(series, motion)| {
            let name = match motion.over_rest {
                None => motion.motion.name().to_owned(),
                Some(over) => format!("{} ({over:.2} × rest)", motion.motion.name()),
            };
            format!(
                "<span><i style=\"background:{}\"></i>{}</span>",
                colour(series),
                escaped(&name)
            )
        })
        .collect();
    format!(
        "<figure class=\"motion\"><figcaption>{}</figcaption>{svg}<div class=\"key\">{key}<span>Hollow: the same moments \
         at rest</span></div></figure>\n",
        escaped(&title)
    )
}

/// What the page's style sheet needs besides that of all plots.
pub const STYLE: &str = "\
.motion figcaption{max-width:none}.motion{margin:.5rem 0 1.5rem}\
.key{font-size:.85rem;display:flex;flex-wrap:wrap;gap:.25rem 1rem}\
.key i{display:inline-block;width:.7em;height:.7em;border-radius:50%;margin-right:.35em}";
