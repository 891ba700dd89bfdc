//! How one quantity grows with another: power laws, and Pareto-optimal points.

/// y = factor · x^exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    pub factor: f64,
    pub exponent: f64,
    /// Share of the variance of log y that the law explains; 1 if all y are equal.
    pub r_squared: f64,
    /// Number of fitted points.
    pub points: usize,
}

impl PowerLaw {
    /// Least squares on the logarithms. Points with a coordinate of 0 or less are left out: no power
    /// law passes through them. `None` for fewer than three different x.
    pub fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let usable = |value: f64| value > 0.0 && value.is_finite();
        let logs: Vec<(f64, f64)> = points
            .iter()
            .filter(|(x, y)| usable(*x) && usable(*y))
            .map(|(x, y)| (x.ln(), y.ln()))
            .collect();
        let mut places: Vec<f64> = logs.iter().map(|(x, _)| *x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        if places.len() < 3 {
            return None;
        }
        let count = logs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
        let (mean_x, mean_y) = (mean(|(x, _)| *x), mean(|(_, y)| *y));
        let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            logs.iter().map(|(x, y)| of(x - mean_x, y - mean_y)).sum()
        };
        let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
        let exponent = xy / xx;
        // Rounding leaves a residue where all y are equal.
        let r_squared = if yy < 1e-18 * count {
            1.0
        } else {
            xy * xy / (xx * yy)
        };
        Some(Self {
            factor: (mean_y - exponent * mean_x).exp(),
            exponent,
            r_squared,
            points: logs.len(),
        })
    }

    /// In words: `frame time grows as rays^0.62`.
    pub fn in_words(&self, y: &str, x: &str) -> String {
        let poorly = if self.r_squared < 0.9 {
            ", roughly: the points do not lie on a power law"
        } else {
            ""
        };
        let exponent = self.exponent;
        match exponent {
            e if e.abs() < 0.02 => format!("{y} does not depend on {x}"),
            e if e > 0.0 => format!("{y} grows as {x}^{exponent:.2}{poorly}"),
            _ => format!("{y} falls as {x}^−{:.2}{poorly}", -exponent),
        }
    }
}

/// Indices of the points that no other point beats in both coordinates: large `gain` at small `cost`.
/// Sorted by rising cost.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|&index| points[index].0.is_finite() && points[index].1.is_finite())
        .collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1))
    });
    let mut best = f64::NEG_INFINITY;
    order.retain(|&index| {
        let better = points[index].1 > best;
        best = best.max(points[index].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_as_it_was_made() {
        let points: Vec<(f64, f64)> = [0.0, 8.0, 16.0, 64.0, 2025.0]
            .map(|x: f64| (x, 3.0 * x.powf(0.62)))
            .to_vec();
        let law = PowerLaw::fit(&points).expect("four points");
        assert!((law.exponent - 0.62).abs() < 1e-12, "{law:?}");
        assert!((law.factor - 3.0).abs() < 1e-9, "{law:?}");
        assert!((law.r_squared - 1.0).abs() < 1e-9, "{law:?}");
        assert_eq!(law.points, 4, "zero has no logarithm");
        assert_eq!(
            law.in_words("frame time", "rays"),
            "frame time grows as rays^0.62"
        );
    }

    #[test]
    fn words_follow_the_fit() {
        let flat = PowerLaw::fit(&[(1.0, 5.0), (2.0, 5.0), (4.0, 5.0)]).expect("three points");
        assert_eq!(flat.in_words("it", "x"), "it does not depend on x");
        let falling = PowerLaw::fit(&[(1.0, 8.0), (2.0, 4.0), (4.0, 2.0)]).expect("three points");
        assert_eq!(falling.in_words("it", "x"), "it falls as x^−1.00");
        let bent = [(1.0, 1.0), (10.0, 9.0), (100.0, 1.2), (1000.0, 9.0)];
        let words = PowerLaw::fit(&bent).expect("points").in_words("it", "x");
        assert!(words.contains("roughly"), "{words}");
        assert_eq!(PowerLaw::fit(&[(1.0, 1.0), (2.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(PowerLaw::fit(&[]), None);
    }

    #[test]
    fn the_front_holds_the_unbeaten_points() {
        let points = [
            (0.10, 100.0),
            (0.05, 50.0),
            (0.08, 40.0),
            (0.05, 45.0),
            (0.20, 100.0),
            (0.20, 300.0),
            (f64::NAN, 1e9),
        ];
        assert_eq!(pareto_front(&points), [1, 0, 5]);
        assert!(pareto_front(&[]).is_empty());
    }
}
