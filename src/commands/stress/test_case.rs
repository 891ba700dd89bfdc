//! A world with everything that a scene takes from it, and the script by which it is played.

use super::{
    super::{Failure, options},
    grammar::{Dice, SCRIPT},
};
use crate::{
    lights::Lights,
    parameters::Parameters,
    world::{Camera, LampPreset, LayoutSpec, World},
};
use std::path::Path;

/// Everything that is rendered.
pub struct TestCase {
    pub world: World,
    pub parameters: Parameters,
    pub layout: LayoutSpec,
    pub lamps: LampPreset,
    pub script: Script,
}

/// The events of a scene. Places are shares of the world's box, so that they also exist in a smaller world.
#[derive(Clone, Debug)]
pub struct Script {
    /// World time of the first frame, and the length of the jump (seconds).
    pub start_s: f64,
    pub jump_s: f64,
    /// The place that the camera flies to.
    pub goal: [f64; 3],
    pub edits: Vec<EditPlan>,
    camera: u32,
    layout: u32,
}

#[derive(Clone, Copy, Debug)]
pub struct EditPlan {
    pub at: [f64; 3],
    pub radius: f64,
    /// A ball if true, else a box.
    pub round: bool,
    /// Air if `None`, else the material of this number modulo the number of materials.
    pub material: Option<u32>,
}

/// Number of edits in a scene.
const EDITS: u32 = 3;

impl Script {
    fn of(seed: u32) -> Self {
        let mut dice = Dice::new(seed, SCRIPT);
        let edit = |dice: &mut Dice| EditPlan {
            at: [0; 3].map(|_| dice.number(-0.1, 1.1)),
            radius: dice.number(0.5, 6.0),
            round: dice.chance(0.6),
            material: dice.chance(0.5).then(|| dice.whole(0, 99)),
        };
        Self {
            start_s: dice.number(0.0, 20.0),
            jump_s: dice.number(-1000.0, 1000.0),
            goal: [0; 3].map(|_| dice.number(-0.2, 1.2)),
            camera: dice.whole(0, 99),
            layout: dice.whole(0, 99),
            edits: (0..EDITS).map(|_| edit(&mut dice)).collect(),
        }
    }
}

impl TestCase {
    /// # Errors
    /// For an invalid parameter, and for a lamp preset that the world does not have.
    pub fn of(world: World, set: &[String], seed: u32) -> Result<Self, Failure> {
        let mut parameters = Parameters::default();
        for assignment in set {
            parameters.set(assignment)?;
        }
        let script = Script::of(seed);
        let preset = Some(&parameters.lights.preset).filter(|name| !name.is_empty());
        let presets = &world.lamp_presets;
        let path = Path::new(&world.name);
        let mut lamps =
            options::choose(path, "lamp preset", presets, |p| &p.name, &preset.cloned())?;
        lamps.lamps.truncate(parameters.lights.max_lamps as usize);
        let layout = world.layouts[script.layout as usize % world.layouts.len()].clone();
        Ok(Self {
            world,
            parameters,
            layout,
            lamps,
            script,
        })
    }

    pub fn camera(&self) -> &Camera {
        &self.world.cameras[self.script.camera as usize % self.world.cameras.len()]
    }

    /// The lights at a time after the start of the scene.
    pub fn lights(&self, elapsed_s: f64) -> Lights {
        let time_s = if self.parameters.lights.animate {
            self.script.start_s + elapsed_s
        } else {
            0.0
        };
        Lights::at(&self.world, &self.lamps, time_s)
    }
}
