//! Axes: where values lie, and which values are labelled.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// An axis. Positions are shares of its length, 0 to 1.
#[derive(Clone, Debug)]
pub struct Scale {
    from: f64,
    to: f64,
    log: bool,
    /// Values to label, with their labels.
    pub ticks: Vec<(f64, String)>,
}

/// Values that spread over more than this factor are shown on a logarithmic axis.
const WIDE: f64 = 12.0;
/// Room beyond the outermost values of a logarithmic axis, as a factor.
const MARGIN: f64 = 1.15;

impl Scale {
    /// From zero to a little more than the largest value.
    pub fn from_zero(values: impl Iterator<Item = f64>, most_ticks: usize) -> Self {
        let largest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
        Self::linear(0.0, if largest > 0.0 { largest } else { 1.0 }, most_ticks)
    }

    /// Holds all values: logarithmic where they are positive and spread widely, else from zero.
    pub fn spanning(values: impl Iterator<Item = f64> + Clone, most_ticks: usize) -> Self {
        let positive = values
            .clone()
            .filter(|value| value.is_finite() && *value > 0.0);
        let (low, high) = positive.fold((f64::INFINITY, 0.0f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        if high > WIDE * low {
            Self::logarithmic(low, high, most_ticks)
        } else {
            Self::from_zero(values, most_ticks)
        }
    }

    /// Linear from `from` to the first round value at or above `to`.
    pub fn linear(from: f64, to: f64, most_ticks: usize) -> Self {
        let step = round_step((to - from) / most_ticks.max(1) as f64);
        let first = (from / step).ceil() as i64;
        let mut last = (to / step).floor() as i64;
        // A longest bar that ends just short of a tick extends the axis to it; otherwise the plot stays
        // tight.
        if to > step * last as f64 + 0.6 * step {
            last += 1;
        }
        let ticks = (first..=last).map(|tick| {
            let value = tick as f64 * step;
            (value, figure(value))
        });
        Self {
            from,
            to: (step * last as f64).max(to * 1.02),
            log: false,
            ticks: ticks.collect(),
        }
    }

    /// Labelled at powers of ten, or at 1, 2 and 5 times powers of ten if the span is short.
    pub fn logarithmic(low: f64, high: f64, most_ticks: usize) -> Self {
        let (from, to) = (low / MARGIN, high * MARGIN);
        let decades = from.log10().floor() as i32..=to.log10().ceil() as i32;
        let of = |factors: &[f64], every: usize| -> Vec<(f64, String)> {
            let powers = decades.clone().step_by(every);
            let values =
                powers.flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)));
            values
                .filter(|value| (from..=to).contains(value))
                .map(|value| (value, figure(value)))
                .collect()
        };
        let choices = [
            of(&[1.0, 2.0, 5.0], 1),
            of(&[1.0, 3.0], 1),
            of(&[1.0], 1),
            of(&[1.0], 2),
            of(&[1.0], 3),
        ];
        let fitting = choices.into_iter().find(|ticks| ticks.len() <= most_ticks);
        Self {
            from,
            to,
            log: true,
            ticks: fitting.unwrap_or_default(),
        }
    }

    /// Logarithmic, labelled at those of the values that are far enough apart. Zero is placed to the
    /// left of the smallest positive value.
    pub fn at_values(values: &[f64]) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let positive: Vec<f64> = sorted.iter().copied().filter(|v| *v > 0.0).collect();
        let (low, high) = match (positive.first(), positive.last()) {
            (Some(&low), Some(&high)) => (low, high),
            _ => (1.0, 1.0),
        };
        let has_zero = sorted.first().is_some_and(|first| *first <= 0.0);
        let mut scale = Self {
            from: if has_zero { 0.4 * low } else { low / MARGIN },
            to: high * MARGIN,
            log: true,
            ticks: Vec::new(),
        };
        for value in sorted {
            let label = figure(value);
            let at = scale.at(value);
            let room = 0.035 + 0.012 * label.len() as f64;
            let free = scale
                .ticks
                .last()
                .is_none_or(|(last, text)| at - scale.at(*last) > room + 0.012 * text.len() as f64);
            if free {
                scale.ticks.push((value, label));
            }
        }
        scale
    }

    /// Places 0, 1, 2, … labelled with names as far as there is room.
    pub fn named(names: &[String]) -> Self {
        let last = names.len().saturating_sub(1) as f64;
        let (from, to) = (-0.3, last + 0.3);
        let longest = names
            .iter()
            .map(|name| name.chars().count())
            .max()
            .unwrap_or(0);
        let room = ((0.95 / (0.05 + 0.022 * longest as f64)) as usize).max(1);
        let every = names.len().div_ceil(room).max(1);
        let ticks = names.iter().enumerate().step_by(every);
        Self {
            from,
            to,
            log: false,
            ticks: ticks.map(|(at, name)| (at as f64, name.clone())).collect(),
        }
    }

    /// Linear, close around all values: for changes that are small compared with the values.
    pub fn around(values: impl Iterator<Item = f64> + Clone, most_ticks: usize) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        if low > high {
            return Self::linear(0.0, 1.0, most_ticks);
        }
        // Noise must not fill the plot.
        let margin = (0.15 * (high - low))
            .max(0.03 * high.abs())
            .max(f64::MIN_POSITIVE);
        Self::linear(low - margin, high + margin, most_ticks)
    }

    /// The label of a tick.
    pub(super) fn label(&self, value: f64) -> String {
        let tick = self.ticks.iter().find(|(tick, _)| *tick == value);
        tick.map_or(String::new(), |(_, label)| label.clone())
    }

    /// Position of a value, 0 to 1; values outside lie at the edges.
    pub fn at(&self, value: f64) -> f64 {
        let share = if self.log {
            // Zero lies at the start.
            (value.max(self.from) / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        };
        share.clamp(0.0, 1.0)
    }

    pub fn is_log(&self) -> bool {
        self.log
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        start + (self.at(*value) * f64::from(end - start)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.ticks.iter().map(|(value, _)| *value).collect()
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(value: &f64) -> String {
        figure(*value)
    }
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is at least `least`.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.max(f64::MIN_POSITIVE).log10().floor());
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|step| step * power);
    steps
        .into_iter()
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// A number with three significant digits, in a readable form: `1193`, `60.2`, `0.00123`, `2.1M`.
pub fn figure(value: f64) -> String {
    let size = value.abs();
    let trimmed = |text: String| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    };
    match size {
        _ if !value.is_finite() => "–".to_owned(),
        0.0 => "0".to_owned(),
        s if s >= 1e9 => trimmed(format!("{:.2}", value / 1e9)) + "G",
        s if s >= 1e6 => trimmed(format!("{:.2}", value / 1e6)) + "M",
        s if s >= 2e4 => trimmed(format!("{:.1}", value / 1e3)) + "k",
        s if s >= 100.0 => format!("{value:.0}"),
        s if s >= 10.0 => trimmed(format!("{value:.1}")),
        s if s >= 1.0 => trimmed(format!("{value:.2}")),
        s if s >= 1e-4 => {
            let places = (2.0 - s.log10().floor()) as usize;
            trimmed(format!("{value:.places$}"))
        }
        _ => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_three_digits() {
        for (value, text) in [
            (1193.4, "1193"),
            (63.25, "63.2"),
            (2.0, "2"),
            (0.001234, "0.00123"),
            (2_073_600.0, "2.07M"),
            (65_536.0, "65.5k"),
            (0.0, "0"),
            (-0.5, "-0.5"),
            (f64::NAN, "–"),
            (3e-7, "3.0e-7"),
        ] {
            assert_eq!(figure(value), text);
        }
    }

    #[test]
    fn axes_hold_their_values_between_round_ticks() {
        let scale = Scale::from_zero([3.0, 870.0].into_iter(), 5);
        assert!(!scale.is_log());
        assert_eq!(scale.at(0.0), 0.0);
        assert!(scale.at(870.0) < 1.0);
        assert!(scale.ticks.len() <= 7, "{:?}", scale.ticks);
        let wide = Scale::spanning([0.1, 90.0].into_iter(), 5);
        assert!(wide.is_log());
        assert!(wide.at(0.1) > 0.0 && wide.at(90.0) < 1.0);
        assert!((wide.at(3.0) - 0.5).abs() < 1e-9);
        assert!((2..=5).contains(&wide.ticks.len()), "{:?}", wide.ticks);
        assert!(!Scale::spanning(std::iter::empty(), 5).is_log());
    }

    #[test]
    fn names_have_room_and_small_changes_are_visible() {
        let names: Vec<String> = (0..40).map(|index| format!("commit{index:02}")).collect();
        let scale = Scale::named(&names);
        assert!((2..=6).contains(&scale.ticks.len()), "{:?}", scale.ticks);
        assert_eq!(scale.label(0.0), "commit00");
        assert_eq!(Scale::named(&names[..3]).ticks.len(), 3);
        let close = Scale::around([10.0, 10.1].into_iter(), 4);
        assert!(close.at(10.1) - close.at(10.0) > 0.1);
        assert!(close.at(10.0) > 0.1 && close.at(10.1) < 0.9);
        let equal = Scale::around([0.0; 2].into_iter(), 4);
        assert!(equal.at(0.0).is_finite());
    }

    #[test]
    fn values_with_room_are_labelled_and_zero_has_a_place() {
        let scale = Scale::at_values(&[0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 64.0]);
        assert_eq!(scale.at(0.0), 0.0);
        assert!(scale.at(1.0) > 0.05);
        assert_eq!(scale.ticks.len(), 7, "{:?}", scale.ticks);
        let dense = Scale::at_values(&[1.0, 1.01, 1.02, 10.0]);
        assert_eq!(dense.ticks.len(), 2, "{:?}", dense.ticks);
        assert_eq!(dense.ticks[1], (10.0, "10".to_owned()));
    }
}
