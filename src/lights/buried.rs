//! Lamps that pass through stone: however slowly they move, their light comes and goes all at once.

use glam::{DVec3, IVec3};

use super::{LampShape, LampState, Lights, rest::is_same_place};
use crate::world::voxels::SolidVoxels;

/// A lamp this near to a face (voxels) may touch it.
const TOUCHING: f64 = 1e-3;

/// Which lamps are inside of solid voxels.
#[derive(Clone, Debug, Default)]
pub struct BuriedLamps {
    /// Each lamp in the frame before, and whether it was buried.
    lamps: Vec<(LampState, bool)>,
}

/// How lamps that leave or enter stone change the light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Burials {
    /// The share of the light of all lamps that comes or goes in this frame, 0 to 1.
    pub change: f32,
    /// Whether there are lamps, and none gives light.
    pub are_total: bool,
}

impl BuriedLamps {
    /// Forgets all lamps.
    pub fn forget(&mut self) {
        self.lamps.clear();
    }

    /// Looks at the lamps of a frame. `origin` is the world position of the grid. What is known of a lamp holds until it moves:
    /// forget all after an edit.
    pub fn follow(&mut self, lights: &Lights, solid: &SolidVoxels, origin: IVec3) -> Burials {
        let (mut changed, mut all, mut shines) = (0.0, 0.0, false);
        self.lamps.truncate(lights.lamps.len());
        for (number, lamp) in lights.lamps.iter().enumerate() {
            let before = self.lamps.get(number).copied();
            let buried = match before {
                Some((before, buried)) if is_same_place(lamp, &before) => buried,
                _ => is_buried(lamp, solid, origin),
            };
            let power = lamp.intensity.element_sum();
            if lamp.shape != LampShape::Directional {
                all += power;
            }
            if before.is_some_and(|(_, before)| before != buried) {
                changed += power;
            }
            shines |= power > 0.0 && !buried;
            match self.lamps.get_mut(number) {
                Some(known) => *known = (*lamp, buried),
                None => self.lamps.push((*lamp, buried)),
            }
        }
        if all == 0.0 {
            return Burials::default();
        }
        Burials {
            change: (changed / all) as f32,
            are_total: !shines,
        }
    }
}

/// Whether a lamp is inside of solid voxels: its middle, and the corners of a cube around all of it. One that touches a face lights
/// what is before the face, so the cube of a lamp without a size reaches across borders of voxels.
fn is_buried(lamp: &LampState, solid: &SolidVoxels, origin: IVec3) -> bool {
    if lamp.shape == LampShape::Directional {
        return false;
    }
    let at = lamp.position_ws - origin.as_dvec3();
    let reach = lamp.soft_radius.max(TOUCHING);
    let is_in_stone = |at: DVec3| solid.is_solid(at.floor().as_ivec3());
    let corner = |number: u32| {
        let side = |axis: u32| f64::from(number >> axis & 1) * 2.0 - 1.0;
        at + reach * DVec3::new(side(0), side(1), side(2))
    };
    is_in_stone(at) && (0..8).all(|number| is_in_stone(corner(number)))
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::world::voxels::Voxels;

    /// A wall from x = 4 to 6 of a world that begins at x = −2.
    fn wall() -> SolidVoxels {
        let mut voxels = Voxels::empty(UVec3::new(16, 4, 4));
        voxels.fill_box(IVec3::new(6, 0, 0), IVec3::new(7, 3, 3), 1);
        SolidVoxels::of(&voxels)
    }

    const ORIGIN: IVec3 = IVec3::new(-2, 0, 0);

    /// `lights` at a height and depth inside of the wall.
    fn lights(lamps: &[(f64, f64)]) -> Lights {
        let mut lights = super::super::rest::tests::lights(lamps);
        for lamp in &mut lights.lamps {
            lamp.position_ws += DVec3::new(0.0, 1.5, 2.5);
        }
        lights
    }

    #[test]
    fn a_lamp_that_touches_a_wall_is_not_in_it() {
        let wall = wall();
        let is_total = |at: DVec3| {
            let mut one = lights(&[(0.0, 1.0)]);
            one.lamps[0].position_ws = at;
            let found = BuriedLamps::default().follow(&one, &wall, ORIGIN);
            found.are_total
        };
        assert!(is_total(DVec3::new(4.5, 1.5, 2.5)));
        assert!(is_total(DVec3::new(5.0, 2.0, 2.0)), "between its voxels");
        for touching in [
            DVec3::new(4.0, 1.5, 2.5),
            DVec3::new(6.0, 1.5, 2.5),
            DVec3::new(4.5, 0.0, 2.5),
            DVec3::new(4.0, 0.0, 4.0),
        ] {
            assert!(!is_total(touching), "{touching}");
        }
    }

    #[test]
    fn a_lamp_counts_where_it_enters_and_leaves_stone() {
        let wall = wall();
        let mut buried = BuriedLamps::default();
        let at = |x: f64| lights(&[(x, 3.0), (0.5, 1.0)]);
        let ways = [3.0, 3.9, 4.1, 5.0, 5.9, 6.1, 7.0];
        let found = ways.map(|x| buried.follow(&at(x), &wall, ORIGIN));
        let changes = found.map(|found| found.change);
        assert_eq!(changes, [0.0, 0.0, 0.75, 0.0, 0.0, 0.75, 0.0]);
        assert!(found.iter().all(|found| !found.are_total));
        let alone = [3.9, 4.1, 6.1].map(|x| {
            let found = buried.follow(&lights(&[(x, 3.0), (0.5, 0.0)]), &wall, ORIGIN);
            found.are_total
        });
        assert_eq!(alone, [false, true, false]);
    }

    #[test]
    fn neither_the_first_frame_nor_a_lamp_that_comes_counts() {
        let wall = wall();
        let mut buried = BuriedLamps::default();
        let mut change = |lamps: &[(f64, f64)]| buried.follow(&lights(lamps), &wall, ORIGIN).change;
        assert_eq!(change(&[(5.0, 1.0)]), 0.0);
        assert_eq!(change(&[(5.0, 1.0), (4.5, 1.0)]), 0.0);
        assert_eq!(change(&[]), 0.0);
        assert_eq!(change(&[(3.0, 1.0)]), 0.0);
        buried.forget();
        assert_eq!(
            buried.follow(&lights(&[(5.0, 1.0)]), &wall, ORIGIN).change,
            0.0
        );
    }

    #[test]
    fn a_sphere_shines_until_all_of_it_is_in_stone() {
        let mut voxels = Voxels::empty(UVec3::splat(32));
        voxels.fill_box(IVec3::new(8, 0, 0), IVec3::new(31, 31, 31), 1);
        let solid = SolidVoxels::of(&voxels);
        let mut buried = BuriedLamps::default();
        let mut at = |x: f64| {
            let mut one = lights(&[(0.0, 1.0)]);
            one.lamps[0].position_ws = DVec3::new(x, 16.0, 16.0);
            one.lamps[0].soft_radius = 2.0;
            buried.follow(&one, &solid, IVec3::ZERO).change
        };
        assert_eq!(
            [7.0, 8.5, 9.9, 10.1, 12.0].map(&mut at),
            [0.0, 0.0, 0.0, 1.0, 0.0]
        );
    }
}
