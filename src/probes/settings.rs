//! What can be tuned about the probes.

use super::ProbeError;

/// How a gather tells whether a probe sees the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Visibility {
    /// Not at all: cheapest, and light leaks through walls.
    None,
    /// By the mean and variance of the probe's distances (Majercik et al. 2019).
    #[default]
    Chebyshev,
}

impl std::str::FromStr for Visibility {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "none" => Ok(Self::None),
            "chebyshev" => Ok(Self::Chebyshev),
            "exact" => {
                Err("`exact` visibility is not available yet; use `none` or `chebyshev`".into())
            }
            other => Err(format!(
                "`{other}` is no visibility; use `none` or `chebyshev`"
            )),
        }
    }
}

/// What becomes of a distance that is longer than the clamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LongRays {
    /// It counts as the clamp: the mean says "far".
    #[default]
    Clamp,
    /// It is left out: the mean is that of what is near.
    Reject,
}

impl std::str::FromStr for LongRays {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "clamp" => Ok(Self::Clamp),
            "reject" => Ok(Self::Reject),
            other => Err(format!(
                "`{other}` is no way to treat long rays; use `clamp` or `reject`"
            )),
        }
    }
}

/// Every tunable of the probes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeSettings {
    /// Rays per probe and frame. More are steadier and settle sooner; the cost of `probe_rays` and
    /// `probe_blend` is proportional.
    pub rays: u32,
    /// Share of history kept per update, 0..1. Higher is steadier; lower reacts sooner.
    pub hysteresis: f32,
    /// Updates in which a new probe's history is replaced, not blended: light gains one bounce in
    /// each. More carry bright surfaces farther; fewer settle sooner.
    pub warmup_frames: u32,
    /// What keeps light from passing walls. `chebyshev` costs eight texture reads a gather.
    pub visibility: Visibility,
    /// Texels along an irradiance map. More keep sharper changes with direction; memory and blend
    /// time grow with the square.
    pub irradiance_texels: u32,
    /// Texels along a distance map. More tell corners apart better; memory and blend time grow with
    /// the square.
    pub distance_texels: u32,
    /// Exponent of the lobe that averages distances. Higher is sharper; lower is steadier.
    pub distance_exponent: f32,
    /// Longest distance kept, in diagonals of a cage. Higher keeps far walls; lower keeps more
    /// precision and less variance near edges.
    pub distance_clamp: f32,
    /// What becomes of longer ones.
    pub long_rays: LongRays,
    /// How far a gather steps off the surface along its normal (voxels). Higher avoids
    /// self-shadowing; lower avoids leaks at thin walls.
    pub normal_bias: f32,
    /// How far a gather steps towards the viewer (voxels), with `chebyshev` only. Higher avoids
    /// self-shadowing at grazing angles; lower depends less on the viewer.
    pub view_bias: f32,
    /// Added to the squared wrap weight. 0 ignores probes behind the surface; 0.2 is smoother and
    /// leaks.
    pub wrap_offset: f32,
    /// Weights below this fall off with their cube. Higher hides faint leaks; lower keeps gradients
    /// smooth. 0: never.
    pub crush: f32,
    /// Exponent of the Chebyshev bound. Higher leaks less; lower shadows less.
    pub chebyshev_power: f32,
    /// Least visibility of any probe. Higher avoids black spots; 0 leaks least.
    pub chebyshev_floor: f32,
    /// Weight of a cage below which its light fades to none, so that where every probe is hidden
    /// nothing is gathered. Higher leaks less in sealed rooms; lower keeps light in tight corners.
    pub least_weight: f32,
    /// Relative change of a texel that lowers its hysteresis. Lower reacts to less.
    pub change_lower: f32,
    /// By how much. Higher reacts sooner and is noisier while light changes.
    pub change_lower_by: f32,
    /// Relative change of a texel that resets its history. Lower reacts to less.
    pub change_reset: f32,
    /// Standard deviations of its own noise that a change must exceed to count as one. Higher is
    /// steadier at few rays; 0 takes all noise for change.
    pub change_deviations: f32,
    /// Most luminance of a ray in multiples of the probe's mean. Lower is steadier but loses the
    /// energy of small bright things; 0: no limit.
    pub firefly_clamp: f32,
}

impl Default for ProbeSettings {
    fn default() -> Self {
        Self {
            rays: 400,
            hysteresis: 0.97,
            warmup_frames: 40,
            visibility: Visibility::Chebyshev,
            irradiance_texels: 8,
            distance_texels: 16,
            distance_exponent: 50.0,
            distance_clamp: 1.5,
            long_rays: LongRays::Clamp,
            normal_bias: 0.3,
            view_bias: 0.1,
            wrap_offset: 0.0,
            crush: 0.2,
            chebyshev_power: 3.0,
            chebyshev_floor: 0.0,
            least_weight: 1e-4,
            change_lower: 0.25,
            change_lower_by: 0.15,
            change_reset: 0.8,
            change_deviations: 3.0,
            firefly_clamp: 0.0,
        }
    }
}

impl ProbeSettings {
    /// # Errors
    /// [`ProbeError::Setting`] names the first value out of its range.
    pub fn check(&self) -> Result<(), ProbeError> {
        let whole = |key, value: u32, low: u32, high: u32, range| {
            inside(
                key,
                f64::from(value),
                f64::from(low),
                f64::from(high),
                range,
            )
        };
        let real = |key, value: f32, low: f64, high: f64, range| {
            inside(key, f64::from(value), low, high, range)
        };
        whole("probes.rays", self.rays, 1, 16384, "1..16384")?;
        real(
            "probes.hysteresis",
            self.hysteresis,
            0.0,
            0.9999,
            "0..0.9999",
        )?;
        whole(
            "probes.warmup_frames",
            self.warmup_frames,
            0,
            10_000,
            "0..10000",
        )?;
        whole(
            "probes.irradiance_texels",
            self.irradiance_texels,
            2,
            64,
            "2..64",
        )?;
        whole(
            "probes.distance_texels",
            self.distance_texels,
            2,
            64,
            "2..64",
        )?;
        real(
            "probes.distance_exponent",
            self.distance_exponent,
            1.0,
            1000.0,
            "1..1000",
        )?;
        real(
            "probes.distance_clamp",
            self.distance_clamp,
            1.0,
            100.0,
            "1..100",
        )?;
        real("probes.normal_bias", self.normal_bias, 0.0, 10.0, "0..10")?;
        real("probes.view_bias", self.view_bias, 0.0, 10.0, "0..10")?;
        real("probes.wrap_offset", self.wrap_offset, 0.0, 1.0, "0..1")?;
        real("probes.crush", self.crush, 0.0, 1.0, "0..1")?;
        real(
            "probes.chebyshev_power",
            self.chebyshev_power,
            1.0,
            20.0,
            "1..20",
        )?;
        real(
            "probes.chebyshev_floor",
            self.chebyshev_floor,
            0.0,
            1.0,
            "0..1",
        )?;
        real(
            "probes.least_weight",
            self.least_weight,
            1e-12,
            1.0,
            "1e-12..1",
        )?;
        real("probes.change_lower", self.change_lower, 0.0, 1e6, "0..1e6")?;
        real(
            "probes.change_lower_by",
            self.change_lower_by,
            0.0,
            1.0,
            "0..1",
        )?;
        real("probes.change_reset", self.change_reset, 0.0, 1e6, "0..1e6")?;
        real(
            "probes.change_deviations",
            self.change_deviations,
            0.0,
            100.0,
            "0..100",
        )?;
        real(
            "probes.firefly_clamp",
            self.firefly_clamp,
            0.0,
            1e6,
            "0..1e6",
        )
    }
}

fn inside(
    key: &'static str,
    value: f64,
    low: f64,
    high: f64,
    range: &'static str,
) -> Result<(), ProbeError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(ProbeError::Setting { key, range, value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_in_range_and_faults_are_named() {
        ProbeSettings::default().check().expect("defaults are good");
        let bad = ProbeSettings {
            hysteresis: f32::NAN,
            ..Default::default()
        };
        let error = bad.check().expect_err("not a number").to_string();
        assert!(
            error.contains("probes.hysteresis") && error.contains("0..0.9999"),
            "{error}"
        );
    }

    #[test]
    fn exact_visibility_is_refused_with_a_reason() {
        let error = "exact".parse::<Visibility>().expect_err("not yet");
        assert!(error.contains("not available yet"), "{error}");
        assert_eq!("chebyshev".parse(), Ok(Visibility::Chebyshev));
    }
}
