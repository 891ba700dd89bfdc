//! The figures of the suites `probes` and `hits`.

use std::collections::BTreeMap;

use glam::Vec3;

use super::{
    super::{
        super::Failure,
        model::{Figure, Row},
    },
    quality::named,
    rig::Rig,
    row::Measured,
    runner::Common,
    spec::{Condition, RowSpec},
};
use crate::{
    passes::probes::{GpuProbePlace, ProbeField},
    probes::{Layout as _, sampling},
};

/// Frames of the suite `hits`, and between two of its samples; with `--quick` it ends at the second one.
const FRAMES: u32 = 600;
const SAMPLE: u32 = 100;
/// Rays that hit nothing are stored as 65 000 voxels long, rounded to a half float (`shaders/probes/ray.wesl`): that may
/// be less. No ray that hits something is as long as this.
const LONGEST_HIT: f32 = 60_000.0;

/// Milliseconds of the passes whose names begin with one of these; `None` where none was timed.
fn sum(passes: &BTreeMap<String, f64>, prefixes: &[&str]) -> Option<f64> {
    let own = |name: &str| prefixes.iter().any(|prefix| name.starts_with(prefix));
    let found: Vec<f64> = passes
        .iter()
        .filter(|(name, _)| own(name))
        .map(|(_, ms)| *ms)
        .collect();
    (!found.is_empty()).then(|| found.iter().sum())
}

impl Common<'_> {
    /// One row of the table of probes: a run in motion and the error of a picture at rest, with the final gather and
    /// without it. Figures without it are called `alone_…`: probes alone.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn probes(&self, spec: &RowSpec, rig: &mut Rig<'_>) -> Result<Row, Failure> {
        let with_gather = spec.clone().with("probes.final_gather", "on")?;
        let mut row = self.timed(&with_gather, rig)?;
        row.varied.clone_from(&spec.varied);
        row.quality = Some(self.judging.quality(rig, &with_gather)?);
        let without = spec.clone().with("probes.final_gather", "off")?;
        let alone = self.timed(&without, rig)?;
        let quality = self.judging.quality(rig, &without)?;
        let gather = ["view/shade", "surface_cache/"];
        let figures = [
            ("update_ms", sum(&row.passes, &["probes/"])),
            ("gather_ms", sum(&row.passes, &gather)),
            ("alone_update_ms", sum(&alone.passes, &["probes/"])),
            ("alone_gather_ms", sum(&alone.passes, &gather)),
            ("alone_fps", alone.fps),
            ("alone_flip", Some(quality.flip)),
            ("alone_energy", quality.energy),
        ];
        let known: Vec<(&str, f64)> = figures
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)))
            .collect();
        row.figures = named(&known);
        Ok(row)
    }

    /// The row of runs of a spec in motion.
    fn timed(&self, spec: &RowSpec, rig: &mut Rig<'_>) -> Result<Row, Failure> {
        let mut measured = Measured::new(spec.clone());
        for _ in 0..self.runs {
            let run = rig.run(spec, Condition::Moving, self.length)?;
            measured.add(run, rig)?;
        }
        let row = measured.row(self.gpu, self.length, self.seed, self.adapter);
        row.ok_or_else(|| Failure::fault(format!("{}: no frame was measured", spec.id)))
    }

    /// Probes and hits of the published octree while world time runs: `probes_N`, their number in frame N; `hits_N`, the
    /// share of their rays that hit anything; `leaf_hits_N`, the share that hit a surface in the probe's own leaf.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn hits_over_time(
        &self,
        spec: &RowSpec,
        rig: &mut Rig<'_>,
    ) -> Result<BTreeMap<String, Figure>, Failure> {
        rig.prepare(spec, spec.size)?;
        let mut figures = BTreeMap::new();
        let mut played = 0;
        let last = if self.quick { SAMPLE } else { FRAMES };
        for frame in (0..=last).step_by(SAMPLE as usize) {
            // A probe has rays from its first frame on.
            let until = frame.max(1);
            rig.play(spec, spec.size, played..until)?;
            played = until;
            let shares = HitShares::read(spec, rig)?;
            let name = |what: &str| format!("{what}_{frame:03}");
            figures.extend(named(&[
                (&name("probes"), f64::from(shares.probes)),
                (&name("hits"), shares.hits),
                (&name("leaf_hits"), shares.leaf_hits),
            ]));
        }
        Ok(figures)
    }
}

/// What the rays of all living probes of an octree hit in their last update.
struct HitShares {
    probes: u32,
    hits: f64,
    leaf_hits: f64,
}

impl HitShares {
    fn read(spec: &RowSpec, rig: &Rig<'_>) -> Result<Self, Failure> {
        let (gpu, field) = (rig.gpu, rig.frame.field());
        let rays: Vec<[half::f16; 4]> = gpu.read_buffer(field.rays())?;
        let places: Vec<GpuProbePlace> = gpu.read_buffer(field.places())?;
        let updates = field.updates(gpu)?;
        // All of them have the directions of the last frame.
        let frame = u64::from(rig.frame.frames().saturating_sub(1));
        let directions = sampling::directions_of_frame(
            &spec.parameters.probes,
            field.rays_per_probe(),
            u64::from(rig.seed),
            frame,
        );
        let directions: Vec<Vec3> = directions.iter().map(|d| d.as_vec3()).collect();
        let lengths = |slot: usize| {
            let own = &rays[slot * directions.len()..(slot + 1) * directions.len()];
            own.iter().map(|ray| ray[3].to_f32())
        };
        let (mut all, mut hits, mut leaf_hits) = (0u64, 0u64, 0u64);
        for (slot, place) in places.iter().enumerate().take(updates.len()) {
            if place.alive == 0.0 || updates[slot] == 0 {
                continue;
            }
            let leaf = Leaf::of(field, slot as u32);
            for (length, direction) in lengths(slot).zip(&directions) {
                all += 1;
                if length < LONGEST_HIT {
                    hits += 1;
                    let point = Vec3::from(place.position_ws) + direction * length.max(0.0);
                    leaf_hits += u64::from(leaf.holds(point));
                }
            }
        }
        Ok(Self {
            probes: field.volume().probes(),
            hits: hits as f64 / all.max(1) as f64,
            leaf_hits: leaf_hits as f64 / all.max(1) as f64,
        })
    }
}

/// The leaf of an octree with a probe in its middle.
struct Leaf {
    middle: Vec3,
    half: Vec3,
}

impl Leaf {
    fn of(field: &ProbeField, slot: u32) -> Self {
        Self {
            middle: field.volume().position(slot),
            half: field.volume().level_of(slot).spacing() / 2.0,
        }
    }

    /// Whether a point on a surface lies in it; its outermost voxels count as its own and its neighbours'.
    fn holds(&self, point: Vec3) -> bool {
        (point - self.middle).abs().cmple(self.half + 0.51).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_summed_by_subject() {
        let passes = [
            ("probes/trace", 1.0),
            ("probes/blend", 2.0),
            ("view/shade", 4.0),
            ("view/tonemap", 8.0),
            ("surface_cache/trace", 16.0),
        ];
        let passes = passes.map(|(name, ms)| (name.to_owned(), ms)).into();
        assert_eq!(sum(&passes, &["probes/"]), Some(3.0));
        assert_eq!(sum(&passes, &["view/shade", "surface_cache/"]), Some(20.0));
        assert_eq!(sum(&passes, &["bench/"]), None);
    }

    #[test]
    fn a_leaf_ends_at_its_faces() {
        let leaf = Leaf {
            middle: Vec3::splat(4.5),
            half: Vec3::splat(4.0),
        };
        assert!(leaf.holds(Vec3::new(9.0, 4.5, 0.0)));
        assert!(!leaf.holds(Vec3::new(9.1, 4.5, 4.5)));
    }
}
