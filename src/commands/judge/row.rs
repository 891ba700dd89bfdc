//! One row of the table: a camera's picture in one layout, judged against the reference.

use serde::{Deserialize, Serialize};

use super::{
    super::{
        Failure,
        dynamics::{self, Responses},
        frame_loop::FrameLoop,
        settings::Setting,
        test_case::TestCase,
    },
    cache::{Traced, Truth},
    motion::MotionRow,
};
use crate::{
    measure::{
        comparison::{Comparison, Shown, compare},
        picture::Picture,
        selection::Selection,
        stability::Stability,
    },
    parameters::Antialias,
    world::{Camera, View},
};

/// The measurements. Fields are in the order in which they are printed; numbers that are not finite become
/// `null`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub world: String,
    pub camera: String,
    pub layout: String,
    /// Values of the keys that vary.
    #[serde(skip_deserializing)]
    pub settings: Setting,
    /// Whether this is direct light without any probes: the worst acceptable result of DDGI.
    pub direct_alone: bool,
    /// Rays per probe and frame.
    pub rays: u32,
    pub hysteresis: f32,
    /// Frames before the pictures.
    pub frames: u32,
    /// All light, compared as by `grotto compare`: DDGI over reference.
    pub full: Comparison,
    /// Bounced light alone.
    pub indirect: Comparison,
    /// What the reference's noise adds to FLIP; `null` where that is not known.
    #[serde(default)]
    pub noise: Option<Noise>,
    /// Light that DDGI adds where the reference has none, over the light of the brightest camera;
    /// `null` where the reference has light everywhere.
    pub leak_ratio: Option<f64>,
    /// `null` if stability was left out.
    pub stability: Option<Stability>,
    /// `null` if the response was left out.
    pub response: Option<Responses>,
    /// Bytes of the probes on the adapter.
    pub probe_bytes: u64,
    /// Errors while things move; empty, and not printed, without `--motion`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<MotionRow>,
}

/// The pictures of a row, as a display shows them, and FLIP of each pixel.
pub struct Pictures {
    pub full: Shown,
    pub indirect: Shown,
    pub full_map: Vec<f32>,
    pub indirect_map: Vec<f32>,
}

/// Mean FLIP that a picture without any error would have against a reference, because of the reference's noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    pub full: f64,
    pub indirect: f64,
}

/// The reference of a camera, prepared for comparison.
pub struct Target {
    pub full: Shown,
    pub indirect: Shown,
    /// `None` where the reference has no halves.
    pub noise: Option<Noise>,
    /// Pixels that must stay dark.
    pub dark: Option<Dark>,
}

/// Pixels where the reference has no light, or that a mask marks.
pub struct Dark {
    pub pixels: Selection,
    /// Mean luminance for which the leak ratio is 1; above 0.
    pub bright: f64,
}

/// Smallest share of a picture's surfaces that counts as a dark place.
const LEAST_DARK: f64 = 0.01;

impl Target {
    /// # Errors
    /// When the reference's halves have not the size of the whole.
    pub fn new(truth: Truth, exposure_ev: f32) -> Result<Self, Failure> {
        let shown = |traced: Traced| {
            let full = Shown::from_linear(full(&traced), exposure_ev);
            (full, Shown::from_linear(traced.indirect, exposure_ev))
        };
        let (full, indirect) = shown(truth.whole);
        let flip = |half: &Shown, whole: &Shown| {
            let compared = compare(half, whole, &Selection::ALL).map_err(Failure::fault);
            compared.map(|(figures, _)| figures.flip.mean)
        };
        let noise = match truth.half {
            Some(half) => {
                let (half_full, half_indirect) = shown(half);
                Some(Noise {
                    full: flip(&half_full, &full)?,
                    indirect: flip(&half_indirect, &indirect)?,
                })
            }
            None => None,
        };
        Ok(Self {
            noise,
            full,
            indirect,
            dark: None,
        })
    }

    /// A mask of the surfaces where the reference has no light; `None` where they fill less than 1 % of the
    /// picture.
    pub fn unlit(&self, normals: &Picture) -> Option<Picture> {
        let black = |rgb: &[f32; 3]| *rgb == [0.0; 3];
        let pairs = self.full.linear.rgb.iter().zip(&normals.rgb);
        let unlit = |(light, normal)| {
            if black(light) && !black(normal) {
                1.0
            } else {
                0.0
            }
        };
        let mask: Vec<[f32; 3]> = pairs.map(|pair| [unlit(pair); 3]).collect();
        let count = mask.iter().filter(|rgb| !black(rgb)).count();
        (count as f64 >= LEAST_DARK * mask.len() as f64).then_some(Picture {
            rgb: mask,
            ..*normals
        })
    }
}

/// The sum of a reference's direct and indirect light.
pub fn full(truth: &Traced) -> Picture {
    let pixels = truth.direct.rgb.iter().zip(&truth.indirect.rgb);
    Picture {
        rgb: pixels
            .map(|(a, b)| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
            .collect(),
        ..truth.direct
    }
}

/// Mean luminance (Rec. 709) of the selected pixels.
pub fn luminance(picture: &Picture, selection: &Selection) -> f64 {
    let chosen = selection.of(&picture.rgb);
    let sum: f64 = chosen
        .iter()
        .map(|&[r, g, b]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b))
        .sum();
    sum / chosen.len().max(1) as f64
}

/// What to measure besides the pictures.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Frames before the pictures.
    pub frames: u32,
    pub stability: bool,
    /// Frames to watch after each change; `None` leaves the response out.
    pub watched: Option<u32>,
}

impl Plan {
    /// Frames of one row, for progress.
    pub fn length(&self) -> u64 {
        let still = if self.stability {
            u64::from(dynamics::STILL_FRAMES)
        } else {
            0
        };
        let response = |watched| Responses::frames(self.frames, watched);
        u64::from(self.frames) + 2 + still + self.watched.map_or(0, response)
    }
}

/// The world, camera, layout and settings of a row.
pub struct Names<'a> {
    pub case: &'a TestCase,
    pub camera: &'a Camera,
    pub layout: &'a str,
    pub settings: &'a Setting,
}

/// The layout of rows without probes.
const NO_LAYOUT: &str = "direct light alone";

/// Measures a row; the frame loop must have fresh probes. The pictures are rounded to the precision of the
/// adapter's f16.
pub fn judge(
    frame_loop: &mut FrameLoop<'_>,
    names: &Names<'_>,
    target: &Target,
    plan: &Plan,
    after: &dyn Fn(),
) -> Result<(Row, Pictures), Failure> {
    let lights = &names.case.lights;
    let size = frame_loop.shot().size;
    let exposure_ev = frame_loop.shot().exposure_ev;
    frame_loop.look(names.camera, View::Full);
    frame_loop.advance(lights, plan.frames + 1, after)?;
    let full = Shown::from_linear(frame_loop.radiance()?, exposure_ev);
    let stability = plan
        .stability
        .then(|| dynamics::stability(frame_loop, lights, after))
        .transpose()?;
    frame_loop.look(names.camera, View::Indirect);
    frame_loop.advance(lights, 1, after)?;
    frame_loop.smooth()?;
    let indirect = Shown::from_linear(frame_loop.radiance()?, exposure_ev);
    let (rays, hysteresis) = (frame_loop.rays(), frame_loop.hysteresis());
    let probe_bytes = frame_loop.probe_bytes();
    let response = match plan.watched {
        Some(watched) => {
            let frames = [plan.frames, watched];
            // They are about light, not about edges.
            let antialias = frame_loop.antialias(Antialias::Off)?;
            let all = dynamics::responses(frame_loop, names.case, names.camera, frames, after)?;
            frame_loop.resize(size)?;
            frame_loop.antialias(antialias)?;
            Some(all)
        }
        None => None,
    };
    let (row, pictures) = compared(names, full, indirect, target)?;
    let row = Row {
        rays,
        hysteresis,
        frames: plan.frames,
        stability,
        response,
        probe_bytes,
        ..row
    };
    Ok((row, pictures))
}

/// A row without probes: direct light, and no bounced light at all.
pub fn direct_alone(
    frame_loop: &mut FrameLoop<'_>,
    names: &Names<'_>,
    target: &Target,
) -> Result<(Row, Pictures), Failure> {
    let exposure_ev = frame_loop.shot().exposure_ev;
    frame_loop.look(names.camera, View::Direct);
    frame_loop.advance(&names.case.lights, 1, &|| {})?;
    frame_loop.smooth()?;
    let direct = frame_loop.radiance()?;
    let dark = Picture::new(direct.width, direct.height);
    let [full, indirect] = [direct, dark].map(|light| Shown::from_linear(light, exposure_ev));
    let (row, pictures) = compared(names, full, indirect, target)?;
    let row = Row {
        layout: NO_LAYOUT.to_owned(),
        direct_alone: true,
        ..row
    };
    Ok((row, pictures))
}

/// The figures of two pictures; all other figures are left empty.
fn compared(
    names: &Names<'_>,
    full: Shown,
    indirect: Shown,
    target: &Target,
) -> Result<(Row, Pictures), Failure> {
    let everywhere = Selection::ALL;
    let (full_figures, full_map) =
        compare(&full, &target.full, &everywhere).map_err(Failure::fault)?;
    let (indirect_figures, indirect_map) =
        compare(&indirect, &target.indirect, &everywhere).map_err(Failure::fault)?;
    let leak = |dark: &Dark| {
        let added =
            luminance(&full.linear, &dark.pixels) - luminance(&target.full.linear, &dark.pixels);
        added / dark.bright
    };
    let row = Row {
        world: names.case.world.name.clone(),
        camera: names.camera.name.clone(),
        layout: names.layout.to_owned(),
        settings: names.settings.clone(),
        direct_alone: false,
        rays: 0,
        hysteresis: 0.0,
        frames: 0,
        full: full_figures,
        indirect: indirect_figures,
        noise: target.noise,
        leak_ratio: target.dark.as_ref().map(leak),
        stability: None,
        response: None,
        probe_bytes: 0,
        motion: Vec::new(),
    };
    let pictures = Pictures {
        full,
        indirect,
        full_map,
        indirect_map,
    };
    Ok((row, pictures))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(rgb: &[[f32; 3]]) -> Picture {
        Picture {
            width: rgb.len() as u32,
            height: 1,
            rgb: rgb.to_vec(),
        }
    }

    #[test]
    fn luminance_of_known_pixels() {
        let picture = picture(&[[1.0; 3], [0.0, 2.0, 0.0], [9.0; 3]]);
        let first_two = Selection::region([3, 1], [0, 0, 2, 1]).expect("inside");
        let expected = (1.0 + 2.0 * 0.7152) / 2.0;
        assert!((luminance(&picture, &first_two) - expected).abs() < 1e-9);
    }

    #[test]
    fn only_surfaces_without_any_light_are_dark() {
        let black = picture(&[[0.0; 3]; 4]);
        let truth = Truth {
            whole: Traced {
                direct: picture(&[[0.0; 3], [0.5; 3], [0.0; 3], [0.0; 3]]),
                indirect: picture(&[[0.0; 3], [0.0; 3], [0.0, 1e-6, 0.0], [0.0; 3]]),
            },
            half: None,
        };
        // Pixels: lit, lit by a bounce, unlit, and beyond all surfaces.
        let normals = picture(&[[0.5, 1.0, 0.5], [0.5; 3], [0.5; 3], [0.0; 3]]);
        let target = Target::new(truth, 0.0).expect("one size");
        let mask = target.unlit(&normals).expect("one of four is enough");
        assert_eq!(mask, picture(&[[1.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]]));
        assert_eq!(target.unlit(&black), None, "the sky does not count");
    }
}
