//! When to find out which lamps stone hides from whole cells of the world (pass `surface_cache/cell_shadows`).

/// Among so few lamps no cell finds enough that it cannot see: to look for them costs more than it spares (measured with eight).
const FEW_LAMPS: usize = 12;
/// Pixels may see new cells: they are examined in one of so many frames.
const NEW_CELLS: u32 = 8;

/// What there is to do in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellShadows {
    /// The pass must run.
    pub are_examined: bool,
    /// What it has found holds in this frame, once it has run.
    pub are_known: bool,
}

impl CellShadows {
    /// In frame `frame` with so many lamps. `changes`: one of them has moved, is new or is listed anew, or a voxel was edited.
    pub fn of_frame(lamps: usize, changes: bool, frame: u32) -> Self {
        let are_known = lamps > FEW_LAMPS;
        Self {
            are_examined: are_known && (changes || frame.is_multiple_of(NEW_CELLS)),
            are_known,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_examined_at_once_after_changes_and_now_and_then_else() {
        let examined = |lamps, changes| {
            let frames = (1..=2 * NEW_CELLS)
                .filter(|&frame| CellShadows::of_frame(lamps, changes, frame).are_examined);
            frames.count() as u32
        };
        assert_eq!(examined(FEW_LAMPS, true), 0);
        assert_eq!(examined(FEW_LAMPS + 1, true), 2 * NEW_CELLS);
        assert_eq!(examined(FEW_LAMPS + 1, false), 2);
        assert!(CellShadows::of_frame(FEW_LAMPS + 1, false, 1).are_known);
        assert!(!CellShadows::of_frame(FEW_LAMPS, false, 1).are_known);
    }
}
