//! The sky: a gradient by the elevation of a direction.

use glam::DVec3;

use crate::world::Sky;

crate::shared! {
    in lights;

    /// How far below the horizon (as the sine of the angle) the ground's colour is reached.
    pub const GROUND_EDGE: f64 = 0.125;
}

/// Radiance (linear RGB) that arrives along a ray which left the world in this unit direction.
///
/// Above the horizon the colour turns from horizon to zenith as 1 − (1 − y)³, so that the pale rim
/// stays low, as in a clear sky; below the horizon it turns smoothly into the ground. Continuous
/// everywhere.
pub fn radiance(sky: &Sky, direction_ws: DVec3) -> DVec3 {
    let y = direction_ws.y;
    let horizon = sky.horizon.as_dvec3();
    if y >= 0.0 {
        horizon.lerp(sky.zenith.as_dvec3(), 1.0 - (1.0 - y.min(1.0)).powi(3))
    } else {
        let t = (-y / GROUND_EDGE).min(1.0);
        horizon.lerp(sky.ground.as_dvec3(), t * t * (3.0 - 2.0 * t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const SKY: Sky = Sky {
        zenith: Vec3::new(0.1, 0.3, 1.0),
        horizon: Vec3::ONE,
        ground: Vec3::new(0.2, 0.1, 0.0),
    };

    fn at(y: f64) -> DVec3 {
        radiance(&SKY, DVec3::new((1.0 - y * y).max(0.0).sqrt(), y, 0.0))
    }

    #[test]
    fn zenith_horizon_and_ground_are_where_they_belong() {
        assert!((at(1.0) - SKY.zenith.as_dvec3()).length() < 1e-12);
        assert_eq!(at(0.0), SKY.horizon.as_dvec3());
        assert!((at(-1.0) - SKY.ground.as_dvec3()).length() < 1e-12);
    }

    #[test]
    fn the_gradient_is_continuous_and_stays_between_its_colours() {
        let lowest = SKY.zenith.min(SKY.horizon).min(SKY.ground).as_dvec3();
        let highest = SKY.zenith.max(SKY.horizon).max(SKY.ground).as_dvec3();
        let mut last = at(-1.0);
        for step in -1999..=2000 {
            let next = at(f64::from(step) / 2000.0);
            assert!(
                (next - last).length() < 0.01,
                "jump at y = {}",
                f64::from(step) / 2000.0
            );
            assert!(next.cmpge(lowest - 1e-9).all() && next.cmple(highest + 1e-9).all());
            last = next;
        }
    }

    #[test]
    fn a_uniform_sky_is_uniform() {
        let sky = Sky {
            zenith: Vec3::ONE,
            horizon: Vec3::ONE,
            ground: Vec3::ONE,
        };
        for y in [-1.0, -0.05, 0.0, 0.3, 1.0] {
            let radiance = radiance(&sky, DVec3::new(0.0, y, 0.0));
            assert!((radiance - DVec3::ONE).length() < 1e-12);
        }
    }
}
