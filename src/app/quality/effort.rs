//! Shares of a preset's work, as steps of one ladder.

use crate::{
    frame::{Smoothing, scaled},
    parameters::{PictureParameters, ProbeParameters, SCALES},
};

/// Shares of what a preset asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Of the edge length of the rendered picture.
    pub scale: f32,
    /// Of the rays of a probe, and of the rays that faces may send.
    pub rays: f32,
}

/// From everything downwards. A step changes one of the two, by so little that no step upwards multiplies the time of a
/// frame by more than [`Effort::DEAREST_STEP`]. Rays go first: noise is averaged away, pixels are not.
const LADDER: [Effort; 11] = [
    step(1.0, 1.0),
    step(1.0, 0.76),
    step(0.87, 0.76),
    step(0.87, 0.58),
    step(0.76, 0.58),
    step(0.76, 0.44),
    step(0.66, 0.44),
    step(0.66, 0.33),
    step(0.58, 0.33),
    step(0.58, 0.25),
    step(0.51, 0.25),
];

const fn step(scale: f32, rays: f32) -> Effort {
    Effort { scale, rays }
}

impl Effort {
    /// All that the preset asks for.
    pub const FULL: Self = LADDER[0];

    /// The step of least work.
    pub const LOWEST: usize = LADDER.len() - 1;

    /// Most that one step upwards multiplies the time of a frame by, if all of the time is for pixels or all for rays.
    pub const DEAREST_STEP: f64 = 1.34;

    /// The effort of a step, counted from 0 for everything.
    pub const fn of_step(step: usize) -> Self {
        LADDER[step]
    }

    /// The size of the shown picture for a chosen one, and how it is smoothed. The scale falls first; where it would be
    /// less than a history can fill, the shown picture becomes smaller, and is stretched.
    pub fn picture(
        self,
        chosen: [u32; 2],
        parameters: &PictureParameters,
    ) -> ([u32; 2], Smoothing) {
        let all = self.scale * parameters.scale;
        let scale = all.max(*SCALES.start());
        let smoothing = Smoothing {
            scale,
            ..parameters.into()
        };
        (scaled(chosen, all / scale), smoothing)
    }

    /// The parameters of the probes for chosen ones.
    pub fn probes(self, chosen: &ProbeParameters) -> ProbeParameters {
        ProbeParameters {
            ray_share: chosen.ray_share * self.rays,
            face_share: chosen.face_share * self.rays,
            ..chosen.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_small_and_change_one_thing() {
        for pair in LADDER.windows(2) {
            let [upper, lower] = pair else {
                unreachable!("pairs")
            };
            let pixels = f64::from(upper.scale / lower.scale).powi(2);
            let rays = f64::from(upper.rays / lower.rays);
            assert_eq!(pixels.min(rays), 1.0, "{lower:?}");
            let dearest = pixels.max(rays);
            assert!(
                dearest > 1.2 && dearest <= Effort::DEAREST_STEP,
                "{lower:?}: {dearest}"
            );
        }
    }

    #[test]
    fn the_full_effort_changes_nothing() {
        let probes = ProbeParameters::default();
        assert_eq!(Effort::FULL.probes(&probes), probes);
        let chosen = PictureParameters {
            scale: 0.6,
            ..Default::default()
        };
        let picture = Effort::FULL.picture([1281, 719], &chosen);
        assert_eq!(picture, ([1281, 719], (&chosen).into()));
    }

    #[test]
    fn the_scale_falls_before_the_shown_picture() {
        let chosen = PictureParameters::default();
        let of = |scale, chosen: &PictureParameters| {
            Effort { scale, rays: 1.0 }.picture([1000, 600], chosen)
        };
        let (size, smoothing) = of(0.76, &chosen);
        assert_eq!((size, smoothing.scale), ([1000, 600], 0.76));
        let halved = PictureParameters {
            scale: 0.5,
            ..chosen
        };
        let (size, smoothing) = of(0.6, &halved);
        assert_eq!((size, smoothing.scale), ([600, 360], 0.5));
    }

    #[test]
    fn no_picture_shrinks_to_nothing() {
        let least = Effort::of_step(Effort::LOWEST);
        let chosen = PictureParameters {
            scale: 0.5,
            ..Default::default()
        };
        assert_eq!(least.picture([1, 1], &chosen).0, [1, 1]);
        assert_eq!(least.picture([0, 0], &chosen).0, [1, 1]);
        let rays = least.probes(&ProbeParameters::default()).rays_per_update();
        assert_eq!(rays, 32);
    }
}
