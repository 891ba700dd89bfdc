//! Light of a lamp that is a sphere: what arrives at a point if nothing is in the way.
//!
//! A sphere of radius R and intensity I radiates L = I / (πR²) from each point of its surface, in every direction: seen
//! from afar it is the point lamp of the same power. At distance d it fills a cone of half angle σ, sin σ = R/d.

use std::f64::consts::PI;

/// Share of a hemisphere of constant radiance, weighted by the cosine with a surface's normal, that a cone of directions
/// fills: irradiance = π · radiance · share. `cosine` is that of the angle between the normal and the cone's axis,
/// `sin_squared` is sin² of the cone's half angle, at most 1.
///
/// Snyder 1996, *Area Light Sources for Real-Time Graphics*, in the form of Lagarde & de Rousiers 2014, *Moving Frostbite to
/// Physically Based Rendering*, listing 9.
pub fn form_factor(cosine: f64, sin_squared: f64) -> f64 {
    // The whole cone lies above the horizon, or none of it does.
    if cosine * cosine >= sin_squared {
        return sin_squared * cosine.max(0.0);
    }
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    // cot σ, and the cosine of the turn from the cone's axis to where its edge meets the horizon.
    let cot = ((1.0 - sin_squared) / sin_squared).max(0.0).sqrt();
    let turn = (-cot * cosine / sine).clamp(-1.0, 1.0);
    let edge = sine * (1.0 - turn * turn).sqrt();
    let above = (cosine * turn.acos() - cot * edge) * sin_squared + edge.atan2(cot);
    (above / PI).max(0.0)
}

/// Irradiance of a sphere of intensity 1 and radius `radius` (voxels) whose centre is `distance` voxels away; `cosine` is
/// that of the angle between the surface's normal and the direction to the centre.
///
/// A point inside the sphere counts as one of its surface: it sees a hemisphere full of light.
pub fn irradiance(radius: f64, distance: f64, cosine: f64) -> f64 {
    let nearest = distance.max(radius);
    form_factor(cosine, (radius / nearest).powi(2)) / (radius * radius)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;

    /// The integral over the cone in small steps.
    fn summed(cosine: f64, sin_squared: f64) -> f64 {
        let (steps, turns) = (400, 400);
        let axis = DVec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
        let (side, up) = axis.any_orthonormal_pair();
        let most = 1.0 - (1.0 - sin_squared).sqrt();
        let mut sum = 0.0;
        for step in 0..steps {
            let height = 1.0 - most * (f64::from(step) + 0.5) / f64::from(steps);
            let radius = (1.0 - height * height).sqrt();
            for turn in 0..turns {
                let angle = 2.0 * PI * (f64::from(turn) + 0.5) / f64::from(turns);
                let direction = axis * height + (side * angle.cos() + up * angle.sin()) * radius;
                sum += direction.y.max(0.0);
            }
        }
        sum * 2.0 * most / f64::from(steps * turns)
    }

    #[test]
    fn the_closed_form_is_the_integral() {
        for sin_squared in [1e-4, 0.01, 0.2, 0.5, 0.9, 0.999, 1.0] {
            for degrees in [0.0f64, 20.0, 50.0, 80.0, 89.0, 90.0, 92.0, 120.0, 179.0] {
                let cosine = degrees.to_radians().cos();
                let (found, truth) = (
                    form_factor(cosine, sin_squared),
                    summed(cosine, sin_squared),
                );
                assert!(
                    (found - truth).abs() < 2e-4 * sin_squared.max(truth),
                    "{degrees}° from a cone of sin² {sin_squared}: {found}, not {truth}"
                );
            }
        }
    }

    /// Far away a sphere is a point, and inside it a wall is lit as by a whole hemisphere.
    #[test]
    fn its_ends_are_a_point_and_a_hemisphere() {
        assert!((irradiance(0.5, 10.0, 0.8) - 0.8 / 100.0).abs() < 1e-15);
        for distance in [0.0, 0.3, 2.0] {
            let facing = irradiance(2.0, distance, 1.0);
            assert!((facing - 0.25).abs() < 1e-12, "{facing} at {distance}");
            assert!((irradiance(2.0, distance, 0.0) - 0.125).abs() < 1e-12);
            assert!(irradiance(2.0, distance, -1.0).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn it_is_continuous_and_within_bounds(cosine in -1.0..1.0f64, sin_squared in 1e-6..1.0f64) {
            let share = form_factor(cosine, sin_squared);
            prop_assert!((0.0..=sin_squared * (1.0 + 1e-9)).contains(&share), "{share}");
            let beside = form_factor((cosine + 1e-6).min(1.0), sin_squared);
            prop_assert!((share - beside).abs() < 1e-3 * sin_squared.max(1e-3), "{share} {beside}");
            prop_assert!(beside >= share - 1e-12, "more towards the normal");
        }
    }
}
