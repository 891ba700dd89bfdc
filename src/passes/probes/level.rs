//! A level of the probe field as shaders read it.

use super::source;
use crate::{
    parameters::ProbeParameters,
    probes::{Level, Motion, VisibilityBits, VisibilityBox, Volume, volume::MAX_LEVELS},
};

crate::shared! {
    in probes;

    /// Room for the levels of a volume.
    pub const LEVELS: usize = MAX_LEVELS as usize;

    /// A window of probes on an endless lattice (src/probes/level.rs). Each level has twice the spacing of
    /// the level before it.
    pub struct GpuProbeLevel as ProbeLevel {
        /// World-space position of the window's lowest corner.
        pub first_ws: [f32; 3],
        pub first_slot: u32,
        /// Distance between lattice points (voxels).
        pub spacing: [f32; 3],
        /// Distances are stored in units of this (voxels).
        pub longest: f32,
        pub inverse_spacing: [f32; 3],
        /// Width in cells of the edge over which the next level takes over.
        pub fade: f32,
        /// World-space middle of what the level lights; `reach` is the distance from there to its end in cells.
        pub middle_ws: [f32; 3],
        /// Frames since most of the level was new.
        pub age: u32,
        pub reach: [f32; 3],
        /// First word of the level in `probe_visibility`; `visibility_words` is the number of words per probe.
        pub visibility_first_word: u32,
        /// World-space position of lattice point (0, 0, 0).
        pub anchor_ws: [f32; 3],
        pub visibility_words: u32,
        /// Lattice point at the window's lowest corner; `wrap` is the same modulo the counts.
        pub base: [i32; 3],
        /// Words of a probe's visibility bits in a row of bricks along x; `visibility_layer`: in a layer of rows.
        pub visibility_row: u32,
        pub wrap: [u32; 3],
        pub visibility_layer: u32,
        /// `base` in the frame before.
        pub base_before: [i32; 3],
        pub _pad4: u32,
        /// Where there is a choice, probes in solid voxels move towards this point.
        pub inwards_ws: [f32; 3],
        pub _pad5: u32,
        /// Voxels, along each axis, of the box that a probe's visibility bits cover.
        pub visibility_counts: [u32; 3],
        pub _pad6: u32,
        /// How far that box reaches from the lattice point (voxels).
        pub visibility_reach: [f32; 3],
        pub _pad7: u32,
    }
}

/// Longest distance that a probe stores, in diagonals of its cage.
const LONGEST: f32 = 1.5;
/// Cells at the edge of a level over which the next one takes over.
const FADE_CELLS: f32 = 1.0;
/// A coordinate far beyond every probe.
const FAR: f32 = 1e30;

impl GpuProbeLevel {
    /// The levels of a volume in a frame; levels that the volume does not have are 0.
    pub fn all(
        volume: &Volume,
        motion: &Motion,
        visibility_bits: Option<&VisibilityBits>,
        parameters: &ProbeParameters,
        frame: u64,
    ) -> [Self; LEVELS] {
        let longest = source::longest(parameters).unwrap_or(LONGEST);
        let mut all = [Self::default(); LEVELS];
        let levels = volume.levels().iter().zip(motion.before().levels());
        for (index, (gpu_level, (level, before))) in all.iter_mut().zip(levels).enumerate() {
            let seen = visibility_bits.map(|visibility_bits| visibility_bits.boxes()[index]);
            *gpu_level = Self {
                visibility_first_word: seen.map_or(0, |seen| seen.first_word),
                visibility_row: seen.map_or(0, |seen| seen.bricks().x),
                visibility_layer: seen.map_or(0, |seen| seen.bricks().x * seen.bricks().y),
                visibility_words: seen.map_or(0, |seen| seen.words()),
                visibility_counts: seen.map_or([0; 3], |seen| seen.counts.to_array()),
                longest: longest * level.cage_diagonal(),
                fade: volume.fade(FADE_CELLS),
                age: motion.age(index, frame),
                ..Self::new(level, before, volume.moves())
            };
        }
        all
    }

    /// The place of a level, now and `before`; the rest is 0. In a volume that `moves`, the destination of a probe in
    /// a solid voxel must not depend on the window's place.
    fn new(level: &Level, before: &Level, moves: bool) -> Self {
        Self {
            first_ws: level.first().to_array(),
            first_slot: level.first_slot(),
            spacing: level.spacing().to_array(),
            visibility_reach: VisibilityBox::reach(level.spacing()).to_array(),
            inverse_spacing: level.spacing().recip().to_array(),
            middle_ws: level.middle().to_array(),
            reach: level.reach().to_array(),
            anchor_ws: level.anchor().to_array(),
            base: level.base().to_array(),
            wrap: level.wrap().to_array(),
            base_before: before.base().to_array(),
            inwards_ws: if moves {
                [FAR; 3]
            } else {
                level.middle().to_array()
            },
            ..Self::default()
        }
    }
}
