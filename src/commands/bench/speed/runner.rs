//! Rows that are not about frames: voxelising, bytes, starts, rays alone, errors.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use super::{
    super::{
        super::Failure,
        model::{Adapter, Figure, Row},
        traversal,
    },
    quality::{Judging, named},
    rig::{Length, Rig},
    row::blank,
    spec::{BenchScene, RowSpec, Work},
    start,
};
use crate::{
    frame::{BuildReport, Stage},
    gpu::{Gpu, Recorder},
    measure::{frame_times::Interval, statistics::median},
    passes::scene::distances::Distances,
    world::View,
};

/// Number of builds of a world, or starts of a process, for a row.
const REPEATS: u32 = 5;

/// Values that all rows of a command share.
pub struct Common<'a> {
    pub gpu: &'a Gpu,
    pub adapter: &'a Adapter,
    /// The value of `--adapter`.
    pub asked: Option<&'a str>,
    pub seed: u32,
    pub judging: &'a Judging<'a>,
    pub quick: bool,
    /// For starts: frames until light counts as settled.
    pub settled: u32,
    /// Runs of frames in a row of probes, and how long they are.
    pub runs: u32,
    pub length: Length,
}

impl Common<'_> {
    fn repeats(&self) -> u32 {
        if self.quick { 2 } else { REPEATS }
    }

    /// A row without frames.
    fn row(&self, spec: &RowSpec, clock: &str, figures: BTreeMap<String, Figure>) -> Row {
        Row {
            figures,
            ..blank(spec, self.seed, self.adapter, clock)
        }
    }

    /// The rows of a spec that needs no rig.
    ///
    /// # Errors
    /// When the adapter fails, or cannot hold the world.
    pub fn without_rig(&self, spec: &RowSpec, scene: &BenchScene) -> Result<Vec<Row>, Failure> {
        match spec.work {
            Work::Build => self.build(spec, scene).map(|row| vec![row]),
            Work::Start => {
                let adapter = self.asked.unwrap_or(&self.gpu.summary.name);
                let starts = (self.repeats(), self.settled);
                let figures = start::measure(spec, &scene.path, adapter, starts)?;
                Ok(vec![self.row(spec, "wall", figures)])
            }
            _ => self.traversal(spec, scene),
        }
    }

    /// The row of a spec that needs a rig but times no frames.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn with_rig(&self, spec: &RowSpec, rig: &mut Rig<'_>) -> Result<Row, Failure> {
        let judging = self.judging;
        match spec.work {
            Work::Stability => {
                let figures = judging.stability(rig, spec)?;
                Ok(self.row(spec, "none", figures))
            }
            Work::Probes => self.probes(spec, rig),
            Work::HitsOverTime => {
                let figures = self.hits_over_time(spec, rig)?;
                Ok(self.row(spec, "none", figures))
            }
            Work::Bytes => {
                rig.prepare(spec, spec.size)?;
                let field = rig.frame.field();
                let slots = f64::from(field.volume().probes());
                let probes = field.memory().total() as f64;
                let (irradiance, distance) = (
                    spec.parameters.probes.irradiance_texels,
                    spec.parameters.probes.distance_texels,
                );
                let figures = named(&[
                    ("bytes_per_probe", probes / slots),
                    ("map_bytes_per_probe", map_bytes(irradiance, distance)),
                ]);
                Ok(self.row(spec, "none", figures))
            }
            work => {
                let view = match work {
                    Work::DirectError => View::Direct,
                    _ => View::Full,
                };
                let (figures, quality) = judging.errors(rig, spec, view)?;
                let mut row = self.row(spec, "none", figures);
                row.quality = Some(quality);
                Ok(row)
            }
        }
    }

    fn build(&self, spec: &RowSpec, scene: &BenchScene) -> Result<Row, Failure> {
        let mut reports: Vec<BuildReport> = Vec::new();
        // The first build compiles shaders; it does not count.
        let mut stage = Stage::build(self.gpu, &scene.world)?;
        for _ in 0..self.repeats() {
            self.keep_warm(&stage)?;
            stage = Stage::build(self.gpu, &scene.world)?;
            reports.extend(stage.built);
        }
        let last = *reports.last().expect("built on the adapter");
        let clock = match last.voxelise.gpu_ms {
            Some(_) if !self.gpu.summary.is_software() => "gpu",
            _ => "wall",
        };
        let mut figures = named(&[
            ("bricks", f64::from(last.voxelise.bricks)),
            ("peak_bytes", last.voxelise.peak_bytes as f64),
        ]);
        let mut time = |name: &str, of: fn(&BuildReport) -> Option<f64>| {
            let values: Vec<f64> = reports.iter().filter_map(of).collect();
            if let (Some(value), Some(interval)) = (median(&values), Interval::of(&values)) {
                let half_width = interval.half_width;
                figures.insert(name.to_owned(), Figure { value, half_width });
            }
        };
        time("voxelise_ms", |report| report.voxelise.gpu_ms);
        time("distances_ms", |report| report.distances_ms);
        time("wall_ms", |report| Some(report.voxelise.wall_ms));
        let mut row = self.row(spec, clock, figures);
        row.layout = None;
        row.memory_bytes
            .insert("voxels".to_owned(), stage.voxels.bytes());
        Ok(row)
    }

    /// Keeps the GPU busy for a while: a GPU that waits for the CPU lowers its clock. Correct distances do not
    /// change when they are swept again.
    fn keep_warm(&self, stage: &Stage) -> Result<(), Failure> {
        const LONG_ENOUGH: Duration = Duration::from_millis(150);
        /// Sweeps of one submission.
        const SWEEPS: u32 = 16;
        if self.gpu.summary.is_software() {
            return Ok(());
        }
        let distances = Distances::new(self.gpu)?;
        let start = Instant::now();
        while start.elapsed() < LONG_ENOUGH {
            let mut recorder = Recorder::new(self.gpu, None);
            for _ in 0..SWEEPS {
                distances.record(self.gpu, &mut recorder, &stage.voxels);
            }
            recorder.submit(self.gpu)?;
            self.gpu.wait()?;
        }
        Ok(())
    }

    fn traversal(&self, spec: &RowSpec, scene: &BenchScene) -> Result<Vec<Row>, Failure> {
        let stage = Stage::build(self.gpu, &scene.world)?;
        let voxels = stage.read_back(self.gpu)?;
        let repeats = if self.quick { 5 } else { 15 };
        let rows = traversal::measure(
            self.gpu,
            &scene.world,
            &voxels,
            &stage.voxels,
            spec.size,
            repeats,
        )?;
        let row = |measured: traversal::Row| {
            let mut figures = named(&[
                ("grays_per_s", measured.grays_per_s),
                ("steps_per_ray", measured.steps_per_ray),
                ("plain_grays_per_s", measured.plain_grays_per_s),
                ("mismatches", measured.mismatches as f64),
            ]);
            let ms = [("ms", measured.ms)];
            figures.extend(named(&ms));
            let kind = measured.light.unwrap_or(measured.rays);
            let name = format!("{}/{kind}", measured.camera);
            let spec = spec.clone().called(&scene.world.name, &name);
            let clock = if self.gpu.summary.is_software() {
                "wall"
            } else {
                "gpu"
            };
            Row {
                camera: measured.camera,
                layout: None,
                rays: [(measured.rays.to_owned(), u64::from(measured.count))].into(),
                ..self.row(&spec, clock, figures)
            }
        };
        Ok(rows.into_iter().map(row).collect())
    }
}

/// Bytes of a probe's two maps with their borders, in half floats: four channels of irradiance, two of
/// distance. The source's table 4.1 counts the same.
fn map_bytes(irradiance: u32, distance: u32) -> f64 {
    let texels = |edge: u32| f64::from(edge + 2) * f64::from(edge + 2);
    texels(irradiance) * 8.0 + texels(distance) * 4.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_the_bytes_of_the_sources_table() {
        let sizes = [(8, 8), (8, 16), (8, 32), (16, 16), (32, 16)];
        let bytes = sizes.map(|(irradiance, distance)| map_bytes(irradiance, distance));
        assert_eq!(bytes, [1200.0, 2096.0, 5424.0, 3888.0, 10544.0]);
    }
}
