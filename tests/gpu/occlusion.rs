//! The occlusion field in whole frames: what the probes keep of the visibility of lamps and of the surroundings, against
//! closed forms and shadow rays.

use std::f64::consts::PI;

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::{
    gpu::Gpu,
    measure::picture::Picture,
    parameters::{FinalGather, OcclusionShown, ProbeParameters, Shadows, Visibility},
    world::{LayoutSpec, View, scenery::OctreeSpec},
};

use crate::support::{
    self,
    frames::{Drawn, apart, mean},
    scenes::{lattice, square_camera},
};

const SIZE: [u32; 2] = [40, 28];

/// A closed room, 22 voxels wide, with `more` in it, under `lamps`.
fn room(more: &str, lamps: &str) -> String {
    format!(
        "(
            title: \"A room.\",
            size: (32, 32, 32),
            origin: (-16, -16, -16),
            shape: Union([
                Subtraction([Box(half: (13, 13, 13)), Box(half: (11, 11, 11))]),
                {more}
            ]),
            materials: {{\"plaster\": (a: Flat(0.7, 0.6, 0.5))}},
            lamps: [(name: \"lamps\", lamps: [{lamps}])],
            cameras: [(name: \"inside\", position: (-8, 2, -9), look_at: (4, -4, 6), fov_deg: 80)],
            sky: (zenith: (0, 0, 0)),
        )"
    )
}

/// A box without openings around the place (3, 3, 3).
const SHELL: &str =
    "Translate(by: (3, 3, 3), of: Subtraction([Box(half: (3, 3, 3)), Box(half: (2, 2, 2))])),";

fn fine() -> LayoutSpec {
    lattice(UVec3::splat(6), Vec3::splat(4.0), Vec3::ZERO)
}

/// What probes keep in these tests unless they say otherwise.
fn probes() -> ProbeParameters {
    let mut probes = ProbeParameters {
        rays: 64,
        warmup_frames: 4,
        final_gather: FinalGather::Off,
        ..ProbeParameters::default()
    };
    probes.occlusion.lamps = 2;
    probes
}

fn drawn_on(gpu: Gpu, text: &str, layout: &LayoutSpec, probes: ProbeParameters) -> Drawn {
    let mut drawn = Drawn::new(gpu, support::parsed(text), layout, probes, SIZE);
    drawn.shot.view = View::Occlusion;
    drawn
}

fn drawn(text: &str, layout: &LayoutSpec, probes: ProbeParameters) -> Drawn {
    drawn_on(support::gpu(), text, layout, probes)
}

/// Least and greatest value of a picture.
fn range(picture: &Picture) -> [f32; 2] {
    let values = picture.rgb.iter().flatten();
    values.fold([f32::MAX, f32::MIN], |[low, high], value| {
        [low.min(*value), high.max(*value)]
    })
}

/// The mean of the view on two voxels of a surface, as seen from `height` voxels before it.
fn shown_from(drawn: &mut Drawn, position: [f64; 3], yaw_deg: f32, pitch_deg: f32) -> f64 {
    let before = drawn.shot.camera.clone();
    drawn.shot.camera = square_camera(DVec3::from(position), yaw_deg, pitch_deg);
    drawn.shot.camera.fov_deg = 30.0;
    drawn.draw(1);
    drawn.shot.camera = before;
    mean(&drawn.radiance())
}

#[test]
fn every_layout_keeps_1_in_an_empty_room_and_0_of_a_sealed_lamp() {
    let octree = LayoutSpec {
        octree: Some(OctreeSpec {
            depth: 2,
            divide_at: 0.0,
            ..OctreeSpec::default()
        }),
        ..lattice(UVec3::splat(2), Vec3::splat(24.0), Vec3::ZERO)
    };
    let cascades = LayoutSpec {
        cascades: 2,
        ..lattice(UVec3::splat(5), Vec3::splat(3.0), Vec3::ZERO)
    };
    let point = "(position: (3, 3, 3), power: 900)";
    let sphere = "(position: (3, 3, 3), power: 900, soft_radius: 1)";
    for (layout, visibility, lamp) in [
        (fine(), Visibility::Exact, point),
        (fine(), Visibility::Chebyshev, sphere),
        (octree, Visibility::Auto, sphere),
        (cascades, Visibility::Auto, point),
    ] {
        let of = |more| {
            let probes = ProbeParameters {
                visibility,
                ..probes()
            };
            let mut drawn = drawn(&room(more, lamp), &layout, probes);
            drawn.draw(12);
            (range(&drawn.radiance()), mean(&drawn.radiance()))
        };
        let case = format!("{visibility:?}, {layout:?}");
        let ([low, high], _) = of("");
        assert!(low > 0.999 && high <= 1.0, "{low}…{high} in {case}");
        // Chebyshev's test lets a little of what a probe inside of the shell sees through its walls.
        let most = if visibility == Visibility::Exact {
            1e-3
        } else {
            0.1
        };
        let (_, found) = of(SHELL);
        assert!(found < most, "{found} of a sealed lamp in {case}");
    }
}

/// A slab over the half x < 0 of the floor, and a sphere over its edge.
#[test]
fn values_lie_between_in_a_penumbra_and_hold_for_every_power() {
    let slab = "Translate(by: (-6, -5.5, 0), of: Box(half: (6, 0.5, 12))),";
    let text = room(slab, "(position: (0, 3, 0.5), power: 900, soft_radius: 3)");
    let values = |gpu: Gpu, power: f64, sharpness: f32| {
        let mut drawn = drawn_on(gpu, &text, &fine(), probes());
        drawn.lights.lamps[0].intensity *= power;
        drawn.probes.occlusion.sharpness = sharpness;
        drawn.draw(48);
        [-6.5, 0.0, 6.5].map(|x| shown_from(&mut drawn, [x, -8.0, 0.5], 0.0, -90.0))
    };
    let found = values(support::gpu(), 1.0, 1.0);
    let [dark, between, bright] = found;
    assert!(dark < 0.12 && bright > 0.88, "{found:?}");
    assert!((0.25..0.75).contains(&between), "{found:?}");
    assert_eq!(found, values(support::gpu(), 1000.0, 1.0));
    let [_, sharp, _] = values(support::gpu(), 1.0, 3.0);
    assert!(
        (sharp - between.powi(3)).abs() < 0.06,
        "{sharp} of {between}"
    );

    // Rays that no wall stops are noticed, and so is a mean that counts what they found for nothing.
    for (file, sound, faulty) in [
        (
            "probes/occlusion_rays.wesl",
            "let is_seen = !is_blocked(point_gs, before, towards.towards_ws, towards.distance);",
            "let is_seen = true;",
        ),
        (
            "probes/occlusion_blend.wesl",
            "weighted[value] += weight * sees;",
            "weighted[value] += weight * faces;",
        ),
    ] {
        let gpu = support::with_faults(&support::gpu(), &[(file, sound, faulty)]);
        let [dark, _, bright] = values(gpu, 1.0, 1.0);
        assert!(dark > 0.5 || bright < 0.8, "{faulty}: {dark} {bright}");
    }
}

/// Mean of min(1, distance / `radius`) over the cosine hemisphere of a floor, `apart` from an endless wall. With the
/// floor's unit disc as the plane of projection, a direction (x, y) with x < 0 meets the wall at a distance of
/// apart / |x|, so that with c = apart / radius
///
/// ½ + (2/π) ∫₀¹ √(1 − x²) min(1, c/x) dx = ½ + (2/π) ((c √(1 − c²) + asin c)/2 + c (artanh √(1 − c²) − √(1 − c²))).
fn openness_beside_a_wall(apart: f64, radius: f64) -> f64 {
    let c = apart / radius;
    if c >= 1.0 {
        return 1.0;
    }
    let root = (1.0 - c * c).sqrt();
    let near = (c * root + c.asin()) / 2.0;
    let beyond = c * (((1.0 + root) / c).ln() - root);
    0.5 + 2.0 / PI * (near + beyond)
}

#[test]
fn open_air_is_1_and_a_corner_follows_its_closed_form() {
    assert!((openness_beside_a_wall(1e-9, 8.0) - 0.5).abs() < 1e-6);
    assert!((openness_beside_a_wall(8.0 - 1e-9, 8.0) - 1.0).abs() < 1e-6);
    // A floor, and a wall at x < 0 that is higher than rays are long.
    let text = "(
        title: \"A corner.\",
        size: (48, 40, 48),
        origin: (-24, -8, -24),
        shape: Union([
            Translate(by: (0, -4, 0), of: Box(half: (24, 4, 24))),
            Translate(by: (-22, 8, 0), of: Box(half: (2, 16, 24))),
        ]),
        materials: {\"plaster\": (a: Flat(0.7, 0.6, 0.5))},
        lamps: [(name: \"none\", lamps: [])],
        cameras: [(name: \"above\", position: (6, 6, 0), look_at: (6, 0, 1), fov_deg: 60)],
    )";
    let layout = lattice(
        UVec3::new(12, 6, 12),
        Vec3::splat(3.0),
        Vec3::new(-3.0, 8.0, 0.0),
    );
    let mut probes = probes();
    probes.occlusion.lamps = 0;
    probes.occlusion.ambient = true;
    probes.occlusion.radius = 8.0;
    probes.occlusion.shown = OcclusionShown::Ambient;
    let mut drawn = drawn(text, &layout, probes);
    drawn.draw(100);
    let [low, high] = range(&drawn.radiance());
    assert!(low > 0.97 && high <= 1.0, "{low}…{high} on an open floor");
    for apart in [1.0, 2.5, 4.5, 6.5] {
        let found = shown_from(&mut drawn, [apart - 20.0, 2.0, 0.5], 0.0, -90.0);
        let expected = openness_beside_a_wall(apart, 8.0);
        assert!(
            (found - expected).abs() < 0.07,
            "{found}, not {expected}, {apart} from the wall"
        );
    }
}

#[test]
fn a_field_that_nothing_uses_changes_no_byte() {
    let pillar = "Translate(by: (4, -4, 2), of: Box(half: (2, 7, 2))),";
    let text = room(pillar, "(position: (-4, 7, -4), power: 2000)");
    let picture = |lamps| {
        let mut probes = probes();
        probes.occlusion.lamps = lamps;
        probes.final_gather = FinalGather::On;
        let mut drawn = drawn(&text, &fine(), probes);
        drawn.shot.view = View::Full;
        drawn.draw(6);
        drawn.radiance()
    };
    assert!(picture(0) == picture(3));
}

#[test]
fn the_field_shadows_direct_light_as_rays_do_from_afar() {
    let pillar = "Translate(by: (4, -4, 2), of: Box(half: (2, 7, 2))),";
    let lamps =
        "(position: (-4, 7, -4), power: 2000, soft_radius: 1), (position: (8, -2, -8), power: 300)";
    for final_gather in [FinalGather::On, FinalGather::Off] {
        let direct = |lamps_kept, shadows| {
            let mut probes = probes();
            probes.occlusion.lamps = lamps_kept;
            probes.final_gather = final_gather;
            let mut drawn = drawn(&room(pillar, lamps), &fine(), probes);
            drawn.shot.view = View::Direct;
            drawn.shot.shadows = shadows;
            drawn.shot.soft_rays = 16;
            drawn.draw(24);
            drawn.radiance()
        };
        let rays = direct(0, Shadows::Rays);
        let all = apart(&direct(2, Shadows::Field), &rays);
        assert!((0.005..0.15).contains(&all), "{final_gather:?}: {all}");
        // Lamps that the field does not keep are shadowed by rays: less differs.
        let first = apart(&direct(1, Shadows::Field), &rays);
        assert!(
            first > 0.0 && first < all,
            "{final_gather:?}: {first} {all}"
        );
        // Where it keeps none, rays say all.
        assert!(direct(0, Shadows::Field) == rays, "{final_gather:?}");
    }
}

#[test]
fn ambient_occlusion_darkens_indirect_light_alone() {
    let pillar = "Translate(by: (4, -4, 2), of: Box(half: (2, 7, 2))),";
    let text = room(pillar, "(position: (-4, 7, -4), power: 2000)");
    let [[direct, indirect], [direct_too, darker]] = [false, true].map(|ambient| {
        let mut probes = probes();
        probes.occlusion.lamps = 0;
        probes.occlusion.ambient = ambient;
        let mut drawn = drawn(&text, &fine(), probes);
        [View::Direct, View::Irradiance].map(|view| {
            drawn.shot.view = view;
            drawn.draw(20);
            drawn.radiance()
        })
    });
    assert!(direct == direct_too);
    let share = mean(&darker) / mean(&indirect);
    assert!((0.5..0.97).contains(&share), "{share}");
    let brighter = |(a, b): (&[f32; 3], &[f32; 3])| a[1] > b[1] * 1.001;
    let pairs = darker.rgb.iter().zip(&indirect.rgb);
    assert_eq!(pairs.filter(|&pair| brighter(pair)).count(), 0);
}

/// Without lamps the view shows that nothing is kept; lamps that come, move, and are dug free are followed.
#[test]
fn the_field_follows_lamps_and_edits() {
    let lamp = "(position: (3, 3, 3), power: 900)";
    let mut drawn = drawn(&room(SHELL, lamp), &fine(), probes());
    let sealed = drawn.lights.lamps[0];
    drawn.lights.lamps.clear();
    drawn.draw(4);
    let nothing = drawn.radiance();
    let first = nothing.rgb[0];
    assert!(nothing.rgb.iter().all(|rgb| *rgb == first) && first[0] != first[1]);

    drawn.lights.lamps.push(sealed);
    drawn.draw(8);
    assert!(range(&drawn.radiance())[1] < 1e-3);
    drawn.lights.lamps[0].position_ws = DVec3::new(-4.0, 7.0, -4.0);
    drawn.draw(30);
    let moved = mean(&drawn.radiance());
    assert!(moved > 0.7, "{moved}");
    drawn.lights.lamps[0].position_ws = sealed.position_ws;
    drawn.draw(30);
    let back = mean(&drawn.radiance());
    assert!(back < 0.08, "{back}");

    // The shell is dug away.
    let mut voxels = (drawn.frame.stage.read_back(&drawn.gpu)).expect("reads back");
    let (low, high) = (IVec3::splat(16), IVec3::splat(21));
    let edit = voxels.edit(low, high, |_, _| 0);
    (drawn.frame.apply(&drawn.gpu, &voxels, &edit)).expect("fits");
    drawn.draw(30);
    let dug = mean(&drawn.radiance());
    assert!(dug > 0.9, "{dug}");
}

#[test]
fn a_field_that_does_not_fit_is_refused_by_name() {
    let mut gpu = support::gpu();
    let world = support::parsed(&room("", "(position: (3, 3, 3), power: 900)"));
    let stage = grotto::frame::Stage::build(&gpu, &world).expect("fits");
    gpu.limits.max_storage_buffer_binding_size = 8 << 20;
    let mut probes = probes();
    probes.occlusion.lamps = 8;
    probes.occlusion.texels = 64;
    let error = grotto::frame::Frame::new(&gpu, stage, &fine(), &probes, SIZE);
    let message = error.err().expect("216 probes of 64 KB").to_string();
    assert!(message.contains("occlusion.texels"), "{message}");
}
