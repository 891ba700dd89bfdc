//! The light of probes that know what they see, at the faces of two rooms with a thin wall between them.

use glam::Vec3;
use grotto::{
    gpu::Recorder,
    passes::{probe_sight::ProbeSight, probe_states::ProbeStates},
    probes::{Layout as _, Volume, sampling},
};

use crate::{
    Rig,
    sight::{ORIGIN, exact, nested, rooms, volume},
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
                _ => (Vec3::new(16.0, 6.1 + along, 5.4 + along), Vec3::X),
            }
        })
        .map(|(point, normal)| (origin + point, normal))
        .collect()
}

/// Between the rooms of [`rooms`], in the first.
const EYE: Vec3 = Vec3::new(-3.0, -2.0, 0.5);

fn lit(volume: Volume, rays: impl Fn(u32) -> [f32; 3]) -> Rig {
    let mut rig = Rig::seeing(volume, exact(), &rooms(), ORIGIN);
    rig.field.follow(EYE, 0);
    let voxels = rig.voxels.resources();
    let states = ProbeStates::new(&rig.gpu, &rig.field, &voxels).expect("compiles");
    let sight = ProbeSight::new(&rig.gpu, &rig.field, &voxels).expect("compiles");
    rig.field.begin_frame(&rig.gpu, &rig.parameters, 1, 0);
    let mut recorder = Recorder::new(&rig.gpu, None);
    states.record(&mut recorder);
    sight.record(&mut recorder);
    recorder.submit(&rig.gpu).expect("submits");
    let places: Vec<[f32; 4]> = rig.gpu.read_buffer(rig.field.places()).expect("reads back");
    rig.update(|slot, _| {
        let [r, g, b] = rays(slot);
        let alive = places[slot as usize][3] != 0.0;
        [r, g, b, if alive { 50.0 } else { -1.0 }]
    });
    rig
}

#[test]
fn a_constant_is_gathered_as_the_constant_wherever_a_probe_is_seen() {
    for volume in [volume(), nested(3), nested(2)] {
        gathers_the_constant(&lit(volume, |_| [0.25, 1.0, 4.0]));
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

/// Each probe another light (red); green where it stands well inside the second room, blue in the first.
fn lit_by_rooms(volume: Volume) -> Rig {
    let mut moved = volume.clone();
    moved.follow(EYE);
    let slots = moved.slots();
    lit(volume, |slot| {
        let random = sampling::rotation(3, u64::from(slot)).xyz().as_vec3();
        let x = moved.position(slot % slots).x;
        [1.0 + random.x, f32::from(x > 12.0), f32::from(x < -6.0)]
    })
}

#[test]
fn light_is_continuous_over_a_surface_and_from_level_to_level() {
    const STEP: f32 = 1e-3;
    for rig in [volume(), nested(3)].map(lit_by_rooms) {
        for (face, start) in (0..3).flat_map(|face| (0..24).map(move |start| (face, start))) {
            let mut line = line_on(face, 0.4, 24);
            let (point, normal) = line.swap_remove(start);
            let across = if normal.y > 0.5 {
                Vec3::new(1.0, 0.0, 0.7)
            } else {
                Vec3::new(0.0, 1.0, 1.0)
            };
            let points: Vec<_> = (0..60)
                .map(|i| (point + across * STEP * i as f32, normal))
                .collect();
            for pair in rig.gather(&points).windows(2) {
                assert!(
                    (pair[0][0] - pair[1][0]).abs() < 0.05,
                    "face {face}: a step at {point}: {pair:?}"
                );
            }
        }
    }
}

/// Probes that stand far inside one room light nothing in the other, thin as the wall may be, nor beyond the
/// last level: two of them end inside the rooms.
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
