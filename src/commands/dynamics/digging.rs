//! Edits like those of a player who digs and builds, the same in every run.

use glam::{IVec3, Vec3};

use crate::{
    reference::march::{Outcome, Ray, march},
    world::{
        Camera, World,
        materials::hash::hash_voxel,
        voxels::{Edit, Voxels},
    },
};

/// Frames between two edits.
const INTERVAL: u32 = 10;
/// Radius of a ball that is dug or built, in voxels.
const RADIUS: f32 = 2.0;
/// Width of a box.
const WIDTH: i32 = 32;
/// Radius of the ball that crumbles, in voxels.
const CRUMBLING: f32 = 12.0;
/// A thousand of its 7238 voxels.
const CRUMBS: u32 = u32::MAX / 7238 * 1000;

/// Voxels on each side of an edit that [`Digging::are_followed_by`] looks at, too.
const AROUND: i32 = 6;

/// What an edit changes at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edited {
    /// A ball of radius 2: dug, and the next one built at another place.
    Ball,
    /// A box of 32³ voxels: dug, and then put back as it was.
    Box,
    /// A thousand single voxels, chosen at random from a ball of radius 12: dug, and then put back.
    Crumbs,
}

impl Edited {
    pub fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Box => "box",
            Self::Crumbs => "crumbs",
        }
    }

    /// The box of voxels around a place that may change, both ends inclusive.
    fn around(self, centre: Vec3) -> (IVec3, IVec3) {
        let ball = |radius: f32| {
            let ends = [centre - radius, centre + radius];
            ends.map(|end| end.floor().as_ivec3())
        };
        let [low, high] = match self {
            Self::Ball => ball(RADIUS),
            Self::Crumbs => ball(CRUMBLING),
            Self::Box => {
                let low = centre.floor().as_ivec3() - WIDTH / 2;
                [low, low + (WIDTH - 1)]
            }
        };
        (low, high)
    }

    fn fill(self, centre: Vec3, material: u8, voxels: &mut Voxels) -> Edit {
        let (low, high) = self.around(centre);
        match self {
            Self::Ball => voxels.fill_sphere(centre, RADIUS, material),
            Self::Box => voxels.fill_box(low, high, material),
            Self::Crumbs => voxels.edit(low, high, |voxel, old| {
                let from_middle = voxel.as_vec3() + 0.5 - centre;
                let crumbles = from_middle.length_squared() <= CRUMBLING * CRUMBLING
                    && hash_voxel(voxel) < CRUMBS;
                if crumbles { material } else { old }
            }),
        }
    }
}

/// An edit that can be repeated on other voxels.
#[derive(Clone, Debug, PartialEq)]
pub enum Stroke {
    /// Fills what is edited around a place (grid space) with a material; 0 is air.
    Fill {
        edited: Edited,
        centre: Vec3,
        material: u8,
    },
    /// Puts back the materials of a box of voxels, both ends inclusive: x, then y, then z.
    PutBack {
        low: IVec3,
        high: IVec3,
        materials: Vec<u8>,
    },
}

impl Stroke {
    /// Edits the voxels.
    pub fn apply(&self, voxels: &mut Voxels) -> Edit {
        match self {
            Self::Fill {
                edited,
                centre,
                material,
            } => edited.fill(*centre, *material, voxels),
            Self::PutBack {
                low,
                high,
                materials,
            } => {
                let size = *high - *low + 1;
                voxels.edit(*low, *high, |voxel, _| {
                    let at = voxel - *low;
                    materials[(at.x + size.x * (at.y + size.y * at.z)) as usize]
                })
            }
        }
    }

    /// The box of voxels that it may change, both ends inclusive.
    fn around(&self) -> (IVec3, IVec3) {
        match self {
            Self::Fill { edited, centre, .. } => edited.around(*centre),
            Self::PutBack { low, high, .. } => (*low, *high),
        }
    }
}

/// Edits the world where the camera looks, always at another place.
pub struct Digging {
    edited: Edited,
    voxels: Voxels,
    origin: IVec3,
    camera: Camera,
    /// Rays tried so far.
    count: u32,
    /// All edits so far.
    strokes: Vec<Stroke>,
    /// Puts back what the last edit has dug.
    undo: Option<Stroke>,
}

impl Digging {
    /// Starts with these voxels of the world, which `camera` sees.
    pub fn new(edited: Edited, world: &World, voxels: &Voxels, camera: &Camera) -> Self {
        Self {
            edited,
            voxels: voxels.clone(),
            origin: world.origin,
            camera: camera.clone(),
            count: 0,
            strokes: Vec::new(),
            undo: None,
        }
    }

    /// Edits the voxels if an edit is due in this frame, and returns what has changed.
    pub fn step(&mut self, frame: u32) -> Option<Edit> {
        self.due(frame).map(|stroke| self.apply(stroke))
    }

    /// The edit that is due in this frame: looking for its place is no part of an edit.
    pub fn due(&mut self, frame: u32) -> Option<Stroke> {
        if !frame.is_multiple_of(INTERVAL) {
            return None;
        }
        self.undo.take().or_else(|| self.next_stroke())
    }

    /// Edits the voxels, and returns what has changed.
    pub fn apply(&mut self, stroke: Stroke) -> Edit {
        let edit = stroke.apply(&mut self.voxels);
        self.strokes.push(stroke);
        edit
    }

    fn next_stroke(&mut self) -> Option<Stroke> {
        let (centre, seen) = self.target()?;
        let edited = self.edited;
        let builds = edited == Edited::Ball && !self.strokes.len().is_multiple_of(2);
        if edited != Edited::Ball {
            self.undo = Some(self.put_back(edited.around(centre)));
        }
        Some(Stroke::Fill {
            edited,
            centre,
            material: if builds { seen } else { 0 },
        })
    }

    /// What puts back the voxels of a box as they are now.
    fn put_back(&self, (low, high): (IVec3, IVec3)) -> Stroke {
        Stroke::PutBack {
            low,
            high,
            materials: voxels_of(low, high)
                .map(|voxel| self.voxels.material(voxel))
                .collect(),
        }
    }

    /// The voxels after all edits so far.
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// Whether these voxels, which have followed the edits, are as edited in and around all edits. Voxels whose bricks have
    /// other numbers cannot follow them.
    pub fn are_followed_by(&self, found: &Voxels) -> bool {
        self.strokes.iter().all(|stroke| {
            let (low, high) = stroke.around();
            voxels_of(low - AROUND, high + AROUND)
                .all(|voxel| found.material(voxel) == self.voxels.material(voxel))
        })
    }

    /// All edits so far, in order.
    pub fn strokes(&self) -> &[Stroke] {
        &self.strokes
    }

    /// Where the next of a fixed sequence of camera rays hits a solid voxel (grid space), and its material.
    fn target(&mut self) -> Option<(Vec3, u8)> {
        /// Rays tried before a camera counts as seeing nothing.
        const TRIES: u32 = 16;
        let basis = self.camera.basis(1.0);
        let origin = basis.origin - self.origin.as_dvec3();
        (0..TRIES).find_map(|_| {
            self.count += 1;
            // R2: the plastic number's additive recurrence covers the picture evenly (Roberts 2018).
            let n = f64::from(self.count);
            let [x, y] =
                [0.754_877_666_246_693, 0.569_840_290_998_053].map(|a| (0.5 + n * a) % 1.0);
            let [x, y] = [x, y].map(|share| 1.2 * (share - 0.5));
            let direction = basis.forward + basis.right * x + basis.up * y;
            let ray = Ray::new(origin, direction.normalize());
            match march(&self.voxels, &ray) {
                Outcome::Hit(hit) => Some((hit.position(&ray).as_vec3(), hit.material)),
                Outcome::Inside(_) | Outcome::Miss => None,
            }
        })
    }
}

/// The voxels of a box, both ends inclusive: x, then y, then z.
fn voxels_of(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    (low.z..=high.z).flat_map(move |z| {
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
    })
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::world::file::{self, Overrides};

    /// A world of 64³ voxels whose lower half is stone, and its voxels.
    fn ground() -> (World, Voxels) {
        let text = "(title: \"\", size: (64, 64, 64), origin: (0, 0, 0),
              shape: Plane(normal: (0, 1, 0), offset: 32),
              cameras: [(name: \"down\", position: (32.5, 56, 32.5), pitch_deg: -60)])";
        let world = file::parse(text, "test.ron", None, &Overrides::default()).expect("sound");
        let mut voxels = Voxels::empty(UVec3::splat(64));
        voxels.fill_box(IVec3::ZERO, IVec3::new(63, 31, 63), 1);
        (world, voxels)
    }

    /// How many voxels differ.
    fn different(a: &Voxels, b: &Voxels) -> usize {
        let all = voxels_of(IVec3::ZERO, IVec3::splat(63));
        all.filter(|voxel| a.material(*voxel) != b.material(*voxel))
            .count()
    }

    /// A reference repeats the strokes on voxels of its own, so they must tell the whole difference.
    #[test]
    fn the_strokes_repeat_all_edits() {
        let (world, before) = ground();
        for edited in [Edited::Ball, Edited::Box, Edited::Crumbs] {
            let mut digging = Digging::new(edited, &world, &before, &world.cameras[0]);
            let edits = (0..90).filter_map(|frame| digging.step(frame)).count();
            assert_eq!([edits, digging.strokes().len()], [9, 9], "{edited:?}");
            let mut repeated = before.clone();
            for stroke in digging.strokes() {
                stroke.apply(&mut repeated);
            }
            assert_eq!(different(digging.voxels(), &repeated), 0, "{edited:?}");
            let dug = different(digging.voxels(), &before);
            assert!(dug > 20, "{edited:?}: {dug}");
            assert!(digging.are_followed_by(&repeated));
            assert!(!digging.are_followed_by(&before), "{edited:?}");
            let (low, _) = digging.strokes()[0].around();
            repeated.set(low - 3, if low.y > 34 { 2 } else { 0 });
            assert!(!digging.are_followed_by(&repeated), "another brick was hit");
        }
    }

    #[test]
    fn boxes_and_crumbs_are_put_back() {
        let (world, before) = ground();
        for (edited, most, least) in [
            (Edited::Box, 32 * 32 * 17, 8000),
            (Edited::Crumbs, 700, 400),
        ] {
            let mut digging = Digging::new(edited, &world, &before, &world.cameras[0]);
            digging.step(0).expect("the camera sees the ground");
            let dug = different(digging.voxels(), &before);
            assert!((least..=most).contains(&dug), "{edited:?}: {dug}");
            digging.step(10).expect("it is put back");
            assert_eq!(different(digging.voxels(), &before), 0, "{edited:?}");
        }
    }

    #[test]
    fn crumbs_are_a_thousand_voxels() {
        let mut voxels = Voxels::empty(UVec3::splat(64));
        let empty = voxels.clone();
        Edited::Crumbs.fill(Vec3::splat(31.5), 1, &mut voxels);
        let crumbs = different(&voxels, &empty);
        assert!((900..1100).contains(&crumbs), "{crumbs}");
    }
}
