//! Bodies of glowing voxels over a floor. The bodies are black, so they have the same radiance from every side,
//! and the light at a point depends on their outline alone.

use std::f64::consts::PI;

use glam::{DVec3, IVec3, UVec3};
use grotto::world::View;

use super::super::stage::{Stage, Tracer, options, square_camera};
use super::{assert_agrees, ratio};

/// The form factor from a point with a normal to a polygon above its horizon: Σ γ (Γ·n) / 2π over the edges,
/// γ being the angle that an edge fills and Γ the normal of the plane through it and the point (Lambert
/// 1760; Arvo 1995, section 2.3).
fn form_factor(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let towards: Vec<DVec3> = corners.iter().map(|c| (*c - point).normalize()).collect();
    let edges = towards.iter().zip(towards.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| a.angle_between(*b) * a.cross(*b).normalize().dot(normal))
        .sum();
    sum.abs() / (2.0 * PI)
}

/// The form factor from a point of a floor to a box above it: the sum over the faces that the point sees, which
/// do not hide each other.
fn form_factor_of_box(point: DVec3, low: DVec3, high: DVec3) -> f64 {
    let mut sum = 0.0;
    for axis in 0..3 {
        for plane in [low[axis], high[axis]] {
            let outside = match plane == low[axis] {
                true => point[axis] < plane,
                false => point[axis] > plane,
            };
            if !outside {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |at_u: f64, at_v: f64| {
                let mut corner = DVec3::ZERO;
                (corner[axis], corner[u], corner[v]) = (plane, at_u, at_v);
                corner
            };
            let corners = [
                corner(low[u], low[v]),
                corner(high[u], low[v]),
                corner(high[u], high[v]),
                corner(low[u], high[v]),
            ];
            sum += form_factor(point, DVec3::Y, &corners);
        }
    }
    sum
}

/// A glowing box of 5 × 3 × 4 voxels, of which the floor sees three faces, lights the floor as the polygons of
/// those faces do. This is exact, because a box of voxels is a box.
pub fn a_glowing_box_over_a_floor(tracer: &dyn Tracer) {
    let (low, high) = (IVec3::new(14, 6, 13), IVec3::new(19, 9, 17));
    let size = UVec3::new(32, 12, 32);
    let stage = Stage::new(size, &[(0.6, 0.0), (0.0, 3.0)], |voxel| match voxel {
        IVec3 { y: 0, .. } => 1,
        _ if voxel.cmpge(low).all() && voxel.cmplt(high).all() => 2,
        _ => 0,
    });
    // Beside an edge of the box, below its foot: a square of 3 by 3.
    let camera = square_camera(DVec3::new(21.0, 2.5, 18.5), 0.0, -90.0);
    let mut options = options(&camera);
    options.size = [8, 8];
    options.samples = 4096 / tracer.haste();
    let picture = tracer.rendered(&stage, &options);
    let truth = |x: f64, z: f64| {
        let point = DVec3::new(19.5 + 3.0 * x, 1.0, 17.0 + 3.0 * z);
        f64::from(0.6f32) * 3.0 * form_factor_of_box(point, low.as_dvec3(), high.as_dvec3())
    };
    assert_agrees(ratio(&picture, truth), 1.0);
}

/// Lambert's formula agrees with that of a rectangle over its corner (Howell's catalogue, B-3), faces that
/// look away do not count, and a box that is all of the sky is all of the light.
#[test]
fn form_factors_of_boxes() {
    let corner = |x: f64, y: f64| {
        let (a, b) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        (x / a * (y / a).atan() + y / b * (x / b).atan()) / (2.0 * PI)
    };
    let (low, high) = (DVec3::new(0.0, 2.0, 0.0), DVec3::new(3.0, 2.5, 1.0));
    // From below a corner only the bottom of the box is visible.
    let found = form_factor_of_box(DVec3::ZERO, low, high);
    assert!((found - corner(1.5, 0.5)).abs() < 1e-12, "{found}");
    let beside = form_factor_of_box(DVec3::new(4.0, 0.0, 0.5), low, high);
    let bottom = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)];
    let bottom = bottom.map(|(x, z)| DVec3::new(x, 2.0, z));
    let alone = form_factor(DVec3::new(4.0, 0.0, 0.5), DVec3::Y, &bottom);
    assert!(
        beside > 1.02 * alone,
        "the side counts too: {beside} {alone}"
    );
    let far = DVec3::new(1e6, 0.0, 1e6);
    let sky = form_factor_of_box(DVec3::ZERO, DVec3::Y - far, 2.0 * DVec3::Y + far);
    assert!((sky - 1.0).abs() < 1e-5, "{sky}");
}

/// A sphere of radius R at distance d over a floor has the form factor (R/d)²·cos θ (Howell's catalogue,
/// B-45 without its horizon). No body of voxels is a sphere, but a body within the sphere lights less
/// and a body around it lights more. The two bounds hold exactly and lie near each other.
pub fn a_ball_of_voxels_is_a_sphere_from_afar(tracer: &dyn Tracer) {
    let radius = 32.0f64;
    let centre = DVec3::new(48.0, 65.0, 48.0);
    // The visible point of the floor, off the axis.
    let point = DVec3::new(62.0, 1.0, 40.0);
    let offset = centre - point;
    let distance = offset.length();
    let factor = (radius / distance).powi(2) * offset.y / distance;
    let truth = f64::from(0.5f32) * 2.0 * factor;

    let mut camera = square_camera(point + 3.0 * DVec3::Y, 0.0, -90.0);
    camera.fov_deg = 0.1;
    let bound = |corner: f64| {
        let stage = Stage::new(
            UVec3::new(96, 100, 96),
            &[(0.5, 0.0), (0.0, 2.0)],
            |voxel| {
                // The centre of a voxel, moved half an edge away from the middle or towards it.
                let from_middle = (voxel.as_dvec3() + 0.5 - centre).abs();
                let reach = (from_middle + corner).max(DVec3::ZERO);
                match voxel.y {
                    0 => 1,
                    _ if reach.length() <= radius => 2,
                    _ => 0,
                }
            },
        );
        tracer.mean(&stage, &camera, View::Full, 16, 1024)
    };
    let (within, around) = (bound(0.5), bound(-0.5));
    assert!(
        within.standard_error < 0.01 * truth,
        "{within:?}, truth {truth}"
    );
    assert!(
        around.standard_error < 0.01 * truth,
        "{around:?}, truth {truth}"
    );
    assert!(
        within.mean < truth + 3.0 * within.standard_error,
        "{within:?}, truth {truth}"
    );
    assert!(
        around.mean > truth - 3.0 * around.standard_error,
        "{around:?}, truth {truth}"
    );
    // Bounds that lie far apart would prove nothing.
    assert!(
        around.mean - within.mean < 0.12 * truth,
        "{within:?}, {around:?}, truth {truth}"
    );
}
