//! Speed against error, for rows that were judged.

use super::{
    super::model::Row,
    html,
    names::{card, distinct, names_with_keys},
};
use crate::measure::{
    plot::{self, Curve, Curves, Mark, Scale, figure},
    scaling::pareto_front,
};

/// A plot and a table for each world, camera and card. Empty where no row was judged.
pub fn quality(rows: &[&Row]) -> String {
    let judged: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| row.quality.is_some() && row.fps.is_some())
        .collect();
    let place = |row: &Row| format!("{}, camera {}, {}", row.world, row.camera, card(row));
    let places = distinct(judged.iter().map(|row| place(row)));
    let of_place = |title: &String| {
        let rows: Vec<&Row> = judged
            .iter()
            .copied()
            .filter(|row| place(row) == *title)
            .collect();
        of_rows(title, &rows)
    };
    let all: String = places.iter().map(of_place).collect();
    if all.is_empty() {
        return all;
    }
    format!(
        "<h2>Speed against error</h2>\n{}{all}",
        html::paragraph(
            "FLIP of the displayed picture against the path-traced reference: 0 is equal. The line joins rows that \
             no other row beats in both (the Pareto front); the table marks them."
        )
    )
}

fn of_rows(title: &str, rows: &[&Row]) -> String {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .filter_map(|row| Some((row.quality?.flip, row.fps?)))
        .collect();
    let front = pareto_front(&points);
    let with_no_interval = |&index: &usize| (points[index].0, points[index].1, None);
    let notes = front.iter().map(|&index| {
        let (x, y) = points[index];
        (x, y, (index + 1).to_string())
    });
    let svg = plot::curves(&Curves {
        label: &format!("{title}: frames per second over FLIP"),
        x: Scale::from_zero(points.iter().map(|point| point.0), 5),
        y: Scale::spanning(points.iter().map(|point| point.1), 6),
        x_name: "mean FLIP (left is better)",
        y_name: "FPS",
        curves: vec![
            Curve {
                series: 1,
                points: front.iter().map(with_no_interval).collect(),
                mark: Mark::Front,
            },
            Curve {
                series: 0,
                points: (0..points.len())
                    .map(|index| with_no_interval(&index))
                    .collect(),
                mark: Mark::Dots,
            },
        ],
        notes: notes.collect(),
    });
    let lines: Vec<Vec<String>> = rows
        .iter()
        .zip(names_with_keys(rows, &["world", "camera", "card"]))
        .zip(&points)
        .enumerate()
        .map(|(index, ((row, name), (flip, fps)))| {
            let energy = row.quality.and_then(|quality| quality.energy);
            vec![
                format!("{}: {name}", row.suite),
                (index + 1).to_string(),
                figure(*fps),
                format!("{flip:.4}"),
                energy.map_or(String::new(), |energy| format!("{energy:.3}")),
                if front.contains(&index) { "front" } else { "" }.to_owned(),
            ]
        })
        .collect();
    let table = html::table(
        &["row", "number", "FPS", "FLIP", "energy", "Pareto"],
        &lines,
    );
    html::plots(&html::plot(title, &svg, &[], &[])) + &table
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn judged_rows_are_drawn_and_the_front_is_listed() {
        let mut report = made_up::report();
        // The last layout becomes slower and worse than the previous one.
        let last = report.rows[6].quality.as_mut().expect("judged");
        last.flip = 0.2;
        let rows: Vec<&Row> = report.rows.iter().collect();
        let text = quality(&rows);
        assert_eq!(text.matches("<circle").count(), 4, "{text}");
        assert_eq!(text.matches(">front<").count(), 3, "{text}");
        assert!(text.contains("layouts: layout3"), "{text}");
        assert_eq!(quality(&rows[8..]), "");
    }
}
