//! The visibility bits of probes, and the places of back-side probes.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Recorder},
    parameters::{ProbeParameters, Visibility},
    passes::{
        probes::{ProbeField, classify::ProbeClassify, visibility::ProbeVisibility},
        scene::GpuVoxels,
    },
    probes::{Layout as _, MOVE_REACH, VisibilityBits, VisibilityBox, Volume, sampling},
    reference::march::{Outcome, Ray, march_plain},
    world::{LayoutSpec, voxels::Voxels},
};

use crate::support::{
    gpu,
    scenes::{lattice, volume_of},
};

const SIZE: i32 = 32;
pub const ORIGIN: IVec3 = IVec3::new(-16, -16, -16);
const SPACING: Vec3 = Vec3::new(5.0, 4.0, 3.5);

pub fn exact() -> ProbeParameters {
    ProbeParameters {
        visibility: Visibility::Exact,
        ..Default::default()
    }
}

pub fn volume() -> Volume {
    let centre = Vec3::new(0.3, -0.4, 0.5);
    volume_of(&lattice(UVec3::new(6, 7, 8), SPACING, centre))
}

/// Two rooms with a wall of one voxel between them, columns in both, and a nook.
pub fn rooms() -> Voxels {
    let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
    voxels.fill_box(IVec3::splat(2), IVec3::splat(29), 1);
    voxels.fill_box(IVec3::new(4, 4, 4), IVec3::new(14, 27, 27), 0);
    voxels.fill_box(IVec3::new(16, 4, 4), IVec3::new(27, 27, 27), 0);
    voxels.fill_box(IVec3::new(8, 4, 9), IVec3::new(9, 27, 12), 1);
    voxels.fill_box(IVec3::new(20, 4, 18), IVec3::new(22, 15, 19), 1);
    voxels.fill_box(IVec3::new(28, 9, 9), IVec3::new(28, 9, 9), 0);
    voxels
}

/// The passes that place probes and find their visibility.
struct Placed {
    field: ProbeField,
    states: ProbeClassify,
    visibility_bits: ProbeVisibility,
}

impl Placed {
    fn new(gpu: &Gpu, field: ProbeField, voxels: &GpuVoxels) -> Self {
        Self {
            states: ProbeClassify::new(gpu, &field, &voxels.resources()).expect("compiles"),
            visibility_bits: ProbeVisibility::new(gpu, &field, &voxels.resources())
                .expect("compiles"),
            field,
        }
    }

    fn run(&mut self, gpu: &Gpu, parameters: &ProbeParameters) {
        self.field.begin_frame(gpu, parameters, 1, 0);
        assert!(self.field.misplaced(), "there is something to look at");
        self.field.set_placed();
        let mut recorder = Recorder::new(gpu, None);
        self.states.record(&mut recorder);
        self.visibility_bits.record(&mut recorder);
        recorder.submit(gpu).expect("submits");
    }

    fn places(&self, gpu: &Gpu) -> Vec<[f32; 4]> {
        gpu.read_buffer(self.field.places()).expect("reads back")
    }

    fn bits(&self, gpu: &Gpu) -> Vec<u32> {
        gpu.read_buffer(self.field.visibility_buffer())
            .expect("reads back")
    }
}

fn placed(gpu: &Gpu, voxels: &Voxels) -> Placed {
    let parameters = exact();
    let on_gpu = GpuVoxels::upload(gpu, voxels, ORIGIN).expect("fits");
    let field = ProbeField::new(gpu, volume(), &parameters).expect("fits");
    let mut placed = Placed::new(gpu, field, &on_gpu);
    placed.run(gpu, &parameters);
    placed
}

/// The voxels (grid space) of the box of a slot of the lattice, with their word and bit.
fn box_in(
    volume: &Volume,
    visibility_bits: &VisibilityBits,
    slot: u32,
) -> impl Iterator<Item = (IVec3, usize, u32)> {
    let level = volume.level_of(slot);
    let lattice = level.anchor() + level.point(slot).as_vec3() * level.spacing();
    let seen = visibility_bits.boxes()[(slot / volume.level_slots()) as usize];
    let corner = VisibilityBox::corner(lattice, level.spacing()) - ORIGIN;
    let first_word = seen.first_word + slot % volume.level_slots() * seen.words();
    let n = seen.counts;
    (0..n.element_product()).map(move |i| {
        let at = UVec3::new(i % n.x, i / n.x % n.y, i / n.x / n.y);
        let (word, bit) = seen.place(at);
        (corner + at.as_ivec3(), (first_word + word) as usize, bit)
    })
}

fn is_surface(voxels: &Voxels, voxel: IVec3) -> bool {
    let around =
        (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| (x, y, z))));
    voxels.material(voxel) == 0
        && around
            .map(IVec3::from)
            .any(|step| voxels.material(voxel + step) != 0)
}

/// Whether the way is free; `None` where it runs along an edge, so that rounding decides.
fn sees(voxels: &Voxels, from: DVec3, to: DVec3) -> Option<bool> {
    let ways = (0..6).map(|i| {
        let nudge = sampling::fibonacci(i, 6) * 2e-3;
        let ray = Ray {
            max_distance: 1.0,
            ..Ray::new(from + nudge, to + nudge - from - nudge)
        };
        from == to || march_plain(voxels, &ray) == Outcome::Miss
    });
    let clear = ways.filter(|clear| *clear).count();
    (clear == 0 || clear == 6).then_some(clear == 6)
}

#[test]
fn a_probe_sees_what_marching_says_and_its_back_side_probe_the_rest() {
    let gpu = gpu();
    let voxels = rooms();
    let placed = placed(&gpu, &voxels);
    let visibility_bits = placed.field.visibility_bits().expect("exact");
    let (places, bits) = (placed.places(&gpu), placed.bits(&gpu));
    let lattice = volume().slots();
    let reach = (MOVE_REACH * SPACING).as_ivec3();
    let (mut seen, mut hidden, mut back_sides) = (0, 0, 0);
    for slot in 0..2 * lattice {
        let [x, y, z, w] = places[slot as usize];
        let place = Vec3::new(x, y, z).as_dvec3() - ORIGIN.as_dvec3();
        let has_back_side = slot < lattice && w == 2.0;
        let back_side = places[(slot % lattice + lattice) as usize];
        assert_eq!(
            slot < lattice && back_side[3] != 0.0,
            has_back_side,
            "slot {slot}"
        );
        if has_back_side {
            back_sides += 1;
            let home = volume().position(slot).floor().as_ivec3();
            let voxel = Vec3::new(back_side[0], back_side[1], back_side[2])
                .floor()
                .as_ivec3();
            assert!(
                (voxel - home).abs().cmple(reach).all(),
                "out of reach: slot {slot}"
            );
            assert_eq!(
                voxels.material(voxel - ORIGIN),
                0,
                "a back-side probe in a solid voxel: slot {slot}"
            );
        }
        let back_side_from = (slot / lattice * visibility_bits.lattice_words()) as usize;
        for (voxel, word, bit) in box_in(placed.field.volume(), visibility_bits, slot % lattice) {
            let (found, own) = (bits[back_side_from + word] >> bit & 1 == 1, bits[word]);
            let lit_by_own = slot >= lattice && own >> bit & 1 == 1;
            let centre = voxel.as_dvec3() + 0.5;
            let expected = match w != 0.0 && is_surface(&voxels, voxel) && !lit_by_own {
                true => sees(&voxels, centre, place),
                false => Some(false),
            };
            if let Some(expected) = expected {
                assert_eq!(found, expected, "slot {slot} at {place} and {voxel}");
                seen += u32::from(found);
                hidden += u32::from(!found && w != 0.0 && is_surface(&voxels, voxel));
            }
        }
    }
    assert!(
        seen > 5000 && hidden > 5000 && back_sides > 20,
        "the world tests all three: {seen}, {hidden}, {back_sides}"
    );
}

#[test]
fn without_surfaces_or_air_there_are_no_back_side_probes() {
    let gpu = gpu();
    let empty = Voxels::empty(UVec3::splat(SIZE as u32));
    let mut solid = empty.clone();
    solid.fill_box(IVec3::ZERO, IVec3::splat(SIZE - 1), 1);
    for (voxels, alive) in [(&empty, true), (&solid, false)] {
        let placed = placed(&gpu, voxels);
        let places = placed.places(&gpu);
        let (own, back_side) = places.split_at(volume().slots() as usize);
        assert!(own.iter().any(|place| (place[3] == 1.0) == alive));
        assert!(own.iter().all(|place| place[3] < 2.0));
        assert!(back_side.iter().all(|place| place[3] == 0.0));
    }
}

/// Probes that an edit touches examine the lines of sight that pass it, others nothing, and that is enough.
#[test]
fn after_edits_probes_see_as_fresh_ones_do() {
    let gpu = gpu();
    let parameters = exact();
    let mut voxels = rooms();
    let on_gpu = GpuVoxels::upload(&gpu, &voxels, ORIGIN).expect("fits");
    let mut on_gpu = match on_gpu.with_room_for(&gpu, &voxels).expect("fits") {
        Some(larger) => larger,
        None => on_gpu,
    };
    let field = ProbeField::new(&gpu, volume(), &parameters).expect("fits");
    let mut edited = Placed::new(&gpu, field, &on_gpu);
    edited.run(&gpu, &parameters);
    let before = edited.bits(&gpu);
    let edits = [
        // A hole in the wall between the rooms, half of it closed again.
        ([15, 8, 8], [15, 12, 13], 0),
        ([15, 8, 8], [15, 12, 10], 1),
        // A block in the air: some probes move, and others lose sight of what lies behind it.
        ([6, 10, 18], [10, 15, 20], 1),
        ([6, 10, 18], [6, 10, 18], 0),
        // A room opens, and a screen divides it.
        ([17, 1, 3], [26, 3, 27], 0),
        ([22, 4, 4], [22, 20, 27], 1),
        ([6, 10, 18], [10, 15, 20], 0),
    ];
    for (number, (low, high, material)) in edits.into_iter().enumerate() {
        let edit = voxels.fill_box(low.into(), high.into(), material);
        let larger = on_gpu.with_room_for(&gpu, &voxels).expect("fits");
        if let Some(larger) = larger {
            // The passes are made again for the larger buffers; the field stays.
            on_gpu = larger;
            edited = Placed::new(&gpu, edited.field, &on_gpu);
        }
        on_gpu.write(&gpu, &voxels, &edit);
        let (first, last) = edit.region.expect("something changed");
        let changes = &mut edited.field.changes;
        changes.edit(first.as_ivec3(), last.as_ivec3(), ORIGIN, 1);
        changes.begin_frame(0.0, 1);
        let bits_before = edited.bits(&gpu);
        edited.run(&gpu, &parameters);
        let fresh = placed(&gpu, &voxels);
        assert_eq!(edited.places(&gpu), fresh.places(&gpu), "edit {number}");
        let (bits, expected) = (edited.bits(&gpu), fresh.bits(&gpu));
        let wrong = (0..bits.len()).filter(|&i| bits[i] != expected[i]);
        assert_eq!(wrong.collect::<Vec<_>>(), [0; 0], "edit {number}");
        assert!(bits_before != bits, "edit {number} does not matter");
    }
    // An update of another region would have missed the change.
    let mut missed = placed(&gpu, &rooms());
    let elsewhere = IVec3::splat(500);
    missed.field.changes.edit(elsewhere, elsewhere, ORIGIN, 1);
    missed.field.changes.begin_frame(0.0, 1);
    missed.run(&gpu, &parameters);
    assert_eq!(missed.bits(&gpu), before);
}

/// An edit touches few probes, so on a GPU several workgroups look for each, in layers of its box.
#[test]
fn workgroups_that_share_a_probe_see_what_one_sees() {
    let gpu = gpu();
    let parameters = exact();
    let (rooms, mut dug) = (rooms(), rooms());
    let (low, high) = (IVec3::new(15, 8, 8), IVec3::new(15, 12, 13));
    dug.fill_box(low, high, 0);
    let [before, after] =
        [&rooms, &dug].map(|voxels| GpuVoxels::upload(&gpu, voxels, ORIGIN).expect("fits"));
    let seen_with = |shares| {
        let looking = |field: &ProbeField, voxels: &GpuVoxels| {
            ProbeVisibility::with_shares(&gpu, field, &voxels.resources(), shares)
                .expect("compiles")
        };
        let field = ProbeField::new(&gpu, volume(), &parameters).expect("fits");
        let mut placed = Placed::new(&gpu, field, &before);
        placed.visibility_bits = looking(&placed.field, &before);
        placed.run(&gpu, &parameters);
        let fresh = (placed.places(&gpu), placed.bits(&gpu));
        let mut edited = Placed::new(&gpu, placed.field, &after);
        edited.visibility_bits = looking(&edited.field, &after);
        edited.field.changes.edit(low, high, ORIGIN, 1);
        edited.field.changes.begin_frame(0.0, 1);
        edited.run(&gpu, &parameters);
        (fresh, (edited.places(&gpu), edited.bits(&gpu)))
    };
    let alone = seen_with(1);
    assert_ne!(alone.0, alone.1, "the edit matters");
    // Of a box of 45 bricks three workgroups divide layers of 9, and of fourteen two have none.
    for shares in [3, 14] {
        assert!(seen_with(shares) == alone, "{shares} workgroups");
    }
}

/// Levels that follow the camera.
pub fn nested(cascades: u32) -> Volume {
    Volume::new(&LayoutSpec {
        name: "test".into(),
        counts: UVec3::new(6, 5, 7),
        spacing: Vec3::new(2.5, 2.0, 2.0),
        centre: Vec3::ZERO,
        follow: true,
        cascades,
        octree: None,
    })
    .expect("a good layout")
}

/// New probes find their visibility, and others keep theirs. The result is as if the volume had begun there.
#[test]
fn after_a_move_the_probes_of_every_level_see_as_if_they_had_begun_there() {
    let gpu = gpu();
    let voxels = rooms();
    let on_gpu = GpuVoxels::upload(&gpu, &voxels, ORIGIN).expect("fits");
    let parameters = exact();
    let begun = |eyes: &[Vec3]| {
        let field = ProbeField::new(&gpu, nested(3), &parameters).expect("fits");
        let mut placed = Placed::new(&gpu, field, &on_gpu);
        for (frame, eye) in (0..).zip(eyes) {
            placed.field.follow(*eye, frame);
            placed.run(&gpu, &parameters);
        }
        placed
    };
    let (here, there) = (Vec3::new(-6.0, 0.0, 1.0), Vec3::new(-1.0, 2.5, 5.0));
    let (moved, fresh) = (begun(&[here, there]), begun(&[there]));
    assert!(
        moved.field.fresh() < moved.field.volume().slots(),
        "some stay"
    );
    assert_ne!(
        begun(&[here]).bits(&gpu),
        fresh.bits(&gpu),
        "the move matters"
    );
    assert_eq!(moved.bits(&gpu), fresh.bits(&gpu));
    let visibility_bits = fresh.field.visibility_bits().expect("exact");
    assert!(!visibility_bits.back_side());
    // The bits agree with marching.
    let (places, bits) = (fresh.places(&gpu), fresh.bits(&gpu));
    let volume = fresh.field.volume();
    let mut seen = [0; 3];
    for slot in 0..volume.slots() {
        let [x, y, z, w] = places[slot as usize];
        let place = Vec3::new(x, y, z).as_dvec3() - ORIGIN.as_dvec3();
        for (voxel, word, bit) in box_in(volume, visibility_bits, slot) {
            let expected = match w != 0.0 && is_surface(&voxels, voxel) {
                true => sees(&voxels, voxel.as_dvec3() + 0.5, place),
                false => Some(false),
            };
            let found = bits[word] >> bit & 1 == 1;
            assert!(
                expected.is_none_or(|expected| expected == found),
                "slot {slot}, {voxel}"
            );
            seen[(slot / volume.level_slots()) as usize] += u32::from(found);
        }
    }
    assert!(seen.iter().all(|count| *count > 500), "{seen:?}");
}
