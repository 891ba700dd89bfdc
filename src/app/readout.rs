//! What a player can keep on the picture: where they are, what they aim at, and how fast frames are.

use egui::{Align2, Area, Color32, Frame, Grid, Id, RichText, Ui};
use glam::IVec3;

use super::{
    clock::WorldClock,
    hands::aim::Target,
    panel::{Facts, digits, told},
    time_graph,
};
use crate::world::{Camera, World};

const WIDTH: f32 = 236.0;
const FILL: Color32 = Color32::from_black_alpha(150);
const MARGIN: f32 = 12.0;

/// Draws the figures in the upper right corner. They take no clicks.
pub fn show(ui: &Ui, facts: &Facts<'_>, clock: &WorldClock, aimed: Option<&Target>) {
    Area::new(Id::unique("readout"))
        .anchor(Align2::RIGHT_TOP, [-MARGIN, MARGIN])
        .interactable(false)
        .show(ui.ctx(), |ui| {
            let frame = Frame::popup(ui.style()).fill(FILL);
            frame.show(ui, |ui| {
                ui.set_width(WIDTH);
                let fps = facts.rate.fps().unwrap_or(0.0);
                ui.label(RichText::new(format!("{} FPS", digits(fps))).strong());
                time_graph::show(ui, facts.rate);
                Grid::new("readout")
                    .num_columns(2)
                    .max_col_width(WIDTH - 56.0)
                    .spacing([8.0, 2.0])
                    .show(ui, |ui| {
                        for (name, value) in lines(facts, clock, aimed) {
                            ui.weak(name);
                            ui.label(value);
                            ui.end_row();
                        }
                    });
            });
        });
}

fn lines(
    facts: &Facts<'_>,
    clock: &WorldClock,
    aimed: Option<&Target>,
) -> [(&'static str, String); 8] {
    let frame = facts.viewport.frame();
    let probes = match &facts.probes {
        Some(counts) => told(counts),
        None => frame.field().volume().probes().to_string(),
    };
    [
        ("at", place(facts.camera)),
        (
            "looks",
            direction(facts.camera.yaw_deg, facts.camera.pitch_deg),
        ),
        ("aims at", target(facts.viewport.world(), aimed)),
        ("time", time(clock)),
        ("picture", facts.picture_in_words()),
        ("quality", facts.effort_in_words()),
        ("probes", probes),
        (
            "sound",
            facts.silence.clone().unwrap_or_else(|| "on".to_owned()),
        ),
    ]
}

/// The eye, in voxels of the world.
fn place(camera: &Camera) -> String {
    let at = camera.position;
    format!("{:.1}  {:.1}  {:.1}", at.x, at.y, at.z)
}

fn direction(yaw_deg: f32, pitch_deg: f32) -> String {
    let yaw_deg = yaw_deg.rem_euclid(360.0);
    format!("yaw {yaw_deg:.0}°, pitch {pitch_deg:.0}°")
}

fn target(world: &World, aimed: Option<&Target>) -> String {
    let Some(target) = aimed else {
        return "nothing in reach".to_owned();
    };
    let IVec3 { x, y, z } = target.voxel + world.origin;
    let index = usize::from(target.material).checked_sub(1);
    let material = index.and_then(|index| world.materials.get(index));
    let name = material.map_or("?", |material| &*material.name);
    format!("{name}  ({x}, {y}, {z})")
}

fn time(clock: &WorldClock) -> String {
    let pace = match (clock.paused, clock.rate) {
        (true, _) => ", paused".to_owned(),
        (false, 1.0) => String::new(),
        (false, rate) => format!(", × {rate}"),
    };
    format!("{:.1} s{pace}", clock.time_s)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::world::file::{self, Overrides};

    #[test]
    fn the_target_is_told_in_world_space_by_the_name_of_its_material() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = file::load(&path, &Overrides::default()).expect("it loads");
        let aimed = Target {
            voxel: IVec3::new(1, 2, 3) - world.origin,
            face: Some(0),
            material: 1,
        };
        let told = target(&world, Some(&aimed));
        assert_eq!(told, format!("{}  (1, 2, 3)", world.materials[0].name));
        assert_eq!(target(&world, None), "nothing in reach");
        let unknown = Target {
            material: 255,
            ..aimed
        };
        assert!(target(&world, Some(&unknown)).starts_with('?'));
    }

    #[test]
    fn directions_and_times_are_short() {
        assert_eq!(direction(-90.0, 12.4), "yaw 270°, pitch 12°");
        let mut clock = WorldClock {
            time_s: 1.25,
            ..WorldClock::default()
        };
        assert_eq!(time(&clock), "1.2 s");
        clock.rate = 2.0;
        assert_eq!(time(&clock), "1.2 s, × 2");
        clock.paused = true;
        assert_eq!(time(&clock), "1.2 s, paused");
    }
}
