//! Voxelising worlds: the CPU's reference against the definition, and the GPU against the CPU.

mod worlds;

use crate::support::{gpu, parsed, shipped};
use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::gpu::{Gpu, Kernel, KernelSpec, Recorder};
use grotto::passes::scene::distances::Distances;
use grotto::passes::scene::voxelise::{Voxelise, VoxeliseReport};
use grotto::world::World;
use grotto::world::generate::{differing, generate};
use grotto::world::noise::NoiseBank;
use grotto::world::rules::RuleSet;
use grotto::world::sdf::{Displace, Empty, Sdf, Shape, SmoothUnion, Subtraction, shape_module};
use grotto::world::voxels::Voxels;
use worlds::{everything, features, moved, rules, sphere, world};

/// The definition, voxel by voxel, with nothing skipped.
fn by_definition(world: &World) -> Vec<u8> {
    let shape = Shape::new(&world.shape, &world.noises);
    let rules = RuleSet::new(&world.rules, &shape);
    let size = world.size.as_ivec3();
    let centre = |voxel: IVec3| (world.origin + voxel).as_dvec3() + 0.5;
    let inside = |voxel: IVec3| voxel.cmpge(IVec3::ZERO).all() && voxel.cmplt(size).all();
    let solid = |voxel: IVec3| !inside(voxel) || shape.eval(centre(voxel)) < 0.0;
    let material = |voxel: IVec3| {
        let value = shape.eval(centre(voxel));
        rules.material(centre(voxel), value, &shape)
    };
    let full =
        |cell: IVec3| (0..512).all(|i| solid(cell * 8 + IVec3::new(i & 7, i >> 3 & 7, i >> 6)));
    let mut buried = std::collections::HashMap::new();
    let mut voxels = Vec::new();
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                let voxel = IVec3::new(x, y, z);
                if !solid(voxel) {
                    let here = world
                        .features
                        .iter()
                        .rev()
                        .find(|part| part.contains(world.origin + voxel));
                    voxels.push(here.map_or(0, |part| part.material));
                    continue;
                }
                let cell = voxel / 8;
                let is_buried = *buried.entry(cell).or_insert_with(|| {
                    let beside = [
                        IVec3::X,
                        IVec3::Y,
                        IVec3::Z,
                        -IVec3::X,
                        -IVec3::Y,
                        -IVec3::Z,
                    ];
                    inside(cell * 8 + 7)
                        && full(cell)
                        && beside.iter().all(|side| full(cell + side))
                });
                voxels.push(material(if is_buried { cell * 8 + 4 } else { voxel }));
            }
        }
    }
    voxels
}

fn listed(voxels: &Voxels) -> Vec<u8> {
    let size = voxels.size().as_ivec3();
    let each = (0..size.z)
        .flat_map(|z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec3::new(x, y, z))));
    each.map(|voxel| voxels.material(voxel)).collect()
}

#[test]
fn generation_equals_the_definition() {
    for (size, shape) in [
        (UVec3::new(45, 30, 50), everything()),
        (UVec3::splat(40), sphere(14.0)),
        (UVec3::splat(33), Sdf::from(Empty)),
        (
            UVec3::splat(33),
            moved(
                [3.0, 0.0, 0.0],
                Sdf::from(Subtraction(vec![sphere(90.0), sphere(6.0)])),
            ),
        ),
    ] {
        let world = world(size, shape, rules(), features());
        let voxels = generate(&world);
        let (found, wanted) = (listed(&voxels), by_definition(&world));
        let differing = found.iter().zip(&wanted).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{:?}", world.shape);
        assert!(
            wanted.iter().any(|m| *m > 6) && wanted.contains(&0),
            "features and air"
        );
    }
}

const PROBE: &str = "
import package::generated::shape::{shape, material_by};

@group(3) @binding(0) var<storage, read> points: array<vec4f>;
@group(3) @binding(1) var<storage, read_write> found: array<vec2f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&points) {
        let p = points[id.x].xyz;
        var values: vec3f;
        for (var k = 0u; k < 3u; k += 1u) {
            values[k] = shape(p + vec3f(0.0, f32(k & 1u) - f32(k >> 1u), 0.0));
        }
        found[id.x] = vec2f(values.x, f32(material_by(p, values)));
    }
}
";

/// (shape, material) at each point.
fn on_gpu(gpu: &Gpu, world: &World, points: &[[f32; 4]]) -> Vec<[f32; 2]> {
    let module = shape_module(world);
    let spec = KernelSpec {
        shader: "generated/probe",
        generated: &[("probe", PROBE), ("shape", &module)],
        ..Default::default()
    };
    let kernel = Kernel::new(gpu, &spec).expect("the module compiles");
    let bank = NoiseBank::new(&world.noises);
    let tables = gpu
        .storage_buffer_of("noise_tables", &bank.packed_tables())
        .expect("fits");
    let input = gpu.storage_buffer_of("points", points).expect("fits");
    let found = gpu
        .storage_buffer("found", points.len() as u64 * 8)
        .expect("fits");
    let bindings = kernel.bind(
        gpu,
        &[
            ("noise_tables", tables.as_entire_binding()),
            ("points", input.as_entire_binding()),
            ("found", found.as_entire_binding()),
        ],
    );
    let mut recorder = Recorder::new(gpu, None);
    recorder.compute("probe", |pass| {
        kernel.dispatch_threads(pass, &bindings, [points.len() as u32, 1, 1]);
    });
    recorder.submit(gpu).expect("submits");
    let mut values = gpu.read_buffer(&found).expect("reads back");
    values.truncate(points.len());
    values
}

fn points(count: usize) -> Vec<[f32; 4]> {
    let point = |i: usize| {
        let i = i as f64 + 0.5;
        let p = DVec3::new(i * 8.191_725_134, i * 6.710_436_067, i * 5.497_004_779) % 60.0 - 30.0;
        [p.x as f32, p.y as f32, p.z as f32, 0.0]
    };
    (0..count).map(point).collect()
}

#[test]
fn the_shader_computes_the_values_of_the_cpu() {
    let gpu = gpu();
    let mut trees: Vec<Sdf> = (0..6)
        .map(|noise| {
            Sdf::from(Displace {
                noise,
                amplitude: 5.0,
                of: Box::new(sphere(9.0)),
            })
        })
        .collect();
    trees.push(everything());
    for tree in trees {
        let world = world(UVec3::splat(8), tree, rules(), Vec::new());
        compare_values(&gpu, &world, 4000);
    }
}

#[test]
fn the_shader_computes_the_shapes_of_the_readme() {
    let gpu = gpu();
    for (_, world) in crate::support::examples::shapes() {
        compare_values(&gpu, &world, 1000);
    }
}

/// Compares values and materials of this many points.
fn compare_values(gpu: &Gpu, world: &World, count: usize) {
    let far_from_steps = |p: DVec3| (p.y - p.y.round()).abs() > 1e-3;
    let shape = Shape::new(&world.shape, &world.noises);
    let rules = RuleSet::new(&world.rules, &shape);
    let points = points(count);
    let mut disagreeing = 0;
    for (point, [value, material]) in points.iter().zip(on_gpu(gpu, world, &points)) {
        let p = Vec3::from_slice(&point[..3]).as_dvec3();
        // The GPU has no infinity.
        let wanted = shape.eval(p).min(1e30);
        // Near the edge of a step the two may round a height to different steps.
        if far_from_steps(p) {
            assert!(
                (f64::from(value) - wanted).abs() < 2e-3 || wanted == 1e30 && value > 9e29,
                "{:?}\nat {p}: {value}, {wanted}",
                world.shape
            );
        }
        disagreeing += usize::from(material != f32::from(rules.material(p, wanted, &shape)));
    }
    assert!(
        disagreeing * 1000 <= count,
        "{disagreeing} of {count} materials differ"
    );
}

#[test]
fn a_tree_of_hundreds_of_nodes_compiles_in_time() {
    let spheres = (0..400).map(|i| moved([f64::from(i), 0.0, f64::from(i * 7 % 31)], sphere(3.0)));
    let world = world(
        UVec3::splat(8),
        Sdf::from(SmoothUnion {
            k: 1.0,
            of: spheres.collect(),
        }),
        rules(),
        Vec::new(),
    );
    let start = std::time::Instant::now();
    let found = on_gpu(&gpu(), &world, &points(64));
    assert_eq!(found.len(), 64);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

/// The voxels that the GPU builds, with their distances.
fn voxelised(gpu: &Gpu, world: &World) -> (Voxels, VoxeliseReport) {
    let pass = Voxelise::new(gpu, world).expect("compiles");
    let (voxels, report) = pass.run(gpu, world).expect("fits");
    let mut recorder = Recorder::new(gpu, None);
    Distances::new(gpu)
        .expect("compiles")
        .record(gpu, &mut recorder, &voxels);
    recorder.submit(gpu).expect("submits");
    (voxels.read_back(gpu).expect("reads back"), report)
}

#[test]
fn the_gpu_builds_the_voxels_of_the_cpu() {
    let gpu = gpu();
    for (size, shape, features) in [
        (UVec3::new(45, 30, 50), everything(), features()),
        (
            UVec3::splat(48),
            moved(
                [3.0, 0.0, 0.0],
                Sdf::from(Subtraction(vec![sphere(90.0), sphere(9.0)])),
            ),
            features(),
        ),
        (UVec3::splat(24), Sdf::from(Empty), Vec::new()),
    ] {
        let world = world(size, shape, rules(), features);
        let (found, report) = voxelised(&gpu, &world);
        let wanted = generate(&world);
        assert_eq!(found.validate(), Ok(()));
        let count = differing(&world, &found, &wanted, 1e-3).unwrap();
        let all = size.element_product();
        println!("{count} of {all} voxels differ, within rounding ({report:?})");
        assert!(
            f64::from(count as u32) <= 1e-4 * f64::from(all),
            "{count} of {all}"
        );
        assert_eq!(found.bricks(), report.bricks as usize);
    }
}

/// A voxel of this world is where its noise is exactly 0, the edge of a step. A GPU that rounded to less than 0 left it out.
#[test]
fn ground_in_steps_is_the_same_where_its_noise_is_zero() {
    let gpu = gpu();
    let text = "(
        title: \"Steps.\", size: (17, 4, 64), origin: (385, 501, 0), seed: 1,
        noises: {\"n\": (basis: Perlin, frequency: 0.021)},
        shape: Translate(by: (401.5, 507.5, 0), of: HeightField(noise: \"n\", base: -1.636, amplitude: 0.934, step: 1.461)),
        materials: {},
    )";
    let world = parsed(text);
    let (found, _) = voxelised(&gpu, &world);
    let wanted = generate(&world);
    assert_eq!(differing(&world, &found, &wanted, 1e-3), Ok(0));
    let voxel = IVec3::new(16, 3, 0);
    assert_ne!(wanted.material(voxel), 0);
    let centre = (world.origin + voxel).as_dvec3() + 0.5 - DVec3::new(401.5, 507.5, 0.0);
    let value = NoiseBank::new(&world.noises).value(0, centre.with_y(0.0));
    assert_eq!(value, 0.0);
}

#[test]
fn the_comparison_notices_a_voxel_out_of_place() {
    let world = world(UVec3::splat(40), sphere(14.0), rules(), Vec::new());
    let wanted = generate(&world);
    let mut found = wanted.clone();
    found.set(IVec3::new(20, 12, 24), 0);
    assert!(differing(&world, &found, &wanted, 1e-3).is_err());
}

#[test]
fn a_world_beyond_the_limits_is_refused() {
    let gpu = gpu();
    let world = world(
        UVec3::new(1 << 20, 1 << 14, 1 << 20),
        sphere(14.0),
        rules(),
        Vec::new(),
    );
    let result = Voxelise::new(&gpu, &world)
        .expect("compiles")
        .run(&gpu, &world);
    let error = result.err().expect("too large");
    assert!(error.to_string().contains("bytes"), "{error}");
}

#[test]
fn the_shipped_worlds_are_the_same_on_both() {
    let gpu = gpu();
    for name in ["cave", "cornell", "minimal"] {
        let world = shipped(name);
        let (found, report) = voxelised(&gpu, &world);
        let wanted = generate(&world);
        assert_eq!(found.validate(), Ok(()));
        let count = differing(&world, &found, &wanted, 1e-3).expect("within rounding");
        let all = world.size.element_product();
        println!("{name}: {count} of {all} voxels differ ({report:?})");
        assert!(
            f64::from(count as u32) <= 1e-4 * f64::from(all),
            "{name}: {count} of {all}"
        );
    }
}
