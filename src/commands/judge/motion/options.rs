//! What moves, for how long, and when it is judged.

use std::path::PathBuf;

use clap::Args;
use serde::{Deserialize, Serialize};

use super::super::super::Failure;
use crate::parameters::Parameters;

/// Options of `grotto judge` about things that move.
#[derive(Args)]
pub struct MotionOptions {
    /// Also judge each row while things move, each moment against a reference of its own: `lamps`, `camera`, or
    /// `both` at once, as in --motion=lamps,camera [without a list: all three]
    ///
    /// World time runs from --time on, at 60 frames per second. The camera flies and turns, and is back at its
    /// place, still in motion, at each judged moment. A row `rest` is always made: nothing moves in it.
    #[arg(long, value_name = "WHAT,WHAT…", num_args = 0..=1, require_equals = true,
          default_missing_value = "lamps,camera,both", value_parser = Wanted::parse)]
    motion: Option<Wanted>,
    /// Frames of motion
    #[arg(long, value_name = "N", requires = "motion", default_value_t = 240, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    motion_frames: u32,
    /// Moments that are judged, evenly spread over the motion; the last frame is one of them
    #[arg(long, value_name = "N", requires = "motion", default_value_t = 4, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    moments: u32,
    /// Also judge everything that --motion moves while a ball of radius 2 is dug or built every tenth frame
    #[arg(long, requires = "motion")]
    edits: bool,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// The world stands still, and the probes have settled.
    Rest,
    Lamps,
    Camera,
    Both,
    /// Everything else that moves, and edits.
    Edits,
}

impl Motion {
    pub fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Lamps => "lamps",
            Self::Camera => "camera",
            Self::Both => "both",
            Self::Edits => "edits",
        }
    }
}

/// What moves in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Moves {
    pub lamps: bool,
    pub camera: bool,
    pub edits: bool,
}

/// The motions that `--motion` lists.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Wanted(Vec<Motion>);

impl Wanted {
    fn parse(text: &str) -> Result<Self, String> {
        let mut wanted = Vec::new();
        for name in text.split(',') {
            let known = [Motion::Lamps, Motion::Camera, Motion::Both];
            let Some(motion) = known.into_iter().find(|one| one.name() == name.trim()) else {
                return Err(
                    "write lamps, camera or both, or several with commas between them".to_owned(),
                );
            };
            if wanted.contains(&motion) {
                return Err(format!("`{}` is there twice", motion.name()));
            }
            wanted.push(motion);
        }
        Ok(Self(wanted))
    }

    fn moves(&self, motion: Motion) -> Moves {
        let any = |of: [Motion; 2]| self.0.iter().any(|one| of.contains(one));
        let [lamps, camera] = match motion {
            Motion::Rest => [false, false],
            Motion::Lamps => [true, false],
            Motion::Camera => [false, true],
            Motion::Both => [true, true],
            Motion::Edits => [Motion::Lamps, Motion::Camera].map(|one| any([one, Motion::Both])),
        };
        let edits = motion == Motion::Edits;
        Moves {
            lamps,
            camera,
            edits,
        }
    }
}

/// The rows that are made of each camera, layout and setting, besides `rest`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    pub rows: Vec<(Motion, Moves)>,
    /// Frames of the judged moments, counted from the first that has moved, which is 1. Ascending; the last is
    /// the last frame of the motion.
    pub moments: Vec<u32>,
}

impl Plan {
    /// Frames that one row moves.
    pub fn frames(&self) -> u32 {
        self.moments.last().copied().unwrap_or(0)
    }
}

impl MotionOptions {
    /// `None` without `--motion`.
    ///
    /// # Errors
    /// For options that contradict each other or the parameters.
    pub fn plan(&self, parameters: &Parameters) -> Result<Option<Plan>, Failure> {
        let Some(wanted) = &self.motion else {
            return Ok(None);
        };
        let (frames, count) = (self.motion_frames, self.moments);
        if frames < count {
            return Err(Failure::bad_input(format!(
                "--moments {count} needs as many frames of motion, and --motion-frames allows {frames}; name \
                 fewer moments or more frames"
            )));
        }
        let edits = self.edits.then_some(Motion::Edits);
        let rows = wanted.0.iter().copied().chain(edits);
        let rows: Vec<_> = rows.map(|one| (one, wanted.moves(one))).collect();
        if rows.iter().any(|(_, moves)| moves.lamps) && !parameters.lights.animate {
            return Err(Failure::bad_input(
                "--motion moves the lamps, and lights.animate=off stops them; leave one of them out, or write \
                 --motion=camera",
            ));
        }
        let at = |moment: u32| (u64::from(frames) * u64::from(moment) / u64::from(count)) as u32;
        Ok(Some(Plan {
            rows,
            moments: (1..=count).map(at).collect(),
        }))
    }

    /// # Errors
    /// For a motion among the worlds: the list needs the equals sign, or it would take the first world's name.
    pub fn check_worlds(&self, worlds: &[PathBuf]) -> Result<(), Failure> {
        if self.motion.is_none() {
            return Ok(());
        }
        let is_motion = |path: &&PathBuf| {
            let list = path
                .to_str()
                .is_some_and(|text| Wanted::parse(text).is_ok());
            list && !path.exists()
        };
        match worlds.iter().find(is_motion) {
            None => Ok(()),
            Some(list) => Err(Failure::bad_input(format!(
                "there is no world `{0}`; write --motion={0}",
                list.display()
            ))),
        }
    }

    /// Bytes of memory per pixel of the references that a camera's rows share.
    pub fn bytes_per_pixel(&self) -> u64 {
        /// Bounced and all light, as light and as display values, in three f32 each.
        const TARGET: u64 = 2 * 2 * 12;
        match self.motion {
            None => 0,
            Some(_) => TARGET * u64::from(self.moments) * (1 + u64::from(self.edits)),
        }
    }

    /// Everything that rows depend on, as text for the head of a part.
    pub fn fact(&self) -> String {
        match &self.motion {
            None => "off".to_owned(),
            Some(Wanted(wanted)) => {
                let names: Vec<&str> = wanted.iter().map(|one| one.name()).collect();
                let edits = if self.edits { " with --edits" } else { "" };
                format!(
                    "{}{edits}, {} moments of {} frames",
                    names.join(","),
                    self.moments,
                    self.motion_frames
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(list: &str, motion_frames: u32, moments: u32, edits: bool) -> MotionOptions {
        MotionOptions {
            motion: Some(Wanted::parse(list).expect("a sound list")),
            motion_frames,
            moments,
            edits,
        }
    }

    #[test]
    fn moments_are_evenly_spread_and_the_last_is_the_end() {
        let moments = |frames, count| {
            let plan = options("both", frames, count, false).plan(&Parameters::default());
            plan.expect("sound").expect("motion").moments
        };
        assert_eq!(moments(240, 4), [60, 120, 180, 240]);
        assert_eq!(moments(10, 3), [3, 6, 10]);
        assert_eq!(moments(3, 3), [1, 2, 3]);
        assert_eq!(moments(5, 1), [5]);
    }

    #[test]
    fn edits_join_everything_that_moves() {
        let moves = |list| {
            let plan = options(list, 4, 1, true).plan(&Parameters::default());
            let rows = plan.expect("sound").expect("motion").rows;
            let (motion, moves) = rows[rows.len() - 1];
            assert_eq!(motion, Motion::Edits);
            [moves.lamps, moves.camera, moves.edits]
        };
        assert_eq!(moves("lamps"), [true, false, true]);
        assert_eq!(moves("camera"), [false, true, true]);
        assert_eq!(moves("both"), [true, true, true]);
        assert_eq!(moves("camera,lamps"), [true, true, true]);
    }

    #[test]
    fn contradictions_are_refused() {
        let mut still = Parameters::default();
        still.set("lights.animate=off").expect("a key");
        for list in ["lamps", "both", "lamps,camera"] {
            let refused = options(list, 4, 1, false).plan(&still);
            let reason = refused.expect_err("the lamps stand still");
            assert!(reason.reason().contains("lights.animate"));
        }
        assert!(options("camera", 4, 1, true).plan(&still).is_ok());
        let refused = options("both", 3, 4, false).plan(&Parameters::default());
        assert!(refused.is_err(), "four moments in three frames");
        assert!(Wanted::parse("lamps,lamps").is_err());
        assert!(Wanted::parse("rest").is_err());
        assert!(Wanted::parse("").is_err());
    }
}
