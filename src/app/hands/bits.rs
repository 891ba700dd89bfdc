//! What flies off dug voxels: small cubes that fall, bounce off voxels, and shrink away within a second.
//!
//! They move in the player's steps of simulated time, and their random numbers come from the voxel and the number of the
//! stroke, so a replay draws the same bits. Nothing else depends on them.

use glam::{DVec3, I64Vec3, IVec3, UVec3, Vec3};

use crate::{
    app::{
        body::{Aabb, Measures, Terrain, point_to_units, to_units, to_voxels},
        player::{NS_PER_S, STEP_S, STEPS_PER_S, step_start_ns, whole_steps},
    },
    passes::view::bits::GpuBit,
    world::{Material, Pattern, sdf::pcg3d},
};

/// Most bits at a time; the oldest are forgotten first.
pub const MOST: usize = 256;
/// Most bits of one stroke, and of one voxel.
const OF_A_STROKE: usize = 48;
const OF_A_VOXEL: usize = 8;

/// Steps of the shortest and the longest life.
const LIVES: [u64; 2] = [STEPS_PER_S * 6 / 10, STEPS_PER_S];
/// Share of a life in which a bit shrinks away.
const SHRINKS: f64 = 0.4;
/// Half of the smallest and the largest edge (voxels).
const HALF_SIZES: [f64; 2] = [0.05, 0.1];

/// Speeds at the start, for a player of the usual size (voxels per second): towards the eye, upwards, and at most in any
/// direction.
const TOWARDS_EYE: f64 = 1.2;
const UPWARDS: f64 = 2.2;
const ASIDE: f64 = 1.6;
/// What a bounce leaves of the speed against the voxel, and of the speed along it.
const BOUNCE: f64 = 0.35;
const SLIDE: f64 = 0.7;
/// Slower than this (voxels per second) a bit no longer bounces.
const LEAST_BOUNCE: f64 = 0.5;

/// A voxel that was dug.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dug {
    /// World space.
    pub voxel: IVec3,
    /// 1-based index into the world's materials.
    pub material: u8,
}

#[derive(Clone, Debug, PartialEq)]
struct Flying {
    /// In units of a voxel, world space.
    centre: I64Vec3,
    /// Voxels per second.
    velocity: DVec3,
    /// Half of its first edge (voxels).
    half_size: f64,
    albedo: Vec3,
    emission: Vec3,
    /// Steps that it has lived, and that it will live.
    age: u64,
    life: u64,
}

/// The bits of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bits {
    flying: Vec<Flying>,
    /// Steps of simulated time so far.
    steps: u64,
    /// Strokes that have made bits.
    strokes: u32,
}

impl Bits {
    /// Bits fly off the voxels of a stroke, towards `eye` (world space). `materials` are those of the world.
    pub fn burst(&mut self, dug: &[Dug], materials: &[Material], eye: DVec3, measures: &Measures) {
        let count = (OF_A_VOXEL * dug.len()).min(OF_A_STROKE);
        for number in 0..count {
            let Dug { voxel, material } = dug[number * dug.len() / count];
            let index = usize::from(material).checked_sub(1);
            let Some(material) = index.and_then(|index| materials.get(index)) else {
                continue;
            };
            let random = Random::new(voxel, self.strokes, number as u32);
            self.flying
                .push(Flying::new(voxel, material, random, eye, measures.scale));
        }
        self.strokes = self.strokes.wrapping_add(1);
        let surplus = self.flying.len().saturating_sub(MOST);
        self.flying.drain(..surplus);
    }

    /// Simulates until this time (nanoseconds of the run).
    pub fn advance(&mut self, to_ns: u64, terrain: &impl Terrain, measures: &Measures) {
        let steps = whole_steps(to_ns);
        while self.steps < steps && !self.flying.is_empty() {
            self.flying.retain_mut(|bit| {
                bit.age += 1;
                bit.step(terrain, measures.gravity, STEP_S);
                bit.age < bit.life && !bit.body().overlaps(terrain)
            });
            self.steps += 1;
        }
        self.steps = self.steps.max(steps);
    }

    /// All bits are gone.
    pub fn clear(&mut self) {
        self.flying.clear();
    }

    /// The bits as they are now: the rest of the time since the last step is played on copies.
    pub fn seen(&self, now_ns: u64, terrain: &impl Terrain, measures: &Measures) -> Vec<GpuBit> {
        let rest_ns = now_ns.saturating_sub(step_start_ns(self.steps));
        let rest_s = rest_ns as f64 / NS_PER_S as f64;
        let seen = self.flying.iter().map(|bit| {
            let mut bit = bit.clone();
            bit.step(terrain, measures.gravity, rest_s);
            GpuBit {
                centre_ws: bit.centre_ws().as_vec3().to_array(),
                half_size: bit.half_now() as f32,
                albedo: bit.albedo.to_array(),
                flies: 1,
                emission: bit.emission.to_array(),
                ..GpuBit::default()
            }
        });
        seen.collect()
    }
}

impl Flying {
    fn new(voxel: IVec3, material: &Material, mut random: Random, eye: DVec3, scale: f64) -> Self {
        let half_size = random.between(HALF_SIZES);
        let room = [half_size, 1.0 - half_size];
        let within = DVec3::from_array(std::array::from_fn(|_| random.between(room)));
        let centre = voxel.as_dvec3() + within;
        let aside = DVec3::from_array(std::array::from_fn(|_| random.between([-ASIDE, ASIDE])));
        let towards_eye = (eye - centre).normalize_or_zero();
        let albedo = material.a.at(voxel, 1.0);
        let share = match material.pattern {
            Pattern::Plain => 0.0,
            _ => random.between([0.0, 1.0]) as f32,
        };
        Self {
            centre: point_to_units(centre),
            velocity: (TOWARDS_EYE * towards_eye + UPWARDS * DVec3::Y + aside) * scale,
            half_size,
            albedo: albedo.lerp(material.b.at(voxel, 1.0), share),
            emission: material.emission,
            age: 0,
            life: random.between(LIVES.map(|steps| steps as f64)) as u64,
        }
    }

    fn centre_ws(&self) -> DVec3 {
        DVec3::from(self.centre.to_array().map(to_voxels))
    }

    /// It keeps its size at first, and then shrinks away.
    fn half_now(&self) -> f64 {
        let left = 1.0 - self.age as f64 / self.life as f64;
        self.half_size * (left / SHRINKS).clamp(0.0, 1.0)
    }

    fn body(&self) -> Aabb {
        let half = I64Vec3::splat(to_units(self.half_now()).max(1));
        Aabb {
            min: self.centre - half,
            max: self.centre + half,
        }
    }

    /// Moves along one axis after the other, up to the voxel that is in the way, and bounces off it.
    fn step(&mut self, terrain: &impl Terrain, gravity: f64, elapsed_s: f64) {
        self.velocity.y -= gravity * elapsed_s;
        for axis in [1, 0, 2] {
            let wanted = to_units(self.velocity[axis] * elapsed_s);
            let moved = self.body().sweep(terrain, axis, wanted);
            self.centre[axis] += moved;
            if moved != wanted {
                let against = self.velocity[axis];
                self.velocity *= SLIDE;
                self.velocity[axis] = match against.abs() {
                    slow if slow < LEAST_BOUNCE => 0.0,
                    _ => -BOUNCE * against,
                };
            }
        }
    }
}

/// Random numbers of one bit (PCG3D of Jarzynski & Olano 2020).
struct Random(UVec3);

impl Random {
    fn new(voxel: IVec3, stroke: u32, number: u32) -> Self {
        Self(pcg3d(
            pcg3d(voxel.as_uvec3()) ^ UVec3::new(stroke, number, 0),
        ))
    }

    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        self.0 = pcg3d(self.0.wrapping_add(UVec3::X));
        low + (high - low) * f64::from(self.0.x) / (f64::from(u32::MAX) + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::{Colour, MaterialSound};

    const MS: u64 = 1_000_000;

    /// A floor below y = 0, and a wall of every third voxel.
    struct Room;

    impl Terrain for Room {
        fn is_solid(&self, voxel: IVec3) -> bool {
            voxel.y < 0 || (voxel.x == 2 && voxel.element_sum() % 3 == 0)
        }
    }

    fn materials() -> Vec<Material> {
        let flat = |name: &str, colour: Vec3| Material {
            name: name.into(),
            a: Colour::Flat(colour),
            b: Colour::Flat(colour),
            pattern: Pattern::Plain,
            emission: 0.5 * colour,
            sound: MaterialSound::Stone,
        };
        vec![flat("red", Vec3::X), flat("green", Vec3::Y)]
    }

    fn measures() -> Measures {
        Measures::of_height(1.77)
    }

    fn dug(voxels: impl IntoIterator<Item = IVec3>) -> Vec<Dug> {
        let of = |voxel| Dug { voxel, material: 2 };
        voxels.into_iter().map(of).collect()
    }

    /// Bits of one voxel beside the wall.
    fn burst() -> Bits {
        let mut bits = Bits::default();
        let eye = DVec3::new(4.0, 1.6, 0.0);
        let voxel = dug([IVec3::new(1, 1, 1)]);
        bits.burst(&voxel, &materials(), eye, &measures());
        bits
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn the_same_bits_are_seen_at_any_frame_rate(frames in prop::collection::vec(1..250u64, 1..20)) {
            let (mut at_once, mut in_frames) = (burst(), burst());
            let mut now_ns = 0;
            for frame in frames {
                now_ns += frame * MS;
                in_frames.advance(now_ns, &Room, &measures());
            }
            at_once.advance(now_ns, &Room, &measures());
            let seen = |bits: &Bits| bits.seen(now_ns, &Room, &measures());
            prop_assert_eq!(seen(&at_once), seen(&in_frames));
            prop_assert_eq!(at_once, in_frames);
        }

        #[test]
        fn no_bit_is_ever_in_a_solid_voxel(
            x in -3..6i32, y in 0..4i32, z in -3..6i32,
            eye in (-9.0..9.0f64, -9.0..9.0f64, -9.0..9.0f64),
        ) {
            let voxel = IVec3::new(x, y, z);
            prop_assume!(!Room.is_solid(voxel));
            let mut bits = Bits::default();
            bits.burst(&dug([voxel]), &materials(), eye.into(), &measures());
            prop_assert_eq!(bits.flying.len(), OF_A_VOXEL);
            for step in 0..STEPS_PER_S {
                for bit in &bits.flying {
                    prop_assert!(!bit.body().overlaps(&Room), "{bit:?} after {step} steps");
                }
                bits.advance(step_start_ns(step + 1), &Room, &measures());
            }
            prop_assert!(bits.flying.is_empty(), "they live for a second at most");
        }
    }

    #[test]
    fn bits_fall_lie_on_the_floor_and_have_the_colours_of_their_voxel() {
        let mut bits = burst();
        let highest = |bits: &Bits| {
            let heights = bits.flying.iter().map(|bit| bit.centre_ws().y);
            heights.fold(0.0, f64::max)
        };
        let size = |seen: &[GpuBit]| seen.iter().map(|bit| bit.half_size).sum::<f32>();
        bits.advance(100 * MS, &Room, &measures());
        let soon = highest(&bits);
        let first = size(&bits.seen(100 * MS, &Room, &measures()));
        bits.advance(590 * MS, &Room, &measures());
        let late = highest(&bits);
        assert!(soon > 1.0 && late < soon - 0.5, "{soon}, {late}");
        let seen = bits.seen(590 * MS, &Room, &measures());
        assert!(size(&seen) < 0.8 * first, "they shrink");
        assert_eq!(seen.len(), OF_A_VOXEL, "none has lived for less than 0.6 s");
        for bit in seen {
            assert_eq!(
                (bit.albedo, bit.emission),
                ([0.0, 1.0, 0.0], [0.0, 0.5, 0.0])
            );
            assert!(bit.centre_ws[1] > 0.0 && bit.flies == 1);
        }
    }

    #[test]
    fn large_strokes_and_many_strokes_make_a_limited_number() {
        let mut bits = Bits::default();
        let ball = dug((0..5000).map(|n| IVec3::new(n % 17 - 20, 3 + n / 289, n / 17 % 17)));
        for stroke in 1..10 {
            bits.burst(&ball, &materials(), DVec3::ZERO, &measures());
            assert_eq!(bits.flying.len(), MOST.min(stroke * OF_A_STROKE));
        }
        let heights: Vec<f64> = bits.flying.iter().map(|bit| bit.centre_ws().y).collect();
        let spread = heights.iter().fold(0.0, |a: f64, b| a.max(*b));
        assert!(spread > 15.0, "they come from all of the ball: {spread}");
        bits.burst(&[], &materials(), DVec3::ZERO, &measures());
        // A material that the world no longer has.
        let unknown = [Dug {
            voxel: IVec3::ZERO,
            material: 9,
        }];
        bits.burst(&unknown, &materials(), DVec3::ZERO, &measures());
        assert_eq!(bits.flying.len(), MOST);
    }

    #[test]
    fn strokes_at_one_place_differ_and_voxels_that_close_around_bits_end_them() {
        struct Stone;
        impl Terrain for Stone {
            fn is_solid(&self, _: IVec3) -> bool {
                true
            }
        }
        let mut bits = burst();
        let first = bits.flying.clone();
        let voxel = dug([IVec3::new(1, 1, 1)]);
        bits.burst(&voxel, &materials(), DVec3::new(4.0, 1.6, 0.0), &measures());
        assert_eq!(bits.flying[..first.len()], first);
        assert!(bits.flying[first.len()..] != first);
        bits.advance(9 * MS, &Stone, &measures());
        assert!(bits.flying.is_empty());
    }
}
