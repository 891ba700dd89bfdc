//! Made-up reports, for tests of whatever reads reports.

use std::collections::BTreeMap;

use super::{
    super::shard::Shard,
    model::{
        Adapter, Build, Figure, GpuState, KIND, Machine, Missing, Part, Probes, Quality, Report,
        Row, SCHEMA, Timing, Varied, WorldRecord,
    },
};
use crate::measure::frame_times::{FrameStatistics, Interval};

pub fn adapter() -> Adapter {
    Adapter {
        name: "Card 9000".to_owned(),
        kind: "discrete".to_owned(),
        driver: "driver 1.2".to_owned(),
        backend: "vulkan".to_owned(),
    }
}

/// A row of `layouts` whose five runs scatter by ±0.2 % around `ms`.
pub fn row(id: &str, ms: f64) -> Row {
    let parts: Vec<&str> = id.split('/').collect();
    let frames: Vec<f64> = (0..600)
        .map(|frame| ms * if frame % 97 == 96 { 1.8 } else { 1.0 })
        .collect();
    let statistics = FrameStatistics::of(&frames).expect("frames");
    let passes = BTreeMap::from([
        ("view/camera_rays".to_owned(), 0.2 * ms),
        ("probe_trace".to_owned(), 0.5 * ms),
        ("view/shade".to_owned(), 0.25 * ms),
    ]);
    let scattered = |middle: f64| [-0.002, 0.001, 0.0, 0.002, -0.001].map(|by| middle * (1.0 + by));
    let runs = scattered(ms).to_vec();
    Row {
        id: id.to_owned(),
        place: 0,
        suite: parts[0].to_owned(),
        world: parts[1].to_owned(),
        camera: "start".to_owned(),
        layout: parts.get(2).map(|&name| name.to_owned()),
        condition: parts.get(3).unwrap_or(&"moving").to_string(),
        view: "full".to_owned(),
        size: [1920, 1080],
        frames: 64,
        seed: 0,
        varied: BTreeMap::new(),
        set: Vec::new(),
        adapter: adapter(),
        clock: "gpu".to_owned(),
        timing: Some(Timing {
            interval: Interval::of(&runs).expect("runs"),
            runs_ms: runs,
            pass_runs_ms: (passes.iter())
                .map(|(name, ms)| (name.clone(), scattered(*ms).to_vec()))
                .collect(),
            noisy: false,
            cpu_ms: FrameStatistics::of(&[0.2 * ms; 600]).expect("frames"),
            wall_ms: FrameStatistics::of(&[1.1 * ms; 600]).expect("frames"),
            curve_ms: frames.iter().map(|&ms| ms as f32).collect(),
            histogram: vec![0, 3, 400, 150, 40, 7],
            histogram_from_ms: 0.9 * ms,
            histogram_step_ms: 0.05 * ms,
        }),
        fps: Some(1e3 / statistics.median),
        frame_ms: Some(statistics),
        passes,
        rays: BTreeMap::from([("probe".to_owned(), 1000), ("camera".to_owned(), 2_073_600)]),
        mrays_per_s: BTreeMap::from([("probe".to_owned(), 812.5)]),
        probes: Some(Probes {
            total: 175,
            alive: 100,
            sleeping: 25,
            dead: 50,
            updated: 100,
        }),
        memory_bytes: BTreeMap::from([("total".to_owned(), 12_345_678)]),
        figures: BTreeMap::new(),
        quality: None,
    }
}

/// A row that is not about frames.
pub fn figure_row(id: &str, name: &str, value: f64) -> Row {
    let half_width = Some(0.002 * value);
    Row {
        timing: None,
        fps: None,
        frame_ms: None,
        passes: BTreeMap::new(),
        figures: BTreeMap::from([(name.to_owned(), Figure { value, half_width })]),
        ..row(id, 1.0)
    }
}

pub fn varied(mut row: Row, key: &str, value: f64) -> Row {
    row.varied.insert(key.to_owned(), Varied::Number(value));
    row
}

/// Layouts of the cave under two conditions with their quality, a series of ray counts, and one figure.
pub fn report() -> Report {
    let mut rows = Vec::new();
    for (index, layout) in ["layout1", "layout2", "layout3", "layout4"]
        .iter()
        .enumerate()
    {
        let ms = 0.8 + 0.1 * index as f64;
        let mut still = row(&format!("layouts/cave/{layout}/still"), 0.8 * ms);
        still.quality = Some(Quality {
            flip: 0.08 - 0.01 * index as f64,
            energy: Some(0.97),
            spp: 256,
            size: [640, 360],
        });
        rows.extend([still, row(&format!("layouts/cave/{layout}/moving"), ms)]);
    }
    for rays in [8.0, 64.0, 512.0] {
        let id = format!("rays/cave/layout1/moving/{rays}");
        rows.push(varied(row(&id, f64::powf(rays, 0.5)), "probes.rays", rays));
    }
    rows.push(figure_row("start/cave/layout1", "first_frame_ms", 812.0));
    let state = GpuState {
        graphics_mhz: Some(1980),
        memory_mhz: Some(3201),
        power_w: Some(312.5),
        temperature_c: Some(45),
    };
    Report {
        kind: KIND.to_owned(),
        schema: SCHEMA,
        suite: "all".to_owned(),
        complete: true,
        quick: false,
        shard: Shard::WHOLE,
        command: vec!["bench".to_owned(), "all".to_owned()],
        started: "2026-11-22T20:00:00Z".to_owned(),
        elapsed_s: 321.5,
        build: Build {
            version: "0.1.0".to_owned(),
            commit: "0123456789ab".to_owned(),
            profile: "release".to_owned(),
        },
        machine: Machine {
            cpu: "CPU 64".to_owned(),
            cores: 64,
            memory_bytes: 1 << 38,
            os: "Linux 6.1".to_owned(),
            warm_up: "2 s of frames".to_owned(),
            gpu_before: Some(state),
            gpu_after: Some(state),
        },
        worlds: vec![WorldRecord {
            name: "cave".to_owned(),
            title: "A cave with mushrooms".to_owned(),
            hash: "0123456789abcdef".repeat(2),
            seed: 7,
            size: [73, 40, 67],
            picture: None,
        }],
        rows,
        missing: Vec::new(),
        parts: Vec::new(),
    }
}

/// A report in which nothing is empty or `null`, so that it has every key of the schema.
pub fn full_report() -> Report {
    let mut full = report();
    for row in &mut full.rows {
        row.varied.insert("key".to_owned(), Varied::Number(1.0));
        let half_width = Some(0.1);
        let value = 1.0;
        row.figures
            .insert("figure_ms".to_owned(), Figure { value, half_width });
    }
    full.missing.push(Missing {
        id: "none".to_owned(),
        reason: "no reason".to_owned(),
    });
    full.parts.push(Part {
        label: "card".to_owned(),
        suite: full.suite.clone(),
        complete: true,
        quick: false,
        command: full.command.clone(),
        started: full.started.clone(),
        elapsed_s: 1.0,
        build: full.build.clone(),
        machine: full.machine.clone(),
    });
    full
}
