//! Samples of a picture in blocks. Each block is summed alone, so that the picture does not depend on which process
//! traces which blocks.

use std::ops::Range;

use crate::measure::{block_sums::BlockSums, picture::Picture};

/// Largest number of blocks of a picture.
const MOST_BLOCKS: u32 = 64;
/// Fewest samples of a block but the last: reading one back must cost less than tracing it.
const LEAST_SAMPLES: u32 = 8;

/// The samples of a picture in blocks. Each block is summed alone; [`BlockSums`] adds the blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    samples: u32,
    /// Samples of each block but the last.
    size: u32,
}

impl Blocks {
    /// No blocks for no samples.
    pub fn of(samples: u32) -> Self {
        let size = samples.div_ceil(MOST_BLOCKS).next_power_of_two();
        Self {
            samples,
            size: size.max(LEAST_SAMPLES),
        }
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.samples.div_ceil(self.size)
    }

    /// The samples of these blocks.
    pub fn samples(self, blocks: &Range<u32>) -> Range<u32> {
        let edge = |block: u32| (block * self.size).min(self.samples);
        edge(blocks.start)..edge(blocks.end)
    }
}

/// Some blocks of a picture.
pub struct Sampled {
    /// The light that is not random: linear Rec. 709 radiance, or the view's data.
    pub certain: Picture,
    pub sums: BlockSums,
    /// If tracing was cancelled within a block: for each pixel, the sum and the number of that block's samples.
    pub(super) unfinished: Option<Vec<[f32; 4]>>,
    /// Samples that every pixel holds.
    pub samples: u32,
}

impl Sampled {
    /// Whether all samples were traced, without cancellation.
    pub fn is_complete(&self) -> bool {
        self.unfinished.is_none()
    }

    /// The picture so far, if these are its first blocks.
    pub fn picture(&self, blocks: Blocks) -> Picture {
        let samples = blocks.samples(&self.sums.blocks()).end;
        let Some(unfinished) = &self.unfinished else {
            return self.sums.mean(&self.certain, samples);
        };
        // Each pixel is the mean of its own samples.
        let total = self.sums.total(self.certain.rgb.len());
        let pixel = |((sure, sum), more): ((&[f32; 3], &[f64; 3]), &[f32; 4])| {
            let count = (f64::from(samples) + f64::from(more[3])).max(1.0);
            std::array::from_fn(|channel| {
                let sum = sum[channel] + f64::from(more[channel]);
                (f64::from(sure[channel]) + sum / count) as f32
            })
        };
        let pixels = self.certain.rgb.iter().zip(&total).zip(unfinished);
        Picture {
            rgb: pixels.map(pixel).collect(),
            ..self.certain
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_share_all_samples_and_are_few() {
        for samples in (0..300).chain([4096, 5000, 1 << 20]) {
            let blocks = Blocks::of(samples);
            let count = blocks.count();
            assert!(count <= MOST_BLOCKS);
            assert_eq!(blocks.samples(&(0..count)), 0..samples);
            for block in 0..count {
                let one = blocks.samples(&(block..block + 1));
                assert!(!one.is_empty());
                let next = blocks.samples(&(block + 1..block + 1)).start;
                assert_eq!(one.end, next);
            }
        }
        assert_eq!(Blocks::of(32).count(), 4);
        assert_eq!(Blocks::of(256).count(), 32);
    }
}
