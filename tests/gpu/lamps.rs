//! Lamps in whole frames: what they light by kept visibility equals what shadow rays say, and light follows the power
//! of a lone lamp exactly.

use glam::{DVec3, IVec3, Vec3};
use grotto::{
    gpu::Gpu,
    lights::{LampState, Lights, table::KNOWN_LAMPS},
    measure::picture::Picture,
    parameters::{FinalGather, ProbeParameters},
    world::{View, voxels::Voxels},
};

use crate::support::{
    self, Fault,
    frames::{Drawn, apart, mean},
    with_faults,
};

/// A room with pillars, a bench and a shelf, under lamps of every kind. Its floor's upper faces lie at y = 0.
const ROOM: &str = "(
    title: \"A room of shadows.\",
    size: (40, 20, 40),
    origin: (-20, -4, -20),
    shape: Union([
        Subtraction([
            Translate(by: (0, 5, 0), of: Box(half: (18, 7, 18))),
            Translate(by: (0, 5, 0), of: Box(half: (16, 5, 16))),
        ]),
        Translate(by: (3, 5, 0), of: Box(half: (1, 5, 2))),
        Translate(by: (-7, 5, -6), of: Capsule(from: (0, -5, 0), to: (3, 5, 1), radius: 1.5)),
        Translate(by: (-4, 1, 6), of: Box(half: (4, 1, 1))),
        Translate(by: (-10, 6, 4), of: Box(half: (3, 0.5, 6))),
    ]),
    materials: {\"plaster\": (a: Flat(0.6, 0.6, 0.6))},
    lamps: [
        (name: \"many\", lamps: [
            (position: (9.5, 8.5, 0.5), power: 400),
            (position: (-9.5, 8.25, -9.5), power: 300),
            (position: (0.5, 2.5, 9.5), power: 200),
            (position: (11, 1.5, 12), power: 200),
            (kind: Spot(direction: (-0.3, -1, 0.2), inner_deg: 20, outer_deg: 50), position: (0, 9, -3), power: 900),
        ]),
        (name: \"one\", lamps: [(position: (9.5, 8.5, 0.5), power: 900)]),
    ],
    cameras: [(name: \"down\", position: (8, 8, 13), look_at: (-3, 1, -2), fov_deg: 75)],
    layouts: [(name: \"fine\", counts: (8, 4, 8), spacing: 5, centre: (0.5, 5.5, 0.5))],
)";

const SIZE: [u32; 2] = [96, 72];

pub fn room(preset: usize, final_gather: FinalGather) -> Drawn {
    room_on(support::gpu(), preset, final_gather)
}

fn room_on(gpu: Gpu, preset: usize, final_gather: FinalGather) -> Drawn {
    let world = support::parsed(ROOM);
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters {
        rays: 48,
        warmup_frames: 8,
        final_gather,
        // Every face that is seen has a place in the surface cache.
        face_pixels: 0.5,
        ..Default::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    let preset = &drawn.world.lamp_presets[preset];
    drawn.lights = Lights::at(&drawn.world, preset, 0.0);
    drawn.shot.view = View::Direct;
    drawn
}

/// Direct light of the same lamps with a shadow ray for every pixel and lamp.
pub fn by_rays(drawn: &Drawn, voxels: Option<&Voxels>) -> Picture {
    let mut plain = room(0, FinalGather::Off);
    plain.lights = drawn.lights.clone();
    if let Some(voxels) = voxels {
        let stage = grotto::frame::Stage::upload(&plain.gpu, &plain.world, voxels).expect("fits");
        let layout = plain.world.layouts[0].clone();
        let probes = plain.probes.clone();
        plain.frame =
            grotto::frame::Frame::new(&plain.gpu, stage, &layout, &probes, SIZE).expect("fits");
    }
    plain.draw(1);
    plain.radiance()
}

/// Shadow rays that the picture's own pixels send.
fn rays_of_pixels(drawn: &Drawn) -> u64 {
    let count = |pixels| {
        let count = drawn.frame.count_shadow_rays(&drawn.gpu, pixels);
        count.expect("counts")
    };
    count(true) - count(false)
}

#[test]
fn kept_visibility_of_lamps_is_what_shadow_rays_say() {
    let mut drawn = room(0, FinalGather::On);
    drawn.draw(2);
    let at_first = rays_of_pixels(&drawn);
    drawn.draw(10);
    let kept = drawn.radiance();
    assert!(mean(&kept) > 0.05, "{}", mean(&kept));
    let different = apart(&kept, &by_rays(&drawn, None));
    assert!(different < 1e-4, "{different}");
    let later = rays_of_pixels(&drawn);
    assert!(
        2 * later < at_first,
        "{later} shadow rays once visibility is known, {at_first} before"
    );
}

/// Shadow rays of lamps that a face sees in part march through the span of their way in which solid voxels lie.
#[test]
fn spans_that_miss_what_is_in_the_way_are_found() {
    let file = "surface_cache/lamp_visibility.wesl";
    let faults = [
        (
            "let first = packed & WHOLE_WAY;",
            "let first = (packed & WHOLE_WAY) + 500u;",
        ),
        (
            "let last = (packed >> SPAN_BITS) & WHOLE_WAY;",
            "let last = ((packed >> SPAN_BITS) & WHOLE_WAY) * 3u / 4u;",
        ),
        ("if (packed >> (2u * SPAN_BITS)) != number {", "if false {"),
    ];
    // Lamps share places only where there are more of them than places.
    let pictures = |faults: &[Fault]| pictures_under_many(with_faults(&support::gpu(), faults), 40);
    let sound = pictures(&[]);
    for (number, (right, wrong)) in faults.into_iter().enumerate() {
        let wrong = pictures(&[(file, right, wrong)]);
        let different = sound.iter().zip(&wrong).map(|(a, b)| apart(a, b));
        let most = different.fold(0.0, f64::max);
        assert!(most > 1e-3, "fault {number}: {most}");
    }
}

#[test]
fn a_lamp_that_moves_takes_its_shadows_along_in_every_frame() {
    let mut drawn = room(0, FinalGather::On);
    drawn.draw(1);
    let of_all_pixels = rays_of_pixels(&drawn);
    drawn.draw(8);
    for step in 0..3 {
        for lamp in &mut drawn.lights.lamps {
            lamp.position_ws += DVec3::new(-0.7, 0.0, 0.9);
        }
        drawn.draw(1);
        let sent = rays_of_pixels(&drawn);
        assert!(
            5 * sent < 4 * of_all_pixels,
            "step {step}: {sent} of {of_all_pixels} rays: large faces say the rest, though the lamps move"
        );
        let different = apart(&drawn.radiance(), &by_rays(&drawn, None));
        assert!(different < 1e-4, "step {step}: {different}");
    }
    // And when it rests again.
    for _ in 0..12 {
        drawn.draw(1);
    }
    let different = apart(&drawn.radiance(), &by_rays(&drawn, None));
    assert!(different < 1e-4, "at rest: {different}");
}

/// Pixels pass over lamps that their faces do not see, without loading them.
const PASSES_OVER: Fault = (
    "view/primary_lighting.wesl",
    "let left = all & ~certainly_hidden(known, has_others(list));",
    "let left = all;",
);

/// The room under `count` lamps, spread over it.
fn under_many(gpu: Gpu, count: usize) -> Drawn {
    let mut drawn = room_on(gpu, 0, FinalGather::On);
    // Rays of faces have no part in direct light where there are no lists of lamps. With lists, pixels whose faces have no light yet
    // show a lamp by chance, and which faces get few rays depends on the order of threads.
    if count <= KNOWN_LAMPS as usize {
        drawn.probes.face_share = 0.05;
    }
    let first = drawn.lights.lamps[0];
    let place = |number: usize| {
        let spread = |step: f64| (number as f64 * step).fract() - 0.5;
        DVec3::new(
            30.0 * spread(0.618),
            5.0 + 8.0 * spread(0.324),
            30.0 * spread(0.755),
        )
    };
    let lamp = |number| LampState {
        position_ws: place(number),
        intensity: first.intensity / count as f64 * (1.0 + (number % 3) as f64),
        ..first
    };
    drawn.lights.lamps = (0..count).map(lamp).collect();
    drawn
}

/// Pictures at rest, while every second lamp moves, while all flicker, and after an edit.
fn pictures_under_many(gpu: Gpu, count: usize) -> Vec<Picture> {
    let mut drawn = under_many(gpu, count);
    drawn.draw(8);
    let mut pictures = vec![drawn.radiance()];
    for step in 0..4 {
        for lamp in drawn.lights.lamps.iter_mut().step_by(2) {
            lamp.position_ws += DVec3::new(0.4, 0.0, -0.3);
        }
        drawn.draw(1);
        pictures.push(drawn.radiance());
        if step == 1 {
            drawn.draw(9);
        }
    }
    drawn.draw(9);
    for lamp in &mut drawn.lights.lamps {
        lamp.intensity *= 0.9;
    }
    drawn.draw(1);
    pictures.push(drawn.radiance());
    let mut voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
    let origin = drawn.world.origin;
    let [low, high] = [IVec3::new(2, 1, -2), IVec3::new(4, 9, 2)].map(|at| at - origin);
    let edit = voxels.fill_box(low, high, 0);
    let applied = drawn.frame.apply(&drawn.gpu, &voxels, &edit);
    applied.expect("it fits");
    drawn.draw(1);
    pictures.push(drawn.radiance());
    pictures
}

/// Without lists of lamps and with them.
#[test]
fn lamps_that_are_passed_over_light_no_pixel() {
    for count in [20, 80] {
        let passed_over = pictures_under_many(support::gpu(), count);
        let looked_at = pictures_under_many(with_faults(&support::gpu(), &[PASSES_OVER]), count);
        for (number, (left, right)) in passed_over.iter().zip(&looked_at).enumerate() {
            assert!(mean(left) > 0.02);
            let different = apart(left, right);
            assert!(
                different < 1e-5,
                "{count} lamps, picture {number}: {different}"
            );
        }
    }
}

#[test]
fn a_lamp_that_is_passed_over_though_it_has_moved_is_found() {
    let file = "surface_cache/lamp_visibility.wesl";
    let whenever = (file, " || known.examined < known_since {", " {");
    let of_all = (
        file,
        "has_lists || known.examined == face_info.frame;",
        "true;",
    );
    for count in [20, 80] {
        // What faces that were not asked know of lamps that have moved.
        let unasked = (
            "surface_cache/lamps.wesl",
            "LEAST_PIXELS: f32 = 8.0",
            "LEAST_PIXELS: f32 = 8e9",
        );
        let sound = pictures_under_many(with_faults(&support::gpu(), &[unasked]), count);
        let faults = [unasked, whenever, of_all];
        let wrong = pictures_under_many(with_faults(&support::gpu(), &faults), count);
        let different: Vec<f64> = sound.iter().zip(&wrong).map(|(a, b)| apart(a, b)).collect();
        let most = different.iter().copied().fold(0.0, f64::max);
        assert!(most > 1e-3, "{count} lamps: {different:?}");
    }
}

#[test]
fn a_voxel_between_lamp_and_face_casts_its_shadow_in_the_first_frame() {
    let mut drawn = room(0, FinalGather::On);
    drawn.draw(10);
    let mut voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
    let before = drawn.radiance();
    // A board below the brightest lamp is built; then the pillar is dug away, and the board again.
    let boxes = [
        (IVec3::new(6, 6, -3), IVec3::new(11, 6, 3), 1),
        (IVec3::new(2, 1, -2), IVec3::new(4, 9, 2), 0),
        (IVec3::new(6, 6, -3), IVec3::new(11, 6, 3), 0),
    ];
    for (low, high, material) in boxes {
        let origin = drawn.world.origin;
        let edit = voxels.fill_box(low - origin, high - origin, material);
        let applied = drawn.frame.apply(&drawn.gpu, &voxels, &edit);
        applied.expect("fits");
        drawn.draw(1);
        let shown = drawn.radiance();
        assert!(apart(&shown, &before) > 0.02, "the edit is seen");
        let different = apart(&shown, &by_rays(&drawn, Some(&voxels)));
        assert!(different < 1e-4, "{low}: {different}");
    }
}

/// The same lamp with another power and another colour.
fn scaled(lamp: &LampState, gain: DVec3) -> Lights {
    let lamp = LampState {
        intensity: lamp.intensity * gain,
        ..*lamp
    };
    let black = grotto::world::Sky {
        zenith: Vec3::ZERO,
        horizon: Vec3::ZERO,
        ground: Vec3::ZERO,
    };
    Lights {
        lamps: vec![lamp],
        sky: black,
    }
}

/// Light is linear: with a lone lamp every picture is the still one times the lamp's gain, in every frame.
#[test]
fn light_scales_with_a_lone_lamp_in_every_frame() {
    let mut still = room(1, FinalGather::On);
    let mut gliding = room(1, FinalGather::On);
    let lamp = still.lights.lamps[0];
    for drawn in [&mut still, &mut gliding] {
        drawn.shot.view = View::Indirect;
        drawn.lights = scaled(&lamp, DVec3::ONE);
        drawn.draw(30);
    }
    // A slow glide, a fast pulse, off, and on again.
    let gains = (0..12)
        .map(|frame| DVec3::splat(1.0 + 0.02 * f64::from(frame)))
        .chain((0..12).map(|frame| DVec3::splat(1.0 + 0.9 * f64::from(frame).sin())))
        .chain([DVec3::ZERO, DVec3::ZERO, DVec3::new(1.0, 0.5, 0.25)]);
    for (frame, gain) in gains.enumerate() {
        still.draw(1);
        gliding.lights = scaled(&lamp, gain);
        gliding.draw(1);
        let (expected, found) = (still.radiance(), gliding.radiance());
        let mut worst = 0.0f64;
        for (expected, found) in expected.rgb.iter().zip(&found.rgb) {
            for channel in 0..3 {
                let expected = f64::from(expected[channel]) * gain[channel];
                let allowed = expected.max(1e-4);
                worst = worst.max((f64::from(found[channel]) - expected).abs() / allowed);
            }
        }
        assert!(worst < 3e-3, "frame {frame}, gain {gain}: {worst}");
    }
}

/// Where two lamps change apart there is no common gain, and light is followed as it comes.
#[test]
fn lamps_that_change_apart_are_followed() {
    let mut drawn = room(0, FinalGather::On);
    drawn.shot.view = View::Indirect;
    drawn.draw(30);
    let before = mean(&drawn.radiance());
    for lamp in drawn.lights.lamps.iter_mut().skip(1) {
        lamp.intensity = DVec3::ZERO;
    }
    drawn.draw(40);
    let after = mean(&drawn.radiance());
    let truth = mean(&drawn.path_traced(View::Indirect, 64));
    assert!(after < 0.8 * before, "{after}, {before} before");
    assert!((after / truth - 1.0).abs() < 0.05, "{after}, not {truth}");
}
