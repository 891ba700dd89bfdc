//! Squares that face each other, or a floor.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, UVec3};
use grotto::reference::FilmOptions;
use grotto::world::{Camera, View};

use super::super::stage::{Cpu, Stage, Tracer, options, square_camera};
use super::{assert_agrees, ratio};

/// The light between two equal squares, face to face: L₁ = a·∫K·L₂ on the lower one, which does not emit, and
/// L₂ = e + a·∫K·L₁ on the upper one, with the kernel of parallel planes K = h²/(π d⁴). Solved bounce by bounce
/// with Nyström's method (Kress 2014, chapter 12) on Gauss-Legendre points. The kernel is smooth: for an edge of
/// four times the distance, 24 points along it leave an error of 1e-9.
struct FacingPlates {
    distance: f64,
    albedo: f64,
    /// Points of either plate, with the area that each represents.
    points: Vec<(DVec2, f64)>,
    /// Radiance of the lower plate at the points.
    lower: Vec<f64>,
    /// Radiance of the upper plate at the points.
    upper: Vec<f64>,
}

impl FacingPlates {
    fn solve(edge: f64, distance: f64, [lower, upper]: [f64; 2], emission: f64) -> Self {
        let line =
            gauss_legendre(24).map(|(x, weight)| ((x + 1.0) * edge / 2.0, weight * edge / 2.0));
        let line: Vec<(f64, f64)> = line.collect();
        let points = line
            .iter()
            .flat_map(|&(x, a)| line.iter().map(move |&(z, b)| (DVec2::new(x, z), a * b)));
        let points: Vec<_> = points.collect();
        let mut plates = Self {
            distance,
            albedo: lower,
            lower: vec![0.0; points.len()],
            upper: vec![emission; points.len()],
            points,
        };
        for _ in 0..200 {
            plates.lower = plates.sent(lower, &plates.upper);
            let back = plates.sent(upper, &plates.lower);
            plates.upper = back.iter().map(|back| emission + back).collect();
        }
        plates
    }

    fn sent(&self, albedo: f64, from: &[f64]) -> Vec<f64> {
        let at = |(point, _): &(DVec2, f64)| albedo * self.received(*point, from);
        self.points.iter().map(at).collect()
    }

    /// ∫K·L at a point of the other plate.
    fn received(&self, point: DVec2, radiance: &[f64]) -> f64 {
        let squared = self.distance * self.distance;
        let part = |((other, area), radiance): (&(DVec2, f64), &f64)| {
            let d2 = squared + point.distance_squared(*other);
            area * radiance * squared / (PI * d2 * d2)
        };
        self.points.iter().zip(radiance).map(part).sum()
    }

    /// Radiance of the lower plate at a point, from its corner.
    fn lower_at(&self, point: DVec2) -> f64 {
        self.albedo * self.received(point, &self.upper)
    }
}

/// Points and weights in −1 … 1 of the rule that is exact for polynomials of degree 2n − 1: the roots of
/// Legendre's polynomial, by Newton's method (Abramowitz & Stegun, 25.4.29).
fn gauss_legendre(n: u32) -> impl Iterator<Item = (f64, f64)> {
    (0..n).map(move |i| {
        let mut x = (PI * (f64::from(i) + 0.75) / (f64::from(n) + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut last, mut value) = (1.0, x);
            for k in 2..=n {
                let k = f64::from(k);
                (last, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * last) / k);
            }
            slope = f64::from(n) * (x * value - last) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// Plates of 16 × 16 at distance 4, the upper one emitting 5, and below it a camera that sees the lower one.
fn close_plates(albedo: f32) -> (Stage, Camera) {
    let size = UVec3::new(24, 6, 24);
    let stage = Stage::new(size, &[(albedo, 0.0), (albedo, 5.0)], |voxel| {
        let plate = (4..20).contains(&voxel.x) && (4..20).contains(&voxel.z);
        match voxel.y {
            0 if plate => 1,
            5 if plate => 2,
            _ => 0,
        }
    });
    let mut camera = square_camera(DVec3::new(12.0, 3.0, 12.0), 0.0, -90.0);
    // 8 to either side at a distance of 2: exactly the plate.
    camera.fov_deg = 2.0 * 4.0f32.atan().to_degrees();
    (stage, camera)
}

const CLOSE_ALBEDO: f32 = 0.8;

fn film(camera: &Camera, samples: u32) -> FilmOptions<'_> {
    FilmOptions {
        size: [8, 8],
        samples,
        view: View::Indirect,
        ..options(camera)
    }
}

/// Light bounces back and forth between two facing plates: point for point, their radiance solves both
/// integral equations.
pub fn plates_that_light_each_other(tracer: &dyn Tracer) {
    let albedo = f64::from(CLOSE_ALBEDO);
    let plates = FacingPlates::solve(16.0, 4.0, [albedo; 2], 5.0);
    let (stage, down) = close_plates(CLOSE_ALBEDO);
    let samples = 1024 / tracer.haste();
    let lower = tracer.rendered(&stage, &film(&down, samples));
    let at = |x: f64, z: f64| DVec2::new(x, z) * 16.0;
    assert_agrees(ratio(&lower, |x, z| plates.lower_at(at(x, z))), 1.0);
    // The upper plate as seen from below: its bounced light is all but its own emission.
    let up = Camera {
        pitch_deg: 90.0,
        ..down
    };
    let upper = tracer.rendered(&stage, &film(&up, samples));
    let back = |x: f64, z: f64| albedo * plates.received(at(x, 1.0 - z), &plates.lower);
    assert_agrees(ratio(&upper, back), 1.0);
}

/// For plates that do not reflect the solver gives the form factor. Light that comes back matters: without it
/// the test above would fail.
#[test]
fn one_bounce_between_plates_is_not_enough() {
    let mean = |plates: &FacingPlates| {
        let each = plates.points.iter().zip(&plates.lower);
        let total: f64 = each.map(|((_, area), radiance)| area * radiance).sum();
        total / plates.points.iter().map(|(_, area)| area).sum::<f64>()
    };
    let unit = FacingPlates::solve(3.0, 3.0, [1.0, 0.0], 1.0);
    assert!((mean(&unit) - 0.199_825).abs() < 1e-6, "{}", mean(&unit));
    let albedo = f64::from(CLOSE_ALBEDO);
    let once = FacingPlates::solve(16.0, 4.0, [albedo, 0.0], 5.0);
    let often = FacingPlates::solve(16.0, 4.0, [albedo; 2], 5.0);
    assert!(
        mean(&often) > 1.2 * mean(&once),
        "{} {}",
        mean(&often),
        mean(&once)
    );

    let (stage, camera) = close_plates(CLOSE_ALBEDO);
    let picture = stage.rendered(&FilmOptions {
        max_bounces: 1,
        ..film(&camera, 256)
    });
    let at = |x: f64, z: f64| DVec2::new(x, z) * 16.0;
    assert_agrees(ratio(&picture, |x, z| once.lower_at(at(x, z))), 1.0);
    let short = ratio(&picture, |x, z| often.lower_at(at(x, z)));
    assert!(!short.agrees_with(1.0, 3.0, 0.01), "{short:?}");
    let whole = Cpu.rendered(&stage, &film(&camera, 256));
    assert!(ratio(&whole, |x, z| often.lower_at(at(x, z))).agrees_with(1.0, 3.0, 0.01));
}

/// Two facing unit squares at distance 1 see 0.1998 of each other (Howell's catalogue, C-11).
pub fn two_facing_plates(tracer: &dyn Tracer) {
    let n = 16;
    let size = UVec3::new(n + 8, n + 2, n + 8);
    let stage = Stage::new(size, &[(0.8, 0.0), (0.0, 5.0)], |voxel| {
        let plate = (4..n as i32 + 4).contains(&voxel.x) && (4..n as i32 + 4).contains(&voxel.z);
        match voxel.y {
            0 if plate => 1,
            y if plate && y == n as i32 + 1 => 2,
            _ => 0,
        }
    });
    // From halfway the camera sees exactly the lower plate.
    let half = f64::from(n) / 2.0;
    let camera = square_camera(DVec3::new(4.0 + half, 1.0 + half, 4.0 + half), 0.0, -90.0);
    assert_agrees(
        tracer.mean(&stage, &camera, View::Full, 32, 64),
        0.8 * 5.0 * 0.199_825,
    );
    assert_eq!(tracer.mean(&stage, &camera, View::Direct, 32, 2).mean, 0.0);
}

/// A square plate that emits L, 2a wide, at height h over a floor: from a floor point the plate is four
/// rectangles that meet above it, each with the form factor of a parallel rectangle over its corner,
/// 1/2π · (X/√(1+X²) atan(Y/√(1+X²)) + Y/√(1+Y²) atan(X/√(1+Y²))), X and Y being its edges over h
/// (Howell's catalogue, B-3). The reflected radiance is albedo · L · F.
pub fn an_emissive_plate_over_a_floor(tracer: &dyn Tracer) {
    let (half, height, radiance) = (4.0f64, 5.0f64, 3.0f64);
    let size = UVec3::new(32, 8, 32);
    let stage = Stage::new(size, &[(0.6, 0.0), (0.0, 3.0)], |voxel| match voxel.y {
        0 => 1,
        6 if (12..20).contains(&voxel.x) && (12..20).contains(&voxel.z) => 2,
        _ => 0,
    });
    let corner = |x: f64, y: f64| {
        let (a, b) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        (x / a * (y / a).atan() + y / b * (x / b).atan()) / (2.0 * PI)
    };
    let truth_at = |x: f64, z: f64| {
        let edges = |at: f64| [(half - at) / height, (half + at) / height];
        let sum = |x: f64| edges(z).map(|z| corner(x, z)).iter().sum::<f64>();
        let factor: f64 = edges(x).map(sum).iter().sum();
        f64::from(0.6f32) * radiance * factor
    };
    // From below the plate, where its sides are not seen: a square of 6 by 6 around its middle.
    let camera = square_camera(DVec3::new(16.0, 4.0, 16.0), 0.0, -90.0);
    let mut options = options(&camera);
    options.size = [8, 8];
    options.samples = 512 / tracer.haste();
    let picture = tracer.rendered(&stage, &options);
    assert_agrees(
        ratio(&picture, |x, z| truth_at(x * 6.0 - 3.0, z * 6.0 - 3.0)),
        1.0,
    );
}
