//! The light of probes with exact visibility, at the faces of two rooms with a thin wall between them.

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    gpu::Recorder,
    parameters::{ProbeParameters, Relocation},
    passes::probes::{classify::ProbeClassify, visibility::ProbeVisibility},
    probes::{Volume, sampling},
    world::{LayoutSpec, voxels::Voxels},
};

use crate::support::scenes::{lattice, volume_of};

use super::{
    Rig,
    visibility_bits::{ORIGIN, exact, nested, rooms, volume},
};

/// Points of the faces that bound a room, with their normals: on a line across voxels and cages.
fn line_on(face: u8, step: f32, count: u32) -> Vec<(Vec3, Vec3)> {
    let origin = ORIGIN.as_vec3();
    (0..count)
        .map(|i| {
            let along = step * i as f32;
            match face {
                // The floor of the first room, behind the column.
                0 => (Vec3::new(5.3 + along, 4.0, 14.2 + 0.7 * along), Vec3::Y),
                // Both sides of the wall between the rooms.
                1 => (Vec3::new(15.0, 6.1 + along, 5.4 + along), Vec3::NEG_X),
                2 => (Vec3::new(16.0, 6.1 + along, 5.4 + along), Vec3::X),
                // Past the column of the second room.
                _ => (Vec3::new(17.3 + along, 4.0, 12.2 + 0.7 * along), Vec3::Y),
            }
        })
        .map(|(point, normal)| (origin + point, normal))
        .collect()
}

/// In the first of the two [`rooms`], near the wall between them.
const EYE: Vec3 = Vec3::new(-3.0, -2.0, 0.5);

/// `rays`: the radiance that a probe's rays find, by its slot and place.
fn lit(volume: Volume, rays: impl Fn(u32, Vec3) -> [f32; 3]) -> Rig {
    let rig = Rig::seeing(volume, exact(), &rooms(), ORIGIN);
    lit_around(rig, EYE, rays)
}

fn lit_around(mut rig: Rig, eye: Vec3, rays: impl Fn(u32, Vec3) -> [f32; 3]) -> Rig {
    rig.field.follow(eye, 0);
    let voxels = rig.voxels.resources();
    let states = ProbeClassify::new(&rig.gpu, &rig.field, &voxels).expect("compiles");
    let visibility_bits = ProbeVisibility::new(&rig.gpu, &rig.field, &voxels).expect("compiles");
    rig.field.begin_frame(&rig.gpu, &rig.parameters, 1, 0);
    let mut recorder = Recorder::new(&rig.gpu, None);
    states.record(&mut recorder);
    visibility_bits.record(&mut recorder);
    recorder.submit(&rig.gpu).expect("submits");
    let places: Vec<[f32; 4]> = rig.gpu.read_buffer(rig.field.places()).expect("reads back");
    rig.update(|slot, _| {
        let [x, y, z, alive] = places[slot as usize];
        let [r, g, b] = rays(slot, Vec3::new(x, y, z));
        let alive = alive != 0.0;
        [r, g, b, if alive { 50.0 } else { -1.0 }]
    });
    rig
}

#[test]
fn a_constant_is_gathered_as_the_constant_wherever_a_probe_is_seen() {
    for volume in [volume(), nested(3), nested(2)] {
        gathers_the_constant(&lit(volume, |_, _| [0.25, 1.0, 4.0]));
    }
}

fn gathers_the_constant(rig: &Rig) {
    for face in 0..3 {
        for gathered in rig.gather(&line_on(face, 0.23, 30)) {
            for (found, expected) in gathered.iter().zip([0.25, 1.0, 4.0]) {
                assert!(
                    (found / expected - 1.0).abs() < 2e-3,
                    "face {face}: {gathered:?}"
                );
            }
        }
    }
}

/// Each probe has another light (red); green for probes in the second room, blue for those in the first.
fn lit_by_rooms(volume: Volume) -> Rig {
    lit(volume, |slot, place| {
        let random = sampling::rotation(3, u64::from(slot)).xyz().as_vec3();
        let wall = ORIGIN.x as f32 + 15.5;
        [
            1.0 + random.x,
            f32::from(place.x > wall),
            f32::from(place.x < wall),
        ]
    })
}

#[test]
fn light_is_continuous_over_a_surface_and_from_level_to_level() {
    const STEP: f32 = 1e-3;
    for rig in [volume(), nested(3)].map(lit_by_rooms) {
        for face in 0..4 {
            for pair in rig.gather(&line_on(face, STEP, 9600)).windows(2) {
                assert!(
                    (pair[0][0] - pair[1][0]).abs() < 0.05,
                    "face {face}: a step: {pair:?}"
                );
            }
        }
    }
}

/// Probes in one room light nothing in the other, however thin the wall is. This holds beyond the last level too,
/// which ends inside the rooms for two of these volumes.
#[test]
fn light_stays_on_its_side_of_a_wall() {
    let mut lit_points = [0; 3];
    for (rig, lit_points) in [volume(), nested(3), nested(2)]
        .map(lit_by_rooms)
        .iter()
        .zip(&mut lit_points)
    {
        for (face, foreign) in [(1, 1), (2, 2)] {
            for gathered in rig.gather(&line_on(face, 0.4, 40)) {
                assert_eq!(gathered[foreign], 0.0, "through the wall: {gathered:?}");
                *lit_points += u32::from(gathered[0] > 0.0);
            }
        }
    }
    assert!(lit_points.iter().all(|count| *count > 60), "{lit_points:?}");
}

/// Of eight probes, 50 voxels apart, one is in the first room. Its bits end 20 voxels away; the wall goes on, and is lit
/// there too. The second room has no probe, and is dark.
#[test]
fn one_probe_of_large_cages_lights_all_of_its_room_and_nothing_else() {
    const SPACING: f32 = 50.0;
    let probe = ORIGIN.as_vec3() + Vec3::new(12.5, 4.5, 4.5);
    let spec = lattice(UVec3::splat(2), Vec3::splat(SPACING), probe + 0.5 * SPACING);
    let rig = lit(volume_of(&spec), |_, _| [0.25, 1.0, 4.0]);
    let of_wall = line_on(1, 0.5, 42);
    let far = of_wall[41].0 - probe;
    assert!(far.z > 21.0, "beyond the bits: {far}");
    for gathered in rig.gather(&of_wall) {
        assert!((gathered[1] - 1.0).abs() < 2e-3, "{gathered:?}");
    }
    for gathered in rig.gather(&line_on(2, 0.5, 42)) {
        assert_eq!(gathered[..3], [0.0; 3], "through the wall");
    }
}

/// A pit between the probes of the finest level, too narrow for them to see its floor. The next level lights the floor;
/// up the wall of the pit the finest level takes over without a step.
#[test]
fn the_next_level_gives_by_degrees_what_a_hidden_cage_does_not() {
    let mut voxels = Voxels::empty(UVec3::splat(32));
    let mut fill = |low: [i32; 3], high: [i32; 3], material| {
        voxels.fill_box(
            IVec3::from(low) - ORIGIN,
            IVec3::from(high) - ORIGIN,
            material,
        );
    };
    fill([-16, -16, -16], [15, 0, 15], 1);
    fill([4, 1, 4], [8, 3, 8], 1);
    fill([5, 1, 5], [7, 3, 7], 0);
    let volume = Volume::new(&LayoutSpec {
        name: "over a pit".into(),
        counts: UVec3::new(6, 5, 7),
        spacing: Vec3::splat(4.0),
        centre: Vec3::ZERO,
        follow: true,
        cascades: 2,
        octree: None,
    })
    .expect("a good layout");
    let slots = volume.level_slots();
    let parameters = ProbeParameters {
        relocation: Relocation::Off,
        ..exact()
    };
    let rig = Rig::seeing(volume, parameters, &voxels, ORIGIN);
    let rig = lit_around(rig, Vec3::new(6.0, 4.0, 6.0), |slot, _| {
        [if slot < slots { 2.0 } else { 4.0 }; 3]
    });
    let floor = rig.gather(&[(Vec3::new(6.5, 1.0, 6.5), Vec3::Y)])[0][0];
    assert!((floor - 4.0).abs() < 0.01, "{floor}");
    let wall = (0..3000).map(|i| (Vec3::new(5.0, 1.0 + 1e-3 * i as f32, 6.5), Vec3::X));
    let light: Vec<f32> = rig
        .gather(&wall.collect::<Vec<_>>())
        .iter()
        .map(|l| l[0])
        .collect();
    assert!(
        (light[0] - 4.0).abs() < 0.01 && light[2999] < 2.5,
        "{} {}",
        light[0],
        light[2999]
    );
    for pair in light.windows(2) {
        assert!((pair[0] - pair[1]).abs() < 0.02, "a step: {pair:?}");
    }
}
