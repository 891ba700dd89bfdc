//! Which lamp is moved where, and which wall is opened: as the world names them, or as found in front of the
//! camera.

use glam::{DVec3, IVec3, Vec3};

use crate::{
    lights::{LampShape, LampState, Lights},
    reference::march::{Outcome, Ray, march},
    world::{
        Camera, Wall, World,
        voxels::{Edit, Voxels},
    },
};

/// Radius in voxels of the hole that is cut where the world names no wall.
const HOLE_RADIUS: f32 = 3.0;
/// Longest move of a lamp where the world names no place, in voxels.
const LAMP_STEP: f64 = 8.0;

/// The lights with one lamp moved: the named one, or the first that has a position. It moves to the place that
/// the world names, or half of the free distance towards the camera.
pub fn moved_lamp(
    voxels: &Voxels,
    world: &World,
    lights: &Lights,
    named: Option<usize>,
    camera: &Camera,
) -> Option<Lights> {
    let placed = |lamp: &LampState| lamp.shape != LampShape::Directional;
    let named = named.filter(|&index| lights.lamps.get(index).is_some_and(placed));
    let index = named.or_else(|| lights.lamps.iter().position(placed))?;
    let mut moved = lights.clone();
    let lamp = &mut moved.lamps[index];
    if let Some(place) = world.response.lamp_to {
        lamp.position_ws = place.as_dvec3();
        return Some(moved);
    }
    let offset = camera.position.as_dvec3() - lamp.position_ws;
    let way = offset.length();
    let towards = offset.try_normalize()?;
    let origin = lamp.position_ws - world.origin.as_dvec3();
    let free = match march(voxels, &Ray::new(origin, towards)) {
        Outcome::Inside(_) => return None,
        Outcome::Hit(hit) => hit.distance.min(way),
        Outcome::Miss => way,
    };
    lamp.position_ws += towards * (free / 2.0).min(LAMP_STEP);
    Some(moved)
}

/// Voxels (grid space) that are opened and closed.
pub enum Opening {
    /// A box of one material, both ends inclusive.
    Named {
        min: IVec3,
        max: IVec3,
        material: u8,
    },
    /// A hole around a centre, in whatever is solid there.
    Hole(Vec3),
}

impl Opening {
    /// The world's wall, or a hole where the central ray of a camera hits a solid voxel.
    pub fn of(voxels: &Voxels, world: &World, camera: &Camera) -> Option<Self> {
        if let Some(Wall { min, max, material }) = world.response.wall {
            return Some(Self::Named {
                min: min - world.origin,
                max: max - world.origin,
                material,
            });
        }
        let basis = camera.basis(1.0);
        let origin: DVec3 = basis.origin - world.origin.as_dvec3();
        let ray = Ray::new(origin, basis.forward);
        match march(voxels, &ray) {
            Outcome::Hit(hit) => Some(Self::Hole(hit.position(&ray).as_vec3())),
            Outcome::Inside(_) | Outcome::Miss => None,
        }
    }

    /// Removes the voxels, so that light passes.
    pub fn open(&self, voxels: &mut Voxels) -> Edit {
        match *self {
            Self::Named { min, max, .. } => voxels.fill_box(min, max, 0),
            Self::Hole(centre) => voxels.fill_sphere(centre, HOLE_RADIUS, 0),
        }
    }

    /// Fills the voxels, so that no light passes; a hole is filled as it was `before`.
    pub fn shut(&self, voxels: &mut Voxels, before: &Voxels) -> Edit {
        match *self {
            Self::Named { min, max, material } => voxels.fill_box(min, max, material),
            Self::Hole(_) => self.restore(voxels, before),
        }
    }

    /// Restores the voxels as they were `before`.
    pub fn restore(&self, voxels: &mut Voxels, before: &Voxels) -> Edit {
        let (min, max) = self.bounds();
        voxels.edit(min, max, |voxel, _| before.material(voxel))
    }

    /// The bounding box, both ends inclusive.
    fn bounds(&self) -> (IVec3, IVec3) {
        match *self {
            Self::Named { min, max, .. } => (min, max),
            Self::Hole(centre) => {
                let reach = Vec3::splat(HOLE_RADIUS);
                (
                    (centre - reach).floor().as_ivec3(),
                    (centre + reach).floor().as_ivec3(),
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::world::file::{self, Overrides};

    fn world(response: &str) -> World {
        let text = format!(
            "(title: \"\", size: (32, 32, 32), origin: (-8, 0, 0), shape: Plane(normal: (0, 1, 0), offset: 16),
              materials: {{\"stone\": (a: Flat(1, 1, 1)), \"brick\": (a: Flat(1, 0, 0))}},
              lamps: [(name: \"two\", lamps: [
                (name: \"a\", position: (1, 20, 16), power: 1), (name: \"b\", position: (9, 20, 16), power: 1),
              ])],
              sun: (towards: (0, 1, 0), irradiance: (1, 1, 1)),
              cameras: [(name: \"down\", position: (8.5, 24, 16.5), pitch_deg: -90)],
              {response})"
        );
        file::parse(&text, "test.ron", None, &Overrides::default()).expect("sound")
    }

    /// Solid voxels in the lower half of the world, in patches.
    fn rock() -> Voxels {
        let mut voxels = Voxels::empty(UVec3::splat(32));
        voxels.fill_box(IVec3::ZERO, IVec3::new(31, 15, 31), 1);
        voxels.fill_box(IVec3::new(3, 3, 3), IVec3::new(20, 9, 20), 2);
        voxels
    }

    fn solid(voxels: &Voxels) -> Vec<(IVec3, u8)> {
        let edge = || 0..32;
        edge()
            .flat_map(|z| edge().flat_map(move |y| edge().map(move |x| IVec3::new(x, y, z))))
            .map(|voxel| (voxel, voxels.material(voxel)))
            .collect()
    }

    #[test]
    fn openings_open_shut_and_leave_the_world_as_it_was() {
        let before = rock();
        let named = Opening::Named {
            min: IVec3::new(2, 8, 2),
            max: IVec3::new(6, 18, 4),
            material: 3,
        };
        let hole = Opening::Hole(Vec3::new(15.2, 9.0, 20.7));
        for (opening, filled) in [(named, 3), (hole, 2)] {
            let (min, max) = opening.bounds();
            let inside = |voxel: IVec3| voxel.cmpge(min).all() && voxel.cmple(max).all();
            let mut voxels = before.clone();
            opening.shut(&mut voxels, &before);
            assert_eq!(voxels.material(min), filled);
            let shut = solid(&voxels);
            opening.open(&mut voxels);
            let open = solid(&voxels);
            let mut cut = 0;
            for ((voxel, was), (_, is)) in shut.iter().zip(&open) {
                assert!(was == is || (inside(*voxel) && *is == 0), "{voxel}");
                cut += usize::from(was != is);
            }
            assert!(cut > 80, "{cut}");
            opening.shut(&mut voxels, &before);
            assert_eq!(solid(&voxels), shut);
            opening.restore(&mut voxels, &before);
            assert_eq!(solid(&voxels), solid(&before));
        }
    }

    #[test]
    fn what_the_world_names_is_taken_and_what_it_does_not_is_found() {
        let (voxels, silent) = (rock(), world(""));
        let camera = &silent.cameras[0];
        match Opening::of(&voxels, &silent, camera) {
            // World (8.5, 16, 16.5), which lies 8 further along x in the grid.
            Some(Opening::Hole(centre)) => {
                assert!(
                    centre.distance(Vec3::new(16.5, 16.0, 16.5)) < 1e-3,
                    "{centre}"
                );
            }
            _ => panic!("the camera looks at solid voxels"),
        }
        let wall = "wall: (min: (-8, 14, 0), max: (-6, 17, 1), material: \"brick\")";
        let telling = world(&format!(
            "response: (lamp: \"b\", lamp_to: (4, 30, 5), {wall})"
        ));
        match Opening::of(&voxels, &telling, camera) {
            Some(Opening::Named { min, max, material }) => {
                assert_eq!([min, max], [IVec3::new(0, 14, 0), IVec3::new(2, 17, 1)]);
                assert_eq!(material, 2);
            }
            _ => panic!("the world names a wall"),
        }

        let lights = |world: &World| Lights::at(world, &world.lamp_presets[0], 0.0);
        let places = |world: &World, named| {
            let moved = moved_lamp(&voxels, world, &lights(world), named, camera);
            let moved = moved.expect("there are lamps");
            let before = lights(world).lamps;
            let each = moved.lamps.iter().zip(&before);
            let far = each.map(|(now, then)| now.position_ws.distance(then.position_ws));
            (moved.clone(), far.map(|far| far > 0.5).collect::<Vec<_>>())
        };
        assert_eq!(places(&silent, None).1, [true, false, false]);
        assert_eq!(places(&silent, Some(1)).1, [false, true, false]);
        // The sun has no position: another lamp moves.
        assert_eq!(places(&silent, Some(2)).1, [true, false, false]);
        let (moved, which) = places(&telling, Some(1));
        assert_eq!(which, [false, true, false]);
        assert_eq!(moved.lamps[1].position_ws, DVec3::new(4.0, 30.0, 5.0));
    }
}
