//! Strokes that place, dig and switch lamps.

use std::collections::HashSet;

use glam::IVec3;

use super::aim::Target;
use crate::{
    app::texts::lamps as texts,
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
        return Err(texts::INSIDE.to_owned());
    };
    let lamp = PlacedLamp {
        voxel: before + world.origin,
        block,
        towards: FACE_NORMALS[usize::from(face)],
        is_on: true,
    };
    let lamps = &world.restored.lamps;
    if !lamp.is_within(world.origin, world.size) {
        return Err(texts::OUTSIDE.to_owned());
    }
    if voxels.material(before) != 0 || placed::at(lamps, lamp.voxel).is_some() {
        return Err(texts::TAKEN.to_owned());
    }
    if lamp.voxel == eye {
        return Err(texts::EYES.to_owned());
    }
    if lamps.len() == MOST_PLACED {
        return Err(texts::too_many(MOST_PLACED));
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::UVec3;

    use super::*;
    use crate::world::{file, placed::tests::lamp};

    /// A world of 16³ voxels, all of them air above a floor.
    fn scene() -> (World, Voxels) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let mut world = file::load(&path, &file::Overrides::default()).expect("it loads");
        world.size = UVec3::splat(16);
        world.origin = IVec3::new(-8, 3, -8);
        let mut voxels = Voxels::empty(world.size);
        voxels.fill_box(IVec3::ZERO, IVec3::new(15, 0, 15), 1);
        (world, voxels)
    }

    const FLOOR: Target = Target {
        voxel: IVec3::new(5, 0, 6),
        face: Some(3),
        material: 1,
    };
    const FAR: IVec3 = IVec3::splat(99);

    fn put(world: &mut World, change: LampChange) {
        placed::put(&mut world.restored.lamps, change.voxel, change.after);
    }

    #[test]
    fn a_lamp_hangs_before_the_face_and_is_met_switched_and_dug_there() {
        let (mut world, voxels) = scene();
        let block = LampBlock::default();
        let hung = hung(block, &voxels, &world, &FLOOR, FAR).expect("there is room");
        assert_eq!(hung.voxel, IVec3::new(-3, 4, -2));
        put(&mut world, hung);
        let target = Target {
            voxel: IVec3::new(5, 1, 6),
            face: Some(3),
            material: 0,
        };
        assert_eq!(met(&world, &FLOOR), None);
        let lamp = *met(&world, &target).expect("it is there");
        assert_eq!(
            (lamp.block, lamp.towards, lamp.is_on),
            (block, IVec3::Y, true)
        );
        assert!(occupied(&world).contains(&target.voxel));
        put(&mut world, switched(&lamp));
        let dark = *met(&world, &target).expect("it is there");
        assert!(!dark.is_on);
        put(&mut world, switched(&dark));
        assert_eq!(met(&world, &target), Some(&lamp));
        put(&mut world, dug(&lamp));
        assert_eq!(met(&world, &target), None);
    }

    #[test]
    fn where_a_lamp_cannot_be_it_is_refused_with_a_reason() {
        let (mut world, mut voxels) = scene();
        let refused = |voxels: &Voxels, world: &World, target: &Target, eye: IVec3| {
            let hung = hung(LampBlock::default(), voxels, world, target, eye);
            hung.expect_err("it is refused")
        };
        let edge = Target {
            voxel: IVec3::new(0, 0, 6),
            face: Some(0),
            material: 1,
        };
        assert!(refused(&voxels, &world, &edge, FAR).contains("outside of the world"));
        let inside = Target {
            face: None,
            ..FLOOR
        };
        assert!(refused(&voxels, &world, &inside, FAR).contains("no room"));
        let eye = IVec3::new(-3, 4, -2);
        assert!(refused(&voxels, &world, &FLOOR, eye).contains("eyes"));
        world.restored.lamps = vec![lamp(eye)];
        assert!(refused(&voxels, &world, &FLOOR, FAR).contains("already"));
        world.restored.lamps = (0..MOST_PLACED as i32)
            .map(|x| lamp(IVec3::X * x))
            .collect();
        assert!(refused(&voxels, &world, &FLOOR, FAR).contains("no more than 4096"));
        voxels.set(IVec3::new(5, 1, 6), 1);
        assert!(refused(&voxels, &world, &FLOOR, FAR).contains("already"));
    }
}
