//! Whether memory grows and frames slow down over minutes.

use std::collections::BTreeMap;

use serde::Serialize;
use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System};

use super::judge::Check;
use crate::{gpu::Gpu, measure::statistics::median};

/// Measurements at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sample {
    /// Seconds since the start.
    pub time_s: f64,
    /// Resident memory of this process.
    pub process_bytes: f64,
    /// Bytes that the adapter's allocator has given out.
    pub adapter_bytes: f64,
    /// Devices, buffers, textures and bind groups that exist.
    pub objects: f64,
    /// Median milliseconds of the frames since the last sample.
    pub frame_ms: f64,
}

/// Measures this process.
pub struct Process {
    system: Option<System>,
    id: Option<Pid>,
}

impl Process {
    /// The process that this code runs in.
    pub fn this() -> Self {
        Self {
            system: System::new().ok(),
            id: sysinfo::get_current_pid().ok(),
        }
    }

    /// Resident bytes; 0 where the system does not report them.
    pub fn bytes(&mut self) -> u64 {
        let (Some(system), Some(id)) = (&mut self.system, self.id) else {
            return 0;
        };
        let memory = ProcessRefreshKind::nothing().with_memory();
        system.refresh_processes_specifics(ProcessesToUpdate::Some(&[id]), false, memory);
        system.process(id).map_or(0, sysinfo::Process::memory)
    }
}

/// The objects and the memory of all devices of an instance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Devices, buffers, textures and bind groups.
    pub objects: u64,
    /// Bytes that the device's allocator has given out; 0 where it does not report them.
    pub bytes: u64,
}

impl Footprint {
    /// The footprint of all devices of the instance. Submitted work must be finished.
    pub fn of(gpu: &Gpu) -> Self {
        let objects = gpu.instance.generate_report().map_or(0, |report| {
            let hub = report.hub_report();
            let kinds = [&hub.devices, &hub.buffers, &hub.textures, &hub.bind_groups];
            kinds
                .map(|kind| kind.num_kept_from_user as u64)
                .iter()
                .sum()
        });
        let report = gpu.device.generate_allocator_report();
        Self {
            objects,
            bytes: report.map_or(0, |report| report.total_allocated_bytes),
        }
    }
}

/// Name of the check of the process.
const PROCESS: &str = "soak.process_growth_bytes";
/// Share of the samples that is left out at the start, while caches fill.
const WARM_UP: f64 = 0.2;
/// Fewer samples say nothing.
const LEAST_SAMPLES: usize = 6;
/// Standard errors above 0 from which a slope is significant.
const SURE: f64 = 4.0;
/// Where growth is steady, each half of the run has at least this share of the whole slope; a single step does
/// not.
const LEAST_IN_HALVES: f64 = 0.25;
/// Allowed growth of the process over the run: allocators keep memory that was freed.
const PROCESS_GROWTH: f64 = 32.0 * 1024.0 * 1024.0;
/// Allowed growth of the adapter's allocator: an edit occasionally enlarges a buffer by half.
const ADAPTER_GROWTH: f64 = 4.0 * 1024.0 * 1024.0;
const OBJECT_GROWTH: f64 = 16.0;
/// Largest share by which frames at the end may be slower than at the start.
const DRIFT: f64 = 0.1;

/// A straight line through points by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    slope: f64,
    standard_error: f64,
}

impl Line {
    /// `None` for fewer than three points, or if all have the same time.
    fn through(points: &[(f64, f64)]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (middle_x, middle_y) = (mean(&|point| point.0), mean(&|point| point.1));
        let spread: f64 = points.iter().map(|(x, _)| (x - middle_x).powi(2)).sum();
        if points.len() < 3 || spread <= 0.0 {
            return None;
        }
        let common: f64 = points
            .iter()
            .map(|(x, y)| (x - middle_x) * (y - middle_y))
            .sum();
        let slope = common / spread;
        let left: f64 = points
            .iter()
            .map(|(x, y)| (y - middle_y - slope * (x - middle_x)).powi(2))
            .sum();
        Some(Self {
            slope,
            standard_error: (left / (count - 2.0) / spread).sqrt(),
        })
    }
}

/// Rise of a line through samples (moment, value) over the whole run. It is 0 unless the samples rise steadily: in
/// both halves, and by more than their scatter explains.
pub fn steady_growth(points: &[(f64, f64)]) -> f64 {
    let (first, second) = points.split_at(points.len() / 2);
    let lines = [points, first, second].map(Line::through);
    let [Some(whole), Some(first), Some(second)] = lines else {
        return 0.0;
    };
    let is_sure = whole.slope > SURE * whole.standard_error;
    let least = LEAST_IN_HALVES * whole.slope;
    if !is_sure || first.slope <= least || second.slope <= least {
        return 0.0;
    }
    let span = points[points.len() - 1].0 - points[0].0;
    whole.slope * span
}

/// Which values of a soak are judged; the others are only reported.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    /// The memory of the process.
    pub process: bool,
    /// The times of its frames.
    pub times: bool,
}

/// Judges a run by its samples; the values are added to `measured`.
pub fn judge(
    samples: &[Sample],
    judged: Judged,
    measured: &mut BTreeMap<String, f64>,
) -> Vec<Check> {
    let skipped = (samples.len() as f64 * WARM_UP).ceil() as usize;
    let settled = &samples[skipped.min(samples.len())..];
    let too_few = LEAST_SAMPLES.saturating_sub(settled.len());
    let mut checks = vec![Check::none("soak.samples_missing", too_few as u64)];
    /// Name of the check, value of a sample, and allowed growth.
    type Part = (&'static str, fn(&Sample) -> f64, f64);
    let parts: [Part; 3] = [
        (PROCESS, |s| s.process_bytes, PROCESS_GROWTH),
        (
            "soak.adapter_growth_bytes",
            |s| s.adapter_bytes,
            ADAPTER_GROWTH,
        ),
        ("soak.object_growth", |s| s.objects, OBJECT_GROWTH),
    ];
    for (name, of, bound) in parts {
        let points: Vec<(f64, f64)> = settled.iter().map(|s| (s.time_s, of(s))).collect();
        let check = Check::at_most(name, steady_growth(&points), bound);
        let told = name == PROCESS && !judged.process;
        checks.push(if told { check.told() } else { check }.measured(measured));
    }
    let drift = drift(settled).unwrap_or(0.0);
    let check = Check::at_most("soak.frame_time_drift", drift, DRIFT);
    checks.push(if judged.times { check } else { check.told() }.measured(measured));
    checks
}

/// Share by which the last tenth of the samples is slower than the first.
fn drift(samples: &[Sample]) -> Option<f64> {
    let tenth = samples.len().div_ceil(10);
    let of = |samples: &[Sample]| {
        let times: Vec<f64> = samples.iter().map(|sample| sample.frame_ms).collect();
        median(&times)
    };
    let first = of(samples.get(..tenth)?)?;
    let last = of(samples.get(samples.len() - tenth..)?)?;
    Some(last / first - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Judged = Judged {
        process: true,
        times: true,
    };
    const MIB: f64 = 1024.0 * 1024.0;

    /// A minute of changes with scatter, modified by `change`.
    fn run(change: impl Fn(usize, &mut Sample)) -> Vec<Sample> {
        let sample = |index: usize| {
            let scatter = ((index * 37) % 11) as f64 / 11.0;
            let mut sample = Sample {
                time_s: index as f64,
                process_bytes: 400.0 * MIB + 3.0 * MIB * scatter,
                adapter_bytes: 120.0 * MIB + 0.3 * MIB * scatter,
                objects: 90.0 + (2.0 * scatter).round(),
                frame_ms: 5.0 + 0.2 * scatter,
            };
            change(index, &mut sample);
            sample
        };
        (0..100).map(sample).collect()
    }

    fn failed(samples: &[Sample]) -> Vec<String> {
        let checks = judge(samples, ALL, &mut BTreeMap::new());
        let failed = checks.into_iter().filter(|check| !check.passed);
        failed.map(|check| check.name).collect()
    }

    #[test]
    fn a_line_is_found_with_its_error() {
        let exact: Vec<(f64, f64)> = (0..9)
            .map(|i| (f64::from(i), 3.0 - 2.0 * f64::from(i)))
            .collect();
        let line = Line::through(&exact).expect("points");
        assert!((line.slope + 2.0).abs() < 1e-12 && line.standard_error < 1e-9);
        assert_eq!(Line::through(&exact[..2]), None);
        assert_eq!(Line::through(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]), None);
    }

    #[test]
    fn steady_play_passes() {
        assert_eq!(failed(&run(|_, _| ())), Vec::<String>::new());
    }

    #[test]
    fn what_grows_and_slows_is_found() {
        let leak = run(|i, sample| sample.process_bytes += 0.6 * MIB * i as f64);
        assert_eq!(failed(&leak), ["soak.process_growth_bytes"]);
        let leak = run(|i, sample| {
            sample.adapter_bytes += 0.07 * MIB * i as f64;
            sample.objects += i as f64;
        });
        assert_eq!(
            failed(&leak),
            ["soak.adapter_growth_bytes", "soak.object_growth"]
        );
        let slow = run(|i, sample| sample.frame_ms *= 1.0 + 0.002 * i as f64);
        assert_eq!(failed(&slow), ["soak.frame_time_drift"]);
        assert_eq!(failed(&run(|_, _| ())[..6]), ["soak.samples_missing"]);
    }

    #[test]
    fn caches_that_fill_once_are_no_leak() {
        // Growth in the warm-up, and a single step later.
        let warm = run(|i, sample| sample.process_bytes += 10.0 * MIB * i.min(15) as f64);
        assert_eq!(failed(&warm), Vec::<String>::new());
        let step = run(|i, sample| sample.process_bytes += if i > 60 { 40.0 * MIB } else { 0.0 });
        assert_eq!(failed(&step), Vec::<String>::new());
    }

    #[test]
    fn times_of_a_cpu_are_told_and_not_judged() {
        let slow = run(|i, sample| sample.frame_ms *= 1.0 + 0.02 * i as f64);
        let mut measured = BTreeMap::new();
        let told = Judged {
            process: false,
            times: false,
        };
        let checks = judge(&slow, told, &mut measured);
        assert!(checks.iter().all(|check| check.passed));
        assert!(measured["soak.frame_time_drift"] > 0.5);
    }

    #[test]
    fn this_process_takes_memory() {
        let mut process = Process::this();
        if cfg!(target_os = "linux") {
            assert!(process.bytes() > 1 << 20);
        }
    }
}
