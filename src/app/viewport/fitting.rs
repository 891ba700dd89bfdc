//! What of a choice a world does not have is replaced.

use super::Choice;
use crate::world::{LayoutSpec, World};

/// The choice, with everything that this world lacks replaced.
pub(super) fn fitting(mut choice: Choice, world: &World) -> Choice {
    choice
        .layout
        .clone_from(&layout(world, &choice.layout).name);
    let preset = &mut choice.parameters.lights.preset;
    if world.lamp_presets.iter().all(|known| known.name != *preset) {
        preset.clear();
    }
    choice
}

/// The layout of this name, or the world's first.
pub(super) fn layout<'a>(world: &'a World, name: &str) -> &'a LayoutSpec {
    let mut layouts = world.layouts.iter();
    layouts
        .find(|layout| layout.name == name)
        .unwrap_or_else(|| world.layouts.first().expect("a world has a probe layout"))
}
