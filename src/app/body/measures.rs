//! How large and how fast the player is.

use super::sweep::to_units;
use crate::world::PLAYER_HEIGHT_M;

/// Sizes in units of a voxel ([`super::sweep::ONE`]), speeds in voxels per second. The numbers are Luanti's
/// defaults for one-metre voxels; a world scales them all by the height of its player.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// From the middle of the box to its sides: 0.3 m.
    pub half_width: i64,
    pub height: i64,
    /// From the feet to the eye: 1.625 m.
    pub eye: i64,
    /// Highest step that is walked up without a jump: 0.6 m, but always at least one voxel.
    pub step_up: i64,
    pub walk: f64,
    pub sneak: f64,
    pub run: f64,
    /// Upwards, at the start of a jump: 6.5 m/s, which rises 1.08 m.
    pub jump: f64,
    /// Voxels per second, per second.
    pub gravity: f64,
    /// Air keeps a fall from becoming faster than this.
    pub fastest_fall: f64,
    /// How far the player reaches to dig and place, in voxels from the eye.
    pub reach: f64,
    /// Voxels per metre of the player's own size.
    pub scale: f64,
}

impl Measures {
    /// For a player of this height in voxels.
    pub fn of_height(height: f64) -> Self {
        let scale = height / PLAYER_HEIGHT_M;
        Self {
            half_width: to_units(0.3 * scale),
            height: to_units(PLAYER_HEIGHT_M * scale),
            eye: to_units(1.625 * scale),
            step_up: to_units((0.6 * scale).max(1.0)),
            walk: 4.0 * scale,
            sneak: 1.35 * scale,
            run: 6.0 * scale,
            jump: 6.5 * scale,
            gravity: 19.6 * scale,
            fastest_fall: 60.0 * scale,
            reach: 5.0 * scale,
            scale,
        }
    }
}
