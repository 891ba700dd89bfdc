//! Pictures as files: PNG for viewing (8 bits, sRGB), OpenEXR for measuring (32-bit float, linear).
//!
//! Files are written under a temporary name and renamed when complete: no incomplete file ever remains,
//! and an old picture survives a failure.

use std::ffi::OsStr;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use exr::prelude::{ReadChannels as _, ReadLayers as _, WritableImage as _};
use image::ImageEncoder as _;
use image::codecs::png::PngEncoder;
use thiserror::Error;

use super::picture::Picture;
use super::tonemap;
use super::whole_file::{self, FileError};

/// Why a picture could not be written or read. Every message names the file and a remedy.
#[derive(Debug, Error)]
pub enum PictureError {
    #[error("{}: pictures are .png (tone-mapped, 8 bits) or .exr (linear, 32-bit float); name one of them", .0.display())]
    UnknownExtension(PathBuf),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: not a picture that can be read: {reason}", path.display())]
    Malformed { path: PathBuf, reason: String },
    #[error("{}: a picture of {width}×{height} cannot be stored: {reason}", path.display())]
    Unstorable {
        path: PathBuf,
        width: u32,
        height: u32,
        reason: String,
    },
}

/// The formats that pictures are stored in, named by the file's extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Display values, 8 bits per channel.
    Png,
    /// Linear radiance, 32-bit float.
    Exr,
}

impl PictureFormat {
    /// The format that a path's extension names.
    ///
    /// # Errors
    /// [`PictureError::UnknownExtension`], which lists the formats.
    pub fn of(path: &Path) -> Result<Self, PictureError> {
        let extension = path
            .extension()
            .and_then(OsStr::to_str)
            .map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(PictureError::UnknownExtension(path.to_owned())),
        }
    }
}

/// Meaning of the numbers of a picture that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// sRGB-encoded, in [0, 1].
    Display,
    /// Linear Rec. 709 radiance.
    Linear,
}

/// Checks, before long work, whether a picture can be written here. Leaves no trace.
///
/// # Errors
/// Those of [`write()`], as far as they can be foreseen.
pub fn check_writable(path: &Path) -> Result<PictureFormat, PictureError> {
    let format = PictureFormat::of(path)?;
    whole_file::open(path)?
        .discard()
        .map_err(|reason| FileError::writing(path, reason))?;
    Ok(format)
}

/// Writes a linear picture in the format of the path's extension: an EXR as it is, a PNG after
/// exposure and tone mapping.
///
/// # Errors
/// [`PictureError`] for an unknown extension, a missing folder, missing rights, a full disk.
pub fn write(path: &Path, linear: &Picture, exposure_ev: f32) -> Result<(), PictureError> {
    match PictureFormat::of(path)? {
        PictureFormat::Png => write_png(path, &tonemap::tone_mapped(linear, exposure_ev)),
        PictureFormat::Exr => write_exr(path, linear),
    }
}

/// Writes display values (sRGB-encoded, in [0, 1]; values outside are clamped, NaN is black) with 8
/// bits per channel.
///
/// # Errors
/// Those of [`write()`].
pub fn write_png(path: &Path, display: &Picture) -> Result<(), PictureError> {
    let file = encoded_png(display).map_err(|error| unstorable(path, display, error))?;
    save(path, &file)
}

fn encoded_png(display: &Picture) -> Result<Vec<u8>, image::ImageError> {
    let bytes: Vec<u8> = display
        .rgb
        .iter()
        .flatten()
        .map(|&value| quantised(value))
        .collect();
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(
        &bytes,
        display.width,
        display.height,
        image::ExtendedColorType::Rgb8,
    )?;
    Ok(file)
}

/// Writes a picture with its full range.
///
/// # Errors
/// Those of [`write()`].
pub fn write_exr(path: &Path, linear: &Picture) -> Result<(), PictureError> {
    let width = linear.width as usize;
    let pixel = |at: exr::math::Vec2<usize>| {
        let [r, g, b] = linear.rgb[at.y() * width + at.x()];
        (r, g, b)
    };
    let layer = exr::image::Layer::new(
        (width, linear.height as usize),
        exr::meta::header::LayerAttributes::default(),
        exr::image::Encoding::SMALL_LOSSLESS,
        exr::image::SpecificChannels::rgb(pixel),
    );
    let mut file = Cursor::new(Vec::new());
    exr::image::Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .map_err(|error| unstorable(path, linear, error))?;
    save(path, file.get_ref())
}

/// Reads a PNG or an EXR, with the meaning of its numbers. Transparency is ignored.
///
/// # Errors
/// [`PictureError`] for an unknown extension, a missing file, and a file that is not a picture.
pub fn read(path: &Path) -> Result<(Picture, Encoding), PictureError> {
    let format = PictureFormat::of(path)?;
    let bytes = std::fs::read(path).map_err(|reason| FileError::reading(path, reason))?;
    match format {
        PictureFormat::Png => Ok((decode_png(path, &bytes)?, Encoding::Display)),
        PictureFormat::Exr => Ok((decode_exr(path, &bytes)?, Encoding::Linear)),
    }
}

fn decode_png(path: &Path, bytes: &[u8]) -> Result<Picture, PictureError> {
    let decoded = image::load_from_memory_with_format(bytes, image::ImageFormat::Png)
        .map_err(|error| malformed(path, error))?
        .into_rgb32f();
    Ok(Picture {
        width: decoded.width(),
        height: decoded.height(),
        rgb: decoded.pixels().map(|pixel| pixel.0).collect(),
    })
}

/// Most pixels of a picture that is read: a header alone must not cause a larger allocation.
const MOST_PIXELS: usize = 1 << 28;

fn decode_exr(path: &Path, bytes: &[u8]) -> Result<Picture, PictureError> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| malformed(path, error))?;
    let too_large = |header: &exr::meta::header::Header| header.layer_size.area() > MOST_PIXELS;
    if meta.headers.iter().any(too_large) {
        return Err(malformed(
            path,
            format!("it has more than {MOST_PIXELS} pixels"),
        ));
    }
    let decoded = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| Picture::new(size.width() as u32, size.height() as u32),
            |picture: &mut Picture, at, (r, g, b, _): (f32, f32, f32, f32)| {
                let index = at.y() * picture.width as usize + at.x();
                picture.rgb[index] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| malformed(path, error))?;
    Ok(decoded.layer_data.channel_data.pixels)
}

/// The nearest of 256 values; the cast sends NaN to 0.
pub(super) fn quantised(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

fn save(path: &Path, bytes: &[u8]) -> Result<(), PictureError> {
    let mut file = whole_file::open(path)?;
    let written = file.write_all(bytes).and_then(|()| file.commit());
    Ok(written.map_err(|reason| FileError::writing(path, reason))?)
}

fn malformed(path: &Path, error: impl ToString) -> PictureError {
    PictureError::Malformed {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

fn unstorable(path: &Path, picture: &Picture, error: impl ToString) -> PictureError {
    PictureError::Unstorable {
        path: path.to_owned(),
        width: picture.width,
        height: picture.height,
        reason: error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use tempfile::tempdir;

    fn gradient() -> Picture {
        let (width, height) = (7, 5);
        let rgb = (0..width * height)
            .map(|i| [i as f32 / 34.0, 0.5, 1.0 - i as f32 / 34.0])
            .collect();
        Picture { width, height, rgb }
    }

    #[test]
    fn an_exr_comes_back_bit_for_bit() {
        let folder = tempdir().expect("a temporary folder");
        let path = folder.path().join("a.exr");
        let mut picture = gradient();
        picture.rgb[3] = [1e6, 1e-30, -2.5];
        write(&path, &picture, 3.0).expect("writable");
        assert_eq!(
            read(&path).expect("readable"),
            (picture.clone(), Encoding::Linear)
        );
        // A planted fault must show.
        picture.rgb[3][0] += 1.0;
        assert_ne!(read(&path).expect("readable").0, picture);
    }

    #[test]
    fn a_png_is_the_tone_mapped_picture() {
        let folder = tempdir().expect("a temporary folder");
        let path = folder.path().join("a.PNG");
        write(&path, &gradient(), 1.0).expect("writable");
        let (picture, encoding) = read(&path).expect("readable");
        assert_eq!(encoding, Encoding::Display);
        let expected = tonemap::tone_mapped(&gradient(), 1.0);
        let worst = |a: &Picture, b: &Picture| {
            let channels = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
            channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        assert!(worst(&picture, &expected) <= 0.5 / 255.0 + 1e-6);
        assert!(worst(&picture, &tonemap::tone_mapped(&gradient(), 1.1)) > 1.0 / 255.0);
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        let folder = tempdir().expect("a temporary folder");
        for name in ["a.png", "a.exr"] {
            let bytes = [0, 1].map(|_| {
                write(&folder.path().join(name), &gradient(), 0.0).expect("writable");
                std::fs::read(folder.path().join(name)).expect("readable")
            });
            assert_eq!(bytes[0], bytes[1]);
        }
    }

    #[test]
    fn an_unknown_extension_is_refused_with_the_list() {
        for name in ["a.jpg", "a", "png"] {
            let message = write(Path::new(name), &gradient(), 0.0)
                .expect_err("unknown")
                .to_string();
            assert!(
                message.contains(".png") && message.contains(".exr"),
                "{message}"
            );
        }
    }

    #[test]
    fn a_check_refuses_places_that_cannot_be_written() {
        let folder = tempdir().expect("a temporary folder");
        let missing = folder.path().join("no/such/a.png");
        assert!(matches!(
            check_writable(&missing),
            Err(PictureError::File(FileError::NoFolder { .. }))
        ));
        let inside = folder.path().join("folder.png");
        std::fs::create_dir(&inside).expect("writable");
        assert!(matches!(
            write(&inside, &gradient(), 0.0),
            Err(PictureError::File(FileError::IsFolder(_)))
        ));
    }

    #[test]
    fn a_check_leaves_no_trace_and_keeps_an_old_picture() {
        let folder = tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        write(&path, &gradient(), 0.0).expect("writable");
        let before = std::fs::read(&path).expect("readable");
        assert_eq!(check_writable(&path).expect("writable"), PictureFormat::Png);
        assert_eq!(before, std::fs::read(&path).expect("readable"));
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("readable").count(),
            1
        );
    }

    #[test]
    fn a_file_that_is_not_a_picture_is_refused() {
        let folder = tempdir().expect("a temporary folder");
        for name in ["a.png", "a.exr"] {
            let path = folder.path().join(name);
            assert!(matches!(
                read(&path),
                Err(PictureError::File(FileError::NoFile(_)))
            ));
            std::fs::write(&path, "not a picture").expect("writable");
            assert!(matches!(read(&path), Err(PictureError::Malformed { .. })));
            std::fs::write(&path, "").expect("writable");
            assert!(matches!(read(&path), Err(PictureError::Malformed { .. })));
        }
    }

    #[test]
    fn an_empty_picture_is_refused() {
        let folder = tempdir().expect("a temporary folder");
        for name in ["a.png", "a.exr"] {
            let path = folder.path().join(name);
            assert!(write(&path, &Picture::new(0, 0), 0.0).is_err(), "{name}");
            assert!(!path.exists());
        }
    }

    #[test]
    fn values_outside_the_display_are_clamped() {
        assert_eq!(
            [f32::NAN, -1.0, 0.5, 2.0, f32::INFINITY].map(quantised),
            [0, 0, 128, 255, 255]
        );
    }

    proptest! {
        /// 8-bit values survive a round trip exactly.
        #[test]
        fn a_png_of_bytes_comes_back(bytes in proptest::collection::vec(any::<[u8; 3]>(), 12)) {
            let rgb = bytes.iter().map(|pixel| pixel.map(|value| f32::from(value) / 255.0)).collect();
            let picture = Picture { width: 4, height: 3, rgb };
            let folder = tempdir().expect("a temporary folder");
            let path = folder.path().join("a.png");
            write_png(&path, &picture).expect("writable");
            prop_assert_eq!(read(&path).expect("readable").0, picture);
        }
    }
}
