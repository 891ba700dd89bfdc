//! The player's hands: what the crosshair points at, strokes that dig and build, and how they are undone.
//!
//! `aim` finds the voxel under the crosshair; `outline` draws its edges, and `extent` those of larger brushes and boxes.
//! `brush` makes strokes there, `held` repeats them, and `history` keeps what they changed. `clipboard` holds a copy, and
//! `clip` is how a run uses it. `bits` fly off what is dug.

pub mod aim;
pub mod bits;
pub mod brush;
mod clip;
pub mod clipboard;
pub mod extent;
mod held;
mod history;
pub mod outline;

use bits::Bits;
use clipboard::Clipboard;

pub use held::Held;
pub use history::{Changes, History, Side};

/// What the hands of a run hold and have done.
#[derive(Clone, Debug, Default)]
pub struct Hands {
    pub held: Held,
    pub history: History,
    pub clipboard: Clipboard,
    pub bits: Bits,
    /// Which build of the world [`Self::history`] belongs to.
    build: u32,
}

impl Hands {
    /// Forgets what belongs to voxels that no longer exist: `build` counts how often the world was built.
    pub fn follow(&mut self, build: u32) {
        if self.build != build {
            self.build = build;
            self.history = History::default();
            self.bits.clear();
        }
    }

    /// Those of a run in another world: the copy goes along.
    pub fn elsewhere(&self) -> Self {
        let clipboard = Clipboard {
            corner: None,
            is_out: false,
            ..self.clipboard.clone()
        };
        Self {
            clipboard,
            ..Self::default()
        }
    }
}
