//! The occlusion field on the GPU: what its passes and the gather of it share.

use glam::DVec3;

use crate::{
    gpu::{Gpu, GpuError},
    lights::{Lights, TrackedLamps, table::NO_LAMP},
    parameters::{OcclusionParameters, OcclusionShown, ProbeParameters, Shadows},
    probes::{MOST_VALUES, OcclusionLayout},
};

crate::shared! {
    in probes;

    /// What `GpuOcclusion::shown` is for the product of all lamps, and for the openness of the surroundings.
    const SHOWN_ALL as OCCLUSION_ALL: u32 = 100;
    const SHOWN_AMBIENT as OCCLUSION_AMBIENT_SHOWN: u32 = 101;

    /// One of the values that the field keeps.
    pub struct GpuOcclusionValue as OcclusionValue {
        /// Number of the lamp; `NO_LAMP` for a place without one, and for the openness of the surroundings.
        pub lamp: u32,
        /// Probes whose number differs know nothing of the value.
        pub generation: u32,
        /// 1 + the frame in which the lamp last moved or voxels were last edited.
        pub changed: u32,
        /// A value that has changed counts as one that was updated at most this often: it follows within a few updates.
        pub updates_after_change: u32,
    }

    /// What every pass knows of the occlusion field.
    pub struct GpuOcclusion as OcclusionInfo {
        /// Lamps, then the openness of the surroundings.
        pub values: [GpuOcclusionValue; MOST_VALUES],
        /// Frames since the probes were made.
        pub frame: u32,
        /// Words from the maps of one probe to those of the next.
        pub stride: u32,
        /// Texels along a map.
        pub texels: u32,
        /// 1: the picture's direct light is shadowed by the field.
        pub shadows: u32,
        /// What the view of occlusion shows: number of a lamp's value, or one of the OCCLUSION_ constants.
        pub shown: u32,
        /// Exponent of values that are read.
        pub sharpness: f32,
        /// Length of the rays that find the openness (voxels).
        pub radius: f32,
        /// One over `radius`.
        pub inverse_radius: f32,
    }
}

/// See [`GpuOcclusionValue::updates_after_change`].
const UPDATES_AFTER_CHANGE: u32 = 2;

/// What of a frame the field depends on.
pub struct OcclusionFrame<'a> {
    pub lights: &'a Lights,
    /// First frame of each lamp's present place, counted from 1: see [`RestingLamps`](crate::lights::RestingLamps).
    pub still_since: &'a [u32],
    pub eye_ws: DVec3,
    pub shadows: Shadows,
    /// Frames since the probes were made.
    pub frame: u32,
    /// Whether this frame is the first to show an edit.
    pub shows_edit: bool,
}

/// Maps of the occlusion field. Where the field is off they are as small as a buffer can be.
pub struct OcclusionField {
    layout: OcclusionLayout,
    tracked: TrackedLamps,
    /// Increases when frames are numbered from the start again.
    ambient_generation: u32,
    /// 1 + the frame of the last edit.
    edited: u32,
    info: wgpu::Buffer,
    maps: wgpu::Buffer,
    rays: wgpu::Buffer,
}

impl OcclusionField {
    /// Refuses a field that the adapter cannot hold; allocates nothing.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn check(
        gpu: &Gpu,
        layout: OcclusionLayout,
        slots: u32,
        rays: u32,
    ) -> Result<(), GpuError> {
        let what = "the maps of the occlusion field (lower occlusion.lamps or occlusion.texels)";
        gpu.check_buffer(what, layout.map_bytes(slots))?;
        let what = "the rays of the occlusion field (lower probes.rays)";
        gpu.check_buffer(what, layout.ray_bytes(slots, rays))
    }

    /// For this many probes and rays of a probe, after [`check`](Self::check).
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(
        gpu: &Gpu,
        layout: OcclusionLayout,
        slots: u32,
        rays: u32,
    ) -> Result<Self, GpuError> {
        // A buffer that is bound must not be empty.
        let words = |bytes: u64| bytes.max(16);
        Ok(Self {
            layout,
            tracked: TrackedLamps::new(layout.lamps),
            ambient_generation: 1,
            edited: 0,
            info: gpu.uniform_buffer("occlusion_info", &GpuOcclusion::default()),
            maps: gpu.storage_buffer("occlusion_maps", words(layout.map_bytes(slots)))?,
            rays: gpu.storage_buffer("occlusion_rays", words(layout.ray_bytes(slots, rays)))?,
        })
    }

    /// What each probe keeps.
    pub fn layout(&self) -> OcclusionLayout {
        self.layout
    }

    /// The maps, probe by probe: `shaders/probes/occlusion.wesl`.
    pub fn maps(&self) -> &wgpu::Buffer {
        &self.maps
    }

    /// Writes the uniform for a frame, before its submission.
    pub fn begin_frame(&mut self, gpu: &Gpu, probes: &ProbeParameters, of: &OcclusionFrame<'_>) {
        if !self.layout.is_kept() {
            return;
        }
        if of.frame == 0 {
            self.tracked.forget();
            self.ambient_generation += 1;
            self.edited = 0;
        }
        if of.shows_edit {
            self.edited = of.frame + 1;
        }
        let info = self.info_of(&probes.occlusion, of);
        gpu.queue
            .write_buffer(&self.info, 0, bytemuck::bytes_of(&info));
    }

    fn info_of(
        &mut self,
        parameters: &OcclusionParameters,
        of: &OcclusionFrame<'_>,
    ) -> GpuOcclusion {
        let nobody = GpuOcclusionValue {
            lamp: NO_LAMP,
            updates_after_change: UPDATES_AFTER_CHANGE,
            ..Default::default()
        };
        let mut values = [nobody; MOST_VALUES];
        let places = self.tracked.follow(of.lights, of.eye_ws);
        for (value, place) in values.iter_mut().zip(places) {
            let Some(place) = place else { continue };
            let still_since = of.still_since.get(place.lamp as usize).copied();
            *value = GpuOcclusionValue {
                lamp: place.lamp,
                generation: place.generation,
                changed: still_since.unwrap_or(0).max(self.edited),
                ..nobody
            };
        }
        if self.layout.ambient {
            values[self.layout.lamps as usize] = GpuOcclusionValue {
                generation: self.ambient_generation,
                changed: self.edited,
                ..nobody
            };
        }
        GpuOcclusion {
            values,
            frame: of.frame,
            stride: self.layout.stride(),
            texels: self.layout.texels,
            shadows: u32::from(of.shadows == Shadows::Field),
            shown: shown(parameters.shown),
            sharpness: parameters.sharpness,
            radius: parameters.radius,
            inverse_radius: 1.0 / parameters.radius,
        }
    }

    /// What kernels that gather from the field read.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("occlusion_info", self.info.as_entire_binding()),
            ("occlusion_maps", self.maps.as_entire_binding()),
        ]
    }

    /// What its own passes write.
    pub fn update_resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 4] {
        [
            ("occlusion_info", self.info.as_entire_binding()),
            ("occlusion_maps_out", self.maps.as_entire_binding()),
            ("occlusion_rays_out", self.rays.as_entire_binding()),
            ("occlusion_rays", self.rays.as_entire_binding()),
        ]
    }

    /// The constants of kernels that read or write the field: where it is off, none of its code is left.
    pub fn constants(&self) -> [(&'static str, f64); 2] {
        [
            ("OCCLUSION_LAMPS", f64::from(self.layout.lamps)),
            (
                "OCCLUSION_AMBIENT",
                f64::from(u8::from(self.layout.ambient)),
            ),
        ]
    }
}

fn shown(shown: OcclusionShown) -> u32 {
    match shown {
        OcclusionShown::Ambient => SHOWN_AMBIENT,
        _ => shown.lamp().unwrap_or(SHOWN_ALL),
    }
}
