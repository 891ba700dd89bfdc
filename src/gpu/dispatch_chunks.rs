//! Long work goes out in several dispatches, so that none holds the GPU for long: a window stays
//! alive, and no watchdog takes the device away.
//!
//! Work is a rectangle of workgroups, and a dispatch takes some of its rows. How many is learned from
//! the time that they took: a fast GPU gets all of them at once from its third frame on. A device learns it for
//! each kernel, whoever binds it and however frames are timed (`learner`). Shaders
//! that can be sent so add `first_row` (`shaders/frame/chunk.wesl`) to their row; it lies in a table
//! that the device is opened with, and a dynamic offset chooses it.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
};

use wgpu::util::DeviceExt as _;

/// Name of the binding that says where a dispatch begins.
pub(super) const FIRST_ROW: &str = "first_row";
/// Bytes from one entry of the table to the next: the alignment that every device supports.
pub(super) const STRIDE: u32 = 256;
/// Most rows of a rectangle: those of the highest picture, in tiles of eight pixels.
pub(super) const MOST_ROWS: u32 = 4096;

/// Milliseconds that a dispatch should take. None may take 50; rows differ, and so do frames.
const AIM_MS: f64 = 20.0;
/// Nothing takes no time at all: a clock that stands still says that there is room.
const LEAST_MS: f64 = 1e-6;
/// Share of a group's time that stays known after a faster one: what was seen of the sky says little
/// about the rest of a picture.
const KEPT_OF_SLOWER: f64 = 0.85;
/// After a slower one.
const KEPT_OF_FASTER: f64 = 0.5;
/// How many times as many rows as the last dispatch the next one takes at most.
const MOST_GROWTH: u32 = 4;
/// Least width of a [`rectangle`]: its row is the least that a dispatch can take.
const LEAST_WIDTH: u32 = 8;
/// Rows of a [`rectangle`], give or take.
const ROWS: u32 = 2048;

/// At least `groups` workgroups as width and rows, for shaders that count through them row by row
/// and leave out what is too many.
pub fn rectangle(groups: u32) -> [u32; 2] {
    let width = groups.div_ceil(ROWS).max(LEAST_WIDTH);
    [width, groups.div_ceil(width)]
}

/// The table of first rows.
pub(super) fn table(device: &wgpu::Device) -> wgpu::Buffer {
    let words = STRIDE as usize / size_of::<u32>();
    let mut rows = vec![0u32; MOST_ROWS as usize * words];
    for (row, entry) in rows.chunks_exact_mut(words).enumerate() {
        entry[0] = row as u32;
    }
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(FIRST_ROW),
        contents: bytemuck::cast_slice(&rows),
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_SRC,
    })
}

/// The workgroups of a slice of an indirect dispatch, made on the GPU, which alone knows how many columns
/// there are. One slice after another uses the same words.
#[derive(Clone, Debug)]
pub(super) struct ChunkArguments {
    rows: wgpu::Buffer,
    words: wgpu::Buffer,
}

impl ChunkArguments {
    /// `rows` is the [`table`] of first rows.
    pub(super) fn new(device: &wgpu::Device, rows: &wgpu::Buffer) -> Self {
        let words = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("slice_arguments"),
            contents: bytemuck::cast_slice(&[0u32, 0, 1]),
            usage: wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
        });
        Self {
            rows: rows.clone(),
            words,
        }
    }

    /// As many columns as the dispatch at a byte of a buffer has, and less than [`MOST_ROWS`] rows.
    pub(super) fn write(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (whole, offset): (&wgpu::Buffer, u64),
        rows: u32,
    ) {
        let word = size_of::<u32>() as u64;
        encoder.copy_buffer_to_buffer(whole, offset, &self.words, 0, word);
        // The table's entry of a row holds its number.
        let entry = u64::from(rows) * u64::from(STRIDE);
        encoder.copy_buffer_to_buffer(&self.rows, entry, &self.words, word, word);
    }

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.words
    }
}

/// Runs of a kernel after which its pace is learned again where nobody times its passes.
const RUNS_BETWEEN: u32 = 256;

/// What is known of the time that a kernel's workgroups take on a device.
#[derive(Debug, Default)]
pub(super) struct ChunkTime {
    /// Bits of an f64; 0 while nothing is known.
    ms_a_group: AtomicU64,
    begun: AtomicBool,
    /// Runs since it last learned.
    runs: AtomicU32,
}

impl ChunkTime {
    /// Whether a run that nobody times should be timed for the pace alone.
    pub(super) fn is_due(&self) -> bool {
        let is_known = self.ms_a_group.load(Ordering::Relaxed) > 0;
        !is_known || self.runs.load(Ordering::Relaxed) >= RUNS_BETWEEN
    }

    /// N workgroups took this many milliseconds. The first time says nothing: drivers compile before they begin.
    pub(super) fn learn(&self, groups: u32, ms: f64) {
        if !self.begun.swap(true, Ordering::Relaxed) {
            return;
        }
        self.runs.store(0, Ordering::Relaxed);
        let fresh = ms.max(LEAST_MS) / f64::from(groups.max(1));
        let known = match f64::from_bits(self.ms_a_group.load(Ordering::Relaxed)) {
            known if known > 0.0 => known,
            _ => fresh,
        };
        let kept = if fresh > known {
            KEPT_OF_FASTER
        } else {
            KEPT_OF_SLOWER
        };
        let next = kept * known + (1.0 - kept) * fresh;
        self.ms_a_group.store(next.to_bits(), Ordering::Relaxed);
    }

    /// How many rows of `width` workgroups the next dispatch may take; `unknown` workgroups as long
    /// as no time is known.
    fn rows(&self, width: u32, unknown: u32) -> u32 {
        let ms = f64::from_bits(self.ms_a_group.load(Ordering::Relaxed)) * f64::from(width);
        let rows = if ms > 0.0 {
            (AIM_MS / ms) as u32
        } else {
            unknown / width.max(1)
        };
        rows.max(1)
    }
}

/// The rows of one dispatch after another. What a dispatch teaches its pace counts for the next.
pub(super) struct DispatchChunks<'a> {
    chunk_time: &'a ChunkTime,
    width: u32,
    rows: u32,
    unknown: u32,
    next: u32,
    last: Option<u32>,
}

impl<'a> DispatchChunks<'a> {
    pub(super) fn new(chunk_time: &'a ChunkTime, [width, rows]: [u32; 2], unknown: u32) -> Self {
        chunk_time.runs.fetch_add(1, Ordering::Relaxed);
        Self {
            chunk_time,
            width,
            rows,
            unknown,
            next: 0,
            last: None,
        }
    }
}

impl Iterator for DispatchChunks<'_> {
    type Item = Range<u32>;

    fn next(&mut self) -> Option<Range<u32>> {
        if self.next >= self.rows {
            return None;
        }
        let most = self
            .last
            .map_or(u32::MAX, |last| last.saturating_mul(MOST_GROWTH));
        let allowed = self.chunk_time.rows(self.width, self.unknown).min(most);
        // Equal shares of what is left: a last dispatch of a row or two would be a waste.
        let left = self.rows - self.next;
        let count = left.div_ceil(left.div_ceil(allowed));
        let first = self.next;
        self.next += count;
        self.last = Some(count);
        Some(first..self.next)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn slices_take_every_row_once_and_none_for_too_long(
            width in 1u32..300,
            rows in 0u32..=MOST_ROWS,
            ms_a_row in 1e-6f64..19.0,
            unknown in 1u32..2000,
        ) {
            let chunk_time = ChunkTime::default();
            let mut expected = 0;
            let mut last: Option<u32> = None;
            for (index, chunk) in DispatchChunks::new(&chunk_time, [width, rows], unknown).enumerate() {
                prop_assert_eq!(chunk.start, expected);
                prop_assert!(chunk.end > chunk.start);
                let count = chunk.end - chunk.start;
                match last {
                    None => prop_assert!(count <= (unknown / width).max(1)),
                    Some(last) => {
                        prop_assert!(count <= last * MOST_GROWTH);
                        // The first dispatch's time is not believed.
                        let known = index > 1;
                        prop_assert!(!known || f64::from(count) * ms_a_row <= AIM_MS);
                        prop_assert!(known || count <= (unknown / width).max(1));
                    }
                }
                chunk_time.learn(count * width, f64::from(count) * ms_a_row);
                last = Some(count);
                expected = chunk.end;
            }
            prop_assert_eq!(expected, rows);
        }

        #[test]
        fn rectangles_hold_their_groups_and_few_more(groups in 0u32..8_000_000) {
            let [width, rows] = rectangle(groups);
            prop_assert!(width * rows >= groups);
            prop_assert!(width * rows < groups + width);
            prop_assert!(rows <= MOST_ROWS && width <= 65_535);
        }
    }

    #[test]
    fn what_is_fast_goes_out_at_once_and_slow_rows_are_remembered() {
        let chunk_time = ChunkTime::default();
        let all = 240 * 135;
        chunk_time.learn(240, 900.0);
        chunk_time.learn(all, 2.0);
        let mut at_once = DispatchChunks::new(&chunk_time, [240, 135], 512);
        assert_eq!((at_once.next(), at_once.next()), (Some(0..135), None));
        // One slow frame: half of it at a time, until faster ones have been seen for a while.
        chunk_time.learn(all, 60.0);
        assert_eq!(DispatchChunks::new(&chunk_time, [240, 135], 512).count(), 2);
        chunk_time.learn(all, 2.0);
        assert_eq!(DispatchChunks::new(&chunk_time, [240, 135], 512).count(), 2);
        for _ in 0..20 {
            chunk_time.learn(all, 2.0);
        }
        assert_eq!(DispatchChunks::new(&chunk_time, [240, 135], 512).count(), 1);
    }
}
