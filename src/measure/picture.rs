//! The pictures that renderers produce and metrics read.

/// Linear Rec. 709 radiance or display values in [0, 1]: the producer states which. Row by row from the
/// top left; `rgb.len()` = width · height.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<[f32; 3]>,
}

impl Picture {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            rgb: vec![[0.0; 3]; pixels],
        }
    }
}
