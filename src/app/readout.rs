//! What a player can keep on the picture: where they are, what they aim at, and how fast frames are.

use egui::{Align2, Area, Color32, Frame, Id, RichText, Ui};
use glam::IVec3;

use super::{
    clock::WorldClock,
    hands::aim::Target,
    named_lines,
    panel::{Facts, digits, told},
    texts::readout as texts,
    time_graph,
};
use crate::world::{Camera, PlacedLamp, World, placed};

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
                named_lines::show(ui, &lines(facts, clock, aimed));
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
        (texts::AT, place(facts.camera)),
        (
            texts::LOOKS,
            direction(facts.camera.yaw_deg, facts.camera.pitch_deg),
        ),
        (texts::AIMS_AT, target(facts.viewport.world(), aimed)),
        (texts::TIME, time(clock)),
        (texts::PICTURE, facts.picture_in_words()),
        (texts::QUALITY, facts.effort_in_words()),
        (texts::PROBES, probes),
        (
            texts::SOUND,
            facts
                .silence
                .clone()
                .unwrap_or_else(|| texts::HEARD.to_owned()),
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
        return texts::NOTHING.to_owned();
    };
    let voxel = target.voxel + world.origin;
    let IVec3 { x, y, z } = voxel;
    let name = match usize::from(target.material).checked_sub(1) {
        Some(index) => (world.materials.get(index)).map(|material| material.name.clone()),
        None => placed::at(&world.restored.lamps, voxel).map(lamp),
    };
    let name = name.unwrap_or_else(|| "?".to_owned());
    format!("{name}  ({x}, {y}, {z})")
}

fn lamp(lamp: &PlacedLamp) -> String {
    let off = if lamp.is_on { "" } else { texts::LAMP_OFF };
    format!("{}{off}", lamp.block.name())
}

fn time(clock: &WorldClock) -> String {
    let pace = match (clock.paused, clock.rate) {
        (true, _) => texts::PAUSED.to_owned(),
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
        let mut world = file::load(&path, &Overrides::default()).expect("it loads");
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
        let mut hung = placed::tests::lamp(IVec3::new(1, 2, 3));
        hung.is_on = false;
        world.restored.lamps.push(hung);
        let at_lamp = Target {
            material: 0,
            ..aimed
        };
        let told = target(&world, Some(&at_lamp));
        assert_eq!(told, format!("{}, off  (1, 2, 3)", hung.block.name()));
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
