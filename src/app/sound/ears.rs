//! What surrounds the ear, found by rays: some dozens in a second leave the ear, are reflected by the voxels, and
//! end in the open or after some reflections. What they meet gives the echo.
//!
//! - The mean length of a path between two reflections is the room's mean free path ℓ = 4V/S (Kosten 1960).
//! - Its reverberation time follows from ℓ and from what a reflection loses: T = 6 ln 10 · ℓ / (c · −ln(1 − α))
//!   (Sabine 1922 in the form of Eyring 1930). A way into the open loses everything.
//! - The level of the echo is that of a diffuse field, 4 (1 − α) / (S α), against the direct sound, 1 / (4π r²)
//!   (Kuttruff, *Room Acoustics*, 5.5). Its walls have the surface S of a ball of the same mean square radius.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, IVec3};

use super::{chance::Chance, mixer::Room, reverb::Echo};
use crate::{
    reference::march::{FACE_NORMALS, Outcome, Ray, march},
    world::{materials::MaterialSound, voxels::Voxels},
};

/// Rays in a second of simulated time.
pub const RAYS_PER_S: u64 = 60;
const NS_PER_RAY: u64 = 1_000_000_000 / RAYS_PER_S;
/// Most paths of a ray from one reflection to the next.
const PATHS: u32 = 6;
/// What is known is a mean over about so many rays.
const REMEMBERED: f64 = 90.0;
/// Most rays in one frame: after a pause, or in a room that was just entered.
const MOST_RAYS: u64 = 96;
/// Whoever is moved farther than this between two frames (metres) is in another room.
const LEAP_M: f64 = 8.0;

const SPEED_OF_SOUND_M_PER_S: f64 = 343.0;
/// What air takes from a sound of 1 kHz on its way (1/m; Kuttruff, table 6.1).
const AIR_PER_M: f64 = 0.001;
/// From the ear to where a noise is made (metres): feet, and hands that dig.
const SOURCE_M: f64 = 1.6;
/// Bounds of the reverberation time (seconds).
const SHORTEST_S: f64 = 0.12;
const LONGEST_S: f64 = 9.0;

/// Where an ear is.
pub struct Place<'a> {
    pub voxels: &'a Voxels,
    /// Of the world's materials, in their order.
    pub sounds: &'a [MaterialSound],
    /// Grid space.
    pub ear: DVec3,
    pub voxels_per_m: f64,
}

/// Means over rays.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    /// Reflections of a ray, and the length of the paths that led to them (metres).
    reflections: f64,
    length_m: f64,
    /// What the reflections lost, each from 0 to 1.
    lost: f64,
    /// 1 for a ray that ended in the open.
    escaped: f64,
    /// 1 for a ray whose first path led into the sky.
    sky: f64,
    /// 1 for a ray whose first path ended at a wall, and the square of its length (m²).
    walls: f64,
    square_m2: f64,
}

/// The sound of a voxel's material (1-based).
pub fn sound_of(sounds: &[MaterialSound], material: u8) -> MaterialSound {
    let index = usize::from(material).checked_sub(1);
    let known = index.and_then(|index| sounds.get(index));
    known.copied().unwrap_or(MaterialSound::Stone)
}

/// Share of a sound that a reflection loses: mean figures of 500 Hz to 1 kHz for such surfaces (Vorländer 2008,
/// *Auralization*, appendix).
fn absorption(material: MaterialSound) -> f64 {
    match material {
        MaterialSound::Stone => 0.05,
        MaterialSound::Soil => 0.35,
        MaterialSound::Grass => 0.5,
        MaterialSound::Wood => 0.12,
        MaterialSound::Glow => 0.2,
    }
}

#[derive(Clone, Debug)]
pub struct Ears {
    chance: Chance,
    means: Means,
    /// Rays that the means are made of.
    known: f64,
    /// Rays that simulated time has asked for, and rays sent.
    due: u64,
    directions: u64,
    last: Option<DVec3>,
}

impl Ears {
    pub fn new(seed: u32) -> Self {
        Self {
            chance: Chance::new(seed),
            means: Means::default(),
            known: 0.0,
            due: 0,
            directions: 0,
            last: None,
        }
    }

    /// Sends the rays that are due until a simulated time, and says what is known now.
    pub fn listen(&mut self, place: &Place<'_>, now_ns: u64) -> Room {
        let leap = LEAP_M * place.voxels_per_m;
        let due = now_ns / NS_PER_RAY;
        let mut rays = due.saturating_sub(self.due).min(MOST_RAYS);
        if self.last.is_none_or(|last| last.distance(place.ear) > leap) {
            self.known = 0.0;
            rays = MOST_RAYS;
        }
        self.due = due;
        self.last = Some(place.ear);
        for _ in 0..rays {
            let ray = self.ray(place);
            self.known = (self.known + 1.0).min(REMEMBERED);
            self.means.approach(&ray, 1.0 / self.known);
        }
        self.means.room()
    }

    /// Follows one ray until it is in the open, or was reflected often enough.
    fn ray(&mut self, place: &Place<'_>) -> Means {
        let mut found = Means::default();
        let mut ray = Ray::new(place.ear, self.first_direction());
        for path in 0..PATHS {
            let hit = match march(place.voxels, &ray) {
                Outcome::Hit(hit) => hit,
                Outcome::Miss => {
                    found.escaped = 1.0;
                    found.sky = f64::from(path == 0 && ray.direction.y > 0.0);
                    break;
                }
                // An ear in stone hears the stone.
                Outcome::Inside(_) => break,
            };
            let length_m = hit.distance / place.voxels_per_m;
            let sound = sound_of(place.sounds, hit.material);
            found.reflections += 1.0;
            found.length_m += length_m;
            found.lost += absorption(sound);
            if path == 0 {
                found.walls = 1.0;
                found.square_m2 = length_m * length_m;
            }
            let normal: IVec3 = FACE_NORMALS[usize::from(hit.face)];
            // Lambert: rough walls reflect by the cosine, which a unit vector plus the normal gives.
            let direction = normal.as_dvec3() * 1.000_001 + self.direction();
            ray = Ray {
                origin: hit.position(&ray),
                direction: direction.normalize(),
                start: hit.voxel + normal,
                max_distance: f64::INFINITY,
            };
        }
        found
    }

    /// The direction of a ray that leaves the ear. Any row of them covers the sphere evenly: the R2 sequence of
    /// Roberts 2018, "The unreasonable effectiveness of quasirandom sequences".
    fn first_direction(&mut self) -> DVec3 {
        self.directions += 1;
        let row = |step: f64| (self.directions as f64 * step).fract();
        on_sphere(row(0.754_877_666_246_693), row(0.569_840_290_998_053))
    }

    fn direction(&mut self) -> DVec3 {
        on_sphere(self.chance.unit().into(), self.chance.unit().into())
    }
}

/// Two numbers in [0, 1) as a direction; even numbers give even directions.
fn on_sphere(height: f64, angle: f64) -> DVec3 {
    let y = 2.0 * height - 1.0;
    let ring = (1.0 - y * y).max(0.0).sqrt();
    let (sin, cos) = (TAU * angle).sin_cos();
    DVec3::new(ring * cos, y, ring * sin)
}

impl Means {
    fn approach(&mut self, ray: &Self, share: f64) {
        let closer = |mean: &mut f64, found: f64| *mean += share * (found - *mean);
        closer(&mut self.reflections, ray.reflections);
        closer(&mut self.length_m, ray.length_m);
        closer(&mut self.lost, ray.lost);
        closer(&mut self.escaped, ray.escaped);
        closer(&mut self.sky, ray.sky);
        closer(&mut self.walls, ray.walls);
        closer(&mut self.square_m2, ray.square_m2);
    }

    fn room(&self) -> Room {
        // Half of the directions lead upwards.
        let sky = (2.0 * self.sky).min(1.0) as f32;
        let outdoors = Room {
            sky,
            ..Room::default()
        };
        if self.reflections < 0.01 || self.walls < 0.01 {
            return outdoors;
        }
        let path_m = self.length_m / self.reflections;
        let loss = ((self.lost + self.escaped) / (self.reflections + self.escaped)).min(0.99);
        let per_m = -(1.0 - loss).ln() / path_m + AIR_PER_M;
        let time_s = 6.0 * 10_f64.ln() / (SPEED_OF_SOUND_M_PER_S * per_m);
        let surface_m2 = 4.0 * PI * self.square_m2 / self.walls;
        let diffuse = 4.0 * (1.0 - loss) / (surface_m2 * loss);
        let direct = 1.0 / (4.0 * PI * SOURCE_M * SOURCE_M);
        Room {
            echo: Echo {
                time_s: time_s.clamp(SHORTEST_S, LONGEST_S) as f32,
                between_s: (path_m / SPEED_OF_SOUND_M_PER_S) as f32,
            },
            wet: (diffuse / (diffuse + direct)).sqrt() as f32,
            sky,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    /// A block of stone with a room of this size in its middle.
    fn room(size: UVec3) -> (Voxels, DVec3) {
        let whole = size + 4;
        let mut voxels = Voxels::empty(whole);
        voxels.fill_box(IVec3::ZERO, whole.as_ivec3() - 1, 1);
        voxels.fill_box(IVec3::splat(2), whole.as_ivec3() - 3, 0);
        (voxels, whole.as_dvec3() * 0.5 + 0.1)
    }

    /// What is known after a minute.
    fn heard(
        voxels: &Voxels,
        ear: DVec3,
        sound: MaterialSound,
        voxels_per_m: f64,
    ) -> (Means, Room) {
        let place = Place {
            voxels,
            sounds: &[sound],
            ear,
            voxels_per_m,
        };
        let mut ears = Ears::new(3);
        let mut sum = Means::default();
        let mut room = Room::default();
        for second in 1..=60 {
            room = ears.listen(&place, second * 1_000_000_000);
            sum.approach(&ears.means, 1.0 / second as f64);
        }
        (sum, room)
    }

    #[test]
    fn paths_in_a_closed_room_have_the_length_that_its_volume_and_surface_give() {
        for size in [UVec3::splat(12), UVec3::new(30, 8, 16)] {
            let (voxels, ear) = room(size);
            let (means, _) = heard(&voxels, ear, MaterialSound::Stone, 1.0);
            let [x, y, z] = size.as_dvec3().to_array();
            let wanted_m = 4.0 * x * y * z / (2.0 * (x * y + y * z + z * x));
            let path_m = means.length_m / means.reflections;
            // The first path begins at the ear, not at a wall.
            assert!(
                (path_m / wanted_m - 1.0).abs() < 0.1,
                "{size}: {path_m} m, {wanted_m} m"
            );
            assert_eq!((means.escaped, means.sky), (0.0, 0.0));
        }
    }

    #[test]
    fn reverberation_is_what_eyring_says_of_the_walls_and_grows_with_the_room() {
        for (sound, loss) in [(MaterialSound::Stone, 0.05), (MaterialSound::Grass, 0.5)] {
            let (voxels, ear) = room(UVec3::splat(16));
            let (_, heard) = heard(&voxels, ear, sound, 1.0);
            let path_m = 4.0 * 16.0 / 6.0;
            let per_m = -f64::ln(1.0 - loss) / path_m + AIR_PER_M;
            // Sabine's 0.161 s/m is 24 ln 10 / c.
            let wanted_s = 0.161 / 4.0 / per_m;
            let ratio = f64::from(heard.echo.time_s) / wanted_s;
            assert!((0.9..1.1).contains(&ratio), "{heard:?}, {wanted_s} s");
        }
        let time = |size: u32, scale: f64| {
            let (voxels, ear) = room(UVec3::splat(size));
            heard(&voxels, ear, MaterialSound::Stone, scale)
                .1
                .echo
                .time_s
        };
        assert!(time(24, 1.0) > 2.0 * time(8, 1.0));
        // Half as many metres: half the time.
        let ratio = time(16, 2.0) / time(16, 1.0);
        assert!((0.45..0.6).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_hole_in_the_roof_lets_the_echo_out_and_the_wind_in() {
        let (mut voxels, ear) = room(UVec3::splat(12));
        let closed = heard(&voxels, ear, MaterialSound::Stone, 1.0).1;
        voxels.fill_box(IVec3::new(4, 14, 4), IVec3::new(11, 15, 11), 0);
        let holed = heard(&voxels, ear, MaterialSound::Stone, 1.0).1;
        voxels.fill_box(IVec3::new(0, 3, 0), IVec3::splat(15), 0);
        let open = heard(&voxels, ear, MaterialSound::Stone, 1.0).1;
        assert!(
            closed.echo.time_s > 1.5 * holed.echo.time_s,
            "{closed:?} {holed:?}"
        );
        assert!(
            closed.wet > holed.wet && holed.wet > 3.0 * open.wet,
            "{holed:?} {open:?}"
        );
        assert_eq!(closed.sky, 0.0);
        assert!((0.1..0.5).contains(&holed.sky), "{holed:?}");
        assert!(open.sky > 0.95, "{open:?}");
    }

    #[test]
    fn nowhere_and_within_stone_nothing_echoes() {
        let air = Voxels::empty(UVec3::splat(8));
        let (_, open) = heard(&air, DVec3::splat(4.0), MaterialSound::Stone, 1.0);
        assert!(open.wet == 0.0 && open.sky > 0.95, "{open:?}");
        let (voxels, _) = room(UVec3::splat(8));
        let (_, stone) = heard(&voxels, DVec3::splat(0.5), MaterialSound::Stone, 1.0);
        assert_eq!((stone.wet, stone.sky), (0.0, 0.0));
    }

    #[test]
    fn another_place_is_known_at_once_and_a_second_costs_as_many_rays_as_it_says() {
        let (voxels, ear) = room(UVec3::splat(12));
        let mut place = Place {
            voxels: &voxels,
            sounds: &[MaterialSound::Stone],
            ear,
            voxels_per_m: 1.0,
        };
        let mut ears = Ears::new(1);
        let first = ears.listen(&place, 0);
        assert!(first.echo.time_s > 0.5, "{first:?}");
        assert_eq!(ears.known, REMEMBERED);
        place.ear = DVec3::new(8.0, 60.0, 8.0);
        let above = ears.listen(&place, 1_000_000);
        assert!(above.sky > 0.9, "{above:?}");
        ears.known = 0.0;
        for frame in 1..=100 {
            ears.listen(&place, 1_000_000 + frame * 10_000_000);
        }
        assert_eq!(ears.known, RAYS_PER_S as f64);
    }
}
