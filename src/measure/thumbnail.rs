//! Small pictures for pages: reduced as the eye would see them from a distance, with lossy compression.

use image::{
    ExtendedColorType, Rgb, Rgb32FImage, codecs::jpeg::JpegEncoder, imageops, imageops::FilterType,
};

use super::{
    picture::Picture,
    picture_file::quantised,
    tonemap::{linear_from_srgb, srgb_from_linear},
};

/// JPEG quality: high enough that no block shows at the size of a thumbnail.
const QUALITY: u8 = 72;

/// A display picture (sRGB-encoded) at most `most_width` pixels wide, averaged in linear light: dots of
/// black and white become the grey that they look like from a distance. Smaller pictures stay
/// unchanged.
pub fn reduced(display: &Picture, most_width: u32) -> Picture {
    if display.width <= most_width {
        return display.clone();
    }
    let each = |picture: &Picture, change: fn(f64) -> f64| Picture {
        rgb: (picture.rgb.iter())
            .map(|rgb| rgb.map(|value| change(f64::from(value)) as f32))
            .collect(),
        ..*picture
    };
    let linear = each(display, linear_from_srgb);
    each(&averaged(&linear, most_width), srgb_from_linear)
}

/// Values in [0, 1], such as those of an error map, averaged to at most `most_width` columns; with the
/// new width and height.
///
/// # Panics
/// Unless there are width · height values.
pub fn reduced_map(size: [u32; 2], values: &[f32], most_width: u32) -> ([u32; 2], Vec<f32>) {
    let [width, height] = size;
    assert_eq!(
        values.len(),
        width as usize * height as usize,
        "one value per pixel"
    );
    if width <= most_width {
        return (size, values.to_vec());
    }
    let picture = Picture {
        width,
        height,
        rgb: values.iter().map(|&value| [value; 3]).collect(),
    };
    let small = averaged(&picture, most_width);
    let values = small.rgb.iter().map(|rgb| rgb[0]).collect();
    ([small.width, small.height], values)
}

/// Keeps the aspect ratio; every old pixel counts, with the weights of a tent around the new pixel.
fn averaged(picture: &Picture, width: u32) -> Picture {
    let share = f64::from(width) / f64::from(picture.width);
    let height = ((f64::from(picture.height) * share).round() as u32).max(1);
    let pixels = Rgb32FImage::from_fn(picture.width, picture.height, |x, y| {
        Rgb(picture.rgb[(y * picture.width + x) as usize])
    });
    let small = imageops::resize(&pixels, width.max(1), height, FilterType::Triangle);
    Picture {
        width: small.width(),
        height: small.height(),
        rgb: small.pixels().map(|pixel| pixel.0).collect(),
    }
}

/// A display picture as JPEG.
///
/// # Panics
/// For a picture without pixels, or wider or taller than 65535, which no JPEG can hold.
pub fn jpeg(display: &Picture) -> Vec<u8> {
    let values = display.rgb.as_flattened().iter();
    let bytes: Vec<u8> = values.map(|&value| quantised(value)).collect();
    let mut file = Vec::new();
    JpegEncoder::new_with_quality(&mut file, QUALITY)
        .encode(
            &bytes,
            display.width,
            display.height,
            ExtendedColorType::Rgb8,
        )
        .expect("a picture with pixels fits a JPEG in memory");
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ramps with a bright frame, which a shift or a mirror image would move.
    fn scene(width: u32, height: u32) -> Picture {
        let rgb = (0..width * height).map(|i| {
            let (x, y) = (i % width, i / width);
            let edge = x == 0 || y == 0;
            let ramp = |at: u32, of: u32| at as f32 / of as f32;
            if edge {
                [1.0; 3]
            } else {
                [ramp(x, width), ramp(y, height), 0.25]
            }
        });
        Picture {
            width,
            height,
            rgb: rgb.collect(),
        }
    }

    fn mean(picture: &Picture) -> f64 {
        let values = picture.rgb.as_flattened().iter();
        let linear = values.map(|&value| linear_from_srgb(f64::from(value)));
        linear.sum::<f64>() / (picture.rgb.len() * 3) as f64
    }

    #[test]
    fn light_and_shape_are_kept() {
        let large = scene(480, 270);
        let small = reduced(&large, 160);
        assert_eq!([small.width, small.height], [160, 90]);
        assert!((mean(&small) / mean(&large) - 1.0).abs() < 0.01);
        let (x, y) = (120, 30);
        let pixel = small.rgb[y * 160 + x];
        let expected = large.rgb[(y * 3 + 1) * 480 + x * 3 + 1];
        assert!(
            (0..3).all(|c| (pixel[c] - expected[c]).abs() < 0.01),
            "{pixel:?} {expected:?}"
        );
        assert_eq!(reduced(&large, 480), large, "no larger than it was");
        let line = reduced(&scene(1000, 1), 10);
        assert_eq!([line.width, line.height], [10, 1]);
    }

    #[test]
    fn fine_dots_become_the_grey_that_they_look_like() {
        let dots = Picture {
            width: 256,
            height: 128,
            rgb: (0..256 * 128)
                .map(|i| [((i % 256 + i / 256) % 2) as f32; 3])
                .collect(),
        };
        let small = reduced(&dots, 32);
        // Half of the light, which sRGB encodes as 0.735, not 0.5.
        for rgb in &small.rgb {
            assert!((rgb[1] - 0.735).abs() < 0.01, "{rgb:?}");
        }
        let values: Vec<f32> = dots.rgb.iter().map(|rgb| rgb[0]).collect();
        let (size, map) = reduced_map([256, 128], &values, 32);
        assert_eq!(size, [32, 16]);
        assert!(map.iter().all(|value| (value - 0.5).abs() < 0.01));
        assert_eq!(reduced_map([256, 128], &values, 999), ([256, 128], values));
    }

    #[test]
    fn a_jpeg_is_small_and_shows_the_picture() {
        let picture = scene(320, 180);
        let file = jpeg(&picture);
        assert!(file.len() < 320 * 180 / 4, "{}", file.len());
        let shown = image::load_from_memory_with_format(&file, image::ImageFormat::Jpeg)
            .expect("a JPEG")
            .into_rgb32f();
        let far = |faulty: &Picture| {
            let pixels = shown.pixels().zip(&faulty.rgb);
            let differences = pixels.flat_map(|(a, b)| (0..3).map(move |c| (a.0[c] - b[c]).abs()));
            differences.sum::<f32>() / (faulty.rgb.len() * 3) as f32
        };
        assert!(far(&picture) < 0.01, "{}", far(&picture));
        let mut mirrored = picture.clone();
        mirrored.rgb.reverse();
        assert!(far(&mirrored) > 0.1);
    }
}
