//! What one frame shows, and the uniform that tells its threads.

use crate::{
    gpu::Gpu,
    parameters::Shadows,
    world::{Camera, View},
};

crate::shared! {
    in frame;

    /// Data that is the same for every thread of a frame.
    pub struct GpuShot as View {
        /// The ray through the centre of pixel (x, y) is
        /// forward + right · (2 (x + ½) / width − 1) + up · (1 − 2 (y + ½) / height).
        pub position_ws: [f32; 3],
        pub width: u32,
        pub forward_ws: [f32; 3],
        pub height: u32,
        pub right_ws: [f32; 3],
        /// Frames since the probes were made.
        pub frame: u32,
        pub up_ws: [f32; 3],
        pub seed: u32,
        /// Angle of a pixel at the picture's centre (radians): the spread of a camera ray's cone.
        pub pixel_angle: f32,
        /// 2^EV.
        pub exposure: f32,
        /// One of the VIEW_ constants.
        pub mode: u32,
        /// World time (seconds).
        pub time_s: f32,
        /// 1: faces show their textures; 0: faces show the mean of their textures.
        pub textures: u32,
        /// Width over which textures are averaged, in pixels.
        pub texture_pixels: f32,
        /// Shadow rays of a pixel to each lamp that is a sphere.
        pub soft_rays: u32,
        /// Number of the picture among those that are averaged; 0 for a picture that stands alone.
        pub picture: u32,
        /// 1: pass `view/shade` shows the picture, which no pass changes afterwards.
        pub is_finished: u32,
        /// 1: the view shows data, which gets neither exposure nor tone curve.
        pub is_data: u32,
        pub _pad: [u32; 2],
        /// First column and row of the tiles that may show bodies, and how many of each.
        pub body_tiles: [u32; 4],
    }

    /// Pixels along a tile of pass `view/shade`.
    pub(super) const SHADE_TILE: u32 = 8;
}

/// What one frame shows: from which camera, at what time, in which view.
#[derive(Clone, Debug)]
pub struct Shot {
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Frames since the probes were made.
    pub frame: u32,
    pub seed: u32,
    pub exposure_ev: f32,
    pub view: View,
    /// World time (seconds).
    pub time_s: f64,
    /// Whether faces show their textures; else each face shows the mean of its texture.
    pub textures: bool,
    /// Shadow rays of a pixel to each lamp that is a sphere, in pictures that are averaged. A picture that stands alone
    /// has several times as many (`ALONE`).
    pub soft_rays: u32,
    /// What shadows the direct light of lamps.
    pub shadows: Shadows,
}

/// How many times as many rays to soft lamps a picture has that no other is averaged with.
const ALONE: u32 = 4;

impl Shot {
    pub fn to_gpu(&self) -> GpuShot {
        let [width, height] = self.size;
        let basis = self.camera.basis(f64::from(width) / f64::from(height));
        GpuShot {
            position_ws: basis.origin.as_vec3().to_array(),
            width,
            forward_ws: basis.forward.as_vec3().to_array(),
            height,
            right_ws: basis.right.as_vec3().to_array(),
            frame: self.frame,
            up_ws: basis.up.as_vec3().to_array(),
            seed: self.seed,
            pixel_angle: (2.0 * basis.up.length() / f64::from(height)) as f32,
            exposure: self.exposure_ev.exp2(),
            mode: self.view as u32,
            time_s: self.time_s as f32,
            textures: u32::from(self.textures && self.view != View::TexturesOff),
            texture_pixels: 1.0,
            soft_rays: self.soft_rays * ALONE,
            picture: 0,
            is_finished: 0,
            is_data: u32::from(self.view.is_data()),
            _pad: [0; 2],
            body_tiles: [0; 4],
        }
    }

    /// The same for rendering `size` pixels, with rays that go through them at `jitter` (pixels from the centre). Jitter
    /// averages textures too, so each ray averages less of them. What the picture shows does not depend on `size`, so its
    /// pixels are square only as far as whole numbers allow. `picture` is its number among those that are averaged, from
    /// 1 on; 0 if it stands alone.
    pub fn to_gpu_jittered(
        &self,
        size: [u32; 2],
        jitter: [f64; 2],
        texture_pixels: f32,
        picture: u32,
    ) -> GpuShot {
        let [shown_width, shown_height] = self.size.map(f64::from);
        let [width, height] = size.map(f64::from);
        let basis = self.camera.basis(shown_width / shown_height);
        let forward = basis.forward + basis.right * (2.0 * jitter[0] / width)
            - basis.up * (2.0 * jitter[1] / height);
        GpuShot {
            forward_ws: forward.as_vec3().to_array(),
            width: size[0],
            height: size[1],
            pixel_angle: (2.0 * basis.up.length() / height) as f32,
            texture_pixels,
            soft_rays: self.soft_rays * if picture == 0 { ALONE } else { 1 },
            picture,
            ..self.to_gpu()
        }
    }

    /// The uniform buffer. It must be written before each frame.
    pub fn buffer(gpu: &Gpu) -> wgpu::Buffer {
        gpu.uniform_buffer("view", &GpuShot::default())
    }
}
