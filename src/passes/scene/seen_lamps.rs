//! Which lamps the rays that hit a cell of the world have reached lately (`shaders/light/seen_lamps.wesl`).

use bytemuck::{Pod, Zeroable};

use crate::{
    gpu::{Gpu, GpuError},
    lights::{Cells, FreshLamps, Lights},
};

crate::shared! {
    in lights;

    /// A bit of the first word of a cell: a ray has looked at all lamps.
    pub const LOOKED_AT_ALL as LOOKED_AT_ALL: u32 = 1 << 31;
}

/// Frames after which rays write the next third.
const TURN_FRAMES: u64 = 16;
/// Frames for which a lamp that has moved, come or gone on counts as seen everywhere: what rays find then fills two thirds.
const LEARNING_FRAMES: u64 = 2 * TURN_FRAMES;
const WORDS_A_CELL: u64 = 2;
const THIRDS: u64 = 3;

/// The start of `SeenLamps` in `shaders/light/seen_lamps.wesl`; its fields are explained there.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuSeenLampsHeader {
    pub read_first: u32,
    pub read_second: u32,
    pub written: u32,
    pub _pad: u32,
    pub fresh: [u32; 2],
}

/// A buffer for rays of probes and one for those of faces, for both are traced at the same time.
pub struct SeenLamps {
    of_probes: wgpu::Buffer,
    of_faces: wgpu::Buffer,
    cells: Cells,
    frames: u64,
    fresh: FreshLamps,
}

impl SeenLamps {
    /// Nothing is known yet.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(gpu: &Gpu, cells: Cells) -> Result<Self, GpuError> {
        let bytes = size_of::<GpuSeenLampsHeader>() as u64 + THIRDS * third_bytes(cells);
        let buffer = || {
            gpu.making("lamps seen by rays", bytes, || {
                gpu.storage_buffer("seen_lamps", bytes)
            })
        };
        let made = Self {
            of_probes: buffer()?,
            of_faces: buffer()?,
            cells,
            frames: 0,
            fresh: FreshLamps::default(),
        };
        made.write_header(gpu, [0; 2]);
        Ok(made)
    }

    /// Forgets everything, as if no frame had been drawn.
    pub fn forget(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let start = size_of::<GpuSeenLampsHeader>() as u64;
        for buffer in [&self.of_probes, &self.of_faces] {
            encoder.clear_buffer(buffer, start, None);
        }
        self.frames = 0;
        self.fresh.forget();
    }

    /// Begins a frame with these lights. What an edit uncovers is found by the rays that look at all lamps. `repeats`: rays
    /// are repeated, so they must choose as before, among the same lamps and those that have come since.
    pub fn begin_frame(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lights: &Lights,
        repeats: bool,
    ) {
        let fresh = self.fresh.follow(lights, self.frames, LEARNING_FRAMES);
        let written = self.write_header(gpu, fresh).written;
        if repeats {
            return;
        }
        if self.frames.is_multiple_of(TURN_FRAMES) {
            let start = size_of::<GpuSeenLampsHeader>() as u64 + 4 * u64::from(written);
            for buffer in [&self.of_probes, &self.of_faces] {
                encoder.clear_buffer(buffer, start, Some(third_bytes(self.cells)));
            }
        }
        self.frames += 1;
    }

    fn write_header(&self, gpu: &Gpu, fresh: [u32; 2]) -> GpuSeenLampsHeader {
        let [written, read_first, read_second] =
            thirds_in_turn(self.frames).map(|third| (third * third_bytes(self.cells) / 4) as u32);
        let header = GpuSeenLampsHeader {
            read_first,
            read_second,
            written,
            _pad: 0,
            fresh,
        };
        for buffer in [&self.of_probes, &self.of_faces] {
            gpu.queue
                .write_buffer(buffer, 0, bytemuck::bytes_of(&header));
        }
        header
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.of_probes.size() + self.of_faces.size()
    }

    /// What pass `probes/trace` binds.
    pub fn of_probes(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("seen_lamps", self.of_probes.as_entire_binding())
    }

    /// What pass `surface_cache/trace` binds.
    pub fn of_faces(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("seen_lamps", self.of_faces.as_entire_binding())
    }
}

/// In frame `frame`, the number of the third that rays write, and those of the two that they read: the oldest and the newest.
fn thirds_in_turn(frame: u64) -> [u64; 3] {
    let turn = frame / TURN_FRAMES;
    [0, 1, 2].map(|later| (turn + later) % THIRDS)
}

fn third_bytes(cells: Cells) -> u64 {
    4 * WORDS_A_CELL * cells.number()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_for_two_turns_and_then_written_anew() {
        for turn in 0..7 {
            let in_turn = |later: u64| thirds_in_turn((turn + later) * TURN_FRAMES);
            let [written, ..] = in_turn(0);
            for frame in 1..TURN_FRAMES {
                assert_eq!(thirds_in_turn(turn * TURN_FRAMES + frame), in_turn(0));
            }
            assert!(!in_turn(0)[1..].contains(&written), "nobody reads it yet");
            assert_eq!(in_turn(1)[2], written, "the newest");
            assert_eq!(in_turn(2)[1], written, "the oldest");
            assert_eq!(in_turn(3)[0], written, "it begins again");
        }
    }
}
