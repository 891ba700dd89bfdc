//! The changes of a storm and their frames, from a seed. Every kind has its own random numbers, so that it does
//! the same whatever other kinds run at the same time.

use glam::{IVec3, UVec3, Vec3};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::kinds::Kind;
use crate::{
    parameters::Parameters,
    world::{
        Camera, LayoutSpec,
        voxels::{Edit, Voxels},
    },
};

/// Voxels that an edit storm rewrites per second of world time.
pub const VOXELS_PER_SECOND: u32 = 10_000;
/// Frames per second of world time.
pub const RATE: u32 = 60;
/// Longest edge of a box, and largest radius of a ball, in voxels.
const LONGEST_EDGE: i32 = 8;
const LARGEST_RADIUS: f32 = 3.5;
/// Half of the strokes are within this distance of the camera, in voxels.
const NEAR: i32 = 16;

/// The random numbers of one kind of change.
pub struct Dice {
    random: ChaCha8Rng,
    /// Frame of the next change.
    next: u32,
}

impl Dice {
    pub fn new(seed: u32, kind: Kind) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(u64::from(seed));
        random.set_stream(kind as u64);
        Self { random, next: 0 }
    }

    /// Whether a change is due in this frame. The next one is due some frames later.
    pub fn is_due(&mut self, frame: u32, frames_between: std::ops::RangeInclusive<u32>) -> bool {
        let due = frame >= self.next;
        if due {
            self.next = frame + self.random.random_range(frames_between);
        }
        // The first frame is left for settling.
        due && frame > 0
    }

    fn chance(&mut self, share: f64) -> bool {
        self.random.random_bool(share)
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.random.random_range(0..all.len())]
    }

    /// Size of a picture: at most 1.5 times `base`, odd or even, often one pixel wide, high or both.
    pub fn size(&mut self, base: [u32; 2]) -> [u32; 2] {
        if self.chance(0.15) {
            return [1, 1];
        }
        base.map(|edge| {
            if self.chance(0.15) {
                1
            } else {
                self.random.random_range(1..=(edge * 3 / 2).max(1))
            }
        })
    }

    /// World time to jump to, in seconds: back, forward, near, and up to the largest `--time`.
    pub fn time(&mut self, now_s: f64) -> f64 {
        let near = self.random.random_range(-10.0..10.0);
        let day = self.random.random_range(-86_400.0..86_400.0);
        self.one_of(&[
            now_s + near,
            now_s + near / 1e3,
            day,
            0.0,
            -0.0,
            1e6 + day,
            1e9,
            -1e9,
        ])
    }

    /// One of these layouts or a random one, with parameters that rebuild the probes.
    pub fn layout(
        &mut self,
        layouts: &[LayoutSpec],
        parameters: &Parameters,
    ) -> (LayoutSpec, Parameters) {
        let mut layout = layouts[self.random.random_range(0..layouts.len())].clone();
        if self.chance(0.25) {
            layout.counts = UVec3::from_array([0; 3].map(|_| self.random.random_range(2..=8)));
            layout.spacing = Vec3::splat(self.random.random_range(2..=12) as f32);
            layout.octree = None;
            layout.cascades = self.random.random_range(1..=3);
            layout.follow = layout.cascades > 1 || self.chance(0.3);
        }
        let mut next = parameters.clone();
        for values in [
            &[
                "probes.rays=8",
                "probes.rays=33",
                "probes.rays=64",
                "probes.rays=150",
            ][..],
            &[
                "probes.visibility=chebyshev",
                "probes.visibility=exact",
                "probes.visibility=auto",
            ],
            &[
                "probes.irradiance_texels=4",
                "probes.irradiance_texels=8",
                "probes.irradiance_texels=13",
            ],
            &[
                "probes.distance_texels=6",
                "probes.distance_texels=16",
                "probes.distance_texels=21",
            ],
            &["probes.relocation=off", "probes.relocation=exact"],
            &["probes.final_gather=on", "probes.final_gather=off"],
            &["probes.states=on", "probes.states=off"],
            &[
                "probes.method=grotto",
                "probes.method=grotto",
                "probes.method=source",
            ],
            &[
                "source.weights=perception",
                "source.weights=adjusted",
                "source.weights=direction",
            ],
            &[
                "source.relocation=off",
                "source.relocation=surface",
                "source.relocation=clear",
            ],
            &["source.depth=clamp", "source.depth=reject"],
        ] {
            // Parameters that are not drawn keep their previous values.
            if self.chance(0.4) {
                let assignment = self.one_of(values);
                next.set(assignment)
                    .expect("the table above holds assignments that are allowed");
            }
        }
        (layout, next)
    }

    /// A stroke in a world of `size` voxels with `materials` materials; half of the strokes are near `camera`
    /// (grid space).
    pub fn stroke(&mut self, size: UVec3, camera: IVec3, materials: u8) -> Stroke {
        let at = if self.chance(0.5) {
            let offset = [0; 3].map(|_| self.random.random_range(-NEAR..=NEAR));
            camera + IVec3::from_array(offset)
        } else {
            let edge = |edge: u32| 0..edge as i32;
            IVec3::from_array(size.to_array().map(|n| self.random.random_range(edge(n))))
        };
        let material = if self.chance(0.5) {
            0
        } else {
            self.random.random_range(1..=materials)
        };
        match self.random.random_range(0..3) {
            0 => Stroke::Voxel(at, material),
            1 => {
                let radius = self.random.random_range(0.8..LARGEST_RADIUS);
                Stroke::Ball(at.as_vec3() + 0.5, radius, material)
            }
            _ => {
                let edges = [0; 3].map(|_| self.random.random_range(1..=LONGEST_EDGE));
                Stroke::Box(at, at + IVec3::from_array(edges) - 1, material)
            }
        }
    }
}

/// A change of voxels (grid space) to one material, 0 for air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stroke {
    Voxel(IVec3, u8),
    /// Centre and radius.
    Ball(Vec3, f32, u8),
    /// Both ends inclusive.
    Box(IVec3, IVec3, u8),
}

impl Stroke {
    pub fn make(&self, voxels: &mut Voxels) -> Edit {
        match *self {
            Self::Voxel(at, material) => voxels.set(at, material),
            Self::Ball(centre, radius, material) => voxels.fill_sphere(centre, radius, material),
            Self::Box(min, max, material) => voxels.fill_box(min, max, material),
        }
    }

    /// Number of voxels in the stroke, in a world that contains all of them.
    pub fn voxels(&self) -> u32 {
        match *self {
            Self::Voxel(..) => 1,
            Self::Ball(_, radius, _) => (4.19 * radius.powi(3)).round().max(1.0) as u32,
            Self::Box(min, max, _) => (max - min + 1).element_product() as u32,
        }
    }
}

/// Frames of the flight from one camera of a world to the next.
const FRAMES_A_LEG: u32 = 240;

/// The camera in frame `frame`: it flies from each camera of the world to the next one and back to the first,
/// looking around. The path may lead through solid voxels.
pub fn camera(cameras: &[Camera], frame: u32) -> Camera {
    let leg = (frame / FRAMES_A_LEG) as usize;
    let along = (frame % FRAMES_A_LEG) as f32 / FRAMES_A_LEG as f32;
    let (from, to) = (
        &cameras[leg % cameras.len()],
        &cameras[(leg + 1) % cameras.len()],
    );
    let turn = (std::f32::consts::TAU * along).sin();
    Camera {
        position: from.position.lerp(to.position, along) + Vec3::Y * turn,
        yaw_deg: from.yaw_deg + 40.0 * turn,
        pitch_deg: from.pitch_deg,
        ..from.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strokes(seed: u32) -> Vec<Stroke> {
        let mut dice = Dice::new(seed, Kind::Edit);
        (0..200)
            .map(|_| dice.stroke(UVec3::new(40, 20, 30), IVec3::splat(9), 3))
            .collect()
    }

    #[test]
    fn a_seed_repeats_what_it_did_and_no_other_does() {
        assert_eq!(strokes(7), strokes(7));
        assert_ne!(strokes(7), strokes(8));
        let times = |kind| Dice::new(7, kind).time(0.0);
        assert_ne!(times(Kind::Time), times(Kind::Edit));
    }

    #[test]
    fn strokes_are_of_every_kind_and_rewrite_about_as_many_voxels_as_they_say() {
        let all = strokes(1);
        let of = |test: &dyn Fn(&Stroke) -> bool| all.iter().filter(|stroke| test(stroke)).count();
        assert!(of(&|stroke| matches!(stroke, Stroke::Voxel(..))) > 40);
        assert!(of(&|stroke| matches!(stroke, Stroke::Ball(..))) > 40);
        assert!(of(&|stroke| matches!(stroke, Stroke::Box(..))) > 40);
        let (mut said, mut rewritten) = (0, 0);
        for stroke in all {
            // In the middle of a world of air, so that every voxel counts.
            let moved = match stroke {
                Stroke::Voxel(..) => Stroke::Voxel(IVec3::splat(16), 1),
                Stroke::Ball(_, radius, _) => Stroke::Ball(Vec3::splat(16.5), radius, 1),
                Stroke::Box(min, max, _) => Stroke::Box(IVec3::splat(16), max - min + 16, 1),
            };
            let mut voxels = Voxels::empty(UVec3::splat(32));
            moved.make(&mut voxels);
            said += moved.voxels();
            rewritten += (0..32 * 32 * 32)
                .filter(|i| voxels.material(IVec3::new(i & 31, i >> 5 & 31, i >> 10)) == 1)
                .count() as u32;
        }
        let ratio = f64::from(said) / f64::from(rewritten);
        assert!((ratio - 1.0).abs() < 0.1, "{said} against {rewritten}");
    }

    #[test]
    fn changes_come_at_their_distances_and_never_in_the_first_frame() {
        let mut dice = Dice::new(3, Kind::Resize);
        let due: Vec<u32> = (0..200)
            .filter(|&frame| dice.is_due(frame, 2..=6))
            .collect();
        assert!(due[0] > 0 && due.len() > 30);
        assert!(
            due.windows(2)
                .all(|pair| (2..=6).contains(&(pair[1] - pair[0])))
        );
    }

    #[test]
    fn sizes_include_single_pixels_and_odd_ones() {
        let mut dice = Dice::new(5, Kind::Resize);
        let sizes: Vec<[u32; 2]> = (0..100).map(|_| dice.size([64, 36])).collect();
        assert!(sizes.contains(&[1, 1]));
        assert!(
            sizes
                .iter()
                .any(|[w, h]| w % 2 == 1 && h % 2 == 1 && *w > 1 && *h > 1)
        );
        assert!(
            sizes
                .iter()
                .all(|[w, h]| (1..=96).contains(w) && (1..=54).contains(h))
        );
    }
}
