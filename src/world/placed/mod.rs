//! Lamps that a player has placed: each fills one voxel of air, beside the lamps of the world's presets.

#[cfg(test)]
pub mod tests;

use std::ops::RangeInclusive;

use glam::{IVec3, UVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::Travel;
use super::scenery::{LEAST_SOFT_RADIUS, Lamp, LampKind, Motion};

/// Most lamps that can be placed in a world.
pub const MOST_PLACED: usize = 4096;

/// Powers of lamp blocks (watts, as in world files).
pub const POWERS: RangeInclusive<f32> = 10.0..=20_000.0;
/// Radii of lamp blocks (voxels): see [`Lamp::radius`].
pub const RADII: RangeInclusive<f32> = 0.05..=0.5;
/// Radii of lamp blocks as spheres (voxels): see [`Lamp::soft_radius`]. The largest ends at the far side of the voxel
/// next to the lamp's own, so it lights nothing behind a wall.
pub const SOFT_RADII: RangeInclusive<f32> = 0.0..=1.5;

/// Voxels of placed lamps lie within ± this.
const FARTHEST: u32 = 1 << 24;

/// What a lamp block is like, wherever it is placed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LampBlock {
    pub form: LampForm,
    pub colour: LampColour,
    /// Watts, as in world files.
    pub power: f32,
    /// Voxels; smaller distances count as this one.
    pub radius: f32,
    /// Voxels: a sphere of this radius shines and casts soft shadows. 0 is a point, which saves and records of older
    /// builds mean, too.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub soft_radius: f32,
    pub motion: LampMotion,
}

fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LampForm {
    /// Shines everywhere.
    Point,
    /// Shines away from the face that it was placed at.
    Spot,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LampColour {
    White,
    Warm,
    Amber,
    Red,
    Magenta,
    Violet,
    Blue,
    Cyan,
    Green,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LampMotion {
    Still,
    Flicker,
    Pulse,
    Bob,
    Orbit,
    Hues,
}

/// A lamp block in its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacedLamp {
    /// World space. The lamp's centre is the centre of this voxel.
    pub voxel: IVec3,
    pub block: LampBlock,
    /// Unit vector along an axis, away from the face that it was placed at.
    pub towards: IVec3,
    pub is_on: bool,
}

impl Default for LampBlock {
    fn default() -> Self {
        Self {
            form: LampForm::Point,
            colour: LampColour::Warm,
            power: 1500.0,
            radius: 0.25,
            soft_radius: 0.0,
            motion: LampMotion::Still,
        }
    }
}

impl LampForm {
    pub const ALL: [Self; 2] = [Self::Point, Self::Spot];

    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "lamp",
            Self::Spot => "spot",
        }
    }
}

impl LampColour {
    pub const ALL: [Self; 9] = [
        Self::White,
        Self::Warm,
        Self::Amber,
        Self::Red,
        Self::Magenta,
        Self::Violet,
        Self::Blue,
        Self::Cyan,
        Self::Green,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Warm => "warm",
            Self::Amber => "amber",
            Self::Red => "red",
            Self::Magenta => "magenta",
            Self::Violet => "violet",
            Self::Blue => "blue",
            Self::Cyan => "cyan",
            Self::Green => "green",
        }
    }

    /// Linear Rec. 709.
    pub fn rgb(self) -> Vec3 {
        Vec3::from(match self {
            Self::White => [1.0, 1.0, 1.0],
            Self::Warm => [1.0, 0.7, 0.38],
            Self::Amber => [1.0, 0.45, 0.1],
            Self::Red => [1.0, 0.12, 0.08],
            Self::Magenta => [1.0, 0.1, 0.8],
            Self::Violet => [0.5, 0.2, 1.0],
            Self::Blue => [0.15, 0.3, 1.0],
            Self::Cyan => [0.1, 0.85, 1.0],
            Self::Green => [0.25, 1.0, 0.2],
        })
    }
}

impl LampMotion {
    pub const ALL: [Self; 6] = [
        Self::Still,
        Self::Flicker,
        Self::Pulse,
        Self::Bob,
        Self::Orbit,
        Self::Hues,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Still => "still",
            Self::Flicker => "flickers",
            Self::Pulse => "pulses",
            Self::Bob => "bobs",
            Self::Orbit => "orbits",
            Self::Hues => "turns its hue",
        }
    }

    fn motions(self) -> Vec<Motion> {
        match self {
            Self::Still => Vec::new(),
            Self::Flicker => vec![Motion::Flicker {
                amount: 0.4,
                rate: 4.0,
            }],
            Self::Pulse => vec![Motion::Pulse {
                amount: 0.9,
                rate: 2.0,
                phase: 0.0,
            }],
            Self::Bob => vec![Motion::Travel(Travel::Bob {
                amplitude: Vec3::new(0.0, 0.4, 0.0),
                rate: 2.0,
                phase: 0.0,
            })],
            Self::Orbit => vec![Motion::Travel(Travel::Orbit {
                radius: Vec3::new(1.5, 0.0, 1.5),
                rate: 1.5,
                phase: 0.0,
            })],
            Self::Hues => vec![Motion::HueCycle { rate: 0.1 }],
        }
    }
}

impl LampBlock {
    /// Half angles of a spot's cone (degrees): full light inside of the first, none outside of the second.
    const CONE_DEG: [f32; 2] = [28.0, 38.0];

    /// For a person: what it is, and how it differs from others.
    pub fn name(&self) -> String {
        let motion = match self.motion {
            LampMotion::Still => String::new(),
            motion => format!(", {}", motion.name()),
        };
        let (colour, form) = (self.colour.name(), self.form.name());
        let soft = if self.is_soft() { "soft " } else { "" };
        format!("{soft}{colour} {form}, {} W{motion}", self.power)
    }

    /// Why a block that was read from a file is none; `None` for one that can be placed.
    pub fn fault(&self) -> Option<String> {
        let fits = POWERS.contains(&self.power)
            && RADII.contains(&self.radius)
            && SOFT_RADII.contains(&self.soft_radius);
        (!fits).then(|| {
            format!(
                "a lamp block cannot have {} W, a radius of {} voxels and a soft radius of {}",
                self.power, self.radius, self.soft_radius
            )
        })
    }

    /// Whether it is a sphere, whose shadows are soft.
    pub fn is_soft(&self) -> bool {
        self.soft_radius >= LEAST_SOFT_RADIUS
    }
}

impl PlacedLamp {
    /// Where the lamp is while it does not move (world space).
    pub fn centre_ws(&self) -> Vec3 {
        self.voxel.as_vec3() + 0.5
    }

    /// Linear Rec. 709; as when it is on.
    pub fn colour(&self) -> Vec3 {
        self.block.colour.rgb()
    }

    /// The lamp as a preset of a world file would have it, where voxels are `voxel_m` metres wide.
    pub fn lamp(&self, voxel_m: f32) -> Lamp {
        let [inner_deg, outer_deg] = LampBlock::CONE_DEG;
        Lamp {
            name: "placed".to_owned(),
            kind: match self.block.form {
                LampForm::Point => LampKind::Point,
                LampForm::Spot => LampKind::Spot {
                    direction: self.towards.as_vec3(),
                    inner_deg,
                    outer_deg,
                },
            },
            position: self.centre_ws(),
            colour: self.colour(),
            power: self.block.power / (voxel_m * voxel_m),
            radius: self.block.radius,
            soft_radius: self.block.soft_radius,
            motion: self.block.motion.motions(),
        }
    }

    /// Whether its voxel lies in a grid of this origin and size.
    pub fn is_within(&self, origin: IVec3, size: UVec3) -> bool {
        let at = self.voxel - origin;
        at.cmpge(IVec3::ZERO).all() && at.cmplt(size.as_ivec3()).all()
    }
}

/// Why these lamps, read from a file, cannot be those of a world; `None` if they can.
pub fn fault(lamps: &[PlacedLamp]) -> Option<String> {
    if lamps.len() > MOST_PLACED {
        return Some(format!("there are more than {MOST_PLACED} placed lamps"));
    }
    let is_far = |lamp: &PlacedLamp| {
        let axes = lamp.voxel.to_array();
        axes.iter().any(|axis| axis.unsigned_abs() > FARTHEST)
    };
    let is_askew = |lamp: &PlacedLamp| {
        let axes = lamp.towards.to_array();
        axes.iter().filter(|axis| axis.unsigned_abs() == 1).count() != 1
            || axes.iter().filter(|axis| **axis == 0).count() != 2
    };
    if let Some(lamp) = lamps.iter().find(|lamp| is_far(lamp) || is_askew(lamp)) {
        let (voxel, towards) = (lamp.voxel, lamp.towards);
        return Some(format!("no lamp can be at {voxel} and point to {towards}"));
    }
    if let Some(fault) = lamps.iter().find_map(|lamp| lamp.block.fault()) {
        return Some(fault);
    }
    let mut places: Vec<[i32; 3]> = lamps.iter().map(|lamp| lamp.voxel.to_array()).collect();
    places.sort_unstable();
    places
        .windows(2)
        .any(|pair| pair[0] == pair[1])
        .then(|| "two lamps are in one voxel".to_owned())
}

/// The lamp in a voxel (world space).
pub fn at(lamps: &[PlacedLamp], voxel: IVec3) -> Option<&PlacedLamp> {
    lamps.iter().find(|lamp| lamp.voxel == voxel)
}

/// Places, changes or removes the lamp of a voxel (world space). A new one comes last: the others keep their order.
pub fn put(lamps: &mut Vec<PlacedLamp>, voxel: IVec3, lamp: Option<PlacedLamp>) {
    let known = lamps.iter().position(|known| known.voxel == voxel);
    match (known, lamp) {
        (Some(index), Some(lamp)) => lamps[index] = lamp,
        (Some(index), None) => drop(lamps.remove(index)),
        (None, Some(lamp)) => lamps.push(lamp),
        (None, None) => {}
    }
}
