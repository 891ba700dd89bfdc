//! Sums of pictures that do not depend on which process adds which part.
//!
//! Addition of floating-point numbers depends on its order. The order here is therefore that of a
//! binary tree over all blocks, as in pairwise summation (Higham 1993): a node is the sum of its left
//! half and its right half. A part holds the largest nodes that lie within it, at most two of each
//! size; joining the parts adds the nodes above them. Rounding errors grow with the logarithm of the
//! number of blocks.

use std::ops::Range;

use super::picture::Picture;

/// The sum of consecutive blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Blocks, counted from 0. Their number is a power of two, and the first is a multiple of that
    /// number.
    pub blocks: Range<u32>,
    pub rgb: Vec<[f32; 3]>,
}

/// Sums of a run of blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockSums {
    /// The blocks that have been added.
    blocks: Range<u32>,
    /// From left to right.
    nodes: Vec<Node>,
}

impl BlockSums {
    /// No block yet; the first one will be number `first`.
    pub fn new(first: u32) -> Self {
        Self {
            blocks: first..first,
            nodes: Vec::new(),
        }
    }

    /// The blocks that have been added.
    pub fn blocks(&self) -> Range<u32> {
        self.blocks.clone()
    }

    /// From left to right.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Adds the next block.
    ///
    /// # Panics
    /// For a picture of another size: that is a caller's bug.
    pub fn push(&mut self, rgb: Vec<[f32; 3]>) {
        let next = self.blocks.end;
        let added = self.push_node(Node {
            blocks: next..next + 1,
            rgb,
        });
        assert!(added, "a single block can follow any block");
    }

    /// Adds a node that begins at the next block. Returns false, and adds nothing, if it begins
    /// elsewhere, is not a node of the tree, or has another picture size.
    #[must_use]
    pub fn push_node(&mut self, node: Node) -> bool {
        let Range { start, end } = node.blocks;
        let size = end.saturating_sub(start);
        let sized = self
            .nodes
            .first()
            .is_none_or(|n| n.rgb.len() == node.rgb.len());
        if start != self.blocks.end
            || !size.is_power_of_two()
            || !start.is_multiple_of(size)
            || !sized
        {
            return false;
        }
        self.blocks.end = end;
        let mut last = node;
        while let Some(left) = self.nodes.pop_if(|left| left.is_left_of(&last)) {
            last = left.joined(last);
        }
        self.nodes.push(last);
        true
    }

    /// Adds the blocks of a part that begins where this one ends. Returns false if it begins elsewhere.
    #[must_use]
    pub fn join(&mut self, part: Self) -> bool {
        part.blocks.start == self.blocks.end
            && part.nodes.into_iter().all(|node| self.push_node(node))
            && part.blocks.end == self.blocks.end
    }

    /// The sum of all blocks in f64; zero without any.
    pub fn total(&self, pixels: usize) -> Vec<[f64; 3]> {
        let mut total = vec![[0.0; 3]; pixels];
        // The smallest nodes are the last.
        for node in self.nodes.iter().rev() {
            for (sum, rgb) in total.iter_mut().zip(&node.rgb) {
                for (sum, value) in sum.iter_mut().zip(rgb) {
                    *sum += f64::from(*value);
                }
            }
        }
        total
    }

    /// `certain` plus the mean of `samples` samples, whose sums these are.
    pub fn mean(&self, certain: &Picture, samples: u32) -> Picture {
        let total = self.total(certain.rgb.len());
        let count = f64::from(samples.max(1));
        let pixel = |(sure, sum): (&[f32; 3], &[f64; 3])| {
            std::array::from_fn(|channel| (f64::from(sure[channel]) + sum[channel] / count) as f32)
        };
        Picture {
            rgb: certain.rgb.iter().zip(&total).map(pixel).collect(),
            ..*certain
        }
    }
}

impl Node {
    /// Whether both are halves of one node, and `self` is the left one.
    fn is_left_of(&self, right: &Self) -> bool {
        self.blocks.len() == right.blocks.len()
            && self.blocks.end == right.blocks.start
            && (self.blocks.start as usize).is_multiple_of(2 * self.blocks.len())
    }

    fn joined(mut self, right: Self) -> Self {
        assert_eq!(self.rgb.len(), right.rgb.len(), "pictures of one size");
        for (sum, value) in self
            .rgb
            .iter_mut()
            .flatten()
            .zip(right.rgb.iter().flatten())
        {
            *sum += value;
        }
        self.blocks.end = right.blocks.end;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values whose sum depends on the order.
    fn block(index: u32) -> Vec<[f32; 3]> {
        let value = |n: u32| {
            let hash = (index * 7 + n + 1)
                .wrapping_mul(2_654_435_761)
                .rotate_left(13);
            hash as f32 * 10f32.powi((hash % 9) as i32 - 12)
        };
        (0..4)
            .map(|n| [value(n), value(n + 4), value(n + 8)])
            .collect()
    }

    fn part(blocks: Range<u32>) -> BlockSums {
        let mut sums = BlockSums::new(blocks.start);
        for index in blocks {
            sums.push(block(index));
        }
        sums
    }

    #[test]
    fn any_division_into_parts_gives_the_same_bits() {
        let mut orders_differ = false;
        for all in 1..=70 {
            let whole = part(0..all);
            for cuts in [
                vec![],
                vec![1],
                vec![all / 3, all / 2],
                (0..all).collect(),
                vec![all, all],
            ] {
                let mut joined = BlockSums::new(0);
                let mut start = 0;
                for end in cuts.into_iter().chain([all]).filter(|end| *end <= all) {
                    assert!(joined.join(part(start..end)));
                    start = end;
                }
                assert_eq!(joined, whole);
                assert_eq!(joined.total(4), whole.total(4));
            }
            let in_order = (1..all).fold(block(0), |mut sum, index| {
                for (sum, value) in sum.iter_mut().flatten().zip(block(index).iter().flatten()) {
                    *sum += value;
                }
                sum
            });
            let tree = whole
                .total(4)
                .iter()
                .map(|rgb| rgb.map(|value| value as f32))
                .collect::<Vec<_>>();
            orders_differ |= tree != in_order;
        }
        assert!(orders_differ, "the order of these blocks does not matter");
    }

    #[test]
    fn few_nodes_hold_many_blocks_and_the_mean_covers_all() {
        assert_eq!(part(0..64).nodes().len(), 1);
        assert_eq!(part(1..63).nodes().len(), 10);
        let mut sums = BlockSums::new(0);
        for index in 0..5u8 {
            sums.push(vec![[f32::from(index), 1.0, 0.0]; 2]);
        }
        let certain = Picture {
            width: 2,
            height: 1,
            rgb: vec![[1.0, 0.0, 7.0]; 2],
        };
        let mean = sums.mean(&certain, 10);
        assert_eq!(mean.rgb, [[2.0, 0.5, 7.0]; 2]);
        assert_eq!(BlockSums::new(0).mean(&certain, 0), certain);
    }

    #[test]
    fn blocks_out_of_order_are_refused() {
        let mut sums = part(0..3);
        assert!(!sums.clone().join(part(4..5)), "block 3 is missing");
        assert!(!sums.clone().join(part(2..5)), "block 2 is repeated");
        let of = |blocks: Range<u32>, pixels| Node {
            blocks,
            rgb: vec![[0.0; 3]; pixels],
        };
        assert!(!sums.push_node(of(3..5, 4)), "not a node of the tree");
        assert!(!sums.push_node(of(3..3, 4)), "none at all");
        assert!(!sums.push_node(of(3..4, 5)), "another size");
        assert!(sums.push_node(of(3..4, 4)));
        assert_eq!(sums.blocks(), 0..4);
        assert_eq!(sums.nodes().len(), 1);
    }
}
