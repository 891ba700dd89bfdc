//! The picture against a short path-traced reference at the same world time.

use std::sync::atomic::AtomicBool;

use super::super::play::{Play, SIZE};
use super::{darkness::Darkness, energy};
use crate::{
    commands::Failure,
    frame::{TraceRequest, trace},
    measure::picture::Picture,
    world::{LayoutSpec, View, World},
};

/// Paths per pixel: with these, the mean over nearly every picture is known to a few per cent.
pub const SAMPLES: u32 = 32;
/// Paths per pixel for a picture that fails: where few paths bring most of the light, those above may have found none of them.
pub const MANY_SAMPLES: u32 = 4096;
/// Largest ratio of the mean luminance of a picture to that of the reference, in either direction. The band is
/// wide because the layouts are random and may be very bad: one probe may have to light a whole world.
const BAND: f64 = 4.0;
/// Mean luminance below which a picture is too dark for a comparison: a few samples decide it.
const LEAST: f64 = 2e-3;
/// Above this albedo light needs more frames to settle than a scene has.
const MOST_ALBEDO: f32 = 0.9;

/// The picture of the play's last shot with `spp` paths per pixel.
///
/// # Errors
/// When the adapter fails.
pub fn traced(play: &Play<'_>, spp: u32) -> Result<Picture, Failure> {
    let request = TraceRequest {
        camera: &play.shot.camera,
        size: SIZE,
        view: View::Full,
        spp,
        seed: 1,
        time_s: play.shot.time_s,
        textures: play.shot.textures,
        antialias: false,
    };
    let never = AtomicBool::new(false);
    let traced = trace(
        play.gpu,
        &play.frame.stage,
        &play.lights(),
        &request,
        &|_, _| {},
        &never,
    )?;
    Ok(traced.picture)
}

fn mean(picture: &Picture) -> f64 {
    let luminance = |rgb: &[f32; 3]| {
        0.2126 * f64::from(rgb[0]) + 0.7152 * f64::from(rgb[1]) + 0.0722 * f64::from(rgb[2])
    };
    picture.rgb.iter().map(luminance).sum::<f64>() / picture.rgb.len() as f64
}

/// Whether the probes of a layout cover the whole world.
fn covers(layout: &LayoutSpec, world: &World) -> bool {
    let half = world.size.as_vec3() / 2.0;
    let off = (layout.centre - world.origin.as_vec3() - half).abs();
    let reach = (layout.counts.as_vec3() * 0.5) * layout.spacing;
    !layout.follow && (off + half).cmple(reach * 1.01).all()
}

/// Compares the mean of the picture with that of the reference. `None` where the two cannot be compared.
pub fn band(play: &Play<'_>, shown: &Picture, truth: &Picture) -> Option<Result<(), String>> {
    let case = play.case;
    if energy::most_albedo(&case.world).max_element() > MOST_ALBEDO {
        return None;
    }
    let (shown, truth) = (mean(shown), mean(truth));
    if shown.max(truth) < LEAST {
        return None;
    }
    let verdict = |is_fine: bool| {
        let message = || {
            format!(
                "mean luminance {shown:.4}, and {truth:.4} in the reference: more than {BAND} times as {}",
                if shown > truth { "bright" } else { "dark" }
            )
        };
        Some(if is_fine { Ok(()) } else { Err(message()) })
    };
    if shown > truth {
        return verdict(shown <= BAND * truth);
    }
    // Where there are no probes, there may be no light.
    covers(&case.layout, &case.world)
        .then(|| verdict(shown * BAND >= truth))
        .flatten()
}

/// The reference itself must be dark where no light can arrive.
pub fn is_dark(darkness: &Darkness, truth: &Picture) -> Result<(), String> {
    darkness
        .light_in(truth)
        .map_err(|message| format!("the reference has {message}"))
}
