//! The default device of Windows and macOS, through cpal.

use std::{
    sync::{Arc, Mutex, mpsc},
    time::Duration,
};

use cpal::traits::{DeviceTrait as _, HostTrait as _, StreamTrait as _};

use super::{Player, locked};

/// How often to look whether the window is closed.
const LOOK: Duration = Duration::from_millis(200);

/// Plays until the window is closed.
///
/// # Errors
/// Why there is no device, or no longer one.
pub fn play(player: &Arc<Mutex<Player>>, is_over: &dyn Fn() -> bool) -> Result<(), String> {
    let device = cpal::default_host()
        .default_output_device()
        .ok_or("the system has no sound device")?;
    let config = device
        .default_output_config()
        .map_err(|error| error.to_string())?
        .config();
    let channels = usize::from(config.channels);
    locked(player).begin(config.sample_rate as f32);
    let (failed, failure) = mpsc::channel();
    let source = player.clone();
    let fill = move |samples: &mut [f32], _: &cpal::OutputCallbackInfo| {
        let mut player = locked(&source);
        player.catch_up();
        for moment in samples.chunks_mut(channels) {
            let [left, right] = player.next();
            match moment {
                [one] => *one = 0.5 * (left + right),
                [first, second, others @ ..] => {
                    (*first, *second) = (left, right);
                    others.fill(0.0);
                }
                [] => {}
            }
        }
    };
    let tell = move |error: cpal::Error| {
        // Only the first one is read.
        let _ = failed.send(error.to_string());
    };
    let stream = device
        .build_output_stream(config, fill, tell, None)
        .map_err(|error| error.to_string())?;
    stream.play().map_err(|error| error.to_string())?;
    while !is_over() {
        if let Ok(error) = failure.recv_timeout(LOOK) {
            return Err(error);
        }
    }
    Ok(())
}
