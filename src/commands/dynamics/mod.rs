//! How steady the picture of a scene at rest is, and how fast light follows a change.

mod digging;
mod edits;

use serde::{Deserialize, Serialize};

pub use self::digging::{Digging, Edited, Stroke};
use self::edits::{Opening, moved_lamp};
use super::{Failure, frame_loop::FrameLoop, test_case::TestCase};
use crate::{
    lights::Lights,
    measure::{
        picture::Picture,
        response::{Change, Response, response},
        stability::{Stability, StabilityMeter},
    },
    world::{Camera, View},
};

/// Frames per second of world time, wherever things move.
pub const RATE: f64 = 60.0;
/// Speed of a camera that flies (metres per second).
pub const FLIGHT_SPEED: f32 = 10.0;
/// Speed of a camera that turns (degrees per second).
pub const TURN_DEG: f32 = 90.0;
/// Pictures over which stability is measured, as in the source's table 4.4.
pub const STILL_FRAMES: u32 = 50;
/// Frames that are watched after a change. At a hysteresis of 0.97 one bounce takes 151 to 99 %.
pub const WATCHED_FRAMES: u32 = 256;
/// Longest edge of the pictures that a response is measured in: indirect light is smooth, and probes do not
/// depend on the picture.
const RESPONSE_EDGE: u32 = 160;
/// Paths per pixel of the references that say where light rises and falls.
const RESPONSE_PATHS: u32 = 256;

/// Measures the next pictures in the current view of the frame loop. The probes must have settled.
pub fn stability(
    frame_loop: &mut FrameLoop<'_>,
    lights: &Lights,
    after: &dyn Fn(),
) -> Result<Stability, Failure> {
    let mut meter = StabilityMeter::new();
    for _ in 0..STILL_FRAMES {
        frame_loop.advance(lights, 1, after)?;
        meter.add(frame_loop.display()?).map_err(Failure::fault)?;
    }
    Ok(meter.result().expect("more than one picture was measured"))
}

/// Frames until light has followed each change; `None` where the world has no place for the change, or where
/// the camera hardly sees its indirect light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

    /// Most frames that [`responses`] takes, for progress.
    pub fn frames(settling: u32, watched: u32) -> u64 {
        5 * u64::from(settling + 1 + watched)
    }
}

/// For each change: settles, makes the change, and watches the indirect light that `camera` sees. A lamp is
/// switched on and off, and moved; a wall is opened and closed. The world may name them
/// ([`crate::world::ResponseSpec`]). The defaults are: the first lamp (or the sun, where there is no lamp);
/// half of the free distance towards the camera, at most eight voxels; a sphere of radius 3 where the camera's
/// central ray hits. Afterwards the world is restored, but the frame loop has another size and view.
pub fn responses(
    frame_loop: &mut FrameLoop<'_>,
    case: &TestCase,
    camera: &Camera,
    [settling, watched]: [u32; 2],
    after: &dyn Fn(),
) -> Result<Responses, Failure> {
    let (world, lights) = (&case.world, &case.lights);
    frame_loop.look(camera, View::Indirect);
    frame_loop.resize(response_size(frame_loop.shot().size))?;
    let before = frame_loop.voxels()?;
    let mut watch = Watch {
        frame_loop,
        settling,
        watched,
        after,
    };
    let mut all = Responses::default();
    let named = case.named_lamp;
    let switched = named.unwrap_or(0);
    if switched < lights.lamps.len() {
        let mut dark = lights.clone();
        dark.lamps[switched] = dark.lamps[switched].dark();
        all.lamp_on = watch.lights(&dark, lights)?;
        all.lamp_off = watch.lights(lights, &dark)?;
    }
    if let Some(moved) = moved_lamp(&before, world, lights, named, camera) {
        all.lamp_moved = watch.lights(lights, &moved)?;
    }
    if let Some(opening) = Opening::of(&before, world, camera) {
        let mut voxels = before.clone();
        let shut = opening.shut(&mut voxels, &before);
        watch.frame_loop.apply(&voxels, &shut)?;
        let cut = opening.open(&mut voxels);
        let opened = |frame_loop: &mut FrameLoop<'_>| frame_loop.apply(&voxels, &cut);
        all.wall_opened = watch.change(lights, lights, opened)?;
        // The wall is still open.
        let fill = opening.shut(&mut voxels, &before);
        let closed = |frame_loop: &mut FrameLoop<'_>| frame_loop.apply(&voxels, &fill);
        all.wall_closed = watch.change(lights, lights, closed)?;
        let restored = opening.restore(&mut voxels, &before);
        watch.frame_loop.apply(&voxels, &restored)?;
    }
    Ok(all)
}

/// One change after another, each on fresh probes.
struct Watch<'a, 'b> {
    frame_loop: &'a mut FrameLoop<'b>,
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
        edit: impl FnOnce(&mut FrameLoop<'_>) -> Result<(), Failure>,
    ) -> Result<Option<Response>, Failure> {
        self.frame_loop.forget()?;
        self.frame_loop
            .advance(before, self.settling + 1, self.after)?;
        let start = self.frame_loop.radiance()?;
        let reference = self.frame_loop.reference(before, RESPONSE_PATHS)?;
        edit(self.frame_loop)?;
        let references = [reference, self.frame_loop.reference(then, RESPONSE_PATHS)?];
        let mut pictures: Vec<Picture> = Vec::new();
        for _ in 0..self.watched {
            self.frame_loop.advance(then, 1, self.after)?;
            pictures.push(self.frame_loop.radiance()?);
        }
        let change = Change {
            before: &references[0],
            after: &references[1],
        };
        response(change, &start, &pictures).map_err(Failure::fault)
    }
}

/// The same aspect, with a longest edge of at most [`RESPONSE_EDGE`].
fn response_size([width, height]: [u32; 2]) -> [u32; 2] {
    let longest = width.max(height);
    if longest <= RESPONSE_EDGE {
        return [width, height];
    }
    [width, height].map(|edge| (edge * RESPONSE_EDGE / longest).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pictures_keep_their_size_and_large_ones_their_shape() {
        assert_eq!(response_size([64, 36]), [64, 36]);
        assert_eq!(response_size([1280, 720]), [160, 90]);
        assert_eq!(response_size([10, 4000]), [1, 160]);
    }
}
