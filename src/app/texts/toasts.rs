//! Messages over the picture. Names of actions in braces stand for their keys.

use std::path::Path;

use crate::app::hands::brush::{Brush, Shape};

pub const FIRST: &str =
    "Click into the picture to look around; {help} shows the keys, {panel} the panel";
pub const ENTERED: &str = "{forward} {left} {back} {right} walk, the mouse looks, {dig} digs, {place} builds, {inventory} has all materials and lamps; \
     Esc opens the menu, {help} shows all keys";
pub const REPLAY_OVER: &str = "The replay is over: go on from here";
pub const TRACED: &str = "Path-traced reference: time is paused ({pause_time} resumes it), {reference} returns to the probes";
pub const NO_BENCHMARK: &str =
    "The benchmark measures light by probes: {reference} returns to them";
pub const EMPTY_BENCHMARK: &str = "Benchmark stopped before any frame counted";
pub const OTHER_SIZE: &str = "The picture has another size: the benchmark was stopped";
pub const GPU_LOST: &str =
    "The GPU was lost and opened again; edits are kept, light is computed again";
pub const SHADERS: &str = "shaders compiled";
pub const HEARD: &str = "Sound is on ({mute} mutes it)";
pub const EMPTY_SLOT: &str = "This slot is empty: {inventory} has everything that can be placed";
pub const NO_COPY: &str = "Nothing is copied yet: {mark} marks the corners of a box";

pub const WITH_AIR: &str = "Pasting air too: it digs what lies there ({air})";
pub const WITHOUT_AIR: &str = "Pasting without air: what lies there stays ({air})";

pub fn corner(place: &str) -> String {
    format!("A corner at {place}: {{mark}} again copies the box to the opposite corner")
}

pub fn copied(size: &str, from: &str, solid: usize) -> String {
    format!(
        "Copied {size} voxels from {from}, {solid} of them solid: {{paste}} pastes them, {{turn}} turns them"
    )
}

pub const REPLACING: &str = "Replacing needs a material in the hand";
pub const NO_UNDO: &str = "There is nothing to undo";
pub const NO_REDO: &str = "There is nothing to redo";
pub const OUT_OF_REACH: &str = "Nothing is within reach: {forward} goes nearer";

pub fn too_large(size: &str, most: i32) -> String {
    format!(
        "This box has {size} voxels. A copy has at most {most} along an edge: mark a nearer corner"
    )
}

pub fn pasted(place: &str, changed: u64, outside: u64) -> String {
    let mut text = format!("Pasted at {place}: {changed} voxels changed");
    if outside > 0 {
        text += &format!(", {outside} lie outside of the world");
    }
    text
}

pub fn no_material(names: &str, voxels: u64) -> String {
    format!("This world has no material {names}: {voxels} voxels were left out")
}

pub fn lost_bodies(lost: u64) -> String {
    format!("{lost} bodies that you placed or pushed have no place or no material any more")
}

pub fn lost_voxels(lost: u64) -> String {
    format!("{lost} changed voxels have no place or no material any more")
}

pub fn unknown_file(path: &str) -> String {
    format!(
        "{path}: only world files (.ron), saves (.grotto) and MagicaVoxel models (.vox) can be opened"
    )
}

pub fn silent(reason: &str) -> String {
    format!("No sound: {reason}")
}

pub fn brush(brush: &Brush) -> String {
    match brush.shape {
        Shape::Voxel => "Brush: one voxel ({brush_shape} changes the shape)".to_owned(),
        Shape::Ball | Shape::Box => format!(
            "Brush: {} ({{smaller_brush}} and {{larger_brush}} change the size)",
            brush.text()
        ),
    }
}

pub const NO_PROBES: &str = "no probes in the picture";

pub fn probes_by(colour: &str) -> String {
    format!("probes by {colour}")
}

pub fn saved(path: &Path) -> String {
    format!("saved {}", path.display())
}

pub fn unkept_settings(reason: &str) -> String {
    format!("The settings cannot be kept. {reason}")
}
