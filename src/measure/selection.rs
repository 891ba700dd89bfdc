//! Which pixels of a picture are measured: all, a rectangle, or those that a mask marks.

use thiserror::Error;

use super::picture::Picture;

/// Why a selection is invalid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SelectionError {
    #[error(
        "the region {},{},{}x{} reaches beyond the picture of {}×{} pixels",
        .region[0], .region[1], .region[2], .region[3], .size[0], .size[1]
    )]
    RegionOutside { region: [u32; 4], size: [u32; 2] },
    #[error(
        "the mask is {}×{} pixels and the pictures are {}×{}; make them the same size",
        .mask[0], .mask[1], .size[0], .size[1]
    )]
    MaskSize { mask: [u32; 2], size: [u32; 2] },
    #[error(
        "the mask marks no pixel: it counts pixels of which a channel is above one half, and there are none"
    )]
    MaskEmpty,
    #[error("the mask marks no pixel: the red channel of none is between {} and {}", .band[0], .band[1])]
    BandEmpty { band: [f32; 2] },
}

/// The pixels that are measured; at least one, unless the picture itself has none.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// Row by row; `None` for all.
    chosen: Option<Vec<bool>>,
}

impl Selection {
    /// Every pixel.
    pub const ALL: Self = Self { chosen: None };

    /// A rectangle [x, y, width, height] counted from the top left.
    ///
    /// # Errors
    /// [`SelectionError::RegionOutside`], also for one without pixels.
    pub fn region(size: [u32; 2], region: [u32; 4]) -> Result<Self, SelectionError> {
        let [x, y, width, height] = region.map(u64::from);
        let inside = x + width <= u64::from(size[0]) && y + height <= u64::from(size[1]);
        if !inside || width == 0 || height == 0 {
            return Err(SelectionError::RegionOutside { region, size });
        }
        let (columns, rows) = (x..x + width, y..y + height);
        let pixels = (0..u64::from(size[1]))
            .flat_map(|row| (0..u64::from(size[0])).map(move |column| (column, row)));
        let chosen = pixels.map(|(column, row)| columns.contains(&column) && rows.contains(&row));
        Ok(Self {
            chosen: Some(chosen.collect()),
        })
    }

    /// The pixels for which a channel of the mask is above one half.
    ///
    /// # Errors
    /// [`SelectionError`] for a mask of another size, and for one that marks no pixel.
    pub fn mask(size: [u32; 2], mask: &Picture) -> Result<Self, SelectionError> {
        let marked = |rgb: &[f32; 3]| rgb.iter().any(|&value| value > 0.5);
        Self::marked(size, mask, marked)?.ok_or(SelectionError::MaskEmpty)
    }

    /// The pixels whose red channel in the mask lies between two values, both included: with a depth
    /// picture as mask, the pixels at some distance.
    ///
    /// # Errors
    /// [`SelectionError`] for a mask of another size, and for one that marks no pixel.
    pub fn band(size: [u32; 2], mask: &Picture, band: [f32; 2]) -> Result<Self, SelectionError> {
        let marked = |rgb: &[f32; 3]| rgb[0] >= band[0] && rgb[0] <= band[1];
        Self::marked(size, mask, marked)?.ok_or(SelectionError::BandEmpty { band })
    }

    /// `None` if no pixel is marked.
    fn marked(
        size: [u32; 2],
        mask: &Picture,
        marked: impl Fn(&[f32; 3]) -> bool,
    ) -> Result<Option<Self>, SelectionError> {
        let mask_size = [mask.width, mask.height];
        if mask_size != size {
            return Err(SelectionError::MaskSize {
                mask: mask_size,
                size,
            });
        }
        let chosen: Vec<bool> = mask.rgb.iter().map(marked).collect();
        let any = chosen.iter().any(|&marked| marked);
        Ok(any.then_some(Self {
            chosen: Some(chosen),
        }))
    }

    /// Whether a pixel, counted row by row, is measured.
    pub fn has(&self, index: usize) -> bool {
        self.chosen.as_ref().is_none_or(|chosen| chosen[index])
    }

    /// The values of the measured pixels, in order.
    pub fn of<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let indexed = values.iter().enumerate();
        indexed
            .filter_map(|(index, &value)| self.has(index).then_some(value))
            .collect()
    }

    /// The measured pixels in one row: for metrics that ignore the position of a pixel.
    pub fn of_picture(&self, picture: &Picture) -> Picture {
        let rgb = self.of(&picture.rgb);
        Picture {
            width: rgb.len() as u32,
            height: 1,
            rgb,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counting(width: u32, height: u32) -> Picture {
        let rgb = (0..width * height).map(|i| [i as f32; 3]).collect();
        Picture { width, height, rgb }
    }

    #[test]
    fn a_band_selects_the_pixels_within_it() {
        let picture = counting(4, 1);
        let chosen = Selection::band([4, 1], &picture, [1.0, 2.0]).expect("marks two");
        assert_eq!(chosen.of(&[10, 11, 12, 13]), [11, 12]);
        let nothing = Selection::band([4, 1], &picture, [1.2, 1.8]);
        assert_eq!(nothing, Err(SelectionError::BandEmpty { band: [1.2, 1.8] }));
        assert!(Selection::band([1, 4], &picture, [0.0, 9.0]).is_err());
    }

    #[test]
    fn a_region_has_its_own_pixels_and_no_others() {
        let picture = counting(4, 3);
        let chosen = Selection::region([4, 3], [1, 1, 2, 2]).expect("inside");
        let values: Vec<f32> = chosen.of(&picture.rgb).iter().map(|rgb| rgb[0]).collect();
        assert_eq!(values, [5.0, 6.0, 9.0, 10.0]);
        assert_eq!(chosen.of_picture(&picture).width, 4);
        assert_eq!(Selection::ALL.of(&picture.rgb), picture.rgb);
    }

    #[test]
    fn regions_that_reach_outside_or_hold_nothing_are_refused() {
        for region in [
            [3, 0, 2, 1],
            [0, 3, 1, 1],
            [0, 0, 0, 1],
            [u32::MAX, 0, u32::MAX, 1],
        ] {
            let refused = Selection::region([4, 3], region);
            let size = [4, 3];
            assert_eq!(refused, Err(SelectionError::RegionOutside { region, size }));
        }
        assert!(Selection::region([4, 3], [0, 0, 4, 3]).is_ok());
    }

    #[test]
    fn a_mask_marks_by_its_brightest_channel() {
        let mut mask = Picture::new(2, 2);
        mask.rgb[2] = [0.0, 0.6, 0.0];
        let chosen = Selection::mask([2, 2], &mask).expect("marks one");
        assert_eq!(chosen.of(&[10, 11, 12, 13]), [12]);
        assert_eq!(
            Selection::mask([2, 2], &Picture::new(2, 2)),
            Err(SelectionError::MaskEmpty)
        );
        assert_eq!(
            Selection::mask([2, 1], &mask),
            Err(SelectionError::MaskSize {
                mask: [2, 2],
                size: [2, 1]
            })
        );
    }
}
