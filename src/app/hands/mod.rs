//! The player's hands: what the crosshair points at, strokes that dig and build, and how they are undone.
//!
//! `aim` finds the voxel under the crosshair; `outline` draws its edges, and `extent` those of larger brushes and boxes.
//! `hotbar` has the `item` in the hand. `brush` and `lamps` make strokes, `held` repeats them, and `history` keeps what
//! they changed. `clipboard` holds a copy, and `lift` makes bodies of voxels and
//! voxels of bodies. `bits` fly off what is dug.

pub mod aim;
pub mod bits;
pub mod brush;
pub mod clipboard;
pub mod extent;
mod held;
mod history;
pub mod hotbar;
pub mod item;
pub mod lamps;
pub mod lift;
pub mod outline;

use bits::Bits;
use clipboard::Clipboard;

pub use held::Held;
pub use history::{Changes, History, Side};
pub use hotbar::Hotbar;
pub use item::Item;

use crate::world::World;

/// What the hands of a run hold and have done.
#[derive(Clone, Debug)]
pub struct Hands {
    pub held: Held,
    pub hotbar: Hotbar,
    pub history: History,
    pub clipboard: Clipboard,
    pub bits: Bits,
    /// Which build of the world [`Self::history`] belongs to.
    build: u32,
}

impl Hands {
    /// Those of a run that begins in this world.
    pub fn new(world: &World, build: u32) -> Self {
        Self {
            held: Held::default(),
            hotbar: Hotbar::of(world),
            history: History::default(),
            clipboard: Clipboard::default(),
            bits: Bits::default(),
            build,
        }
    }

    /// Forgets what belongs to voxels and materials that no longer exist: `build` counts how often the world was built.
    pub fn follow(&mut self, world: &World, build: u32) {
        if self.build != build {
            self.build = build;
            self.history = History::default();
            self.hotbar.fit(world);
            self.bits.clear();
        }
    }

    /// The same, with the copy of a run in another world.
    pub fn with_copy_of(self, other: &Self) -> Self {
        let clipboard = Clipboard {
            corner: None,
            is_out: false,
            ..other.clipboard.clone()
        };
        Self { clipboard, ..self }
    }
}
