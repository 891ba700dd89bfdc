//! Splits long work into dispatch chunks that do not hold the GPU for long, however slow the GPU is. A chunk is some
//! samples of some tiles of a picture, as many as measured times allow.

use std::ops::Range;

/// Milliseconds that a chunk should take. No supported device may be held for more than 50.
const TARGET_MS: f64 = 20.0;
/// Largest ratio of a chunk to the chunk before: parts of a picture differ in cost.
const GROWTH: f64 = 4.0;

/// Some samples of some tiles. Places count tiles in the order of `tile_of` of
/// `shaders/path_trace/trace.wesl`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunk {
    pub places: Range<u32>,
    pub samples: Range<u32>,
    /// 0: places are tiles, row by row; else tiles are scattered, and this is log2 of the number of places.
    pub scatter_bits: u32,
    /// Tiles × samples.
    pub work: u64,
}

/// How much of a picture is done, and how much to do next.
#[derive(Clone, Debug)]
pub struct Schedule {
    tiles: u32,
    samples: u32,
    /// The samples that every tile gets in this round; `place` is the next place.
    round: Range<u32>,
    place: u32,
    /// Tiles × samples that the next chunk may have.
    work: f64,
}

impl Schedule {
    /// `samples` of each of `tiles`.
    pub fn new(tiles: u32, samples: u32) -> Self {
        Self {
            tiles,
            samples,
            round: 0..0,
            place: 0,
            work: 1.0,
        }
    }

    /// Tiles of the picture.
    pub fn tiles(&self) -> u32 {
        self.tiles
    }

    /// One sample of every tile at once.
    pub fn all_tiles(&self) -> Chunk {
        Chunk {
            places: 0..self.tiles,
            samples: 0..1,
            scatter_bits: 0,
            work: u64::from(self.tiles),
        }
    }

    /// Starts again with `samples` of each tile, and keeps what was learnt about the speed.
    pub fn restart(&mut self, samples: u32) {
        self.samples = samples;
        self.round = 0..0;
        self.place = 0;
    }

    /// Samples that every tile has.
    pub fn complete(&self) -> u32 {
        if self.place == 0 {
            self.round.end
        } else {
            self.round.start
        }
    }

    /// Whether every tile has all samples.
    pub fn is_done(&self) -> bool {
        self.complete() == self.samples
    }

    /// Tiles × samples that are done, for a progress bar.
    pub fn done(&self) -> u64 {
        let tiles = u64::from(self.tiles);
        let share = f64::from(self.place) / f64::from(self.places());
        let within = if self.place == 0 { 0.0 } else { share };
        let round = self.round.len() as f64 * tiles as f64 * within;
        u64::from(self.complete()) * tiles + round as u64
    }

    /// The next chunk; `None` when all is done.
    pub fn next_chunk(&mut self) -> Option<Chunk> {
        if self.place == 0 {
            let first = self.round.end;
            if first == self.samples {
                return None;
            }
            let affordable = (self.work / f64::from(self.tiles)).max(1.0) as u32;
            self.round = first..self.samples.min(first.saturating_add(affordable));
        }
        let whole = f64::from(self.tiles) * self.round.len() as f64;
        let scatter_bits = if self.place == 0 && self.work >= whole {
            0
        } else {
            self.scatter_bits()
        };
        let first = self.place;
        let mut tiles = self.tiles;
        if scatter_bits == 0 {
            self.place = tiles;
        } else {
            let wanted = (self.work / self.round.len() as f64).max(1.0) as u32;
            tiles = 0;
            // Some places hold no tile. They join this chunk, so that no chunk consists of them alone.
            while self.place < self.places() && (tiles < wanted || !self.holds_tile(self.place)) {
                tiles += u32::from(self.holds_tile(self.place));
                self.place += 1;
            }
        }
        let places = first..self.place;
        if scatter_bits == 0 || self.place == self.places() {
            self.place = 0;
        }
        Some(Chunk {
            places,
            samples: self.round.clone(),
            scatter_bits,
            work: u64::from(tiles) * self.round.len() as u64,
        })
    }

    /// Learns from the milliseconds that a chunk of this much work took, the last chunk or an older one.
    pub fn took(&mut self, work: u64, ms: f64) {
        let work = work as f64;
        // The small rest of a round says little about the speed, unless even the rest took too long.
        if work * 2.0 < self.work && ms < TARGET_MS {
            return;
        }
        // A time of 0 from a coarse clock means that a larger chunk is affordable.
        let affordable = (work * TARGET_MS / ms.max(1e-3)).min(work * GROWTH);
        let most = f64::from(self.tiles) * f64::from(self.samples);
        self.work = affordable.min(most).max(1.0);
    }

    fn holds_tile(&self, place: u32) -> bool {
        place.reverse_bits() >> (32 - self.scatter_bits()) < self.tiles
    }

    fn scatter_bits(&self) -> u32 {
        self.tiles.next_power_of_two().trailing_zeros().max(1)
    }

    /// Places of scattered tiles.
    fn places(&self) -> u32 {
        1 << self.scatter_bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Same as `tile_of` of the shader.
    fn tile_of(place: u32, bits: u32) -> u32 {
        match bits {
            0 => place,
            bits => place.reverse_bits() >> (32 - bits),
        }
    }

    /// Runs a schedule on a device that takes `ms_per_work` per tile and sample, and returns the time of the longest
    /// chunk.
    fn run(tiles: u32, samples: u32, ms_per_work: f64) -> f64 {
        let mut schedule = Schedule::new(tiles, samples);
        let in_all = u64::from(tiles) * u64::from(samples);
        let mut seen = vec![0; tiles as usize];
        let mut longest = 0.0f64;
        while let Some(chunk) = schedule.next_chunk() {
            let mut work = 0;
            for place in chunk.places.clone() {
                let tile = tile_of(place, chunk.scatter_bits) as usize;
                if tile < seen.len() {
                    assert_eq!(
                        seen[tile], chunk.samples.start,
                        "each sample once, in order"
                    );
                    seen[tile] = chunk.samples.end;
                    work += chunk.samples.len();
                }
            }
            assert_eq!(chunk.work, work as u64);
            let ms = work as f64 * ms_per_work + 0.05;
            longest = longest.max(ms);
            schedule.took(chunk.work, ms);
            let fewest = seen.iter().copied().min().expect("there are tiles");
            // The last places of a round may hold no tile.
            assert!(schedule.complete() <= fewest);
            assert!(schedule.done() <= in_all);
            assert!(!schedule.is_done() || fewest == samples);
        }
        assert!(seen.iter().all(|samples_of| *samples_of == samples));
        assert_eq!(schedule.done(), in_all);
        assert_eq!(schedule.complete(), samples);
        assert!(schedule.is_done());
        longest
    }

    #[test]
    fn every_tile_gets_every_sample_once_and_no_chunk_is_long() {
        for tiles in [1, 2, 3, 100, 1000] {
            for samples in [0, 1, 7, 300] {
                for ms_per_work in [1e-6, 1e-3, 0.3, 4.0, 30.0] {
                    let longest = run(tiles, samples, ms_per_work);
                    // One tile with one sample is the smallest chunk.
                    let allowed = 50f64.max(ms_per_work + 1.0);
                    assert!(
                        longest <= allowed,
                        "{tiles} {samples} {ms_per_work}: {longest} ms"
                    );
                }
            }
        }
    }

    #[test]
    fn a_restart_keeps_what_was_learnt_about_the_speed() {
        let mut schedule = Schedule::new(64, 1000);
        for _ in 0..6 {
            let chunk = schedule.next_chunk().expect("more to do");
            schedule.took(chunk.work, 0.1);
        }
        schedule.restart(1000);
        assert_eq!((schedule.complete(), schedule.done()), (0, 0));
        let first = schedule.next_chunk().expect("all to do");
        assert!(first.samples.len() > 1, "{first:?}");
    }
}
