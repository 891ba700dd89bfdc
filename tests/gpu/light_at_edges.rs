//! Light beside an edge where two surfaces meet, against a closed form: a floor under an even sky, beside a black wall.

use glam::DVec2;
use grotto::{gpu::Gpu, parameters::ProbeParameters, world::View};

use crate::support::{self, frames::Drawn};

/// All black, so that nothing but the sky lights the floor (y = 0). The wall is 1 high, and far longer.
const WALL: &str = "(
    title: \"A low wall.\", size: (24, 8, 32), origin: (-12, -4, -16),
    shape: Union([
        Plane(normal: (0, 1, 0), offset: 0),
        Translate(by: (-6, 0, 0), of: Box(half: (6, 1, 16))),
    ]),
    materials: {\"soot\": (a: Flat(0, 0, 0))},
    sky: (zenith: (1, 1, 1)),
    cameras: [(name: \"above\", position: (0.5, 2, 0.3), look_at: (0.5, 0, 0), fov_deg: 60)],
    layouts: [(name: \"coarse\", counts: (4, 2, 4), spacing: 6, centre: (0.5, 3.5, 0.5))],
)";

const SIZE: [u32; 2] = [48, 48];

/// Irradiance over π at this distance from the wall: one less the wall's form factor (a strip that is perpendicular to the
/// floor).
fn expected(distance: f64) -> f64 {
    1.0 - 0.5 * (1.0 - distance / distance.hypot(1.0))
}

/// Mean relative error of the floor in the quarter of a voxel beside the wall, where a face knows but one quadrant.
fn error_at_the_edge(gpu: Gpu) -> f64 {
    let world = support::parsed(WALL);
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters {
        rays: 32,
        warmup_frames: 8,
        ..Default::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.view = View::Irradiance;
    drawn.draw(200);
    let picture = drawn.radiance();
    let basis = drawn.shot.camera.basis(1.0);
    let size = DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
    let errors = picture.rgb.iter().enumerate().filter_map(|(index, rgb)| {
        let [x, y] = [index as u32 % SIZE[0], index as u32 / SIZE[0]].map(f64::from);
        let direction = basis.direction_ws(DVec2::new(x + 0.5, y + 0.5), size);
        let point = basis.origin - direction * (basis.origin.y / direction.y);
        let is_beside = (0.0..0.25).contains(&point.x);
        is_beside.then(|| (f64::from(rgb[1]) / expected(point.x) - 1.0).abs())
    });
    let errors: Vec<f64> = errors.collect();
    assert!(errors.len() > 100, "{} pixels", errors.len());
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn light_goes_on_beside_a_wall() {
    let gpu = support::gpu();
    let right = error_at_the_edge(gpu.clone());
    // Planted: the light of the nearest quadrant, as far as the wall.
    let faults = [(
        "surface_cache/query.wesl",
        "const MOST_CONTINUED: f32 = 0.5;",
        "const MOST_CONTINUED: f32 = 0.0;",
    )];
    let wrong = error_at_the_edge(support::with_faults(&gpu, &faults));
    assert!(right < 0.04 && wrong > 0.07, "{right} {wrong}");
}
