//! A MagicaVoxel model that is opened in place of a world file.

use std::path::Path;

use glam::{DVec3, IVec3};

use super::diagnostics::Problem;
use super::source_file;
use super::values::Read;
use super::vox::{MAX_BYTES, parse, scene_voxels};

/// Air around a model that is opened as a world, and the ground below it (voxels).
const AROUND: i32 = 24;
const GROUND: i32 = 4;

/// The text of a world that shows a model alone: on a plain, under a sky, seen from a corner.
///
/// # Errors
/// A [`Problem`] when the file cannot be read, and when it is no model.
pub(super) fn world_around(path: &Path) -> Read<String> {
    let shown = path.display();
    let help = "export the model from MagicaVoxel as .vox again";
    let refuse = |message: String| Problem::of_file(format!("{shown} {message}"), help);
    let bytes = source_file::read_bytes(path, MAX_BYTES).map_err(refuse)?;
    let data = parse(&bytes)
        .map_err(|message| refuse(format!("is not a MagicaVoxel model: {message}")))?;
    let voxels = scene_voxels(&data).map_err(refuse)?;
    let corners = || voxels.keys().map(|&voxel| IVec3::from(voxel));
    let (Some(low), Some(high)) = (corners().reduce(IVec3::min), corners().reduce(IVec3::max))
    else {
        return Err(refuse("has no voxels".to_owned()));
    };
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
        return Err(refuse("has a name that is no Unicode text".to_owned()));
    };
    let extent = high - low + 1;
    let size = extent + IVec3::new(2 * AROUND, GROUND + AROUND, 2 * AROUND);
    let middle = extent.as_dvec3() * 0.5;
    let eye =
        middle + (extent.as_dvec3() * 0.5 + f64::from(AROUND) - 4.0) * DVec3::new(1.0, 0.6, 1.0);
    let name = name.escape_default();
    Ok(format!(
        r#"(
    title: "The model {name}",
    size: ({}, {}, {}),
    origin: ({}, {}, {}),
    shape: Plane(normal: (0, 1, 0), offset: 0),
    materials: {{"plain": (a: Flat(0.5, 0.5, 0.5))}},
    models: [(file: "{name}", at: (0, 0, 0))],
    sky: (zenith: (0.45, 0.6, 1), horizon: (0.9, 0.95, 1), ground: (0.3, 0.3, 0.3)),
    sun: (towards: (0.4, 1, 0.6), irradiance: (4, 3.7, 3.2)),
    cameras: [(name: "corner", position: ({}, {}, {}), look_at: ({}, {}, {}), fov_deg: 60)],
)
"#,
        size.x,
        size.y,
        size.z,
        -AROUND,
        -GROUND,
        -AROUND,
        eye.x,
        eye.y,
        eye.z,
        middle.x,
        middle.y,
        middle.z,
    ))
}
