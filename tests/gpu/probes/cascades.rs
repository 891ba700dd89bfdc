//! How the levels of a volume share the lighting of a point.

use glam::{IVec2, UVec3, Vec3};
use grotto::{
    gpu::Recorder,
    parameters::ProbeParameters,
    passes::probes::{classify::ProbeClassify, seed::ProbeSeed},
    probes::{Layout as _, Volume, sampling},
    world::LayoutSpec,
};

use super::{Rig, SEED};

const RADIANCE: [f32; 3] = [1.0, 4.0, 16.0];

fn nested(follow: bool) -> Volume {
    Volume::new(&LayoutSpec {
        name: "nested".into(),
        counts: UVec3::new(6, 5, 7),
        spacing: Vec3::new(3.0, 4.0, 3.0),
        centre: Vec3::new(0.5, 1.5, 0.0),
        follow,
        cascades: 3,
        octree: None,
    })
    .expect("a good layout")
}

fn points(around: Vec3) -> Vec<(Vec3, Vec3)> {
    (0..400)
        .map(|i| {
            let direction = sampling::rotation(9, i).xyz().as_vec3();
            let normal = direction.normalize();
            (around + direction * 45.0, normal)
        })
        .collect()
}

/// The probes of each level see a light of their own, so the light at a point tells which levels gave it.
#[test]
fn levels_share_a_point_as_the_cpu_says() {
    for eyes in [&[][..], &[Vec3::new(31.0, -8.0, 100.0)]] {
        let parameters = ProbeParameters {
            // Points are gathered where they are.
            normal_bias: 0.0,
            ..Default::default()
        };
        let mut volume = nested(!eyes.is_empty());
        let mut rig = Rig::new(volume.clone(), parameters);
        for eye in eyes {
            volume.follow(*eye);
            rig.field.follow(*eye, 0);
        }
        let around = eyes.first().copied().unwrap_or_default();
        let level_slots = volume.level_slots();
        let light = |slot: u32| RADIANCE[(slot / level_slots) as usize];
        rig.update(|slot, _| [light(slot), light(slot), light(slot), 1000.0]);
        let points = points(around);
        let mut mixed = 0;
        for ((point, _), found) in points.iter().zip(rig.gather(&points)) {
            let cage = volume.cage(*point);
            let expected: f32 = cage.iter().map(|(slot, w)| light(*slot) * w).sum();
            mixed += u32::from(
                RADIANCE
                    .iter()
                    .all(|one| (one - expected).abs() > 0.01 * one),
            );
            let off = (found[0] - expected).abs();
            assert!(off < 0.01 * expected, "{point}: {} of {expected}", found[0]);
        }
        assert!(mixed > 3, "some points lie where levels fade: {mixed}");
    }
}

#[test]
fn the_next_level_gives_what_a_hidden_cage_does_not() {
    let volume = nested(false);
    let level_slots = volume.level_slots();
    let mut rig = Rig::new(volume, ProbeParameters::default());
    let middle = [(Vec3::new(0.5, 1.5, 0.0), Vec3::Y)];
    // The finest level lies in solid voxels.
    rig.update(|slot, _| match slot / level_slots {
        0 => [7.0, 7.0, 7.0, -1.0],
        1 => [2.0, 2.0, 2.0, 1000.0],
        _ => [3.0, 3.0, 3.0, 1000.0],
    });
    let found = rig.gather(&middle)[0];
    assert!((found[0] - 2.0).abs() < 0.01, "{found:?}");
    // All levels do: there is no light left.
    rig.update(|_, _| [7.0, 7.0, 7.0, -1.0]);
    assert_eq!(rig.gather(&middle)[0], [0.0; 4]);
}

/// A new probe shows the light of the coarser level until its first update; a new probe of the coarsest
/// level shows none. Probes that stay keep their light.
#[test]
fn new_probes_show_the_light_of_the_coarser_level() {
    let volume = nested(true);
    let mut rig = Rig::new(volume, ProbeParameters::default());
    let level_slots = rig.field.volume().level_slots();
    rig.field.follow(Vec3::ZERO, 0);
    rig.field.set_placed();
    let light = |slot: u32| RADIANCE[(slot / level_slots) as usize];
    rig.update(|slot, _| [light(slot), light(slot), light(slot), 1000.0]);
    let before = rig.field.volume().clone();
    // One cell of the coarsest level.
    rig.field.follow(Vec3::new(0.0, 16.0, 0.0), 1);
    let voxels = rig.voxels.resources();
    let states = ProbeClassify::new(&rig.gpu, &rig.field, &voxels).expect("compiles");
    let seed = ProbeSeed::new(&rig.gpu, &rig.field, &voxels).expect("compiles");
    rig.field
        .begin_frame(&rig.gpu, &rig.parameters, SEED, rig.frame);
    let mut recorder = Recorder::new(&rig.gpu, None);
    states.record(&mut recorder);
    seed.record(&mut recorder);
    recorder.submit(&rig.gpu).expect("submits");
    let volume = rig.field.volume().clone();
    let updates = rig.field.updates(&rig.gpu).expect("reads back");
    let texels = rig.parameters.irradiance_texels as i32;
    let (mut counts, mut seeded) = ([0; 3], [0; 3]);
    for slot in 0..volume.slots() {
        let level = slot / level_slots;
        let stays = before
            .level_of(slot)
            .contains(volume.level_of(slot).point(slot));
        // Weight of the probes in the coarser cage around it that have been updated.
        let known = volume
            .levels()
            .get(level as usize + 1)
            .map_or(0.0, |coarser| {
                let corners = coarser.cage(volume.position(slot)).into_iter();
                let known = corners.filter(|(source, _)| {
                    let point = coarser.point(*source);
                    before.level_of(*source).contains(point)
                });
                known.map(|(_, weight)| weight).sum()
            });
        let expected = match (stays, known) {
            (true, _) => light(slot),
            (false, 0.3..) => RADIANCE[level as usize + 1],
            (false, 0.0) => 0.0,
            // Few probes, and hardly any of them near the camera.
            (false, _) => continue,
        };
        counts[level as usize] += u32::from(!stays);
        seeded[level as usize] += u32::from(!stays && expected > 0.0);
        assert_eq!(updates[slot as usize], u32::from(stays), "slot {slot}");
        let map = rig.irradiance(slot);
        // Texels of the border too.
        for place in [
            IVec2::ZERO,
            IVec2::new(-1, 3),
            IVec2::splat(texels),
            IVec2::new(2, texels),
        ] {
            let [r, ..] = map(place);
            let off = (r as f32 - expected).abs();
            assert!(off <= 0.01 * expected, "slot {slot} at {place}: {r}");
        }
    }
    assert!(counts.iter().all(|count| *count > 20), "{counts:?}");
    assert_eq!(
        seeded.map(|count| count > 20),
        [true, true, false],
        "{seeded:?}"
    );
}
