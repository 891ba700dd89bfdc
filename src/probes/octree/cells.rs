//! Numbers for the cells or points of a lattice, and sets of them.

use glam::{IVec3, UVec3};

/// So many places along each axis, fewer than 2³² in all. Their numbers rise with x, then y, then z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice(pub UVec3);

impl Lattice {
    pub fn count(self) -> usize {
        self.0.element_product() as usize
    }

    pub fn number(self, place: IVec3) -> usize {
        let place = place.as_uvec3();
        debug_assert!(place.cmplt(self.0).all(), "{place} of {}", self.0);
        (place.x + self.0.x * (place.y + self.0.y * place.z)) as usize
    }

    pub fn place(self, number: usize) -> IVec3 {
        let (number, counts) = (number as u32, self.0);
        let row = number / counts.x;
        UVec3::new(number % counts.x, row % counts.y, row / counts.y).as_ivec3()
    }
}

const BITS: usize = u64::BITS as usize;

/// One bit for each cell of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CellSet {
    lattice: Lattice,
    words: Vec<u64>,
}

impl CellSet {
    /// `counts`: as of [`Lattice`].
    pub fn empty(counts: UVec3) -> Self {
        let lattice = Lattice(counts);
        Self {
            lattice,
            words: vec![0; lattice.count().div_ceil(BITS)],
        }
    }

    pub fn insert(&mut self, cell: IVec3) {
        let number = self.lattice.number(cell);
        self.words[number / BITS] |= 1 << (number % BITS);
    }

    pub fn contains(&self, cell: IVec3) -> bool {
        let number = self.lattice.number(cell);
        self.words[number / BITS] >> (number % BITS) & 1 == 1
    }

    pub fn len(&self) -> usize {
        let ones = self.words.iter().map(|word| word.count_ones() as usize);
        ones.sum()
    }

    /// By z, then y, then x.
    pub fn iter(&self) -> impl Iterator<Item = IVec3> {
        let numbers = self.words.iter().enumerate().flat_map(|(number, word)| {
            let mut left = *word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                left &= left.wrapping_sub(1);
                (bit < BITS).then_some(number * BITS + bit)
            })
        });
        numbers.map(|number| self.lattice.place(number))
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
