//! One world on the adapter, and the runs of frames that are timed on it.

use std::{
    collections::VecDeque,
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use super::{
    super::{
        super::{
            Failure,
            dynamics::{Digging, RATE},
        },
        results::FrameSample,
    },
    motion::Track,
    spec::{BenchScene, Condition, RowSpec},
};
use crate::{
    frame::{Frame, Stage},
    gpu::{Gpu, PassTimes, Recorder, Timing},
    lights::{LampKinds, Lights},
    passes::view::Shot,
    world::{View, voxels::Voxels},
};

/// Frames between two that are timed pass by pass; the interval of edits is not a multiple of it.
const BY_PASS_INTERVAL: u32 = 7;
/// Frames that the adapter may lag behind.
const IN_FLIGHT: usize = 2;

/// How long a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Length {
    /// Frames from fresh probes to the first measured frame.
    pub settling: u32,
    /// Measured frames.
    pub measured: u32,
}

/// The results of one run.
pub struct Run {
    /// Every measured frame in order.
    pub samples: Vec<FrameSample>,
    /// Times of the frames that were timed pass by pass.
    pub passes: Vec<PassTimes>,
    /// For each edit: how long the CPU took to change its copy of the voxels and to tell the frame, in milliseconds. This is a part
    /// of the frame's CPU time.
    pub edits_ms: Vec<f64>,
}

/// Everything that the frames of a run share, whatever the spec.
pub struct Rig<'a> {
    pub gpu: &'a Gpu,
    pub scene: &'a BenchScene,
    pub frame: Frame,
    /// The voxels before any edit.
    pub voxels: Voxels,
    pub seed: u32,
    /// World time of the first frame.
    pub time_s: f64,
    stop: &'a AtomicBool,
    /// Times of unmeasured frames, from which their passes learn how long they take.
    timing: Timing,
}

impl<'a> Rig<'a> {
    /// # Errors
    /// When the adapter cannot hold the world or its probes.
    pub fn new(
        gpu: &'a Gpu,
        scene: &'a BenchScene,
        spec: &RowSpec,
        (seed, time_s): (u32, f64),
        stop: &'a AtomicBool,
    ) -> Result<Self, Failure> {
        let stage = stage_for(gpu, scene, spec)?;
        let voxels = stage.read_back(gpu)?;
        let probes = &spec.parameters.probes;
        Ok(Self {
            gpu,
            scene,
            frame: Frame::new(gpu, stage, &spec.layout, probes, spec.size)?,
            voxels,
            seed,
            time_s,
            stop,
            timing: Timing::new(gpu)?,
        })
    }

    /// Replaces the probes by fresh ones of the spec, and resizes the picture. Pictures are taken at the centres of their
    /// pixels, unless the spec asks for fewer pixels.
    ///
    /// # Errors
    /// When the adapter cannot hold them.
    pub fn prepare(&mut self, spec: &RowSpec, size: [u32; 2]) -> Result<(), Failure> {
        if self.frame.size() != size {
            self.frame.resize(self.gpu, size)?;
        }
        self.frame
            .know_lamps(self.gpu, kinds_of(self.scene, spec))?;
        let smoothing = spec.smoothing();
        self.frame.antialias(self.gpu, smoothing)?;
        let probes = &spec.parameters.probes;
        Ok(self.frame.replace_probes(self.gpu, &spec.layout, probes)?)
    }

    /// # Errors
    /// When the user has stopped the run.
    pub fn check_stop(&self) -> Result<(), Failure> {
        match self.stop.load(Ordering::Relaxed) {
            true => Err(Failure::interrupted("stopped")),
            false => Ok(()),
        }
    }

    /// The lights of a spec at this time.
    pub fn lights(&self, spec: &RowSpec, time_s: f64) -> Lights {
        let time_s = if spec.parameters.lights.animate {
            time_s
        } else {
            0.0
        };
        Lights::at(&self.scene.world, &spec.lamps, time_s)
    }

    /// The view of a frame of the spec; its frame number is set when the frame is recorded.
    pub fn shot(&self, spec: &RowSpec, size: [u32; 2], view: View, time_s: f64) -> Shot {
        Shot {
            camera: spec.camera.clone(),
            size,
            frame: 0,
            seed: self.seed,
            exposure_ev: spec.parameters.picture.exposure_ev,
            view,
            time_s,
            textures: spec.parameters.textures.enabled,
            soft_rays: spec.parameters.lights.soft_rays,
            shadows: spec.parameters.lights.shadows,
        }
    }

    /// Draws frames of the spec at rest, only to advance the light.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn advance(
        &mut self,
        spec: &RowSpec,
        size: [u32; 2],
        view: View,
        frames: u32,
    ) -> Result<(), Failure> {
        for _ in 0..frames {
            self.draw(spec, size, view, self.time_s)?;
        }
        Ok(())
    }

    /// Draws frames of the spec while world time runs; frame 0 is at the rig's time.
    ///
    /// # Errors
    /// See [`advance`](Self::advance).
    pub fn play(
        &mut self,
        spec: &RowSpec,
        size: [u32; 2],
        frames: Range<u32>,
    ) -> Result<(), Failure> {
        for frame in frames {
            let time_s = self.time_s + f64::from(frame) / RATE;
            self.draw(spec, size, View::Full, time_s)?;
        }
        Ok(())
    }

    /// Draws one frame without measuring it.
    fn draw(
        &mut self,
        spec: &RowSpec,
        size: [u32; 2],
        view: View,
        time_s: f64,
    ) -> Result<(), Failure> {
        let lights = self.lights(spec, time_s);
        self.check_stop()?;
        let mut shot = self.shot(spec, size, view, time_s);
        shot.frame = self.frame.frames();
        let mut recorder = Recorder::new(self.gpu, Some(&mut self.timing));
        let probes = &spec.parameters.probes;
        self.frame
            .record(self.gpu, &mut recorder, &shot, &lights, probes);
        recorder.submit(self.gpu)?;
        self.gpu.wait()?;
        while self.timing.next_frame().is_some() {}
        Ok(())
    }

    /// Settles, then times frames. Every run starts with fresh probes, so that runs are alike. A run with edits
    /// uses a world of its own, because buffers that have grown stay large.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn run(
        &mut self,
        spec: &RowSpec,
        condition: Condition,
        length: Length,
    ) -> Result<Run, Failure> {
        self.prepare(spec, spec.size)?;
        let Condition::Edits(edited) = condition else {
            return self.frames(spec, condition, length, None);
        };
        let stage = stage_for(self.gpu, self.scene, spec)?;
        // A GPU numbers bricks in the order in which its threads come: the edits of one copy would hit others' bricks.
        let voxels = stage.read_back(self.gpu)?;
        let probes = &spec.parameters.probes;
        let mut own = Frame::new(self.gpu, stage, &spec.layout, probes, spec.size)?;
        own.antialias(self.gpu, spec.smoothing())?;
        std::mem::swap(&mut own, &mut self.frame);
        let mut digging = Digging::new(edited, &self.scene.world, &voxels, &spec.camera);
        let result = self.frames(spec, condition, length, Some(&mut digging));
        std::mem::swap(&mut own, &mut self.frame);
        let run = result?;
        if !digging.are_followed_by(&own.stage.read_back(self.gpu)?) {
            let name = &self.scene.world.name;
            return Err(Failure::fault(format!(
                "the edits of {name} were not drawn"
            )));
        }
        Ok(run)
    }

    fn frames(
        &mut self,
        spec: &RowSpec,
        condition: Condition,
        length: Length,
        mut digging: Option<&mut Digging>,
    ) -> Result<Run, Failure> {
        let gpu = self.gpu;
        let track = Track::of(condition, self.scene, &self.voxels, &spec.camera);
        let mut timing = Timing::new(gpu)?;
        let mut pending = VecDeque::new();
        let mut times = Vec::new();
        let mut samples = Vec::new();
        let mut edits_ms = Vec::new();
        let all = length.settling + length.measured;
        let mut last_end = Instant::now();
        for index in 0..all {
            self.check_stop()?;
            let elapsed_s = match condition {
                Condition::Still => 0.0,
                _ => f64::from(index) / RATE,
            };
            let flown_s = f64::from(index.saturating_sub(length.settling)) / RATE;
            let time_s = self.time_s + elapsed_s;
            let lights = self.lights(spec, time_s);
            let mut shot = self.shot(spec, spec.size, View::Full, time_s);
            shot.camera = track.at(flown_s);
            shot.frame = self.frame.frames();
            let digs = digging.as_deref_mut().filter(|_| index >= length.settling);
            let due = digs.and_then(|digging| {
                let stroke = digging.due(index - length.settling)?;
                Some((digging, stroke))
            });
            let start = Instant::now();
            if let Some((digging, stroke)) = due {
                let edit = digging.apply(stroke);
                self.frame.apply(gpu, digging.voxels(), &edit)?;
                edits_ms.push(start.elapsed().as_secs_f64() * 1e3);
            }
            // A fresh field learns how long its passes take before frames are measured.
            let by_pass = index.is_multiple_of(BY_PASS_INTERVAL) || index < length.settling / 4;
            let mut recorder = if by_pass {
                Recorder::new(gpu, Some(&mut timing))
            } else {
                Recorder::new_whole(gpu, &mut timing)
            };
            let probes = &spec.parameters.probes;
            self.frame
                .record(gpu, &mut recorder, &shot, &lights, probes);
            pending.push_back(recorder.submit(gpu)?);
            let cpu_ms = start.elapsed().as_secs_f64() * 1e3;
            if pending.len() >= IN_FLIGHT
                && let Some(oldest) = pending.pop_front()
            {
                gpu.wait_for(oldest)?;
            }
            let end = Instant::now();
            samples.push(FrameSample {
                gpu_ms: None,
                cpu_ms,
                wall_ms: (end - last_end).as_secs_f64() * 1e3,
                by_pass,
            });
            last_end = end;
            times.extend(std::iter::from_fn(|| timing.next_frame()));
        }
        gpu.wait()?;
        times.extend(std::iter::from_fn(|| timing.next_frame()));
        if timing.supported() {
            for (sample, times) in samples.iter_mut().zip(&times) {
                sample.gpu_ms = Some(times.frame_ms);
            }
        }
        let from = length.settling as usize;
        Ok(Run {
            samples: samples.split_off(from.min(samples.len())),
            passes: times
                .into_iter()
                .skip(from)
                .filter(|frame| !frame.passes_ms.is_empty())
                .collect(),
            edits_ms,
        })
    }
}

/// The world of a scene for the lamps of a spec: kernels know no others.
fn stage_for(gpu: &Gpu, scene: &BenchScene, spec: &RowSpec) -> Result<Stage, Failure> {
    let mut stage = Stage::build(gpu, &scene.world)?;
    stage.lamp_kinds = kinds_of(scene, spec);
    Ok(stage)
}

fn kinds_of(scene: &BenchScene, spec: &RowSpec) -> LampKinds {
    LampKinds::of_lamps(&scene.world, &spec.lamps.lamps)
}
