//! Less work than was chosen: a smaller picture, and fewer rays.

use super::Viewport;
use crate::{app::quality::Effort, frame::FrameError};

impl Viewport {
    /// The effort of the pictures.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Draws the next pictures with this effort. The choice stays as it is, and so does the path-traced reference.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it; the effort is then unchanged.
    pub fn make(&mut self, effort: Effort) -> Result<(), FrameError> {
        let size = effort.size(self.choice.size);
        if size != self.frame.size() {
            self.frame.resize(&self.gpu, size)?;
        }
        self.effort = effort;
        Ok(())
    }
}
