//! The frame that storms change, with the CPU's copy of its voxels and everything needed to draw the next
//! frame.

use crate::{
    commands::Failure,
    frame::{Frame, Stage},
    gpu::{DeviceErrors, Gpu, Recorder},
    lights::Lights,
    measure::picture::Picture,
    parameters::Parameters,
    passes::view::Shot,
    world::{
        Camera, LampPreset, LayoutSpec, View, World,
        voxels::{Edit, Voxels},
    },
};

/// The state of the next frame: everything that storms change, apart from the voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct Now {
    pub layout: LayoutSpec,
    pub parameters: Parameters,
    /// Width and height in pixels.
    pub size: [u32; 2],
    pub time_s: f64,
    pub camera: Camera,
    /// Seed of the random rays.
    pub seed: u32,
}

/// A world with its lamps.
pub struct Scene {
    pub world: World,
    pub lamps: LampPreset,
}

impl Scene {
    pub fn lights(&self, now: &Now) -> Lights {
        let animated = now.parameters.lights.animate;
        let time_s = if animated { now.time_s } else { 0.0 };
        Lights::at(&self.world, &self.lamps, time_s)
    }
}

/// A frame and its voxels.
pub struct Rig<'a> {
    scene: &'a Scene,
    pub gpu: Gpu,
    pub device_errors: DeviceErrors,
    pub frame: Frame,
    /// The CPU's copy, with all edits.
    pub voxels: Voxels,
    pub now: Now,
    /// Replaces the lights, where a test wants stale ones.
    pub stale: Option<Lights>,
}

impl<'a> Rig<'a> {
    /// Builds the world in the usual way.
    pub fn new(gpu: Gpu, scene: &'a Scene, now: Now) -> Result<Self, Failure> {
        let device_errors = DeviceErrors::watch(&gpu);
        let stage = Stage::build(&gpu, &scene.world)?;
        let voxels = stage.read_back(&gpu)?;
        let frame = Frame::new(&gpu, stage, &now.layout, &now.parameters.probes, now.size)?;
        Ok(Self {
            scene,
            gpu,
            device_errors,
            frame,
            voxels,
            now,
            stale: None,
        })
    }

    /// Draws a frame and waits for the GPU.
    pub fn step(&mut self) -> Result<(), Failure> {
        let lights = match &self.stale {
            Some(lights) => lights.clone(),
            None => self.scene.lights(&self.now),
        };
        draw(&self.gpu, &mut self.frame, &self.now, &lights)
    }

    pub fn steps(
        &mut self,
        frames: u32,
        after: &dyn Fn() -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for _ in 0..frames {
            self.step()?;
            after()?;
        }
        Ok(())
    }

    /// Changes the CPU's copy and updates the GPU.
    pub fn edit(&mut self, change: impl FnOnce(&mut Voxels) -> Edit) -> Result<(), Failure> {
        let edit = change(&mut self.voxels);
        Ok(self.frame.apply(&self.gpu, &self.voxels, &edit)?)
    }

    /// Sets another picture size; the probes keep their light.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<(), Failure> {
        self.frame.resize(&self.gpu, size)?;
        self.now.size = size;
        Ok(())
    }

    /// Fresh probes in another layout. False where the adapter or the layout does not allow it: then nothing
    /// changes.
    pub fn replace_probes(
        &mut self,
        layout: LayoutSpec,
        parameters: Parameters,
    ) -> Result<bool, Failure> {
        let replaced = self
            .frame
            .replace_probes(&self.gpu, &layout, &parameters.probes);
        match replaced.map_err(Failure::from) {
            Ok(()) => {
                (self.now.layout, self.now.parameters) = (layout, parameters);
                Ok(true)
            }
            // The layout is too large for this adapter, or invalid.
            Err(failure) if failure.exit_code() == crate::commands::EXIT_BAD_INPUT => Ok(false),
            Err(failure) => Err(failure),
        }
    }

    /// Destroys the device, draws once more on it, as a window does that has not noticed the loss, and
    /// continues with a new device. Edits are kept, unless `forget_edits`. False where the loss was not
    /// reported.
    pub fn lose_device(&mut self, forget_edits: bool) -> Result<bool, Failure> {
        self.gpu.device.destroy();
        // A lost device gives errors, which do not matter here; the loss must be reported.
        let _ = self.step();
        let _ = self.frame.read_radiance(&self.gpu);
        let heard = self.device_errors.is_lost();
        let gpu = self.gpu.reopened(None)?;
        let device_errors = DeviceErrors::watch(&gpu);
        let Now {
            layout, parameters, ..
        } = &self.now;
        let voxels = (!forget_edits).then_some(&self.voxels);
        self.frame =
            self.frame
                .moved_to(&gpu, &self.scene.world, voxels, layout, &parameters.probes)?;
        (self.gpu, self.device_errors) = (gpu, device_errors);
        Ok(heard)
    }

    /// The light of a frame that started with the present voxels, lights and size, after N frames.
    pub fn fresh(
        &self,
        seed: u32,
        frames: u32,
        after: &dyn Fn() -> Result<(), Failure>,
    ) -> Result<(Frame, Picture), Failure> {
        let now = Now {
            seed,
            ..self.now.clone()
        };
        let stage = Stage::upload(&self.gpu, &self.scene.world, &self.voxels)?;
        let probes = &now.parameters.probes;
        let mut frame = Frame::new(&self.gpu, stage, &now.layout, probes, now.size)?;
        let lights = self.scene.lights(&now);
        for _ in 0..frames {
            draw(&self.gpu, &mut frame, &now, &lights)?;
            after()?;
        }
        let picture = frame.read_radiance(&self.gpu)?;
        Ok((frame, picture))
    }
}

fn draw(gpu: &Gpu, frame: &mut Frame, now: &Now, lights: &Lights) -> Result<(), Failure> {
    let shot = Shot {
        camera: now.camera.clone(),
        size: now.size,
        frame: frame.frames(),
        seed: now.seed,
        exposure_ev: now.parameters.picture.exposure_ev,
        view: View::Full,
        time_s: now.time_s,
        textures: now.parameters.textures.enabled,
        soft_rays: now.parameters.lights.soft_rays,
        shadows: now.parameters.lights.shadows,
    };
    let mut recorder = Recorder::new(gpu, None);
    frame.record(gpu, &mut recorder, &shot, lights, &now.parameters.probes);
    recorder.submit(gpu)?;
    Ok(gpu.wait()?)
}
