//! Choices of what the rays of probes keep, and what follows from the parameters of probes.

use std::borrow::Cow;

use super::{
    FinalGather, Kind, LEAST_RAYS, Method, ProbeParameters, Relocation, Value, Visibility,
};

choice! {
    /// Whether probes keep what their rays hit.
    ProbeHits {
        /// Every update traces its rays in directions of its own.
        Traced = "traced",
        /// Updates take a few sets of directions in turn. A hit is kept until voxels change on its ray or its
        /// probe moves, and lit again in every update.
        Kept = "kept",
    }
}

choice! {
    /// The lattice of directions that a probe's rays have.
    RayLattice {
        /// The spherical Fibonacci lattice.
        Fibonacci = "fibonacci",
        /// Rows of latitude, each divided evenly by longitude, so that all rays stand for the same solid angle.
        LatLong = "latlong",
    }
}

impl ProbeParameters {
    /// Sets of directions whose hits are kept: 0 under [`ProbeHits::Traced`].
    pub fn kept_sets(&self) -> u32 {
        match self.hits {
            ProbeHits::Traced => 0,
            ProbeHits::Kept => self.hit_sets,
        }
    }

    /// Rays that an update of a probe traces, or whose kept hits it lights. Kept hits belong to the directions of a
    /// whole set, so an update takes all of these.
    pub fn rays_per_update(&self) -> u32 {
        if self.hits == ProbeHits::Kept {
            return self.rays;
        }
        let share = (self.rays as f32 * self.ray_share).round() as u32;
        share.max(LEAST_RAYS).min(self.rays)
    }

    /// In effect: under [`Method::Source`] probes alone light the picture, and estimate visibility from distances.
    pub fn effective(&self) -> Cow<'_, Self> {
        match self.method {
            Method::Grotto => Cow::Borrowed(self),
            Method::Source => Cow::Owned(Self {
                visibility: Visibility::Chebyshev,
                final_gather: FinalGather::Off,
                relocation: Relocation::Off,
                ..self.clone()
            }),
        }
    }
}
