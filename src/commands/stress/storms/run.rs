//! Runs one storm from its first frame to its last check.

use std::{
    cell::Cell,
    collections::BTreeMap,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use glam::Vec3;
use indicatif::ProgressBar;

use super::{
    changes::{self, Dice, RATE, VOXELS_PER_SECOND},
    judge::{self, Check},
    kinds::{Kind, Kinds},
    report::Measured,
    rig::{Now, Rig, Scene},
    soak::{Footprint, Process, Sample},
};
use crate::{commands::Failure, gpu::Gpu, measure::statistics::median};

/// The length of a storm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Frames: repeats exactly with the same seed.
    Frames(u32),
    /// Minutes of real time.
    Minutes(f64),
}

/// The description of a storm.
pub struct Plan<'a> {
    pub scene: &'a Scene,
    /// The state of the first frame.
    pub start: Now,
    pub kinds: Kinds,
    pub length: Length,
    /// Frames without a change, before pictures are compared.
    pub settling: u32,
    pub seed: u32,
    /// A fault planted on purpose.
    pub planted: Planted,
}

/// Faults that tests plant, to show that each check finds its fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planted {
    #[default]
    Nothing,
    /// One stroke does not reach the GPU.
    EditOnCpuOnly,
    /// After the storm the light is computed from other lamps.
    StaleLight,
    /// In each frame a buffer is leaked.
    LeakedBuffer,
    /// The result of a probe ray is NaN.
    NotANumber,
    /// A call that the device rejects.
    InvalidCall,
    /// The last layout is not applied.
    KeptProbes,
    /// A new device gets the voxels without their edits.
    LostEdits,
    /// Lamps are a second late.
    LateLamps,
}

/// The results of a storm.
pub struct Found {
    pub frames: u32,
    pub complete: bool,
    pub changes: BTreeMap<&'static str, u64>,
    pub checks: Vec<Check>,
    pub measured: Measured,
}

/// Frames between two checks of the light.
const FRAMES_TO_LOOK: u32 = 64;
/// Frames of a soak between two samples.
const FRAMES_TO_SAMPLE: u32 = 8;
/// Soaks: frames between two edits, number of places that are dug and filled in turn, and their radius.
const FRAMES_TO_DIG: u32 = 30;
const SOAK_PLACES: u32 = 8;
const SOAK_RADIUS: f32 = 2.5;

/// A storm in progress.
pub(super) struct Storm<'a> {
    pub plan: &'a Plan<'a>,
    pub rig: Rig<'a>,
    dice: BTreeMap<Kind, Dice>,
    /// Voxels that may be rewritten now.
    credit: f64,
    /// Footprint of the device without the frame.
    pub before: Footprint,
    leaked: Vec<wgpu::Buffer>,
    pub not_finite: u64,
    pub refused: Vec<String>,
    pub unheard_losses: u64,
    pub late_lamps: u64,
    pub found: Found,
}

/// Runs a storm and judges it. `stop` ends the storm early: then it is not judged.
pub fn run(
    gpu: Gpu,
    plan: &Plan<'_>,
    stop: &AtomicBool,
    bar: &ProgressBar,
) -> Result<Found, Failure> {
    let before = Footprint::of(&gpu);
    let rig = Rig::new(gpu, plan.scene, plan.start.clone())?;
    let mut storm = Storm {
        plan,
        rig,
        dice: Kind::ALL
            .map(|kind| (kind, Dice::new(plan.seed, kind)))
            .into(),
        credit: 0.0,
        before,
        leaked: Vec::new(),
        not_finite: 0,
        refused: Vec::new(),
        unheard_losses: 0,
        late_lamps: 0,
        found: Found {
            frames: 0,
            complete: false,
            changes: BTreeMap::new(),
            checks: Vec::new(),
            measured: Measured::default(),
        },
    };
    let stopped = Cell::new(false);
    let after = || {
        bar.inc(1);
        stopped.set(stop.load(Ordering::Relaxed));
        if stopped.get() {
            return Err(Failure::interrupted("stopped"));
        }
        Ok(())
    };
    match storm.blow(&after).and_then(|()| storm.judge(&after)) {
        Err(_) if stopped.get() => {
            storm.found.checks.clear();
            Ok(storm.found)
        }
        Err(failure) => Err(failure),
        Ok(()) => {
            storm.found.complete = true;
            Ok(storm.found)
        }
    }
}

pub(super) type After<'f> = &'f dyn Fn() -> Result<(), Failure>;

impl Storm<'_> {
    pub fn has(&self, kind: Kind) -> bool {
        self.plan.kinds.has(kind)
    }

    fn count(&mut self, what: &'static str, count: u64) {
        *self.found.changes.entry(what).or_default() += count;
    }

    fn dice(&mut self, kind: Kind) -> &mut Dice {
        self.dice.get_mut(&kind).expect("every kind has its dice")
    }

    fn is_due(&mut self, kind: Kind, frame: u32, every: std::ops::RangeInclusive<u32>) -> bool {
        self.has(kind) && self.dice(kind).is_due(frame, every)
    }

    /// Draws the frames of the storm.
    fn blow(&mut self, after: After<'_>) -> Result<(), Failure> {
        let start = Instant::now();
        let mut process = Process::this();
        let mut frame_ms = Vec::new();
        loop {
            let frame = self.found.frames;
            let seconds = start.elapsed().as_secs_f64();
            let is_over = match self.plan.length {
                Length::Frames(frames) => frame >= frames,
                Length::Minutes(minutes) => seconds >= 60.0 * minutes,
            };
            if is_over {
                break;
            }
            self.change(frame)?;
            let drawn = Instant::now();
            self.rig.step()?;
            frame_ms.push(drawn.elapsed().as_secs_f64() * 1e3);
            if self.plan.planted == Planted::LeakedBuffer {
                let leaked = self.rig.gpu.storage_buffer("leaked", 1 << 16)?;
                self.leaked.push(leaked);
            }
            if frame.is_multiple_of(FRAMES_TO_LOOK) {
                self.look()?;
            }
            if self.has(Kind::Soak) && (frame + 1).is_multiple_of(FRAMES_TO_SAMPLE) {
                let footprint = Footprint::of(&self.rig.gpu);
                self.found.measured.samples.push(Sample {
                    time_s: start.elapsed().as_secs_f64(),
                    process_bytes: process.bytes() as f64,
                    adapter_bytes: footprint.bytes as f64,
                    objects: footprint.objects as f64,
                    frame_ms: median(&frame_ms).unwrap_or_default(),
                });
                frame_ms.clear();
            }
            self.found.frames = frame + 1;
            self.found.measured.seconds = start.elapsed().as_secs_f64();
            after()?;
        }
        Ok(())
    }

    /// Applies all changes before a frame.
    fn change(&mut self, frame: u32) -> Result<(), Failure> {
        let plan = self.plan;
        self.rig.now.camera = changes::camera(&plan.scene.world.cameras, frame);
        self.rig.now.time_s += 1.0 / f64::from(RATE);
        if self.is_due(Kind::Loss, frame, 20..=60) {
            self.lose_device()?;
        }
        if self.is_due(Kind::Layout, frame, 3..=12) {
            let layouts = &plan.scene.world.layouts;
            let parameters = &plan.start.parameters;
            let (layout, parameters) = self.dice(Kind::Layout).layout(layouts, parameters);
            let taken = self.rig.replace_probes(layout, parameters)?;
            self.count(if taken { "layouts" } else { "layouts refused" }, 1);
        }
        if self.is_due(Kind::Resize, frame, 2..=6) {
            let size = self.dice(Kind::Resize).size(plan.start.size);
            self.rig.resize(size)?;
            self.count("sizes", 1);
        }
        if self.is_due(Kind::Time, frame, 5..=20) {
            let now_s = self.rig.now.time_s;
            self.rig.now.time_s = self.dice(Kind::Time).time(now_s);
            self.count("jumps", 1);
        }
        if self.has(Kind::Edit) {
            self.edit()?;
        }
        if self.has(Kind::Soak) && frame.is_multiple_of(FRAMES_TO_DIG) {
            self.dig(frame / FRAMES_TO_DIG)?;
        }
        Ok(())
    }

    fn edit(&mut self) -> Result<(), Failure> {
        self.credit += f64::from(VOXELS_PER_SECOND) / f64::from(RATE);
        let world = &self.plan.scene.world;
        let here = self.rig.now.camera.position.floor().as_ivec3() - world.origin;
        let materials = world.materials.len().min(255) as u8;
        while self.credit > 0.0 {
            let stroke = self.dice(Kind::Edit).stroke(world.size, here, materials);
            self.credit -= f64::from(stroke.voxels());
            self.rig.edit(|voxels| stroke.make(voxels))?;
            self.count("strokes", 1);
            self.count("voxels", u64::from(stroke.voxels()));
        }
        Ok(())
    }

    /// Slow edits that leave the number of solid voxels unchanged: a few balls are dug and filled in turn.
    fn dig(&mut self, index: u32) -> Result<(), Failure> {
        let world = &self.plan.scene.world;
        let camera = &world.cameras[0];
        let turn = (index % SOAK_PLACES) as f32 / SOAK_PLACES as f32 * std::f32::consts::TAU;
        let around = Vec3::new(turn.cos(), -0.5, turn.sin()) * 8.0;
        let centre = camera.position + around - world.origin.as_vec3();
        let material = (index / SOAK_PLACES % 2) as u8;
        self.count("strokes", 1);
        self.rig
            .edit(|voxels| voxels.fill_sphere(centre, SOAK_RADIUS, material))
    }

    pub fn lose_device(&mut self) -> Result<(), Failure> {
        self.hear_device_errors();
        let heard = self
            .rig
            .lose_device(self.plan.planted == Planted::LostEdits)?;
        self.unheard_losses += u64::from(!heard);
        self.count("losses", 1);
        Ok(())
    }

    /// Collects errors that the device has reported asynchronously.
    pub fn hear_device_errors(&mut self) {
        self.refused.extend(
            self.rig
                .device_errors
                .first()
                .map(|fault| fault.to_string()),
        );
    }

    pub fn look(&mut self) -> Result<(), Failure> {
        if self.plan.planted == Planted::NotANumber {
            let rays = self.rig.frame.field().rays();
            self.rig
                .gpu
                .queue
                .write_buffer(rays, 0, &f32::NAN.to_le_bytes());
        }
        self.not_finite += judge::not_finite(&self.rig.gpu, &self.rig.frame)?;
        Ok(())
    }
}
