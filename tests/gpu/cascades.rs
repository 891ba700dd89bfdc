//! Volumes that follow the camera: which probes a move replaces and which it keeps, jumps, edits, and how
//! much the light changes during a flight.

use glam::{IVec3, Vec3};
use grotto::{
    frame::{Frame, Stage},
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    lights::Lights,
    measure::{
        changes::{ChangeMeter, mean_lit},
        picture::Picture,
    },
    parameters::{ProbeParameters, Visibility},
    passes::view::Shot,
    probes::{Layout as _, Volume},
    world::{Camera, LayoutSpec, View, World},
};

use crate::support::{self, frames};

/// A hall with pillars under a lamp at either end.
const HALL: &str = "(
    title: \"A hall to fly through.\",
    size: (96, 32, 64),
    origin: (-48, -16, -32),
    shape: Union([
        Subtraction([Box(half: (48, 16, 32)), Box(half: (44, 9, 20))]),
        Repeat(period: (16, 0, 16), of: Box(half: (1, 12, 1))),
    ]),
    materials: {\"plaster\": (a: Flat(0.7, 0.6, 0.5))},
    lamps: [(name: \"two\", lamps: [
        (position: (-30, 6, 3), power: 3000),
        (position: (30, 6, -3), power: 3000, colour: (0.4, 0.7, 1)),
    ])],
    sky: (zenith: (0, 0, 0)),
)";

const SIZE: [u32; 2] = [48, 32];

fn camera(position: Vec3) -> Camera {
    Camera {
        name: "flying".into(),
        position,
        yaw_deg: -90.0,
        pitch_deg: -5.0,
        fov_deg: 80.0,
    }
}

struct Hall {
    gpu: Gpu,
    frame: Frame,
    layout: LayoutSpec,
    probes: ProbeParameters,
    lights: Lights,
    world: World,
}

impl Hall {
    fn new(rays: u32, counts: [u32; 3], cascades: u32) -> Self {
        Self::seeing(Visibility::Auto, rays, counts, cascades)
    }

    fn seeing(visibility: Visibility, rays: u32, counts: [u32; 3], cascades: u32) -> Self {
        let gpu = support::gpu();
        let world = support::parsed(HALL);
        let layout = LayoutSpec {
            name: "around".into(),
            counts: counts.into(),
            spacing: Vec3::splat(2.0),
            centre: Vec3::ZERO,
            follow: true,
            cascades,
            octree: None,
        };
        let probes = ProbeParameters {
            rays,
            visibility,
            ..Default::default()
        };
        let stage = Stage::build(&gpu, &world).expect("fits");
        Self {
            frame: Frame::new(&gpu, stage, &layout, &probes, SIZE).expect("fits"),
            lights: Lights::at(&world, &world.lamp_presets[0], 0.0),
            gpu,
            layout,
            probes,
            world,
        }
    }

    fn shot(&self, position: Vec3) -> Shot {
        Shot {
            frame: self.frame.frames(),
            seed: 5,
            view: View::Irradiance,
            ..frames::shot(camera(position), SIZE)
        }
    }

    fn step(&mut self, position: Vec3) {
        let shot = self.shot(position);
        let mut recorder = Recorder::new(&self.gpu, None);
        self.frame
            .record(&self.gpu, &mut recorder, &shot, &self.lights, &self.probes);
        recorder.submit(&self.gpu).expect("submits");
    }

    fn settle(&mut self, position: Vec3, frames: u32) {
        for _ in 0..frames {
            self.step(position);
        }
    }

    fn picture(&self) -> Picture {
        self.frame.read_radiance(&self.gpu).expect("reads back")
    }

    /// The picture from another place, without updating the probes.
    fn look(&mut self, position: Vec3) -> Picture {
        let shot = self.shot(position);
        let mut recorder = Recorder::new(&self.gpu, None);
        self.frame.show(&self.gpu, &mut recorder, &shot);
        recorder.submit(&self.gpu).expect("submits");
        self.picture()
    }

    fn volume(&self) -> Volume {
        self.frame.field().volume().clone()
    }

    fn updates(&self) -> Vec<u32> {
        self.frame.field().updates(&self.gpu).expect("reads back")
    }

    fn places(&self) -> Vec<[f32; 4]> {
        let places = self.gpu.read_buffer(self.frame.field().places());
        places.expect("reads back")
    }
}

/// Number of levels, and how visibility is found: estimated from distances, exact, and exact with back-side probes.
const KINDS: [(u32, Visibility); 3] = [
    (3, Visibility::Auto),
    (3, Visibility::Exact),
    (1, Visibility::Auto),
];

/// Moves by one cell and by several, along one axis and along all: probes that stay keep their history, new
/// probes start without any.
#[test]
fn only_fresh_planes_start_again() {
    for (cascades, visibility) in KINDS {
        moves(Hall::seeing(visibility, 16, [8, 5, 8], cascades));
    }
}

fn moves(mut hall: Hall) {
    let mut place = Vec3::new(-30.0, 0.0, 1.0);
    hall.settle(place, 3);
    for step in [Vec3::X * 2.0, Vec3::new(-1.0, 2.0, 9.0), Vec3::X * 12.0] {
        let (before, updates) = (hall.volume(), hall.updates());
        place += step;
        hall.step(place);
        let volume = hall.volume();
        let mut fresh = 0;
        for (slot, (now, then)) in (0..).zip(hall.updates().into_iter().zip(updates)) {
            let level = volume.level_of(slot);
            let stays = before.level_of(slot).contains(level.point(slot));
            if stays {
                assert_eq!(now, then + u32::from(then > 0), "slot {slot} stays");
            } else {
                assert!(now <= 1, "slot {slot} is new, and {now} updates old");
                fresh += 1;
            }
        }
        assert!(fresh > 0 && fresh < volume.slots(), "{fresh}");
        assert_eq!(hall.frame.field().fresh(), fresh);
        hall.settle(place, 2);
    }
    hall.step(place);
    assert_eq!(hall.frame.field().fresh(), 0, "nothing moves");
}

fn irradiance(hall: &Hall) -> Vec<[f32; 3]> {
    let field = hall.frame.field();
    field.irradiance(&hall.gpu).expect("reads back")
}

/// After a jump that keeps no probe, the bytes equal those of a run that started there.
#[test]
fn a_jump_equals_a_start_there() {
    for (cascades, visibility) in KINDS {
        jumps(Hall::seeing(visibility, 16, [8, 5, 8], cascades));
    }
}

fn jumps(mut hall: Hall) {
    let (here, there) = (Vec3::new(-36.0, 0.0, 1.0), Vec3::new(36.0, -2.0, 0.0));
    hall.settle(here, 6);
    let before = hall.picture();
    hall.step(there);
    assert_eq!(hall.frame.field().fresh(), hall.volume().slots());
    hall.settle(there, 4);
    let jumped = (hall.picture(), irradiance(&hall));
    assert_ne!(before, jumped.0);
    hall.frame
        .replace_probes(&hall.gpu, &hall.layout, &hall.probes)
        .expect("fits");
    hall.settle(there, 5);
    assert!(mean_lit(&jumped.0) > 1e-3, "there is light to compare");
    assert!((hall.picture(), irradiance(&hall)) == jumped);
}

/// How the camera of [`flight`] moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Going {
    /// It does not move.
    Still,
    /// At 20 m/s and 60 frames a second.
    Flying,
    /// As `Flying`, and all probes are replaced every eighth frame.
    Forgetting,
}

/// 99th percentile of the changes of light from frame to frame on the same surfaces.
fn flight(going: Going) -> f64 {
    let mut hall = Hall::new(32, [6, 5, 6], 2);
    let speed = if going == Going::Still {
        0.0
    } else {
        1.0 / 3.0
    };
    let place = |frame: u32| Vec3::new(-16.0 + frame as f32 * speed, 0.3, 6.0);
    hall.settle(place(0), 60);
    let mut last = hall.picture();
    let mut meter = ChangeMeter::new(0.05 * mean_lit(&last));
    for frame in 1..=24 {
        if going == Going::Forgetting && frame % 8 == 0 {
            hall.frame
                .replace_probes(&hall.gpu, &hall.layout, &hall.probes)
                .expect("fits");
        }
        hall.step(place(frame));
        let now = hall.picture();
        let again = hall.look(place(frame - 1));
        meter.add(&last, &again).expect("comparable");
        last = now;
    }
    eprintln!("{going:?}: {:?}", meter.result());
    meter.result().p99
}

#[test]
fn nothing_pops_on_the_way() {
    let [still, flying, forgetting] = [Going::Still, Going::Flying, Going::Forgetting].map(flight);
    // Measured: 3.3 times, and 46 times when all probes are replaced.
    assert!(flying < 5.0 * still, "{flying} of {still}");
    assert!(
        forgetting > 3.0 * flying,
        "a pop would be seen: {forgetting} of {flying}"
    );
}

/// Probes of every level leave voxels that an edit makes solid.
#[test]
fn probes_of_every_level_leave_new_solid_voxels() {
    let mut hall = Hall::new(16, [8, 5, 8], 3);
    let eye = Vec3::new(-30.0, 0.0, 1.0);
    hall.settle(eye, 2);
    let mut voxels = hall.frame.stage.read_back(&hall.gpu).expect("reads back");
    let origin = hall.world.origin;
    let is_solid = |voxels: &grotto::world::voxels::Voxels, place: [f32; 4]| {
        let voxel = Vec3::new(place[0], place[1], place[2]).floor().as_ivec3() - origin;
        voxels.material(voxel) != 0
    };
    let low = IVec3::new(-34, -8, -4) - origin;
    let edit = voxels.fill_box(low, low + IVec3::new(9, 12, 9), 1);
    let level_slots = hall.volume().level_slots() as usize;
    for (level, places) in hall.places().chunks(level_slots).enumerate() {
        let caught = |place: &&[f32; 4]| place[3] != 0.0 && is_solid(&voxels, **place);
        let caught = places.iter().filter(caught).count();
        assert!(caught > 0, "the edit reaches level {level}");
    }
    hall.frame
        .apply(&hall.gpu, &voxels, &edit)
        .expect("the bricks fit");
    hall.step(eye);
    assert_eq!(hall.frame.field().fresh(), 0, "an edit moves no volume");
    for (slot, place) in hall.places().iter().enumerate() {
        assert!(
            place[3] == 0.0 || !is_solid(&voxels, *place),
            "slot {slot} is alive in a solid voxel at {place:?}"
        );
    }
}

#[test]
fn a_camera_beyond_all_worlds_shows_a_picture() {
    let mut hall = Hall::new(8, [6, 5, 6], 3);
    hall.settle(Vec3::splat(1e7), 2);
    assert!(hall.picture().rgb.iter().flatten().all(|v| v.is_finite()));
    // The camera comes back.
    hall.settle(Vec3::new(-30.0, 0.0, 1.0), 45);
    assert!(mean_lit(&hall.picture()) > 1e-3);
}

/// For each point and each choice, how much of the point's light comes from each level; choice 0 takes every level.
const SHARES_OF_LEVELS: &str = "
import package::math::hash::{hash, unit};
import package::probes::field::probe_info;
import package::probes::volume::{next_level, EVERY_LEVEL, NO_SHARE};
@group(3) @binding(0) var<storage, read_write> found: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let point_ws = vec3f(f32(id.y) * 0.9 - 3.0, 0.1, 0.2);
    var choice = select(unit(hash(id.x)), EVERY_LEVEL, id.x == 0u);
    var shares = vec4f(0.0);
    var left = 1.0;
    var level = 0u;
    while left > NO_SHARE && level < probe_info.level_count {
        let next = next_level(level, probe_info.level_count, point_ws, &choice);
        shares[next.level] += left * next.share;
        left -= left * next.share;
        level = next.level + 1u;
    }
    found[id.y * CHOICES + id.x] = shares;
}
const CHOICES: u32 = 4096u;
";

/// The shares of the levels that `gpu` finds: for each point those of every level, and the mean over random choices.
fn shares_of_levels(gpu: &Gpu, hall: &Hall) -> Vec<[[f32; 4]; 2]> {
    const CHOICES: u32 = 4096;
    const POINTS: u32 = 64;
    let spec = KernelSpec {
        shader: "generated/shares_of_levels",
        generated: &[("shares_of_levels", SHARES_OF_LEVELS)],
        ..Default::default()
    };
    let kernel = Kernel::new(gpu, &spec).unwrap_or_else(|error| panic!("{error}"));
    let bytes = u64::from(CHOICES * POINTS) * 16;
    let found = gpu.storage_buffer("found", bytes).expect("fits");
    let mut resources = hall.frame.field().resources().to_vec();
    resources.push(("found", found.as_entire_binding()));
    let bindings = kernel.bind(gpu, &resources);
    let mut recorder = Recorder::new(gpu, None);
    recorder.compute("shares_of_levels", |pass| {
        kernel.dispatch_threads(pass, &bindings, [CHOICES, POINTS, 1])
    });
    recorder.submit(gpu).expect("submits");
    let found: Vec<[f32; 4]> = gpu.read_buffer(&found).expect("reads back");
    let of_point = |choices: &[[f32; 4]]| {
        for shares in &choices[1..] {
            let whole = shares.iter().filter(|share| **share == 1.0).count();
            let none = shares.iter().filter(|share| **share == 0.0).count();
            assert_eq!((whole, none), (1, 3), "one level gives all: {shares:?}");
        }
        let mean = |level: usize| {
            let sum: f32 = choices[1..].iter().map(|shares| shares[level]).sum();
            sum / (CHOICES - 1) as f32
        };
        [choices[0], [0, 1, 2, 3].map(mean)]
    };
    found.chunks(CHOICES as usize).map(of_point).collect()
}

fn departure([every, mean]: &[[f32; 4]; 2]) -> f32 {
    let differences = every.iter().zip(mean).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f32::max)
}

/// Rays take the light of one of the levels that share a point, with the probability of its share.
#[test]
fn levels_are_chosen_as_often_as_their_shares_say() {
    let mut hall = Hall::new(16, [8, 5, 8], 4);
    hall.step(Vec3::ZERO);
    let shares = shares_of_levels(&hall.gpu, &hall);
    let shared = |[every, _]: &&[[f32; 4]; 2]| every.iter().all(|share| *share < 0.9);
    assert!(shares.iter().filter(shared).count() > 5, "{shares:?}");
    for level in 0..4 {
        let gives = |[every, _]: &[[f32; 4]; 2]| every[level] > 0.5;
        assert!(shares.iter().any(gives), "level {level}: {shares:?}");
    }
    for of_point in &shares {
        let sum: f32 = of_point[0].iter().sum();
        assert!((sum - 1.0).abs() < 2e-4, "{of_point:?}");
        // Four standard deviations of the mean of 4095 choices.
        assert!(departure(of_point) < 0.032, "{of_point:?}");
    }
    let unfair = [(
        "probes/volume.wesl",
        "*choice < share {",
        "*choice < 0.8 * share {",
    )];
    let shares = shares_of_levels(&support::with_faults(&hall.gpu, &unfair), &hall);
    assert!(shares.iter().any(|of_point| departure(of_point) > 0.032));
}
