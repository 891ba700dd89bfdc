//! Colours of whole voxels. `shaders/scene/albedo.wesl` evaluates the same on the GPU.

use glam::{IVec3, Vec3};

use super::Colour;
use super::hash::{hash_voxel, unit};

impl Colour {
    /// The colour of a world-space voxel, by the height and x of its centre.
    ///
    /// `detail` in [0, 1] is the visible share of the variation from voxel to voxel: at 0 dithers are
    /// replaced by their average, so that they do not shimmer in the distance.
    pub fn at(&self, voxel: IVec3, detail: f32) -> Vec3 {
        let random = || unit(hash_voxel(voxel));
        match self {
            Self::Flat(colour) => *colour,
            Self::Bands { below, above } => {
                let y = voxel.y as f32 + 0.5;
                below
                    .iter()
                    .find(|(height, _)| y < *height)
                    .map_or(*above, |&(_, colour)| colour)
            }
            Self::DitherX {
                from,
                to,
                low,
                high,
            } => {
                let share = share_of_high(voxel.x as f32 + 0.5, *from, *to);
                let dither = if random() < share { 1.0 } else { 0.0 };
                low.lerp(*high, share + (dither - share) * detail)
            }
            Self::Hash(low, high) => low.lerp(*high, 0.5 + (random() - 0.5) * detail),
        }
    }
}

fn share_of_high(x: f32, from: f32, to: f32) -> f32 {
    if x >= to {
        1.0
    } else if x < from {
        0.0
    } else {
        (x - from) / (to - from)
    }
}

/// Visible share of a voxel-sized variation if a ray's footprint is `footprint` voxels wide: all up to
/// half a voxel, none from two.
pub fn voxel_detail(footprint: f32) -> f32 {
    let t = ((footprint - 0.5) / 1.5).clamp(0.0, 1.0);
    1.0 - t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOW: Vec3 = Vec3::new(0.2, 0.0, 0.1);
    const HIGH: Vec3 = Vec3::new(0.0, 0.6, 1.0);

    #[test]
    fn bands_change_at_their_heights() {
        let bands = Colour::Bands {
            below: vec![(-8.0, Vec3::X), (0.0, Vec3::Y)],
            above: Vec3::Z,
        };
        let at = |y: i32| bands.at(IVec3::new(3, y, 4), 1.0);
        assert_eq!(
            [at(-9), at(-8), at(-1), at(0), at(99)],
            [Vec3::X, Vec3::Y, Vec3::Y, Vec3::Z, Vec3::Z]
        );
    }

    #[test]
    fn a_dither_is_pure_at_its_ends_and_mixed_in_proportion_between() {
        let dither = Colour::DitherX {
            from: -1.0,
            to: 7.0,
            low: LOW,
            high: HIGH,
        };
        let share = |x: i32| {
            let colours = (0..4096).map(|i| dither.at(IVec3::new(x, i % 64, i / 64), 1.0));
            colours.filter(|colour| *colour == HIGH).count() as f32 / 4096.0
        };
        assert_eq!(share(-2), 0.0);
        assert_eq!(share(7), 1.0);
        for x in -1..7 {
            let expected = (x as f32 + 1.5) / 8.0;
            assert!(
                (share(x) - expected).abs() < 0.03,
                "{} instead of {expected} at {x}",
                share(x)
            );
        }
    }

    #[test]
    fn a_dither_without_width_is_a_step() {
        let step = Colour::DitherX {
            from: 2.0,
            to: 2.0,
            low: LOW,
            high: HIGH,
        };
        assert_eq!(step.at(IVec3::new(1, 0, 0), 1.0), LOW);
        assert_eq!(step.at(IVec3::new(2, 0, 0), 1.0), HIGH);
    }

    /// Without detail every voxel has the average colour of the voxels with detail.
    #[test]
    fn the_average_over_voxels_is_the_colour_without_detail() {
        for colour in [
            Colour::Hash(LOW, HIGH),
            Colour::DitherX {
                from: -5.0,
                to: 9.0,
                low: LOW,
                high: HIGH,
            },
            Colour::Flat(HIGH),
        ] {
            let voxel = |i: i32| IVec3::new(2, i % 64, i / 64);
            let mean = (0..4096).map(|i| colour.at(voxel(i), 1.0)).sum::<Vec3>() / 4096.0;
            let flat = colour.at(voxel(0), 0.0);
            assert!(
                (mean - flat).length() < 0.02,
                "{colour:?}: {mean} and {flat}"
            );
        }
    }

    #[test]
    fn detail_fades_as_voxels_shrink_below_a_pixel() {
        assert_eq!(voxel_detail(0.0), 1.0);
        assert_eq!(voxel_detail(0.5), 1.0);
        assert_eq!(voxel_detail(2.0), 0.0);
        assert!(voxel_detail(1.0) > voxel_detail(1.1));
    }
}
