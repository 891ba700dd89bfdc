//! Points of a lamp that is a sphere, at random.
//!
//! Directions are uniform over the solid angle that the sphere fills as seen from the lit point (Shirley, Wang &
//! Zimmerman 1996, *Monte Carlo Techniques for Direct Lighting Calculations*, section on spherical luminaires).

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::random::Pcg;

/// A direction from a point towards a sphere.
#[derive(Clone, Copy, Debug)]
pub struct SphereSample {
    /// Unit vector.
    pub towards: DVec3,
    /// Distance to the sphere's surface in that direction; 0 from inside.
    pub distance: f64,
    /// What the sample stands for on a surface that faces this direction, per radiant intensity of the sphere: radiance
    /// over probability density.
    pub weight: f64,
}

/// Samples a sphere whose centre is `offset` away from the lit point. A point inside the sphere counts as one of its
/// surface, straight out from the centre; at the centre itself, `facing` says where out is.
pub fn sample(offset: DVec3, radius: f64, facing: DVec3, random: &mut Pcg) -> SphereSample {
    let centre_distance = offset.length();
    let axis = offset.try_normalize().unwrap_or(facing);
    let sine = (radius / centre_distance.max(radius)).min(1.0);
    // The cone's height as a share of the unit sphere: 1 − cos of the half angle.
    let depth = 1.0 - (1.0 - sine * sine).sqrt();
    let cosine = 1.0 - random.unit() * depth;
    let angle = TAU * random.unit();
    let around = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (u, v) = axis.any_orthonormal_pair();
    let towards = axis * cosine + (u * angle.cos() + v * angle.sin()) * around;
    // The nearer root of |t · towards − offset|² = radius².
    let half = towards.dot(offset);
    let inner = (half * half - offset.length_squared() + radius * radius).max(0.0);
    SphereSample {
        towards,
        distance: (half - inner.sqrt()).max(0.0),
        weight: TAU * depth / (PI * radius * radius),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{lights::sphere, measure::statistics::MeanEstimate};

    /// The mean of the samples is the closed form, above, across and below the horizon, outside and inside of the sphere.
    #[test]
    fn samples_add_up_to_the_closed_form() {
        for (distance, radius) in [(9.0, 0.5), (3.0, 1.5), (1.1, 1.0), (0.4, 1.0), (0.0, 1.0)] {
            for degrees in [0.0f64, 60.0, 85.0, 95.0, 130.0] {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let offset = DVec3::new(sine, cosine, 0.0) * distance;
                let mut random = Pcg::new(3, 1, degrees as u64);
                let light = (0..40_000).map(|_| {
                    let sample = sample(offset, radius, DVec3::Y, &mut random);
                    sample.weight * sample.towards.y.max(0.0)
                });
                let mean = MeanEstimate::of(light).expect("samples");
                let cosine = if distance == 0.0 { 1.0 } else { cosine };
                let truth = sphere::irradiance(radius, distance, cosine);
                assert!(
                    mean.agrees_with(truth, 4.0, 1e-9),
                    "{degrees}° at {distance}, radius {radius}: {mean:?}, not {truth}"
                );
            }
        }
    }

    #[test]
    fn rays_end_on_the_sphere() {
        let offset = DVec3::new(2.0, 3.0, -1.0);
        let mut random = Pcg::new(1, 2, 3);
        for _ in 0..1000 {
            let ray = sample(offset, 1.2, DVec3::Y, &mut random);
            let end = ray.towards * ray.distance;
            assert!((end.distance(offset) - 1.2).abs() < 1e-6, "{end}");
            assert!(
                end.dot(offset) < offset.length_squared(),
                "on the near side"
            );
        }
    }
}
