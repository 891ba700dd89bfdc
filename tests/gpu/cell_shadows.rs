//! Which lamps stone hides from whole cells of the world: a ray to every lamp in place of that changes no pixel.

use glam::{DVec3, IVec3};
use grotto::{
    gpu::Gpu,
    lights::{LampShape, LampState},
    measure::picture::Picture,
    parameters::ProbeParameters,
    world::View,
};

use crate::support::{self, Fault, frames::Drawn};

/// Two halls with a wall of ten voxels between them, a passage near the ceiling, and a skylight over the hall that is seen.
const HALLS: &str = "(
    title: \"halls\", size: (72, 32, 32), origin: (-36, 0, -16),
    shape: Subtraction([
        Box(half: (36, 40, 20)),
        Union([
            Translate(by: (-18, 15, 0), of: Box(half: (13, 11, 12))),
            Translate(by: (18, 15, 0), of: Box(half: (13, 11, 12))),
            Translate(by: (0, 24, 0), of: Box(half: (10, 2, 3))),
            Translate(by: (-18, 28, 0), of: Box(half: (3, 6, 3))),
        ]),
    ]),
    materials: {\"stone\": (a: Flat(0.6, 0.6, 0.6))}, rules: [(material: \"stone\")],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"hall\", position: (-30, 12, 10), look_at: (-10, 14, -4), fov_deg: 95)],
    layouts: [(name: \"coarse\", counts: (6, 3, 3), spacing: 10, centre: (0, 14, 0))],
)";

const SIZE: [u32; 2] = [96, 72];
const KNOWN: &str = "light/listed_lamps.wesl";
const PASS: &str = "surface_cache/cell_shadows.wesl";

/// What lamps are.
#[derive(Clone, Copy)]
enum Kind {
    Points,
    /// A sun above the skylight, spheres, and points.
    All,
}

/// Lamps all over both halls, too many to be few; at each step a third of them change halls, and one nears the passage.
fn lamps(count: usize, kind: Kind, step: usize) -> Vec<LampState> {
    let along = |number: usize, step: f64| (0.5 + number as f64 * step).fract();
    let lamp = |number: usize| {
        let moves = usize::from(number.is_multiple_of(3));
        let moved = number + 40 * step * moves;
        let side = [18.0, -18.0][(number + step * moves) % 2];
        let inside = DVec3::new(
            side + 20.0 * along(moved, 0.8191725134) - 10.0,
            6.0 + 18.0 * along(moved, 0.6710436067),
            18.0 * along(moved, 0.5497004779) - 9.0,
        );
        let by_passage = DVec3::new(16.0 - 2.5 * step as f64, 23.5, -1.5);
        LampState {
            shape: LampShape::Point,
            position_ws: if number == 3 { by_passage } else { inside },
            direction_ws: DVec3::ZERO,
            intensity: DVec3::splat(6.0 + number as f64),
            radius: 0.5,
            soft_radius: match kind {
                Kind::All if number.is_multiple_of(2) => 1.5,
                _ => 0.0,
            },
            rhythm: None,
        }
    };
    let mut all: Vec<_> = (0..count).map(lamp).collect();
    if let Kind::All = kind {
        let sinks = 0.1 * step as f64;
        all[0] = LampState {
            shape: LampShape::Directional,
            direction_ws: DVec3::new(0.3 + sinks, -1.0, 0.2).normalize(),
            intensity: DVec3::splat(2.0),
            ..all[0]
        };
    }
    all
}

/// Direct light while lamps move, then at rest, and after a shaft was dug through the wall and closed again.
fn pictures(gpu: Gpu, count: usize, kind: Kind) -> Vec<Picture> {
    let world = support::parsed(HALLS);
    let layout = world.layouts[0].clone();
    // Probes and rays of faces have no part in direct light, and every face that is seen has a place in the surface cache.
    let probes = ProbeParameters {
        rays: 8,
        face_share: 0.05,
        face_pixels: 0.5,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.view = View::Direct;
    let mut all = Vec::new();
    for step in 0..4 {
        drawn.lights.lamps = lamps(count, kind, step);
        drawn.draw(if step == 0 { 9 } else { 2 });
        all.push(drawn.radiance());
    }
    drawn.draw(12);
    all.push(drawn.radiance());
    let mut voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
    let (low, high) = (IVec3::new(28, 8, 12), IVec3::new(45, 16, 22));
    for material in [0, 1] {
        let edit = voxels.edit(low, high, |_, _| material);
        let applied = drawn.frame.apply(&drawn.gpu, &voxels, &edit);
        applied.expect("fits");
        drawn.draw(1);
        all.push(drawn.radiance());
    }
    all
}

/// Shares of pixels that differ, picture by picture.
fn shares(a: &[Picture], b: &[Picture]) -> Vec<f64> {
    let differing = |(a, b): (&Picture, &Picture)| {
        let differs = |(a, b): &(&[f32; 3], &[f32; 3])| {
            (a[0] - b[0]).abs() > 2e-3 * a[0].abs().max(b[0].abs()).max(0.05)
        };
        a.rgb.iter().zip(&b.rgb).filter(differs).count() as f64 / a.rgb.len() as f64
    };
    a.iter().zip(b).map(differing).collect()
}

#[test]
fn what_stone_hides_from_cells_changes_no_pixel() {
    let gpu = support::gpu();
    let nothing: Fault = (
        KNOWN,
        "return lights.lists[lights.first_shadow + 2u * cell_of_sight(voxel)];",
        "return NO_SLOTS;",
    );
    // With lists of lamps, and without.
    for (count, kind) in [(70, Kind::Points), (24, Kind::Points), (24, Kind::All)] {
        let found = pictures(gpu.clone(), count, kind);
        let with = |faults: &[Fault]| {
            let changed = pictures(support::with_faults(&gpu, faults), count, kind);
            shares(&found, &changed)
        };
        let most = |shares: Vec<f64>| shares.into_iter().fold(0.0, f64::max);
        assert_eq!(
            with(&[nothing]),
            [0.0; 7],
            "{count} lamps: pixels that differ from those that know nothing of cells"
        );
        let through_stone = most(with(&[
            (
                "surface_cache/lamps.wesl",
                "fields_with(slots_in(of_group, SURELY_HIDDEN), HIDDEN)",
                "fields_with(slots_in(of_group, SURELY_HIDDEN), VISIBLE)",
            ),
            (
                "view/primary_lighting.wesl",
                "return left & ~shadowed_slots(surface.voxel);",
                "return left;",
            ),
        ]));
        assert!(through_stone > 0.2, "lamps are found: {through_stone}");
        let stale = "if examined < listed.y || is_old {";
        let old = with(&[(PASS, stale, "if examined == 0u {")]);
        assert!(most(old[1..4].to_vec()) > 0.0, "lamps that move: {old:?}");
        assert!(old[5] > 0.0, "a wall that is opened: {old:?}");
        let part = most(with(&[(
            "surface_cache/hull.wesl",
            "solid &= solid_layers(slab, vec3i(x, y, z) << vec3u(2u), hull.axis);",
            "solid &= 15u;",
        )]));
        assert!(part > 0.0, "layers that are not solid are noticed");
    }
}
