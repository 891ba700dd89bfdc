//! Holds a frame time by doing less than the preset asks for.
//!
//! Frames are judged by the median of a stretch of frames, so that single slow ones count for nothing. Three rules keep
//! the picture from changing to and fro. The band between [`Auto::FAST`] and [`Auto::SLOW`] is wider than any step
//! upwards. Steps upwards take several fast stretches in a row. And a step upwards that turned out too dear is tried
//! again only after a wait, which doubles with every failure and halves with every success.

use std::ops::RangeInclusive;

use super::Effort;

/// The control, and what it has seen of the frames.
#[derive(Clone, Debug)]
pub struct Auto {
    pub target_ms: f64,
    step: usize,
    /// Times of the frames of this stretch (milliseconds).
    frames_ms: Vec<f64>,
    /// Frames that do not count yet.
    skipped: u32,
    /// Stretches in a row that were too slow, and that were fast enough for more.
    slow: u32,
    fast: u32,
    /// Stretches since the last step upwards; `None` if the last step went down.
    since_up: Option<u32>,
    /// Stretches before the next step upwards, and how many the next failure will cost.
    barred: u32,
    penalty: u32,
}

impl Auto {
    /// Frame times that can be held (milliseconds).
    pub const TARGETS_MS: RangeInclusive<f64> = 1.0..=1000.0;
    /// Below this share of the target a frame leaves room for a step upwards.
    const FAST: f64 = 0.8;
    /// Above this share a frame takes too long.
    const SLOW: f64 = 1.1;
    /// Above this share it takes so much too long that one stretch is enough to see it.
    const FAR_TOO_SLOW: f64 = 1.5;
    /// A stretch has at least so many frames, and takes at least so long.
    const FRAMES: usize = 7;
    const STRETCH_MS: f64 = 400.0;
    /// Frames after a change or a hitch that say nothing.
    const SKIPPED: u32 = 2;
    /// Stretches in a row before a step.
    const SLOW_STRETCHES: u32 = 3;
    const FAST_STRETCHES: u32 = 3;
    /// A change of the picture's size ends the history of its anti-aliasing: it is made more rarely.
    const FAST_STRETCHES_FOR_SIZE: u32 = 6;
    /// Most steps at once.
    const MOST_STEPS: usize = 4;
    /// A step downwards saves about this much, or less where other work takes most of the time.
    const STEP: f64 = 1.25;
    /// A step upwards has failed if frames are too slow within this many stretches.
    const TRIAL: u32 = 30;
    /// Stretches until a failed step is tried again: at least, and at most.
    const PENALTY: u32 = 16;
    const MOST_PENALTY: u32 = 1024;

    pub fn new(target_ms: f64) -> Self {
        Self {
            target_ms,
            step: 0,
            frames_ms: Vec::new(),
            skipped: Self::SKIPPED,
            slow: 0,
            fast: 0,
            since_up: None,
            barred: 0,
            penalty: Self::PENALTY,
        }
    }

    /// The frame time that is held where nobody chose one (milliseconds).
    pub const fn default_target_ms(is_software: bool) -> f64 {
        if is_software { 150.0 } else { 16.7 }
    }

    /// The effort of the next frame.
    pub const fn effort(&self) -> Effort {
        Effort::of_step(self.step)
    }

    /// The next frames say nothing: something was built, or the window rested.
    pub fn interrupt(&mut self) {
        self.frames_ms.clear();
        self.skipped = Self::SKIPPED;
    }

    /// A frame took so long. The effort may be another one afterwards.
    pub fn frame(&mut self, ms: f64) {
        if self.skipped > 0 {
            self.skipped -= 1;
            return;
        }
        self.frames_ms.push(ms);
        let total_ms: f64 = self.frames_ms.iter().sum();
        if self.frames_ms.len() >= Self::FRAMES && total_ms >= Self::STRETCH_MS {
            let median_ms = median(&mut self.frames_ms);
            self.frames_ms.clear();
            self.stretch(median_ms / self.target_ms);
        }
    }

    /// A stretch of frames took `share` of the target.
    fn stretch(&mut self, share: f64) {
        self.barred = self.barred.saturating_sub(1);
        self.since_up = self.since_up.map(|stretches| stretches + 1);
        if self.since_up == Some(Self::TRIAL) {
            self.penalty = (self.penalty / 2).max(Self::PENALTY);
        }
        self.slow = if share > Self::SLOW { self.slow + 1 } else { 0 };
        self.fast = if share < Self::FAST { self.fast + 1 } else { 0 };
        if self.slow >= Self::SLOW_STRETCHES || share > Self::FAR_TOO_SLOW {
            self.less(share);
        } else if self.fast >= Self::FAST_STRETCHES && self.barred == 0 {
            self.more(share);
        }
    }

    fn less(&mut self, share: f64) {
        let has_failed = self.since_up.is_some_and(|since| since < Self::TRIAL);
        if has_failed {
            self.barred = self.penalty;
            self.penalty = (2 * self.penalty).min(Self::MOST_PENALTY);
        }
        let steps = (share.ln() / Self::STEP.ln()).ceil() as usize;
        let steps = steps.clamp(1, if has_failed { 1 } else { Self::MOST_STEPS });
        self.since_up = None;
        self.go_to((self.step + steps).min(Effort::LOWEST));
    }

    fn more(&mut self, share: f64) {
        let Some(next) = self.step.checked_sub(1) else {
            return;
        };
        let is_resized = Effort::of_step(next).scale != self.effort().scale;
        if is_resized && self.fast < Self::FAST_STRETCHES_FOR_SIZE {
            return;
        }
        // As many steps as fit even if each of them costs the most.
        let steps = ((1.0 / share).ln() / Effort::DEAREST_STEP.ln()) as usize;
        let steps = steps.clamp(1, Self::MOST_STEPS);
        self.since_up = Some(0);
        self.go_to(self.step.saturating_sub(steps));
    }

    fn go_to(&mut self, step: usize) {
        self.slow = 0;
        self.fast = 0;
        if step != self.step {
            self.step = step;
            self.interrupt();
        }
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests;
