//! A PulseAudio server, or PipeWire in its place, by its own protocol: that needs no library of the system.

use std::{
    sync::{Arc, Mutex},
    thread,
    time::{Duration, Instant},
};

use pulseaudio::{
    AsPlaybackSource as _, Client, ClientError,
    protocol::{
        ChannelMap, DEFAULT_SINK, PlaybackStreamParams, Prop, Props, SampleFormat, SampleSpec,
        stream::{BufferAttr, StreamFlags},
    },
};

use super::{Player, locked};

const RATE_HZ: u32 = 48_000;
/// Bytes of a sample for both ears.
const MOMENT: usize = 2 * size_of::<f32>();
/// Bytes that the server keeps ready: 40 ms.
const READY: u32 = RATE_HZ / 25 * MOMENT as u32;
/// A server asks for samples every few milliseconds; one that has not asked for so long is gone.
const PATIENCE: Duration = Duration::from_secs(2);
const LOOK: Duration = Duration::from_millis(200);

/// Plays until the window is closed.
///
/// # Errors
/// Why there is no server, or no longer one.
pub fn play(player: &Arc<Mutex<Player>>, is_over: &dyn Fn() -> bool) -> Result<(), String> {
    let client = Client::from_env(c"grotto").map_err(|error| told(&error))?;
    let asked = Arc::new(Mutex::new(Instant::now()));
    let source = {
        let (player, asked) = (player.clone(), asked.clone());
        move |bytes: &mut [u8]| {
            *locked(&asked) = Instant::now();
            fill(&mut locked(&player), bytes)
        }
    };
    let mut props = Props::new();
    props.set(Prop::MediaName, c"grotto");
    props.set(Prop::MediaRole, c"game");
    let params = PlaybackStreamParams {
        sample_spec: SampleSpec {
            format: SampleFormat::Float32Le,
            channels: 2,
            sample_rate: RATE_HZ,
        },
        channel_map: ChannelMap::stereo(),
        sink_name: Some(DEFAULT_SINK.to_owned()),
        buffer_attr: BufferAttr {
            target_length: READY,
            ..BufferAttr::default()
        },
        flags: StreamFlags {
            adjust_latency: true,
            ..StreamFlags::default()
        },
        props,
        ..PlaybackStreamParams::default()
    };
    locked(player).begin(RATE_HZ as f32);
    let stream = client.create_playback_stream(params, source.as_playback_source());
    let stream = pollster::block_on(stream).map_err(|error| told(&error))?;
    while !is_over() {
        thread::sleep(LOOK);
        if locked(&asked).elapsed() > PATIENCE {
            return Err("the sound server has stopped asking for sound".into());
        }
    }
    drop(stream);
    Ok(())
}

/// Fills the bytes that the server asks for. Returns their number: 0 ends the stream.
fn fill(player: &mut Player, bytes: &mut [u8]) -> usize {
    if !player.catch_up() {
        return 0;
    }
    let mut filled = 0;
    for moment in bytes.chunks_exact_mut(MOMENT) {
        let [left, right] = player.next().map(f32::to_le_bytes);
        moment[..MOMENT / 2].copy_from_slice(&left);
        moment[MOMENT / 2..].copy_from_slice(&right);
        filled += MOMENT;
    }
    filled
}

fn told(error: &ClientError) -> String {
    match error {
        ClientError::ServerUnavailable => {
            "neither PulseAudio nor PipeWire (with pipewire-pulse) runs".into()
        }
        error => format!("the sound server does not answer: {error}"),
    }
}
