//! The furnace bound: an upper bound on the light that any surface of a world can send.
//!
//! Let M be the greatest radiance that leaves a surface, per channel. A surface sends its emission, its albedo
//! times the direct light over π, and its albedo times the mean incident radiance, which is at most M or the
//! sky: M ≤ e + ρ·(E/π + max(M, S)). So M ≤ max(S, (e + ρ·E/π)/(1 − ρ), e + ρ·(E/π + S)): the radiance of a
//! white furnace (Veach 1997, §8.3) whose walls all have the greatest emission, albedo and direct light of the
//! world. E is bounded by each lamp's intensity over its radius squared, because nothing is nearer than the
//! radius. For a sphere of radius R that is the irradiance of its own surface, and of every point inside of it: the
//! hemisphere of radiance I/(πR²).

use glam::{DVec3, Vec3};

use super::super::test_case::TestCase;
use crate::{
    lights::lamp::MIN_RADIUS,
    measure::picture::Picture,
    world::{Colour, Lamp, LampKind, Motion, World},
};

/// Estimates of light from emissive faces and from spheres are unbiased but noisy: single estimates may lie above the
/// mean. One ray into a hemisphere brings at most twice the mean.
const NOISE: f32 = 2.0;
/// Halves are rounded, and probes clamp to the largest half.
const ROUNDING: f32 = 1.01;
const MOST_HALF: f32 = 65504.0;

/// Upper bound of radiance per channel; `None` where an albedo of 1 leaves no bound below the largest half.
pub fn bound(case: &TestCase) -> Option<Vec3> {
    let world = &case.world;
    let mut direct = DVec3::ZERO;
    for lamp in &case.lamps.lamps {
        let turns = lamp
            .motion
            .iter()
            .any(|motion| matches!(motion, Motion::HueCycle { .. }));
        let colour = if turns {
            Vec3::splat(lamp.colour.max_element())
        } else {
            lamp.colour
        };
        let power = colour.as_dvec3() * f64::from(lamp.power);
        direct += match lamp.kind {
            LampKind::Directional { .. } => power,
            LampKind::Point | LampKind::Spot { .. } => {
                let radius = match lamp.is_sphere() {
                    true => f64::from(lamp.soft_radius),
                    false => f64::from(lamp.radius).max(MIN_RADIUS),
                };
                power / (4.0 * std::f64::consts::PI * radius * radius)
            }
        };
    }
    direct += world
        .sun
        .map_or(DVec3::ZERO, |sun| sun.irradiance.as_dvec3());
    let sky = world
        .sky
        .zenith
        .max(world.sky.horizon)
        .max(world.sky.ground)
        .as_dvec3();
    let albedo = most_albedo(world).as_dvec3();
    let emission = world
        .materials
        .iter()
        .fold(Vec3::ZERO, |most, of| most.max(of.emission));
    let own = emission.as_dvec3() + albedo * direct / std::f64::consts::PI;
    let closed = own / (DVec3::ONE - albedo);
    let open = own + albedo * sky;
    let bound = sky.max(closed).max(open).as_vec3();
    (bound.is_finite() && bound.max_element() * ROUNDING < MOST_HALF).then_some(bound)
}

pub fn most_albedo(world: &World) -> Vec3 {
    let of = |colour: &Colour| match colour {
        Colour::Flat(colour) => *colour,
        Colour::Bands { below, above } => below
            .iter()
            .fold(*above, |most, (_, colour)| most.max(*colour)),
        Colour::DitherX { low, high, .. } | Colour::Hash(low, high) => low.max(*high),
    };
    let materials = world.materials.iter();
    materials.fold(Vec3::ZERO, |most, material| {
        most.max(of(&material.a)).max(of(&material.b))
    })
}

/// The tolerance of the bound: larger if there are emissive faces or spheres, whose light is sampled at random.
fn slack(case: &TestCase) -> f32 {
    let shines = |emission: Vec3| emission.max_element() > 0.0;
    let mut materials = case.world.materials.iter();
    let noisy = materials.any(|material| shines(material.emission))
        || case.lamps.lamps.iter().any(Lamp::is_sphere);
    if noisy { ROUNDING * NOISE } else { ROUNDING }
}

/// Checks every pixel against the bound.
pub fn picture(what: &str, picture: &Picture, case: &TestCase) -> Result<(), String> {
    let Some(bound) = bound(case) else {
        return Ok(());
    };
    let most = bound * slack(case) + 1e-4;
    for (index, rgb) in picture.rgb.iter().enumerate() {
        if Vec3::from_array(*rgb).cmpgt(most).any() {
            let (x, y) = (index as u32 % picture.width, index as u32 / picture.width);
            return Err(format!(
                "{what}: {rgb:?} at pixel ({x}, {y}), and nothing in this world can send more than {bound}"
            ));
        }
    }
    Ok(())
}

/// The irradiance over π that probes store is a mean of radiances, so the same bound holds.
pub fn irradiance(texels: &[f32], case: &TestCase) -> Result<(), String> {
    let Some(bound) = bound(case) else {
        return Ok(());
    };
    let most = bound * slack(case) + 1e-4;
    for (index, texel) in texels.chunks_exact(3).enumerate() {
        let light = Vec3::new(texel[0], texel[1], texel[2]);
        if light.cmpgt(most).any() {
            return Err(format!(
                "the irradiance of probes: {light} in texel {index}, and nothing in this world can send more than {bound}"
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::file::{Overrides, parse};

    fn furnace(albedo: f32) -> TestCase {
        let text = format!(
            "(title: \"\", size: (8, 8, 8), shape: Empty, sky: (zenith: (0, 0, 0)), \
             materials: {{\"a\": (a: Flat({albedo}, {albedo}, {albedo}), emission: (1, 1, 1))}})"
        );
        let world = parse(&text, "furnace", None, &Overrides::default()).expect("sound");
        TestCase::of(world, &[], 0).expect("sound")
    }

    #[test]
    fn the_bound_is_the_radiance_of_a_furnace() {
        let bound = bound(&furnace(0.5)).expect("finite");
        assert!(
            (bound - Vec3::splat(2.0)).abs().max_element() < 1e-6,
            "{bound}"
        );
        assert!(super::bound(&furnace(1.0)).is_none());
    }

    #[test]
    fn a_sphere_lights_its_own_surface_most() {
        let of = |radius: &str| {
            let text = format!(
                "(title: \"\", size: (8, 8, 8), shape: Empty, sky: (zenith: (0, 0, 0)), \
                 materials: {{\"a\": (a: Flat(0.5, 0.5, 0.5))}}, \
                 lamps: [Preset(name: \"p\", lamps: [(position: (4, 4, 4), power: 16, {radius})])])"
            );
            let world = parse(&text, "sphere", None, &Overrides::default()).expect("sound");
            let case = TestCase::of(world, &[], 0).expect("sound");
            (bound(&case).expect("finite").x, slack(&case))
        };
        assert_eq!(of("soft_radius: 2"), (of("radius: 2").0, ROUNDING * NOISE));
        assert_eq!(of("soft_radius: 0.005, radius: 2"), of("radius: 2"));
    }

    #[test]
    fn more_than_the_bound_is_found() {
        let case = furnace(0.5);
        let of = |value| Picture {
            width: 1,
            height: 1,
            rgb: vec![[value; 3]],
        };
        assert_eq!(picture("it", &of(2.0), &case), Ok(()));
        assert!(picture("it", &of(4.1), &case).is_err());
        assert!(irradiance(&[0.0, 5.0, 0.0], &case).is_err());
    }
}
