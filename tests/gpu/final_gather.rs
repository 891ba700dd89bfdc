//! The final gather: faces that the camera sees trace rays for their own light. (tests/cli/measuring/stairs.rs
//! measures how close the result is to the path tracer.)

use glam::{DVec3, IVec3};
use grotto::{
    gpu::Gpu,
    lights::Lights,
    measure::picture::Picture,
    parameters::{FinalGather, ProbeParameters},
    passes::surface_cache::GpuFaceHistory,
    world::{View, voxels::Voxels},
};

use crate::support::{
    self, Fault,
    frames::{Drawn, apart, mean},
};

/// A room with a lamp behind a pillar. Its floor's upper faces lie at y = 0.
const ROOM: &str = "(
    title: \"A room to change.\",
    size: (24, 16, 24),
    origin: (-12, -4, -12),
    shape: Union([
        Subtraction([
            Translate(by: (0, 4, 0), of: Box(half: (10, 6, 10))),
            Translate(by: (0, 4, 0), of: Box(half: (8, 4, 8))),
        ]),
        Translate(by: (3, 4, 0), of: Box(half: (1, 4, 2))),
    ]),
    materials: {\"plaster\": (a: Flat(0.6, 0.6, 0.6))},
    lamps: [
        (name: \"on\", lamps: [(position: (6, 6, 0), power: 900)]),
        (name: \"off\"),
    ],
    cameras: [(name: \"down\", position: (-2, 5, 5), look_at: (-2, 0, -1), fov_deg: 60)],
    layouts: [(name: \"fine\", counts: (6, 4, 6), spacing: 4, centre: (0.5, 4.5, 0.5))],
)";

const SIZE: [u32; 2] = [48, 36];

struct Room {
    drawn: Drawn,
    voxels: Voxels,
}

impl Room {
    fn new(probes: ProbeParameters) -> Self {
        Self::of(ROOM, probes)
    }

    fn of(text: &str, probes: ProbeParameters) -> Self {
        Self::seen(text, probes, SIZE)
    }

    fn seen(text: &str, probes: ProbeParameters, size: [u32; 2]) -> Self {
        Self::on(support::gpu(), text, probes, size)
    }

    fn on(gpu: Gpu, text: &str, probes: ProbeParameters, size: [u32; 2]) -> Self {
        let world = support::parsed(text);
        let layout = world.layouts[0].clone();
        let mut drawn = Drawn::new(gpu, world, &layout, probes, size);
        drawn.shot.view = View::Irradiance;
        drawn.shot.seed = 3;
        let voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
        Self { drawn, voxels }
    }

    /// Lit by the lamps of this preset.
    fn light(&mut self, preset: usize) {
        let preset = &self.drawn.world.lamp_presets[preset];
        self.drawn.lights = Lights::at(&self.drawn.world, preset, 0.0);
    }

    /// Irradiance (over π) of the last of `frames` more frames.
    fn after(&mut self, frames: u32) -> Picture {
        self.drawn.draw(frames);
        self.drawn.radiance()
    }

    /// The picture that [`after`](Self::after) should converge to.
    fn truth(&self) -> Picture {
        self.drawn.path_traced(View::Irradiance, 256)
    }

    /// Entries of the surface cache.
    fn listed(&self) -> u32 {
        let faces = self.drawn.frame.faces();
        faces.listed(&self.drawn.gpu).expect("reads back")
    }

    /// Rays that quadrants have averaged.
    fn samples(&self) -> impl Iterator<Item = f32> {
        let histories = self.drawn.frame.faces().histories();
        let histories: Vec<GpuFaceHistory> =
            (self.drawn.gpu).read_buffer(histories).expect("reads back");
        let quadrants = histories.into_iter().flat_map(|face| face.quadrants);
        quadrants.map(|quadrant| quadrant.samples)
    }

    /// Fills a box of voxels (world space, both ends inclusive) with material 1.
    fn fill(&mut self, low: IVec3, high: IVec3) {
        let origin = self.drawn.world.origin;
        let edit = self.voxels.fill_box(low - origin, high - origin, 1);
        self.drawn
            .frame
            .apply(&self.drawn.gpu, &self.voxels, &edit)
            .expect("fits");
    }

    /// A solid block on the floor, 3 × 2 × 3, in the middle of the picture.
    fn build(&mut self) {
        self.fill(IVec3::new(-3, 0, -1), IVec3::new(-1, 1, 1));
    }
}

fn quick() -> ProbeParameters {
    ProbeParameters {
        rays: 64,
        warmup_frames: 8,
        ..Default::default()
    }
}

#[test]
fn faces_of_few_pixels_are_lit_by_the_probes_alone() {
    let by_probes = ProbeParameters {
        final_gather: FinalGather::Off,
        ..quick()
    };
    let too_small = ProbeParameters {
        final_gather: FinalGather::On,
        face_pixels: 1000.0,
        ..by_probes.clone()
    };
    let (probes, faces) = (
        Room::new(by_probes).after(6),
        Room::new(too_small.clone()).after(6),
    );
    assert!(mean(&probes) > 1e-3);
    assert!(probes == faces, "exactly the same");
    let large = ProbeParameters {
        face_pixels: 0.5,
        ..too_small
    };
    assert!(apart(&Room::new(large).after(6), &probes) > 0.01);
}

#[test]
fn a_quadrant_averages_as_many_rays_as_it_may() {
    let most = |face_samples| {
        let mut room = Room::new(ProbeParameters {
            face_samples,
            warmup_frames: 1,
            ..quick()
        });
        room.after(40);
        room.samples().fold(0.0, f32::max)
    };
    assert_eq!(most(16), 16.0);
    assert!(most(8192) > 64.0);
}

#[test]
fn a_still_picture_settles() {
    let mut room = Room::new(quick());
    room.after(60);
    let mut last = room.after(1);
    for _ in 0..4 {
        let next = room.after(1);
        assert!(apart(&next, &last) < 0.01, "{}", apart(&next, &last));
        last = next;
    }
    let listed = room.listed();
    assert!((100..2000).contains(&listed), "{listed}");
}

#[test]
fn a_share_of_the_budget_sends_fewer_rays() {
    let sent = |face_share| {
        let mut room = Room::new(ProbeParameters {
            face_share,
            ..quick()
        });
        room.drawn.draw(2);
        let faces = room.drawn.frame.faces();
        faces.rays_sent(&room.drawn.gpu).expect("reads back")
    };
    let (all, some) = (sent(1.0), sent(0.05));
    assert!(0 < some && some < all, "{some} of {all}");
}

/// Where the list has room for half of the visible faces, all of them get light of their own in turn.
#[test]
fn faces_that_the_list_has_no_room_for_have_their_turn() {
    let file = "surface_cache/allocate.wesl";
    let lit = |room_for: &str| {
        let fault = (file, "face_info.most_listed", room_for);
        let gpu = support::with_faults(&support::gpu(), &[fault]);
        let mut room = Room::on(gpu, ROOM, quick(), [96, 72]);
        let picture = room.after(80);
        // The four quadrants of a face send rays together.
        (
            picture,
            room.samples().filter(|rays| *rays > 16.0).count() / 4,
        )
    };
    let (all, _) = lit("face_info.most_listed");
    let (in_turn, some) = lit("100u");
    // Pixels see 211; faces that only rays hit come after them.
    assert!((200..=211).contains(&some), "{some} faces");
    let difference = apart(&in_turn, &all);
    assert!(difference < 0.03, "{difference}");
    // Without room for any there is light of probes alone.
    let (by_probes, none) = lit("0u");
    assert_eq!(none, 0);
    assert!(
        apart(&by_probes, &all) > 0.03,
        "{}",
        apart(&by_probes, &all)
    );
}

/// Rays request entries for the faces that they hit, visible or not. Light of many bounces is therefore right even
/// where the lattice of the probes is much too coarse for it.
#[test]
fn faces_that_rays_hit_have_their_own_light() {
    let coarse = ROOM.replace(
        "counts: (6, 4, 6), spacing: 4",
        "counts: (4, 3, 4), spacing: 8",
    );
    let bright = coarse
        .replace("Flat(0.6, 0.6, 0.6)", "Flat(0.75, 0.75, 0.75)")
        .replace("fov_deg: 60", "fov_deg: 80")
        .replace("position: (-2, 5, 5)", "position: (-6, 6.5, 6)");
    let mut by_probes = Room::seen(
        &bright,
        ProbeParameters {
            final_gather: FinalGather::Off,
            ..quick()
        },
        [96, 72],
    );
    let mut room = Room::seen(&bright, quick(), [96, 72]);
    let truth = room.truth();
    // Rays of the first frame make the first requests, so its list has only faces that pixels see.
    room.after(1);
    let seen = room.listed();
    room.after(1);
    let listed = room.listed();
    assert!(listed > seen + 10, "{listed} faces, {seen} of them seen");
    let (picture, coarse) = (room.after(198), by_probes.after(100));
    // Measured: 0.963, and 0.845 by probes. It is 0.868 without the light of faces where rays hit them and the correction of the
    // probes' light there; 0.945 without the first alone.
    let [ours, theirs] = [&picture, &coarse].map(|picture| mean(picture) / mean(&truth));
    assert!(
        (ours - 1.0).abs() < 0.08 && theirs < 0.88,
        "{ours}, {theirs} by probes"
    );
}

/// Quadrants of a face that differ by no more than their noise show the same light, so other rays change the picture
/// only a little.
#[test]
fn noise_between_quadrants_is_not_shown() {
    // Smaller faces have fewer rays in a picture of this size: their noise is another matter.
    let probes = ProbeParameters {
        face_pixels: 2.0,
        ..quick()
    };
    let seen_by = |seed| {
        let mut room = Room::new(probes.clone());
        room.drawn.shot.seed = seed;
        room.after(40)
    };
    let apart = apart(&seen_by(3), &seen_by(4));
    // Measured: 0.014, and 0.021 if each quadrant showed its own mean. The bound lies between the two.
    assert!(apart < 0.017, "{apart}");
}

/// Threads find faces, request them and claim entries for them in any order.
#[test]
fn the_order_of_threads_does_not_show() {
    let [once, again] = [(); 2].map(|()| Room::new(quick()).after(70));
    assert!(once == again);
}

/// The light stored before is wrong after the switch and must not be shown.
#[test]
fn a_lamp_that_goes_out_leaves_no_light() {
    let mut room = Room::new(quick());
    let lit = mean(&room.after(60));
    room.light(1);
    let mut by_probes = Room::new(ProbeParameters {
        final_gather: FinalGather::Off,
        ..quick()
    });
    let lit_by_probes = mean(&by_probes.after(60));
    by_probes.light(1);
    // The faces darken as fast as the probes do. After these frames next to nothing is left, and that is noise.
    for frame in 1..=6 {
        let left = mean(&room.after(1)) / lit;
        let left_by_probes = mean(&by_probes.after(1)) / lit_by_probes;
        println!("{frame}: {left:.5}, {left_by_probes:.5}");
        assert!(left < 1.1 * left_by_probes, "{left}, {left_by_probes}");
    }
    for _ in 7..=12 {
        let (left, left_by_probes) = (mean(&room.after(1)), mean(&by_probes.after(1)));
        assert!(left < 0.005 * lit, "{left} of {lit}");
        assert!(left_by_probes < 0.005 * lit_by_probes, "{left_by_probes}");
    }
    room.light(0);
    by_probes.light(0);
    let mut again = 0.0;
    for _ in 0..8 {
        again = mean(&room.after(1)) / lit;
        assert!(again < 1.1, "{again}: a flash");
    }
    let again_by_probes = mean(&by_probes.after(8)) / lit_by_probes;
    let apart = (again / again_by_probes - 1.0).abs();
    assert!(apart < 0.05, "{again}, {again_by_probes}");
    // Measured: 0.93, and rising. A value above 1 would be a flash.
    let later = mean(&room.after(4)) / lit;
    assert!((0.85..1.1).contains(&later), "{later}");
}

/// A new block casts its shade at once, and its own faces are lit at once.
#[test]
fn an_edit_shows_at_once() {
    let mut edited = Room::new(quick());
    let before = edited.after(60);
    edited.build();
    let soon = edited.after(4);
    let mut settled = Room::new(quick());
    settled.build();
    let truth = settled.after(90);
    let (was, is) = (apart(&before, &truth), apart(&soon, &truth));
    // Measured: the block changes 8 % of the light, and after four frames a third of that change is missing.
    assert!(was > 0.05, "the block changes little: {was}");
    assert!(is < 0.5 * was, "{is} apart, {was} before");
    assert!(soon.rgb.iter().flatten().all(|value| value.is_finite()));
    // None of the block's faces is black: they have found light.
    let darkest = |picture: &Picture| {
        picture
            .rgb
            .iter()
            .map(|rgb| rgb[1])
            .fold(f32::MAX, f32::min)
    };
    assert!(darkest(&soon) > 0.3 * darkest(&truth));
}

/// The alert of an edit makes nobody take noise for change: behind the wall all light stays as it is, and faces keep the rays
/// that they have averaged.
#[test]
fn an_edit_out_of_sight_leaves_the_light_as_it_is() {
    let other_rays = (
        "probes/schedule.wesl",
        "set_of(slot, first) << RAY_SET_SHIFT",
        "set_of(slot, frame) << RAY_SET_SHIFT",
    );
    let forgetful = (
        "surface_cache/resolve.wesl",
        "return max(AFTER_EDIT / max(step, 1e-6), LEAST_AFTER_CHANGE);",
        "return LEAST_AFTER_CHANGE;",
    );
    // The largest difference of the light from before, and the mean of the rays that quadrants have averaged.
    let after_edit = |faults: &[Fault<'_>]| {
        let gpu = match faults {
            [] => support::gpu(),
            _ => support::with_faults(&support::gpu(), faults),
        };
        let mut room = Room::on(gpu, ROOM, quick(), SIZE);
        let before = mean(&room.after(100));
        room.fill(IVec3::new(-12, -4, -12), IVec3::new(-11, -3, -11));
        let differs = (0..8).fold(0f64, |most, _| {
            most.max((mean(&room.after(1)) / before - 1.0).abs())
        });
        let samples: Vec<f32> = room.samples().filter(|&rays| rays > 0.0).collect();
        (differs, samples.iter().sum::<f32>() / samples.len() as f32)
    };
    let (differs, samples) = after_edit(&[]);
    assert!(differs < 0.01 && samples > 160.0, "{differs} {samples}");
    let (differs, _) = after_edit(&[other_rays]);
    assert!(differs > 0.03, "{differs}");
    let (_, samples) = after_edit(&[forgetful]);
    assert!(samples < 128.0, "{samples}");
}

/// While a lamp glides, faces repeat rays: what has changed at what these hit is added to their light, so that it is not late.
#[test]
fn light_of_faces_follows_a_lamp_that_glides() {
    let unheard = (
        "surface_cache/resolve.wesl",
        "return unpacked_radiance(now) - scale * unpacked_radiance(history.last_found);",
        "return vec3f(0.0);",
    );
    const FRAMES: u32 = 40;
    // From behind the pillar into the middle.
    let glide = |room: &mut Room, frame: u32| {
        room.drawn.lights.lamps[0].position_ws = DVec3::new(6.0, 6.0, 0.0).lerp(
            DVec3::new(-2.0, 6.0, -6.0),
            f64::from(frame) / f64::from(FRAMES),
        );
    };
    let after_glide = |faults: &[Fault<'_>]| {
        let gpu = match faults {
            [] => support::gpu(),
            _ => support::with_faults(&support::gpu(), faults),
        };
        let mut room = Room::on(gpu, ROOM, quick(), SIZE);
        room.after(100);
        (1..=FRAMES).for_each(|frame| {
            glide(&mut room, frame);
            room.drawn.draw(1);
        });
        room.drawn.radiance()
    };
    let mut settled = Room::new(quick());
    glide(&mut settled, FRAMES);
    let truth = settled.after(150);
    let (found, late) = (after_glide(&[]), after_glide(&[unheard]));
    let (differs, lags) = (apart(&found, &truth), apart(&late, &truth));
    let energy = mean(&found) / mean(&truth);
    assert!(differs < 0.05, "{differs}");
    assert!((energy - 1.0).abs() < 0.02, "{energy}");
    assert!(lags > 1.5 * differs, "{lags}, {differs} without the fault");
}

/// Emissive voxels are sampled from a list: a new one must be on that list, and must give no more and no less light
/// than it emits.
#[test]
fn an_ember_that_is_placed_gives_its_light() {
    let embers = ROOM.replace(
        "materials: {",
        "rules: [
            (material: \"ember\", when: InBox(min: (-3, 3, -9), max: (-2, 4, -8))),
            (material: \"plaster\"),
        ],
        materials: {
            \"ember\": (a: Flat(0.6, 0.6, 0.6), emission: (30, 20, 10)),
            ",
    );
    // With black walls all light comes from the embers directly, and none from the probes.
    let embers = embers.replace("Flat(0.6, 0.6, 0.6)", "Flat(0, 0, 0)");
    let all_faces = ProbeParameters {
        face_pixels: 0.5,
        ..quick()
    };
    let mut room = Room::of(&embers, all_faces);
    room.light(1);
    let (picture, truth) = (room.after(150), room.truth());
    let before = (mean(&picture) / mean(&truth) - 1.0).abs();
    assert!(before < 0.02 && apart(&picture, &truth) < 0.04, "{before}");
    let place = IVec3::new(0, 0, 1);
    room.fill(place, place);
    // The alert after an edit lasts long.
    let after = (mean(&room.after(280)) / mean(&room.truth()) - 1.0).abs();
    assert!(after < 0.02, "{after}");
}
