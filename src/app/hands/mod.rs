//! The player's hands: what the crosshair points at, strokes that dig and build, and how they are undone.
//!
//! `aim` finds the voxel under the crosshair, and `outline` draws its edges. `brush` makes strokes there, `held`
//! repeats them, and `history` keeps what they changed.

pub mod aim;
pub mod brush;
mod held;
mod history;
pub mod outline;

pub use held::Held;
pub use history::{Changes, History, Side};

/// What the hands of a run hold and have done.
#[derive(Clone, Debug, Default)]
pub struct Hands {
    pub held: Held,
    pub history: History,
    /// Which build of the world [`Self::history`] belongs to.
    build: u32,
}

impl Hands {
    /// Forgets what belongs to voxels that no longer exist: `build` counts how often the world was built.
    pub fn follow(&mut self, build: u32) {
        if self.build != build {
            self.build = build;
            self.history = History::default();
        }
    }
}
