//! Widgets for parameters of any kind: everything that the panel knows about a key comes from the key table.

use egui::{Align, ComboBox, DragValue, Label, Layout, Response, RichText, Slider, Ui};
use glam::{UVec3, Vec3};

use crate::parameters::{Key, Kind, Parameters, Value};

/// Width of the names, so that the widgets stand in one column.
const NAMES: f32 = 136.0;
/// What stands before the name of a changed parameter.
const MARK: &str = "●";

/// A parameter: its name, a widget that edits it, a button that resets it, and a line of help. A value other than the
/// default is marked. `names` are the allowed values of a [`Kind::Name`].
pub fn row(ui: &mut Ui, key: &Key, parameters: &mut Parameters, names: &[&str]) {
    let before = key.get(parameters);
    let is_changed = before != key.default();
    let help = format!("{}\n\n{} · {}", key.doc, key.name, key.kind.range());
    let mut after = before.clone();
    ui.horizontal(|ui| {
        let height = ui.spacing().interact_size.y;
        ui.allocate_ui_with_layout(
            egui::vec2(NAMES, height),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.set_min_width(NAMES);
                let name = match is_changed {
                    true => RichText::new(format!("{MARK} {}", label(key))).strong(),
                    false => RichText::new(label(key)),
                };
                ui.label(name).on_hover_text(&help);
            },
        );
        edit(ui, key, &mut after, names);
        if is_changed
            && ui
                .small_button(RichText::new("↺").monospace())
                .on_hover_text(format!("back to {}", shown(&key.default())))
                .clicked()
        {
            after = key.default();
        }
    });
    let line = RichText::new(first_sentence(key.doc)).small().weak();
    ui.add(Label::new(line).wrap()).on_hover_text(&help);
    ui.add_space(3.0);
    if after != before {
        // A value that the range refuses (a number typed as NaN) leaves the parameter unchanged.
        let _ = key.set(parameters, after);
    }
}

fn first_sentence(help: &str) -> &str {
    help.find(". ").map_or(help, |end| &help[..=end])
}

/// `hysteresis` for `probes.hysteresis`, with spaces between words.
pub fn label(key: &Key) -> String {
    let field = key
        .name
        .split_once('.')
        .map_or(key.name, |(_, field)| field);
    field.replace('_', " ")
}

/// A value for display: the empty name is the world's first.
fn shown(value: &Value) -> String {
    match value {
        Value::Name(name) if name.is_empty() => "the world's first".to_owned(),
        value => value.to_string(),
    }
}

fn edit(ui: &mut Ui, key: &Key, value: &mut Value, names: &[&str]) {
    match (key.kind, value) {
        (Kind::Flag, Value::Flag(flag)) => {
            ui.checkbox(flag, "");
        }
        (Kind::Count { min, max }, Value::Count(count)) => {
            let logarithmic = spans_decades(f64::from(min), f64::from(max));
            ui.add(Slider::new(count, min..=max).logarithmic(logarithmic));
        }
        (Kind::Number { min, max }, Value::Number(number)) => {
            let logarithmic = spans_decades(f64::from(min), f64::from(max));
            let slider = Slider::new(number, min..=max).logarithmic(logarithmic);
            ui.add(if logarithmic {
                slider.smallest_positive(smallest(f64::from(min)))
            } else {
                slider.max_decimals(3)
            });
        }
        (Kind::Choice { words, .. }, Value::Choice(word)) => {
            choose(ui, key.name, word, words);
        }
        (Kind::Name, Value::Name(name)) => {
            let known = names.iter().find(|known| **known == name.as_str());
            let mut chosen = known.or(names.first()).copied().unwrap_or_default();
            if choose(ui, key.name, &mut chosen, names) {
                *name = chosen.to_owned();
            }
        }
        (Kind::Seed, Value::Seed(seed)) => {
            or_file(ui, seed, 0, |ui, seed| ui.add(DragValue::new(seed)));
        }
        (Kind::Colour { max }, Value::Colour(colour)) => {
            or_file(ui, colour, Vec3::splat(0.5), |ui, colour| {
                let mut channel = |channel: &mut f32| {
                    let speed = 0.01 * channel.max(0.1);
                    ui.add(DragValue::new(channel).range(0.0..=max).speed(speed))
                };
                channel(&mut colour.x) | channel(&mut colour.y) | channel(&mut colour.z)
            });
        }
        (Kind::Size { max }, Value::Size(size)) => {
            or_file(ui, size, UVec3::splat(128), |ui, size| {
                let mut edge = |edge: &mut u32| {
                    // Otherwise each number on the way would build a world.
                    let field = DragValue::new(edge).range(1..=max);
                    ui.add(field.update_while_editing(false))
                };
                edge(&mut size.x) | edge(&mut size.y) | edge(&mut size.z)
            });
        }
        (kind, value) => unreachable!("{}: {value:?} is not {kind}", key.name),
    }
}

/// A box of words. Returns whether another word was chosen.
pub fn choose<'a>(ui: &mut Ui, id: &str, chosen: &mut &'a str, words: &[&'a str]) -> bool {
    let before = *chosen;
    ComboBox::from_id_salt(id)
        .selected_text(before)
        .width(ui.spacing().slider_width)
        .show_ui(ui, |ui| {
            for word in words {
                ui.selectable_value(chosen, word, *word);
            }
        });
    *chosen != before
}

/// A check box that leaves the value to the world file, and a widget while it is not ticked.
fn or_file<T>(
    ui: &mut Ui,
    value: &mut Option<T>,
    first: T,
    widget: impl FnOnce(&mut Ui, &mut T) -> Response,
) {
    let mut file = value.is_none();
    ui.checkbox(&mut file, "as the file")
        .on_hover_text("What the world file says; untick to replace it");
    if file {
        *value = None;
    } else {
        widget(ui, value.get_or_insert(first));
    }
}

/// Whether a range is too wide for a linear slider.
fn spans_decades(min: f64, max: f64) -> bool {
    min >= 0.0 && (max >= 100.0 * min.max(1.0) || (min > 0.0 && max >= 1000.0 * min))
}

/// Smallest value of a logarithmic slider before it leaps to 0.
fn smallest(min: f64) -> f64 {
    if min > 0.0 { min } else { 0.01 }
}

#[cfg(test)]
mod tests {
    use egui::{Context, Event, PointerButton, Pos2, RawInput, Rect};

    use super::*;
    use crate::parameters::KEYS;

    fn pass(context: &Context, events: Vec<Event>, parameters: &mut Parameters, keys: &[&Key]) {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(600.0, 4000.0))),
            events,
            ..Default::default()
        };
        let output = context.run_ui(input, |ui| {
            for key in keys {
                row(ui, key, parameters, &["four", "one"]);
            }
        });
        output.drop_without_applying_deltas();
    }

    /// Sets every key to a value within its range, including both ends.
    fn extremes(parameters: &mut Parameters, key: &Key, most: bool) {
        let value = match key.kind {
            Kind::Flag => Value::Flag(most),
            Kind::Count { min, max } => Value::Count(if most { max } else { min }),
            Kind::Number { min, max } => Value::Number(if most { max } else { min }),
            Kind::Choice { words, .. } => {
                Value::Choice(words[if most { words.len() - 1 } else { 0 }])
            }
            Kind::Name => Value::Name(if most { "one" } else { "gone" }.to_owned()),
            Kind::Seed => Value::Seed(most.then_some(u32::MAX)),
            Kind::Colour { max } => Value::Colour(most.then_some(Vec3::splat(max))),
            Kind::Size { max } => Value::Size(most.then_some(UVec3::splat(max))),
        };
        key.set(parameters, value).expect(key.name);
    }

    #[test]
    fn every_key_has_a_widget_and_looking_at_it_changes_nothing() {
        let all: Vec<&Key> = KEYS.iter().collect();
        for most in [None, Some(false), Some(true)] {
            let mut parameters = Parameters::default();
            if let Some(most) = most {
                for key in KEYS {
                    extremes(&mut parameters, key, most);
                }
            }
            let before = parameters.clone();
            let context = Context::default();
            for _ in 0..3 {
                pass(&context, Vec::new(), &mut parameters, &all);
            }
            assert_eq!(parameters, before);
        }
    }

    /// Clicks along a row until `key` has changed.
    fn click(key: &str) -> Parameters {
        let key = Key::find(key).expect("a key");
        let mut parameters = Parameters::default();
        let context = Context::default();
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Default::default(),
        };
        for x in (0..60).map(|step| step as f32 * 5.0) {
            let pos = Pos2::new(x, 18.0);
            for events in [
                vec![Event::PointerMoved(pos)],
                vec![button(pos, true)],
                vec![button(pos, false)],
            ] {
                pass(&context, events, &mut parameters, &[key]);
            }
            if parameters != Parameters::default() {
                break;
            }
        }
        parameters
    }

    #[test]
    fn a_click_changes_what_it_hits() {
        let flag = click("textures.enabled");
        assert!(!flag.textures.enabled);
        let count = click("probes.rays").probes.rays;
        assert_ne!(count, Parameters::default().probes.rays);
        assert!((8..=4096).contains(&count));
        let number = click("picture.exposure_ev").picture.exposure_ev;
        assert_ne!(number, 0.0);
        assert_eq!(click("world.seed").world.seed, Some(0));
    }

    #[test]
    fn the_line_of_help_is_the_first_sentence() {
        assert_eq!(first_sentence("More. Or less."), "More.");
        assert_eq!(first_sentence("From 0.5 to 1."), "From 0.5 to 1.");
        for key in KEYS {
            assert!(first_sentence(key.doc).ends_with('.'), "{}", key.name);
        }
    }

    #[test]
    fn wide_ranges_get_logarithmic_sliders() {
        for (range, logarithmic) in [
            ((8.0, 4096.0), true),
            ((1e-9, 1.0), true),
            ((0.0, 65504.0), true),
            ((0.0, 0.999), false),
            ((-20.0, 20.0), false),
            ((4.0, 64.0), false),
        ] {
            assert_eq!(spans_decades(range.0, range.1), logarithmic, "{range:?}");
        }
    }
}
