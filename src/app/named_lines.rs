//! Names, each with a value beside it, which may take several lines.

use egui::{Label, RichText, Ui, Vec2, vec2};

/// Width of the column of names (points).
const NAMES: f32 = 56.0;
/// Between columns and between rows.
const BETWEEN: Vec2 = vec2(8.0, 2.0);

/// Draws them as wide as `ui` is. A grid of egui would not do: it places the first frame's text by row heights that it measured in a
/// narrower column.
pub fn show(ui: &mut Ui, lines: &[(&str, String)]) {
    ui.spacing_mut().item_spacing = BETWEEN;
    for (name, value) in lines {
        ui.horizontal_top(|ui| {
            let name = Label::new(RichText::new(*name).weak());
            let left = ui.cursor().left();
            ui.add(name);
            ui.add_space((left + NAMES - ui.cursor().left()).max(0.0));
            ui.add(Label::new(value).wrap());
        });
    }
}

#[cfg(test)]
mod tests {
    use egui::{Align2, Area, Id};

    use super::*;

    #[test]
    fn rows_are_below_one_another_from_the_first_frame_on() {
        let context = egui::Context::default();
        let long = "a material with a name that takes lines  (-120, 30, -64)";
        let lines = [
            ("at", "0.5"),
            ("aims at", long),
            ("time", "1.2 s"),
            ("sound", long),
        ];
        let lines = lines.map(|(name, value)| (name, value.to_owned()));
        let input = || egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(
                egui::Pos2::ZERO,
                vec2(640.0, 360.0),
            )),
            ..Default::default()
        };
        let mut shown: Vec<Vec<egui::Rect>> = Vec::new();
        for _ in 0..4 {
            let mut output = context.run_ui(input(), |ui| {
                Area::new(Id::unique("lines"))
                    .anchor(Align2::RIGHT_TOP, [-12.0, 12.0])
                    .show(ui.ctx(), |ui| {
                        ui.set_width(236.0);
                        show(ui, &lines);
                    });
            });
            output.textures_delta.clear();
            let texts = output.shapes.iter().filter_map(|shape| match &shape.shape {
                egui::Shape::Text(text) => Some(text.visual_bounding_rect()),
                _ => None,
            });
            shown.push(texts.collect());
        }
        // A frame that only measures shows nothing.
        shown.retain(|texts| !texts.is_empty());
        assert!(shown.len() >= 2);
        for texts in &shown {
            assert_eq!(texts.len(), 2 * lines.len());
            assert_eq!(*texts, shown[0], "it does not move");
            for pair in texts.chunks(2).collect::<Vec<_>>().windows(2) {
                let end = pair[0][0].bottom().max(pair[0][1].bottom());
                let next = pair[1][0].top().min(pair[1][1].top());
                assert!(end <= next, "{end} {next}");
                assert!(pair[0][0].right() < pair[0][1].left());
            }
        }
    }
}
