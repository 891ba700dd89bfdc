//! How the maps of the occlusion field are stored, and how much memory they take.

use crate::parameters::{MOST_OCCLUSION_LAMPS, OcclusionParameters};

crate::shared! {
    in probes;

    /// Values that the field can keep: one for each lamp, and the openness of the surroundings.
    pub const MOST_VALUES as OCCLUSION_VALUES: usize = MOST_OCCLUSION_LAMPS as usize + 1;

    /// Words before the maps of a probe: how often each value was updated, and the frame of the last update.
    const HEADER_WORDS as OCCLUSION_HEADER: u32 = MOST_OCCLUSION_LAMPS + 2;
}

/// What each probe keeps in its occlusion maps: for each texel the visibility of some lamps, then the openness of the
/// surroundings if it is wanted. A value has 16 bits, and two share a word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OcclusionLayout {
    pub lamps: u32,
    pub ambient: bool,
    /// Width of a map.
    pub texels: u32,
}

impl OcclusionLayout {
    pub fn new(parameters: &OcclusionParameters) -> Self {
        Self {
            lamps: parameters.lamps,
            ambient: parameters.ambient,
            texels: parameters.texels,
        }
    }

    /// Values of a texel.
    pub fn values(&self) -> u32 {
        self.lamps + u32::from(self.ambient)
    }

    /// Whether there is a field at all.
    pub fn is_kept(&self) -> bool {
        self.values() > 0
    }

    /// Words of 32 bits from one probe to the next.
    pub fn stride(&self) -> u32 {
        HEADER_WORDS + self.texels.pow(2) * self.values().div_ceil(2)
    }

    /// Bytes of the maps of all probes; 0 where there is no field.
    pub fn map_bytes(&self, slots: u32) -> u64 {
        u64::from(self.is_kept()) * u64::from(slots) * u64::from(self.stride()) * 4
    }

    /// Bytes of what the rays of all probes find; 0 where there is no field.
    pub fn ray_bytes(&self, slots: u32, rays: u32) -> u64 {
        u64::from(self.is_kept()) * u64::from(slots) * u64::from(rays) * 4
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_that_is_off_takes_no_memory() {
        let off = OcclusionLayout::new(&OcclusionParameters::default());
        assert_eq!((off.map_bytes(1000), off.ray_bytes(1000, 64)), (0, 0));
    }

    #[test]
    fn two_values_share_a_word() {
        let layout = |lamps, ambient| OcclusionLayout {
            lamps,
            ambient,
            texels: 16,
        };
        assert_eq!(layout(1, false).stride(), 10 + 256);
        assert_eq!(layout(1, true).stride(), layout(2, false).stride());
        assert_eq!(layout(8, true).stride(), 10 + 256 * 5);
        assert_eq!(layout(4, true).map_bytes(3), 3 * (10 + 256 * 3) * 4);
        assert_eq!(layout(4, true).ray_bytes(3, 64), 3 * 64 * 4);
    }
}
