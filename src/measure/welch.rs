//! Whether two samples differ: Welch's t-test, and the correction for many tests.

/// Two-sided probability that two samples with equal means differ at least as much as these (Welch
/// 1947). `None` for fewer than two values in a sample.
pub fn welch(a: &[f64], b: &[f64]) -> Option<f64> {
    let (a, b) = (Sample::of(a)?, Sample::of(b)?);
    let difference = b.mean - a.mean;
    let squared_error = a.squared_error + b.squared_error;
    if squared_error <= 0.0 {
        // Without any spread every difference is significant.
        return Some(if difference == 0.0 { 1.0 } else { 0.0 });
    }
    let t = difference / squared_error.sqrt();
    let parts =
        a.squared_error.powi(2) / (a.count - 1.0) + b.squared_error.powi(2) / (b.count - 1.0);
    Some(two_sided(t, squared_error.powi(2) / parts))
}

struct Sample {
    count: f64,
    mean: f64,
    /// Squared standard error of the mean.
    squared_error: f64,
}

impl Sample {
    fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (values.len() > 1).then(|| Self {
            count,
            mean,
            squared_error: squares / (count - 1.0) / count,
        })
    }
}

/// Probability that |T| is at least |t|, for Student's t with `freedom` degrees of freedom.
fn two_sided(t: f64, freedom: f64) -> f64 {
    incomplete_beta(freedom / (freedom + t * t), 0.5 * freedom, 0.5)
}

/// The regularised incomplete beta function, by its continued fraction (DLMF 8.17.22) with Lentz's algorithm.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // The fraction converges quickly only on this side.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let front = a * x.ln() + b * (1.0 - x).ln() + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b);
    let tiny = |value: f64| {
        if value.abs() < 1e-300 { 1e-300 } else { value }
    };
    let (mut c, mut d) = (1.0, 1.0 / tiny(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for step in 1..500 {
        let m = f64::from(step);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / tiny(1.0 + term * d);
            c = tiny(1.0 + term / c);
            fraction *= c * d;
        }
        if (fraction - before).abs() < 1e-15 * fraction.abs() {
            break;
        }
    }
    front.exp() * fraction / a
}

/// Logarithm of the gamma function for positive arguments: Stirling's series (DLMF 5.11.1), after the
/// recurrence has made the argument large.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut product) = (x, 1.0);
    while x < 12.0 {
        product *= x;
        x += 1.0;
    }
    let inverse = 1.0 / (x * x);
    let series =
        (1.0 / 12.0 - inverse * (1.0 / 360.0 - inverse * (1.0 / 1260.0 - inverse / 1680.0))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + series - product.ln()
}

/// Which of many tests are discoveries, such that at most a share `rate` of the discoveries is expected
/// to be chance (Benjamini & Hochberg 1995). `None` stands for a test that could not be made.
pub fn discoveries(probabilities: &[Option<f64>], rate: f64) -> Vec<bool> {
    let mut known: Vec<f64> = probabilities.iter().flatten().copied().collect();
    known.sort_by(f64::total_cmp);
    let count = known.len() as f64;
    let passes = |(rank, p): &(usize, &f64)| **p <= rate * (*rank as f64 + 1.0) / count;
    let threshold = known.iter().enumerate().rfind(passes);
    let threshold = threshold.map_or(f64::NEG_INFINITY, |(_, p)| *p);
    probabilities
        .iter()
        .map(|p| p.is_some_and(|p| p <= threshold))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tabled critical values of Student's t.
    #[test]
    fn probabilities_of_tabled_values() {
        for (t, freedom, p) in [
            (12.706, 1.0, 0.05),
            (2.776, 4.0, 0.05),
            (4.604, 4.0, 0.01),
            (2.228, 10.0, 0.05),
            (1.984, 100.0, 0.05),
            (0.0, 5.0, 1.0),
        ] {
            let found = two_sided(t, freedom);
            assert!((found / p - 1.0).abs() < 2e-3, "{t} {freedom}: {found}");
            assert_eq!(found, two_sided(-t, freedom));
        }
        // With one degree of freedom it is Cauchy's distribution.
        let exact = 1.0 - 2.0 / std::f64::consts::PI * 3f64.atan();
        assert!((two_sided(3.0, 1.0) - exact).abs() < 1e-12);
    }

    #[test]
    fn equal_samples_do_not_differ_and_shifted_ones_do() {
        let a = [1.0, 1.01, 0.99, 1.005, 0.995];
        assert!(welch(&a, &a).expect("values") > 0.999);
        let shifted = a.map(|value| 1.03 * value);
        assert!(welch(&a, &shifted).expect("values") < 1e-3);
        let barely = a.map(|value| 1.002 * value);
        assert!(welch(&a, &barely).expect("values") > 0.3);
        assert_eq!(welch(&[2.0; 3], &[2.0; 3]), Some(1.0));
        assert_eq!(welch(&[2.0; 3], &[2.5; 3]), Some(0.0));
        assert_eq!(welch(&[1.0], &a), None);
    }

    /// Welch's degrees of freedom: a sample without spread contributes none, so those of the other
    /// remain.
    #[test]
    fn unequal_spreads_are_allowed() {
        let a = [1.0, 2.0, 3.0, 4.0, 5.0];
        let t = 3.0 / 0.5f64.sqrt();
        let p = welch(&a, &[6.0; 4]).expect("values");
        assert!((p - two_sided(t, 4.0)).abs() < 1e-12);
    }

    #[test]
    fn many_tests_need_stronger_evidence() {
        // The one of 20 that is below 0.05 by chance does not count, a clear one does.
        let mut all = vec![Some(0.5); 19];
        all.push(Some(0.04));
        assert!(discoveries(&all, 0.05).iter().all(|found| !found));
        all.push(Some(1e-5));
        all.push(None);
        let found = discoveries(&all, 0.05);
        assert_eq!(found.iter().filter(|found| **found).count(), 1);
        assert!(found[20]);
        assert_eq!(discoveries(&[Some(0.04)], 0.05), [true]);
        assert!(discoveries(&[], 0.05).is_empty());
    }
}
