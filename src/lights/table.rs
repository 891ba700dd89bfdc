//! The lights as bytes for the GPU: the start of the buffer `Lights` of `shaders/scene/lights.wesl`.

use std::iter;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use super::lamp::MIN_SPOT_EDGE;
use super::{Cells, LampShape, LampState, Lights, Rhythms, rest::Settled};
use crate::world::{placed::MOST_PLACED, scenery::MAX_LAMPS};

crate::shared! {
    in lights;

    /// Lamps in the buffer: those of the largest preset, the sun, and those that players place.
    pub const CAPACITY as LAMPS: usize = MAX_LAMPS + 1 + MOST_PLACED;

    /// Lamps that a face can know about, whether it sees them. Worlds with no more lamps have no lists.
    pub const KNOWN_LAMPS as KNOWN_LAMPS: u32 = 64;

    /// Lamps in the list of a cell: see [`super::lists`]. Fewer than [`KNOWN_LAMPS`], because pixels and hits look at all
    /// of them.
    pub const LISTED as LISTED: u32 = 32;

    /// `GpuLampSlot::lamp` of a slot without a lamp.
    pub const NO_LAMP as NO_LAMP: u32 = u32::MAX;

    /// What a lamp is: `GpuLamp::kind`.
    const LAMP_POINT: u32 = 0;
    const LAMP_DIRECTIONAL: u32 = 1;
    /// A sphere, whose shadows are soft.
    const LAMP_SPHERE: u32 = 2;

    /// One lamp. The spot's edge is folded into a ramp,
    /// clamp(cos · spot_scale + spot_offset), which is 1 for lamps that are not spots.
    pub struct GpuLamp as Lamp {
        pub position_ws: [f32; 3],
        /// Of a sphere its radius; of other lamps, smaller distances count as this one.
        pub radius: f32,
        /// Unit vector along which the light goes.
        pub direction_ws: [f32; 3],
        /// One of the LAMP_ constants. A directional lamp has neither position nor falloff.
        pub kind: u32,
        /// Radiant intensity (linear RGB, W/sr).
        pub intensity: [f32; 3],
        /// The spot's edge: clamp(cos · spot_scale + spot_offset); 0 and 1 for lamps that are not
        /// spots.
        pub spot_scale: f32,
        pub spot_offset: f32,
        /// The first frame of the lamp's present place, direction and shape ([`super::RestingLamps`]).
        pub still_since: u32,
        /// Sum of the channels of the greatest intensity that lists count with ([`super::LampRanks`]).
        pub brightest: f32,
        /// `brightest` of all lamps before this one.
        pub brightest_before: f32,
    }

    /// Rhythms that are told apart ([`super::rhythms`]).
    pub const RHYTHMS_KNOWN as RHYTHMS_KNOWN: u32 = 9;

    /// So many are told apart by their share of each colour channel ([`super::RhythmsTold`]).
    pub const TOLD_BY_CHANNEL as TOLD_BY_CHANNEL: u32 = 3;

    /// The lamps of a rhythm.
    pub struct GpuRhythm as Rhythm {
        /// The factors of now (linear RGB).
        pub gain: [f32; 3],
        /// Their share of the power of all lamps that have rhythms.
        pub power: f32,
        /// Linear RGB, with a sum of 1.
        pub colour: [f32; 3],
        pub _pad0: f32,
        /// One bit for each lamp.
        pub lamps: [u32; 2],
        pub _pad1: [f32; 2],
    }

    /// A place in the list of a cell.
    pub struct GpuLampSlot as LampSlot {
        /// Number of the lamp, or `NO_LAMP`.
        pub lamp: u32,
        /// The frame since which it is the lamp of this slot.
        pub since: u32,
    }

    /// Radiance of the sky (linear RGB).
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
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuLightsHeader {
    pub sky: GpuSky,
    /// See [`super::CommonGain`].
    pub gain: [f32; 3],
    pub lamp_count: u32,
    /// Cells along each axis that have lists of lamps.
    pub list_cells: [u32; 3],
    /// log2 of the voxels along a cell.
    pub list_shift: u32,
    /// `brightest` of all lamps.
    pub all_brightest: f32,
    /// The frame in which the lists were last made.
    pub list_frame: u32,
    /// 1: lamps that stay in a list keep their slots.
    pub keeps_slots: u32,
    /// Number of lamps that are spheres.
    pub soft_lamps: u32,
    /// See [`Settled`].
    pub unsettled: [u32; 2],
    pub settled_since: u32,
    /// The last frame in which a lamp moved.
    pub moved_last: u32,
    /// Cells along each axis that know which lamps are seen from them.
    pub sight_cells: [u32; 3],
    /// log2 of the voxels along a cell.
    pub sight_shift: u32,
    /// What stone hides from the first cell ([`super::CellShadows`]): an index into `lists`.
    pub first_shadow: u32,
    /// 1: what is known of that holds.
    pub shadows_known: u32,
    /// 1: some light comes from no lamp that has a rhythm.
    pub has_steady: u32,
    pub _pad: u32,
    /// See [`Rhythms`].
    pub rhythms: [GpuRhythm; RHYTHMS_KNOWN as usize],
    /// Of the first [`KNOWN_LAMPS`] lamps: by what their light is multiplied (linear RGB).
    pub lamp_gains: [[f32; 4]; KNOWN_LAMPS as usize],
}

/// The frame since which a lamp rests that never does.
const NEVER_STILL: u32 = u32::MAX / 2;

/// Byte of the lists in the buffer: behind the header and the lamps.
pub const LISTS_OFFSET: usize = size_of::<GpuLightsHeader>() + CAPACITY * size_of::<GpuLamp>();

/// What the GPU is told about the lights of a frame, besides the lights.
#[derive(Clone, Debug, PartialEq)]
pub struct LightsOfFrame {
    /// The factor of [`super::CommonGain`].
    pub gain: Vec3,
    pub rhythms: Rhythms,
    /// What [`super::RestingLamps`] says of each lamp; lamps without a number never rest.
    pub still_since: Vec<u32>,
    /// What [`super::LampRanks`] says of each lamp; lamps without a number count with their intensity of now.
    pub brightest: Vec<f32>,
    /// The frame in which the lists were last made, and whether lamps that stay in a list keep their slots.
    pub list_frame: u32,
    pub keeps_slots: bool,
    /// What pass `surface_cache/cell_shadows` has found holds.
    pub shadows_known: bool,
}

impl Default for LightsOfFrame {
    fn default() -> Self {
        Self {
            gain: Vec3::ONE,
            rhythms: Rhythms::default(),
            still_since: Vec::new(),
            brightest: Vec::new(),
            list_frame: 0,
            keeps_slots: false,
            shadows_known: false,
        }
    }
}

impl Lights {
    /// The header and the lamps. `listed` are the cells that have lists, `of_sight` those that know which lamps they see.
    ///
    /// Panics beyond [`CAPACITY`] lamps, which a checked world cannot have.
    pub fn to_bytes(&self, of_frame: &LightsOfFrame, listed: Cells, of_sight: Cells) -> Vec<u8> {
        assert!(
            self.lamps.len() <= CAPACITY,
            "a checked world has at most {MAX_LAMPS} lamps, a sun, and {MOST_PLACED} placed lamps"
        );
        let since = (of_frame.still_since.iter().copied()).chain(iter::repeat(NEVER_STILL));
        let since: Vec<u32> = since.take(self.lamps.len()).collect();
        let settled = Settled::of(&since);
        let brightest = (of_frame.brightest.iter().copied().map(Some)).chain(iter::repeat(None));
        let mut before = 0.0;
        let lamps: Vec<GpuLamp> = (self.lamps.iter().zip(since).zip(brightest))
            .map(|((lamp, still_since), brightest)| {
                let brightest = brightest.unwrap_or_else(|| lamp.brightness());
                let brightest_before = before as f32;
                before += f64::from(brightest);
                GpuLamp {
                    still_since,
                    brightest,
                    brightest_before,
                    ..GpuLamp::from(lamp)
                }
            })
            .collect();
        let header = GpuLightsHeader {
            sky: GpuSky {
                zenith: self.sky.zenith.to_array(),
                horizon: self.sky.horizon.to_array(),
                ground: self.sky.ground.to_array(),
                ..GpuSky::default()
            },
            gain: of_frame.gain.to_array(),
            lamp_count: self.lamps.len() as u32,
            list_cells: listed.count.to_array(),
            list_shift: listed.shift,
            all_brightest: before as f32,
            list_frame: of_frame.list_frame,
            keeps_slots: u32::from(of_frame.keeps_slots),
            soft_lamps: self.lamps.iter().filter(|lamp| lamp.is_soft()).count() as u32,
            unsettled: settled.unsettled,
            settled_since: settled.since,
            moved_last: settled.moved_last,
            sight_cells: of_sight.count.to_array(),
            sight_shift: of_sight.shift,
            first_shadow: listed.number() as u32 * LISTED,
            shadows_known: u32::from(of_frame.shadows_known),
            has_steady: u32::from(of_frame.rhythms.has_steady()),
            _pad: 0,
            rhythms: of_frame.rhythms.to_gpu(),
            lamp_gains: of_frame.rhythms.lamp_gains(),
        };
        [
            bytemuck::bytes_of(&header),
            bytemuck::cast_slice::<_, u8>(&lamps),
        ]
        .concat()
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
        let (kind, radius) = match lamp.shape {
            LampShape::Directional => (LAMP_DIRECTIONAL, lamp.radius),
            _ if lamp.is_soft() => (LAMP_SPHERE, lamp.soft_radius),
            LampShape::Point | LampShape::Spot { .. } => (LAMP_POINT, lamp.radius),
        };
        Self {
            position_ws: array(lamp.position_ws),
            radius: radius as f32,
            direction_ws: array(lamp.direction_ws),
            kind,
            intensity: array(lamp.intensity),
            spot_scale,
            spot_offset,
            ..Self::default()
        }
    }
}
