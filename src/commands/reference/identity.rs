//! What a reference depends on, as text: its cache and its parts ask for it.

use super::super::Failure;
use crate::{
    gpu::ShaderLibrary,
    lights::Lights,
    world::{ResponseSpec, World},
};

/// What is traced of a world, as a text: who looks, where probes stand and what may change change nothing
/// about the world as it is. `time_s`: world time (seconds), at which bodies are where they are.
pub fn content(world: &World, lights: &Lights, time_s: f64) -> String {
    let poses = match &world.bodies.poses(time_s)[..] {
        [] => String::new(),
        poses => format!(" {poses:?}"),
    };
    let mut world = world.clone();
    world.name.clear();
    world.title.clear();
    world.cameras.clear();
    world.layouts.clear();
    world.lamp_presets.clear();
    world.response = ResponseSpec::default();
    // Where they are says all about how they move.
    for body in &mut world.bodies.bodies {
        body.motion.clear();
    }
    format!("{world:?} {lights:?}{poses}")
}

/// The sources of the tracer: what it gives is the same for as long as they are.
const SOURCES: [&str; 8] = [
    include_str!("../../frame/traced.rs"),
    include_str!("../../lights/emitters.rs"),
    include_str!("../../lights/table.rs"),
    include_str!("../../measure/block_sums.rs"),
    include_str!("../../passes/path_trace/blocks.rs"),
    include_str!("../../passes/path_trace/sums.rs"),
    include_str!("../../passes/path_trace/trace.rs"),
    include_str!("../../passes/scene/body_emitters.rs"),
];

/// The text of all sources of the tracer, those of its shader too.
///
/// # Errors
/// When the shader cannot be composed.
pub fn sources(library: &ShaderLibrary) -> Result<String, Failure> {
    let shader = library.compose("path_trace/trace", &[])?;
    let mut text = SOURCES.concat();
    for name in &shader.sources {
        text += &format!("\n{name}\n{}", library.text(name).unwrap_or_default());
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fs, path::Path};

    use super::*;
    use crate::world::file::{Overrides, parse};

    #[test]
    fn what_is_traced_depends_on_the_time_only_where_bodies_move() {
        let content_at = |motion: &str, time_s: f64| {
            let text = format!(
                "(title: \"\", size: (8, 8, 8), shape: Empty, bodies: [(position: (4, 4, 4),
                    model: Shape(size: (2, 2, 2), shape: Sphere(radius: 2)), motion: [{motion}])])"
            );
            let world = parse(&text, "world", None, &Overrides::default()).expect("sound");
            let lights = Lights::at(&world, &world.lamp_presets[0], 0.0);
            content(&world, &lights, time_s)
        };
        let turn = "TurnBetween(axis: (0, 1, 0), degrees: 45, start_s: 1, end_s: 2)";
        assert_ne!(content_at(turn, 0.0), content_at(turn, 1.5));
        assert_eq!(
            content_at(turn, 0.0),
            content_at("", 7.0),
            "it has not turned yet"
        );
        assert_eq!(
            content_at(turn, 2.0),
            content_at(turn, 9.0),
            "it has turned"
        );
    }

    #[test]
    fn the_sources_are_the_same_in_every_run_and_an_edit_changes_them() {
        let embedded = ShaderLibrary::embedded();
        let texts: BTreeSet<String> = (0..20)
            .map(|_| sources(&embedded).expect("our own shaders"))
            .collect();
        assert_eq!(texts.len(), 1);

        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in embedded.names() {
            let path = folder.path().join(format!("{name}.wesl"));
            fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
            fs::write(path, embedded.text(name).expect("it has that name")).expect("writable");
        }
        let read = |folder: &Path| {
            let library = ShaderLibrary::from_folder(folder).expect("shaders");
            sources(&library).expect("they compose")
        };
        assert!(texts.contains(&read(folder.path())));
        let append = |name: &str| {
            let path = folder.path().join(name);
            let text = fs::read_to_string(&path).expect("it is there");
            fs::write(&path, text + "// edited\n").expect("writable");
        };
        append("probes/gather.wesl");
        assert!(
            texts.contains(&read(folder.path())),
            "the tracer knows no probes"
        );
        append("march/march.wesl");
        assert!(!texts.contains(&read(folder.path())), "it marches");
    }
}
