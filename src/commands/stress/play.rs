//! Plays a scene from start to end: frames at rest, moving time and camera, edits, and frames that settle.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3, Vec3};

use super::{
    super::Failure,
    checks::darkness::Reached,
    fault::Fault,
    test_case::{EditPlan, TestCase},
};
use crate::{
    frame::{Frame, Stage},
    gpu::{Gpu, Recorder, Timing},
    lights::Lights,
    parameters::{Method, ProbeParameters, SourceWeights},
    passes::view::Shot,
    world::{View, voxels::Voxels},
};

/// Width and height of the pictures: small, so that a scene takes about a second on a software adapter.
pub const SIZE: [u32; 2] = [48, 32];
/// Frames at rest, in motion, after each edit, after the jump, and until the light has settled again.
const FIRST: u32 = 4;
const MOVING: u32 = 6;
const AFTER_EDIT: u32 = 2;
const JUMPED: u32 = 2;
const SETTLING: u32 = 32;
/// Seconds of world time between frames in motion.
const FRAME_S: f64 = 1.0 / 60.0;

/// The parts of a scene, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    First,
    Moving,
    Edits,
    Jump,
    /// Fresh probes under constant lights, for the comparison with a reference.
    Settled,
}

impl Part {
    pub const ALL: [Self; 5] = [
        Self::First,
        Self::Moving,
        Self::Edits,
        Self::Jump,
        Self::Settled,
    ];

    /// Whether places that light has not reached in any frame must be black. For some frames after edits and after a jump they have
    /// up to some thousandths of the light elsewhere (docs/stress.md).
    pub fn is_dark_where_no_light_was(self) -> bool {
        matches!(self, Self::First | Self::Moving | Self::Settled)
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::First => "at first",
            Self::Moving => "in motion",
            Self::Edits => "after edits",
            Self::Jump => "after a jump in time",
            Self::Settled => "settled",
        }
    }
}

pub struct Play<'a> {
    pub gpu: &'a Gpu,
    pub case: &'a TestCase,
    pub frame: Frame,
    /// The CPU's copy, with the same edits.
    pub voxels: Voxels,
    pub shot: Shot,
    /// Where light may have come since the probes were new, in the parts that are judged by it; `None` if nobody asks.
    pub reached: Option<Reached>,
    probes: ProbeParameters,
    elapsed_s: f64,
    timing: Timing,
    /// The longest time of each pass in a frame (milliseconds), where the adapter reports it.
    pub longest_ms: BTreeMap<String, f64>,
}

impl<'a> Play<'a> {
    /// # Errors
    /// When the adapter cannot hold the scene.
    pub fn new(
        gpu: &'a Gpu,
        case: &'a TestCase,
        stage: Stage,
        fault: Option<Fault>,
    ) -> Result<Self, Failure> {
        let parameters = &case.parameters;
        let mut probes = parameters.probes.clone();
        if fault == Some(Fault::Leak) {
            // Interpolation of the source documents, without the test that hides probes behind walls.
            probes.method = Method::Source;
            probes.source.weights = SourceWeights::Direction;
        }
        let voxels = stage.read_back(gpu)?;
        Ok(Self {
            gpu,
            case,
            frame: Frame::new(gpu, stage, &case.layout, &probes, SIZE)?,
            voxels,
            shot: Shot {
                camera: case.camera().clone(),
                size: SIZE,
                frame: 0,
                seed: 0,
                exposure_ev: parameters.picture.exposure_ev,
                view: View::Full,
                time_s: case.script.start_s,
                textures: parameters.textures.enabled,
                soft_rays: parameters.lights.soft_rays,
                shadows: parameters.lights.shadows,
            },
            reached: None,
            probes,
            elapsed_s: 0.0,
            timing: Timing::new(gpu)?,
            longest_ms: BTreeMap::new(),
        })
    }

    /// The lights of the last frame.
    pub fn lights(&self) -> Lights {
        self.case.lights(self.elapsed_s)
    }

    /// # Errors
    /// When the adapter fails.
    pub fn part(&mut self, part: Part) -> Result<(), Failure> {
        match part {
            Part::First => {
                self.follow_light();
                self.frames(FIRST)
            }
            Part::Moving => self.walk(),
            Part::Edits => {
                self.shot.camera = self.case.camera().clone();
                for plan in &self.case.script.edits {
                    self.edit(plan)?;
                    self.frames(AFTER_EDIT)?;
                }
                Ok(())
            }
            Part::Jump => {
                self.elapsed_s += self.case.script.jump_s;
                self.shot.camera.position = self.place(self.case.script.goal) + Vec3::splat(999.0);
                self.frames(1)?;
                self.shot.camera = self.case.camera().clone();
                self.frames(JUMPED)
            }
            Part::Settled => {
                self.reached = self.reached.is_some().then(Reached::default);
                self.follow_light();
                self.frame
                    .replace_probes(self.gpu, &self.case.layout, &self.probes)?;
                self.frames(SETTLING)
            }
        }
    }

    /// Time advances, and the camera flies to the goal.
    fn walk(&mut self) -> Result<(), Failure> {
        let start = self.case.camera().clone();
        let goal = self.place(self.case.script.goal);
        for step in 1..=MOVING {
            self.elapsed_s += FRAME_S;
            let way = step as f32 / MOVING as f32;
            self.shot.camera.position = start.position.lerp(goal, way);
            self.shot.camera.yaw_deg = start.yaw_deg + 40.0 * way;
            self.follow_light();
            self.frames(1)?;
        }
        Ok(())
    }

    /// Notes where the lights of the next frame may reach.
    fn follow_light(&mut self) {
        let lights = self.lights();
        let time_s = self.case.script.start_s + self.elapsed_s;
        if let Some(reached) = &mut self.reached {
            reached.add(&self.case.world, &self.voxels, &lights, time_s);
        }
    }

    fn frames(&mut self, count: u32) -> Result<(), Failure> {
        for _ in 0..count {
            let lights = self.lights();
            self.shot.frame = self.frame.frames();
            self.shot.time_s = self.case.script.start_s + self.elapsed_s;
            // On a software adapter, timing would run the passes one after another, as no normal frame does.
            let timed = !self.gpu.summary.is_software();
            let mut recorder = Recorder::new(self.gpu, timed.then_some(&mut self.timing));
            self.frame
                .record(self.gpu, &mut recorder, &self.shot, &lights, &self.probes);
            recorder.submit(self.gpu)?;
            self.gpu.wait()?;
            while let Some(times) = self.timing.next_frame() {
                for (pass, ms) in times.passes_ms {
                    let longest = self.longest_ms.entry(pass).or_default();
                    *longest = longest.max(ms);
                }
            }
        }
        Ok(())
    }

    /// The world-space position of a point given in shares of the world's box.
    fn place(&self, share: [f64; 3]) -> Vec3 {
        let world = &self.case.world;
        let share = DVec3::from_array(share);
        (world.origin.as_dvec3() + share * world.size.as_dvec3()).as_vec3()
    }

    fn edit(&mut self, plan: &EditPlan) -> Result<(), Failure> {
        let world = &self.case.world;
        let centre_gs = self.place(plan.at) - world.origin.as_vec3();
        let materials = world.materials.len() as u32;
        let material = plan
            .material
            .map_or(0, |number| (number % materials + 1) as u8);
        let radius = plan.radius as f32;
        let edit = if plan.round {
            self.voxels.fill_sphere(centre_gs, radius, material)
        } else {
            let corner = |sign: f32| (centre_gs + sign * radius * Vec3::new(1.0, 0.5, 0.3)).floor();
            let (low, high): (IVec3, IVec3) = (corner(-1.0).as_ivec3(), corner(1.0).as_ivec3());
            self.voxels.fill_box(low, high, material)
        };
        Ok(self.frame.apply(self.gpu, &self.voxels, &edit)?)
    }
}
