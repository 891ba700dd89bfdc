//! The two marchers against each other, and against geometry.

use glam::{DVec3, IVec3, UVec3};
use grotto::reference::march::{FACE_NORMALS, Hit, Outcome, Ray, march, march_plain};
use grotto::world::voxels::Voxels;
use proptest::prelude::*;

use crate::support::scenes::voxels_from;

fn empty_but(size: UVec3, solid: IVec3) -> Voxels {
    voxels_from(size, |voxel| u8::from(voxel == solid))
}

fn hit(outcome: Outcome) -> Hit {
    match outcome {
        Outcome::Hit(hit) => hit,
        other => panic!("expected a hit, got {other:?}"),
    }
}

#[test]
fn every_face_is_named_by_its_outward_normal() {
    let solid = IVec3::new(9, 10, 11);
    let voxels = empty_but(UVec3::new(20, 21, 22), solid);
    let centre = solid.as_dvec3() + 0.5;
    for (face, normal) in FACE_NORMALS.iter().enumerate() {
        // From inside the grid, and from outside.
        for away in [3.5, 40.5] {
            let ray = Ray::new(centre + away * normal.as_dvec3(), -normal.as_dvec3());
            let expected = Hit {
                voxel: solid,
                material: 1,
                face: face as u8,
                distance: away - 0.5,
            };
            assert_eq!(hit(march(&voxels, &ray)), expected);
            assert_eq!(hit(march_plain(&voxels, &ray)), expected);
            let position = expected.position(&ray);
            assert!(position.distance(centre + 0.5 * normal.as_dvec3()) < 1e-12);
        }
    }
}

#[test]
fn distances_count_in_multiples_of_the_direction() {
    let voxels = empty_but(UVec3::splat(16), IVec3::new(12, 2, 2));
    let ray = Ray::new(DVec3::new(2.0, 2.5, 2.5), DVec3::X * 4.0);
    assert_eq!(hit(march(&voxels, &ray)).distance, 2.5);
}

#[test]
fn a_ray_that_starts_in_a_solid_voxel_says_so() {
    let voxels = empty_but(UVec3::splat(9), IVec3::splat(8));
    let ray = Ray::new(DVec3::splat(8.5), DVec3::X);
    assert_eq!(march(&voxels, &ray), Outcome::Inside(1));
    assert_eq!(march_plain(&voxels, &ray), Outcome::Inside(1));
}

#[test]
fn a_ray_stops_at_its_maximum_distance() {
    let voxels = empty_but(UVec3::splat(16), IVec3::new(12, 2, 2));
    let mut ray = Ray::new(DVec3::new(2.5, 2.5, 2.5), DVec3::X);
    for (max_distance, reaches) in [(9.5, false), (9.5001, true)] {
        ray.max_distance = max_distance;
        assert_eq!(matches!(march(&voxels, &ray), Outcome::Hit(_)), reaches);
        assert_eq!(march(&voxels, &ray), march_plain(&voxels, &ray));
    }
}

#[test]
fn a_tie_steps_x_then_y_then_z() {
    // A ray through an edge meets the voxel that the x step enters, not the diagonal one.
    let origin = DVec3::splat(0.5);
    for (direction, beside) in [
        (DVec3::new(1.0, 1.0, 0.0), IVec3::new(1, 0, 0)),
        (DVec3::new(0.0, 1.0, 1.0), IVec3::new(0, 1, 0)),
        (DVec3::new(1.0, 0.0, 1.0), IVec3::new(1, 0, 0)),
        (DVec3::new(1.0, 1.0, 1.0), IVec3::new(1, 0, 0)),
    ] {
        let voxels = empty_but(UVec3::splat(4), beside);
        assert_eq!(
            hit(march_plain(&voxels, &Ray::new(origin, direction))).voxel,
            beside
        );
        let voxels = empty_but(UVec3::splat(4), direction.as_ivec3() - beside);
        let passes = march_plain(&voxels, &Ray::new(origin, direction));
        assert_eq!(passes, Outcome::Miss, "{direction}");
    }
}

#[test]
fn odd_rays_end() {
    let voxels = empty_but(UVec3::splat(16), IVec3::splat(5));
    for ray in [
        Ray::new(DVec3::splat(3.5), DVec3::ZERO),
        Ray::new(DVec3::splat(1e300), DVec3::NEG_ONE),
        Ray::new(DVec3::new(-1e6, 5.5, 5.5), DVec3::NEG_X),
        Ray::new(DVec3::new(3.5, 3.5, -4.0), DVec3::new(1.0, 0.0, 1e-300)),
        Ray::new(DVec3::NAN, DVec3::X),
    ] {
        assert_eq!(march(&voxels, &ray), Outcome::Miss, "{ray:?}");
    }
    let far = Ray::new(DVec3::new(-1e6, 5.5, 5.5), DVec3::X);
    assert_eq!(hit(march(&voxels, &far)).distance, 1e6 + 5.0);
}

/// Coordinates with many exact ties (multiples of a half) or with hardly any.
fn coordinate(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        low..high,
        (low as i32 * 2..high as i32 * 2).prop_map(|twice| f64::from(twice) / 2.0)
    ]
}

fn vector(low: f64, high: f64) -> impl Strategy<Value = DVec3> {
    (
        coordinate(low, high),
        coordinate(low, high),
        coordinate(low, high),
    )
        .prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// A grid with solid lumps in air: whole cells empty, whole cells solid, and mixed ones.
fn lumps(size: UVec3, seed: u64, density: u64) -> Voxels {
    let hash = |p: IVec3, salt: u64| {
        let mut h = seed ^ salt;
        for c in p.to_array() {
            h = (h ^ c as u64)
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(29);
        }
        h.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 32
    };
    voxels_from(size, |voxel| match hash(voxel / 8, 1) % 8 {
        0 => 2,
        1..4 => u8::from(hash(voxel, 2) % 1000 < density),
        _ => 0,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Hit for hit, bit for bit, from inside, from outside, and along exact diagonals.
    #[test]
    fn skipping_cells_changes_nothing(
        size in (1u32..70, 1u32..70, 1u32..70),
        seed: u64,
        density in prop_oneof![Just(0u64), 1..30u64, 100..900u64],
        rays in prop::collection::vec((vector(-20.0, 90.0), vector(-2.0, 2.0)), 40),
    ) {
        let voxels = lumps(size.into(), seed, density);
        for (origin, direction) in rays {
            let mut ray = Ray::new(origin, direction);
            let outcome = march_plain(&voxels, &ray);
            prop_assert_eq!(march(&voxels, &ray), outcome, "{:?}", ray);
            if let Outcome::Hit(hit) = outcome {
                prop_assert_eq!(voxels.material(hit.voxel), hit.material);
                let before = hit.voxel + FACE_NORMALS[usize::from(hit.face)];
                prop_assert_eq!(voxels.material(before), 0);
                // A second ray that leaves the face, from the cell beyond it.
                ray = Ray {
                    origin: hit.position(&ray),
                    direction: DVec3::new(direction.y, -direction.x, direction.z),
                    start: before,
                    max_distance: 30.0,
                };
                prop_assert_eq!(march(&voxels, &ray), march_plain(&voxels, &ray), "{:?}", ray);
            }
        }
    }

    /// The marcher against geometry alone: the hit is the nearest of all boxes (slab test).
    #[test]
    fn a_hit_is_the_nearest_solid_voxel(
        seed: u64,
        origin in vector(-5.0, 20.0),
        direction in (-1.0..1.0, -1.0..1.0, -1.0..1.0),
    ) {
        let size = UVec3::new(13, 9, 16);
        let voxels = lumps(size, seed, 200);
        let direction = DVec3::from(direction);
        prop_assume!(direction.abs().min_element() > 1e-3);
        let crossed = |voxel: IVec3| {
            let a = (voxel.as_dvec3() - origin) / direction;
            let b = ((voxel + 1).as_dvec3() - origin) / direction;
            (a.min(b).max_element(), a.max(b).min_element())
        };
        let mut nearest = f64::INFINITY;
        for index in 0..(size.x * size.y * size.z) as i32 {
            let voxel = IVec3::new(index % 13, index / 13 % 9, index / 117);
            let (enter, leave) = crossed(voxel);
            if voxels.material(voxel) != 0 && leave > 1e-9 && enter < leave - 1e-9 {
                nearest = nearest.min(enter);
            }
        }
        match march_plain(&voxels, &Ray::new(origin, direction)) {
            Outcome::Hit(hit) => {
                let (enter, leave) = crossed(hit.voxel);
                prop_assert!((hit.distance - enter.max(0.0)).abs() < 1e-9);
                // A voxel that the ray only touches may be met before the nearest one entered.
                prop_assert!(enter <= leave + 1e-9 && hit.distance <= nearest + 1e-9);
            }
            Outcome::Inside(material) => {
                prop_assert_eq!(voxels.material(origin.floor().as_ivec3()), material);
            }
            Outcome::Miss => prop_assert!(nearest.is_infinite()),
        }
    }
}
