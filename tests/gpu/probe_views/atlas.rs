//! Layers of the atlases, drawn flat.

use glam::{IVec2, Vec3};
use grotto::{
    frame::FrameError,
    parameters::{ProbeParameters, Visibility},
    passes::view::{AtlasLayer, AtlasMap, Inspection, InspectionError},
    probes::{octahedral, packed::distances_of},
};

use super::{Watched, few_rays};
use crate::support;

/// Bytes of a row in a copy of a texture.
const ROW: u32 = 512;

/// A layer of the distance atlas as it is shown, rows from the top.
fn distances(watched: &Watched, layer: u32) -> Vec<Vec<[f32; 3]>> {
    let (gpu, texture) = (&watched.gpu, watched.frame.field().distance_atlas());
    let (width, height) = (texture.width(), texture.height());
    assert!(width * 4 <= ROW);
    let copy = gpu.storage_buffer("copy", u64::from(height * ROW));
    let copy = copy.expect("it fits");
    let mut from = texture.as_image_copy();
    from.origin.z = layer;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        from,
        wgpu::TexelCopyBufferInfo {
            buffer: &copy,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(ROW),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
    );
    gpu.queue.submit([encoder.finish()]);
    let rows: Vec<u32> = gpu.read_buffer(&copy).expect("reads back");
    let shown = |stored: &u32| {
        let [mean, squares] = distances_of(*stored);
        [mean, squares, 0.0]
    };
    rows.chunks_exact(ROW as usize / 4)
        .map(|row| row[..width as usize].iter().map(shown).collect())
        .collect()
}

/// A layer of tiles of irradiance, rows from the top.
fn irradiance(watched: &Watched, layer: u32) -> Vec<Vec<[f32; 3]>> {
    let field = watched.frame.field();
    let (atlas, n) = (field.atlas(), field.atlas().irradiance_texels);
    let maps = field.irradiance(&watched.gpu).expect("reads back");
    let [width, height, _] = atlas.layer_extent(n);
    let mut rows = vec![vec![[0.0; 3]; width as usize]; height as usize];
    for slot in 0..atlas.slots {
        let [column, row, its_layer] = atlas.tile(slot);
        if its_layer != layer {
            continue;
        }
        for (x, y) in (0..n + 2).flat_map(|y| (0..n + 2).map(move |x| (x, y))) {
            let source = octahedral::border_source(IVec2::new(x as i32, y as i32) - 1, n);
            let texel = (slot * n + source.y) * n + source.x;
            let [x, y] = [column * (n + 2) + x, row * (n + 2) + y];
            rows[y as usize][x as usize] = maps[texel as usize];
        }
    }
    rows
}

/// Probes whose maps take many layers, because the adapter is limited to tiny textures.
fn watched(size: [u32; 2]) -> Watched {
    let mut gpu = support::gpu();
    gpu.limits.max_texture_dimension_2d = 64;
    let parameters = ProbeParameters {
        visibility: Visibility::Chebyshev,
        irradiance_texels: 8,
        distance_texels: 16,
        ..few_rays()
    };
    let mut watched = Watched::on(gpu, "house", "coarse", size, parameters);
    watched.settle(2);
    assert!(watched.frame.field().atlas().layers > 5);
    watched
}

fn shown(map: AtlasMap, layer: u32) -> Inspection {
    Inspection {
        atlas: Some(AtlasLayer { map, layer }),
        ..Inspection::default()
    }
}

#[test]
fn a_layer_fills_the_picture_texel_by_texel() {
    // Two pixels per texel of irradiance, with a stripe at both sides, and less than one pixel per texel of distances.
    let size = [50, 40];
    let mut watched = watched(size);
    let mut known = Vec::new();
    for (map, layer) in [
        (AtlasMap::Irradiance, 0),
        (AtlasMap::Irradiance, 4),
        (AtlasMap::Distance, 4),
    ] {
        let picture = watched.look(shown(map, layer));
        let texels = match map {
            AtlasMap::Irradiance => irradiance(&watched, layer),
            AtlasMap::Distance => distances(&watched, layer),
        };
        let [width, height] = [texels[0].len() as u32, texels.len() as u32];
        let scale =
            (f64::from(size[0]) / f64::from(width)).min(f64::from(size[1]) / f64::from(height));
        let texel_at = |pixel: u32, pixels: u32, texels: u32| {
            let margin = (f64::from(pixels) - f64::from(texels) * scale) / 2.0;
            ((f64::from(pixel) + 0.5 - margin) / scale).floor() as i64
        };
        for (index, rgb) in (0..).zip(&picture.rgb) {
            let x = texel_at(index % size[0], size[0], width);
            let y = texel_at(index / size[0], size[1], height);
            let inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
            let mut expected = [0.0; 3];
            if inside {
                expected = texels[y as usize][x as usize];
            }
            // The picture is in half floats.
            let off = (Vec3::from(*rgb) - Vec3::from(expected)).abs();
            let step = Vec3::from(expected) / 1024.0 + 1e-7;
            assert!(
                off.cmple(step).all(),
                "{map:?} {layer}, pixel {index}: {rgb:?}, not {expected:?}"
            );
        }
        let lit = picture.rgb.iter().filter(|rgb| rgb[0] > 0.0).count();
        assert!(lit > 100, "{map:?} {layer}: {lit} pixels");
        known.push(picture);
    }
    assert!(known[0] != known[1], "all layers are the same one");
}

#[test]
fn a_missing_layer_is_refused_with_the_number_of_layers() {
    let mut watched = watched([8, 8]);
    let layers = watched.frame.field().atlas().layers;
    let before = watched.look(shown(AtlasMap::Irradiance, layers - 1));
    let error = watched
        .frame
        .inspect(&watched.gpu, shown(AtlasMap::Distance, layers))
        .expect_err("one too many");
    assert!(matches!(
        error,
        FrameError::Inspection(InspectionError::NoLayer { .. })
    ));
    let message = error.to_string();
    assert!(message.contains(&format!("{layers} layers")), "{message}");
    let after = watched.look(shown(AtlasMap::Irradiance, layers - 1));
    assert!(before == after, "the frame is not as before");
}

#[test]
fn distances_that_are_not_stored_are_refused() {
    let gpu = support::gpu();
    let mut exact = Watched::on(gpu, "house", "coarse", [8, 8], few_rays());
    assert!(!exact.frame.field().keeps_distances());
    let error = exact
        .frame
        .inspect(&exact.gpu, shown(AtlasMap::Distance, 0))
        .expect_err("there are none");
    let message = error.to_string();
    assert!(message.contains("probes.visibility=chebyshev"), "{message}");
}
