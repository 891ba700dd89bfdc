//! Draws a world's frames one after another: pictures settle, stay steady, and follow changes.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use super::Failure;
use crate::{
    frame::{Frame, Smoothing, Stage, TraceRequest, trace},
    gpu::{Gpu, Recorder},
    lights::Lights,
    measure::picture::Picture,
    parameters::{Parameters, ProbeParameters},
    passes::view::Shot,
    world::{
        Camera, LayoutSpec, View, World,
        voxels::{Edit, Voxels},
    },
};

/// A frame with everything needed to record the next one.
pub struct FrameLoop<'a> {
    gpu: &'a Gpu,
    frame: Frame,
    layout: LayoutSpec,
    probes: ProbeParameters,
    shot: Shot,
    smoothing: Smoothing,
    stop: Option<Arc<AtomicBool>>,
}

impl<'a> FrameLoop<'a> {
    /// # Errors
    /// When the adapter cannot hold the picture or the probes.
    pub fn new(
        gpu: &'a Gpu,
        stage: Stage,
        layout: &LayoutSpec,
        parameters: &Parameters,
        shot: Shot,
    ) -> Result<Self, Failure> {
        let probes = parameters.probes.clone();
        Ok(Self {
            gpu,
            frame: Frame::new(gpu, stage, layout, &probes, shot.size)?,
            layout: layout.clone(),
            probes,
            shot,
            smoothing: Smoothing::default(),
            stop: None,
        })
    }

    /// A loop with the same probes, picture and stop over a copy of the world of its own: edits of one world do
    /// not change the other. The probes have no light.
    ///
    /// # Errors
    /// When the adapter cannot hold both.
    pub fn in_own_world(&self, world: &World) -> Result<Self, Failure> {
        let gpu = self.gpu;
        let stage = Stage::build(gpu, world)?;
        let mut frame = Frame::new(gpu, stage, &self.layout, &self.probes, self.shot.size)?;
        frame.antialias(gpu, self.smoothing)?;
        Ok(Self {
            gpu,
            frame,
            layout: self.layout.clone(),
            probes: self.probes.clone(),
            shot: self.shot.clone(),
            smoothing: self.smoothing,
            stop: self.stop.clone(),
        })
    }

    /// Sets whether the next pictures are anti-aliased, and how many of their pixels are rendered; at first they are not,
    /// and all are. Returns what was set before.
    ///
    /// # Errors
    /// When the adapter cannot hold the history.
    pub fn antialias(&mut self, wanted: impl Into<Smoothing>) -> Result<Smoothing, Failure> {
        let wanted = wanted.into();
        self.frame.antialias(self.gpu, wanted)?;
        Ok(std::mem::replace(&mut self.smoothing, wanted))
    }

    /// Starts no further frame once `stop` is set.
    pub fn stop_at(&mut self, stop: &Arc<AtomicBool>) {
        self.stop = Some(stop.clone());
    }

    /// Starts again with fresh probes, in this layout and with these parameters.
    ///
    /// # Errors
    /// When the adapter cannot hold them.
    pub fn replace_probes(
        &mut self,
        layout: &LayoutSpec,
        probes: &ProbeParameters,
    ) -> Result<(), Failure> {
        self.frame.replace_probes(self.gpu, layout, probes)?;
        self.layout = layout.clone();
        self.probes = probes.clone();
        Ok(())
    }

    /// Starts again with fresh probes that have no light.
    ///
    /// # Errors
    /// See [`replace_probes`](Self::replace_probes).
    pub fn forget(&mut self) -> Result<(), Failure> {
        let frame = &mut self.frame;
        Ok(frame.replace_probes(self.gpu, &self.layout, &self.probes)?)
    }

    /// Sets the view of the next frames; the probes keep their light.
    pub fn look(&mut self, camera: &Camera, view: View) {
        self.shot.camera = camera.clone();
        self.shot.view = view;
    }

    /// Sets the world time of the next frames, in seconds; the lights are given with the frames.
    pub fn set_time(&mut self, time_s: f64) {
        self.shot.time_s = time_s;
    }

    /// Sets the width and height in pixels of the next pictures; the probes keep their light.
    ///
    /// # Errors
    /// When the adapter cannot hold them.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<(), Failure> {
        if size != self.shot.size {
            self.frame.resize(self.gpu, size)?;
            self.shot.size = size;
        }
        Ok(())
    }

    pub fn shot(&self) -> &Shot {
        &self.shot
    }

    /// Records frames under constant lights; `after` is called after each.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn advance(
        &mut self,
        lights: &Lights,
        frames: u32,
        after: &dyn Fn(),
    ) -> Result<(), Failure> {
        let stopped = |stop: &Arc<AtomicBool>| stop.load(Ordering::Relaxed);
        for _ in 0..frames {
            if self.stop.as_ref().is_some_and(stopped) {
                return Err(Failure::interrupted("stopped"));
            }
            self.shot.frame = self.frame.frames();
            let mut recorder = Recorder::new(self.gpu, None);
            self.frame
                .record(self.gpu, &mut recorder, &self.shot, lights, &self.probes);
            recorder.submit(self.gpu)?;
            self.gpu.wait()?;
            after();
        }
        Ok(())
    }

    /// Averages jittered pictures of the last frame, if pictures are anti-aliased: see [`smooth`].
    ///
    /// # Errors
    /// When the adapter fails.
    pub fn smooth(&mut self) -> Result<(), Failure> {
        smooth(self.gpu, &mut self.frame, &self.shot)
    }

    /// Linear light of the last frame.
    ///
    /// # Errors
    /// When the adapter fails.
    pub fn radiance(&self) -> Result<Picture, Failure> {
        Ok(self.frame.read_radiance(self.gpu)?)
    }

    /// Linear light of the last frame in another view, at the centres of pixels: nothing moves, and neither probes nor
    /// the history of anti-aliasing change in between.
    ///
    /// # Errors
    /// When the adapter fails.
    pub fn radiance_of(&mut self, view: View) -> Result<Picture, Failure> {
        let shot = Shot {
            view,
            ..self.shot.clone()
        };
        let mut recorder = Recorder::new(self.gpu, None);
        self.frame.show(self.gpu, &mut recorder, &shot);
        recorder.submit(self.gpu)?;
        self.radiance()
    }

    /// Path-traces what the next frame shows under these lights, from the pixels' centres, with `paths` per pixel. Every call
    /// takes the same random numbers.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn reference(&self, lights: &Lights, paths: u32) -> Result<Picture, Failure> {
        let request = TraceRequest {
            camera: &self.shot.camera,
            size: self.shot.size,
            view: self.shot.view,
            spp: paths,
            seed: 0,
            time_s: self.shot.time_s,
            textures: self.shot.textures,
            antialias: false,
        };
        let never = Arc::default();
        let stop = self.stop.as_ref().unwrap_or(&never);
        let traced = trace(self.gpu, self.stage(), lights, &request, &|_, _| {}, stop)?;
        if traced.spp < paths {
            return Err(Failure::interrupted("stopped"));
        }
        Ok(traced.picture)
    }

    /// The last frame as a display shows it.
    ///
    /// # Errors
    /// When the adapter fails.
    pub fn display(&self) -> Result<Picture, Failure> {
        Ok(self.frame.read_display(self.gpu)?)
    }

    /// A copy of the voxels, for picking and edits.
    ///
    /// # Errors
    /// When the adapter fails.
    pub fn voxels(&self) -> Result<Voxels, Failure> {
        Ok(self.frame.stage.read_back(self.gpu)?)
    }

    /// Updates the adapter after an edit of that copy.
    ///
    /// # Errors
    /// When the adapter cannot hold the bricks.
    pub fn apply(&mut self, voxels: &Voxels, edit: &Edit) -> Result<(), Failure> {
        Ok(self.frame.apply(self.gpu, voxels, edit)?)
    }

    /// The world on the adapter.
    pub fn stage(&self) -> &Stage {
        &self.frame.stage
    }

    /// Bytes on the adapter that the probes take.
    pub fn probe_bytes(&self) -> u64 {
        self.frame.memory().probes
    }

    /// Rays per probe in a frame.
    pub fn rays(&self) -> u32 {
        self.probes.rays
    }

    /// Share of history kept per update of a probe.
    pub fn hysteresis(&self) -> f32 {
        self.probes.hysteresis
    }
}

/// Anti-aliases the last frame's picture, if that is wanted of the frame: a mean of jittered pictures by the light of
/// that frame.
///
/// # Errors
/// When the adapter fails.
pub fn smooth(gpu: &Gpu, frame: &mut Frame, shot: &Shot) -> Result<(), Failure> {
    /// Rays per pixel in the mean.
    const RAYS: f32 = 32.0;
    frame.restart_antialiasing();
    let pictures = (RAYS / frame.smoothing().scale.powi(2)).ceil() as u32;
    for _ in 0..pictures {
        let mut recorder = Recorder::new(gpu, None);
        if !frame.smooth(gpu, &mut recorder, shot) {
            break;
        }
        recorder.submit(gpu)?;
        gpu.wait()?;
    }
    Ok(())
}
