//! After the storm: the conditions that must hold, and the comparison with frames that never had a storm.

use super::{
    judge::{self, Check},
    kinds::Kind,
    report::Measured,
    rig::{Now, Rig},
    run::{After, Planted, Storm},
    soak::{self, Footprint, Judged},
};
use crate::commands::Failure;

/// Frames after a rebuild or a loss, before the picture must equal that of a fresh start bit for bit.
const EXACT_FRAMES: u32 = 12;
/// Pictures with other seeds, which measure the noise.
const FRESH_PICTURES: u32 = 3;
/// Radius around the camera that is cleared of voxels when pictures are compared (voxels).
const AIR_RADIUS: f32 = 4.5;
/// What may remain above the memory of a fresh frame: objects, and bytes on the adapter.
const SLACK_OBJECTS: f64 = 4.0;
const SLACK_BYTES: f64 = 2.0 * 1024.0 * 1024.0;
/// Largest ratio of buffers that have grown by edits to those of a fresh frame.
const GROWN: f64 = 2.0;

impl Storm<'_> {
    /// Settles, and compares with frames that never had a storm.
    pub fn judge(&mut self, after: After<'_>) -> Result<(), Failure> {
        self.still_scene()?;
        // Only now: an edit that makes buffers grow uploads all voxels again, and would repair the planted
        // fault.
        self.plant()?;
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
            let judged = Judged {
                // New kernels and devices take memory, which compilers and drivers keep.
                process: !self.has(Kind::Layout) && !self.has(Kind::Loss),
                times: self.plan.kinds.only(Kind::Soak) && !software,
            };
            let Measured {
                samples, values, ..
            } = &mut self.found.measured;
            let checks = soak::judge(samples, judged, values);
            self.found.checks.extend(checks);
        }
        self.hear_device_errors();
        for refused in &self.refused {
            tracing::error!("the device has reported an error: {refused}");
        }
        let checks = [
            Check::none("light.not_finite", self.not_finite),
            Check::none("device.errors", self.refused.len() as u64),
        ];
        self.found.checks.extend(checks);
        Ok(())
    }

    /// Brings the scene to rest: a camera of the world with some air around it, the time at which the storm
    /// ended, and a picture that is large enough for a comparison.
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
            // The lamps at a given time must be the same, whatever times came before.
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

    /// Plants the fault that a test requests.
    fn plant(&mut self) -> Result<(), Failure> {
        match self.plan.planted {
            Planted::EditOnCpuOnly => {
                let last = self.plan.scene.world.size.as_ivec3() - 1;
                let turned = |_, material| u8::from(material == 0);
                self.rig.voxels.edit(last - 2, last, turned);
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

    /// Checks that the picture after some frames equals that of a fresh start, bit for bit.
    fn exact(&mut self, name: &str, after: After<'_>) -> Result<(), Failure> {
        self.rig.steps(EXACT_FRAMES, after)?;
        let picture = self.rig.frame.read_radiance(&self.rig.gpu)?;
        let (_, fresh) = self.rig.fresh(self.rig.now.seed, EXACT_FRAMES, after)?;
        let different = judge::different_pixels(&picture, &fresh);
        self.found.checks.push(Check::none(name, different));
        Ok(())
    }

    /// Compares the memory of the stormed frame with that of a fresh one. `stormed` is the footprint of the
    /// first alone, `both` that of both, `own` the bytes that the fresh frame reports.
    fn memory(&mut self, stormed: Footprint, both: Footprint, own: u64) {
        let fresh_objects = both.objects.saturating_sub(stormed.objects);
        let fresh_bytes = both.bytes.saturating_sub(stormed.bytes);
        let here = self.rig.frame.memory().total;
        // Buffers that became too small for the edits were replaced by larger ones, which stay.
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
                // A difference, so that the bound is the same in every run: how closely an allocator packs buffers
                // depends on the order in which threads ask for them.
                held_bytes as f64 - (fresh_bytes + grown) as f64,
                SLACK_BYTES,
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
