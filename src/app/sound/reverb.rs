//! The echo: a feedback delay network (Jot & Chaigne 1991, "Digital delay networks for designing artificial
//! reverberators"). Eight delay lines feed each other through an orthogonal matrix, which loses nothing; what a
//! line loses for the length of its delay gives the reverberation time.

/// Delay lines, a power of two for the matrix.
const LINES: usize = 8;
/// Delays relative to the mean time between two reflections. Their ratios are those of no small whole numbers, so
/// that echoes do not pile up; their mean is 1.
const RATIOS: [f32; LINES] = [0.613, 0.711, 0.797, 0.919, 1.037, 1.151, 1.303, 1.469];
/// Mean times between two reflections that the lines can hold (seconds).
const SHORTEST_S: f32 = 0.004;
const LONGEST_S: f32 = 0.12;
/// High frequencies fade in this share of the reverberation time, as in air and at rough walls.
const HIGH_SHARE: f32 = 0.45;
/// A delay changes by at most this many samples in a sample: a higher number would be heard as another pitch.
const FASTEST: f32 = 0.02;
/// Smaller numbers count as silence: they would become denormal, which slows processors down.
const SILENCE: f32 = 1e-15;

/// What an echo sounds like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// Seconds until the sound has fallen by 60 dB.
    pub time_s: f32,
    /// Mean time between two reflections (seconds).
    pub between_s: f32,
}

#[derive(Clone, Debug)]
struct Line {
    samples: Vec<f32>,
    /// In samples; it changes slowly.
    delay: f32,
    /// Gain of one pass, and the pole of its low-pass.
    gain: f32,
    pole: f32,
    last: f32,
}

#[derive(Clone, Debug)]
pub struct Reverb {
    lines: [Line; LINES],
    at: usize,
    rate_hz: f32,
    between_s: f32,
    /// Makes the energy of the echo that of its input.
    level: f32,
}

impl Reverb {
    pub fn new(echo: Echo, rate_hz: f32) -> Self {
        let longest = LONGEST_S * RATIOS[LINES - 1] * rate_hz;
        let between_s = echo.between_s.clamp(SHORTEST_S, LONGEST_S);
        let mut reverb = Self {
            lines: RATIOS.map(|ratio| Line {
                samples: vec![0.0; (longest as usize + 4).next_power_of_two()],
                delay: ratio * between_s * rate_hz,
                gain: 0.0,
                pole: 0.0,
                last: 0.0,
            }),
            at: 0,
            rate_hz,
            between_s,
            level: 0.0,
        };
        reverb.set(echo);
        reverb
    }

    /// Takes another echo: its time at once, its delays as fast as they may change.
    pub fn set(&mut self, echo: Echo) {
        self.between_s = echo.between_s.clamp(SHORTEST_S, LONGEST_S);
        let gain_after = |seconds: f32| 0.001_f32.powf(seconds / echo.time_s.max(0.01));
        for line in &mut self.lines {
            // Jot & Chaigne: a one-pole low-pass with this gain at 0 Hz and its power 1 / HIGH_SHARE at the top.
            line.gain = gain_after(line.delay / self.rate_hz);
            line.pole = 1.0 - 2.0 / (1.0 + line.gain.powf(1.0 - 1.0 / HIGH_SHARE));
        }
        let pass = gain_after(self.between_s);
        // What comes out after one pass, two passes, and so on: pass² + pass⁴ + …
        self.level = (1.0 - pass * pass).sqrt() / pass;
    }

    /// The echo at the left and the right ear.
    pub fn next(&mut self, input: f32) -> [f32; 2] {
        let mut state = [0.0; LINES];
        for ((line, ratio), out) in self.lines.iter_mut().zip(RATIOS).zip(&mut state) {
            let wanted = ratio * self.between_s * self.rate_hz;
            line.delay += (wanted - line.delay).clamp(-FASTEST, FASTEST);
            *out = line.read(self.at);
        }
        let left: f32 = (0..LINES).map(|i| sign(i, 0) * state[i]).sum();
        let right: f32 = (0..LINES).map(|i| sign(i, 1) * state[i]).sum();
        mix(&mut state);
        let share = input / (LINES as f32).sqrt();
        for (i, (line, mixed)) in self.lines.iter_mut().zip(state).enumerate() {
            line.write(self.at, mixed + sign(i, 2) * share);
        }
        self.at = self.at.wrapping_add(1);
        [left * self.level, right * self.level]
    }
}

impl Line {
    /// The sample `delay` ago, after its low-pass.
    fn read(&mut self, at: usize) -> f32 {
        let mask = self.samples.len() - 1;
        let whole = self.delay.floor();
        let rest = self.delay - whole;
        let sample = |ago: usize| self.samples[at.wrapping_sub(ago) & mask];
        let now = sample(whole as usize) * (1.0 - rest) + sample(whole as usize + 1) * rest;
        self.last = self.gain * (1.0 - self.pole) * now + self.pole * self.last;
        self.last
    }

    fn write(&mut self, at: usize, sample: f32) {
        let mask = self.samples.len() - 1;
        self.samples[at & mask] = if sample.abs() < SILENCE { 0.0 } else { sample };
    }
}

/// The Hadamard matrix, divided by √8 so that it keeps the energy, by butterflies.
fn mix(state: &mut [f32; LINES]) {
    let mut width = 1;
    while width < LINES {
        for start in (0..LINES).step_by(2 * width) {
            for i in start..start + width {
                let (a, b) = (state[i], state[i + width]);
                (state[i], state[i + width]) = (a + b, a - b);
            }
        }
        width *= 2;
    }
    let scale = 1.0 / (LINES as f32).sqrt();
    state.iter_mut().for_each(|x| *x *= scale);
}

/// Signs of the lines: rows 0, 1 and 2 are orthogonal, so that the ears hear different echoes.
fn sign(line: usize, row: usize) -> f32 {
    let odd = match row {
        0 => line & 1,
        1 => line >> 1 & 1,
        _ => (line ^ line >> 1 ^ line >> 2) & 1,
    };
    1.0 - 2.0 * odd as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::sound::signal::{energy, low_passed, reverberation_s};

    const RATE_HZ: f32 = 48_000.0;

    /// Both ears' response to one sample of 1.
    fn impulse(echo: Echo, seconds: f32) -> Vec<[f32; 2]> {
        let mut reverb = Reverb::new(echo, RATE_HZ);
        let samples = (seconds * RATE_HZ) as usize;
        (0..samples)
            .map(|at| reverb.next(if at == 0 { 1.0 } else { 0.0 }))
            .collect()
    }

    fn ear(response: &[[f32; 2]], ear: usize) -> Vec<f32> {
        response.iter().map(|both| both[ear]).collect()
    }

    #[test]
    fn it_fades_in_the_time_that_was_asked_for() {
        for time_s in [0.3, 0.8, 1.5, 3.0, 6.0] {
            for between_s in [0.006, 0.02, 0.09] {
                if time_s < 5.0 * between_s {
                    // A few single echoes have no slope.
                    continue;
                }
                let echo = Echo { time_s, between_s };
                let response = impulse(echo, 1.2 * time_s + 0.3);
                for side in 0..2 {
                    let low = low_passed(&ear(&response, side), 500.0, RATE_HZ);
                    let measured = reverberation_s(&low, RATE_HZ);
                    let error = measured / time_s - 1.0;
                    assert!(error.abs() < 0.15, "{echo:?}: {measured} s");
                }
            }
        }
    }

    #[test]
    fn high_frequencies_fade_faster() {
        let echo = Echo {
            time_s: 2.0,
            between_s: 0.02,
        };
        let all = ear(&impulse(echo, 3.0), 0);
        let low = low_passed(&all, 500.0, RATE_HZ);
        let high: Vec<f32> = all
            .iter()
            .zip(low_passed(&all, 6000.0, RATE_HZ))
            .map(|(all, low)| all - low)
            .collect();
        let ratio = reverberation_s(&high, RATE_HZ) / reverberation_s(&low, RATE_HZ);
        assert!((0.3..0.8).contains(&ratio), "{ratio}");
    }

    #[test]
    fn its_energy_is_that_of_its_input_and_its_ears_differ() {
        for (time_s, between_s) in [(0.3, 0.02), (1.0, 0.01), (4.0, 0.06)] {
            let response = impulse(Echo { time_s, between_s }, 1.5 * time_s);
            let low = |side: &[f32]| energy(&low_passed(side, 500.0, RATE_HZ));
            let input = low(&[&[1.0][..], &[0.0; 4800]].concat());
            let (left, right) = (ear(&response, 0), ear(&response, 1));
            for side in [&left, &right] {
                let db = 10.0 * (low(side) / input).log10();
                assert!(db.abs() < 4.0, "{time_s} s, {between_s} s: {db} dB");
            }
            let both: f32 = left.iter().zip(&right).map(|(l, r)| l * r).sum();
            let likeness = both / (energy(&left) * energy(&right)).sqrt();
            assert!(likeness.abs() < 0.3, "{likeness}");
        }
    }

    #[test]
    fn another_room_makes_no_jump_and_no_nonsense() {
        let small = Echo {
            time_s: 0.2,
            between_s: 0.004,
        };
        let mut reverb = Reverb::new(small, RATE_HZ);
        let mut last = [0.0; 2];
        for at in 0..96_000_u32 {
            if at.is_multiple_of(4000) {
                let is_large = at.is_multiple_of(8000);
                reverb.set(if is_large {
                    Echo {
                        time_s: 9.0,
                        between_s: 1.0,
                    }
                } else {
                    small
                });
            }
            let sine = 0.1 * (at as f32 * 0.02).sin();
            let now = reverb.next(sine);
            for (now, last) in now.iter().zip(last) {
                assert!(now.is_finite());
                assert!((now - last).abs() < 0.3, "a jump at {at}: {last} to {now}");
            }
            last = now;
        }
        let delays: Vec<f32> = reverb.lines.iter().map(|line| line.delay).collect();
        assert!(delays.iter().all(|delay| *delay < 9000.0), "{delays:?}");
    }
}
