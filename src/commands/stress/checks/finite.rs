//! No NaN, no infinity and no negative light in any buffer of light, tested by bits.

use super::super::play::Play;
use crate::{
    commands::Failure,
    measure::picture::Picture,
    passes::surface_cache::{GpuFaceHistory, GpuFaceQuadrant},
};

/// Checks the linear light of a picture.
pub fn picture(what: &str, picture: &Picture) -> Result<(), String> {
    for (index, rgb) in picture.rgb.iter().enumerate() {
        if let Some(bad) = rgb.iter().find(|value| !value.is_finite() || **value < 0.0) {
            let (x, y) = (index as u32 % picture.width, index as u32 / picture.width);
            return Err(format!("{what}: {bad} at pixel ({x}, {y})"));
        }
    }
    Ok(())
}

fn finite(what: &str, mut values: impl Iterator<Item = f32>) -> Result<(), String> {
    match values.position(|value| !value.is_finite()) {
        Some(index) => Err(format!("{what}: number {index} is not finite")),
        None => Ok(()),
    }
}

fn light(what: &str, values: &[f32]) -> Result<(), String> {
    finite(what, values.iter().copied())?;
    match values.iter().position(|value| *value < 0.0) {
        Some(index) => Err(format!(
            "{what}: number {index} is {}, less than no light",
            values[index]
        )),
        None => Ok(()),
    }
}

/// Checks the stored light of probes and faces.
pub fn buffers(play: &Play<'_>) -> Result<Result<(), String>, Failure> {
    let (gpu, field) = (play.gpu, play.frame.field());
    let rays = field.new_rays(gpu)?;
    if let bad @ Err(_) = finite("the rays of probes", rays.into_iter()) {
        return Ok(bad);
    }
    let variability: Vec<f32> = gpu.read_buffer(field.variability())?;
    if let bad @ Err(_) = finite("the variability of probes", variability.into_iter()) {
        return Ok(bad);
    }
    let cubes = field.light_along_axes(gpu)?;
    if let bad @ Err(_) = light("the light of probes along the axes", &cubes) {
        return Ok(bad);
    }
    faces(play)
}

/// The irradiance maps of all probes. What they store is always finite.
pub fn irradiance(play: &Play<'_>) -> Result<Vec<f32>, Failure> {
    Ok(play.frame.field().irradiance(play.gpu)?.into_flattened())
}

fn faces(play: &Play<'_>) -> Result<Result<(), String>, Failure> {
    let faces = play.frame.faces();
    if !faces.is_used() {
        return Ok(Ok(()));
    }
    let histories: Vec<GpuFaceHistory> = play.gpu.read_buffer(faces.histories())?;
    let mut entries = histories.iter().enumerate();
    Ok(match entries.find(|(_, history)| !is_finite(history)) {
        Some((entry, history)) => Err(format!(
            "the light of faces: entry {entry} is not finite: {history:?}"
        )),
        None => Ok(()),
    })
}

fn is_finite(history: &GpuFaceHistory) -> bool {
    let of_quadrant = |quadrant: &GpuFaceQuadrant| {
        let [r, g, b] = quadrant.light;
        let [probes_r, probes_g, probes_b] = quadrant.by_probes;
        let numbers = [r, g, b, quadrant.samples];
        let by_probes = [probes_r, probes_g, probes_b];
        numbers
            .iter()
            .chain(&by_probes)
            .all(|value| value.is_finite())
    };
    history.spread.is_finite() && history.quadrants.iter().all(of_quadrant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_light_is_found_with_its_place() {
        let of = |value| Picture {
            width: 2,
            height: 2,
            rgb: vec![[0.0; 3], [0.0; 3], [0.0; 3], [0.0, value, 0.0]],
        };
        assert_eq!(picture("it", &of(4.0)), Ok(()));
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-3] {
            let found = picture("it", &of(bad)).expect_err("bad light");
            assert!(found.contains("pixel (1, 1)"), "{found}");
        }
        assert!(light("it", &[1.0, -1.0]).is_err() && light("it", &[1.0, f32::NAN]).is_err());
    }
}
