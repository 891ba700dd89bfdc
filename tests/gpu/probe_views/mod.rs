//! Pictures that show the probes themselves: spheres and lines in the scene, states of what lights a
//! point, layers of the atlases.

mod atlas;
mod oracle;

use glam::{DVec3, Vec3};
use grotto::{
    frame::{self, Frame, Stage},
    gpu::{Gpu, Recorder},
    lights::Lights,
    measure::{palette, picture::Picture},
    parameters::{ProbeParameters, ProbeStates, Relocation},
    passes::{
        scene::GpuLights,
        view::{Inspection, ProbeColour, Shot, state_view::StateView},
    },
    probes::Layout as _,
    world::View,
};
use half::f16;
use oracle::{Expected, Oracle};

use crate::support::{self, frames, layout_of};

/// A world seen by its first camera.
struct Watched {
    gpu: Gpu,
    frame: Frame,
    lights: Lights,
    parameters: ProbeParameters,
    shot: Shot,
}

impl Watched {
    fn new(world: &str, layout: &str, size: [u32; 2], parameters: ProbeParameters) -> Self {
        let gpu = support::gpu();
        Self::on(gpu, world, layout, size, parameters)
    }

    fn on(
        gpu: Gpu,
        world: &str,
        layout: &str,
        size: [u32; 2],
        parameters: ProbeParameters,
    ) -> Self {
        let world = support::shipped(world);
        let stage = Stage::build(&gpu, &world).expect("it fits");
        let frame = Frame::new(&gpu, stage, layout_of(&world, layout), &parameters, size);
        Self {
            frame: frame.expect("it fits"),
            lights: Lights::at(&world, &world.lamp_presets[0], 0.0),
            shot: Shot {
                seed: 1,
                ..frames::shot(world.cameras[0].clone(), size)
            },
            gpu,
            parameters,
        }
    }

    fn settle(&mut self, frames: u32) {
        for _ in 0..frames {
            let mut recorder = Recorder::new(&self.gpu, None);
            let (shot, lights) = (&self.shot, &self.lights);
            self.frame
                .record(&self.gpu, &mut recorder, shot, lights, &self.parameters);
            recorder.submit(&self.gpu).expect("submits");
            self.gpu.wait().expect("the device lives");
        }
    }

    /// Draws a view of the probes without updating them.
    fn look(&mut self, wanted: Inspection) -> Picture {
        self.shot.view = wanted.view;
        self.frame.inspect(&self.gpu, wanted).expect("it fits");
        let mut recorder = Recorder::new(&self.gpu, None);
        self.frame.show(&self.gpu, &mut recorder, &self.shot);
        recorder.submit(&self.gpu).expect("submits");
        self.frame.read_radiance(&self.gpu).expect("reads back")
    }

    fn spheres(&mut self, colour: ProbeColour) -> Picture {
        self.look(Inspection {
            probes: Some(colour),
            ..Inspection::default()
        })
    }

    fn view(&mut self, view: View) -> Picture {
        self.look(Inspection {
            view,
            ..Inspection::default()
        })
    }

    /// Which probe should be at each pixel, from the places in the field.
    fn oracle(&mut self, lines: bool) -> Oracle {
        let depth = self.view(View::Depth);
        Oracle::new(&self.gpu, &self.frame, &self.shot.camera, &depth, lines)
    }
}

/// Few rays, to save time: these pictures test where probes are and what states they have.
fn few_rays() -> ProbeParameters {
    ProbeParameters {
        rays: 8,
        irradiance_texels: 4,
        distance_texels: 4,
        states: ProbeStates::Off,
        ..Default::default()
    }
}

fn unmoved() -> ProbeParameters {
    ProbeParameters {
        relocation: Relocation::Off,
        ..few_rays()
    }
}

const ALIVE: usize = 2;
const MOVED: usize = 3;
const BACK_SIDE: usize = 4;
const INDIRECT_ONLY: usize = 1;
const ASLEEP: usize = 0;
const DEAD: usize = 5;

/// A colour of the palette.
fn of(index: usize) -> Vec3 {
    palette::linear(index).into()
}

/// Number of pixels of spheres, of lines, and of wrong pixels among both. A pixel that belongs to no probe must be as
/// in the picture without probes.
fn faults(
    drawn: &Picture,
    plain: &Picture,
    oracle: &Oracle,
    colour: impl Fn(&Expected) -> Vec3,
) -> [u32; 3] {
    let [mut spheres, mut lines, mut wrong] = [0; 3];
    let (mut certain, all) = (0, drawn.rgb.len());
    for (index, (drawn, plain)) in drawn.rgb.iter().zip(&plain.rgb).enumerate() {
        let Some(expected) = oracle.at(index as u32) else {
            continue;
        };
        certain += 1;
        let right = match expected {
            None => drawn == plain,
            Some(expected) => {
                let counter = if expected.is_line {
                    &mut lines
                } else {
                    &mut spheres
                };
                *counter += 1;
                let lit = 0.3 + 0.7 * expected.facing as f32;
                (Vec3::from(*drawn) - colour(&expected) * lit)
                    .abs()
                    .max_element()
                    < 0.02
            }
        };
        wrong += u32::from(!right);
    }
    assert!(
        certain * 10 > all * 8,
        "only {certain} of {all} are certain"
    );
    [spheres, lines, wrong]
}

#[test]
fn spheres_and_lines_are_where_probes_and_back_side_probes_stand_and_walls_hide_them() {
    let mut watched = Watched::new("house", "house", [128, 72], few_rays());
    watched.settle(2);
    let plain = watched.view(View::Full);
    let drawn = watched.spheres(ProbeColour::State);
    let mut oracle = watched.oracle(true);
    let by_state = |expected: &Expected| match (expected.is_back_side, expected.is_moved) {
        (true, _) => of(BACK_SIDE),
        (false, true) => of(MOVED),
        (false, false) => of(ALIVE),
    };
    let [spheres, lines, wrong] = faults(&drawn, &plain, &oracle, by_state);
    assert!(spheres > 150 && lines > 40, "{spheres} and {lines} pixels");
    assert_eq!(wrong, 0);

    // The comparison notices probes that are a voxel off, probes drawn through walls, and lines without their end.
    let surfaces = oracle.clear_surfaces();
    let [.., through_walls] = faults(&drawn, &plain, &oracle, by_state);
    assert!(through_walls > 100, "{through_walls}");
    oracle.set_surfaces(surfaces);
    oracle.move_ends(DVec3::X);
    let [.., moved] = faults(&drawn, &plain, &oracle, by_state);
    assert!(moved > 100, "{moved}");
}

#[test]
fn every_level_of_a_volume_that_moves_is_drawn_where_it_is_now() {
    let mut watched = Watched::new("house", "around", [96, 54], few_rays());
    watched.settle(2);
    let before = watched.oracle(false);
    watched.shot.camera.position += Vec3::new(-9.0, 1.0, 8.3);
    watched.settle(2);
    let plain = watched.view(View::Full);
    let drawn = watched.spheres(ProbeColour::Cascade);
    let by_level = |expected: &Expected| of(expected.level as usize);
    let oracle = watched.oracle(false);
    let [spheres, _, wrong] = faults(&drawn, &plain, &oracle, by_level);
    assert!(spheres > 300, "{spheres}");
    assert_eq!(wrong, 0);
    let [.., stale] = faults(&drawn, &plain, &before, by_level);
    assert!(stale > 300, "{stale}");
}

#[test]
fn a_camera_in_a_sphere_looks_through_it() {
    let mut watched = Watched::new("furnace", "coarse", [64, 36], unmoved());
    watched.settle(1);
    let volume = watched.frame.field().volume();
    let centre = (0..volume.slots()).map(|slot| volume.position(slot));
    let inside = centre.clone().find(|at| at.abs().max_element() < 5.0);
    watched.shot.camera.position = inside.expect("a probe in the room") + Vec3::splat(0.1);
    let plain = watched.view(View::Full);
    let drawn = watched.spheres(ProbeColour::Offset);
    let oracle = watched.oracle(true);
    // Nothing has moved: black.
    let [spheres, _, wrong] = faults(&drawn, &plain, &oracle, |_| Vec3::ZERO);
    assert!(spheres > 20 && wrong == 0, "{spheres}, {wrong} wrong");
}

#[test]
fn in_a_furnace_every_sphere_shows_the_light_of_all_directions() {
    let parameters = ProbeParameters {
        rays: 64,
        ..few_rays()
    };
    let mut watched = Watched::new("furnace", "coarse", [64, 36], parameters);
    let radiance_of_spheres = |watched: &mut Watched| -> Vec<f32> {
        let marked = watched.spheres(ProbeColour::State);
        let plain = watched.view(View::Full);
        let light = watched.spheres(ProbeColour::Irradiance);
        let spheres = (0..light.rgb.len()).filter(|&at| marked.rgb[at] != plain.rgb[at]);
        // Where there is no line, the picture shows what is behind.
        spheres.flat_map(|at| light.rgb[at]).collect()
    };
    watched.settle(2);
    let early = radiance_of_spheres(&mut watched);
    assert!(early.iter().any(|light| *light < 1.7), "light takes time");
    watched.settle(28);
    let late = radiance_of_spheres(&mut watched);
    assert!(late.len() > 600, "{} values", late.len());
    for light in late {
        assert!((light - 2.0).abs() < 0.02, "{light}");
    }
}

fn has_hue(rgb: [f32; 3], index: usize) -> bool {
    let colour = Vec3::from(rgb).normalize_or_zero();
    (colour - of(index).normalize()).abs().max_element() < 0.01
}

#[test]
fn surfaces_show_the_states_of_the_probes_that_light_them() {
    let mut watched = Watched::new("furnace", "fine", [48, 27], unmoved());
    watched.settle(2);
    let green = watched.view(View::States);
    assert!(green.rgb.iter().all(|rgb| has_hue(*rgb, ALIVE)));

    // Some of the probes in pillars move, and light points that others lit before.
    let mut watched = Watched::new("furnace", "fine", [48, 27], few_rays());
    watched.settle(2);
    let mixed = watched.view(View::States);
    let green = mixed.rgb.iter().filter(|rgb| has_hue(**rgb, ALIVE)).count();
    let moved = mixed.rgb.iter().filter(|rgb| has_hue(**rgb, MOVED)).count();
    assert!(green > 0 && moved > 0, "{green} green, {moved} yellow");
}

#[test]
fn painted_cubes_count_as_the_states_do() {
    let parameters = ProbeParameters {
        states: ProbeStates::On,
        warmup_frames: 1,
        // No probe is active through variability alone: probes that light no pixel are asleep or indirect-only.
        variability: 1.0,
        ..few_rays()
    };
    let mut watched = Watched::new("furnace", "fine", [16, 9], parameters);
    watched.settle(4);
    let field = watched.frame.field();
    let gpu = &watched.gpu;
    let surfaces = gpu.storage_buffer("surfaces", 16 * 9 * 8).expect("it fits");
    let format = wgpu::TextureFormat::Rgba16Float;
    let hdr = gpu.texture("hdr", [16, 9, 1], format).expect("it fits");
    let (view, lights) = (
        Shot::buffer(gpu),
        GpuLights::new(gpu, None).expect("it fits"),
    );
    let scene = frame::scene(&watched.frame.stage, &view, &lights);
    let offer = frame::offer(field, watched.frame.faces(), &scene);
    let (slots, cube_bytes) = (field.atlas().slots, field.memory().ambient_cubes);
    let paint = StateView::new(gpu, &hdr, &surfaces, slots, cube_bytes, &offer).expect("it fits");
    let mut recorder = Recorder::new(gpu, None);
    paint.record(&mut recorder);
    recorder.submit(gpu).expect("submits");
    let cubes: Vec<[[u32; 4]; 3]> = watched.gpu.read_buffer(&paint.cubes).expect("reads back");
    let updates = field.updates(&watched.gpu).expect("reads back");
    let [mut alive, mut sleeping, mut dead] = [0, 0, 0];
    for (slot, cube) in (0..field.atlas().slots).zip(cubes) {
        let light: Vec<f32> = cube
            .iter()
            .flat_map(|axis| bytemuck::cast_slice::<u32, f16>(&axis[..3]))
            .map(|half| half.to_f32())
            .collect();
        let colour = Vec3::from_slice(&light[..3]);
        assert!(light.chunks(3).all(|side| side == &light[..3]));
        if let Some(updates) = updates.get(slot as usize) {
            let known = f32::from(u8::from(*updates > 0));
            assert!(cube.iter().all(|axis| f32::from_bits(axis[3]) == known));
        }
        let is = |state| (colour - of(state)).abs().max_element() < 1e-3;
        alive += u32::from(is(ALIVE) || is(MOVED) || is(BACK_SIDE) || is(INDIRECT_ONLY));
        sleeping += u32::from(is(ASLEEP));
        dead += u32::from(is(DEAD) && slot < field.volume().slots());
    }
    let counts = field.state_counts(&watched.gpu).expect("reads back");
    assert_eq!(
        [alive, sleeping, dead],
        [counts.alive, counts.sleeping, counts.dead]
    );
    assert!(alive > 0 && sleeping > 0, "{counts:?}");
}
