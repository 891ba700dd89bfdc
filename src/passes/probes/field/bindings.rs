//! What a probe field offers to kernels: buffers, textures and constants, by name.

use super::{ProbeField, Source};
use crate::{lights::RhythmsTold, probes::VisibilityBits};

impl ProbeField {
    /// The bindings of `shaders/probes/field.wesl`: what kernels that gather read.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 10] {
        use wgpu::BindingResource::TextureView;
        let [update_schedule, work] = self.update_schedule.resources();
        [
            update_schedule,
            work,
            ("probe_tree", self.tree.rows.as_entire_binding()),
            ("probe_info", self.info.as_entire_binding()),
            ("ray_directions", self.ray_directions.as_entire_binding()),
            ("irradiance_maps", self.irradiance_maps.as_entire_binding()),
            ("distance_atlas", TextureView(&self.distance_view)),
            ("probe_places", self.places.as_entire_binding()),
            (
                "probe_visibility",
                self.visibility_buffer.as_entire_binding(),
            ),
            ("ambient_cubes", self.ambient_cubes.as_entire_binding()),
        ]
    }

    /// What an update of the field writes: rays, maps, and states; and which probes measure distances.
    pub fn update_resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 14] {
        use wgpu::BindingResource::TextureView;
        let [update_schedule, work] = self.update_schedule.resources();
        [
            update_schedule,
            work,
            ("probe_tree", self.tree.rows.as_entire_binding()),
            ("probe_info", self.info.as_entire_binding()),
            ("ray_directions", self.ray_directions.as_entire_binding()),
            ("probe_rays", self.rays.as_entire_binding()),
            ("probe_states", self.states.as_entire_binding()),
            ("probe_variability", self.variability.as_entire_binding()),
            ("probe_places", self.places.as_entire_binding()),
            ("changes", self.changes_info.as_entire_binding()),
            ("irradiance_out", self.irradiance_maps.as_entire_binding()),
            ("distance_out", TextureView(&self.distance_view)),
            ("ambient_cubes_out", self.ambient_cubes.as_entire_binding()),
            self.update_schedule.distance_list(),
        ]
    }

    /// What the passes `probes/classify` and `probes/visibility` read and write of each probe: its place, its state,
    /// its visibility bits, and requests.
    pub fn state_resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 9] {
        let [update_schedule, work] = self.update_schedule.resources();
        let [_, _, of_pixels] = self.update_schedule.requests();
        [
            of_pixels,
            update_schedule,
            work,
            ("probe_tree", self.tree.rows.as_entire_binding()),
            ("probe_info", self.info.as_entire_binding()),
            ("probe_places_out", self.places.as_entire_binding()),
            ("probe_states", self.states.as_entire_binding()),
            (
                "probe_visibility_out",
                self.visibility_buffer.as_entire_binding(),
            ),
            ("probe_rays", self.rays.as_entire_binding()),
        ]
    }

    /// What pass `probes/cover` writes besides [`Self::resources`].
    pub fn cover_resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("probe_places_out", self.places.as_entire_binding()),
            ("probe_variability", self.variability.as_entire_binding()),
        ]
    }

    /// What pass `probes/schedule` reads and writes besides [`Self::resources`].
    pub fn schedule_resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 8] {
        let [of_faces, of_quadrants, of_pixels] = self.update_schedule.requests();
        [
            of_faces,
            of_quadrants,
            of_pixels,
            ("probe_states", self.states.as_entire_binding()),
            (
                "probe_dispatch",
                self.update_schedule.dispatch().as_entire_binding(),
            ),
            ("probe_variability", self.variability.as_entire_binding()),
            ("changes", self.changes_info.as_entire_binding()),
            self.update_schedule.distance_list(),
        ]
    }

    /// The request list that pass `surface_cache/trace` binds in place of that of pass `probes/trace`: the two passes
    /// run concurrently.
    pub fn requests_of_faces(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        self.update_schedule.requests_of_faces()
    }

    /// The request list of pass `surface_cache/estimate`, which runs concurrently with both.
    pub fn requests_of_quadrants(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        self.update_schedule.requests_of_quadrants()
    }

    /// The request list of pass `view/shade`, which runs concurrently with all of them.
    pub fn requests_of_pixels(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        self.update_schedule.requests_of_pixels()
    }

    /// The constants of kernels that gather.
    pub fn gather_constants(&self) -> [(&'static str, f64); 8] {
        let [octree, rhythms, by_channel] = self.layout_constants();
        let visits_all = self
            .volume
            .octree()
            .is_some_and(|octree| octree.spec().source);
        let cut = self.visibility_bits().is_some_and(VisibilityBits::is_cut);
        let nested = self.volume.moves() || self.volume.levels().len() > 1;
        [
            (
                "SOURCE_WEIGHTS",
                self.source.as_ref().map_or(0.0, Source::weights),
            ),
            ("EXACT", f64::from(u8::from(self.exact()))),
            ("CUT", f64::from(u8::from(cut))),
            ("NESTED", f64::from(u8::from(nested))),
            ("VISITS_ALL", f64::from(u8::from(visits_all))),
            octree,
            rhythms,
            by_channel,
        ]
    }

    /// The constants of kernels that know where probes are and how their light is stored.
    pub fn layout_constants(&self) -> [(&'static str, f64); 3] {
        let is_octree = self.volume.octree().is_some();
        let by_channel = self.told == RhythmsTold::ByChannel;
        [
            ("OCTREE", f64::from(u8::from(is_octree))),
            ("RHYTHMS", f64::from(u8::from(self.rhythms.is_some()))),
            ("BY_CHANNEL", f64::from(u8::from(by_channel))),
        ]
    }
}
