//! How long new probes warm up: until the light of many bounces has arrived.

/// Albedo up to which the parameter's number of frames is enough.
const ENOUGH: f32 = 0.875;
/// The warm-up takes at most this many times as long.
const MOST: f32 = 10.0;

/// Frames of warm-up in a world whose brightest material has this mean albedo; `frames` is `probes.warmup_frames`.
///
/// Each frame of the warm-up adds a bounce. What is missing after n bounces is albedoⁿ of all light, so for the same
/// error n grows with 1 / −ln(albedo). After the warm-up, averages bring the rest very slowly.
pub fn warmup_frames(frames: u32, brightest: f32) -> u32 {
    let brightest = brightest.clamp(ENOUGH, 0.999_999);
    let longer = (ENOUGH.ln() / brightest.ln()).min(MOST);
    (frames as f32 * longer).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bright_rooms_warm_up_longer_and_others_as_told() {
        assert_eq!(warmup_frames(40, 0.0), 40);
        assert_eq!(warmup_frames(40, 0.8), 40);
        assert_eq!(warmup_frames(0, 0.95), 0);
        // As much is missing after either.
        let longer = warmup_frames(40, 0.95);
        let missing = |albedo: f32, frames: u32| albedo.powi(frames as i32);
        assert!((missing(0.95, longer) / missing(0.875, 40) - 1.0).abs() < 0.05);
        assert_eq!(warmup_frames(40, 1.0), 400);
    }
}
