//! Memory on the adapter: all of it is released, and none is taken that was not predicted.

use crate::{
    frame::Frame,
    gpu::Gpu,
    world::{
        bodies::{Bodies, BodyModel},
        file::Summary,
    },
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
/// Bytes of the facts about a cell around a body, in two copies, and most such cells along an axis.
const NEAR_FACTS: u64 = 64;
const MOST_NEAR: u64 = 16;
/// Bytes of a model's block of 4³ voxels: a material for each, a mask, and what is said of six faces.
const BLOCK: u64 = 112;
/// Bytes of the light of a body's block: six faces, in two copies.
const LIGHT: u64 = 96;

/// Most bytes that bodies take.
fn of_bodies(bodies: &Bodies, cells: u64) -> u64 {
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
        .map(|model| BLOCK * (1 + blocks(model)))
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
    bodies: &Bodies,
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
    let most = grid + cells * BRICK + of_bodies(bodies, cells) + 1024;
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
    use super::*;

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
