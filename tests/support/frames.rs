//! Whole frames of a small world, and statistics of pictures for tests.

use std::sync::atomic::AtomicBool;

use grotto::{
    frame::{Frame, Stage, TraceRequest, trace},
    gpu::{Gpu, Recorder},
    lights::{LampKinds, Lights},
    measure::picture::Picture,
    parameters::ProbeParameters,
    passes::view::Shot,
    world::{Camera, LayoutSpec, View, World},
};

/// The full view of the first frame, at time 0 and without exposure.
pub fn shot(camera: Camera, size: [u32; 2]) -> Shot {
    Shot {
        camera,
        size,
        frame: 0,
        seed: 0,
        exposure_ev: 0.0,
        view: View::Full,
        time_s: 0.0,
        textures: true,
        soft_rays: 4,
        shadows: Default::default(),
    }
}

/// A world on the GPU and the frame that draws it.
pub struct Drawn {
    pub gpu: Gpu,
    pub world: World,
    pub frame: Frame,
    pub lights: Lights,
    pub probes: ProbeParameters,
    /// What the next frame shows. [`draw`](Self::draw) sets its frame number.
    pub shot: Shot,
}

impl Drawn {
    /// Under the world's first lamps, seen by its first camera.
    pub fn new(
        gpu: Gpu,
        world: World,
        layout: &LayoutSpec,
        probes: ProbeParameters,
        size: [u32; 2],
    ) -> Self {
        let stage = Stage::build(&gpu, &world).expect("the world fits");
        let frame = Frame::new(&gpu, stage, layout, &probes, size).expect("the frame fits");
        Self {
            lights: Lights::at(&world, &world.lamp_presets[0], 0.0),
            shot: shot(world.cameras[0].clone(), size),
            gpu,
            world,
            frame,
            probes,
        }
    }

    /// Draws `frames` more frames.
    pub fn draw(&mut self, frames: u32) {
        let kinds = LampKinds::of(&self.lights);
        let allowed = self.frame.allow_lamps(&self.gpu, kinds);
        allowed.expect("the passes fit");
        for _ in 0..frames {
            self.shot.frame = self.frame.frames();
            let mut recorder = Recorder::new(&self.gpu, None);
            let (shot, lights) = (&self.shot, &self.lights);
            self.frame
                .record(&self.gpu, &mut recorder, shot, lights, &self.probes);
            recorder.submit(&self.gpu).expect("submits");
            self.gpu.wait().expect("the device lives");
        }
    }

    /// What the last frame shows, before the tone mapper.
    pub fn radiance(&self) -> Picture {
        self.frame.read_radiance(&self.gpu).expect("reads back")
    }

    /// The picture that frames should converge to: path traced on the GPU.
    pub fn path_traced(&self, view: View, spp: u32) -> Picture {
        let request = TraceRequest {
            camera: &self.shot.camera,
            size: self.shot.size,
            view,
            spp,
            seed: 5,
            time_s: self.shot.time_s,
            textures: true,
            antialias: false,
        };
        let (stage, stop) = (&self.frame.stage, AtomicBool::new(false));
        trace(&self.gpu, stage, &self.lights, &request, &|_, _| {}, &stop)
            .unwrap_or_else(|failure| panic!("{failure}"))
            .picture
    }
}

/// Mean of the green channel.
pub fn mean(picture: &Picture) -> f64 {
    let sum: f64 = picture.rgb.iter().map(|rgb| f64::from(rgb[1])).sum();
    sum / picture.rgb.len() as f64
}

/// Mean difference of two pictures, relative to the mean of the second.
pub fn apart(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.rgb.iter().zip(&b.rgb);
    let sum: f64 = pairs.map(|(a, b)| f64::from((a[1] - b[1]).abs())).sum();
    sum / a.rgb.len() as f64 / mean(b)
}
