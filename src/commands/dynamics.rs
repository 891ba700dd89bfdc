//! How still a still scene is, and how soon light follows a change.

use glam::{DVec3, IVec3, Vec3};
use serde::Serialize;

use super::{Failure, driver::Driver};
use crate::{
    lights::{LampShape, LampState, Lights},
    measure::{
        picture::Picture,
        response::{Response, response},
        stability::{Stability, StabilityMeter},
    },
    passes::ViewMode,
    reference::march::{Outcome, Ray, march},
    world::{Camera, World, voxels::Voxels},
};

/// Pictures of a still scene that stability is measured on, as in the source's table 4.4.
pub const STILL_FRAMES: u32 = 50;
/// Frames that are watched after a change. At a hysteresis of 0.97 one bounce takes 151 to 99 %.
pub const WATCHED_FRAMES: u32 = 256;
/// Longest edge of the pictures that a response is read from: indirect light is smooth, and probes do
/// not depend on the picture.
const RESPONSE_EDGE: u32 = 160;
/// Radius in voxels of the hole that opens a wall.
const HOLE_RADIUS: f32 = 3.0;
/// Farthest that a lamp is moved, in voxels.
const LAMP_STEP: f64 = 8.0;

/// Measures the pictures that follow, in the view that the driver shows; the probes have settled.
pub fn stability(
    driver: &mut Driver<'_>,
    lights: &Lights,
    after: &dyn Fn(),
) -> Result<Stability, Failure> {
    let mut meter = StabilityMeter::new();
    for _ in 0..STILL_FRAMES {
        driver.advance(lights, 1, after)?;
        meter.add(driver.display()?).map_err(Failure::fault)?;
    }
    Ok(meter.result().expect("more than one picture was measured"))
}

/// Frames to follow each change; `None` for one that the world has no place for, or whose indirect
/// light the camera hardly sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Responses {
    pub lamp_on: Option<Response>,
    pub lamp_off: Option<Response>,
    pub lamp_moved: Option<Response>,
    pub wall_opened: Option<Response>,
    pub wall_closed: Option<Response>,
}

impl Responses {
    pub const NAMES: [&'static str; 5] = [
        "lamp_on",
        "lamp_off",
        "lamp_moved",
        "wall_opened",
        "wall_closed",
    ];

    /// In the order of [`Self::NAMES`].
    pub fn all(&self) -> [Option<Response>; 5] {
        [
            self.lamp_on,
            self.lamp_off,
            self.lamp_moved,
            self.wall_opened,
            self.wall_closed,
        ]
    }

    /// Frames that [`responses`] takes at most, for progress.
    pub fn frames(settling: u32, watched: u32) -> u64 {
        5 * u64::from(settling + 1 + watched)
    }
}

/// Settles, changes, and watches the indirect light that `camera` sees, once for each change:
/// the first lamp (or the sun, where there is no lamp) is switched on and off; the first lamp with a
/// place moves half of the free way towards the camera, at most eight voxels; a sphere of radius 3 is cut
/// out where the camera's central ray hits, and filled again. Leaves the world as it was, and the
/// driver at another size and view.
pub fn responses(
    driver: &mut Driver<'_>,
    world: &World,
    lights: &Lights,
    camera: &Camera,
    [settling, watched]: [u32; 2],
    after: &dyn Fn(),
) -> Result<Responses, Failure> {
    driver.look(camera, ViewMode::Indirect);
    driver.resize(response_size(driver.view().size))?;
    let closed = driver.voxels()?;
    let mut watch = Watch {
        driver,
        settling,
        watched,
        after,
    };
    let mut all = Responses::default();
    if !lights.lamps.is_empty() {
        let mut dark = lights.clone();
        dark.lamps.remove(0);
        all.lamp_on = watch.lights(&dark, lights)?;
        all.lamp_off = watch.lights(lights, &dark)?;
    }
    if let Some(moved) = moved_lamp(&closed, world, lights, camera) {
        all.lamp_moved = watch.lights(lights, &moved)?;
    }
    if let Some(centre) = wall_ahead(&closed, world, camera) {
        let mut open = closed.clone();
        let cut = open.fill_sphere(centre, HOLE_RADIUS, 0);
        let opening = |driver: &mut Driver<'_>| driver.apply(&open, &cut);
        all.wall_opened = watch.change(lights, lights, opening)?;
        // The hole is still there.
        let (min, max) = hole(centre);
        let mut filled = open.clone();
        let fill = filled.edit(min, max, |voxel, _| closed.material(voxel));
        let closing = |driver: &mut Driver<'_>| driver.apply(&filled, &fill);
        all.wall_closed = watch.change(lights, lights, closing)?;
    }
    Ok(all)
}

/// One change after another, each on fresh probes.
struct Watch<'a, 'b> {
    driver: &'a mut Driver<'b>,
    settling: u32,
    watched: u32,
    after: &'a dyn Fn(),
}

impl Watch<'_, '_> {
    fn lights(&mut self, before: &Lights, then: &Lights) -> Result<Option<Response>, Failure> {
        self.change(before, then, |_| Ok(()))
    }

    fn change(
        &mut self,
        before: &Lights,
        then: &Lights,
        edit: impl FnOnce(&mut Driver<'_>) -> Result<(), Failure>,
    ) -> Result<Option<Response>, Failure> {
        self.driver.forget()?;
        self.driver.advance(before, self.settling + 1, self.after)?;
        let start = self.driver.radiance()?;
        edit(self.driver)?;
        let mut pictures: Vec<Picture> = Vec::new();
        for _ in 0..self.watched {
            self.driver.advance(then, 1, self.after)?;
            pictures.push(self.driver.radiance()?);
        }
        response(&start, &pictures).map_err(Failure::fault)
    }
}

/// Of the same aspect, with a longest edge of [`RESPONSE_EDGE`] at most.
fn response_size([width, height]: [u32; 2]) -> [u32; 2] {
    let longest = width.max(height);
    if longest <= RESPONSE_EDGE {
        return [width, height];
    }
    [width, height].map(|edge| (edge * RESPONSE_EDGE / longest).max(1))
}

fn moved_lamp(voxels: &Voxels, world: &World, lights: &Lights, camera: &Camera) -> Option<Lights> {
    let placed = |lamp: &LampState| lamp.shape != LampShape::Directional;
    let index = lights.lamps.iter().position(placed)?;
    let mut moved = lights.clone();
    let lamp = &mut moved.lamps[index];
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

/// Where the central ray of a camera meets stone, in grid space.
fn wall_ahead(voxels: &Voxels, world: &World, camera: &Camera) -> Option<Vec3> {
    let basis = camera.basis(1.0);
    let origin: DVec3 = basis.origin - world.origin.as_dvec3();
    let ray = Ray::new(origin, basis.forward);
    match march(voxels, &ray) {
        Outcome::Hit(hit) => Some(hit.position(&ray).as_vec3()),
        Outcome::Inside(_) | Outcome::Miss => None,
    }
}

/// The box around the hole, both ends inclusive.
fn hole(centre: Vec3) -> (IVec3, IVec3) {
    let reach = Vec3::splat(HOLE_RADIUS);
    (
        (centre - reach).floor().as_ivec3(),
        (centre + reach).floor().as_ivec3(),
    )
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    #[test]
    fn small_pictures_keep_their_size_and_large_ones_their_shape() {
        assert_eq!(response_size([64, 36]), [64, 36]);
        assert_eq!(response_size([1280, 720]), [160, 90]);
        assert_eq!(response_size([10, 4000]), [1, 160]);
    }

    #[test]
    fn a_hole_lies_within_its_box() {
        let mut voxels = Voxels::empty(UVec3::splat(32));
        voxels.fill_box(IVec3::ZERO, IVec3::splat(31), 1);
        let centre = Vec3::new(15.2, 9.0, 20.7);
        let (min, max) = hole(centre);
        let mut open = voxels.clone();
        open.fill_sphere(centre, HOLE_RADIUS, 0);
        let mut changed = 0;
        for (x, y, z) in
            (0..32).flat_map(|x| (0..32).flat_map(move |y| (0..32).map(move |z| (x, y, z))))
        {
            let voxel = IVec3::new(x, y, z);
            if open.material(voxel) != 1 {
                changed += 1;
                assert!(voxel.cmpge(min).all() && voxel.cmple(max).all());
            }
        }
        assert!(changed > 80, "{changed}");
    }
}
