//! One row of the table of motion: a camera's picture at several moments of one motion.

use serde::{Deserialize, Serialize};

use super::{
    super::row::Noise,
    options::{Motion, Moves},
};
use crate::measure::comparison::Comparison;

/// The figures of one motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MotionRow {
    pub motion: Motion,
    pub moves: Moves,
    /// In order of time; the row at rest also has the start.
    pub moments: Vec<Moment>,
    /// Mean FLIP of the moments over that of the same moments at rest. `null` for the row at rest itself, and
    /// where there is no error at rest.
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
    /// Bounced light alone, which is taken at the centres of pixels also with `--displayed`.
    pub indirect: Comparison,
    /// What the reference's noise adds to FLIP; `null` where that is not known.
    #[serde(default)]
    pub noise: Option<Noise>,
    /// Mean FLIP of all light after as many frames of a world that stands still as at this moment.
    pub rest_flip: f64,
}

impl MotionRow {
    pub fn new(motion: Motion, moves: Moves, moments: Vec<Moment>) -> Self {
        let mut row = Self {
            motion,
            moves,
            moments,
            over_rest: None,
        };
        let at_rest = row.mean(|moment| moment.rest_flip);
        if motion != Motion::Rest && at_rest > 0.0 {
            row.over_rest = Some(row.mean(|moment| moment.full.flip.mean) / at_rest);
        }
        row
    }

    /// Mean of a figure over the moments after the start; the start is a point of the curve.
    pub fn mean(&self, figure: impl Fn(&Moment) -> f64) -> f64 {
        let figures = self.after_the_start().map(figure);
        let (count, sum) = figures.fold((0u32, 0.0), |(count, sum), one| (count + 1, sum + one));
        sum / f64::from(count.max(1))
    }

    /// Mean of the noise of all light; `None` where that of a moment is not known.
    pub fn noise(&self) -> Option<f64> {
        let known = self.after_the_start().all(|moment| moment.noise.is_some());
        known.then(|| self.mean(|moment| moment.noise.map_or(0.0, |noise| noise.full)))
    }

    /// Greatest FLIP (mean over the pixels) of the moments after the start.
    pub fn worst_flip(&self) -> f64 {
        let flips = self.after_the_start().map(|moment| moment.full.flip.mean);
        flips.fold(0.0, f64::max)
    }

    fn after_the_start(&self) -> impl Iterator<Item = &Moment> {
        self.moments.iter().filter(|moment| moment.frame > 0)
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::measure::comparison::{AbsoluteSummary, FlipSummary};

    pub fn moment(frame: u32, flip: f64, rest_flip: f64) -> Moment {
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
            noise: Some(Noise {
                full: 0.125,
                indirect: 0.25,
            }),
            rest_flip,
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
        let moments = || vec![moment(30, 0.4, 0.1), moment(60, 0.8, 0.3)];
        let row = MotionRow::new(Motion::Lamps, moves(true, false), moments());
        assert!((row.over_rest.expect("an error at rest") - 3.0).abs() < 1e-12);
        assert_eq!(row.worst_flip(), 0.8);
        assert_eq!(row.noise(), Some(0.125));
        let mut unknown = moments();
        unknown[1].noise = None;
        let unknown = MotionRow::new(Motion::Lamps, moves(true, false), unknown);
        assert_eq!(unknown.noise(), None);
        let row = MotionRow::new(Motion::Rest, moves(false, false), moments());
        assert_eq!(row.over_rest, None);
        let perfect = vec![moment(30, 0.4, 0.0)];
        let row = MotionRow::new(Motion::Lamps, moves(true, false), perfect);
        assert_eq!(row.over_rest, None);
    }
}
