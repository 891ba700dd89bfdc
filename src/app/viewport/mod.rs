//! What the window shows: a world on the GPU, and the choices made for it.

mod bits;
mod bodies;
mod changes;
mod effort;
mod fitting;
mod lamps;
mod record;
#[cfg(test)]
pub mod sample;

use std::path::{Path, PathBuf};

use miette::{GraphicalReportHandler, GraphicalTheme, Report};

use self::fitting::{fitting, layout};
use super::{
    body::free::FreeBodies, clock::ClockReading, quality::Effort, reference_view::ReferenceView,
};
use crate::{
    frame::{Frame, FrameError, scaled},
    gpu::{Compiling, Gpu, GpuError, ShaderLibrary},
    parameters::{Parameters, Remake},
    passes::view::Inspection,
    world::{
        self, World,
        file::Overrides,
        voxels::{Edit, Originals, Voxels},
    },
};

/// What a user can choose about a world; a change takes effect through [`Viewport::apply`].
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    pub parameters: Parameters,
    /// Name of a probe layout of the world.
    pub layout: String,
    /// Width and height of the shown picture in pixels; an [`Effort`] may make it smaller. Of the path-traced picture the
    /// share `picture.scale` is made.
    pub size: [u32; 2],
    /// Show the path-traced picture in place of the one lit by probes.
    pub traced: bool,
}

impl Choice {
    /// Width and height of the path-traced picture in pixels.
    fn traced_size(&self) -> [u32; 2] {
        scaled(self.size, self.parameters.picture.scale)
    }
}

/// Why a choice or an edit cannot be shown; the previous picture stays.
#[derive(Debug, thiserror::Error)]
pub enum ViewportError {
    /// The diagnostic of a world file, as a terminal would show it.
    #[error("{0}")]
    World(String),
    #[error(transparent)]
    Frame(#[from] FrameError),
}

impl From<Report> for ViewportError {
    fn from(report: Report) -> Self {
        let mut text = String::new();
        let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
            .with_width(DIAGNOSTIC_COLUMNS);
        Self::World(match handler.render_report(&mut text, &*report) {
            Ok(()) => text,
            // What the report quotes cannot be shown: its message alone.
            Err(_) => report.to_string(),
        })
    }
}

/// A world, its frame, and the user's choices.
pub struct Viewport {
    pub gpu: Gpu,
    path: PathBuf,
    world: World,
    frame: Frame,
    /// Present while `choice.traced`.
    reference_view: Option<ReferenceView>,
    choice: Choice,
    effort: Effort,
    inspection: Inspection,
    /// Says where bodies are while the player moves.
    pub clock: ClockReading,
    /// The voxels as on the GPU, read back at the first need. They remember what edited cells contained when
    /// this world was built.
    voxels: Option<Voxels>,
    /// How often voxels were built again, without edits.
    build: u32,
    free: FreeBodies,
    /// Free bodies have moved since the last frame.
    bodies_moved: bool,
    /// The kernels for the first body, while they are compiled.
    preparation: Option<Compiling>,
    preparation_failed: bool,
    /// The frame does not show the bodies yet.
    bodies_wait: bool,
    /// What cells contained whose last edit did not fit, while there are no voxels.
    originals: Originals,
}

/// Columns at which a diagnostic wraps.
const DIAGNOSTIC_COLUMNS: usize = 84;

/// Shaders that produce voxels and distances: when one is edited, the world is built again.
const STAGE_SHADERS: [&str; 5] = [
    "sdf/",
    "scene/voxelise",
    "scene/distances",
    "data/voxel",
    "scene/noise_tables",
];

impl Viewport {
    /// Builds `world`, which was read from `path` with the overrides of `choice`.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it.
    pub fn new(gpu: Gpu, path: &Path, world: World, choice: Choice) -> Result<Self, FrameError> {
        let choice = fitting(choice, &world);
        let stage = lamps::stage(&gpu, &world, &choice)?;
        let layout = layout(&world, &choice.layout);
        let mut frame = Frame::new(&gpu, stage, layout, &choice.parameters.probes, choice.size)?;
        frame.antialias(&gpu, &choice.parameters.picture)?;
        frame.prepare_bits(&gpu)?;
        let free = FreeBodies::of(&world.bodies);
        let mut viewport = Self {
            gpu,
            path: path.to_owned(),
            world,
            frame,
            reference_view: None,
            choice,
            effort: Effort::FULL,
            inspection: Inspection::default(),
            clock: ClockReading::default(),
            voxels: None,
            build: 0,
            free,
            bodies_moved: false,
            preparation: None,
            preparation_failed: false,
            bodies_wait: false,
            originals: Originals::default(),
        };
        viewport.reference_view = viewport.traced(&viewport.choice)?;
        Ok(viewport)
    }

    /// The path tracer for this choice, if the choice is path-traced.
    fn traced(&self, choice: &Choice) -> Result<Option<ReferenceView>, GpuError> {
        let size = choice.traced_size();
        choice
            .traced
            .then(|| ReferenceView::new(&self.gpu, &self.frame.stage, size))
            .transpose()
    }

    pub fn world(&self) -> &World {
        &self.world
    }

    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Counts how often the world was built: edits belong to the voxels of one build.
    pub fn build(&self) -> u32 {
        self.build
    }

    /// What is shown.
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// Applies another choice and rebuilds what depends on it. Returns whether anything was rebuilt.
    ///
    /// # Errors
    /// [`ViewportError`] when the adapter cannot hold it; the previous picture stays.
    pub fn apply(&mut self, next: Choice) -> Result<bool, ViewportError> {
        let mut remake = self.choice.parameters.remake_for(&next.parameters);
        if remake == Remake::World {
            let overrides = Overrides::from(&next.parameters);
            let world = world::file::load(&self.path, &overrides)?;
            self.rebuild(world, next)?;
            return Ok(true);
        }
        self.allow_lamps_of(&next)?;
        if next.layout != self.choice.layout {
            remake = Remake::Probes;
        }
        if remake == Remake::Probes {
            let layout = layout(&self.world, &next.layout);
            self.frame
                .replace_probes(&self.gpu, layout, &next.parameters.probes)?;
            self.choice.layout.clone_from(&next.layout);
            self.choice.parameters.clone_from(&next.parameters);
        }
        let resized = self.fit(self.effort, next.size, &next.parameters.picture)?;
        let changed = next.traced != self.choice.traced;
        if changed
            || (next.traced
                && self
                    .reference_view
                    .as_ref()
                    .is_none_or(|reference_view| reference_view.size() != next.traced_size()))
        {
            self.reference_view = self.traced(&next).map_err(FrameError::from)?;
        }
        self.choice = next;
        Ok(remake == Remake::Probes || resized || changed)
    }

    /// Reads the world file again. Changes of its voxels are kept, as far as they fit.
    ///
    /// # Errors
    /// [`ViewportError`] with the diagnostic; the last good world stays.
    pub fn reload_world(&mut self) -> Result<(), ViewportError> {
        let overrides = Overrides::from(&self.choice.parameters);
        let world = world::file::load(&self.path, &overrides)?;
        Ok(self.rebuild(world, self.choice.clone())?)
    }

    /// Compiles every pass from the shaders in `folder`; the probes keep their light unless the voxels change.
    /// The caller should then rebuild other users of the device with [`Viewport::gpu`] too.
    ///
    /// # Errors
    /// [`FrameError`] with the place; the last good shaders stay.
    pub fn reload_shaders(&mut self, folder: &Path) -> Result<(), FrameError> {
        let shaders = ShaderLibrary::from_folder(folder)?;
        let stage_changed = shaders
            .differences(self.gpu.shaders())
            .any(|name| STAGE_SHADERS.iter().any(|part| name.starts_with(part)));
        let gpu = self.gpu.with_shaders(shaders);
        if stage_changed {
            let mut world = self.world.clone();
            world.restored.overlay = self.overlay()?;
            let stage = lamps::stage(&gpu, &world, &self.choice)?;
            let layout = layout(&world, &self.choice.layout);
            let parameters = &self.choice.parameters;
            let size = self.frame.size();
            let mut frame = Frame::new(&gpu, stage, layout, &parameters.probes, size)?;
            frame.antialias(&gpu, self.frame.smoothing())?;
            frame.prepare_bits(&gpu)?;
            self.frame = frame;
            self.world = world;
            self.voxels = None;
            self.build += 1;
            self.originals = Originals::default();
        } else {
            self.frame.rebuild_passes(&gpu)?;
        }
        self.gpu = gpu;
        self.forget_preparation();
        self.reference_view = self.traced(&self.choice)?;
        Ok(())
    }

    /// Shows the same on a device that replaces a lost one: edits are kept, light is computed again.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it.
    pub fn move_to(&mut self, gpu: Gpu) -> Result<(), FrameError> {
        let layout = layout(&self.world, &self.choice.layout);
        let probes = &self.choice.parameters.probes;
        let voxels = self.voxels.as_ref();
        self.frame = self
            .frame
            .moved_to(&gpu, &self.world, voxels, layout, probes)?;
        self.gpu = gpu;
        self.forget_preparation();
        self.reference_view = self.traced(&self.choice)?;
        Ok(())
    }

    fn rebuild(&mut self, mut world: World, choice: Choice) -> Result<(), FrameError> {
        self.carry_changes(&mut world);
        let build = self.build + 1;
        let effort = self.effort;
        *self = Self {
            build,
            ..Self::new(self.gpu.clone(), &self.path, world, choice)?
        };
        self.make(effort)
    }

    /// The voxels as on the GPU.
    ///
    /// # Errors
    /// [`FrameError`] when the device is lost.
    pub fn voxels(&mut self) -> Result<&Voxels, FrameError> {
        Ok(self.voxels_and_world()?.0)
    }

    /// The voxels as on the GPU, and the world that they are of.
    ///
    /// # Errors
    /// [`FrameError`] when the device is lost.
    pub fn voxels_and_world(&mut self) -> Result<(&Voxels, &World), FrameError> {
        if self.voxels.is_none() {
            let mut voxels = self.frame.stage.read_back(&self.gpu)?;
            voxels.remember(std::mem::take(&mut self.originals));
            self.voxels = Some(voxels);
        }
        let voxels = self.voxels.as_ref().expect("they are read");
        Ok((voxels, &self.world))
    }

    /// Changes voxels, on the CPU and on the GPU. They stay changed when the world is built again.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold them; then nothing changes.
    pub fn edit(
        &mut self,
        change: impl FnOnce(&mut Voxels, &World) -> Edit,
    ) -> Result<(), FrameError> {
        self.voxels()?;
        let mut voxels = self.voxels.take().expect("they were just read");
        let edit = change(&mut voxels, &self.world);
        if edit == Edit::default() {
            self.voxels = Some(voxels);
            return Ok(());
        }
        if let Err(error) = self.frame.apply(&self.gpu, &voxels, &edit) {
            // The GPU's copy is unchanged: the next edit reads it back.
            self.originals = voxels.take_originals();
            return Err(error);
        }
        self.voxels = Some(voxels);
        self.free.wake();
        self.reference_view = self.traced(&self.choice)?;
        Ok(())
    }

    /// Shows another view and the chosen probes and atlas. A layer that the atlas lacks becomes its last one.
    ///
    /// # Errors
    /// [`FrameError`] when it cannot be shown; then nothing changes.
    pub fn inspect(&mut self, wanted: &mut Inspection) -> Result<(), FrameError> {
        if let Some(atlas) = &mut wanted.atlas {
            atlas.layer = atlas.layer.min(self.frame.field().atlas().layers - 1);
        }
        self.frame.inspect(&self.gpu, *wanted)?;
        self.inspection = *wanted;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::{IVec3, UVec3, Vec3};

    use super::{
        sample::{body_at, shown, shown_as},
        *,
    };
    use crate::{
        gpu::{DeviceErrors, GpuError, Recorder},
        lights::{Lights, table::KNOWN_LAMPS},
        world::{LampPreset, PlacedLamp, file::Overrides, placed::tests::lamp},
    };

    #[test]
    fn a_body_that_comes_while_its_kernels_are_compiled_is_shown_afterwards() {
        let mut viewport = shown();
        viewport.prepare_bodies();
        viewport
            .put_body("placed 1", Some(&body_at(Vec3::Y * 20.0)))
            .expect("it waits");
        assert!(viewport.bodies_wait() && !viewport.frame.has_bodies());
        assert_eq!(viewport.world.bodies.bodies.len(), 1);
        while viewport.bodies_wait() {
            viewport.show_waiting_bodies().expect("it fits");
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        assert!(viewport.frame.has_bodies());
        // Another one need not wait.
        viewport.prepare_bodies();
        viewport
            .put_body("placed 2", Some(&body_at(Vec3::Y * 24.0)))
            .expect("it fits");
        assert!(!viewport.bodies_wait());
    }

    fn on_the_gpu(viewport: &Viewport) -> Voxels {
        viewport
            .frame
            .stage
            .read_back(&viewport.gpu)
            .expect("reads back")
    }

    #[test]
    fn edits_outlast_a_change_of_size_and_reading_the_world_again() {
        let mut viewport = shown();
        let at = IVec3::new(2, 30, 3);
        viewport
            .edit(|voxels, _| voxels.set(at, 1))
            .expect("it fits");
        viewport
            .edit(|voxels, _| voxels.set(at + 1, 1))
            .expect("it fits");
        let resized = Choice {
            size: [9, 7],
            ..viewport.choice.clone()
        };
        viewport.apply(resized).expect("it fits");
        let read = on_the_gpu(&viewport);
        assert_eq!((read.material(at), read.material(at + 1)), (1, 1));
        assert_eq!(read.validate(), Ok(()));
        viewport.reload_world().expect("it is as it was");
        let again = on_the_gpu(&viewport);
        assert_eq!((again.material(at), again.crc32()), (1, read.crc32()));
        viewport
            .edit(|voxels, _| voxels.set(at, 0))
            .expect("it fits");
        let changes: Vec<_> = viewport
            .overlay()
            .expect("no device is lost")
            .voxels()
            .collect();
        // That the first is back as it was is known only since the world was read again.
        assert_eq!(changes, [(at.as_uvec3(), 0), (at.as_uvec3() + 1, 1)]);
    }

    #[test]
    fn edits_survive_the_loss_of_the_device() {
        let mut viewport = shown();
        let at = IVec3::new(2, 30, 3);
        for edited in [0, 1] {
            let device_errors = DeviceErrors::watch(&viewport.gpu);
            viewport.gpu.device.destroy();
            assert!(viewport.read_display().is_err() && device_errors.is_lost());
            let gpu = viewport
                .gpu
                .reopened(None)
                .expect("the adapter is still there");
            viewport.move_to(gpu).expect("it fits");
            assert!(viewport.read_display().is_ok());
            assert_eq!(on_the_gpu(&viewport).material(at), edited);
            viewport
                .edit(|voxels, _| voxels.set(at, 1))
                .expect("it fits");
        }
    }

    #[test]
    fn placed_lamps_outlast_presets_rebuilds_and_the_loss_of_the_device() {
        let mut viewport = shown();
        let at = |x| lamp(IVec3::new(x, 12, 3));
        // Lamps of two sides of the world's edge at x = 32.
        for lamp in [at(2), at(31), at(40)] {
            viewport.put_lamp(lamp.voxel, Some(lamp)).expect("it fits");
        }
        let off = PlacedLamp {
            is_on: false,
            ..at(2)
        };
        viewport.put_lamp(off.voxel, Some(off)).expect("it fits");
        let lit = |viewport: &Viewport| {
            let lights = Lights::at(&viewport.world, &viewport.lamps(), 0.0);
            // Without the sun.
            lights
                .lamps
                .iter()
                .filter(|lamp| lamp.brightness() > 0.0)
                .count()
                - 1
        };
        assert_eq!(lit(&viewport), 2, "one is off");
        let resized = Choice {
            size: [9, 7],
            ..viewport.choice.clone()
        };
        viewport.apply(resized).expect("it fits");
        viewport.reload_world().expect("it is as it was");
        assert_eq!(viewport.placed_lamps(), [off, at(31)]);
        let notes = viewport.take_notes();
        assert!(notes[0].contains("1 placed lamps"), "{notes:?}");
        let device_errors = DeviceErrors::watch(&viewport.gpu);
        viewport.gpu.device.destroy();
        assert!(viewport.read_display().is_err() && device_errors.is_lost());
        let gpu = viewport.gpu.reopened(None).expect("the adapter");
        viewport.move_to(gpu).expect("it fits");
        assert_eq!((viewport.placed_lamps().len(), lit(&viewport)), (2, 1));
        viewport.put_lamp(off.voxel, None).expect("it fits");
        assert_eq!(viewport.placed_lamps(), [at(31)]);
    }

    fn shows_a_frame(viewport: &mut Viewport) {
        let camera = viewport.world.cameras[0].clone();
        let mut recorder = Recorder::new(&viewport.gpu, None);
        let recorded = viewport.record(&mut recorder, &camera, 0.0, 0);
        recorded.expect("it records");
        recorder.submit(&viewport.gpu).expect("submits");
    }

    /// Debug builds panic where lamps are recorded that kernels do not know.
    #[test]
    fn kernels_know_lists_once_a_preset_or_the_player_has_so_many_lamps() {
        let lists = |viewport: &Viewport| viewport.frame.stage.lamp_kinds.lists;
        let mut viewport = shown();
        shows_a_frame(&mut viewport);
        let at = |number: i32| lamp(IVec3::new(number % 30, 12, number / 30));
        for number in 0..KNOWN_LAMPS as i32 {
            // The sun is one of the lamps.
            assert!(!lists(&viewport), "{number}");
            let lamp = at(number);
            viewport.put_lamp(lamp.voxel, Some(lamp)).expect("it fits");
        }
        assert!(lists(&viewport));
        shows_a_frame(&mut viewport);

        let mut viewport = shown();
        let cornell = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/cornell.ron");
        let cornell = world::file::load(&cornell, &Overrides::default()).expect("it loads");
        viewport.world.lamp_presets.push(LampPreset {
            name: "many".into(),
            lamps: vec![cornell.lamp_presets[0].lamps[0].clone(); KNOWN_LAMPS as usize],
        });
        let mut choice = viewport.choice.clone();
        choice.parameters.lights.preset = "many".into();
        viewport.apply(choice).expect("it fits");
        assert!(lists(&viewport));
        shows_a_frame(&mut viewport);
    }

    #[test]
    fn an_edit_that_does_not_fit_is_forgotten_on_both_sides() {
        // More cells than a new world has spare bricks.
        let mut viewport = shown_as(&Overrides {
            size: Some(UVec3::new(160, 128, 160)),
            ..Overrides::default()
        });
        let before = on_the_gpu(&viewport);
        let held = viewport.frame.stage.voxels.materials.size();
        viewport.gpu.limits.max_storage_buffer_binding_size = held;
        let checker = |voxels: &mut Voxels, world: &World| {
            let last = world.size.as_ivec3() - 1;
            voxels.edit(IVec3::ZERO, last, |at, _| (at.element_sum() & 1) as u8)
        };
        let error = viewport.edit(checker).expect_err("a brick in every cell");
        assert!(matches!(error, FrameError::Gpu(GpuError::TooLarge { .. })));
        assert_eq!(on_the_gpu(&viewport).raw().0, before.raw().0);
        viewport
            .edit(|voxels, _| {
                assert_eq!(voxels.raw().0, before.raw().0);
                Edit::default()
            })
            .expect("nothing changed");
    }
}
