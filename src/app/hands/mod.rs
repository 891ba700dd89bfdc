//! The player's hands: what the crosshair points at, strokes that dig and build, and how they are undone.
//!
//! `aim` finds the voxel under the crosshair, and `outline` draws its edges. `hotbar` has the `item` in the hand.
//! `brush` and `lamps` make strokes, `held` repeats them, and `history` keeps what they changed.

pub mod aim;
pub mod brush;
mod held;
mod history;
pub mod hotbar;
pub mod item;
pub mod lamps;
pub mod outline;

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
            build,
        }
    }

    /// Forgets what belongs to voxels and materials that no longer exist: `build` counts how often the world was built.
    pub fn follow(&mut self, world: &World, build: u32) {
        if self.build != build {
            self.build = build;
            self.history = History::default();
            self.hotbar.fit(world);
        }
    }
}
