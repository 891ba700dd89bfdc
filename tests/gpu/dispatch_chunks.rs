//! Work that is split into several dispatches writes the same bytes as a single dispatch.

use glam::{UVec3, Vec3};
use grotto::{
    frame::{Frame, Stage},
    gpu::{Gpu, Kernel, KernelSpec, Recorder, ShaderChecks, Timing, rectangle},
    lights::Lights,
    measure::picture::Picture,
    parameters::{Parameters, ProbeStates},
    passes::{
        bench::rays::{FoundHit, Marcher, RayBench, RayKind, RaySet, ShadowTarget},
        view::Shot,
    },
    world::{LayoutSpec, World},
};

use crate::support::{self, frames};

const SIZE: [u32; 2] = [90, 70];

/// A device of its own, which knows no pace yet, and whose dispatches hold `first_groups` workgroups until it does.
fn gpu(first_groups: u32) -> Gpu {
    let mut gpu = support::gpu_with(ShaderChecks::Checked);
    gpu.first_groups = first_groups;
    gpu
}

fn world() -> World {
    support::shipped("cornell")
}

fn shot(world: &World, frame: u32) -> Shot {
    Shot {
        frame,
        ..frames::shot(world.cameras[0].clone(), SIZE)
    }
}

#[derive(PartialEq)]
struct Drawn {
    radiance: Picture,
    irradiance: Vec<[f32; 3]>,
    distance: Vec<u32>,
    shadow_rays: u64,
}

/// Frames of the Cornell box with more probes than a row of workgroups holds: all of them are active in
/// the first frame, some in the others.
fn draw(gpu: &Gpu, timed: bool) -> Drawn {
    let world = world();
    let stage = Stage::build(gpu, &world).expect("fits");
    let mut parameters = Parameters::default();
    parameters.probes.rays = 32;
    parameters.probes.warmup_frames = 1;
    parameters.probes.states = ProbeStates::On;
    let layout = LayoutSpec {
        name: "test".into(),
        counts: UVec3::new(4, 3, 3),
        ..world.layouts[0].clone()
    };
    let mut frame = Frame::new(gpu, stage, &layout, &parameters.probes, SIZE).expect("fits");
    let lights = Lights::at(&world, &world.lamp_presets[0], 0.0);
    let mut timing = timed.then(|| Timing::new(gpu).expect("a clock"));
    for index in 0..3 {
        let mut recorder = Recorder::new(gpu, timing.as_mut());
        let shot = shot(&world, index);
        frame.record(gpu, &mut recorder, &shot, &lights, &parameters.probes);
        recorder.submit(gpu).expect("submits");
        gpu.wait().expect("the device lives");
        if let Some(timing) = timing.as_mut().filter(|timing| timing.supported()) {
            let times = timing.next_frame().expect("one frame was drawn");
            let labels: Vec<&str> = times.passes_ms.keys().map(|label| &**label).collect();
            let mut passes = vec![
                "view/camera_rays",
                "probes/blend",
                "probes/schedule",
                "probes/trace",
            ];
            // Only for new probes.
            if index == 0 {
                passes.extend(["probes/visibility", "probes/classify"]);
            }
            passes.extend([
                "surface_cache/lamps",
                "surface_cache/estimate",
                "surface_cache/resolve",
                "surface_cache/allocate",
                "surface_cache/place_requested",
                "surface_cache/trace",
                "view/shade",
            ]);
            passes.sort();
            assert_eq!(labels, passes, "one row per pass, however it was split");
        }
    }
    Drawn {
        radiance: frame.read_radiance(gpu).expect("reads back"),
        irradiance: frame.field().irradiance(gpu).expect("reads back"),
        distance: gpu
            .read_texture(frame.field().distance_atlas())
            .expect("reads back"),
        shadow_rays: frame.count_shadow_rays(gpu, true).expect("counts"),
    }
}

#[test]
fn frames_do_not_depend_on_dispatch_chunks() {
    let at_once = draw(&gpu(u32::MAX), false);
    assert!(at_once.shadow_rays > 1000 && at_once.radiance.rgb.iter().any(|c| c[0] > 0.0));
    assert!(at_once == draw(&gpu(1), false), "row by row");
    assert!(at_once == draw(&gpu(1), true), "split by their times");
}

/// A kernel in which each of 100 threads, one per workgroup, writes `value`.
fn writer(gpu: &Gpu, value: &str) -> Kernel {
    let source = format!(
        "import package::frame::chunk::first_row;
        @group(3) @binding(0) var<storage, read_write> outputs: array<u32>;
        @compute @workgroup_size(1)
        fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {{
            let row = id.y + first_row;
            let index = id.x + row * groups.x;
            if index < 100u {{ outputs[index] = {value}; }}
        }}"
    );
    let spec = KernelSpec {
        shader: "generated/rows",
        generated: &[("rows", &source)],
        ..Default::default()
    };
    Kernel::new(gpu, &spec).unwrap_or_else(|error| panic!("{error}"))
}

/// What the threads of [`writer`] write.
fn written(first_groups: u32, value: &str) -> Vec<u32> {
    let gpu = gpu(first_groups);
    let kernel = writer(&gpu, value);
    let outputs = gpu.storage_buffer("outputs", 400).expect("fits");
    let bindings = kernel.bind(&gpu, &[("outputs", outputs.as_entire_binding())]);
    let mut recorder = Recorder::new(&gpu, None);
    recorder.run(&kernel, &bindings, rectangle(100));
    recorder.submit(&gpu).expect("submits");
    gpu.read_buffer(&outputs).expect("reads back")
}

#[test]
fn a_dispatch_that_ignores_where_it_begins_is_found() {
    let rows: Vec<u32> = (0..100).map(|index| index / rectangle(100)[0]).collect();
    assert_eq!(written(u32::MAX, "row"), rows);
    assert_eq!(written(1, "row"), rows);
    // Each dispatch counts its own rows from 0, so the comparison sees that the work was split.
    assert_eq!(written(u32::MAX, "id.y"), rows);
    assert_ne!(written(1, "id.y"), rows);
}

#[test]
fn bench_rays_do_not_depend_on_dispatch_chunks() {
    let found = |first_groups: u32| -> Vec<Vec<FoundHit>> {
        let gpu = gpu(first_groups);
        let world = world();
        let stage = Stage::build(&gpu, &world).expect("fits");
        let buffer = gpu.uniform_buffer("view", &shot(&world, 0).to_gpu());
        let probes: Vec<UVec3> = (1..30).map(|at| UVec3::new(at, 5, 7)).collect();
        let directions: Vec<Vec3> = (0..64)
            .map(|i| {
                Vec3::new(
                    (i % 7) as f32 - 3.2,
                    (i % 5) as f32 - 2.1,
                    (i % 3) as f32 - 1.3,
                )
            })
            .collect();
        let rays = RaySet {
            view: &buffer,
            size: SIZE,
            rays_per_edge: 1,
            probes: &probes,
            directions: &directions,
        };
        let mut bench = RayBench::new(&gpu, &stage.voxels, &rays).expect("fits");
        let light = ShadowTarget::Lamp(Vec3::splat(20.0));
        bench.aim(&gpu, light).expect("runs");
        let kinds = [RayKind::Camera, RayKind::Shadow, RayKind::Probe];
        let marchers = [Marcher::BrickMap, Marcher::PlainDda];
        kinds
            .iter()
            .flat_map(|kind| marchers.iter().map(|marcher| (*kind, *marcher)))
            .map(|(kind, marcher)| bench.hits(&gpu, kind, marcher).expect("runs"))
            .collect()
    };
    let at_once = found(u32::MAX);
    assert!(
        at_once
            .iter()
            .flatten()
            .any(|hit| hit.place != FoundHit::MISS)
    );
    assert_eq!(at_once, found(1));
}

/// This holds however frames are timed, and when the kernel is bound again. Two runs are enough on an idle machine; on
/// a busy one a run may be measured as slow, and is forgotten after some more.
#[test]
fn fast_work_soon_takes_one_dispatch() {
    for timing in ["none", "whole", "by pass"] {
        let gpu = gpu(1);
        let mut clock = Timing::new(&gpu).expect("a clock");
        let kernel = writer(&gpu, "row");
        let outputs = gpu.storage_buffer("outputs", 400).expect("fits");
        let mut dispatches = Vec::new();
        while dispatches.len() < 40 && dispatches.last() != Some(&1) {
            let bindings = kernel.bind(&gpu, &[("outputs", outputs.as_entire_binding())]);
            let mut recorder = match timing {
                "none" => Recorder::new(&gpu, None),
                "whole" => Recorder::new_whole(&gpu, &mut clock),
                _ => Recorder::new(&gpu, Some(&mut clock)),
            };
            recorder.run(&kernel, &bindings, rectangle(100));
            dispatches.push(recorder.dispatches());
            recorder.submit(&gpu).expect("submits");
            gpu.wait().expect("the device lives");
            while clock.next_frame().is_some() {}
        }
        assert!(dispatches[0] > 1, "{timing}: nothing is known at first");
        assert_eq!(dispatches.last(), Some(&1), "{timing}: {dispatches:?}");
    }
}
