//! Bodies that a player places, removes or pushes while a frame is shown.

use std::mem;

use super::{Frame, FrameError, offer, scene};
use crate::{
    gpu::{Gpu, OwnedSpec},
    passes::{
        probes::cover::ProbeCover,
        scene::{BODIES, publish_facts::PublishFacts},
        surface_cache::{
            body_cells::BodyCells, body_lamps::BodyLamps, body_light::BodyLight,
            body_shafts::BodyShafts,
        },
        view::shade::Shade,
    },
    world::bodies::Bodies,
};

impl Frame {
    /// Shows other bodies; the probes keep their light. The first ones of a world that had none, and more than there is
    /// room for, bind every pass again; the first ones compile them, too.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold them; the frame is then unchanged.
    pub fn set_bodies(&mut self, gpu: &Gpu, bodies: &Bodies) -> Result<(), FrameError> {
        if self.stage.voxels.bodies.take(gpu, bodies) {
            return Ok(());
        }
        let larger = self.stage.voxels.bodies.with_room(gpu, bodies)?;
        let before = mem::replace(&mut self.stage.voxels.bodies, larger);
        if let Err(error) = self.rebuild_passes(gpu) {
            self.stage.voxels.bodies = before;
            return Err(error);
        }
        Ok(())
    }

    /// Whether kernels are compiled for bodies.
    pub fn has_bodies(&self) -> bool {
        self.stage.voxels.bodies.exist()
    }

    /// The kernels that the first body of this frame needs, and which are not compiled yet.
    pub fn kernels_for_bodies(&self, gpu: &Gpu) -> Vec<OwnedSpec> {
        let scene = scene(&self.stage, &self.view, &self.lights);
        let mut offered = offer(&self.field, &self.faces, &scene).constants;
        for (name, value) in &mut offered {
            if *name == BODIES {
                *value = 1.0;
            }
        }
        let own = [
            ProbeCover::spec(&offered),
            BodyLight::spec(&offered),
            BodyCells::spec(&offered),
            BodyLamps::spec(&offered),
            BodyShafts::spec(&offered),
            Shade::spec(true, &offered),
            PublishFacts::spec(),
        ];
        let own = own.iter().map(OwnedSpec::from);
        gpu.unknown(gpu.variants(BODIES, 1.0).into_iter().chain(own))
    }

    /// Moves the bodies to where they rest now.
    pub fn rest_bodies(&self, gpu: &Gpu, bodies: &Bodies) {
        self.stage.voxels.bodies.rest(gpu, bodies);
    }
}

#[cfg(test)]
mod tests {
    use std::{path::Path, sync::Arc};

    use glam::{UVec3, Vec3};

    use super::*;
    use crate::{
        frame::Stage,
        gpu::ShaderChecks,
        parameters::Parameters,
        world::{
            bodies::{BodyModel, PlacedBody},
            file::{self, Overrides},
        },
    };

    #[test]
    fn the_first_body_compiles_nothing_that_was_compiled_ahead() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = file::load(&path, &Overrides::default()).expect("it loads");
        let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need a Vulkan device");
        let stage = Stage::build(&gpu, &world).expect("it fits");
        let Parameters {
            probes, picture, ..
        } = Parameters::default();
        let frame = Frame::new(&gpu, stage, &world.layouts[0], &probes, [8, 8]);
        let mut frame = frame.expect("it fits");
        frame.antialias(&gpu, &picture).expect("it fits");
        frame.prepare_bits(&gpu).expect("it fits");
        let needed = frame.kernels_for_bodies(&gpu);
        assert!(needed.len() > 10, "{}", needed.len());
        let ahead = gpu.compile_ahead(needed);
        ahead.finish().expect("they compile");
        assert_eq!(frame.kernels_for_bodies(&gpu), []);
        let known = gpu.compiled();
        let mut bodies = Bodies::default();
        bodies.add(&PlacedBody {
            name: "placed 1".into(),
            model: Arc::new(BodyModel {
                size: UVec3::ONE,
                materials: vec![1],
            }),
            corner: Vec3::ZERO,
        });
        frame.set_bodies(&gpu, &bodies).expect("it fits");
        assert!(frame.has_bodies());
        assert_eq!(gpu.compiled(), known);
        let listed = |frame: &Frame| frame.stage.voxels.bodies.touched_cells().is_some();
        assert!(listed(&frame));
        frame.set_bodies(&gpu, &Bodies::default()).expect("it fits");
        assert!(
            !listed(&frame),
            "no pass looks at cells of bodies that are gone"
        );
    }
}
