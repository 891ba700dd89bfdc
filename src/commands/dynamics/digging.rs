//! Edits like those of a player who digs and builds, the same in every run.

use glam::{IVec3, Vec3};

use crate::{
    reference::march::{Outcome, Ray, march},
    world::{
        Camera, World,
        voxels::{Edit, Voxels},
    },
};

/// Frames between two edits.
const INTERVAL: u32 = 10;
/// Radius of the ball that is dug or built, in voxels.
const RADIUS: f32 = 2.0;

/// Farther from the middle of a ball than its voxels: [`Digging::are_followed_by`] looks at so many on each side.
const AROUND: f32 = 8.0;

/// A ball of voxels that was filled with a material; 0 is air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Grid space.
    centre: Vec3,
    material: u8,
}

impl Ball {
    /// Fills the ball.
    pub fn fill(&self, voxels: &mut Voxels) -> Edit {
        voxels.fill_sphere(self.centre, RADIUS, self.material)
    }
}

/// Edits balls where the camera looks, alternately digging and building, each at another place. As with a
/// player, the world keeps outgrowing its buffers.
pub struct Digging {
    voxels: Voxels,
    origin: IVec3,
    camera: Camera,
    /// Rays tried so far.
    count: u32,
    /// All edits so far.
    balls: Vec<Ball>,
}

impl Digging {
    /// Starts with these voxels of the world, which `camera` sees.
    pub fn new(world: &World, voxels: &Voxels, camera: &Camera) -> Self {
        Self {
            voxels: voxels.clone(),
            origin: world.origin,
            camera: camera.clone(),
            count: 0,
            balls: Vec::new(),
        }
    }

    /// Edits the voxels if an edit is due in this frame, and returns what has changed.
    pub fn step(&mut self, frame: u32) -> Option<Edit> {
        if !frame.is_multiple_of(INTERVAL) {
            return None;
        }
        let (centre, seen) = self.target()?;
        let builds = !self.balls.len().is_multiple_of(2);
        let material = if builds { seen } else { 0 };
        let ball = Ball { centre, material };
        self.balls.push(ball);
        Some(ball.fill(&mut self.voxels))
    }

    /// The voxels after all edits so far.
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// Whether these voxels, which have followed the edits, are as edited in and around all balls. Voxels whose bricks have
    /// other numbers cannot follow them.
    pub fn are_followed_by(&self, found: &Voxels) -> bool {
        self.balls.iter().all(|ball| {
            let low = (ball.centre - AROUND).floor().as_ivec3();
            let edge = 2 * AROUND as i32 + 1;
            (0..edge.pow(3)).all(|index| {
                let step = IVec3::new(index % edge, index / edge % edge, index / edge.pow(2));
                found.material(low + step) == self.voxels.material(low + step)
            })
        })
    }

    /// All edits so far, in order.
    pub fn balls(&self) -> &[Ball] {
        &self.balls
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

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::world::file::{self, Overrides};

    /// A reference repeats the balls on voxels of its own, so they must tell the whole difference.
    #[test]
    fn the_balls_repeat_all_edits() {
        let text = "(title: \"\", size: (32, 32, 32), origin: (0, 0, 0),
              shape: Plane(normal: (0, 1, 0), offset: 16),
              cameras: [(name: \"down\", position: (16.5, 24, 16.5), pitch_deg: -60)])";
        let world = file::parse(text, "test.ron", None, &Overrides::default()).expect("sound");
        let mut before = Voxels::empty(UVec3::splat(32));
        before.fill_box(IVec3::ZERO, IVec3::new(31, 15, 31), 1);
        let mut digging = Digging::new(&world, &before, &world.cameras[0]);
        let edits = (0..100).filter_map(|frame| digging.step(frame)).count();
        assert_eq!([edits, digging.balls().len()], [10, 10]);
        let mut repeated = before.clone();
        for ball in digging.balls() {
            ball.fill(&mut repeated);
        }
        let cells = (0..32 * 32 * 32).map(|i| IVec3::new(i % 32, i / 32 % 32, i / 1024));
        let (mut dug, mut different) = (0, 0);
        for cell in cells {
            let now = digging.voxels().material(cell);
            different += usize::from(now != repeated.material(cell));
            dug += usize::from(now != before.material(cell));
        }
        assert_eq!(different, 0);
        assert!(dug > 20, "{dug}");
        assert!(digging.are_followed_by(&repeated));
        assert!(!digging.are_followed_by(&before));
        repeated.set(digging.balls[0].centre.as_ivec3() + 5, 2);
        assert!(!digging.are_followed_by(&repeated), "another brick was hit");
    }
}
