//! Rays that are repeated after a change.

use glam::DVec3;
use grotto::{gpu::Gpu, parameters::ProbeParameters, probes::sampling};

use super::{Rig, history::specks, volume};
use crate::support::{Fault, gpu, with_faults};

/// Probes that find much of a change take new rays.
const ANEW: Fault = (
    "probes/repeated_rays.wesl",
    "const CHANGE_VARIANCE: f32 = 8.0;",
    "const CHANGE_VARIANCE: f32 = 1e4;",
);

fn mean(rig: &Rig) -> f64 {
    let all = rig.field.irradiance(&rig.gpu).expect("reads back");
    all.iter().map(|[r, ..]| f64::from(*r)).sum::<f64>() / all.len() as f64
}

/// A change that is a tenth of the noise of an update is followed in eight frames, by what the same rays find; without
/// repeated rays it would take a hundred. And light that does not change stays as it is, however noisy it is.
#[test]
fn small_changes_are_followed_by_rays_that_are_repeated() {
    let parameters = ProbeParameters {
        rays: 64,
        warmup_frames: 1,
        ..Default::default()
    };
    let rig_after = |share: f32, is_told: bool| {
        let mut rig = Rig::new(volume([4, 4, 4], 4.0), parameters.clone());
        for _ in 0..100 {
            rig.update(specks);
        }
        let before = mean(&rig);
        for frame in 0..8 {
            if is_told {
                let change = if frame == 0 { 1.0 } else { 0.0 };
                rig.field.changes.begin_frame(change, rig.frame as u32);
            }
            // The half of all directions that looks up is brighter.
            rig.update(|slot, d| {
                let factor = if d.y > 0.0 { 1.0 + share } else { 1.0 };
                specks(slot, d).map(|value| value * factor)
            });
        }
        mean(&rig) / before - 1.0
    };
    let still = rig_after(0.0, true);
    assert!(still.abs() < 1e-3, "nothing has changed: {still}");
    let followed = rig_after(0.04, true);
    assert!((0.016..0.024).contains(&followed), "{followed}");
    let untold = rig_after(0.04, false);
    assert!(
        !(0.016..0.024).contains(&untold),
        "{untold}: the check cannot fail"
    );
}

/// A change that comes from bright places which most probes hit with no ray is followed without bias: what some probes find too
/// much, the others find too little.
#[test]
fn rare_bright_rays_are_not_forgotten() {
    const BRIGHT: f32 = 150.0;
    /// Share of all directions.
    const SHARE: f64 = 0.005;
    let spot = |slot: u32, direction: DVec3| {
        let middle = sampling::fibonacci(slot, 512);
        if direction.dot(middle) > 1.0 - 2.0 * SHARE {
            1.0 + BRIGHT
        } else {
            1.0
        }
    };
    let grown = |gpu: &Gpu| {
        let parameters = ProbeParameters {
            rays: 64,
            warmup_frames: 1,
            ..Default::default()
        };
        let mut rig = Rig::on(gpu, volume([8, 8, 8], 4.0), parameters);
        for _ in 0..60 {
            rig.update(|_, _| [1.0; 4]);
        }
        for frame in 0..8 {
            let change = if frame == 0 { 1.0 } else { 0.0 };
            rig.field.changes.begin_frame(change, rig.frame as u32);
            rig.update(|slot, direction| [spot(slot, direction); 4]);
        }
        mean(&rig) - 1.0
    };
    let expected = f64::from(BRIGHT) * SHARE;
    let followed = grown(&gpu()) / expected;
    let biased = grown(&with_faults(&gpu(), &[ANEW])) / expected;
    println!(
        "{followed:.3} of the change, {biased:.3} where probes that find much of it take new rays"
    );
    assert!((followed - 1.0).abs() < 0.12, "{followed}");
    assert!(biased < 0.6, "{biased}");
}
