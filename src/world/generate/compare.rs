//! Two builds of the same world, voxel by voxel.

use glam::{IVec3, UVec3};

use super::super::{World, rules::RuleSet, sdf::Shape, voxels::Voxels};

/// Number of voxels that differ between the two. Each must lie within rounding of a boundary: some
/// point within `tolerance` of its centre has the material of the other build.
///
/// # Errors
/// The first voxel that differs for another reason.
pub fn differing(
    world: &World,
    found: &Voxels,
    wanted: &Voxels,
    tolerance: f64,
) -> Result<usize, String> {
    let shape = Shape::new(&world.shape, &world.noises);
    let rules = RuleSet::new(&world.rules, &shape);
    let size = world.size;
    let mut count = 0;
    for index in 0..size.element_product() {
        let voxel = UVec3::new(
            index % size.x,
            index / size.x % size.y,
            index / size.x / size.y,
        );
        let (a, b) = (
            found.material(voxel.as_ivec3()),
            wanted.material(voxel.as_ivec3()),
        );
        if a == b {
            continue;
        }
        count += 1;
        let centre = (world.origin + voxel.as_ivec3()).as_dvec3() + 0.5;
        let near = (0..27).any(|k| {
            let p = centre + tolerance * (IVec3::new(k % 3, k / 3 % 3, k / 9) - 1).as_dvec3();
            let value = shape.eval(p);
            value.abs() < tolerance || value < 0.0 && rules.material(p, value, &shape) == a
        });
        if !near {
            return Err(format!(
                "voxel {voxel} is {a}, not {b}; shape {}",
                shape.eval(centre)
            ));
        }
    }
    Ok(count)
}
