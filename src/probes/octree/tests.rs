use std::collections::HashMap;

use proptest::prelude::*;

use super::*;
use crate::probes::{Layout as _, Volume};
use crate::world::scenery::Split;

const SIZE: u32 = 32;

fn layout(depth: u32, split: Split, divide_at: f32) -> LayoutSpec {
    LayoutSpec {
        name: "test".into(),
        counts: UVec3::new(3, 2, 2),
        spacing: Vec3::splat(16.0),
        centre: Vec3::new(1.0, -2.0, 3.0),
        follow: false,
        cascades: 1,
        octree: Some(OctreeSpec {
            depth,
            split,
            divide_at,
            ..OctreeSpec::default()
        }),
    }
}

const ORIGIN: IVec3 = IVec3::splat(-16);

fn volume(layout: &LayoutSpec, voxels: &Voxels) -> Volume {
    Volume::octree_of(layout, voxels, ORIGIN).expect("a good layout")
}

/// Solid balls: (centre, radius).
fn world(balls: &[([f32; 3], f32)]) -> Voxels {
    let mut voxels = Voxels::empty(UVec3::splat(SIZE));
    for (centre, radius) in balls {
        voxels.fill_sphere((*centre).into(), *radius, 1);
    }
    voxels
}

/// Weights by the places of probes.
fn weights(volume: &Volume, point: Vec3) -> HashMap<IVec3, f32> {
    let mut weights = HashMap::new();
    for (slot, weight) in volume.cage(point) {
        *weights
            .entry(volume.position(slot).floor().as_ivec3())
            .or_default() += weight;
    }
    weights
}

/// The same without a fade: the finest cell gives all light.
fn unfaded(volume: &Volume, point: Vec3) -> HashMap<IVec3, f32> {
    let octree = volume.octree().expect("an octree");
    let (_, cage) = (0..9)
        .find_map(|level| octree.cage(level, point))
        .expect("a cell");
    let mut weights = HashMap::new();
    for (slot, weight) in cage {
        *weights
            .entry(volume.position(slot).floor().as_ivec3())
            .or_default() += weight;
    }
    weights
}

/// The largest change of any weight between steps of a hundredth of a voxel along a line.
fn largest_jump(weights: impl Fn(Vec3) -> HashMap<IVec3, f32>, from: Vec3, to: Vec3) -> f32 {
    let steps = (from.distance(to) * 100.0) as u32;
    let mut before = weights(from);
    let mut jump = 0f32;
    for step in 1..=steps {
        let now = weights(from.lerp(to, step as f32 / steps as f32));
        for probe in now.keys().chain(before.keys()) {
            let of = |all: &HashMap<IVec3, f32>| all.get(probe).copied().unwrap_or(0.0);
            jump = jump.max((of(&now) - of(&before)).abs());
        }
        before = now;
    }
    jump
}

/// Weights change by at most 1 over half of a finest cell of 2 voxels along each axis, so by less than this in a step.
const STEP: f32 = 0.06;

fn balls() -> impl Strategy<Value = Vec<([f32; 3], f32)>> {
    let place = prop::array::uniform3(0.0f32..SIZE as f32);
    prop::collection::vec((place, 0.5f32..9.0), 1..6)
}

fn splits() -> impl Strategy<Value = (Split, f32)> {
    prop_oneof![
        (0.0f32..2.0).prop_map(|at| (Split::Surface, at)),
        (0.1f32..0.9).prop_map(|at| (Split::Hits, at)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn weights_are_shares_that_change_without_steps(
        balls in balls(),
        depth in 1u32..4,
        (split, at) in splits(),
        ends in prop::array::uniform6(-20.0f32..20.0),
    ) {
        let volume = volume(&layout(depth, split, at), &world(&balls));
        let [a, b, c, d, e, f] = ends;
        let (from, to) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        for step in 0..20 {
            let all = volume.cage(from.lerp(to, step as f32 / 20.0));
            for (slot, weight) in &all {
                prop_assert!((0.0..=1.0).contains(weight) && *slot < volume.slots());
            }
            let sum: f32 = all.iter().map(|(_, weight)| weight).sum();
            prop_assert!((sum - 1.0).abs() < 1e-4, "{}", sum);
        }
        let jump = largest_jump(|point| weights(&volume, point), from, to);
        prop_assert!(jump < STEP, "{}", jump);
    }

    #[test]
    fn cells_that_touch_differ_by_one_level(balls in balls(), depth in 1u32..4, (split, at) in splits()) {
        let voxels = world(&balls);
        let volume = volume(&layout(depth, split, at), &voxels);
        let octree = volume.octree().expect("an octree");
        let counts = (octree.roots << depth).as_ivec3();
        let level_at = |cell: IVec3| {
            (0..=depth).find(|level| octree.cell_at(*level, cell.as_uvec3() >> *level).is_some())
        };
        for z in 0..counts.z {
            for y in 0..counts.y {
                for x in 0..counts.x {
                    let cell = IVec3::new(x, y, z);
                    for step in [IVec3::X, IVec3::Y, IVec3::Z, IVec3::ONE, IVec3::new(1, -1, 1)] {
                        let beside = (cell + step).clamp(IVec3::ZERO, counts - 1);
                        let (own, other) = (level_at(cell).expect("a leaf"), level_at(beside).expect("a leaf"));
                        prop_assert!(own.abs_diff(other) <= 1, "{} {}: {} {}", cell, beside, own, other);
                    }
                }
            }
        }
    }

    #[test]
    fn a_tree_that_follows_edits_is_the_tree_of_the_edited_world(
        balls in balls(),
        (split, at) in splits(),
        edit in prop::array::uniform3(2.0f32..30.0),
        material in 0u8..2,
    ) {
        let mut voxels = world(&balls);
        let layout = layout(3, split, at);
        let mut tree = Octree::new(&layout, &voxels, ORIGIN).expect("a good layout");
        let before = tree.clone();
        let edited = voxels.fill_sphere(edit.into(), 2.5, material);
        let (first, last) = edited.region.expect("inside");
        let changed = tree.regrow(&voxels, first.as_ivec3(), last.as_ivec3());
        let wanted = Octree::new(&layout, &voxels, ORIGIN).expect("a good layout");
        let homes = |tree: &Octree| {
            let mut homes: Vec<_> = tree.by_home.keys().map(|home| home.to_array()).collect();
            homes.sort_unstable();
            homes
        };
        if changed {
            prop_assert_eq!(homes(&tree), homes(&wanted));
        } else {
            prop_assert_eq!(homes(&tree), homes(&before));
        }
        // Probes that stay keep their slots; those and only those are not new.
        for (home, slot) in &tree.by_home {
            let is_kept = before.by_home.get(home) == Some(slot);
            prop_assert_eq!(!tree.slots[*slot as usize].fresh, is_kept);
            prop_assert_eq!(before.by_home.contains_key(home), is_kept);
        }
        tree.settle_down();
        prop_assert_eq!(tree.fresh(), 0);
    }
}

#[test]
fn a_box_of_voxels_is_solid_where_its_voxels_are() {
    let mut voxels = world(&[([10.0, 8.0, 20.0], 7.3)]);
    voxels.fill_box(IVec3::splat(16), IVec3::splat(31), 2);
    for (low, high) in [
        (IVec3::splat(-3), IVec3::splat(SIZE as i32 + 2)),
        (IVec3::new(5, 6, 7), IVec3::new(21, 9, 30)),
        (IVec3::new(30, 2, -9), IVec3::new(40, 3, -2)),
    ] {
        let one_by_one = geometry::places(low, high).map(|voxel| voxels.material(voxel) != 0);
        let wanted: Vec<bool> = one_by_one.collect();
        assert_eq!(geometry::solid_in(&voxels, low, high), wanted);
    }
}

#[test]
fn without_the_fade_there_are_steps() {
    let volume = volume(&layout(3, Split::Surface, 0.0), &world(&[([8.0; 3], 3.0)]));
    let (from, to) = (Vec3::new(-14.0, -7.3, -6.1), Vec3::new(14.0, 5.0, 6.0));
    assert!(largest_jump(|point| weights(&volume, point), from, to) < STEP);
    assert!(largest_jump(|point| unfaded(&volume, point), from, to) > 3.0 * STEP);
}

#[test]
fn air_and_stone_need_only_the_roots() {
    for material in [0, 1] {
        let mut voxels = Voxels::empty(UVec3::splat(SIZE));
        voxels.fill_box(IVec3::ZERO, IVec3::splat(31), material);
        // A lattice inside of the world: at its border there would be surfaces.
        let layout = LayoutSpec {
            counts: UVec3::splat(2),
            spacing: Vec3::splat(16.0),
            centre: Vec3::ZERO,
            ..layout(3, Split::Hits, 0.5)
        };
        let volume = volume(&layout, &voxels);
        assert_eq!(volume.probes(), 8);
        let sum: f32 = volume
            .cage(Vec3::new(3.0, 50.0, 1.0))
            .iter()
            .map(|(_, weight)| weight)
            .sum();
        assert!((sum - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_point_at_a_probe_has_that_probe_alone() {
    let volume = volume(
        &layout(3, Split::Surface, 0.5),
        &world(&[([20.0, 9.0, 12.0], 5.0)]),
    );
    let octree = volume.octree().expect("an octree");
    for (home, slot) in &octree.by_home {
        let point = (octree.anchor + *home).as_vec3();
        let all = weights(&volume, point);
        let own = all[&volume.position(*slot).floor().as_ivec3()];
        assert!((own - 1.0).abs() < 1e-5, "{home}: {own}");
    }
}

#[test]
fn a_flat_wall_counts_once_and_an_edge_twice() {
    let mut voxels = Voxels::empty(UVec3::splat(64));
    voxels.fill_box(IVec3::ZERO, IVec3::new(63, 10, 63), 1);
    let spec = OctreeSpec {
        depth: 1,
        ..OctreeSpec::default()
    };
    let measure = |voxels: &Voxels, at: f32| {
        let spec = OctreeSpec {
            divide_at: at,
            ..spec.clone()
        };
        let mut geometry = Geometry::new(
            &spec,
            UVec3::ONE,
            IVec3::splat(16),
            IVec3::new(16, 8, 16),
            voxels,
        );
        geometry.divided(voxels, 1, &[IVec3::ZERO])[0]
    };
    assert!(measure(&voxels, 0.99) && !measure(&voxels, 1.01));
    voxels.fill_box(IVec3::new(0, 0, 32), IVec3::splat(63), 1);
    assert!(measure(&voxels, 1.2) && !measure(&voxels, 2.0));
}

#[test]
fn the_published_way_has_probes_in_leaves_that_see_enough() {
    let mut layout = layout(3, Split::Hits, 0.5);
    let voxels = world(&[([16.0; 3], 9.0)]);
    layout.octree.as_mut().expect("an octree").source = true;
    let all = Octree::new(&layout, &voxels, ORIGIN).expect("a good layout");
    layout.octree.as_mut().expect("an octree").free_below = 0.9;
    let few = Octree::new(&layout, &voxels, ORIGIN).expect("a good layout");
    assert!(few.probes() < all.probes() && all.probes() > 0);
}

#[test]
fn bad_octrees_say_what_is_wrong() {
    let voxels = world(&[([16.0; 3], 9.0)]);
    let refused = |change: &dyn Fn(&mut LayoutSpec)| {
        let mut layout = layout(3, Split::Surface, 0.0);
        change(&mut layout);
        let error = Octree::new(&layout, &voxels, ORIGIN).expect_err("must be refused");
        error.to_string()
    };
    assert!(refused(&|l| l.counts.x = 1).contains("at least 2"));
    assert!(refused(&|l| l.spacing.y = 12.0).contains("2^3"));
    assert!(refused(&|l| l.spacing.x = f32::NAN).contains("2^3"));
    assert!(refused(&|l| l.centre.x = f32::NAN).contains("centre"));
    assert!(refused(&|l| l.counts = UVec3::splat(60)).contains("Lower `depth`"));
    assert!(refused(&|l| l.centre.x = 1e6 + 5e4).contains("voxels from the origin"));
}
