//! Edits on the GPU: after each edit the GPU's copy equals the CPU's voxel by voxel, is valid, and gives
//! rays the same hits as a fresh upload of the same voxels.

use std::{cell::Cell, ops::Range};

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    frame::{Frame, Stage},
    gpu::{Gpu, GpuError, Recorder},
    lights::Lights,
    parameters::{ProbeParameters, Relocation},
    passes::{
        bench::rays::{FoundHit, Marcher, RayBench, RayKind, RaySet},
        scene::GpuVoxels,
        view::Shot,
    },
    world::{
        Camera, View, World,
        voxels::{BRICK_VOXELS, CELL, Edit, NewCell, Voxels, brick_index},
    },
};
use proptest::{
    prelude::*,
    test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner},
};

use crate::support::{frames, gpu, scenes::lattice, shipped};

/// Not a multiple of a cell along any axis.
const SIZE: UVec3 = UVec3::new(44, 37, 41);

/// A floor of uniform cells under air, one brick at its edge.
fn ground() -> Voxels {
    let mut voxels = Voxels::from_cells(SIZE, |cell| {
        if cell.y < 2 && (cell + 1).cmple(SIZE / CELL).all() {
            NewCell::Uniform(1)
        } else {
            NewCell::Empty
        }
    });
    voxels.set(IVec3::new(43, 0, 40), 2);
    voxels
}

/// The same voxels without any spare brick.
fn tight(voxels: &Voxels) -> Voxels {
    Voxels::from_cells(voxels.size(), |cell| {
        let mut content = [0; BRICK_VOXELS];
        for local in everywhere(UVec3::splat(CELL)) {
            let at = (cell * CELL).as_ivec3() + local;
            content[brick_index(local.as_uvec3())] = voxels.material(at);
        }
        NewCell::Voxels(Box::new(content))
    })
}

/// One world on both sides.
struct Pair {
    gpu: Gpu,
    cpu: Voxels,
    on_gpu: GpuVoxels,
}

impl Pair {
    fn new(gpu: &Gpu, cpu: Voxels) -> Self {
        Self {
            on_gpu: GpuVoxels::upload(gpu, &cpu, IVec3::ZERO).expect("fits"),
            gpu: gpu.clone(),
            cpu,
        }
    }

    /// Applies the edit on the GPU; returns whether its buffers had to grow.
    fn follow(&mut self, edit: &Edit) -> bool {
        let larger = self.on_gpu.with_room_for(&self.gpu, &self.cpu);
        let larger = larger.expect("fits");
        let outgrown = larger.is_some();
        if let Some(larger) = larger {
            self.on_gpu = larger;
        }
        self.on_gpu.write(&self.gpu, &self.cpu, edit);
        outgrown
    }

    /// The first difference between the GPU's copy and the CPU's.
    fn compare(&self) -> Result<(), String> {
        let read = self.on_gpu.read_back(&self.gpu).expect("reads back");
        read.validate()?;
        let (grid, masks, materials) = self.cpu.raw();
        let (read_grid, read_masks, read_materials) = read.raw();
        if read_grid != grid {
            return Err("a word of the grid differs".to_owned());
        }
        // The content of free bricks does not matter.
        for brick in grid.iter().filter(|word| **word >> 30 == 2) {
            let brick = (brick & 0x3fff_ffff) as usize;
            if read_masks[brick] != masks[brick] || read_materials[brick] != materials[brick] {
                return Err(format!("brick {brick} differs"));
            }
        }
        match everywhere(SIZE).find(|at| read.material(*at) != self.cpu.material(*at)) {
            Some(at) => Err(format!("voxel {at} differs")),
            None => Ok(()),
        }
    }

    /// Number of rays whose hit in the GPU's copy differs from the hit in a fresh upload.
    fn compare_rays(&self) -> usize {
        let fresh = GpuVoxels::upload(&self.gpu, &tight(&self.cpu), IVec3::ZERO).expect("fits");
        let edited = hits(&self.gpu, &self.on_gpu, &[Marcher::BrickMap]);
        let built = hits(&self.gpu, &fresh, &[Marcher::BrickMap, Marcher::PlainDda]);
        assert_eq!(built.len(), 2 * edited.len());
        let twice = edited.iter().chain(&edited);
        twice.zip(&built).filter(|(a, b)| !a.same_hit(**b)).count()
    }
}

fn everywhere(size: UVec3) -> impl Iterator<Item = IVec3> {
    let UVec3 { x, y, z } = size;
    (0..x * y * z).map(move |i| UVec3::new(i % x, i / x % y, i / x / y).as_ivec3())
}

/// Hits of a picture's rays, and of rays in all directions from a lattice of voxels, solid or not.
fn hits(gpu: &Gpu, voxels: &GpuVoxels, marchers: &[Marcher]) -> Vec<FoundHit> {
    let camera = Camera {
        name: "above".to_owned(),
        position: Vec3::new(50.3, 45.1, 52.7),
        yaw_deg: 45.0,
        pitch_deg: -40.0,
        fov_deg: 80.0,
    };
    let shot = frames::shot(camera, [48, 32]);
    let view_buffer = gpu.uniform_buffer("view", &shot.to_gpu());
    let probes: Vec<UVec3> = everywhere(UVec3::splat(4))
        .map(|at| at.as_uvec3() * 10 + UVec3::new(3, 1, 2))
        .collect();
    let directions: Vec<Vec3> = everywhere(UVec3::splat(5))
        .filter(|at| *at != IVec3::splat(2))
        .map(|at| (at - 2).as_vec3() + Vec3::new(0.0, 0.13, 0.31))
        .collect();
    let rays = RaySet {
        view: &view_buffer,
        size: shot.size,
        rays_per_edge: 1,
        probes: &probes,
        directions: &directions,
    };
    let bench = RayBench::new(gpu, voxels, &rays).expect("compiles");
    let mut found = Vec::new();
    for marcher in marchers {
        for kind in [RayKind::Camera, RayKind::Probe] {
            found.extend(bench.hits(gpu, kind, *marcher).expect("runs"));
        }
    }
    found
}

#[derive(Clone, Debug)]
enum Change {
    Set(IVec3, u8),
    Box(IVec3, IVec3, u8),
    Sphere(Vec3, f32, u8),
}

impl Change {
    fn make(&self, voxels: &mut Voxels) -> Edit {
        match *self {
            Change::Set(at, material) => voxels.set(at, material),
            Change::Box(a, b, material) => voxels.fill_box(a.min(b), a.max(b), material),
            Change::Sphere(at, radius, material) => voxels.fill_sphere(at, radius, material),
        }
    }
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let place = || (-3..47i32, -3..40i32, -3..44i32).prop_map(|(x, y, z)| IVec3::new(x, y, z));
    let material = || prop_oneof![Just(0u8), 1..4u8];
    let sphere = (place(), 0.5..12.0f32, material());
    let change = prop_oneof![
        (place(), material()).prop_map(|(at, m)| Change::Set(at, m)),
        (place(), place(), material()).prop_map(|(a, b, m)| Change::Box(a, b, m)),
        sphere.prop_map(|(at, radius, m)| Change::Sphere(at.as_vec3() + 0.4, radius, m)),
    ];
    proptest::collection::vec(change, 1..8)
}

#[test]
fn any_edits_leave_both_sides_equal() {
    let gpu = gpu();
    let config = Config {
        cases: 10,
        max_shrink_iters: 40,
        failure_persistence: None,
        ..Config::default()
    };
    let seed = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let outgrown = Cell::new(0);
    let result = TestRunner::new_with_rng(config, seed).run(&changes(), |changes| {
        let mut pair = Pair::new(&gpu, ground());
        for change in &changes {
            let edit = change.make(&mut pair.cpu);
            outgrown.set(outgrown.get() + u32::from(pair.follow(&edit)));
            prop_assert_eq!(pair.compare(), Ok(()));
        }
        prop_assert_eq!(pair.compare_rays(), 0);
        Ok(())
    });
    match result {
        Ok(()) => assert!(outgrown.get() > 3, "{outgrown:?}: too few to be a test"),
        Err(TestError::Fail(reason, changes)) => panic!("{reason}\nafter {changes:#?}"),
        Err(error) => panic!("{error}"),
    }
}

/// Every change of a cell's kind, one after another.
#[test]
fn bricks_come_and_go_on_both_sides() {
    let mut pair = Pair::new(&gpu(), ground());
    let step = |pair: &mut Pair, change: Change| -> (Edit, bool) {
        let edit = change.make(&mut pair.cpu);
        let outgrown = pair.follow(&edit);
        assert_eq!(pair.compare(), Ok(()), "after {change:?}");
        assert_eq!(pair.compare_rays(), 0, "after {change:?}");
        (edit, outgrown)
    };
    let dug = IVec3::new(10, 3, 11);
    // A solid cell is opened and needs a brick, for which the buffer must grow.
    let (opened, outgrown) = step(&mut pair, Change::Set(dug, 0));
    assert_eq!((opened.bricks.len(), outgrown), (1, true));
    // A change within the same brick.
    let (_, outgrown) = step(&mut pair, Change::Set(dug + IVec3::X, 0));
    assert!(!outgrown);
    // Filled again, the cell is uniform and its brick is free.
    let bricks = pair.cpu.bricks();
    let (filled, _) = step(&mut pair, Change::Box(dug, dug + IVec3::X, 1));
    assert_eq!((filled.bricks.len(), pair.cpu.bricks()), (0, bricks - 1));
    // The next cell that needs a brick gets that one.
    let (again, outgrown) = step(
        &mut pair,
        Change::Sphere(Vec3::new(24.0, 32.0, 24.0), 2.0, 3),
    );
    let freed = opened.bricks[0].start;
    let takes = |range: &Range<usize>| range.contains(&freed);
    assert!(again.bricks.iter().any(takes), "{again:?}");
    assert!(outgrown, "a sphere across eight cells takes more than one");
    // At the world's corners, and beyond them.
    let last = SIZE.as_ivec3() - 1;
    step(&mut pair, Change::Set(last, 2));
    step(&mut pair, Change::Sphere(last.as_vec3() + 0.5, 6.0, 3));
    step(&mut pair, Change::Set(IVec3::ZERO, 0));
    step(&mut pair, Change::Box(IVec3::splat(-9), IVec3::ZERO, 3));
    let (outside, outgrown) = step(&mut pair, Change::Set(SIZE.as_ivec3(), 1));
    assert_eq!((outside, outgrown), (Edit::default(), false));
    // No voxel at all, and every voxel.
    step(&mut pair, Change::Box(IVec3::ZERO, last, 0));
    assert_eq!(pair.cpu.bricks(), 0);
    step(&mut pair, Change::Box(IVec3::ZERO, last, 1));
    step(&mut pair, Change::Box(IVec3::ONE, last - 1, 0));
}

#[test]
fn uploads_that_are_skipped_are_found() {
    let gpu = gpu();
    // A hole into four solid cells.
    let stroke = Change::Sphere(Vec3::new(24.0, 15.0, 24.0), 4.5, 0);
    let caught = |skip: &dyn Fn(&mut Edit)| {
        let mut pair = Pair::new(&gpu, ground());
        // Room for the bricks, so that only what is written differs.
        let edit = Change::Sphere(Vec3::new(30.0, 30.0, 20.0), 7.0, 2).make(&mut pair.cpu);
        pair.follow(&edit);
        assert_eq!((pair.compare(), pair.compare_rays()), (Ok(()), 0));
        let mut edit = stroke.make(&mut pair.cpu);
        skip(&mut edit);
        pair.follow(&edit);
        (pair.compare().is_err(), pair.compare_rays() > 0)
    };
    assert_eq!(caught(&|_| ()), (false, false));
    assert_eq!(caught(&|edit| *edit = Edit::default()), (true, true));
    assert_eq!(caught(&|edit| edit.bricks.clear()), (true, true));
    assert_eq!(caught(&|edit| edit.bricks[0].end -= 1), (true, true));
    assert_eq!(caught(&|edit| edit.grid.clear()), (true, true));
    let (voxels_differ, _) = caught(&|edit| edit.grid.truncate(edit.grid.len() / 2));
    assert!(voxels_differ);
}

/// A small picture of the world's sphere, with probes around it.
struct Shown {
    gpu: Gpu,
    world: World,
    frame: Frame,
    parameters: ProbeParameters,
}

impl Shown {
    fn new(gpu: &Gpu, voxels: &Voxels, relocation: Relocation) -> Self {
        let world = shipped("minimal");
        let stage = Stage::upload(gpu, &world, voxels);
        let parameters = ProbeParameters {
            rays: 64,
            relocation,
            ..Default::default()
        };
        let layout = lattice(UVec3::splat(3), Vec3::splat(6.0), Vec3::new(0.0, 8.0, 0.0));
        let frame = Frame::new(gpu, stage.expect("fits"), &layout, &parameters, [48, 32]);
        Self {
            gpu: gpu.clone(),
            world,
            frame: frame.expect("fits"),
            parameters,
        }
    }

    fn places(&self) -> Vec<[f32; 4]> {
        let places = self.frame.field().places();
        self.gpu.read_buffer(places).expect("reads back")
    }

    /// Draws one more frame: its picture in a view that does not use probes, and the number of probes outside
    /// solid voxels.
    fn draw(&mut self) -> (Vec<[f32; 3]>, u32) {
        let shot = Shot {
            frame: self.frame.frames(),
            view: View::Direct,
            ..frames::shot(self.world.cameras[0].clone(), self.frame.size())
        };
        let lights = Lights::at(&self.world, &self.world.lamp_presets[0], 0.0);
        let mut recorder = Recorder::new(&self.gpu, None);
        self.frame
            .record(&self.gpu, &mut recorder, &shot, &lights, &self.parameters);
        recorder.submit(&self.gpu).expect("submits");
        let picture = self.frame.read_radiance(&self.gpu).expect("reads back");
        let alive = self.frame.field().state_counts(&self.gpu);
        let alive = alive.expect("reads back").alive;
        (picture.rgb, alive)
    }
}

/// The voxels of a shipped world, as the GPU builds them.
fn built(gpu: &Gpu, name: &str) -> Voxels {
    let stage = Stage::build(gpu, &shipped(name)).expect("fits");
    stage.read_back(gpu).expect("reads back")
}

/// Buffers that have to grow stop a frame.
#[test]
fn a_new_world_has_room_for_many_strokes() {
    let gpu = gpu();
    let stage = Stage::build(&gpu, &shipped("cave")).expect("fits");
    let mut voxels = stage.read_back(&gpu).expect("reads back");
    let before = voxels.bricks();
    let cells = voxels.size() / CELL;
    // A voxel in the middle of every cell makes a brick of each cell that has none.
    for cell in everywhere(cells).take(4000) {
        voxels.edit(cell * CELL as i32 + 4, cell * CELL as i32 + 4, |_, old| {
            u8::from(old == 0)
        });
    }
    let new = voxels.bricks() - before;
    assert!(new > 400, "{new} new bricks: too few to be a test");
    let larger = stage.voxels.with_room_for(&gpu, &voxels);
    assert!(larger.expect("fits").is_none(), "{new} new bricks");
    let tight = GpuVoxels::upload(&gpu, &tight(&built(&gpu, "cave")), IVec3::ZERO).expect("fits");
    let larger = tight.with_room_for(&gpu, &voxels);
    assert!(
        larger.expect("fits").is_some(),
        "the planted fault: no room"
    );
}

/// Picture, shadows and probes follow a frame's edits, whether buffers are written in place or all passes are bound
/// again.
#[test]
fn a_frame_follows_its_edits() {
    follows_edits(Relocation::Off);
}

#[test]
fn a_frame_with_moved_probes_follows_its_edits() {
    follows_edits(Relocation::Exact);
}

fn follows_edits(relocation: Relocation) {
    let gpu = gpu();
    let mut voxels = tight(&built(&gpu, "minimal"));
    let mut shown = Shown::new(&gpu, &voxels, relocation);
    assert_eq!(voxels.validate(), Ok(()));
    let (before, alive) = shown.draw();
    let middle = (-shown.world.origin).as_vec3() + Vec3::new(0.0, 6.0, 0.0);
    let mut buffers = Vec::new();
    let (mut last, mut pictures) = (alive, vec![before]);
    for (change, more_alive) in [
        // The sphere is hollowed out: probes inside it become alive.
        (Change::Sphere(middle, 5.0, 0), true),
        (
            Change::Sphere(middle + Vec3::new(4.0, 4.0, 6.0), 4.0, 0),
            true,
        ),
        (Change::Sphere(middle, 9.0, 1), false),
    ] {
        let edit = change.make(&mut voxels);
        shown.frame.apply(&gpu, &voxels, &edit).expect("fits");
        buffers.push(shown.frame.stage.voxels.masks.clone());
        let (picture, alive) = shown.draw();
        let mut fresh = Shown::new(&gpu, &voxels, relocation);
        let (expected, fresh_alive) = fresh.draw();
        assert_eq!(shown.places(), fresh.places(), "after {change:?}");
        assert!(picture == expected, "after {change:?}");
        assert_eq!(alive, fresh_alive, "after {change:?}");
        // Moved probes always find air.
        if relocation == Relocation::Off {
            assert_eq!(alive > last, more_alive, "{last}, then {alive} probes");
        }
        last = alive;
        pictures.push(picture);
    }
    assert!(
        buffers.windows(2).any(|pair| pair[0] == pair[1]),
        "in place"
    );
    assert!(
        buffers.windows(2).any(|pair| pair[0] != pair[1]),
        "outgrown"
    );
    // The first edit was inside the sphere; the others are visible.
    assert!(pictures[0] == pictures[1] && pictures[1] != pictures[2] && pictures[2] != pictures[3]);
}

#[test]
fn an_edit_that_does_not_fit_leaves_all_as_it_was() {
    let mut gpu = gpu();
    let mut voxels = tight(&built(&gpu, "minimal"));
    let mut shown = Shown::new(&gpu, &voxels, Relocation::Exact);
    let (before, alive) = shown.draw();
    let held = shown.frame.stage.voxels.materials.size();
    gpu.limits.max_storage_buffer_binding_size = held;
    // Every other voxel is solid: every cell needs a brick.
    let mut edited = voxels.clone();
    let last = edited.size().as_ivec3() - 1;
    let edit = edited.edit(IVec3::ZERO, last, |at, old| {
        if at.element_sum() % 2 == 0 { 1 } else { old }
    });
    let error = shown.frame.apply(&gpu, &edited, &edit);
    let error = error.expect_err("twice the limit");
    assert!(error.to_string().contains("max_storage_buffer"), "{error}");
    assert!(matches!(
        error,
        grotto::frame::FrameError::Gpu(GpuError::TooLarge { .. })
    ));
    let read = shown.frame.stage.read_back(&gpu).expect("reads back");
    assert_eq!(read.raw().0, voxels.raw().0);
    assert!(read.raw().1 == voxels.raw().1 && read.raw().2 == voxels.raw().2);
    assert!(shown.draw() == (before, alive));
    // The next edit that fits is applied: whole solid cells, which take no brick.
    let edit = Change::Box(IVec3::ZERO, IVec3::new(last.x, 15, last.z), 1).make(&mut voxels);
    assert!(voxels.raw().1.len() as u64 * 512 <= held);
    shown.frame.apply(&gpu, &voxels, &edit).expect("fits");
    let read = shown.frame.stage.read_back(&gpu).expect("reads back");
    assert_eq!(read.raw().0, voxels.raw().0);
}
