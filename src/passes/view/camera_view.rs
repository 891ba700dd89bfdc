//! The uniform of a frame: camera, time, mode.

use crate::{gpu::Gpu, world::Camera};

/// What the picture shows. The command line's `--view` spells these in kebab case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum ViewMode {
    /// Direct light + albedo · indirect irradiance + emission.
    #[default]
    Full,
    /// Direct light and emission alone.
    Direct,
    /// Light that has bounced at least once, reflected by the surface.
    Indirect,
    /// Incoming indirect irradiance (over π), before the albedo.
    Irradiance,
    Albedo,
    Normal,
    /// White near, half as bright with every 32 voxels.
    Depth,
    /// Steps of the camera ray, in the colours of magma.
    Steps,
    /// The cage of probes that each point is lit by, one colour each.
    Cage,
    /// As full, with every texture replaced by its mean.
    TexturesOff,
    /// What the probes that light each point are doing, weighted as their light. Green: alive; amber: alive
    /// and moved out of stone; magenta: twins; cyan: updated now and then; blue: asleep; red: none
    /// gives light there.
    States,
}

crate::shared! {
    in frame;

    enum ViewMode as VIEW {
        Full, Direct, Indirect, Irradiance, Albedo, Normal, Depth, Steps, Cage, TexturesOff, States,
    }

    /// Voxels over which the view of depth loses half its light.
    const DEPTH_HALF: f32 = 32.0;
}

impl ViewMode {
    /// Views of data are not light: no exposure and no tone mapping.
    pub fn is_data(self) -> bool {
        use ViewMode::{Albedo, Cage, Depth, Normal, States, Steps};
        matches!(self, Albedo | Normal | Depth | Steps | Cage | States)
    }

    /// What the view of depth shows of a surface so many voxels away.
    pub fn depth_shown(distance: f32) -> f32 {
        (-distance / DEPTH_HALF).exp2()
    }
}

crate::shared! {
    in frame;

    /// What is the same for every thread of a frame.
    pub struct GpuView as View {
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
        /// 0: faces show the mean of their textures.
        pub textures: u32,
        pub _pad: [u32; 3],
    }
}

/// What a frame is to show.
#[derive(Clone, Debug)]
pub struct View {
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Frames since the probes were made.
    pub frame: u32,
    pub seed: u32,
    pub exposure_ev: f32,
    pub mode: ViewMode,
    /// World time (seconds).
    pub time_s: f64,
    /// Whether faces show their textures or the mean of them.
    pub textures: bool,
}

impl View {
    pub fn to_gpu(&self) -> GpuView {
        let [width, height] = self.size;
        let basis = self.camera.basis(f64::from(width) / f64::from(height));
        GpuView {
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
            mode: self.mode as u32,
            time_s: self.time_s as f32,
            textures: u32::from(self.textures && self.mode != ViewMode::TexturesOff),
            ..Default::default()
        }
    }

    /// The uniform buffer, to be written before each frame.
    pub fn buffer(gpu: &Gpu) -> wgpu::Buffer {
        gpu.uniform_buffer("view", &GpuView::default())
    }
}
