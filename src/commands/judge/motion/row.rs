//! One row of the table of motion: a camera's picture at several moments of one motion.

use serde::{Deserialize, Serialize};

use super::options::{Motion, Moves};
use crate::measure::comparison::Comparison;

/// The figures of one motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MotionRow {
    pub motion: Motion,
    pub moves: Moves,
    /// In order of time; never empty.
    pub moments: Vec<Moment>,
    /// Mean FLIP of the moments over that of the same moments at rest. `null` for the row at rest itself.
    pub over_rest: Option<f64>,
}

/// One judged frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Moment {
    /// Frames since things began to move.
    pub frame: u32,
    /// World time in seconds.
    pub time_s: f64,
    /// All light: DDGI over the reference of this moment.
    pub full: Comparison,
    /// Bounced light alone.
    pub indirect: Comparison,
}

impl MotionRow {
    pub fn new(motion: Motion, moves: Moves, moments: Vec<Moment>, rest: &[Moment]) -> Self {
        let mut row = Self {
            motion,
            moves,
            moments,
            over_rest: None,
        };
        if motion != Motion::Rest {
            // Where lamps stand still, every moment shows the light of the first.
            let same = |frame| match moves.lamps {
                true => rest.iter().find(|rest| rest.frame == frame),
                false => rest.first(),
            };
            let at_rest = row.moments.iter().filter_map(|moment| same(moment.frame));
            let at_rest: f64 = at_rest.map(|rest| rest.full.flip.mean).sum();
            let moving: f64 = row.moments.iter().map(|one| one.full.flip.mean).sum();
            row.over_rest = (at_rest > 0.0).then_some(moving / at_rest);
        }
        row
    }

    /// Mean of a figure over the moments.
    pub fn mean(&self, figure: impl Fn(&Moment) -> f64) -> f64 {
        let sum: f64 = self.moments.iter().map(figure).sum();
        sum / self.moments.len() as f64
    }

    /// Greatest FLIP (mean over the pixels) of the moments.
    pub fn worst_flip(&self) -> f64 {
        let flips = self.moments.iter().map(|moment| moment.full.flip.mean);
        flips.fold(0.0, f64::max)
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::measure::comparison::{AbsoluteSummary, FlipSummary};

    pub fn moment(frame: u32, flip: f64) -> Moment {
        let figures = Comparison {
            flip: FlipSummary {
                mean: flip,
                p99: 0.0,
                max: 0.0,
            },
            abs_sum: AbsoluteSummary {
                mean: 0.0,
                max: 0.0,
            },
            rel_mse: 0.5,
            energy_ratio: 1.25,
            size: [1, 1],
            pixels: 1,
        };
        Moment {
            frame,
            time_s: f64::from(frame) / 60.0,
            full: figures,
            indirect: figures,
        }
    }

    pub fn moves(lamps: bool, camera: bool) -> Moves {
        Moves {
            lamps,
            camera,
            edits: false,
        }
    }

    #[test]
    fn motion_is_compared_with_the_same_moments_at_rest() {
        let rest = [moment(0, 0.1), moment(30, 0.2), moment(60, 0.4)];
        let moved = || vec![moment(30, 0.4), moment(60, 0.8)];
        let over = |motion, lamps| {
            let moves = moves(lamps, !lamps);
            MotionRow::new(motion, moves, moved(), &rest).over_rest
        };
        let near = |value: Option<f64>, wanted: f64| {
            assert!((value.expect("light") - wanted).abs() < 1e-12, "{value:?}");
        };
        near(over(Motion::Lamps, true), 2.0);
        near(over(Motion::Camera, false), 6.0);
        assert_eq!(over(Motion::Rest, false), None);
    }
}
