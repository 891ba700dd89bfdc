//! `worlds/cave.ron` matches the cave that it is modelled on, to the block where numbers are known.

use std::sync::LazyLock;

use glam::IVec3;
use grotto::lights::Lights;
use grotto::world::voxels::Voxels;
use grotto::world::{World, generate};

use crate::support::shipped;

struct Cave {
    world: World,
    voxels: Voxels,
}

static CAVE: LazyLock<Cave> = LazyLock::new(|| {
    let world = shipped("cave");
    let voxels = generate::generate(&world);
    Cave { world, voxels }
});

impl Cave {
    /// Material of a world-space voxel; 0 is air.
    fn at(&self, voxel: IVec3) -> u8 {
        self.voxels.material(voxel - self.world.origin)
    }

    fn material_name(&self, voxel: IVec3) -> &str {
        match self.at(voxel) {
            0 => "air",
            material => &self.world.materials[usize::from(material) - 1].name,
        }
    }

    /// World-space voxels of the cave's box, below the top of the rock.
    fn voxels_below_ground(&self) -> impl Iterator<Item = IVec3> {
        let (low, high) = (
            self.world.origin,
            self.world.origin + self.world.size.as_ivec3(),
        );
        (low.z..high.z).flat_map(move |z| {
            (low.y..17).flat_map(move |y| (low.x..high.x).map(move |x| IVec3::new(x, y, z)))
        })
    }
}

/// Voxel v here is block v + 1 of the original, where block n fills (n − 1, n].
fn block(x: i32, y: i32, z: i32) -> IVec3 {
    IVec3::new(x, y, z) - 1
}

#[test]
fn skylights_have_their_columns() {
    let top = CAVE.voxels_below_ground().filter(|voxel| voxel.y == 16);
    let open: Vec<IVec3> = top.filter(|voxel| CAVE.at(*voxel) == 0).collect();
    // One lies around the origin, the other around (13, −19): a plane between them separates them.
    let first = open
        .iter()
        .filter(|voxel| voxel.x - 2 * voxel.z < 26)
        .count();
    assert_eq!((first, open.len() - first), (349, 221));
}

#[test]
fn air_spans_what_it_should() {
    let air = |voxel: &IVec3| CAVE.at(*voxel) == 0;
    let (low, high) = CAVE
        .voxels_below_ground()
        .filter(air)
        .fold((IVec3::MAX, IVec3::MIN), |(low, high), voxel| {
            (low.min(voxel), high.max(voxel))
        });
    assert_eq!(low, block(-41, -19, -37));
    assert_eq!(high, block(31, 17, 30));
}

/// Both counts are those of the cave with its floor and its mushrooms: the faces between air
/// and anything solid below the top of the rock. The floor's noise differs from the
/// original's, hence the tolerance.
#[test]
fn air_and_exposed_faces_are_as_many_as_in_the_original() {
    let (mut air, mut faces) = (0u32, 0u32);
    for voxel in CAVE.voxels_below_ground() {
        if CAVE.at(voxel) != 0 {
            continue;
        }
        air += 1;
        for axis in [IVec3::X, IVec3::Y, IVec3::Z] {
            for beside in [voxel - axis, voxel + axis] {
                faces += u32::from(beside.y < 17 && CAVE.at(beside) != 0);
            }
        }
    }
    let near = |found: u32, expected: u32| found.abs_diff(expected) * 50 <= expected;
    assert!(near(air, 85_234), "{air} air voxels");
    assert!(near(faces, 19_366), "{faces} exposed faces");
}

#[test]
fn mushrooms_stand_where_they_should() {
    let is = |voxel: IVec3, name: &str| assert_eq!(CAVE.material_name(voxel), name, "{voxel}");
    for (x, y, z) in [
        (-19, -12, 22),
        (-18, -12, 2),
        (-4, -14, 12),
        (-32, -14, -20),
        (-30, -12, -12),
        (-14, -15, -10),
        (-2, -12, -2),
        (6, -14, -3),
        (20, -7, -16),
    ] {
        is(block(x, y, z), "amber cap");
        is(block(x + 1, y, z - 1), "amber cap");
        is(block(x, y - 1, z), "stem");
    }
    for (x, y, z) in [(-10, -8, 18), (-25, -7, -4), (-5, -9, -14)] {
        is(block(x, y + 1, z), "red cap");
        is(block(x + 2, y, z + 1), "orange cap");
        is(block(x, y - 1, z), "amber cap");
        is(block(x, y - 2, z), "stem");
        is(block(x + 2, y, z + 2), "air");
    }
    for (x, y, z) in [(-27, -4, 16), (-4, -1, 6), (-20, -3, -20), (6, -6, -10)] {
        is(block(x + 3, y, z - 2), "red cap");
        is(block(x + 3, y, z - 3), "air");
        is(block(x - 2, y + 1, z + 2), "red cap");
        is(block(x, y - 3, z), "stem");
        is(block(x + 1, y - 8, z), "stem");
    }
    for (x, y, z, lean) in [(-22, 3, 8, -1), (-8, 8, -6, 1), (14, 10, -20, -1)] {
        is(block(x, y + 2, z), "orange cap");
        is(block(x + 4, y - 1, z - 4), "orange cap");
        is(block(x, y - 5, z), "stem");
        is(block(x, y - 12, z + lean), "stem");
    }
}

/// Light enters and leaves through the skylights alone.
#[test]
fn rock_closes_the_cave_all_around() {
    let (low, high) = (
        CAVE.world.origin,
        CAVE.world.origin + CAVE.world.size.as_ivec3() - 1,
    );
    let on_the_border = |voxel: &IVec3| {
        voxel.x == low.x
            || voxel.x == high.x
            || voxel.y == low.y
            || voxel.z == low.z
            || voxel.z == high.z
    };
    for voxel in CAVE.voxels_below_ground().filter(on_the_border) {
        assert_ne!(CAVE.at(voxel), 0, "{voxel}");
    }
    for x in low.x..=high.x {
        for z in low.z..=high.z {
            assert_eq!(CAVE.at(IVec3::new(x, 17, z)), 0);
        }
    }
}

#[test]
fn lamps_never_enter_the_rock() {
    for preset in &CAVE.world.lamp_presets {
        for tenth in 0..600 {
            let lights = Lights::at(&CAVE.world, preset, f64::from(tenth) / 10.0);
            for (lamp, now) in preset.lamps.iter().zip(&lights.lamps) {
                let voxel = now.position_ws.floor().as_ivec3();
                let inside = CAVE.at(voxel) != 0;
                assert!(
                    !inside,
                    "{} of `{}` is at {voxel} after {tenth}/10 s",
                    lamp.name, preset.name
                );
            }
        }
    }
}

#[test]
fn presets_and_layouts_are_all_there() {
    let presets = CAVE
        .world
        .lamp_presets
        .iter()
        .map(|preset| (preset.name.as_str(), preset.lamps.len()));
    assert_eq!(
        presets.collect::<Vec<_>>(),
        [("one", 1), ("four", 4), ("eight", 8)]
    );
    for (name, probes) in [
        ("layout1", 175),
        ("layout2", 567),
        ("layout3", 1089),
        ("layout4", 3375),
    ] {
        let mut layouts = CAVE.world.layouts.iter();
        let layout = layouts
            .find(|layout| layout.name == name)
            .expect("the layout exists");
        assert_eq!(layout.counts.element_product(), probes);
    }
}
