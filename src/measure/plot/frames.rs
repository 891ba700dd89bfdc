//! Small plots of one row: its frames in order, and a histogram of their times.

use plotters::{prelude::*, style::text_anchor::HPos};

use super::{
    AXIS, Drawn, GRID, WIDTH, finished,
    scale::{Scale, figure},
    series, write,
};

const HEIGHT: u32 = 110;
const LEFT: i32 = 40;
const RIGHT: i32 = WIDTH as i32 - 8;
const TOP: i32 = 8;
const BOTTOM: i32 = HEIGHT as i32 - 18;
/// Most points of a curve: about one for every two pixels.
const MOST_POINTS: usize = 120;

/// Milliseconds of frames in order. Each plotted point is the worst of the frames that it represents.
pub fn frame_curve(label: &str, frames_ms: &[f32], median: f64) -> String {
    let kept = thinned(frames_ms);
    let y = Scale::from_zero(kept.iter().map(|ms| f64::from(*ms)).chain([median]), 3);
    let mut svg = String::new();
    let mut drawn = || -> Drawn {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
        for (value, text) in &y.ticks {
            let at = row(&y, *value);
            root.draw(&PathElement::new(
                vec![(LEFT, at), (RIGHT, at)],
                GRID.stroke_width(1),
            ))?;
            write(&root, text, (LEFT - 5, at), HPos::Right)?;
        }
        let at = row(&y, median);
        root.draw(&PathElement::new(
            vec![(LEFT, at), (RIGHT, at)],
            AXIS.stroke_width(1),
        ))?;
        let last = kept.len().saturating_sub(1).max(1) as i32;
        let points = kept.iter().enumerate().map(|(index, ms)| {
            (
                LEFT + index as i32 * (RIGHT - LEFT) / last,
                row(&y, f64::from(*ms)),
            )
        });
        root.draw(&PathElement::new(
            points.collect::<Vec<_>>(),
            series(0).stroke_width(1),
        ))?;
        write(
            &root,
            "ms of each frame, in order",
            ((LEFT + RIGHT) / 2, HEIGHT as i32 - 8),
            HPos::Center,
        )?;
        root.present()
    };
    drawn().expect("drawing into a string cannot fail");
    finished(&svg, label)
}

/// Number of frames by their milliseconds, in equal steps; the last step holds all longer frames.
pub fn histogram(label: &str, counts: &[u32], from_ms: f64, step_ms: f64) -> String {
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let mut svg = String::new();
    let mut drawn = || -> Drawn {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
        let steps = counts.len().max(1) as i32;
        let x = |step: i32| LEFT + step * (RIGHT - LEFT) / steps;
        let mut outline = vec![(LEFT, BOTTOM)];
        for (step, count) in counts.iter().enumerate() {
            let share = f64::from(*count) / f64::from(most);
            // A single frame among many stays visible.
            let least = i32::from(*count > 0);
            let top = BOTTOM - ((f64::from(BOTTOM - TOP) * share) as i32).max(least);
            outline.extend([(x(step as i32), top), (x(step as i32 + 1), top)]);
        }
        outline.push((x(counts.len() as i32), BOTTOM));
        root.draw(&Polygon::new(outline, series(0).filled()))?;
        root.draw(&PathElement::new(
            vec![(LEFT, BOTTOM), (RIGHT, BOTTOM)],
            AXIS.stroke_width(1),
        ))?;
        write(&root, &most.to_string(), (LEFT - 5, TOP + 3), HPos::Right)?;
        write(&root, "0", (LEFT - 5, BOTTOM), HPos::Right)?;
        let ms = |step: i32| figure(from_ms + f64::from(step) * step_ms);
        let below = HEIGHT as i32 - 8;
        write(&root, &ms(0), (LEFT, below), HPos::Left)?;
        write(
            &root,
            &format!("{} ms", ms(steps / 2)),
            (x(steps / 2), below),
            HPos::Center,
        )?;
        write(
            &root,
            &format!("≥ {}", ms(steps - 1)),
            (RIGHT, below),
            HPos::Right,
        )?;
        root.present()
    };
    drawn().expect("drawing into a string cannot fail");
    finished(&svg, label)
}

fn row(y: &Scale, value: f64) -> i32 {
    BOTTOM - (y.at(value) * f64::from(BOTTOM - TOP)).round() as i32
}

/// At most [`MOST_POINTS`] frames, each the worst of the frames that it represents.
fn thinned(frames_ms: &[f32]) -> Vec<f32> {
    let each = frames_ms.len().div_ceil(MOST_POINTS).max(1);
    let worst = |frames: &[f32]| frames.iter().copied().fold(0.0, f32::max);
    frames_ms.chunks(each).map(worst).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hitches_survive_thinning() {
        let mut frames = vec![1.0; 600];
        frames[333] = 9.0;
        let kept = thinned(&frames);
        assert_eq!(kept.len(), MOST_POINTS);
        assert_eq!(kept.iter().filter(|ms| **ms == 9.0).count(), 1);
        assert_eq!(thinned(&[2.0]), [2.0]);
        assert!(frame_curve("a row", &frames, 1.0).len() < 3000);
        assert!(frame_curve("no frames", &[], 1.0).starts_with("<svg"));
    }

    #[test]
    fn rare_frames_are_visible_in_the_histogram() {
        let svg = histogram("a row", &[0, 100_000, 1], 1.0, 0.5);
        let (_, outline) = svg.split_once("points=\"").expect("an outline");
        let (outline, _) = outline.split_once('"').expect("its end");
        let at = |height: i32| format!(",{height}");
        let heights: Vec<&str> = outline.split(' ').collect();
        let last = heights
            .iter()
            .rev()
            .find(|point| point.contains(',') && !point.ends_with(&at(BOTTOM)));
        assert!(
            last.is_some_and(|point| point.ends_with(&at(BOTTOM - 1))),
            "{outline}"
        );
        assert!(outline.contains(&at(TOP)), "{outline}");
        assert!(svg.contains("≥ 2"), "{svg}");
        assert!(histogram("none", &[], 0.0, 1.0).starts_with("<svg"));
    }
}
