//! Less work than was chosen: fewer pixels, and fewer rays.

use super::Viewport;
use crate::{app::quality::Effort, frame::FrameError, parameters::PictureParameters};

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
        self.fit(
            effort,
            self.choice.size,
            &self.choice.parameters.picture.clone(),
        )?;
        self.effort = effort;
        Ok(())
    }

    /// Gives the frame the size and the smoothing of this effort at a choice. Returns whether the number of pixels
    /// changed.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it.
    pub(super) fn fit(
        &mut self,
        effort: Effort,
        size: [u32; 2],
        picture: &PictureParameters,
    ) -> Result<bool, FrameError> {
        let (size, smoothing) = effort.picture(size, picture);
        let is_resized = size != self.frame.size();
        let is_rescaled = smoothing.scale != self.frame.smoothing().scale;
        if is_resized {
            self.frame.resize(&self.gpu, size)?;
        }
        self.frame.antialias(&self.gpu, smoothing)?;
        Ok(is_resized || is_rescaled)
    }
}
