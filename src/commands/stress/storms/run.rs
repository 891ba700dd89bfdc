//! One storm from its first frame to its last check.

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
    soak::{self, Footprint, Process, Sample},
};
use crate::{commands::Failure, gpu::Gpu, measure::statistics::median};

/// How long a storm blows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Repeats exactly with the same seed.
    Frames(u32),
    /// By the clock on the wall.
    Minutes(f64),
}

/// What a storm is made of.
pub struct Plan<'a> {
    pub scene: &'a Scene,
    /// What the first frame shows.
    pub start: Now,
    pub kinds: Kinds,
    pub length: Length,
    /// Frames without a change, before pictures are compared.
    pub settling: u32,
    pub seed: u32,
    /// Something that is wrong on purpose.
    pub planted: Planted,
}

/// Faults that tests plant, to show that each check finds its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planted {
    #[default]
    Nothing,
    /// One stroke does not reach the GPU.
    EditOnCpuOnly,
    /// After the storm the light is that of other lamps.
    StaleLight,
    /// A buffer in each frame is never given back.
    LeakedBuffer,
    /// What a probe ray has found is not a number.
    NotANumber,
    /// A call that the device refuses.
    InvalidCall,
    /// The last layout is not taken.
    KeptProbes,
    /// A new device gets the voxels as nobody has edited them.
    LostEdits,
    /// Lamps are a second late.
    LateLamps,
}

/// What a storm has found.
pub struct Found {
    pub frames: u32,
    pub complete: bool,
    pub changes: BTreeMap<&'static str, u64>,
    pub checks: Vec<Check>,
    pub measured: Measured,
}

/// Frames after a remake or a loss, before the picture must be that of a fresh start to the bit.
const EXACT_FRAMES: u32 = 12;
/// Pictures of other seeds that tell how large the noise is.
const FRESH_PICTURES: u32 = 3;
/// Frames from one look at the light to the next.
const FRAMES_TO_LOOK: u32 = 64;
/// Frames of a soak from one sample to the next.
const FRAMES_TO_SAMPLE: u32 = 16;
/// Frames from one edit of a soak to the next, places that it digs and fills in turn, and their radius.
const FRAMES_TO_DIG: u32 = 30;
const SOAK_PLACES: u32 = 8;
const SOAK_RADIUS: f32 = 2.5;
/// Voxels around the camera that are air when pictures are compared.
const AIR_RADIUS: f32 = 4.5;
/// What may be left beside the memory of a fresh frame: objects, and bytes on the adapter.
const SLACK_OBJECTS: f64 = 4.0;
const SLACK_BYTES: f64 = 2.0 * 1024.0 * 1024.0;
/// How much larger than those of a fresh frame the buffers may be that edits have made grow.
const GROWN: f64 = 2.0;

struct Storm<'a> {
    plan: &'a Plan<'a>,
    rig: Rig<'a>,
    dice: BTreeMap<Kind, Dice>,
    /// Voxels that may be rewritten by now.
    credit: f64,
    /// What the device holds apart from the frame.
    before: Footprint,
    leaked: Vec<wgpu::Buffer>,
    not_finite: u64,
    refused: Vec<String>,
    unheard_losses: u64,
    late_lamps: u64,
    found: Found,
}

/// Runs a storm and judges it. `stop` ends it early: then it is not judged.
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

type After<'f> = &'f dyn Fn() -> Result<(), Failure>;

impl Storm<'_> {
    fn has(&self, kind: Kind) -> bool {
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
        let mut process = Process::new();
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

    /// All that changes before a frame.
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

    /// Slow edits, which leave as much stone as there was: a few balls are dug and filled in turn.
    fn dig(&mut self, index: u32) -> Result<(), Failure> {
        let world = &self.plan.scene.world;
        let camera = &world.cameras[0];
        let turn = (index % SOAK_PLACES) as f32 / SOAK_PLACES as f32 * std::f32::consts::TAU;
        let around = Vec3::new(turn.cos(), -0.5, turn.sin()) * 8.0;
        let centre = camera.position + around - world.origin.as_vec3();
        let material = if index / SOAK_PLACES % 2 == 0 { 0 } else { 1 };
        self.count("strokes", 1);
        self.rig
            .edit(|voxels| voxels.fill_sphere(centre, SOAK_RADIUS, material))
    }

    fn lose_device(&mut self) -> Result<(), Failure> {
        self.hear_faults();
        let heard = self
            .rig
            .lose_device(self.plan.planted == Planted::LostEdits)?;
        self.unheard_losses += u64::from(!heard);
        self.count("losses", 1);
        Ok(())
    }

    /// Errors that the device has reported on its own.
    fn hear_faults(&mut self) {
        self.refused
            .extend(self.rig.faults.first().map(|fault| fault.to_string()));
    }

    fn look(&mut self) -> Result<(), Failure> {
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

    /// Settles, and compares with what never saw a storm.
    fn judge(&mut self, after: After<'_>) -> Result<(), Failure> {
        self.plant()?;
        self.still_scene()?;
        self.look()?;
        self.rig.steps(self.plan.settling, after)?;
        self.look()?;
        let picture = self.rig.frame.read_radiance(&self.rig.gpu)?;
        let stormed = Footprint::of(&self.rig.gpu);

        let mut fresh = Vec::new();
        for index in 1..=FRESH_PICTURES {
            let seed = self.rig.now.seed.wrapping_add(index);
            let (frame, picture) = self.rig.fresh(seed, self.plan.settling, after)?;
            fresh.push(picture);
            if index == 1 {
                let (both, own) = (Footprint::of(&self.rig.gpu), frame.memory().total);
                self.memory(stormed, both, own);
            }
        }
        let exposure_ev = self.plan.start.parameters.picture.exposure_ev;
        let light = judge::light("light", &picture, &fresh, exposure_ev)?;
        self.found.checks.extend(light);
        let mean = picture
            .rgb
            .iter()
            .flatten()
            .map(|&value| f64::from(value))
            .sum::<f64>();
        let mean = mean / (3 * picture.rgb.len()) as f64;
        self.found
            .measured
            .values
            .insert("light.mean_radiance".to_owned(), mean);

        self.voxels("")?;
        if self.has(Kind::Time) {
            let name = "time.lamps_differ";
            self.found.checks.push(Check::none(name, self.late_lamps));
        }
        if self.has(Kind::Layout) {
            if self.plan.planted != Planted::KeptProbes {
                let Now {
                    layout, parameters, ..
                } = self.rig.now.clone();
                self.rig.replace_probes(layout, parameters)?;
            }
            self.exact("layout.pixels_differ", after)?;
        }
        if self.has(Kind::Loss) {
            self.lose_device()?;
            self.exact("loss.pixels_differ", after)?;
            self.voxels("loss.")?;
            let unheard = Check::none("loss.unheard", self.unheard_losses);
            self.found.checks.push(unheard);
        }
        if self.has(Kind::Soak) {
            let software = self.rig.gpu.summary.is_software();
            let times_count = self.plan.kinds.only(Kind::Soak) && !software;
            let Measured {
                samples, values, ..
            } = &mut self.found.measured;
            let checks = soak::judge(samples, times_count, values);
            self.found.checks.extend(checks);
        }
        self.hear_faults();
        for refused in &self.refused {
            tracing::error!("the device has refused: {refused}");
        }
        let checks = [
            Check::none("light.not_finite", self.not_finite),
            Check::none("device.errors", self.refused.len() as u64),
        ];
        self.found.checks.extend(checks);
        Ok(())
    }

    /// What nothing changes any longer: a camera of the world in some air, at the time when the storm ended, in a
    /// picture that is large enough to be compared.
    fn still_scene(&mut self) -> Result<(), Failure> {
        let world = &self.plan.scene.world;
        self.rig.now.camera = world.cameras[0].clone();
        let eye = self.rig.now.camera.position - world.origin.as_vec3();
        if self.has(Kind::Edit) {
            self.rig
                .edit(|voxels| voxels.fill_sphere(eye, AIR_RADIUS, 0))?;
        }
        if self.has(Kind::Resize) {
            self.rig.resize(self.plan.start.size.map(|edge| edge | 1))?;
        }
        if self.has(Kind::Time) {
            // The lamps of a moment are the same, whatever moments came before.
            let mut now = self.rig.now.clone();
            if self.plan.planted == Planted::LateLamps {
                now.time_s -= 1.0;
            }
            let (there, again) = (
                self.plan.scene.lights(&now),
                self.plan.scene.lights(&self.rig.now),
            );
            let finite = again.lamps.iter().all(|lamp| {
                lamp.position_ws.is_finite()
                    && lamp.intensity.is_finite()
                    && lamp.direction_ws.is_finite()
            });
            self.late_lamps = u64::from(there != again || !finite);
        }
        Ok(())
    }

    /// Makes wrong what a test wants to be wrong.
    fn plant(&mut self) -> Result<(), Failure> {
        match self.plan.planted {
            Planted::EditOnCpuOnly => {
                let last = self.plan.scene.world.size.as_ivec3() - 1;
                self.rig.voxels.fill_box(last - 2, last, 1);
            }
            Planted::StaleLight => {
                let mut lights = self.plan.scene.lights(&self.rig.now);
                lights
                    .lamps
                    .iter_mut()
                    .for_each(|lamp| lamp.intensity *= 0.5);
                self.rig.stale = Some(lights);
            }
            Planted::InvalidCall => {
                let _ = self.rig.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("planted"),
                    size: 16,
                    usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE,
                    mapped_at_creation: false,
                });
            }
            _ => {}
        }
        Ok(())
    }

    fn voxels(&mut self, prefix: &str) -> Result<(), Failure> {
        let Rig {
            gpu, frame, voxels, ..
        } = &self.rig;
        let mut checks = judge::voxels(gpu, frame, &self.plan.scene.world, voxels)?;
        for check in &mut checks {
            check.name.insert_str(0, prefix);
        }
        self.found.checks.extend(checks);
        Ok(())
    }

    /// The picture after some frames is that of a fresh start, to the bit.
    fn exact(&mut self, name: &str, after: After<'_>) -> Result<(), Failure> {
        self.rig.steps(EXACT_FRAMES, after)?;
        let picture = self.rig.frame.read_radiance(&self.rig.gpu)?;
        let (_, fresh) = self.rig.fresh(self.rig.now.seed, EXACT_FRAMES, after)?;
        let different = judge::different_pixels(&picture, &fresh);
        self.found.checks.push(Check::none(name, different));
        Ok(())
    }

    /// What the stormed frame holds against what a fresh one does: `stormed` is the footprint with the first alone,
    /// `both` with both, `own` the bytes that the fresh one says it has.
    fn memory(&mut self, stormed: Footprint, both: Footprint, own: u64) {
        let fresh_objects = both.objects.saturating_sub(stormed.objects);
        let fresh_bytes = both.bytes.saturating_sub(stormed.bytes);
        let here = self.rig.frame.memory().total;
        // Buffers that edits have outgrown are replaced by larger ones, which stay.
        let grown = here.saturating_sub(own);
        let held_objects = stormed.objects.saturating_sub(self.before.objects);
        let held_bytes = stormed.bytes.saturating_sub(self.before.bytes);
        let values = &mut self.found.measured.values;
        self.found.checks.extend([
            Check::at_most(
                "memory.objects",
                held_objects as f64,
                fresh_objects as f64 + SLACK_OBJECTS,
            ),
            Check::at_most(
                "memory.adapter_bytes",
                held_bytes as f64,
                (fresh_bytes + grown) as f64 + SLACK_BYTES,
            )
            .measured(values),
            Check::at_most(
                "memory.frame_bytes",
                here as f64,
                GROWN * own as f64 + SLACK_BYTES,
            ),
        ]);
    }
}
