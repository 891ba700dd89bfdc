//! When the feet of a body meet the ground: for the ear.

use glam::{DVec2, DVec3, IVec3};

use super::super::body::{Body, Mode, Terrain};

/// A stride at rest, and what each metre per second adds (metres): 1.6 m at a walk of 4 m/s, 2.2 m at a run of 6.
const STRIDE_M: f64 = 0.55;
const STRIDE_S: f64 = 0.27;
/// Slower than this (m/s) nobody walks.
const STANDING: f64 = 0.2;
/// Speeds of the softest and of the hardest steps and landings (m/s).
const STEPS: (f64, f64) = (1.0, 7.0);
const LANDINGS: (f64, f64) = (2.0, 16.0);
/// Whoever moves faster was put elsewhere (m/s).
const LEAP: f64 = 120.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    Step,
    Land,
}

/// A foot met the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footfall {
    pub contact: Contact,
    /// How hard, 0 to 1.
    pub strength: f32,
    /// The voxel that bears the body (world space).
    pub voxel: IVec3,
    /// Simulated time in nanoseconds.
    pub at_ns: u64,
}

/// Counts the way from one footfall to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gait {
    /// Since the last footfall (metres).
    walked_m: f64,
    was_borne: bool,
    /// Before the last step of the simulation: voxels, and voxels per second upwards.
    at: DVec3,
    rise: f64,
}

impl Gait {
    /// Looks at a body after a step of `dt_s` seconds that ended at `at_ns`.
    pub fn follow(
        &mut self,
        body: &Body,
        terrain: &impl Terrain,
        dt_s: f64,
        at_ns: u64,
    ) -> Option<Footfall> {
        let scale = body.measures.scale;
        let at = body.feet();
        let moved_m = DVec2::new(at.x - self.at.x, at.z - self.at.z).length() / scale;
        let speed = moved_m / dt_s;
        let fall = -self.rise / scale;
        let was_borne = std::mem::replace(&mut self.was_borne, false);
        self.at = at;
        self.rise = body.velocity().y;
        let ground = match body.mode {
            Mode::Walk => ground_below(body, terrain)?,
            Mode::Fly | Mode::NoClip => return None,
        };
        self.was_borne = true;
        let footfall = |contact, speed: f64, (soft, hard): (f64, f64)| Footfall {
            contact,
            strength: ((speed - soft) / (hard - soft)).clamp(0.0, 1.0) as f32,
            voxel: ground,
            at_ns,
        };
        if !was_borne {
            self.walked_m = 0.0;
            return (fall > LANDINGS.0).then(|| footfall(Contact::Land, fall, LANDINGS));
        }
        if !(STANDING..LEAP).contains(&speed) {
            // The first step from rest is half a stride.
            self.walked_m = 0.5 * STRIDE_M;
            return None;
        }
        self.walked_m += moved_m;
        if self.walked_m < STRIDE_M + STRIDE_S * speed {
            return None;
        }
        self.walked_m = 0.0;
        Some(footfall(Contact::Step, speed, STEPS))
    }
}

/// The voxel that bears a body: the one below its middle, or another below its base.
fn ground_below(body: &Body, terrain: &impl Terrain) -> Option<IVec3> {
    if !body.shape().is_supported(terrain) {
        return None;
    }
    let (low, high) = body.shape().voxels();
    let y = low.y - 1;
    let middle = body.feet().floor().as_ivec3().with_y(y);
    let others = (low.z..=high.z).flat_map(|z| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)));
    std::iter::once(middle)
        .chain(others)
        .find(|voxel| terrain.is_solid(*voxel))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::body::{Intent, Measures};

    /// A floor whose top is y = 0, and a step of one voxel up at x = 40.
    struct Floor;

    impl Terrain for Floor {
        fn is_solid(&self, voxel: IVec3) -> bool {
            voxel.y < i32::from(voxel.x >= 40)
        }
    }

    /// The footfalls of some seconds, in a body of this scale that begins this high above the floor.
    fn footfalls(intent: Intent, scale: f64, height: f64, seconds: f64) -> Vec<Footfall> {
        let measures = Measures::of_height(crate::world::PLAYER_HEIGHT_M * scale);
        let eye = DVec3::new(0.5, height + 1.625 * scale, 0.5);
        let mut body = Body::with_eye_at(eye, measures, -9.0, &Floor);
        body.mode = Mode::Walk;
        let mut gait = Gait::default();
        let dt_s = 1.0 / 120.0;
        (1..=(seconds / dt_s) as u64)
            .filter_map(|step| {
                body.step(&Floor, &intent, dt_s);
                gait.follow(&body, &Floor, dt_s, step * 8_333_333)
            })
            .collect()
    }

    fn forward() -> Intent {
        Intent {
            forward: 1,
            heading: DVec3::X,
            rightwards: DVec3::Z,
            ..Intent::default()
        }
    }

    #[test]
    fn a_walk_is_a_row_of_even_steps_and_rest_is_silent() {
        assert_eq!(footfalls(Intent::default(), 1.0, 0.0, 5.0), []);
        let steps = footfalls(forward(), 1.0, 0.0, 9.0);
        assert!(steps.iter().all(|step| step.contact == Contact::Step));
        // 36 m in strides of 1.63 m.
        assert!(steps.len().abs_diff(22) <= 1, "{steps:?}");
        let gaps: Vec<u64> = steps[2..]
            .windows(2)
            .map(|pair| (pair[1].at_ns - pair[0].at_ns) / 1_000_000)
            .collect();
        assert!(gaps.iter().all(|ms| ms.abs_diff(408) < 20), "{gaps:?}");
        assert!(steps.iter().all(|step| step.voxel.y == -1));
        // The same player, twice as many voxels tall, takes steps of twice as many voxels.
        assert!(
            footfalls(forward(), 2.0, 0.0, 9.0)
                .len()
                .abs_diff(steps.len())
                <= 1
        );
    }

    #[test]
    fn running_is_harder_and_sneaking_softer() {
        let hardest = |intent: Intent| {
            let steps = footfalls(intent, 1.0, 0.0, 4.0);
            steps.iter().map(|step| step.strength).fold(0.0, f32::max)
        };
        let run = hardest(Intent {
            run: true,
            ..forward()
        });
        let sneak = hardest(Intent {
            down: true,
            ..forward()
        });
        let walk = hardest(forward());
        assert!(
            run > 1.3 * walk && walk > 3.0 * sneak,
            "{run} {walk} {sneak}"
        );
    }

    #[test]
    fn a_fall_ends_with_one_landing_as_hard_as_it_was_deep_and_steps_of_the_ground_are_none() {
        let landing = |height: f64| footfalls(Intent::default(), 1.0, height, 3.0);
        let (low, high) = (landing(1.0), landing(8.0));
        assert_eq!((low.len(), high.len()), (1, 1), "{low:?} {high:?}");
        assert_eq!(
            (low[0].contact, high[0].contact),
            (Contact::Land, Contact::Land)
        );
        assert!(high[0].strength > 2.0 * low[0].strength);
        let jump = Intent {
            up: true,
            ..Intent::default()
        };
        assert!(
            footfalls(jump, 1.0, 0.0, 2.5).len() >= 2,
            "one for each jump"
        );
        let climbing = footfalls(forward(), 1.0, 0.0, 14.0);
        assert!(climbing.iter().all(|step| step.contact == Contact::Step));
        assert_eq!(climbing.last().map(|step| step.voxel.y), Some(0));
    }
}
