//! Rigid bodies: rays against the CPU's marching, bodies against the same voxels in the grid, light against laws and
//! the path tracers.

mod distances;
mod emitters;
mod gather;
mod lamps;
mod light;
mod shafts;
mod shutters;
mod stone;

use std::{f32::consts::PI, sync::atomic::AtomicBool};

use glam::{DVec3, IVec3, Quat, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    measure::picture::Picture,
    parameters::{Antialias, ProbeParameters},
    passes::scene::{GpuBodies, GpuVoxels},
    reference::{
        self, FilmOptions, PosedBodies, RenderOptions,
        bodies::BodyOutcome,
        march::{Outcome, Ray, march},
    },
    world::{
        LampPreset, View, World,
        bodies::{Bodies, Body, BodyModel, BodyMotion, Pose},
        generate,
    },
};

use crate::support::{
    self,
    frames::{Drawn, apart, mean},
    scenes::{flat, voxels_from},
};

/// A pseudorandom number in [0, 1).
fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277_803_737);
    ((word >> 22 ^ word) >> 8) as f32 / 16_777_216.0
}

fn random_vector(state: &mut u32) -> Vec3 {
    Vec3::ZERO.map(|_| random(state))
}

fn random_direction(state: &mut u32) -> Vec3 {
    let from_middle = random_vector(state) * 2.0 - 1.0;
    from_middle.normalize_or(Vec3::X)
}

fn model(size: UVec3, material: impl Fn(UVec3) -> u8) -> BodyModel {
    let voxels = 0..size.element_product();
    let places = voxels.map(|i| UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y)));
    BodyModel {
        size,
        materials: places.map(material).collect(),
    }
}

fn body(model: usize, pivot: Vec3, position: Vec3, rotation: Quat) -> Body {
    Body {
        name: "body".into(),
        model,
        pivot,
        rest: Pose { position, rotation },
        motion: Vec::new(),
        put_by: Default::default(),
    }
}

/// Models of all kinds of sizes, some sparse, at random poses in a box of this size.
fn scattered(count: usize, size: Vec3, state: &mut u32) -> Bodies {
    let mut bodies = Bodies::default();
    for extent in [(1, 1, 1), (7, 3, 5), (4, 8, 12), (17, 9, 30)] {
        let density = if extent.0 == 1 {
            1.0
        } else {
            0.1 + 0.3 * random(state)
        };
        let mut seed = *state;
        let solid: Vec<bool> = (0..extent.0 * extent.1 * extent.2)
            .map(|_| random(&mut seed) < density)
            .collect();
        let extent = UVec3::from(extent);
        let place = |at: UVec3| (at.x + extent.x * (at.y + extent.y * at.z)) as usize;
        bodies
            .models
            .push(model(extent, |at| u8::from(solid[place(at)])));
        *state = seed;
    }
    for number in 0..count {
        let which = number % bodies.models.len();
        let pivot = random_vector(state) * bodies.models[which].size.as_vec3();
        let turn = Quat::from_axis_angle(random_direction(state), 2.0 * PI * random(state));
        let position = random_vector(state) * size;
        bodies.bodies.push(body(which, pivot, position, turn));
    }
    bodies
}

/// What two rays of a thread found: the given one, and one that leaves what it hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Found {
    voxel: [u32; 3],
    face: u32,
    t: f32,
    body: u32,
    found: u32,
    pad: u32,
    point_gs: [f32; 3],
    pad1: u32,
}

const KERNEL: &str = "
    import package::march::march::{march, march_out_of};
    import package::march::surface::{point_on_surface, start_on, surface_of};
    struct Two { origin: vec4f, first: vec4f, second: vec4f }
    struct Found { voxel: vec3u, face: u32, t: f32, body: u32, found: u32, point_gs: vec3f }
    @group(3) @binding(0) var<storage, read> inputs: array<Two>;
    @group(3) @binding(1) var<storage, read_write> outputs: array<Found>;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x >= arrayLength(&inputs) { return; }
        let rays = inputs[id.x];
        let hit = march(rays.origin.xyz, rays.first.xyz, rays.first.w);
        let surface = surface_of(hit);
        let point_gs = point_on_surface(rays.origin.xyz + hit.t * rays.first.xyz, surface);
        outputs[2u * id.x] = Found(hit.voxel, hit.face, hit.t, hit.body, u32(hit.found), point_gs);
        if hit.found && hit.face < 6u {
            let next = march_out_of(point_gs, start_on(surface, point_gs), rays.second.xyz, rays.second.w);
            outputs[2u * id.x + 1u] = Found(next.voxel, next.face, next.t, next.body, u32(next.found), vec3f(0.0));
        }
    }";

fn marched(gpu: &Gpu, voxels: &GpuVoxels, rays: &[[[f32; 4]; 3]]) -> Vec<Found> {
    let spec = KernelSpec {
        shader: "generated/two_rays",
        generated: &[("two_rays", KERNEL)],
        overrides: &[("BODIES", 1.0)],
        ..Default::default()
    };
    let kernel = Kernel::new(gpu, &spec).unwrap_or_else(|error| panic!("{error}"));
    let inputs = gpu
        .storage_buffer_of("inputs", rays.as_flattened())
        .expect("fits");
    let bytes = rays.len() * 2 * size_of::<Found>();
    let outputs = gpu.storage_buffer("outputs", bytes as u64).expect("fits");
    let mut all = voxels.resources().to_vec();
    all.push(("inputs", inputs.as_entire_binding()));
    all.push(("outputs", outputs.as_entire_binding()));
    let bindings = kernel.bind(gpu, &all);
    let mut recorder = Recorder::new(gpu, None);
    recorder.compute("two_rays", |pass| {
        kernel.dispatch_threads(pass, &bindings, [rays.len() as u32, 1, 1]);
    });
    recorder.submit(gpu).expect("submits");
    gpu.read_buffer(&outputs).expect("reads back")
}

/// What the CPU's rays hit: a body's number, or none for the grid; its voxel, the face, and the distance.
type Expected = Option<(Option<usize>, IVec3, u8, f64)>;

fn nearer(of_grid: Outcome, of_bodies: BodyOutcome) -> Option<Expected> {
    let of_grid = match of_grid {
        Outcome::Inside(_) => return None,
        Outcome::Hit(hit) => Some((None, hit.voxel, hit.face, hit.distance)),
        Outcome::Miss => None,
    };
    let of_bodies = match of_bodies {
        BodyOutcome::Inside(_) => return None,
        BodyOutcome::Hit(found) => {
            let hit = found.hit;
            Some((Some(found.point.body), hit.voxel, hit.face, hit.distance))
        }
        BodyOutcome::Miss => None,
    };
    let distance = |found: &Expected| found.map_or(f64::INFINITY, |found| found.3);
    Some(if distance(&of_bodies) < distance(&of_grid) {
        of_bodies
    } else {
        of_grid
    })
}

fn agrees(found: &Found, expected: &Expected) -> bool {
    let Some((body, voxel, face, distance)) = expected else {
        return found.found == 0;
    };
    let number = body.map_or(u32::MAX, |body| body as u32);
    found.found == 1
        && found.body == number
        && UVec3::from(found.voxel) == voxel.as_uvec3()
        && found.face == u32::from(*face)
        && (f64::from(found.t) - distance).abs() < 1e-4 * distance.max(1.0)
}

/// Rays through rubble and bodies at random poses hit what the CPU's hit, and so do rays that leave what was hit. Where a
/// ray passes an edge, f32 and f64 may choose differently.
#[test]
fn rays_hit_what_the_cpu_hits() {
    const SIZE: UVec3 = UVec3::splat(64);
    let gpu = support::gpu();
    let mut state = 3;
    for count in [4, 40, 300] {
        let voxels = voxels_from(SIZE, |at| {
            let mut seed = (at.x * 7 + at.y * 1_009 + at.z * 91_193) as u32;
            u8::from(random(&mut seed) < 0.002)
        });
        let bodies = scattered(count, SIZE.as_vec3(), &mut state);
        let mut on_gpu = GpuVoxels::upload(&gpu, &voxels, IVec3::ZERO).expect("fits");
        on_gpu.bodies = GpuBodies::upload(&gpu, &bodies, &[], voxels.size()).expect("fits");
        let posed = PosedBodies::new(&bodies, IVec3::ZERO, &bodies.poses(0.0));
        let rays: Vec<[[f32; 4]; 3]> = (0..4000)
            .map(|_| {
                let origin = random_vector(&mut state) * SIZE.as_vec3();
                let [first, second] = [0, 1].map(|_| random_direction(&mut state));
                [origin.extend(0.0), first.extend(1e9), second.extend(1e9)].map(|v| v.to_array())
            })
            .collect();
        let found = marched(&gpu, &on_gpu, &rays);
        let (mut compared, mut on_bodies, mut differ) = (0, 0, 0);
        for (rays, found) in rays.iter().zip(found.chunks(2)) {
            let [origin, first, second] = rays.map(|v| Vec3::from_slice(&v).as_dvec3());
            let ray = Ray::new(origin, first);
            let Some(expected) = nearer(march(&voxels, &ray), posed.march(&ray, None, None)) else {
                continue;
            };
            compared += 1;
            let agree = agrees(&found[0], &expected);
            differ += u32::from(!agree);
            on_bodies += u32::from(found[0].body != u32::MAX);
            let Some((Some(_), ..)) = expected.filter(|_| agree) else {
                continue;
            };
            // From the body that was hit.
            let BodyOutcome::Hit(from) = posed.march(&ray, None, None) else {
                panic!("it was hit");
            };
            if from.normal.dot(second) <= 0.01 {
                continue;
            }
            let leaving = Ray::new(from.position_gs, second);
            let of_bodies = posed.march(&leaving, Some(from.normal), Some(&from.point));
            let Some(expected) = nearer(march(&voxels, &leaving), of_bodies) else {
                continue;
            };
            compared += 1;
            differ += u32::from(!agrees(&found[1], &expected));
        }
        assert!(
            compared > 1000 && on_bodies > 2 * count as u32,
            "{compared}, {on_bodies}"
        );
        assert!(
            differ * 500 <= compared,
            "{count} bodies: {differ} of {compared} differ"
        );
    }
}

/// A closed room with a lamp and a block in it.
const ROOM: &str = "(
    title: \"A closed room.\",
    size: (24, 24, 24),
    origin: (-12, -12, -12),
    shape: Subtraction([Box(half: (12, 12, 12)), Box(half: (8, 8, 8))]),
    lamps: [(name: \"lamp\", lamps: [(position: (1.7, 5.3, -0.9), power: 1000)])],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"corner\", position: (-7.3, 3.1, -7.2), look_at: (2, -4, 3), fov_deg: 80)],
    layouts: [(name: \"lattice\", counts: (4, 4, 4), spacing: 6)],
)";
const SIZE: [u32; 2] = [64, 48];

fn room() -> World {
    let mut world = support::parsed(ROOM);
    world.materials = vec![flat(0.6, 0.0)];
    world
}

/// With a block of 4 × 7 × 3 voxels, its lowest corner at (−1, −8, 0), as a body turned by this angle about its middle.
fn with_block(turn: f32) -> World {
    let mut world = room();
    let size = UVec3::new(4, 7, 3);
    let pivot = size.as_vec3() / 2.0;
    world.bodies.models.push(model(size, |_| 1));
    let position = Vec3::new(-1.0, -8.0, 0.0) + pivot;
    let turned = body(0, pivot, position, Quat::from_rotation_y(turn));
    world.bodies.bodies.push(turned);
    world
}

/// The same block as voxels of the grid.
fn with_voxels() -> World {
    let text = ROOM.replace(
        "shape: Subtraction([Box(half: (12, 12, 12)), Box(half: (8, 8, 8))]),",
        "shape: Union([Subtraction([Box(half: (12, 12, 12)), Box(half: (8, 8, 8))]),
            Translate(by: (1, -4.5, 1.5), of: Box(half: (2, 3.5, 1.5)))]),",
    );
    let mut world = support::parsed(&text);
    world.materials = vec![flat(0.6, 0.0)];
    world
}

/// Drawn in its first layout, with default parameters.
fn drawn(world: World) -> Drawn {
    let layout = world.layouts[0].clone();
    Drawn::new(
        support::gpu(),
        world,
        &layout,
        ProbeParameters::default(),
        SIZE,
    )
}

fn shown(drawn: &mut Drawn, view: View) -> Picture {
    drawn.shot.view = view;
    drawn.draw(1);
    drawn.radiance()
}

/// Share of the pixels that differ by more than rounding does.
fn differing(a: &Picture, b: &Picture) -> f64 {
    let differs = |(a, b): &(&[f32; 3], &[f32; 3])| {
        (0..3).any(|i| (a[i] - b[i]).abs() > 2e-3 * a[i].abs().max(b[i].abs()).max(0.05))
    };
    let count = a.rgb.iter().zip(&b.rgb).filter(differs).count();
    count as f64 / a.rgb.len() as f64
}

#[test]
fn a_body_that_is_not_turned_looks_like_the_same_voxels() {
    let mut as_body = drawn(with_block(0.0));
    let mut as_voxels = drawn(with_voxels());
    for view in [View::Normal, View::Albedo, View::Depth, View::Direct] {
        let (a, b) = (shown(&mut as_body, view), shown(&mut as_voxels, view));
        // Rays along edges may choose differently.
        assert!(differing(&a, &b) < 0.005, "{view:?}: {}", differing(&a, &b));
    }
    // Its own light is that of the probes, not of faces, but there is no less of it.
    as_body.draw(60);
    as_voxels.draw(60);
    let [a, b] = [&mut as_body, &mut as_voxels].map(|room| shown(room, View::Full));
    let off = apart(&a, &b);
    assert!(off < 0.05, "{off}");
    let turned = shown(&mut drawn(with_block(0.3)), View::Normal);
    let b = shown(&mut as_voxels, View::Normal);
    assert!(
        differing(&turned, &b) > 0.02,
        "a turned body looks different"
    );
}

/// What no ray can meet changes nothing: kernels with bodies show the grid as kernels without.
#[test]
fn a_body_that_is_buried_changes_no_byte() {
    let mut buried = room();
    buried.bodies.models.push(model(UVec3::splat(2), |_| 1));
    let place = Vec3::new(-11.0, 3.0, 2.0);
    buried
        .bodies
        .bodies
        .push(body(0, Vec3::ONE, place, Quat::from_rotation_y(0.4)));
    let [mut with, mut without] = [drawn(buried), drawn(room())];
    for frames in [1, 30] {
        with.draw(frames);
        without.draw(frames);
        assert!(
            with.radiance().rgb == without.radiance().rgb,
            "after {frames} frames"
        );
    }
}

/// A block that turns: direct light is that of the very frame, in which the path tracer finds the same.
#[test]
fn a_moving_shadow_is_right_in_its_frame() {
    let mut world = with_block(0.0);
    world.bodies.bodies[0].motion = vec![BodyMotion::Turn {
        axis: Vec3::new(0.3, 1.0, 0.1).normalize(),
        rate: 2.0,
    }];
    let mut drawn = drawn(world);
    drawn.draw(20);
    let mut before: Option<Picture> = None;
    for frame in 1..5 {
        drawn.shot.time_s = f64::from(frame) * 0.1;
        drawn.shot.view = View::Direct;
        drawn.draw(1);
        let found = drawn.radiance();
        let expected = drawn.path_traced(View::Direct, 1);
        assert!(
            differing(&found, &expected) < 0.005,
            "frame {frame}: {}",
            differing(&found, &expected)
        );
        if let Some(before) = &before {
            assert!(differing(&found, before) > 0.02, "the shadow moves");
        }
        before = Some(found);
    }
}

/// A hollow cube around the lamp leaves the room dark, from the first frame on; without the cube it is not. So it does when a lamp
/// that stone had enclosed jumps into the cube: what was known of the ways to the lamp is then wrong.
#[test]
fn a_closed_body_around_a_lamp_lets_no_light_out() {
    let mut world = room();
    let size = UVec3::splat(5);
    let shell = |at: UVec3| u8::from(at.cmpeq(UVec3::ZERO).any() || at.cmpeq(size - 1).any());
    world.bodies.models.push(model(size, shell));
    let lamp = Vec3::new(1.7, 5.3, -0.9);
    let turn = Quat::from_axis_angle(Vec3::new(0.2, 0.9, 0.4).normalize(), 0.7);
    world
        .bodies
        .bodies
        .push(body(0, size.as_vec3() / 2.0, lamp, turn));
    let mut dark = drawn(world);
    let mut brightest_after = |at: Vec3, frames| {
        dark.lights.lamps[0].position_ws = at.as_dvec3();
        dark.draw(frames);
        let picture = dark.radiance();
        let channels = picture.rgb.iter().flatten();
        channels.fold(0.0f32, |a, b| a.max(*b))
    };
    let in_stone = Vec3::new(10.5, -10.5, 10.5);
    for (at, frames) in [(lamp, 1), (lamp, 39), (in_stone, 1), (lamp, 1), (lamp, 2)] {
        let brightest = brightest_after(at, frames);
        assert!(
            brightest < 1e-4,
            "{brightest} at {at} after {frames} frames"
        );
    }
    let mut lit = drawn(room());
    lit.draw(40);
    assert!(mean(&lit.radiance()) > 0.1);
}

/// A furnace with bodies that turn: e / (1 − ρ) everywhere, on the bodies too.
#[test]
fn turning_bodies_keep_a_furnace() {
    let mut world = with_block(0.5);
    world.materials = vec![flat(0.5, 1.0)];
    world.lamp_presets = vec![LampPreset {
        name: "none".into(),
        lamps: Vec::new(),
    }];
    world.bodies.bodies[0].motion = vec![BodyMotion::Turn {
        axis: Vec3::Y,
        rate: 0.5,
    }];
    let mut drawn = drawn(world);
    let even = |picture: &Picture| {
        let errors = picture
            .rgb
            .iter()
            .map(|rgb| (f64::from(rgb[1]) / 2.0 - 1.0).abs());
        errors.fold(0.0, f64::max)
    };
    let traced = drawn.path_traced(View::Full, 64);
    assert!(
        (mean(&traced) / 2.0 - 1.0).abs() < 0.01,
        "{}",
        mean(&traced)
    );
    drawn.draw(100);
    for _ in 0..20 {
        drawn.shot.time_s += 1.0 / 60.0;
        drawn.draw(1);
        let picture = drawn.radiance();
        assert!(
            (mean(&picture) / 2.0 - 1.0).abs() < 0.01,
            "{}",
            mean(&picture)
        );
        assert!(even(&picture) < 0.1, "{}", even(&picture));
    }
}

/// Both path tracers show the same bodies at the same time.
#[test]
fn the_path_tracers_agree_about_bodies() {
    let world = support::shipped("cornell_turning");
    let size = [40, 24];
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters::default();
    let mut drawn = Drawn::new(support::gpu(), world.clone(), &layout, probes, size);
    drawn.shot.time_s = 4.6;
    let on_cpu = |view, time_s| {
        let film = FilmOptions {
            camera: &world.cameras[0],
            size,
            samples: 128,
            seed: 3,
            view,
            antialias: false,
            max_bounces: u32::MAX,
        };
        let options = RenderOptions {
            lamps: &world.lamp_presets[0],
            time_s,
            lamp_time_s: 0.0,
            textures: true,
            film,
        };
        let voxels = generate::generate(&world);
        reference::render(
            &world,
            &voxels,
            &options,
            &|_, _| {},
            &AtomicBool::new(false),
        )
    };
    let direct = drawn.path_traced(View::Direct, 1);
    let same = apart(&direct, &on_cpu(View::Direct, 4.6));
    let other = apart(&direct, &on_cpu(View::Direct, 0.0));
    assert!(
        same < 0.01 && other > 2.0 * same,
        "{same}, {other} at another time"
    );
    let full = drawn.path_traced(View::Full, 512);
    let same = apart(&blocks(&full), &blocks(&on_cpu(View::Full, 4.6)));
    assert!(same < 0.04, "{same}");
}

/// Means of 4 × 4 pixels, which hide noise.
fn blocks(picture: &Picture) -> Picture {
    const EDGE: u32 = 4;
    let mut means = Picture::new(picture.width / EDGE, picture.height / EDGE);
    for (number, mean) in (0..).zip(&mut means.rgb) {
        let corner = [
            number % (picture.width / EDGE),
            number / (picture.width / EDGE),
        ]
        .map(|at| at * EDGE);
        for at in 0..EDGE * EDGE {
            let (x, y) = (corner[0] + at % EDGE, corner[1] + at / EDGE);
            let rgb = picture.rgb[(y * picture.width + x) as usize];
            (0..3).for_each(|channel| mean[channel] += rgb[channel] / (EDGE * EDGE) as f32);
        }
    }
    means
}

/// While the blocks of a Cornell box turn, the picture follows what the path tracer shows at the same time.
#[test]
fn light_follows_turning_bodies() {
    let world = support::shipped("cornell_turning");
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters::default();
    let mut drawn = Drawn::new(support::gpu(), world, &layout, probes, [64, 42]);
    drawn.shot.time_s = 4.0;
    drawn.draw(90);
    let at_rest = apart(&drawn.radiance(), &drawn.path_traced(View::Full, 256));
    for _ in 0..30 {
        drawn.shot.time_s += 1.0 / 60.0;
        drawn.draw(1);
    }
    let moving = apart(&drawn.radiance(), &drawn.path_traced(View::Full, 256));
    println!("{at_rest:.4} at rest, {moving:.4} while blocks turn");
    assert!(
        at_rest < 0.1 && moving < 0.1,
        "{at_rest} at rest, {moving} while blocks turn"
    );
}

/// Anti-aliased pictures of a body that turns do not show where it was: they stay as close to the picture of the moment
/// as those of a camera at rest before a body at rest.
#[test]
fn a_turning_body_leaves_no_ghost() {
    let mut world = with_block(0.0);
    world.bodies.bodies[0].motion = vec![BodyMotion::Turn {
        axis: Vec3::Y,
        rate: 1.5,
    }];
    let mut smoothed = drawn(world);
    smoothed.draw(60);
    smoothed
        .frame
        .antialias(&smoothed.gpu, Antialias::Temporal)
        .expect("fits");
    let off = |smoothed: &mut Drawn, moves: bool| {
        for _ in 0..12 {
            smoothed.shot.time_s += if moves { 1.0 / 60.0 } else { 0.0 };
            smoothed.draw(1);
        }
        let found = smoothed.radiance();
        let expected = smoothed.path_traced(View::Full, 128);
        apart(&found, &expected)
    };
    let still = off(&mut smoothed, false);
    let moving = off(&mut smoothed, true);
    println!("{still:.4} still, {moving:.4} moving");
    assert!(
        moving < still + 0.02,
        "{moving} while it turns, {still} at rest"
    );
}

#[test]
fn positions_are_in_world_space() {
    // A world whose origin is not 0, and a body without a turn: the ray meets it where it is.
    let gpu = support::gpu();
    let origin = IVec3::new(-20, 5, 40);
    let voxels = voxels_from(UVec3::splat(16), |_| 0);
    let mut bodies = Bodies::default();
    bodies.models.push(model(UVec3::new(2, 3, 4), |_| 1));
    bodies.bodies.push(body(
        0,
        Vec3::ZERO,
        Vec3::new(-15.0, 8.0, 45.0),
        Quat::IDENTITY,
    ));
    let mut on_gpu = GpuVoxels::upload(&gpu, &voxels, origin).expect("fits");
    on_gpu.bodies = GpuBodies::upload(&gpu, &bodies, &[], voxels.size()).expect("fits");
    let from = Vec3::new(-14.5, 6.0, 46.5) - origin.as_vec3();
    let up = [from.extend(0.0), Vec3::Y.extend(1e9), Vec3::Y.extend(1.0)].map(|v| v.to_array());
    let found = marched(&gpu, &on_gpu, &[up]);
    let expected = Some((Some(0), IVec3::new(0, 0, 1), 2, 2.0));
    assert!(agrees(&found[0], &expected), "{:?}", found[0]);
    let point = Vec3::from(found[0].point_gs).as_dvec3() + origin.as_dvec3();
    assert!(
        point.distance(DVec3::new(-14.5, 8.0, 46.5)) < 1e-4,
        "{point}"
    );
}
