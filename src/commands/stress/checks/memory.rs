//! Memory on the adapter: all of it is released, and none is taken that was not predicted.

use glam::{IVec3, Vec3};

use crate::{
    frame::Frame,
    gpu::Gpu,
    world::{World, bodies::BodyModel, file::Summary},
};

/// Bytes that the adapter's allocator has given out; `None` where it does not report them.
pub fn allocated(gpu: &Gpu) -> Option<u64> {
    // Staging memory and dropped resources are released with the next submission.
    gpu.queue.submit([]);
    gpu.wait().ok()?;
    gpu.device
        .generate_allocator_report()
        .map(|report| report.total_allocated_bytes)
}

/// Checks that everything is released after a scene was dropped.
pub fn returned(before: Option<u64>, after: Option<u64>) -> Option<Result<(), String>> {
    let (before, after) = (before?, after?);
    Some(if after <= before {
        Ok(())
    } else {
        Err(format!(
            "{} bytes remain on the adapter after the scene is dropped",
            after - before
        ))
    })
}

/// Uniforms, tables and texture padding that `Frame::memory` leaves out.
const SMALL: u64 = 2 << 20;
/// Bytes of a brick with its masks.
const BRICK: u64 = 576;

/// Bytes of a body: its poses now and before, two boxes in each of eight orders, and the fact about it in two copies.
const BODY: u64 = 1024;
/// Bytes of the facts about a cell of 8³ voxels or more, in two copies.
const FACTS: u64 = 16;
/// Bytes of the facts about a cell around a body, in two copies, and of its entry in a list; and most such cells along an axis.
const NEAR_FACTS: u64 = 68;
const MOST_NEAR: u64 = 16;
/// Bytes of a model's block of 4³ voxels: a material for each, a mask, and what is said of two lit faces
/// on each of six sides.
const BLOCK: u64 = 192;
/// Bytes of a model's emissive face in the list of them.
const EMISSIVE_FACE: u64 = 8;
/// Bytes of the light of a body's block: sixteen columns and four quadrants of two lit faces on each of six sides, in two copies.
const LIGHT: u64 = 3456;

/// Number of a model's faces that emit light: those of emissive voxels beside air.
fn emissive_faces(model: &BodyModel, world: &World) -> u64 {
    let emits = |voxel: &IVec3| {
        let material = usize::from(model.material(*voxel)) - 1;
        let emission = world.materials.get(material).map(|of| of.emission);
        emission.is_some_and(|emission| emission.cmpgt(Vec3::ZERO).any())
    };
    let exposed = |voxel: IVec3| {
        let around = IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let airy = around.filter(|facing| model.material(voxel + *facing) == 0);
        airy.count() as u64
    };
    model.solid().filter(emits).map(exposed).sum()
}

/// Most bytes that bodies take.
fn of_bodies(world: &World, cells: u64) -> u64 {
    let bodies = &world.bodies;
    if bodies.bodies.is_empty() {
        return 0;
    }
    let blocks = |model: &BodyModel| {
        let blocks = model.size.map(|edge| edge.div_ceil(4)).as_u64vec3();
        blocks.element_product()
    };
    // A body touches one cell of 4³ voxels more than its diagonal is long, rounded up.
    let near = |model: &BodyModel| {
        let touched = (model.size.as_vec3().length() / 4.0) as u64 + 2;
        touched.next_power_of_two().min(MOST_NEAR).pow(3)
    };
    let models: u64 = bodies
        .models
        .iter()
        .map(|model| {
            BLOCK * (1 + blocks(model)) + EMISSIVE_FACE * (1 + emissive_faces(model, world))
        })
        .sum();
    let of_body = |model: &BodyModel| BODY + LIGHT * blocks(model) + NEAR_FACTS * near(model);
    let all = bodies
        .bodies
        .iter()
        .map(|body| of_body(&bodies.models[body.model]));
    FACTS * cells + models + all.sum::<u64>()
}

/// Compares the memory of a scene with the predictions of `grotto check` and `Frame::memory`.
pub fn predicted(
    frame: &Frame,
    world: &World,
    summary: &Summary,
    taken: Option<u64>,
) -> Result<(), String> {
    let memory = frame.memory();
    let grid = frame.stage.voxels.grid.size();
    if grid != summary.grid_bytes.max(16) {
        return Err(format!(
            "the grid takes {grid} bytes, and `grotto check` says {}",
            summary.grid_bytes
        ));
    }
    let cells = summary.size.map(|edge| u64::from(edge.div_ceil(8)));
    let cells: u64 = cells.iter().product();
    let most = grid + cells * BRICK + of_bodies(world, cells) + 1024;
    if memory.voxels > most {
        return Err(format!(
            "the voxels take {} bytes, and all cells and bodies together {most}",
            memory.voxels
        ));
    }
    match taken {
        Some(taken) if taken > memory.total + SMALL => Err(format!(
            "the scene takes {taken} bytes of the adapter, and {} are reported",
            memory.total
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::world::file;

    #[test]
    fn emissive_faces_are_those_beside_air() {
        let text = "(
            title: \"Stone, and what glows.\", size: (1, 1, 1), shape: Box(half: (1, 1, 1)),
            materials: {
                \"glow\": (a: Flat(0, 0, 0), emission: (0, 0, 1)),
                \"stone\": (a: Flat(0.5, 0.5, 0.5)),
            },
            rules: [(material: \"stone\")],
        )";
        let world = file::parse(text, "test", None, &Default::default()).expect("a world");
        let number = |name: &str| {
            let found = world.materials.iter().position(|of| of.name == name);
            found.expect("it is there") as u8 + 1
        };
        let (stone, glow) = (number("stone"), number("glow"));
        let model = BodyModel {
            size: UVec3::new(5, 1, 1),
            materials: vec![stone, glow, glow, 0, glow],
        };
        // Four sides of the first, five of the second, and all six of the one that stands alone.
        assert_eq!(emissive_faces(&model, &world), 4 + 5 + 6);
    }

    #[test]
    fn what_stays_behind_is_counted() {
        assert_eq!(returned(Some(5), Some(5)), Some(Ok(())));
        assert_eq!(returned(None, Some(5)), None);
        let left = returned(Some(5), Some(21))
            .expect("known")
            .expect_err("16 bytes");
        assert!(left.contains("16 bytes"), "{left}");
    }
}
