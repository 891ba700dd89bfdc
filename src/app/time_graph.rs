//! The graph of frame times: a curve of every frame, with the median and the slow tail marked.

use egui::{
    Color32, FontId, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, Vec2, epaint::Mesh, pos2, vec2,
};

use super::{clock::FrameRate, panel::digits};
use crate::measure::frame_times::FrameStatistics;

/// Colour of the line of the median and of its figure.
pub const MEDIAN: Color32 = Color32::from_rgb(130, 200, 130);
/// Colour of the line of the 1 % low and of its figure.
pub const LOW: Color32 = Color32::from_rgb(255, 190, 80);
/// Colour of the curve.
const CURVE: Color32 = Color32::from_rgb(120, 180, 255);

/// Height of the graph in the panel (egui's points).
const PANEL_HEIGHT: f32 = 56.0;
/// Height of the letters below the graph.
const FIGURES: f32 = 11.0;
/// The graph's height in medians: at least LEAST, and at most MOST unless the P99 is above that. One hitch must
/// not flatten all other frames.
const LEAST_MEDIANS: f64 = 2.0;
const MOST_MEDIANS: f64 = 4.0;
/// Room above the highest value shown.
const HEADROOM: f64 = 1.1;

/// The last frames of the window, for the panel.
pub fn show(ui: &mut Ui, rate: &FrameRate) {
    let figures = rate.figures();
    let size = vec2(ui.available_width(), PANEL_HEIGHT);
    draw(ui, &rate.frames_ms(), figures, FrameRate::KEPT, size);
    ui.horizontal(|ui| {
        let figure = |colour, text: String| RichText::new(text).size(FIGURES).color(colour);
        let Some(figures) = figures else {
            ui.label(RichText::new("no frames yet").size(FIGURES));
            return;
        };
        ui.label(figure(
            MEDIAN,
            format!("median {} ms", digits(figures.median)),
        ));
        ui.label(figure(
            LOW,
            format!("1 % low {} FPS", digits(figures.low1_fps)),
        ));
        let p99 = format!("P99 {} ms", digits(figures.p99));
        ui.label(RichText::new(p99).size(FIGURES));
    })
    .response
    .on_hover_text(format!(
        "Of the last {} frames, by the wall clock",
        FrameRate::KEPT
    ));
}

/// Draws the frames from left to right, the latest at the right edge; `slots` frames fill the width. Frames
/// slower than the top of the graph touch its upper edge.
pub fn draw(
    ui: &mut Ui,
    frames_ms: &[f64],
    figures: Option<&FrameStatistics>,
    slots: usize,
    size: Vec2,
) {
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let Some(figures) = figures else {
        return;
    };
    let top_ms = top_ms(figures);
    let points = points(frames_ms, rect, slots, top_ms);
    painter.add(Shape::mesh(area(&points, rect.bottom())));
    if points.len() > 1 {
        painter.line(points, Stroke::new(1.0, CURVE));
    }
    for (ms, colour) in [(figures.median, MEDIAN), (1e3 / figures.low1_fps, LOW)] {
        let y = height(ms, rect, top_ms);
        let line = [pos2(rect.left(), y), pos2(rect.right(), y)];
        painter.extend(Shape::dashed_line(
            &line,
            Stroke::new(1.0, colour),
            4.0,
            3.0,
        ));
    }
    let scale = format!("{} ms", digits(top_ms));
    let colour = ui.visuals().text_color();
    let scale = painter.layout_no_wrap(scale, FontId::proportional(10.0), colour);
    let at = rect.left_top() + vec2(4.0, 2.0);
    // The lines must not run through the text.
    let behind = Rect::from_min_size(at, scale.size()).expand(2.0);
    painter.rect_filled(behind, 2.0, ui.visuals().extreme_bg_color);
    painter.galley(at, scale, colour);
}

/// Milliseconds at the upper edge of the graph.
fn top_ms(figures: &FrameStatistics) -> f64 {
    let least = LEAST_MEDIANS * figures.median;
    let most = (MOST_MEDIANS * figures.median).max(figures.p99);
    HEADROOM * figures.worst.clamp(least, most)
}

fn height(ms: f64, rect: Rect, top_ms: f64) -> f32 {
    let share = (ms / top_ms).clamp(0.0, 1.0) as f32;
    rect.bottom() - share * rect.height()
}

fn points(frames_ms: &[f64], rect: Rect, slots: usize, top_ms: f64) -> Vec<Pos2> {
    let step = rect.width() / slots.saturating_sub(1).max(1) as f32;
    let frames = frames_ms.iter().rev().take(slots).enumerate();
    let mut points: Vec<Pos2> = frames
        .map(|(age, &ms)| pos2(rect.right() - age as f32 * step, height(ms, rect, top_ms)))
        .collect();
    points.reverse();
    points
}

/// The area between the curve and the bottom.
fn area(points: &[Pos2], bottom: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let fill = CURVE.gamma_multiply(0.25);
    for (index, point) in points.iter().enumerate() {
        mesh.colored_vertex(*point, fill);
        mesh.colored_vertex(pos2(point.x, bottom), fill);
        if let Some(before) = (2 * index as u32).checked_sub(2) {
            mesh.add_triangle(before, before + 1, before + 2);
            mesh.add_triangle(before + 1, before + 2, before + 3);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect() -> Rect {
        Rect::from_min_max(pos2(100.0, 10.0), pos2(400.0, 60.0))
    }

    fn figures(frames_ms: &[f64]) -> FrameStatistics {
        FrameStatistics::of(frames_ms).expect("frames")
    }

    #[test]
    fn the_latest_frame_is_at_the_right_edge_and_slow_is_high() {
        let points = points(&[10.0, 20.0, 40.0], rect(), 301, 20.0);
        assert_eq!(
            points,
            [pos2(398.0, 35.0), pos2(399.0, 10.0), pos2(400.0, 10.0)]
        );
        let latest = super::points(&[1.0; 500], rect(), 301, 20.0);
        assert_eq!((latest.len(), latest[0].x), (301, 100.0), "as many as fit");
        assert!(super::points(&[], rect(), 301, 20.0).is_empty());
        assert_eq!(super::points(&[5.0], rect(), 1, 20.0)[0].x, 400.0);
    }

    #[test]
    fn a_hitch_does_not_flatten_the_graph_and_a_slow_tail_fits_into_it() {
        let even = figures(&[10.0; 300]);
        assert!((top_ms(&even) - 22.0).abs() < 1e-9);
        let mut frames = vec![10.0; 300];
        frames[7] = 900.0;
        assert!((top_ms(&figures(&frames)) - 44.0).abs() < 1e-9);
        for slow in &mut frames[..30] {
            *slow = 100.0;
        }
        assert!(top_ms(&figures(&frames)) >= 100.0);
    }

    #[test]
    fn the_area_lies_below_the_curve() {
        let points = points(&[10.0, 20.0, 5.0], rect(), 3, 20.0);
        let mesh = area(&points, rect().bottom());
        assert!(mesh.is_valid());
        assert_eq!((mesh.vertices.len(), mesh.triangles().count()), (6, 4));
        assert!(area(&points[..1], 60.0).triangles().next().is_none());
    }
}
