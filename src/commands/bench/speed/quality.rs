//! The error of a row's light against the path-traced reference that the judge stores.

use std::{collections::BTreeMap, sync::atomic::AtomicBool};

use super::{
    super::{
        super::{
            Failure,
            judge::{
                cache::Cache,
                row::Target,
                truth::{Against, Film, Tracer},
            },
            options::RunOptions,
        },
        model::{Figure, Quality},
    },
    rig::Rig,
    spec::RowSpec,
};
use crate::{
    measure::{
        comparison::{Comparison, Shown, compare},
        picture::Picture,
        selection::Selection,
        stability::StabilityMeter,
    },
    world::View,
};

/// Frames from fresh probes to the judged picture, as in the judge's own tables.
const SETTLING: u32 = 300;
/// Longest edge of a judged picture.
const LONGEST_EDGE: u32 = 480;
/// Pictures over which stability is measured (the source's table 4.4).
const STILL_FRAMES: u32 = 50;

/// Where references come from, and their quality.
pub struct Judging<'a> {
    pub cache: &'a Cache,
    pub run: &'a RunOptions,
    pub stop: &'a AtomicBool,
    /// Paths per pixel.
    pub spp: u32,
    /// Settling frames in place of [`SETTLING`].
    pub settling: Option<u32>,
}

/// The size of a picture with the row's aspect that is not larger than the judge's.
fn judged_size([width, height]: [u32; 2]) -> [u32; 2] {
    let longest = width.max(height);
    if longest <= LONGEST_EDGE {
        return [width, height];
    }
    let scaled =
        |edge: u32| (u64::from(edge) * u64::from(LONGEST_EDGE) / u64::from(longest)) as u32;
    [scaled(width).max(1), scaled(height).max(1)]
}

/// One picture of the rig's present state, from settled probes.
fn settled(
    rig: &mut Rig<'_>,
    spec: &RowSpec,
    size: [u32; 2],
    view: View,
    frames: u32,
) -> Result<Picture, Failure> {
    rig.advance(spec, size, view, frames)?;
    Ok(rig.frame.read_radiance(rig.gpu)?)
}

impl Judging<'_> {
    fn frames(&self) -> u32 {
        self.settling.unwrap_or(SETTLING)
    }

    /// The reference for a spec's view at rest.
    fn target(&self, rig: &Rig<'_>, spec: &RowSpec, size: [u32; 2]) -> Result<Target, Failure> {
        let lights = rig.lights(spec, rig.time_s);
        let mut tracer = Tracer {
            world: &rig.scene.world,
            run: self.run,
            cache: self.cache,
            gpu: rig.gpu,
            against: Against::Reference,
            stop: self.stop,
            voxels: None,
        };
        let film = Film {
            camera: &spec.camera,
            lights: &lights,
            time_s: rig.time_s,
            edits: &[],
            size,
            spp: self.spp,
            seed: rig.seed,
            textures: spec.parameters.textures.enabled,
            antialias: !spec.smoothing().is_plain(),
        };
        let truth = tracer.truth(&film, &rig.frame.stage)?;
        Target::new(truth, spec.parameters.picture.exposure_ev)
    }

    /// FLIP and energy of the settled picture.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn quality(&self, rig: &mut Rig<'_>, spec: &RowSpec) -> Result<Quality, Failure> {
        let size = judged_size(spec.size);
        let target = self.target(rig, spec, size)?;
        let exposure_ev = spec.parameters.picture.exposure_ev;
        rig.prepare(spec, size)?;
        let full = settled(rig, spec, size, View::Full, self.frames() + 1)?;
        let bounced = settled(rig, spec, size, View::Indirect, 1)?;
        let [full, bounced] = [full, bounced].map(|light| Shown::from_linear(light, exposure_ev));
        let full = compared(&full, &target.full)?;
        let bounced = compared(&bounced, &target.indirect)?;
        Ok(Quality {
            flip: full.flip.mean,
            energy: Some(bounced.energy_ratio).filter(|energy| energy.is_finite()),
            spp: self.spp,
            size,
        })
    }

    /// The source's figures of error: the sum over RGB of the absolute difference of the displayed pictures.
    /// `view` is [`View::Direct`] for light without any probes.
    ///
    /// # Errors
    /// See [`quality`](Self::quality).
    pub fn errors(
        &self,
        rig: &mut Rig<'_>,
        spec: &RowSpec,
        view: View,
    ) -> Result<(BTreeMap<String, Figure>, Quality), Failure> {
        let size = judged_size(spec.size);
        let target = self.target(rig, spec, size)?;
        rig.prepare(spec, size)?;
        let light = settled(rig, spec, size, view, self.frames() + 1)?;
        let shown = Shown::from_linear(light, spec.parameters.picture.exposure_ev);
        let full = compared(&shown, &target.full)?;
        let quality = Quality {
            flip: full.flip.mean,
            energy: Some(full.energy_ratio).filter(|energy| energy.is_finite()),
            spp: self.spp,
            size,
        };
        let figures = [
            ("absolute_error_mean", full.abs_sum.mean),
            ("absolute_error_max", full.abs_sum.max),
            ("probe_bytes", rig.frame.memory().probes as f64),
        ];
        Ok((named(&figures), quality))
    }

    /// The mean and the greatest change of a pixel between frames of a scene at rest.
    ///
    /// # Errors
    /// See [`quality`](Self::quality).
    pub fn stability(
        &self,
        rig: &mut Rig<'_>,
        spec: &RowSpec,
    ) -> Result<BTreeMap<String, Figure>, Failure> {
        let size = judged_size(spec.size);
        rig.prepare(spec, size)?;
        rig.advance(spec, size, View::Full, self.frames())?;
        let mut meter = StabilityMeter::new();
        for _ in 0..STILL_FRAMES {
            rig.advance(spec, size, View::Full, 1)?;
            let display = rig.frame.read_display(rig.gpu)?;
            meter.add(display).map_err(Failure::fault)?;
        }
        let stability = meter.result().expect("more than one picture was measured");
        Ok(named(&[
            ("change_mean", stability.mean),
            ("change_max", stability.max),
        ]))
    }
}

fn compared(shown: &Shown, truth: &Shown) -> Result<Comparison, Failure> {
    let (figures, _) = compare(shown, truth, &Selection::ALL).map_err(Failure::fault)?;
    Ok(figures)
}

/// Figures that were measured once.
pub fn named(figures: &[(&str, f64)]) -> BTreeMap<String, Figure> {
    let figure = |value| Figure {
        value,
        half_width: None,
    };
    let named = figures.iter();
    named
        .map(|(name, value)| ((*name).to_owned(), figure(*value)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_judged_small_and_keep_their_shape() {
        assert_eq!(judged_size([1920, 1080]), [480, 270]);
        assert_eq!(judged_size([64, 36]), [64, 36]);
        assert_eq!(judged_size([16, 9000]), [1, 480]);
    }
}
