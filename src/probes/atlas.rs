//! How the maps of many probes are arranged, and how much memory they take.

use super::ProbeError;
use crate::parameters::{Method, ProbeParameters};

/// The maps of slot s lie in tile (s & (2^columns_log2 − 1), (s >> columns_log2) & (2^rows_log2 − 1))
/// of layer s >> (columns_log2 + rows_log2). A tile holds a map and its border of one texel. Distances lie so in a texture;
/// irradiance lies in a buffer, probe by probe and without borders, and is shown in such tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AtlasLayout {
    pub slots: u32,
    pub columns_log2: u32,
    pub rows_log2: u32,
    /// Allocated rows of tiles: fewer than 2^rows_log2 where one layer is enough.
    pub rows: u32,
    pub layers: u32,
    /// Texels along a map, without its border.
    pub irradiance_texels: u32,
    /// 0 if no distances are stored.
    pub distance_texels: u32,
}

/// Bytes of a texel of an irradiance map: see [`light_of`](super::packed::light_of).
const IRRADIANCE_TEXEL_BYTES: u64 = 8;
/// Bytes of a texel of the distance atlas: see [`distances_of`](super::packed::distances_of).
const DISTANCE_TEXEL_BYTES: u64 = 4;
/// Radiance and distance of one ray (f16); a kept hit takes as many.
const RAY_BYTES: u64 = 8;
/// Number of updates, mean luminance, variability, and flags.
pub const STATE_BYTES: u64 = 16;
/// The means that tell changes from noise, and the values that they share.
const VARIABILITY_BYTES: u64 = VARIABILITY_VECTORS * 16;
/// Where the probe is, and whether it gives light.
pub const PLACE_BYTES: u64 = 16;
/// Irradiance along six axes (f16), and whether the probe gives any.
const CUBE_BYTES: u64 = CUBE_VECTORS * 16;
const RHYTHM_CUBE_BYTES: u64 = RHYTHM_VECTORS as u64 * 16;
/// Per probe: an entry of the active list, and the frames of the last requests by rays of probes, by rays of faces, by quadrants of
/// faces that rays and that pixels request, and by pixels.
const PLAN_BYTES: u64 = (1 + 1 + 1 + 2 + 1) * 4;
/// Under [`Method::Source`]: what each probe knows about its place.
pub const WALK_BYTES: u64 = 8;
/// Where probes keep distances: an entry of the list of those that measure them.
const MEASURED_BYTES: u64 = 16;

crate::shared! {
    in probes;

    /// Means that are watched for change: RGB, and direction times luminance.
    const VARIABILITY_MEANS: u64 = 6;

    /// Vectors that a probe's variability takes: one for each mean, one for its pulse, and a component for the drift of each
    /// mean and for the last frame in which a body was near.
    const VARIABILITY_VECTORS: u64 = VARIABILITY_MEANS + 1 + (VARIABILITY_MEANS + 1).div_ceil(4);

    /// Vectors of a packed cube, one for each axis: three halves low, three halves high, and a word
    /// that says whether the probe gives any light.
    const CUBE_VECTORS: u64 = 3;

    /// The same where lamps have rhythms: one for each direction along an axis.
    const RHYTHM_VECTORS: u32 = 6;

    /// Words of the shares of a light that come from lamps of each rhythm: of three numbers each.
    const RHYTHM_PARTS: u32 = 3;
}

/// Memory of a probe field on the GPU, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeMemory {
    pub irradiance_maps: u64,
    pub distance_atlas: u64,
    pub rays: u64,
    /// Hits that are kept, which lie behind the rays in their buffer.
    pub kept_hits: u64,
    /// Places that kept hits were traced from.
    pub hit_places: u64,
    pub states: u64,
    pub variability: u64,
    pub places: u64,
    pub ambient_cubes: u64,
    /// Which shares of the radiance of rays come from lamps that have rhythms: behind the kept hits in their buffer.
    pub ray_shares: u64,
    /// The same of the light of probes.
    pub rhythms: u64,
    /// Visibility bits of the probes under exact visibility; not part of the atlas.
    pub visibility_bits: u64,
    /// The octree's cells and slots; not part of the atlas.
    pub octree: u64,
    /// Maps and rays of the occlusion field; not part of the atlas.
    pub occlusion: u64,
    pub update_schedule: u64,
    /// Under [`Method::Source`] alone.
    pub walks: u64,
}

impl ProbeMemory {
    /// The same for probes that tell apart lamps that have rhythms.
    #[must_use]
    pub fn with_rhythms(self, layout: &AtlasLayout) -> Self {
        let slots = u64::from(layout.slots);
        Self {
            ray_shares: self.rays,
            rhythms: slots * RHYTHM_CUBE_BYTES * u64::from(RHYTHM_PARTS),
            ambient_cubes: slots * RHYTHM_CUBE_BYTES,
            ..self
        }
    }

    /// Of the buffer of the rays, and of what lies behind them.
    pub fn ray_buffer(&self) -> u64 {
        self.rays + self.kept_hits + self.ray_shares
    }

    pub fn total(&self) -> u64 {
        self.irradiance_maps
            + self.distance_atlas
            + self.rays
            + self.kept_hits
            + self.hit_places
            + self.states
            + self.variability
            + self.places
            + self.ambient_cubes
            + self.ray_shares
            + self.rhythms
            + self.visibility_bits
            + self.octree
            + self.occlusion
            + self.update_schedule
            + self.walks
    }
}

impl AtlasLayout {
    /// A roughly square layout within textures of `extent`² texels and `layers` layers. Without
    /// `distances` there are no distance maps.
    ///
    /// # Errors
    /// [`ProbeError::Atlas`] if the maps do not fit.
    pub fn new(
        slots: u32,
        parameters: &ProbeParameters,
        distances: bool,
        extent: u32,
        layers: u32,
    ) -> Result<Self, ProbeError> {
        let distance_texels = if distances {
            parameters.distance_texels
        } else {
            0
        };
        let texels = parameters.irradiance_texels.max(distance_texels);
        let refused = ProbeError::Atlas {
            texels,
            slots,
            extent,
            layers,
        };
        let Some(most_log2) = (extent / (texels + 2)).checked_ilog2() else {
            return Err(refused);
        };
        let square_log2 = slots.next_power_of_two().ilog2().div_ceil(2);
        let columns_log2 = square_log2.min(most_log2);
        let all_rows = slots.div_ceil(1 << columns_log2);
        let rows_log2 = all_rows.next_power_of_two().ilog2().min(most_log2);
        let needed = all_rows.div_ceil(1 << rows_log2);
        if needed > layers {
            return Err(refused);
        }
        Ok(Self {
            slots,
            columns_log2,
            rows_log2,
            rows: all_rows.min(1 << rows_log2),
            layers: needed,
            irradiance_texels: parameters.irradiance_texels,
            distance_texels,
        })
    }

    /// Width, height and number of the layers for maps of this width in texels; of the smallest possible texture for 0.
    pub fn layer_extent(&self, texels: u32) -> [u32; 3] {
        if texels == 0 {
            return [1; 3];
        }
        let tile = texels + 2;
        [tile << self.columns_log2, tile * self.rows, self.layers]
    }

    /// Column, row and layer of a slot's tile.
    pub fn tile(&self, slot: u32) -> [u32; 3] {
        let low = |bits: u32| (1 << bits) - 1;
        [
            slot & low(self.columns_log2),
            (slot >> self.columns_log2) & low(self.rows_log2),
            slot >> (self.columns_log2 + self.rows_log2),
        ]
    }

    /// All memory of the field with the rays of `parameters`.
    pub fn memory(&self, parameters: &ProbeParameters) -> ProbeMemory {
        let slots = u64::from(self.slots);
        let rays = slots * u64::from(parameters.rays) * RAY_BYTES;
        let hit_sets = u64::from(parameters.kept_sets());
        let irradiance_texels = u64::from(self.irradiance_texels).pow(2);
        let measured = if self.distance_texels > 0 {
            MEASURED_BYTES
        } else {
            0
        };
        let [width, height, layers] = self.layer_extent(self.distance_texels).map(u64::from);
        ProbeMemory {
            irradiance_maps: slots * irradiance_texels * IRRADIANCE_TEXEL_BYTES,
            distance_atlas: width * height * layers * DISTANCE_TEXEL_BYTES,
            rays,
            kept_hits: hit_sets * rays,
            hit_places: slots * PLACE_BYTES * hit_sets.min(1),
            states: slots * STATE_BYTES,
            variability: slots * VARIABILITY_BYTES,
            places: slots * PLACE_BYTES,
            ambient_cubes: slots * CUBE_BYTES,
            ray_shares: 0,
            rhythms: 0,
            visibility_bits: 0,
            octree: 0,
            occlusion: 0,
            update_schedule: slots * (PLAN_BYTES + measured),
            walks: match parameters.method {
                Method::Source => slots * WALK_BYTES,
                Method::Grotto => 0,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::parameters::ProbeHits;

    fn layout(slots: u32, extent: u32, layers: u32) -> Result<AtlasLayout, ProbeError> {
        AtlasLayout::new(slots, &ProbeParameters::default(), true, extent, layers)
    }

    #[test]
    fn every_slot_has_a_tile_of_its_own_inside_the_texture() {
        for (slots, extent) in [(1, 8192), (2, 8192), (567, 8192), (3375, 8192), (1000, 128)] {
            let layout = layout(slots, extent, 256).expect("fits");
            let [width, height, layers] = layout.layer_extent(layout.distance_texels);
            assert!(
                width <= extent && height <= extent && layers <= 256,
                "{layout:?}"
            );
            let mut seen = HashSet::new();
            for slot in 0..slots {
                let [column, row, layer] = layout.tile(slot);
                assert!((column + 1) * 18 <= width && (row + 1) * 18 <= height && layer < layers);
                assert!(seen.insert([column, row, layer]));
            }
        }
    }

    #[test]
    fn a_quarter_of_a_million_probes_fit_the_default_limits() {
        let limits = wgpu_defaults();
        let layout = layout(262_144, limits.0, limits.1).expect("fits");
        assert_eq!(layout.layers, 4);
    }

    /// `max_texture_dimension_2d` and `max_texture_array_layers` of WebGPU's defaults.
    fn wgpu_defaults() -> (u32, u32) {
        (8192, 256)
    }

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let error = layout(100_000, 64, 4).expect_err("too many").to_string();
        assert!(error.contains("probes.distance_texels"), "{error}");
        assert!(
            layout(1, 8, 1).is_err(),
            "one tile is wider than the texture"
        );
    }

    #[test]
    fn memory_is_the_sum_of_its_parts() {
        let layout = layout(64, 8192, 256).expect("fits");
        let parameters = |hits, hit_sets| ProbeParameters {
            rays: 100,
            hits,
            hit_sets,
            ..ProbeParameters::default()
        };
        let memory = layout.memory(&parameters(ProbeHits::Traced, 4));
        assert_eq!(memory.irradiance_maps, 64 * 64 * 8);
        assert_eq!(memory.distance_atlas, 64 * 324 * 4);
        assert_eq!(
            memory.total(),
            64 * (64 * 8 + 1296 + 800 + 16 + 144 + 16 + 48 + 40)
        );
        // Four sets of 100 hits of 8 bytes, and the place of each probe.
        let kept = layout.memory(&parameters(ProbeHits::Kept, 4));
        assert_eq!(kept.total() - memory.total(), 64 * (4 * 800 + 16));
    }

    /// `worlds/cavern.ron --layout cascades`: four levels of 32 × 16 × 32 probes, whose visibility is estimated.
    #[test]
    fn the_cascades_of_the_cavern_take_3_kb_per_probe() {
        let layout = layout(65_536, 16_384, 2048).expect("fits");
        let memory = layout.memory(&ProbeParameters::default());
        assert_eq!(memory.total(), 65_536 * 3096);
        assert!(memory.total() < 203_000_000, "{memory:?}");
    }
}
