//! What a surface gathers from the probes around it.

use glam::{DVec3, IVec2, Vec3};
use grotto::{
    parameters::{Method, ProbeParameters, SourceWeights},
    probes::sampling,
};

use super::{Rig, volume};

#[test]
fn gathering_a_constant_gives_the_constant_whatever_the_normal() {
    let mut rig = Rig::new(volume([3, 3, 3], 4.0), ProbeParameters::default());
    rig.update(|_, _| [0.25, 1.0, 4.0, 100.0]);
    let places: Vec<(Vec3, Vec3)> = sampling::directions(64, 5, 1)
        .enumerate()
        .map(|(i, d)| {
            let normal = if i < 6 {
                Vec3::AXES[i % 3] * if i < 3 { 1.0 } else { -1.0 }
            } else {
                d.as_vec3()
            };
            (
                sampling::rotation(9, i as u64).xyz().as_vec3() * 9.0,
                normal,
            )
        })
        .collect();
    for (gathered, (point, normal)) in rig.gather(&places).iter().zip(&places) {
        for (found, expected) in gathered.iter().zip([0.25, 1.0, 4.0]) {
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "{gathered:?} at {point} facing {normal}"
            );
        }
    }
}

/// A probe behind a wall: it saw the wall at 2 voxels; the point lies 4 voxels behind that.
#[test]
fn chebyshev_hides_what_a_wall_separates() {
    // Two probes on x at −4 and 4 (voxel centres 0.5 beside); a wall in between, seen by the left
    // one alone, which is bright.
    let mut rig = Rig::new(volume([2, 1, 1], 8.0), ProbeParameters::default());
    let rays = |slot: u32, d: DVec3| {
        let wall = 2.0 / d.x.max(1e-6);
        match slot {
            0 => [100.0, 0.0, 0.0, wall.min(50.0) as f32],
            _ => [0.0, 1.0, 0.0, 50.0],
        }
    };
    rig.update(rays);
    let point = (Vec3::new(2.5, 0.5, 0.5), Vec3::Y);
    let seen = rig.gather(&[point])[0];
    assert!(seen[0] < 0.5, "leaks {seen:?}");
    assert!(seen[1] > 0.99, "loses what it sees: {seen:?}");
    let mut blind = ProbeParameters {
        method: Method::Source,
        ..Default::default()
    };
    blind.source.weights = SourceWeights::Direction;
    let mut rig = Rig::new(volume([2, 1, 1], 8.0), blind);
    rig.update(rays);
    let blind = rig.gather(&[point])[0];
    assert!(blind[0] > 5.0, "the test's own wall must matter: {blind:?}");
}

#[test]
fn probes_in_solid_voxels_give_nothing_and_cost_their_neighbours_nothing() {
    let mut rig = Rig::new(volume([2, 1, 1], 8.0), ProbeParameters::default());
    rig.update(|slot, _| match slot {
        0 => [7.0, 7.0, 7.0, -1.0],
        _ => [1.0, 2.0, 3.0, 100.0],
    });
    assert_eq!(rig.irradiance(0)(IVec2::ZERO), [0.0; 3]);
    let near_solid = (Vec3::new(-3.0, 0.5, 0.5), Vec3::Y);
    let gathered = rig.gather(&[near_solid])[0];
    assert!((gathered[0] - 1.0).abs() < 2e-3, "{gathered:?}");
    // A live probe that becomes solid forgets its light, and starts again when it is freed.
    rig.update(|_, _| [0.0, 0.0, 0.0, -1.0]);
    assert_eq!(rig.gather(&[near_solid])[0], [0.0; 4]);
    rig.update(|_, _| [5.0, 5.0, 5.0, 100.0]);
    let back = rig.gather(&[near_solid])[0];
    assert!((back[0] - 5.0).abs() < 0.01, "{back:?}");
}
