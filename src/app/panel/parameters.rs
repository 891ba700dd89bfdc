//! All parameters, in groups: a field to search them, a reset for each and for each group, and all that was changed as
//! text for the command line.

use egui::{Button, CollapsingHeader, Id, RichText, TextEdit, Ui};

use crate::{
    app::{record::assignments, widgets},
    parameters::{KEYS, Key, Kind, Parameters},
    world::World,
};

/// Room for the button that empties the search.
const CLEAR: f32 = 34.0;

/// Parameters whose keys begin with the same word.
struct Group {
    prefix: &'static str,
    title: &'static str,
    /// Whether it is open at first.
    is_open: bool,
}

/// In the order of the table of parameters, except that those that rebuild the world come last.
const GROUPS: [Group; 8] = [
    group("probes", "Probes", false),
    group("source", "Probes: the source's method", false),
    group("occlusion", "Probes: the occlusion field", false),
    group("lights", "Lights", true),
    group("picture", "Picture", true),
    group("textures", "Textures", true),
    group("materials", "Materials", false),
    group("world", "World", false),
];

const fn group(prefix: &'static str, title: &'static str, is_open: bool) -> Group {
    Group {
        prefix,
        title,
        is_open,
    }
}

impl Group {
    fn keys(&self) -> impl Iterator<Item = &'static Key> {
        KEYS.iter().filter(|key| {
            let section = key.name.split_once('.').map(|(section, _)| section);
            section == Some(self.prefix)
        })
    }
}

/// The field of the search, and a button that empties it.
pub fn search_field(ui: &mut Ui, search: &mut String) {
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(search)
            .id(Id::unique("search of parameters"))
            .hint_text("search parameters")
            .desired_width(ui.available_width() - CLEAR);
        ui.add(field);
        let clear = ui.add_enabled(!search.is_empty(), Button::new("×"));
        if clear.on_hover_text("Shows everything again").clicked() {
            search.clear();
        }
    });
}

/// Copies all that is changed as flags of the command line.
pub fn copy_button(ui: &mut Ui, parameters: &Parameters) {
    let changed = assignments(parameters);
    let button = ui.add_enabled(!changed.is_empty(), Button::new("Copy as --set"));
    let button = button.on_hover_text(
        "Copies every parameter that is not at its default, as flags of the command line",
    );
    if button.clicked() {
        ui.ctx().copy_text(as_flags(&changed));
    }
}

/// Draws the groups. Unless `search` is empty, only parameters that match it are shown, in open groups.
pub fn show(ui: &mut Ui, search: &str, world: &World, parameters: &mut Parameters) {
    let presets: Vec<&str> = world
        .lamp_presets
        .iter()
        .map(|preset| &*preset.name)
        .collect();
    let words = words(search);
    let mut is_found = false;
    for group in &GROUPS {
        let found: Vec<&Key> = group.keys().filter(|key| matches(key, &words)).collect();
        if found.is_empty() {
            continue;
        }
        is_found = true;
        let changed = group.keys().filter(|key| is_changed(key, parameters));
        let title = match changed.count() {
            0 => group.title.to_owned(),
            count => format!("{} · {count} changed", group.title),
        };
        CollapsingHeader::new(RichText::new(title).strong())
            .id_salt(group.prefix)
            .default_open(group.is_open)
            .open((!words.is_empty()).then_some(true))
            .show(ui, |ui| {
                for key in found {
                    let names: &[&str] = if key.kind == Kind::Name {
                        &presets
                    } else {
                        &[]
                    };
                    widgets::row(ui, key, parameters, names);
                }
                let any = group.keys().any(|key| is_changed(key, parameters));
                if ui
                    .add_enabled(any, Button::new("Reset group").small())
                    .clicked()
                {
                    reset(group.keys(), parameters);
                }
            });
    }
    if !is_found {
        ui.weak(format!(
            "No parameter has “{}” in its key or help.",
            search.trim()
        ));
    }
}

fn is_changed(key: &Key, parameters: &Parameters) -> bool {
    key.get(parameters) != key.default()
}

fn reset(keys: impl Iterator<Item = &'static Key>, parameters: &mut Parameters) {
    for key in keys {
        key.set(parameters, key.default())
            .expect("a default is valid");
    }
}

fn words(search: &str) -> Vec<String> {
    search.split_whitespace().map(str::to_lowercase).collect()
}

/// Whether every word is in the key, in its label or in its help.
fn matches(key: &Key, words: &[String]) -> bool {
    let text = format!("{} {} {}", key.name, widgets::label(key), key.doc).to_lowercase();
    words.iter().all(|word| text.contains(word))
}

/// `--set KEY=VALUE` for each assignment, as a shell reads it.
fn as_flags(assignments: &[String]) -> String {
    let flags = assignments.iter().map(|assignment| {
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "._,=+-".contains(letter);
        if assignment.chars().all(is_plain) {
            format!("--set {assignment}")
        } else {
            format!("--set '{}'", assignment.replace('\'', r"'\''"))
        }
    });
    flags.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use egui::{Context, Event, RawInput, Rect, Shape};

    use super::*;
    use crate::{parameters::Value, world::file::Overrides};

    fn found(search: &str) -> Vec<&'static str> {
        let words = words(search);
        let keys = KEYS.iter().filter(|key| matches(key, &words));
        keys.map(|key| key.name).collect()
    }

    #[test]
    fn every_parameter_is_in_one_group() {
        for key in KEYS {
            let groups = GROUPS
                .iter()
                .filter(|group| group.keys().any(|known| known.name == key.name));
            assert_eq!(groups.count(), 1, "{}", key.name);
        }
    }

    #[test]
    fn a_search_reads_keys_labels_and_help() {
        assert_eq!(found("").len(), KEYS.len());
        assert_eq!(found("picture.exposure_ev"), ["picture.exposure_ev"]);
        assert!(
            found("Face Pixels").contains(&"probes.face_pixels"),
            "label"
        );
        assert!(found("jittered").contains(&"picture.antialias"), "help");
        assert!(
            found("probes leaks").contains(&"probes.visibility"),
            "words"
        );
        assert!(!found("probes leaks").contains(&"probes.rays"));
        assert!(found("no such parameter").is_empty());
    }

    #[test]
    fn a_reset_of_a_group_leaves_the_others() {
        let mut parameters = Parameters::default();
        for assignment in [
            "probes.rays=16",
            "source.depth=reject",
            "picture.exposure_ev=1",
        ] {
            parameters.set(assignment).expect("sound");
        }
        reset(GROUPS[0].keys(), &mut parameters);
        assert_eq!(
            assignments(&parameters),
            ["source.depth=reject", "picture.exposure_ev=1"]
        );
    }

    #[test]
    fn flags_of_changed_values_give_the_same_parameters_back() {
        let mut parameters = Parameters::default();
        parameters.set("lights.preset=it's four").expect("sound");
        parameters.set("materials.albedo=0.5,1,0").expect("sound");
        let flags = as_flags(&assignments(&parameters));
        assert_eq!(
            flags,
            r"--set materials.albedo=0.5,1,0 --set 'lights.preset=it'\''s four'"
        );
    }

    /// The texts of a frame of the parameters, after the frames that egui takes to settle.
    fn texts(search: &str, parameters: &mut Parameters, events: Vec<Event>) -> Vec<String> {
        let context = Context::default();
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = crate::world::file::load(&path, &Overrides::default()).expect("it loads");
        let mut texts = Vec::new();
        for frame in 0..4 {
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(
                    egui::Pos2::ZERO,
                    egui::vec2(400.0, 6000.0),
                )),
                events: if frame == 3 {
                    events.clone()
                } else {
                    Vec::new()
                },
                // The animation of an opening group is over.
                time: Some(f64::from(frame)),
                ..Default::default()
            };
            let output = context.run_ui(input, |ui| show(ui, search, &world, parameters));
            texts.clear();
            for shape in &output.shapes {
                if let Shape::Text(text) = &shape.shape {
                    texts.push(text.galley.text().to_owned());
                }
            }
            output.drop_without_applying_deltas();
        }
        texts
    }

    #[test]
    fn a_search_opens_the_groups_of_what_it_finds_and_hides_the_others() {
        let mut parameters = Parameters::default();
        let shown = texts("hysteresis", &mut parameters, Vec::new());
        assert!(shown.iter().any(|text| text == "hysteresis"), "{shown:?}");
        assert!(
            shown
                .iter()
                .any(|text| text.starts_with("Share of a probe's old light")),
            "its line of help: {shown:?}"
        );
        assert!(!shown.iter().any(|text| text == "Lights"), "{shown:?}");
        let none = texts("no such parameter", &mut parameters, Vec::new());
        assert!(
            none.iter().any(|text| text.starts_with("No parameter has")),
            "{none:?}"
        );
        assert_eq!(parameters, Parameters::default(), "looking changes nothing");
    }

    #[test]
    fn changed_values_are_marked_and_counted() {
        let mut parameters = Parameters::default();
        let key = Key::find("picture.exposure_ev").expect("a key");
        key.set(&mut parameters, Value::Number(1.5)).expect("valid");
        let shown = texts("", &mut parameters, Vec::new());
        assert!(
            shown.iter().any(|text| text == "Picture · 1 changed"),
            "{shown:?}"
        );
        assert!(
            shown.iter().any(|text| text == "● exposure ev"),
            "{shown:?}"
        );
    }
}
