//! Temporal anti-aliasing of a frame, and the upscaling that uses its history: how many pixels are rendered, where camera
//! rays go through them, and how long pictures are averaged.

use super::{Frame, FrameError, values::Drawn};
use crate::{
    gpu::{Gpu, Recorder},
    lights::Lights,
    parameters::{Antialias, PictureParameters, SCALES},
    passes::view::{Inspection, Shot, antialias::GpuHistory},
    world::Camera,
};

/// Most frames that a pixel averages while anything changes. More is smoother; less follows sooner.
const MOST_MOVING: u32 = 16;
/// Most rays that a pixel averages in a world at rest. With more of them the noise of rounding to f16 would outweigh what
/// they add.
const MOST_STILL: u32 = 64;
/// Frames after a change in which history is still clipped: light follows a change for some frames.
const CLIPPED_FRAMES: u32 = 16;
/// Width over which a ray averages textures, in pixels, while few frames are averaged: a bias of −1 level of detail, as
/// is usual for temporal anti-aliasing (Karis 2014).
const MOVING_TEXTURE_PIXELS: f32 = 0.5;
/// The same in a world at rest: many jittered rays average textures over the pixel exactly. A mip level averages over a
/// square, and so blurs surfaces that are seen at a slant.
const STILL_TEXTURE_PIXELS: f32 = 0.0;

/// How pictures are smoothed, and how many of their pixels are rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothing {
    pub antialias: Antialias,
    /// Edge length of the rendered picture over that of the shown one, in [`SCALES`]. Below 1 the history fills the shown
    /// picture; without anti-aliasing neighbours do.
    pub scale: f32,
}

impl Default for Smoothing {
    fn default() -> Self {
        Antialias::Off.into()
    }
}

impl From<Antialias> for Smoothing {
    fn from(antialias: Antialias) -> Self {
        Self {
            antialias,
            scale: 1.0,
        }
    }
}

impl From<&PictureParameters> for Smoothing {
    fn from(parameters: &PictureParameters) -> Self {
        let PictureParameters {
            antialias, scale, ..
        } = *parameters;
        Self { antialias, scale }
    }
}

impl Smoothing {
    /// Whether pictures are shown as they are shaded.
    pub fn is_plain(self) -> bool {
        self.antialias == Antialias::Off && self.scale >= 1.0
    }

    /// Which passes draw the pictures: those of another scale below 1 are the same.
    fn passes(self) -> (bool, bool) {
        (self.is_plain(), self.scale < 1.0)
    }
}

/// A size times a scale, in whole pixels and never nothing.
pub fn scaled(size: [u32; 2], scale: f32) -> [u32; 2] {
    size.map(|edge| ((edge as f32 * scale).round() as u32).max(1))
}

/// Rendered pixels per shown pixel: the mean number of rays of a shown pixel in a frame.
fn rays_per_pixel(shown: [u32; 2], rendered: [u32; 2]) -> f32 {
    let ratio = |axis: usize| rendered[axis] as f32 / shown[axis] as f32;
    ratio(0) * ratio(1)
}

/// What the pictures so far have shown.
#[derive(Default)]
pub(super) struct Antialiasing {
    pub wanted: Smoothing,
    /// Pictures since the history began.
    pictures: u32,
    /// Frames since the camera, the lights or the voxels changed, or the probes were still warming up.
    still: u32,
    /// What the last picture showed; `None` where there is no history.
    before: Option<(Shot, Option<Lights>)>,
    /// Bits that stand still have changed since.
    bits_changed: bool,
    /// Bodies have moved since.
    bodies_moved: bool,
    /// First and last voxel (grid space) of the box that was edited since.
    edited: Option<([u32; 3], [u32; 3])>,
}

/// How the next picture is drawn.
pub(super) struct Jittered {
    /// Width and height in pixels of what is rendered.
    pub size: [u32; 2],
    /// Where camera rays go through their pixels: pixels from the centre.
    pub jitter: [f64; 2],
    /// Width over which rays average textures, in pixels.
    pub texture_pixels: f32,
    /// Its number among those that are averaged, from 1 on; 0 if it stands alone.
    pub picture: u32,
    /// Index of the picture that is written.
    pub which: usize,
    pub history: GpuHistory,
}

impl Antialiasing {
    /// Forgets all pictures: the next sequence is the same as that of a new frame.
    pub fn restart(&mut self) {
        *self = Self {
            wanted: self.wanted,
            ..Self::default()
        };
    }

    /// Remembers that the voxels of this box (grid space) were edited.
    pub fn edit(&mut self, first: [u32; 3], last: [u32; 3]) {
        let (low, high) = self.edited.unwrap_or((first, last));
        self.edited = Some((
            std::array::from_fn(|axis| low[axis].min(first[axis])),
            std::array::from_fn(|axis| high[axis].max(last[axis])),
        ));
    }

    /// Remembers that bits which stand still came, went or changed.
    pub fn change_bits(&mut self) {
        self.bits_changed = true;
    }

    /// Remembers that bodies moved.
    pub fn move_bodies(&mut self) {
        self.bodies_moved = true;
    }

    /// The next picture; `None` if it is shown as it is shaded. Views of data are exact at the centres of pixels, and so
    /// are probes that are drawn over a picture. `lights`: `None` if the light is that of the last picture. `is_warming`: the
    /// probes are new, and their light still rises.
    pub fn next(
        &mut self,
        shot: &Shot,
        inspected: &Inspection,
        lights: Option<&Lights>,
        is_warming: bool,
    ) -> Option<Jittered> {
        let has_marks = inspected.probes.is_some() || inspected.atlas.is_some();
        if self.wanted.is_plain() || shot.view.is_data() || has_marks {
            self.restart();
            return None;
        }
        let size = scaled(shot.size, self.wanted.scale);
        let rays = rays_per_pixel(shot.size, size);
        if self.wanted.antialias == Antialias::Off {
            self.restart();
            return Some(Jittered::without_history(shot, size));
        }
        let shows_same = |(before, _): &(Shot, _)| shows_same(before, shot);
        let before = self.before.take().filter(shows_same);
        let edited = self.edited.take();
        let same_bits = !std::mem::take(&mut self.bits_changed);
        let bodies_moved = std::mem::take(&mut self.bodies_moved);
        let is_still = !is_warming
            && !bodies_moved
            && same_bits
            && edited.is_none()
            && before.as_ref().is_some_and(|(before, lights_before)| {
                let is_lit_alike = lights.is_none() || lights == lights_before.as_ref();
                before.camera == shot.camera && is_lit_alike
            });
        self.still = if is_still { self.still + 1 } else { 0 };
        let is_clipped = lights.is_some() && self.still < CLIPPED_FRAMES;
        let most_samples = match lights {
            // Nothing changes but the jitter.
            None => u32::MAX,
            // Half of the time since the last change: what the light was during the change must not stay.
            Some(_) => (self.still / 2).clamp(MOST_MOVING, (MOST_STILL as f32 / rays) as u32),
        };
        self.pictures += 1;
        let jitter = jitter(self.pictures);
        let mut history = history_of(before.as_ref().map(|(shot, _)| &shot.camera), shot);
        history.clips = u32::from(is_clipped);
        history.bodies_moved = u32::from(bodies_moved);
        history.most_samples = (most_samples as f32 * rays).min(MOST_COUNTED as f32);
        history.jitter = jitter.map(|pixels| pixels as f32);
        history.edited = u32::from(edited.is_some());
        (history.edited_first, history.edited_last) = edited.unwrap_or(([1; 3], [0; 3]));
        let lights = match lights {
            Some(lights) => Some(lights.clone()),
            None => before.and_then(|(_, lights)| lights),
        };
        self.before = Some((shot.clone(), lights));
        Some(Jittered {
            size,
            jitter,
            texture_pixels: match is_clipped {
                // A share of the shown pixel.
                true => MOVING_TEXTURE_PIXELS * rays.sqrt(),
                false => STILL_TEXTURE_PIXELS,
            },
            picture: self.pictures,
            which: self.pictures as usize % 2,
            history,
        })
    }
}

impl Jittered {
    /// A picture of rays through the centres of the rendered pixels.
    fn without_history(shot: &Shot, size: [u32; 2]) -> Self {
        let mut history = history_of(None, shot);
        history.most_samples = 1.0;
        Self {
            size,
            jitter: [0.0; 2],
            texture_pixels: 1.0,
            picture: 0,
            which: 0,
            history,
        }
    }
}

/// Largest number of rays that f16 counts exactly, with room for the base of the count.
const MOST_COUNTED: u32 = 1024;

/// Whether the pictures differ only by camera and light. Exposure comes after the average.
fn shows_same(a: &Shot, b: &Shot) -> bool {
    a.size == b.size && a.view == b.view && a.textures == b.textures
}

fn history_of(before: Option<&Camera>, shot: &Shot) -> GpuHistory {
    let [width, height] = shot.size.map(f64::from);
    let basis = before.unwrap_or(&shot.camera).basis(width / height);
    GpuHistory {
        position_ws: basis.origin.as_vec3().to_array(),
        forward_ws: basis.forward.as_vec3().to_array(),
        right_ws: basis.right.as_vec3().to_array(),
        up_ws: basis.up.as_vec3().to_array(),
        forgets: u32::from(before.is_none()),
        moved: u32::from(before.is_some_and(|before| *before != shot.camera)),
        size: shot.size,
        edited_first: [1; 3],
        ..Default::default()
    }
}

/// Pixels from the centre of the pixel. Each point comes with its mirror image, so that the mean of few pictures is not
/// shifted: the first 32 points of R2 alone are 0.06 pixels off centre.
fn jitter(picture: u32) -> [f64; 2] {
    let point = r2(picture.div_ceil(2));
    match picture % 2 {
        0 => point.map(|pixels| -pixels),
        _ => point,
    }
}

/// The additive recurrence of the plastic number (R2, Roberts 2018), from −½ to ½: any number of successive points covers
/// the square evenly.
fn r2(number: u32) -> [f64; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053]
        .map(|step| (0.5 + f64::from(number) * step).fract() - 0.5)
}

impl Frame {
    /// Sets whether the next pictures are anti-aliased, and how many of their pixels are rendered. Views of data, and
    /// pictures with probes drawn over them, are never anti-aliased, and all of their pixels are rendered. A change
    /// between two scales below 1 keeps the history.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold the history; the frame is then unchanged.
    ///
    /// # Panics
    /// With a scale outside [`SCALES`]: that is a caller's bug.
    pub fn antialias(&mut self, gpu: &Gpu, wanted: impl Into<Smoothing>) -> Result<(), FrameError> {
        let wanted = wanted.into();
        let scale = wanted.scale;
        assert!(SCALES.contains(&scale), "the scale {scale} is in range");
        let before = std::mem::replace(&mut self.antialiasing.wanted, wanted);
        if before.passes() != wanted.passes()
            && let Err(error) = self.rebuild_passes(gpu)
        {
            self.antialiasing.wanted = before;
            return Err(error);
        }
        Ok(())
    }

    /// How the next pictures are smoothed.
    pub fn smoothing(&self) -> Smoothing {
        self.antialiasing.wanted
    }

    /// Width and height in pixels of what was rendered for the last picture, which has [`size`](Self::size).
    pub fn rendered_size(&self) -> [u32; 2] {
        self.drawn.size
    }

    /// Rays per shown pixel in the last picture.
    pub(super) fn rays_per_pixel(&self) -> f32 {
        rays_per_pixel(self.size, self.drawn.size)
    }

    /// Begins a new average of pictures of [`smooth`](Self::smooth).
    pub fn restart_antialiasing(&mut self) {
        self.antialiasing.restart();
    }

    /// Records one more picture of a shot by the lights and the probes of the last frame, without updates, for the
    /// average of pictures with different jitter: light does not change, so it is a plain mean. The shot's size must be
    /// the frame's. Returns whether the picture is anti-aliased; if not, nothing is recorded.
    pub fn smooth(&mut self, gpu: &Gpu, recorder: &mut Recorder<'_>, shot: &Shot) -> bool {
        debug_assert_eq!(shot.size, self.size, "the shot's size is the frame's");
        let inspected = self.passes.inspect.wanted;
        let Some(jittered) = self.antialiasing.next(shot, &inspected, None, false) else {
            return false;
        };
        self.look(gpu, shot, Some(&jittered), false);
        self.passes.record_picture(recorder, shot, self.drawn);
        true
    }

    /// Records the picture of a shot by the lights and the probes of the last frame, without updates and without
    /// anti-aliasing, with all pixels. The shot's size must be the frame's.
    pub fn show(&mut self, gpu: &Gpu, recorder: &mut Recorder<'_>, shot: &Shot) {
        debug_assert_eq!(shot.size, self.size, "the shot's size is the frame's");
        self.look(gpu, shot, None, false);
        self.passes.record_picture(recorder, shot, self.drawn);
    }

    /// Tells the GPU about the next picture. One that is shaded early is shown by a pass of its own: there is time for it beside
    /// later passes, and shading is what other passes wait for.
    pub(super) fn look(
        &mut self,
        gpu: &Gpu,
        shot: &Shot,
        jittered: Option<&Jittered>,
        shades_early: bool,
    ) {
        let mut uniform = match jittered {
            Some(jittered) => shot.to_gpu_jittered(
                jittered.size,
                jittered.jitter,
                jittered.texture_pixels,
                jittered.picture,
            ),
            None => shot.to_gpu(),
        };
        uniform.body_tiles = uniform.tiles_around(&self.stage.voxels.bodies.boxes());
        let is_finished = jittered.is_none()
            && !shades_early
            && !self.passes.inspect.draws(shot.view)
            && !self.draws_bits(shot.view);
        uniform.is_finished = u32::from(is_finished);
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        self.drawn = Drawn {
            size: jittered.map_or(shot.size, |jittered| jittered.size),
            body_tiles: uniform.body_tiles,
            smoothed: jittered.map(|jittered| jittered.which),
            is_finished,
        };
        if let (Some(jittered), Some(pass)) = (jittered, &self.passes.antialias) {
            pass.set(gpu, &jittered.history);
        }
        self.upload_bits(gpu);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn successive_jitters_cover_the_pixel_evenly() {
        for from in [1, 40, 1000] {
            let points: Vec<_> = (from..from + 64).map(jitter).collect();
            for quadrant in 0..4 {
                let inside =
                    |[x, y]: &&[f64; 2]| (x >= &0.0) as u32 + 2 * (y >= &0.0) as u32 == quadrant;
                let count = points.iter().filter(inside).count();
                assert!((14..=18).contains(&count), "{count} of 64 from {from}");
            }
            let all = points.iter().flatten();
            assert!(all.clone().all(|pixels| pixels.abs() <= 0.5));
            let mean: f64 = all.sum::<f64>() / 128.0;
            assert!(mean.abs() < 0.02, "{mean}");
            // Few pictures must not be shifted either: those of R2 alone are.
            for axis in 0..2 {
                let sum: f64 = points[..32].iter().map(|point| point[axis]).sum();
                let mean = sum / 32.0;
                assert!(mean.abs() < 0.03, "{mean} from {from}");
            }
        }
    }

    /// Frames from picture `from` on until each shown pixel had a ray through it.
    fn frames_to_cover(
        shown: [u32; 2],
        scale: f32,
        from: u32,
        jitter: impl Fn(u32) -> [f64; 2],
    ) -> u32 {
        let rendered = scaled(shown, scale);
        let mut has_ray = vec![false; (shown[0] * shown[1]) as usize];
        for frame in 0..1000 {
            let through = jitter(from + frame);
            for y in 0..rendered[1] {
                for x in 0..rendered[0] {
                    let at = |axis: usize, pixel: u32| {
                        let ratio = f64::from(shown[axis]) / f64::from(rendered[axis]);
                        ((f64::from(pixel) + 0.5 + through[axis]) * ratio) as u32
                    };
                    let [column, row] = [at(0, x).min(shown[0] - 1), at(1, y).min(shown[1] - 1)];
                    has_ray[(row * shown[0] + column) as usize] = true;
                }
            }
            if has_ray.iter().all(|&has| has) {
                return frame + 1;
            }
        }
        u32::MAX
    }

    #[test]
    fn every_shown_pixel_soon_has_a_ray() {
        for (shown, scale) in [
            ([32, 18], 0.5),
            ([37, 23], 0.5),
            ([64, 36], 0.67),
            ([61, 35], 0.77),
            ([50, 50], 0.9),
        ] {
            let most = (8.0 / f32::powi(scale, 2)).ceil() as u32;
            for from in [1, 2, 17, 400, 12_345] {
                let frames = frames_to_cover(shown, scale, from, jitter);
                assert!(frames <= most, "{frames} frames at {scale} from {from}");
            }
            // The comparator: rays that always go through the centres miss pixels for ever.
            assert_eq!(frames_to_cover(shown, scale, 1, |_| [0.0; 2]), u32::MAX);
        }
    }

    #[test]
    fn rendered_sizes_are_whole_and_never_nothing() {
        assert_eq!(scaled([1281, 719], 1.0), [1281, 719]);
        assert_eq!(scaled([1281, 719], 0.5), [641, 360]);
        assert_eq!(scaled([1, 0], 0.5), [1, 1]);
        assert_eq!(rays_per_pixel([8, 6], [4, 3]), 0.25);
    }

    #[test]
    fn edits_join_to_one_box() {
        let mut state = Antialiasing::default();
        state.edit([4, 5, 6], [4, 5, 6]);
        state.edit([1, 9, 6], [2, 9, 7]);
        assert_eq!(state.edited, Some(([1, 5, 6], [4, 9, 7])));
    }
}
