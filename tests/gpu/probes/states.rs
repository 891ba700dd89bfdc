//! Which probes are active: by their surroundings, by requests, and after edits.

use std::collections::BTreeSet;

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    parameters::{ProbeParameters, ProbeStates as Sleep, Relocation, Visibility},
    passes::{
        probes::{ProbeField, StateCounts, classify::ProbeClassify, schedule::ProbeSchedule},
        scene::GpuVoxels,
    },
    probes::Layout as _,
    world::voxels::{NewCell, Voxels},
};
use half::f16;

use super::Blends;
use crate::support::{
    gpu,
    scenes::{lattice, volume_of},
};

const SIZE: u32 = 56;
/// Voxels below this x are solid.
const WALL: i32 = 16;
/// Rays of each probe.
const RAYS: u32 = 8;
const COUNTS: UVec3 = UVec3::new(6, 3, 3);
const SPACING: f32 = 8.0;

/// A solid slab beside open air, and probes from deep inside the slab to far outside. Of the lattice's columns
/// two are in the slab, one is before the wall, and three have nothing around them.
struct Slab {
    gpu: Gpu,
    on_cpu: Voxels,
    voxels: GpuVoxels,
    field: ProbeField,
    states: ProbeClassify,
    schedule: ProbeSchedule,
    blend: Blends,
    parameters: ProbeParameters,
    frame: u64,
}

impl Slab {
    fn new(parameters: ProbeParameters) -> Self {
        let gpu = gpu();
        let on_cpu = Voxels::from_cells(UVec3::splat(SIZE), |cell| {
            if (cell.x as i32) * 8 < WALL {
                NewCell::Uniform(1)
            } else {
                NewCell::Empty
            }
        });
        let voxels = GpuVoxels::upload(&gpu, &on_cpu, IVec3::ZERO).expect("fits");
        let centre = Vec3::new(24.5, 28.5, 28.5);
        let volume = volume_of(&lattice(COUNTS, Vec3::splat(SPACING), centre));
        let parameters = ProbeParameters {
            relocation: Relocation::Off,
            visibility: Visibility::Chebyshev,
            warmup_frames: 2,
            rays: RAYS,
            ..parameters
        };
        let field = ProbeField::new(&gpu, volume, &parameters).expect("fits");
        let slab = Self {
            states: ProbeClassify::new(&gpu, &field, &voxels.resources()).expect("compiles"),
            schedule: ProbeSchedule::new(&gpu, &field, &[]).expect("compiles"),
            blend: Blends::new(&gpu, &field, &[]),
            gpu,
            on_cpu,
            voxels,
            field,
            parameters,
            frame: 0,
        };
        // Every ray is long: no probe is hidden.
        (0..COUNTS.element_product()).for_each(|slot| slab.set_rays(slot, 100.0));
        slab
    }

    /// All rays of a probe have this length (negative: they begin in a solid voxel) and bring no light.
    fn set_rays(&self, slot: u32, length: f32) {
        let rays = [[0.0, 0.0, 0.0, length].map(f16::from_f32); RAYS as usize];
        let offset = u64::from(slot) * size_of_val(&rays) as u64;
        let bytes = bytemuck::cast_slice(&rays);
        self.gpu
            .queue
            .write_buffer(self.field.rays(), offset, bytes);
    }

    /// Runs one update; returns the slots that were active in it.
    fn update(&mut self) -> BTreeSet<u32> {
        self.field
            .begin_frame(&self.gpu, &self.parameters, 1, self.frame);
        let mut recorder = Recorder::new(&self.gpu, None);
        if self.field.misplaced() {
            self.states.record(&mut recorder);
            self.field.set_placed();
        }
        let is_edited = self.field.changes.shown_first().is_some();
        self.schedule.record(&mut recorder);
        self.blend.record(&mut recorder);
        recorder.submit(&self.gpu).expect("submits");
        self.frame += 1;
        if is_edited {
            // No alert, so that intervals are those of steady light.
            self.field.changes = Default::default();
        }
        let list = self.field.active_slots(&self.gpu).expect("reads back");
        let active: BTreeSet<u32> = list.iter().copied().collect();
        assert_eq!(active.len(), list.len(), "a slot is listed twice");
        active
    }

    fn updates(&self) -> Vec<u32> {
        self.field.updates(&self.gpu).expect("reads back")
    }

    /// How often each slot is updated in the next frames.
    fn watch(&mut self, frames: u32) -> Vec<u32> {
        let before = self.updates();
        for _ in 0..frames {
            self.update();
        }
        let after = self.updates();
        after
            .iter()
            .zip(before)
            .map(|(after, before)| after - before)
            .collect()
    }

    /// Fills a box (both ends inclusive) with a material.
    fn fill(&mut self, low: IVec3, high: IVec3, material: u8) {
        let edit = self.on_cpu.fill_box(low, high, material);
        let larger = self
            .voxels
            .with_room_for(&self.gpu, &self.on_cpu)
            .expect("fits");
        if let Some(larger) = larger {
            self.voxels = larger;
            let resources = self.voxels.resources();
            self.states = ProbeClassify::new(&self.gpu, &self.field, &resources).expect("compiles");
        }
        self.voxels.write(&self.gpu, &self.on_cpu, &edit);
        let (low, high) = edit.region.expect("something changed");
        let (first, last) = (low.as_ivec3(), high.as_ivec3());
        let changes = &mut self.field.changes;
        changes.edit(first, last, IVec3::ZERO, self.frame as u32);
        changes.begin_frame(0.0, self.frame as u32);
    }

    /// Gathers for a pixel that shows this point of a surface, as in pass `view/shade`.
    fn look_at(&self, point: Vec3, normal: Vec3) {
        self.ask(point, normal, false);
    }

    /// Gathers at a point: for the hit of a probe's ray, or for a pixel.
    fn ask(&self, point: Vec3, normal: Vec3, by_ray: bool) {
        let (requester, number) = if by_ray { ("RAY", 0.0) } else { ("PIXEL", 1.0) };
        let look = LOOK.replace("REQUESTER", requester);
        let kernel = Kernel::new(
            &self.gpu,
            &KernelSpec {
                shader: "generated/look",
                generated: &[("look", &look)],
                overrides: &[("FIRST_REQUESTER", number)],
                ..Default::default()
            },
        )
        .expect("compiles");
        let places = [point.extend(0.0).to_array(), normal.extend(0.0).to_array()];
        let place = self.gpu.storage_buffer_of("place", &places).expect("fits");
        let mut resources = self.voxels.resources().to_vec();
        resources.extend(self.field.resources());
        if !by_ray {
            resources.retain(|(name, _)| *name != "active_list");
            resources.push(self.field.requests_of_pixels());
        }
        resources.push(("place", place.as_entire_binding()));
        let bindings = kernel.bind(&self.gpu, &resources);
        let mut recorder = Recorder::new(&self.gpu, None);
        recorder.compute("look", |pass| {
            kernel.dispatch(pass, &bindings, [1, 1, 1]);
        });
        recorder.submit(&self.gpu).expect("submits");
    }

    fn counts(&self) -> StateCounts {
        self.field.state_counts(&self.gpu).expect("reads back")
    }
}

const LOOK: &str = "
import package::probes::requests::REQUESTER;
import package::probes::gather::gather;
@group(3) @binding(0) var<storage, read_write> place: array<vec4f>;
@compute @workgroup_size(1)
fn main() {
    place[0] = vec4f(gather(place[0].xyz, place[1].xyz, REQUESTER), 0.0);
}
";

/// Slots of a column of the lattice along x.
fn column(x: u32) -> impl Iterator<Item = u32> {
    (0..COUNTS.y * COUNTS.z).map(move |row| row * COUNTS.x + x)
}

fn columns(range: std::ops::Range<u32>) -> BTreeSet<u32> {
    range.flat_map(column).collect()
}

/// How often slots were updated, fewest and most.
fn fewest_and_most(updates: &[u32], slots: &BTreeSet<u32>) -> [u32; 2] {
    let counts = slots.iter().map(|slot| updates[*slot as usize]);
    let [fewest, most] = [counts.clone().min(), counts.max()];
    [fewest, most].map(|count| count.expect("some slots"))
}

/// Each of `slots`, which take turns, was updated `times` times.
#[track_caller]
fn assert_each(updates: &[u32], slots: &BTreeSet<u32>, times: u32) {
    let found = fewest_and_most(updates, slots);
    assert_eq!(found, [times; 2], "fewest and most updates of {slots:?}");
}

/// Besides `awake` only sleeping probes whose turn it is are active: about a tenth of them per frame.
#[track_caller]
fn assert_active(active: &BTreeSet<u32>, awake: &BTreeSet<u32>, asleep: &BTreeSet<u32>) {
    assert!(awake.is_subset(active), "{awake:?} are awake: {active:?}");
    let others = active - awake;
    assert!(
        others.is_subset(asleep),
        "{asleep:?} are asleep: {active:?}"
    );
    assert!(
        others.len() <= asleep.len().div_ceil(5),
        "a tenth: {others:?}"
    );
}

/// With classification, but ignoring variability, which new probes have.
fn on() -> ProbeParameters {
    ProbeParameters {
        states: Sleep::On,
        variability: 1.0,
        ..Default::default()
    }
}

#[test]
fn solid_is_dead_unseen_is_asleep_and_what_lights_pixels_is_alive() {
    let mut slab = Slab::new(on());
    let (near, far) = (columns(2..3), columns(3..6));
    for frame in 0..2 {
        // New probes are active until they have warmed up.
        assert_eq!(slab.update(), columns(2..6), "frame {frame}");
    }
    // The middle of each cage before the wall.
    for (y, z) in [(24.5, 24.5), (24.5, 32.5), (32.5, 24.5), (32.5, 32.5)] {
        slab.look_at(Vec3::new(16.0, y, z), Vec3::X);
    }
    let before = slab.updates();
    for _ in 0..20 {
        assert_active(&slab.update(), &near, &far);
    }
    let after = slab.updates();
    let updates: Vec<u32> = after.iter().zip(before).map(|(a, b)| a - b).collect();
    assert_each(&updates, &near, 20);
    assert_each(&updates, &far, 2);
    assert_each(&after, &columns(0..2), 0);
    let expected = StateCounts {
        alive: 9,
        sleeping: 27,
        dead: 18,
        updated: slab.counts().updated,
        back_side: 0,
    };
    assert_eq!(slab.counts(), expected);
}

#[test]
fn unrequested_probes_sleep_and_wake_when_they_are_looked_at() {
    let mut slab = Slab::new(ProbeParameters {
        alive_frames: 5,
        ..on()
    });
    let all = columns(2..6);
    for _ in 0..2 {
        assert_eq!(slab.update(), all);
    }
    assert_each(&slab.watch(20), &all, 2);
    assert_eq!((slab.counts().alive, slab.counts().sleeping), (0, 36));
    // In the middle of the cage between rows 0 and 1 of y and of z; columns 1 (dead) and 2 of x.
    slab.look_at(Vec3::new(16.0, 24.5, 24.5), Vec3::X);
    let seen: BTreeSet<u32> = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(y, z)| 2 + 6 * (y + 3 * z))
        .into();
    // The request carries the number of the last frame.
    let others = &all - &seen;
    for _ in 0..4 {
        assert_active(&slab.update(), &seen, &others);
        assert_eq!(slab.counts().alive, 4);
    }
    slab.update();
    assert_each(&slab.watch(10), &all, 1);
}

#[test]
fn indirect_only_probes_are_active_at_once_when_light_changes() {
    let mut slab = Slab::new(on());
    for _ in 0..2 {
        slab.update();
    }
    slab.ask(Vec3::new(16.0, 24.5, 24.5), Vec3::X, true);
    let indirect_only: BTreeSet<u32> = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(y, z)| 2 + 6 * (y + 3 * z))
        .into();
    let asleep = &columns(2..6) - &indirect_only;
    let updates = slab.watch(20);
    assert_each(&updates, &indirect_only, 5);
    assert_each(&updates, &asleep, 2);
    slab.field.changes.begin_frame(1.0, slab.frame as u32);
    assert_active(&slab.update(), &indirect_only, &asleep);
    // A slowly moving lamp is no reason for extra updates, once rays are not repeated any more.
    for frame in 0..200 {
        slab.field
            .changes
            .begin_frame(0.02, slab.frame as u32 + frame);
    }
    assert_each(&slab.watch(4), &indirect_only, 1);
}

#[test]
fn variable_probes_before_surfaces_are_active_in_every_frame() {
    let mut slab = Slab::new(ProbeParameters {
        variability: 0.1,
        ..on()
    });
    for _ in 0..2 {
        slab.update();
    }
    // New probes vary: nobody requests them, but those before the wall do not sleep yet.
    assert_active(&slab.update(), &columns(2..3), &columns(3..6));
}

#[test]
fn an_edit_wakes_what_it_touches_at_once_and_kills_what_it_covers() {
    let mut slab = Slab::new(ProbeParameters {
        alive_frames: 3,
        ..on()
    });
    let all = columns(2..6);
    for _ in 0..4 {
        slab.update();
    }
    // Around the probe of the last column's middle row.
    let covered = 5 + 6 * (1 + 3);
    slab.fill(IVec3::new(43, 27, 27), IVec3::new(45, 29, 29), 1);
    slab.set_rays(covered, -1.0);
    // Longest distance: 1.5 · √3 · 8 = 20.8. The column before the wall is 22.5 from the box.
    let (touched, untouched) = (columns(3..6), columns(2..3));
    assert_active(&slab.update(), &touched, &untouched);
    assert_eq!(slab.counts().dead, 19);
    let mut living = all.clone();
    living.remove(&covered);
    let mut awake = touched;
    awake.remove(&covered);
    let updates = slab.watch(3);
    assert_each(&updates, &awake, 3);
    assert!(fewest_and_most(&updates, &untouched)[1] <= 1, "{updates:?}");
    // The covered probe was active once more, to forget its light.
    assert_eq!(slab.updates()[covered as usize], 0);
    let updates = slab.watch(10);
    assert_each(&updates, &living, 1);
    assert_eq!(updates[covered as usize], 0);
    // Uncovered, it is alive and new, so it is active until it has warmed up.
    slab.fill(IVec3::new(43, 27, 27), IVec3::new(45, 29, 29), 0);
    slab.set_rays(covered, 100.0);
    assert!(slab.update().contains(&covered));
    assert_eq!(slab.counts().dead, 18);
}

#[test]
fn probes_that_an_edit_walls_in_are_no_longer_far() {
    let mut slab = Slab::new(on());
    let far = |slab: &Slab| -> BTreeSet<u32> {
        let states = slab.field.states(&slab.gpu).expect("reads back");
        let far = (0..).zip(states).filter(|(_, state)| state.is_far());
        far.map(|(slot, _)| slot).collect()
    };
    slab.update();
    assert_eq!(far(&slab), columns(3..6));
    // One solid voxel, exactly a spacing away from the probe along each axis, and no nearer.
    let slot = 5 + 6 * (2 + 3 * 2);
    let voxel = slab.field.volume().position(slot).floor().as_ivec3() + 8;
    slab.fill(voxel, voxel, 1);
    slab.update();
    let mut others = columns(3..6);
    others.remove(&slot);
    assert_eq!(far(&slab), others);
    slab.fill(voxel, voxel, 0);
    slab.fill(voxel + IVec3::X, voxel + IVec3::X, 1);
    slab.update();
    assert_eq!(far(&slab), columns(3..6));
}

#[test]
fn without_states_all_probes_outside_solid_voxels_are_active() {
    let mut slab = Slab::new(ProbeParameters {
        states: Sleep::Off,
        ..on()
    });
    for _ in 0..4 {
        assert_eq!(slab.update(), columns(2..6));
    }
    let counts = slab.counts();
    assert_eq!((counts.alive, counts.dead, counts.updated), (36, 18, 36));
}
