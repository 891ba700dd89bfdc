//! Which octrees are possible.

use glam::IVec3;

use crate::probes::ProbeError;
use crate::world::LayoutSpec;
use crate::world::scenery::{FARTHEST, MAX_OCTREE_CELLS};

/// Voxels between the points of the finest lattice of a valid layout.
pub(super) fn check(layout: &LayoutSpec, depth: u32) -> Result<IVec3, ProbeError> {
    let name = || layout.name.clone();
    if layout.counts.min_element() < 2 {
        return Err(ProbeError::TooFew {
            layout: name(),
            counts: layout.counts.to_string(),
            least: 2,
        });
    }
    if !layout.centre.is_finite() {
        return Err(ProbeError::Centre {
            layout: name(),
            centre: layout.centre.to_string(),
        });
    }
    let finest = layout.spacing / (1u64 << depth.min(32)) as f32;
    // Written so that NaN is refused.
    if !(finest.min_element() >= 1.0
        && finest == finest.round()
        && layout.spacing.max_element() <= FARTHEST)
    {
        return Err(ProbeError::Halves {
            layout: name(),
            spacing: layout.spacing.to_string(),
            depth,
        });
    }
    let cells = (layout.counts - 1)
        .to_array()
        .map(|n| u64::from(n) << depth);
    let cells = cells.iter().fold(1u64, |a, b| a.saturating_mul(*b));
    if cells > MAX_OCTREE_CELLS {
        return Err(ProbeError::TooDeep {
            layout: name(),
            depth,
            cells,
            most: MAX_OCTREE_CELLS,
        });
    }
    let half = (layout.counts - 1).as_dvec3() * 0.5 * layout.spacing.as_dvec3();
    let reach = (layout.centre.as_dvec3().abs() + half).max_element();
    if reach > f64::from(FARTHEST) {
        return Err(ProbeError::TooFar {
            layout: name(),
            reach,
            most: FARTHEST,
        });
    }
    Ok(finest.as_ivec3())
}
