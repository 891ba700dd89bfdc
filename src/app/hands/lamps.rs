//! Strokes that place, dig and switch lamps.

use std::collections::HashSet;

use glam::IVec3;

use super::aim::Target;
use crate::{
    reference::march::FACE_NORMALS,
    world::{
        PlacedLamp, World,
        placed::{self, LampBlock, MOST_PLACED},
        voxels::Voxels,
    },
};

/// The lamp of a voxel before and after a stroke; `None` where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampChange {
    /// World space.
    pub voxel: IVec3,
    pub before: Option<PlacedLamp>,
    pub after: Option<PlacedLamp>,
}

/// The lamp that a stroke meets.
pub fn met<'a>(world: &'a World, target: &Target) -> Option<&'a PlacedLamp> {
    placed::at(&world.restored.lamps, target.voxel + world.origin)
}

/// The lamp goes.
pub fn dug(lamp: &PlacedLamp) -> LampChange {
    LampChange {
        voxel: lamp.voxel,
        before: Some(*lamp),
        after: None,
    }
}

/// The lamp goes on, or off.
pub fn switched(lamp: &PlacedLamp) -> LampChange {
    LampChange {
        voxel: lamp.voxel,
        before: Some(*lamp),
        after: Some(PlacedLamp {
            is_on: !lamp.is_on,
            ..*lamp
        }),
    }
}

/// A lamp in front of the face aimed at. A spot shines away from the face.
///
/// # Errors
/// Why it cannot be there, for a person.
pub fn hung(
    block: LampBlock,
    voxels: &Voxels,
    world: &World,
    target: &Target,
    eye: IVec3,
) -> Result<LampChange, String> {
    let Some((before, face)) = target.before().zip(target.face) else {
        return Err("There is no room for a lamp inside of a voxel".to_owned());
    };
    let lamp = PlacedLamp {
        voxel: before + world.origin,
        block,
        towards: FACE_NORMALS[usize::from(face)],
        is_on: true,
    };
    let lamps = &world.restored.lamps;
    if !lamp.is_within(world.origin, world.size) {
        return Err("Nothing can be placed outside of the world".to_owned());
    }
    if voxels.material(before) != 0 || placed::at(lamps, lamp.voxel).is_some() {
        return Err("Something is in the place of the lamp already".to_owned());
    }
    if lamp.voxel == eye {
        return Err("A lamp cannot be where your eyes are: step back".to_owned());
    }
    if lamps.len() == MOST_PLACED {
        return Err(format!("A world holds no more than {MOST_PLACED} lamps"));
    }
    Ok(LampChange {
        voxel: lamp.voxel,
        before: None,
        after: Some(lamp),
    })
}

/// The voxels of all lamps (grid space): they stay air.
pub fn occupied(world: &World) -> HashSet<IVec3> {
    let lamps = world.restored.lamps.iter();
    lamps.map(|lamp| lamp.voxel - world.origin).collect()
}
