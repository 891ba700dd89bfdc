//! Splits long work into several dispatches (chunks), so that none holds the GPU for long: a window
//! stays responsive, and no watchdog resets the device.
//!
//! Work is a rectangle of workgroups, and each dispatch takes some of its rows. How many is learned
//! from the measured time of earlier dispatches: a fast GPU gets all rows at once from its third frame
//! on. A device learns the time of each kernel, whichever bindings it has and however frames are timed
//! (`learner`). Shaders that can be split add `first_row` (`shaders/frame/chunk.wesl`) to their row.
//! `first_row` lies in a table that is created with the device, and a dynamic offset selects its entry.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
};

use wgpu::util::DeviceExt as _;

use super::{AdapterSummary, device::DISCRETE};

/// Name of the binding that holds the first row of a dispatch.
pub(super) const FIRST_ROW: &str = "first_row";
/// Bytes from one entry of the table to the next: the alignment that every device supports.
pub(super) const STRIDE: u32 = 256;
/// Most rows of a rectangle: those of the tallest picture, in tiles of eight pixels.
pub(super) const MOST_ROWS: u32 = 4096;

/// Milliseconds that a dispatch should take. None may take 50; the rest is a margin, because rows and
/// frames differ.
const AIM_MS: f64 = 20.0;
/// Least time that counts: where the clock shows no time at all, there is room for more.
const LEAST_MS: f64 = 1e-6;
/// Share of the known time per workgroup that is kept after a faster dispatch: rows that show only sky
/// say little about the rest of a picture.
const KEPT_OF_SLOWER: f64 = 0.85;
/// The same after a slower dispatch.
const KEPT_OF_FASTER: f64 = 0.5;
/// The next dispatch takes at most this many times the rows of the last one.
const MOST_GROWTH: u32 = 4;
/// Least width of a [`rectangle`]: one row is the least that a dispatch can take.
const LEAST_WIDTH: u32 = 8;
/// Approximate number of rows of a [`rectangle`].
const ROWS: u32 = 2048;

/// At least `groups` workgroups as width and rows, for shaders that number them row by row and skip the
/// surplus.
pub fn rectangle(groups: u32) -> [u32; 2] {
    let width = groups.div_ceil(ROWS).max(LEAST_WIDTH);
    [width, groups.div_ceil(width)]
}

/// Workgroups of a first dispatch: a few milliseconds on the slowest integrated GPU, tens of
/// milliseconds on a software adapter. There each dispatch has a fixed cost, so that fewer workgroups
/// would cost more than they save.
const FIRST_GROUPS: u32 = 512;
/// The same on a card: half of a picture of 3840×2160 pixels. With 512, the first frame of the cavern took an H200 165 ms in
/// place of 38.
const FIRST_GROUPS_OF_CARDS: u32 = 65_536;

/// Workgroups of 64 threads that a first dispatch may have on an adapter.
pub(super) fn usual_first_groups(adapter: &AdapterSummary) -> u32 {
    match adapter.kind {
        DISCRETE => FIRST_GROUPS_OF_CARDS,
        _ => FIRST_GROUPS,
    }
}

/// Workgroups of this size that a first dispatch may have, where it may have `usual` ones of 64 threads.
pub(super) fn first_groups(usual: u32, size: [u32; 3]) -> u32 {
    const USUAL_THREADS: u32 = 64;
    let threads: u32 = size.iter().product();
    usual / (threads / USUAL_THREADS).max(1)
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

/// Arguments of one chunk of an indirect dispatch. The GPU writes them, because only it knows the
/// number of columns. Successive chunks reuse the same words.
#[derive(Clone, Debug)]
pub(super) struct ChunkArguments {
    rows: wgpu::Buffer,
    words: wgpu::Buffer,
}

impl ChunkArguments {
    /// `rows` is the [`table`] of first rows.
    pub(super) fn new(device: &wgpu::Device, rows: &wgpu::Buffer) -> Self {
        let words = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("chunk_arguments"),
            contents: bytemuck::cast_slice(&[0u32, 0, 1]),
            usage: wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
        });
        Self {
            rows: rows.clone(),
            words,
        }
    }

    /// Writes the columns of the dispatch at a byte offset of a buffer, and `rows` rows, fewer than
    /// [`MOST_ROWS`].
    pub(super) fn write(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (whole, offset): (&wgpu::Buffer, u64),
        rows: u32,
    ) {
        let word = size_of::<u32>() as u64;
        encoder.copy_buffer_to_buffer(whole, offset, &self.words, 0, word);
        // The table's entry of a row holds the number of the row.
        let entry = u64::from(rows) * u64::from(STRIDE);
        encoder.copy_buffer_to_buffer(&self.rows, entry, &self.words, word, word);
    }

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.words
    }
}

/// Runs of a kernel after which its chunk time is learned again, where its passes are not timed
/// otherwise.
const RUNS_BETWEEN: u32 = 256;

/// The learned time of a kernel's workgroups on a device.
#[derive(Debug, Default)]
pub(super) struct ChunkTime {
    /// Bits of an f64; 0 while no time is known.
    ms_a_group: AtomicU64,
    begun: AtomicBool,
    /// Whether the last run took several dispatches.
    is_split: AtomicBool,
    /// Runs since the last measurement.
    runs: AtomicU32,
}

impl ChunkTime {
    /// Whether a run that is not timed otherwise should be timed for the chunk time alone. Work that is
    /// split always is: a single slow measurement must not keep it split.
    pub(super) fn is_due(&self) -> bool {
        let is_known = self.ms_a_group.load(Ordering::Relaxed) > 0;
        !is_known
            || self.is_split.load(Ordering::Relaxed)
            || self.runs.load(Ordering::Relaxed) >= RUNS_BETWEEN
    }

    /// Records that `groups` workgroups took `ms` milliseconds. The first measurement is ignored:
    /// drivers compile before they begin.
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

    /// How many rows of `width` workgroups the next dispatch may take; rows of `unknown` workgroups
    /// while no time is known.
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

/// The rows of successive dispatches. The measured time of each dispatch sets the size of the next.
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
        // Equal shares of the remaining rows: a last dispatch of a row or two would be a waste.
        let left = self.rows - self.next;
        let count = left.div_ceil(left.div_ceil(allowed));
        let is_split = count < self.rows;
        self.chunk_time.is_split.store(is_split, Ordering::Relaxed);
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
        fn chunks_take_every_row_once_and_none_too_long(
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
                        // The first dispatch's time is ignored.
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
    fn a_first_dispatch_has_fewer_large_workgroups() {
        assert_eq!(first_groups(512, [8, 8, 1]), 512);
        assert_eq!(first_groups(512, [1, 1, 1]), 512);
        assert_eq!(first_groups(512, [1024, 1, 1]), 32);
        assert_eq!(first_groups(u32::MAX, [8, 8, 1]), u32::MAX);
    }

    #[test]
    fn fast_work_is_one_dispatch_and_slow_rows_are_remembered() {
        let chunk_time = ChunkTime::default();
        let all = 240 * 135;
        chunk_time.learn(240, 900.0);
        chunk_time.learn(all, 2.0);
        let mut at_once = DispatchChunks::new(&chunk_time, [240, 135], 512);
        assert_eq!((at_once.next(), at_once.next()), (Some(0..135), None));
        // After one slow frame the work is split in half, until several faster frames have been
        // measured.
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
