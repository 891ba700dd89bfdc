//! What probes see, where their twins stand, and the light that comes of it.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Recorder},
    parameters::{ProbeParameters, Visibility},
    passes::{GpuVoxels, ProbeField, probe_sight::ProbeSight, probe_states::ProbeStates},
    probes::{Layout as _, Sight, Volume, sampling},
    reference::march::{Outcome, Ray, march_plain},
    world::{LayoutSpec, voxels::Voxels},
};

use crate::{Rig, gpu};

const SIZE: i32 = 32;
const ORIGIN: IVec3 = IVec3::new(-16, -16, -16);
const SPACING: Vec3 = Vec3::new(5.0, 4.0, 3.5);

fn exact() -> ProbeParameters {
    ProbeParameters {
        visibility: Visibility::Exact,
        ..Default::default()
    }
}

fn volume() -> Volume {
    Volume::new(&LayoutSpec {
        name: "test".into(),
        counts: UVec3::new(6, 7, 8),
        spacing: SPACING,
        centre: Vec3::new(0.3, -0.4, 0.5),
        follow: false,
        cascades: 1,
    })
    .expect("a good layout")
}

/// Two rooms with a wall of one voxel between them, columns in both, and a nook.
fn rooms() -> Voxels {
    let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
    voxels.fill_box(IVec3::splat(2), IVec3::splat(29), 1);
    voxels.fill_box(IVec3::new(4, 4, 4), IVec3::new(14, 27, 27), 0);
    voxels.fill_box(IVec3::new(16, 4, 4), IVec3::new(27, 27, 27), 0);
    voxels.fill_box(IVec3::new(8, 4, 9), IVec3::new(9, 27, 12), 1);
    voxels.fill_box(IVec3::new(20, 4, 18), IVec3::new(22, 15, 19), 1);
    voxels.fill_box(IVec3::new(28, 9, 9), IVec3::new(28, 9, 9), 0);
    voxels
}

/// The passes that place probes and look around.
struct Placed {
    field: ProbeField,
    states: ProbeStates,
    sight: ProbeSight,
}

impl Placed {
    fn new(gpu: &Gpu, field: ProbeField, voxels: &GpuVoxels) -> Self {
        Self {
            states: ProbeStates::new(gpu, &field, &voxels.resources()).expect("compiles"),
            sight: ProbeSight::new(gpu, &field, &voxels.resources()).expect("compiles"),
            field,
        }
    }

    fn run(&mut self, gpu: &Gpu, parameters: &ProbeParameters) {
        self.field.begin_frame(gpu, parameters, 1, 0);
        assert!(self.field.misplaced(), "there is something to look at");
        self.field.set_placed();
        let mut recorder = Recorder::new(gpu, None);
        self.states.record(&mut recorder);
        self.sight.record(&mut recorder);
        recorder.submit(gpu).expect("submits");
    }

    fn places(&self, gpu: &Gpu) -> Vec<[f32; 4]> {
        gpu.read_buffer(self.field.places()).expect("reads back")
    }

    fn bits(&self, gpu: &Gpu) -> Vec<u32> {
        let (_, bits) = self.field.sight().expect("exact");
        gpu.read_buffer(bits).expect("reads back")
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

/// The voxels (grid space) of a slot's box, with their word and bit.
fn box_of(slot: u32, sight: &Sight) -> impl Iterator<Item = (IVec3, usize, u32)> {
    let own = slot % volume().slots();
    let counts = volume().counts();
    let row = own / counts.x;
    let index = UVec3::new(own % counts.x, row % counts.y, row / counts.y);
    let lattice = volume().levels()[0].anchor() + index.as_vec3() * SPACING;
    let corner = Sight::corner(lattice, SPACING) - ORIGIN;
    let (n, words) = (sight.counts, sight.words());
    (0..n.x * n.y * n.z).map(move |i| {
        let at = UVec3::new(i % n.x, i / n.x % n.y, i / n.x / n.y);
        let word = slot * words + at.y + n.y * at.z;
        (corner + at.as_ivec3(), word as usize, at.x)
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

/// Whether nothing stands between: `None` where the way runs along an edge, which rounding decides.
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
fn a_probe_sees_what_marching_says_and_its_twin_the_rest() {
    let gpu = gpu();
    let voxels = rooms();
    let placed = placed(&gpu, &voxels);
    let (sight, _) = placed.field.sight().expect("exact");
    let (places, bits) = (placed.places(&gpu), placed.bits(&gpu));
    let lattice = volume().slots();
    let reach = (exact().move_reach * SPACING).as_ivec3();
    let (mut seen, mut hidden, mut twins) = (0, 0, 0);
    for slot in 0..2 * lattice {
        let [x, y, z, w] = places[slot as usize];
        let place = Vec3::new(x, y, z).as_dvec3() - ORIGIN.as_dvec3();
        let has_twin = slot < lattice && w == 2.0;
        let twin = places[(slot % lattice + lattice) as usize];
        assert_eq!(slot < lattice && twin[3] != 0.0, has_twin, "slot {slot}");
        if has_twin {
            twins += 1;
            let home = volume().position(slot).floor().as_ivec3();
            let voxel = Vec3::new(twin[0], twin[1], twin[2]).floor().as_ivec3();
            assert!(
                (voxel - home).abs().cmple(reach).all(),
                "out of reach: slot {slot}"
            );
            assert_eq!(
                voxels.material(voxel - ORIGIN),
                0,
                "a twin in stone: slot {slot}"
            );
        }
        for (voxel, word, bit) in box_of(slot, &sight) {
            let found = bits[word] >> bit & 1 == 1;
            let own = bits[word - (slot / lattice * lattice * sight.words()) as usize];
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
        seen > 5000 && hidden > 5000 && twins > 20,
        "the world tests all three: {seen}, {hidden}, {twins}"
    );
}

#[test]
fn where_there_is_no_surface_or_no_air_there_are_no_twins() {
    let gpu = gpu();
    let empty = Voxels::empty(UVec3::splat(SIZE as u32));
    let mut solid = empty.clone();
    solid.fill_box(IVec3::ZERO, IVec3::splat(SIZE - 1), 1);
    for (voxels, alive) in [(&empty, true), (&solid, false)] {
        let placed = placed(&gpu, voxels);
        let places = placed.places(&gpu);
        let (own, twins) = places.split_at(volume().slots() as usize);
        assert!(own.iter().any(|place| (place[3] == 1.0) == alive));
        assert!(own.iter().all(|place| place[3] < 2.0));
        assert!(twins.iter().all(|place| place[3] == 0.0));
    }
}

/// Only what an edit touches is looked at again, and that is enough.
#[test]
fn after_an_edit_probes_see_as_fresh_ones_do() {
    let gpu = gpu();
    let parameters = exact();
    let mut voxels = rooms();
    let on_gpu = GpuVoxels::upload(&gpu, &voxels, ORIGIN).expect("fits");
    let on_gpu = match on_gpu.with_room_for(&gpu, &voxels).expect("fits") {
        Some(larger) => larger,
        None => on_gpu,
    };
    let field = ProbeField::new(&gpu, volume(), &parameters).expect("fits");
    let mut placed_before = Placed::new(&gpu, field, &on_gpu);
    placed_before.run(&gpu, &parameters);
    let before = placed_before.bits(&gpu);
    // A hole in the wall between the rooms: no brick is new.
    let edit = voxels.fill_box(IVec3::new(15, 8, 8), IVec3::new(15, 12, 13), 0);
    on_gpu.write(&gpu, &voxels, &edit);
    let (first, last) = edit.region.expect("something changed");
    let field = &mut placed_before.field;
    field.note_change(first.as_vec3(), last.as_vec3() + 1.0);
    placed_before.run(&gpu, &parameters);
    let fresh = placed(&gpu, &voxels);
    assert_eq!(placed_before.bits(&gpu), fresh.bits(&gpu));
    assert_ne!(before, fresh.bits(&gpu), "the edit must matter");
    assert_eq!(placed_before.places(&gpu), fresh.places(&gpu));
    // A region elsewhere would have missed it.
    let mut missed = placed(&gpu, &rooms());
    missed
        .field
        .note_change(Vec3::splat(500.0), Vec3::splat(501.0));
    missed.run(&gpu, &parameters);
    assert_eq!(missed.bits(&gpu), before);
}

/// Points of the faces that bound a room, with their normals: on a line across voxels and cages.
fn line_on(face: u8, step: f32, count: u32) -> Vec<(Vec3, Vec3)> {
    let origin = ORIGIN.as_vec3();
    (0..count)
        .map(|i| {
            let along = step * i as f32;
            match face {
                // The floor of the first room, behind the column.
                0 => (Vec3::new(5.3 + along, 4.0, 14.2 + 0.7 * along), Vec3::Y),
                // Both sides of the wall between the rooms.
                1 => (Vec3::new(15.0, 6.1 + along, 5.4 + along), Vec3::NEG_X),
                _ => (Vec3::new(16.0, 6.1 + along, 5.4 + along), Vec3::X),
            }
        })
        .map(|(point, normal)| (origin + point, normal))
        .collect()
}

fn lit(rays: impl Fn(u32) -> [f32; 3]) -> Rig {
    let mut rig = Rig::seeing(volume(), exact());
    let voxels = GpuVoxels::upload(&rig.gpu, &rooms(), ORIGIN).expect("fits");
    let states = ProbeStates::new(&rig.gpu, &rig.field, &voxels.resources()).expect("compiles");
    let sight = ProbeSight::new(&rig.gpu, &rig.field, &voxels.resources()).expect("compiles");
    rig.field.begin_frame(&rig.gpu, &rig.parameters, 1, 0);
    let mut recorder = Recorder::new(&rig.gpu, None);
    states.record(&mut recorder);
    sight.record(&mut recorder);
    recorder.submit(&rig.gpu).expect("submits");
    let places: Vec<[f32; 4]> = rig.gpu.read_buffer(rig.field.places()).expect("reads back");
    rig.update(|slot, _| {
        let [r, g, b] = rays(slot);
        let alive = places[slot as usize][3] != 0.0;
        [r, g, b, if alive { 50.0 } else { -1.0 }]
    });
    rig
}

#[test]
fn a_constant_is_gathered_as_the_constant_wherever_a_probe_is_seen() {
    let rig = lit(|_| [0.25, 1.0, 4.0]);
    for face in 0..3 {
        for gathered in rig.gather(&line_on(face, 0.23, 30)) {
            for (found, expected) in gathered.iter().zip([0.25, 1.0, 4.0]) {
                assert!(
                    (found / expected - 1.0).abs() < 2e-3,
                    "face {face}: {gathered:?}"
                );
            }
        }
    }
}

#[test]
fn light_is_continuous_over_a_surface_and_stays_on_its_side_of_a_wall() {
    const STEP: f32 = 1e-3;
    let x_of = |slot: u32| volume().position(slot % volume().slots()).x;
    // Each probe another light; those whose lattice points lie in the second room are blue as well.
    let rig = lit(|slot| {
        let random = sampling::rotation(3, u64::from(slot)).xyz().as_vec3();
        [
            1.0 + random.x,
            f32::from(x_of(slot) > 12.0),
            f32::from(x_of(slot) < -6.0),
        ]
    });
    for face in 0..3 {
        for start in 0..24 {
            let mut line = line_on(face, 0.4, 24);
            let (point, normal) = line.swap_remove(start);
            let across = if normal.y > 0.5 {
                Vec3::new(1.0, 0.0, 0.7)
            } else {
                Vec3::new(0.0, 1.0, 1.0)
            };
            let points: Vec<_> = (0..60)
                .map(|i| (point + across * STEP * i as f32, normal))
                .collect();
            let light = rig.gather(&points);
            for pair in light.windows(2) {
                assert!(
                    (pair[0][0] - pair[1][0]).abs() < 0.05,
                    "face {face}: a step at {point}: {pair:?}"
                );
            }
        }
    }
    // Probes that stand far inside one room light nothing in the other, thin as the wall may be.
    for gathered in rig.gather(&line_on(1, 0.4, 40)) {
        assert_eq!(gathered[1], 0.0, "light through the wall: {gathered:?}");
    }
    for gathered in rig.gather(&line_on(2, 0.4, 40)) {
        assert_eq!(gathered[2], 0.0, "light through the wall: {gathered:?}");
    }
}
