//! Lamps that are spheres, in whole frames: the picture's direct light is that of the path tracer, kept visibility is never
//! wrong, and nothing flickers that no average smooths.

use grotto::{
    gpu::{Gpu, Recorder},
    lights::{LampState, Lights},
    measure::{
        comparison::{self, Shown},
        picture::Picture,
        selection::Selection,
    },
    parameters::{Antialias, FinalGather, ProbeParameters},
    world::View,
};

use crate::support::{
    self,
    frames::{Drawn, apart, mean},
};

/// Pillars, a bench, a shelf and a wall with a window, under spheres of several sizes; one pokes into the wall.
const HALL: &str = "(
    title: \"A hall of soft shadows.\",
    size: (40, 20, 40),
    origin: (-20, -4, -20),
    shape: Union([
        Subtraction([
            Translate(by: (0, 5, 0), of: Box(half: (18, 7, 18))),
            Translate(by: (0, 5, 0), of: Box(half: (16, 5, 16))),
        ]),
        Translate(by: (3, 5, 0), of: Box(half: (1, 5, 2))),
        Translate(by: (-7, 3, -6), of: Box(half: (1, 4, 1))),
        Translate(by: (-4, 1, 6), of: Box(half: (4, 1, 1))),
        Translate(by: (-10, 6, 4), of: Box(half: (3, 0.5, 6))),
    ]),
    materials: {\"plaster\": (a: Flat(0.6, 0.6, 0.6))},
    lamps: [
        (name: \"spheres\", lamps: [
            (position: (9.5, 8, 0.5), power: 900, soft_radius: 1.5),
            (position: (-14.5, 3.25, -9.5), power: 300, soft_radius: 2.5),
            (kind: Spot(direction: (-0.3, -1, 0.2), inner_deg: 20, outer_deg: 50),
                position: (0, 8, -3), power: 900, soft_radius: 0.5),
            (position: (11, 1.5, 12), power: 100),
        ]),
    ],
    cameras: [(name: \"down\", position: (8, 8, 13), look_at: (-3, 1, -2), fov_deg: 75)],
    layouts: [(name: \"fine\", counts: (8, 4, 8), spacing: 5, centre: (0.5, 5.5, 0.5))],
)";

const SIZE: [u32; 2] = [96, 72];

fn hall(gpu: Gpu, final_gather: FinalGather) -> Drawn {
    let world = support::parsed(HALL);
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters {
        rays: 16,
        warmup_frames: 4,
        final_gather,
        // Every face that is seen has a place in the surface cache.
        face_pixels: 0.5,
        ..Default::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.view = View::Direct;
    drawn
}

/// Direct light with shadow rays for every pixel and lamp.
fn by_rays(like: &Drawn) -> Picture {
    let mut plain = hall(support::gpu(), FinalGather::Off);
    plain.lights = like.lights.clone();
    plain.shot.soft_rays = like.shot.soft_rays;
    plain.draw(1);
    plain.radiance()
}

/// Pixels whose light differs by more than 2 % of the picture's mean.
fn differing(a: &Picture, b: &Picture) -> usize {
    let allowed = 0.02 * mean(b) as f32;
    let far = |(a, b): (&[f32; 3], &[f32; 3])| (a[1] - b[1]).abs() > allowed.max(0.02 * b[1]);
    a.rgb.iter().zip(&b.rgb).filter(|&pair| far(pair)).count()
}

#[test]
fn kept_visibility_of_spheres_is_what_shadow_rays_say() {
    let mut drawn = hall(support::gpu(), FinalGather::On);
    drawn.shot.soft_rays = 64;
    let rays = |drawn: &Drawn| {
        let count = |pixels| drawn.frame.count_shadow_rays(&drawn.gpu, pixels);
        count(true).expect("counts") - count(false).expect("counts")
    };
    drawn.draw(2);
    let at_first = rays(&drawn);
    drawn.draw(10);
    let kept = drawn.radiance();
    assert!(mean(&kept) > 0.05, "{}", mean(&kept));
    // Rays of the same pixels are the same, so only what is kept can differ: where a sphere is cut by a face's horizon,
    // its closed form is free of the noise of rays.
    let truth = by_rays(&drawn);
    let different = apart(&kept, &truth);
    assert!(different < 4e-3, "{different}");
    assert!(
        differing(&kept, &truth) <= 40,
        "{}",
        differing(&kept, &truth)
    );
    let later = rays(&drawn);
    assert!(
        3 * later < 2 * at_first,
        "{later} shadow rays, {at_first} before"
    );

    // A test that takes part of a sphere for all of it, or a wall with a hole for a wall, is noticed.
    for (sound, faulty) in [
        ("if are_empty(blocks) {", "if true {"),
        ("if hides_lamp(hull, slabs, slab) {", "if true {"),
    ] {
        let fault = ("surface_cache/hull.wesl", sound, faulty);
        let mut mutant = hall(support::with_faults(&drawn.gpu, &[fault]), FinalGather::On);
        mutant.shot.soft_rays = 64;
        mutant.draw(12);
        let found = differing(&mutant.radiance(), &truth);
        assert!(found > 80, "`{faulty}`: {found} pixels");
    }
}

#[test]
fn the_picture_agrees_with_the_path_tracer() {
    for final_gather in [FinalGather::On, FinalGather::Off] {
        let mut drawn = hall(support::gpu(), final_gather);
        drawn.shot.soft_rays = 32;
        drawn.draw(12);
        let shown = |linear: Picture| Shown::from_linear(linear, 0.0);
        let picture = shown(drawn.radiance());
        let truth = shown(drawn.path_traced(View::Direct, 512));
        let (result, _) =
            comparison::compare(&picture, &truth, &Selection::ALL).expect("the same size");
        assert!(
            (result.energy_ratio - 1.0).abs() < 5e-3,
            "{final_gather:?}: {result:?}"
        );
        assert!(result.flip.mean < 0.015, "{final_gather:?}: {result:?}");
        // Points in place of spheres are noticed.
        for lamp in &mut drawn.lights.lamps {
            lamp.soft_radius = 0.0;
        }
        drawn.draw(8);
        let hard = shown(drawn.radiance());
        let (hard, _) = comparison::compare(&hard, &truth, &Selection::ALL).expect("the same size");
        assert!(hard.flip.mean > 2.0 * result.flip.mean, "{hard:?}");
    }
}

#[test]
fn pictures_alone_stand_still_and_averaged_ones_take_turns() {
    let mut drawn = hall(support::gpu(), FinalGather::On);
    drawn.shot.soft_rays = 1;
    drawn.draw(12);
    let still = drawn.radiance();
    drawn.draw(1);
    assert_eq!(still, drawn.radiance(), "nothing flickers");
    let truth = drawn.path_traced(View::Direct, 256);
    let alone = apart(&still, &truth);

    // Jittered rays see other edges of pixels than `truth`: what is averaged is compared with the same pictures with many
    // rays each.
    let gpu = &drawn.gpu;
    (drawn.frame.antialias(gpu, Antialias::Temporal)).expect("fits");
    let mut averaged = |soft_rays| {
        drawn.frame.restart_antialiasing();
        drawn.shot.soft_rays = soft_rays;
        for _ in 0..32 {
            let mut recorder = Recorder::new(&drawn.gpu, None);
            assert!(drawn.frame.smooth(&drawn.gpu, &mut recorder, &drawn.shot));
            recorder.submit(&drawn.gpu).expect("submits");
        }
        drawn.radiance()
    };
    let (few, many) = (averaged(1), averaged(48));
    let averaged = apart(&few, &many);
    assert!(
        averaged < 0.7 * alone,
        "{averaged} on average, {alone} alone"
    );
}

/// A lamp that grows, shrinks and moves takes its shadow along in every frame.
#[test]
fn what_is_kept_follows_a_sphere() {
    let mut drawn = hall(support::gpu(), FinalGather::On);
    drawn.shot.soft_rays = 64;
    drawn.draw(12);
    let first: LampState = drawn.lights.lamps[0];
    let changes: [fn(&mut LampState); 3] = [
        |lamp| lamp.soft_radius = 3.0,
        |lamp| lamp.soft_radius = 0.0,
        |lamp| {
            lamp.soft_radius = 1.5;
            lamp.position_ws.x -= 7.0;
        },
    ];
    for (step, change) in changes.into_iter().enumerate() {
        let mut lamp = first;
        change(&mut lamp);
        drawn.lights.lamps[0] = lamp;
        for frames in [1, 9] {
            drawn.draw(frames);
            let found = differing(&drawn.radiance(), &by_rays(&drawn));
            assert!(found <= 40, "step {step}, {frames} frames: {found} pixels");
        }
    }
}

/// Lamps in walls, over the edge of the world and larger than it are drawn, with finite light.
#[test]
fn lamps_in_strange_places_are_drawn() {
    let mut drawn = hall(support::gpu(), FinalGather::On);
    drawn.shot.view = View::Full;
    let lamp = drawn.lights.lamps[0];
    for (position, soft_radius) in [
        ([17.0, 5.0, 0.0], 1.5),
        ([17.0, 5.0, 0.0], 0.011),
        ([0.0, 5.0, 0.0], 64.0),
        ([500.0, 5.0, 0.0], 64.0),
        ([-4.0, 1.0, 6.0], 1.0),
    ] {
        drawn.lights = Lights {
            lamps: vec![LampState {
                position_ws: position.into(),
                soft_radius,
                ..lamp
            }],
            ..drawn.lights.clone()
        };
        drawn.draw(8);
        let picture = drawn.radiance();
        assert!(
            picture
                .rgb
                .iter()
                .flatten()
                .all(|c| c.is_finite() && *c >= 0.0)
        );
        let kept = {
            drawn.shot.view = View::Direct;
            drawn.shot.soft_rays = 64;
            drawn.draw(1);
            drawn.radiance()
        };
        let truth = drawn.path_traced(View::Direct, 256);
        let (found, wanted) = (mean(&kept), mean(&truth));
        let error = (found - wanted).abs() / wanted.max(1e-3);
        assert!(
            error < 0.02,
            "{position:?}, radius {soft_radius}: {found}, not {wanted}"
        );
        drawn.shot.view = View::Full;
    }
}
