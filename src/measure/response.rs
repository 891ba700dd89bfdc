//! How many frames light takes to follow a change of the scene.

use serde::{Deserialize, Serialize};

use super::{
    metrics::{MetricError, comparable},
    picture::Picture,
};

/// Frames from a change until a share of it is visible; the first frame that shows any of the change is
/// frame 1. `None` if the watched frames were too few.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Response {
    pub to_90: Option<u32>,
    pub to_99: Option<u32>,
    /// Number of watched frames.
    pub watched: u32,
}

/// Frames that progress must stay within the tolerance: passing through does not count.
const HOLD: usize = 8;
/// A change of less than this share of the light is too small to follow.
const LEAST_CHANGE: f64 = 0.005;
/// Where the references change by so much, their noise counted, light must follow.
const CERTAIN_CHANGE: f64 = 0.02;

/// References before and after a change of the scene. They say where light rises and where it falls.
#[derive(Clone, Copy, Debug)]
pub struct Change<'a> {
    pub before: &'a Picture,
    pub after: &'a Picture,
}

/// How a series of pictures goes from `before` to its settled value, the mean of its last quarter.
/// `None` if the light hardly changes (by less than half a percent), or no picture follows. Where the references change by 2 %
/// and the light does not, no share of the change is ever reached.
///
/// Progress is the part of the change that has happened, summed over pixels and channels: with settled value e, start b, and
/// s the sign of the references' change, Σ s·(value − b) / Σ s·(e − b). It is linear in the pictures, so that noise which
/// averages out over pixels averages out of it. The sign of e − b itself would not do: where light does not change, it is that
/// of the start's noise, which stays in the pictures for as long as their histories do and would count as a slow change.
/// A share of 90 % is reached when progress is within 10 % of 1 and stays there for eight frames.
///
/// # Errors
/// [`MetricError`] for pictures of different sizes, or not finite. The pictures are linear light.
pub fn response(
    change: Change<'_>,
    before: &Picture,
    after: &[Picture],
) -> Result<Option<Response>, MetricError> {
    comparable(change.before, before)?;
    comparable(change.after, before)?;
    for picture in after {
        comparable(picture, before)?;
    }
    let signs: Vec<f64> = flat(change.after)
        .zip(flat(change.before))
        .map(|(after, before)| sign(after - before))
        .collect();
    let settled = mean(&after[after.len() - after.len().div_ceil(4)..]);
    let start: Vec<f64> = flat(before).collect();
    let light: f64 = settled.iter().chain(&start).map(|value| value.abs()).sum();
    let done = |values: &mut dyn Iterator<Item = f64>| -> f64 {
        let changes = values.zip(&start).map(|(value, b)| value - b);
        changes
            .zip(&signs)
            .map(|(change, sign)| change * sign)
            .sum()
    };
    let all = done(&mut settled.iter().copied());
    if all <= LEAST_CHANGE * light {
        let must_follow = !after.is_empty() && share_of_change(change) > CERTAIN_CHANGE;
        return Ok(must_follow.then_some(Response {
            to_90: None,
            to_99: None,
            watched: after.len() as u32,
        }));
    }
    let progress: Vec<f64> = (after.iter())
        .map(|picture| done(&mut flat(picture)) / all)
        .collect();
    Ok(Some(Response {
        to_90: reached(&progress, 0.9),
        to_99: reached(&progress, 0.99),
        watched: after.len() as u32,
    }))
}

/// The first frame (counted from 1) at which progress reaches this share and stays there.
fn reached(progress: &[f64], share: f64) -> Option<u32> {
    let within = |value: &f64| (1.0 - value).abs() <= 1.0 - share + 1e-9;
    let frame = progress
        .windows(HOLD.min(progress.len().max(1)))
        .position(|window| window.iter().all(within))?;
    Some(frame as u32 + 1)
}

/// By what share of their light two references differ.
fn share_of_change(change: Change<'_>) -> f64 {
    let pairs = || flat(change.after).zip(flat(change.before));
    let light: f64 = pairs().map(|(after, before)| after + before).sum();
    let difference: f64 = pairs().map(|(after, before)| (after - before).abs()).sum();
    difference / light.max(f64::MIN_POSITIVE)
}

/// 0 of 0.
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

fn flat(picture: &Picture) -> impl Iterator<Item = f64> {
    picture.rgb.iter().flatten().map(|&value| f64::from(value))
}

fn mean(pictures: &[Picture]) -> Vec<f64> {
    let mut sums = Vec::new();
    for picture in pictures {
        sums.resize(picture.rgb.len() * 3, 0.0);
        for (sum, value) in sums.iter_mut().zip(flat(picture)) {
            *sum += value / pictures.len() as f64;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One pixel that rises and one that falls, at the same progress.
    fn at(progress: f64) -> Picture {
        Picture {
            width: 2,
            height: 1,
            rgb: vec![[progress as f32; 3], [2.0 - progress as f32; 3]],
        }
    }

    /// Between references before and after.
    fn rises_and_falls(of: [&Picture; 2]) -> Change<'_> {
        Change {
            before: of[0],
            after: of[1],
        }
    }

    fn of(progress: impl IntoIterator<Item = f64>) -> Option<Response> {
        let after: Vec<Picture> = progress.into_iter().map(at).collect();
        response(rises_and_falls([&at(0.0), &at(1.0)]), &at(0.0), &after).expect("comparable")
    }

    #[test]
    fn a_running_mean_takes_the_frames_that_its_hysteresis_predicts() {
        // After n frames progress is 1 − 0.9ⁿ: 90 % after 21.9 frames, 99 % after 43.7.
        let response = of((1..400).map(|n| 1.0 - 0.9f64.powi(n))).expect("a change");
        assert_eq!((response.to_90, response.to_99), (Some(22), Some(44)));
        assert_eq!(response.watched, 399);
    }

    #[test]
    fn an_immediate_change_takes_one_frame() {
        let response = of([1.0; 40]).expect("a change");
        assert_eq!((response.to_90, response.to_99), (Some(1), Some(1)));
    }

    #[test]
    fn passing_through_the_settled_value_is_not_arriving() {
        let mut progress = vec![1.0; 100];
        progress[..20].copy_from_slice(&[1.5; 20]);
        progress[3] = 1.0;
        let response = of(progress).expect("a change");
        assert_eq!(response.to_90, Some(21));
    }

    #[test]
    fn light_that_never_settles_is_reported_as_unsettled() {
        let swinging = (0..80).map(|n| if n % 2 == 0 { 0.5 } else { 1.5 });
        let response = of(swinging).expect("a change");
        assert_eq!((response.to_90, response.to_99), (None, None));
    }

    #[test]
    fn no_change_and_no_frames_have_no_response() {
        let (dark, hardly) = (at(0.0), at(0.001));
        let change = rises_and_falls([&dark, &hardly]);
        for light in [&dark, &hardly] {
            let found = response(change, &dark, &vec![light.clone(); 30]);
            assert_eq!(found.expect("comparable"), None);
        }
        assert_eq!(of([]), None);
    }

    #[test]
    fn light_that_does_not_follow_or_goes_the_other_way_never_arrives() {
        for found in [of([0.0; 30]), of([-1.0; 30])] {
            let never = found.expect("the references change");
            assert_eq!((never.to_90, never.to_99), (None, None));
        }
    }

    /// In [−0.5, 0.5).
    fn noise(seed: u32) -> f64 {
        let hash = seed
            .wrapping_mul(2_654_435_761)
            .rotate_left(15)
            .wrapping_mul(2_246_822_519);
        f64::from(hash >> 8) / f64::from(1 << 24) - 0.5
    }

    fn picture(light: impl Fn(u32) -> f64) -> Picture {
        Picture {
            width: 20,
            height: 20,
            rgb: (0..400).map(|i| [light(i) as f32; 3]).collect(),
        }
    }

    #[test]
    fn noise_that_histories_replace_slowly_is_no_change() {
        // A fifth of the pixels becomes brighter at once; in all of them old noise becomes new noise.
        let at = |kept: f64| {
            picture(move |i| {
                let lit = if i < 80 && kept < 1.0 { 0.5 } else { 0.0 };
                let (old, new) = (noise(400 + i), noise(800 + i));
                1.0 + lit + 0.08 * (kept * old + (1.0 - kept) * new)
            })
        };
        let after: Vec<Picture> = (1..400).map(|n| at(0.98f64.powi(n))).collect();
        let lit = picture(|i| 1.0 + 0.08 * noise(1600 + i) + if i < 80 { 0.5 } else { 0.0 });
        let dark = picture(|i| 1.0 + 0.08 * noise(1200 + i));
        let known = response(rises_and_falls([&dark, &lit]), &at(1.0), &after);
        let known = known.expect("comparable").expect("a change");
        assert!(known.to_90.is_some_and(|n| n < 4), "{known:?}");
        // Its own pictures, noise and all, in place of references.
        let last = after.last().expect("there are some").clone();
        let own = response(rises_and_falls([&at(1.0), &last]), &at(1.0), &after);
        let own = own.expect("comparable").expect("a change");
        assert!(own.to_90.is_some_and(|n| n > 20), "{own:?}");
    }

    #[test]
    fn independent_noise_hardly_moves_the_count() {
        let noisy = |n: u32| {
            let done = 1.0 - 0.9f64.powi(n as i32);
            picture(|i| done + 0.05 * noise(n * 400 + i))
        };
        let after: Vec<Picture> = (1..300).map(noisy).collect();
        let dark = Picture::new(20, 20);
        let lit = picture(|_| 1.0);
        let response = response(rises_and_falls([&dark, &lit]), &dark, &after);
        let response = response.expect("comparable");
        let response = response.expect("a change");
        assert!(
            response.to_90.is_some_and(|n| n.abs_diff(22) <= 1),
            "{response:?}"
        );
        assert!(
            response.to_99.is_some_and(|n| n.abs_diff(44) <= 4),
            "{response:?}"
        );
    }

    #[test]
    fn a_picture_that_is_not_finite_is_refused() {
        let (dark, lit) = (at(0.0), at(1.0));
        let change = rises_and_falls([&dark, &lit]);
        let refused = response(change, &dark, &[at(0.5), at(f64::NAN)]);
        assert!(matches!(refused, Err(MetricError::NotFinite { .. })));
        let nowhere = at(f64::NAN);
        let refused = response(
            rises_and_falls([&dark, &nowhere]),
            &dark,
            std::slice::from_ref(&lit),
        );
        assert!(matches!(refused, Err(MetricError::NotFinite { .. })));
    }
}
