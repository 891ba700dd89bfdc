//! The lights as bytes for the GPU: the uniform `Lights` of `shaders/scene/lights.wesl`.

use std::iter;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use super::lamp::MIN_SPOT_EDGE;
use super::{LampShape, LampState, Lights};
use crate::world::scenery::MAX_LAMPS;

crate::shared! {
    in lights;

    /// Lamps in the uniform: those of the largest preset, and the sun.
    pub const CAPACITY as LAMPS: usize = MAX_LAMPS + 1;

    /// One lamp: `Lamp` in `shaders/scene/lights.wesl`. The spot's edge is folded into a ramp,
    /// clamp(cos · spot_scale + spot_offset), which is 1 for lamps that are not spots.
    pub struct GpuLamp as Lamp {
        pub position_ws: [f32; 3],
        /// Smaller distances count as this one.
        pub radius: f32,
        /// Unit vector along which the light goes.
        pub direction_ws: [f32; 3],
        /// 1 for lamps without position and falloff, else 0.
        pub directional: u32,
        /// Radiant intensity (linear RGB, W/sr).
        pub intensity: [f32; 3],
        /// The spot's edge: clamp(cos · spot_scale + spot_offset); 0 and 1 for lamps that are not
        /// spots.
        pub spot_scale: f32,
        pub spot_offset: f32,
        /// The first frame of the lamp's present place, direction and shape ([`super::RestingLamps`]).
        pub still_since: u32,
        pub _pad: [f32; 2],
    }

    /// `Sky` in `shaders/scene/lights.wesl`.
    pub struct GpuSky as Sky {
        pub zenith: [f32; 3],
        pub _pad0: f32,
        pub horizon: [f32; 3],
        pub _pad1: f32,
        pub ground: [f32; 3],
        pub _pad2: f32,
    }
}

/// The fields before the lamps: the start of `Lights` in `shaders/scene/lights.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuLightsHeader {
    pub sky: GpuSky,
    /// See [`super::CommonGain`].
    pub gain: [f32; 3],
    pub lamp_count: u32,
}

/// Size of the uniform in bytes, the same for every world.
pub const BYTES: usize = size_of::<GpuLightsHeader>() + CAPACITY * size_of::<GpuLamp>();

impl Lights {
    /// The uniform's content: [`BYTES`] bytes, unused lamps zero. `gain` is the factor of [`super::CommonGain`].
    ///
    /// `still_since` is what [`super::RestingLamps`] says of each lamp; lamps without a number never rest.
    ///
    /// Panics beyond [`CAPACITY`] lamps, which a checked world cannot have.
    pub fn to_bytes(&self, gain: Vec3, still_since: &[u32]) -> Vec<u8> {
        assert!(
            self.lamps.len() <= CAPACITY,
            "a checked world has at most {MAX_LAMPS} lamps and a sun"
        );
        let header = GpuLightsHeader {
            sky: GpuSky {
                zenith: self.sky.zenith.to_array(),
                horizon: self.sky.horizon.to_array(),
                ground: self.sky.ground.to_array(),
                ..GpuSky::default()
            },
            gain: gain.to_array(),
            lamp_count: self.lamps.len() as u32,
        };
        let since = still_since
            .iter()
            .copied()
            .chain(iter::repeat(u32::MAX / 2));
        let lamps: Vec<GpuLamp> = (self.lamps.iter().zip(since))
            .map(|(lamp, still_since)| GpuLamp {
                still_since,
                ..GpuLamp::from(lamp)
            })
            .collect();
        let mut bytes = Vec::with_capacity(BYTES);
        bytes.extend_from_slice(bytemuck::bytes_of(&header));
        bytes.extend_from_slice(bytemuck::cast_slice(&lamps));
        bytes.resize(BYTES, 0);
        bytes
    }
}

impl From<&LampState> for GpuLamp {
    fn from(lamp: &LampState) -> Self {
        let array = |v: DVec3| v.as_vec3().to_array();
        let (spot_scale, spot_offset) = match lamp.shape {
            LampShape::Spot {
                cos_inner,
                cos_outer,
            } => {
                let scale = 1.0 / (cos_inner - cos_outer).max(MIN_SPOT_EDGE);
                (scale as f32, (-cos_outer * scale) as f32)
            }
            LampShape::Point | LampShape::Directional => (0.0, 1.0),
        };
        Self {
            position_ws: array(lamp.position_ws),
            radius: lamp.radius as f32,
            direction_ws: array(lamp.direction_ws),
            directional: u32::from(lamp.shape == LampShape::Directional),
            intensity: array(lamp.intensity),
            spot_scale,
            spot_offset,
            ..Self::default()
        }
    }
}
