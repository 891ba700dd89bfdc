//! Sets of the cells of a lattice.

use glam::{IVec3, UVec3};

/// One bit for each cell of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CellSet {
    counts: UVec3,
    words: Vec<u64>,
}

impl CellSet {
    /// `counts`: cells of the lattice along each axis, fewer than 2³² in all.
    pub fn empty(counts: UVec3) -> Self {
        let cells = counts.element_product() as usize;
        Self {
            counts,
            words: vec![0; cells.div_ceil(u64::BITS as usize)],
        }
    }

    pub fn insert(&mut self, cell: IVec3) {
        let (word, bit) = self.place(cell);
        self.words[word] |= 1 << bit;
    }

    pub fn contains(&self, cell: IVec3) -> bool {
        let (word, bit) = self.place(cell);
        self.words[word] >> bit & 1 == 1
    }

    pub fn len(&self) -> usize {
        let ones = self.words.iter().map(|word| word.count_ones() as usize);
        ones.sum()
    }

    /// By z, then y, then x.
    pub fn iter(&self) -> impl Iterator<Item = IVec3> {
        let bits = |(number, word): (usize, &u64)| {
            let mut left = *word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros();
                left &= left.wrapping_sub(1);
                (bit < u64::BITS).then_some(number as u32 * u64::BITS + bit)
            })
        };
        let counts = self.counts;
        let numbers = self.words.iter().enumerate().flat_map(bits);
        numbers.map(move |number| {
            let row = number / counts.x;
            UVec3::new(number % counts.x, row % counts.y, row / counts.y).as_ivec3()
        })
    }

    fn place(&self, cell: IVec3) -> (usize, u32) {
        let cell = cell.as_uvec3();
        debug_assert!(cell.cmplt(self.counts).all(), "{cell} of {}", self.counts);
        let number = cell.x + self.counts.x * (cell.y + self.counts.y * cell.z);
        ((number / u64::BITS) as usize, number % u64::BITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_has_what_was_put_in_and_in_order() {
        let mut set = CellSet::empty(UVec3::new(5, 7, 3));
        let cells = [[4, 6, 2], [0, 0, 0], [3, 2, 1], [4, 6, 1], [0, 3, 1]].map(IVec3::from);
        for cell in cells {
            assert!(!set.contains(cell));
            set.insert(cell);
            set.insert(cell);
            assert!(set.contains(cell));
        }
        assert_eq!(set.len(), cells.len());
        let mut sorted = cells;
        sorted.sort_by_key(|cell| (cell.z, cell.y, cell.x));
        assert_eq!(set.iter().collect::<Vec<_>>(), sorted);
    }
}
