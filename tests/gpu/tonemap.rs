//! The pass `view/tonemap` against the CPU's tone mapper, picture for picture.

use grotto::{
    gpu::{Gpu, Recorder},
    measure::{picture::Picture, picture_file, tonemap},
    passes::view::{Display, GpuShot, Shot, tonemap::Tonemap},
    world::View,
};

use crate::support;

/// Not a multiple of the workgroup, nor of a row's alignment.
const SIZE: [u32; 2] = [37, 21];

/// Light from darkness to far above white, and values that should never occur.
fn linear() -> Picture {
    let mut picture = Picture::new(SIZE[0], SIZE[1]);
    for (index, rgb) in picture.rgb.iter_mut().enumerate() {
        let (x, y) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let light = (x as f32 * 0.5 - 10.0).exp2();
        *rgb = [light, light * y as f32 / 20.0, light * 0.1];
    }
    picture.rgb[5] = [f32::NAN, 0.5, f32::INFINITY];
    picture
}

fn map_on_gpu(gpu: &Gpu, exposure_ev: f32, view: View) -> Picture {
    map_marked(gpu, exposure_ev, view, 1.0)
}

/// As [`map_on_gpu`], with this alpha, which says how pixels are shown.
fn map_marked(gpu: &Gpu, exposure_ev: f32, view: View, alpha: f32) -> Picture {
    let texels: Vec<[f32; 4]> = linear()
        .rgb
        .iter()
        .map(|&[r, g, b]| [r, g, b, alpha])
        .collect();
    let size = wgpu::Extent3d {
        width: SIZE[0],
        height: SIZE[1],
        depth_or_array_layers: 1,
    };
    let lit = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("lit"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    gpu.queue.write_texture(
        lit.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(SIZE[0] * 16),
            rows_per_image: None,
        },
        size,
    );
    let uniform = Shot::buffer(gpu);
    let content = GpuShot {
        width: SIZE[0],
        height: SIZE[1],
        exposure: exposure_ev.exp2(),
        mode: view as u32,
        is_data: u32::from(view.is_data()),
        ..Default::default()
    };
    gpu.queue
        .write_buffer(&uniform, 0, bytemuck::bytes_of(&content));
    let resources = [("view", uniform.as_entire_binding())];
    let display = Display::new(gpu, SIZE).expect("fits");
    let pass = Tonemap::new(gpu, &display, &lit, &resources).expect("compiles");
    let mut recorder = Recorder::new(gpu, None);
    pass.record(&mut recorder);
    recorder.submit(gpu).expect("submits");
    display.read_back(gpu).expect("reads back")
}

/// Largest difference of a channel.
fn worst(a: &Picture, b: &Picture) -> f32 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let channels = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
    channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn the_pass_shows_what_the_cpu_shows() {
    let gpu = support::gpu();
    let shown = map_on_gpu(&gpu, 0.5, View::Full);
    // Half a step of rounding, and the error of 32-bit powers.
    let tolerance = 0.75 / 255.0;
    assert!(worst(&shown, &tonemap::tone_mapped(&linear(), 0.5)) < tolerance);
    assert!(
        worst(&shown, &tonemap::tone_mapped(&linear(), 0.6)) > tolerance,
        "exposure must matter"
    );
}

#[test]
fn data_is_encoded_but_neither_exposed_nor_mapped() {
    let gpu = support::gpu();
    let shown = map_on_gpu(&gpu, 3.0, View::Albedo);
    assert!(worst(&shown, &tonemap::encoded(&linear())) < 0.75 / 255.0);
}

#[test]
fn probes_are_shown_as_light_or_data_in_every_view() {
    let gpu = support::gpu();
    let [light, data] = [View::Full, View::Albedo];
    let shown = |view, alpha| map_marked(&gpu, 1.0, view, alpha);
    let [of_light, of_data] = [shown(light, 1.0), shown(data, 1.0)];
    assert!(of_light != of_data);
    for view in [light, data] {
        assert!(shown(view, 2.0) == of_light, "{view:?}");
        assert!(shown(view, 3.0) == of_data, "{view:?}");
    }
}

#[test]
fn the_file_of_a_shown_picture_holds_exactly_its_bytes() {
    let gpu = support::gpu();
    let shown = map_on_gpu(&gpu, 0.0, View::Full);
    let folder = support::folder();
    let path = folder.path().join("shown.png");
    picture_file::write_png(&path, &shown).expect("writable");
    assert_eq!(picture_file::read(&path).expect("readable").0, shown);
}
