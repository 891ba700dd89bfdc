//! A picture of a block, seen from above one of its edges: each pixel evaluates what the block's faces look like.

use egui::{Color32, ColorImage};
use glam::{DVec2, DVec3, IVec3, Vec3};

use crate::{
    measure::tonemap::tone_map,
    world::{
        materials::MaterialSet,
        placed::{LampBlock, LampForm},
    },
};

/// Width and height (pixels).
pub const SIZE: usize = 64;
/// Samples along a pixel's edge.
const SAMPLES: usize = 3;

/// Light that the upper, the left and the right face get.
const LIGHT: [f32; 3] = [2.6, 1.5, 0.9];
/// The faces of a voxel that are seen: +y, +z, +x.
const FACES: [u8; 3] = [3, 5, 1];

/// Edge of a lamp's block, as a share of a voxel's.
const LAMP_EDGE: f64 = 0.6;
/// Radiance of a lamp's faces, and of the glow around it.
const LAMP_RADIANCE: f32 = 1.5;
const GLOW_RADIANCE: f32 = 0.9;

/// A face of the block (0 upper, 1 left, 2 right) and the place on it: right and down, in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    face: usize,
    at: DVec2,
}

/// What a block with edges of half the picture's height shows at a point of the picture, in [0, 1]².
fn place_of(point: DVec2) -> Option<Place> {
    let DVec2 { x, y } = point;
    // In units of the upper face's edges, which go right and down, and left and down.
    let top = DVec2::new(2.0 * y + x - 0.5, 2.0 * y - x + 0.5);
    let in_square = |at: DVec2| at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::ONE).all();
    let left = DVec2::new(2.0 * x, 2.0 * y - 0.5 - x);
    let right = DVec2::new(2.0 * x - 1.0, 2.0 * y - 1.5 + x);
    [top, left, right]
        .into_iter()
        .enumerate()
        .find(|(_, at)| in_square(*at))
        .map(|(face, at)| Place { face, at })
}

/// The first material of a set.
pub fn of_material(set: &MaterialSet) -> ColorImage {
    let footprint = 2.0 / SIZE as f64;
    drawn(|point| {
        let Place { face, at } = place_of(point)?;
        let position = match face {
            0 => DVec3::new(at.x, 1.0, at.y),
            1 => DVec3::new(at.x, 1.0 - at.y, 1.0),
            _ => DVec3::new(1.0, 1.0 - at.y, 1.0 - at.x),
        };
        let albedo = set.albedo(1, IVec3::ZERO, FACES[face], position, footprint);
        Some((albedo * LIGHT[face] + set.emission(1), 1.0))
    })
}

/// A lamp in its colour, and where its light goes.
pub fn of_lamp(lamp: &LampBlock) -> ColorImage {
    let colour = lamp.colour.rgb();
    drawn(|point| {
        let from_middle = point - 0.5;
        if let Some(Place { face, .. }) = place_of(0.5 + from_middle / LAMP_EDGE) {
            let share = LIGHT[face] / LIGHT[0];
            return Some((LAMP_RADIANCE * share * colour, 1.0));
        }
        let distance = from_middle.length() / 0.5;
        let is_lit = match lamp.form {
            LampForm::Point => true,
            LampForm::Spot => from_middle.y > from_middle.x.abs(),
        };
        let strength = (1.0 - distance).max(0.0) as f32;
        (is_lit && strength > 0.0).then_some((GLOW_RADIANCE * colour, strength))
    })
}

/// A picture of what a function shows at each point in [0, 1]²: radiance (linear RGB) and opacity.
fn drawn(seen: impl Fn(DVec2) -> Option<(Vec3, f32)>) -> ColorImage {
    let mut pixels = Vec::with_capacity(SIZE * SIZE);
    for row in 0..SIZE {
        for column in 0..SIZE {
            let corner = DVec2::new(column as f64, row as f64);
            let samples = (0..SAMPLES * SAMPLES).filter_map(|sample| {
                let within = DVec2::new((sample % SAMPLES) as f64, (sample / SAMPLES) as f64);
                seen((corner + (within + 0.5) / SAMPLES as f64) / SIZE as f64)
            });
            let (light, opacity) = samples.fold((Vec3::ZERO, 0.0), |(light, opacity), (l, o)| {
                (light + l * o, opacity + o)
            });
            pixels.push(colour_of(light, opacity));
        }
    }
    ColorImage::new([SIZE, SIZE], pixels)
}

/// Of the sums over a pixel's samples.
fn colour_of(light: Vec3, opacity: f32) -> Color32 {
    if opacity <= 0.0 {
        return Color32::TRANSPARENT;
    }
    let byte = |share: f64| (255.0 * share + 0.5) as u8;
    let [r, g, b] = tone_map((light / opacity).as_dvec3()).to_array().map(byte);
    let opacity = opacity / (SAMPLES * SAMPLES) as f32;
    Color32::from_rgba_unmultiplied(r, g, b, byte(opacity.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{
        Colour, Material, MaterialSound, Pattern,
        placed::{LampColour, LampMotion},
    };

    fn material(pattern: Pattern, emission: Vec3) -> ColorImage {
        let material = Material {
            name: "test".into(),
            a: Colour::Flat(Vec3::new(0.8, 0.1, 0.1)),
            b: Colour::Flat(Vec3::new(0.1, 0.1, 0.8)),
            pattern,
            emission,
            sound: MaterialSound::Stone,
        };
        of_material(&MaterialSet::bake(&[material], 1))
    }

    fn at(image: &ColorImage, x: usize, y: usize) -> Color32 {
        image.pixels[y * SIZE + x]
    }

    #[test]
    fn three_faces_meet_in_the_middle_and_fill_half_of_the_picture_and_more() {
        let faces = [(0.5, 0.25), (0.25, 0.6), (0.75, 0.6)];
        for (face, (x, y)) in faces.into_iter().enumerate() {
            let place = place_of(DVec2::new(x, y)).expect("a face");
            assert_eq!(place.face, face);
        }
        for corner in [(0.02, 0.02), (0.98, 0.02), (0.02, 0.98), (0.98, 0.98)] {
            assert_eq!(place_of(corner.into()), None);
        }
        let image = material(Pattern::Plain, Vec3::ZERO);
        let opaque = image.pixels.iter().filter(|pixel| pixel.a() == 255).count();
        let share = opaque as f64 / (SIZE * SIZE) as f64;
        assert!((0.70..0.76).contains(&share), "{share}");
    }

    #[test]
    fn a_block_is_red_striped_or_shining_as_its_material() {
        let plain = material(Pattern::Plain, Vec3::ZERO);
        let (top, left, right) = (at(&plain, 32, 16), at(&plain, 16, 38), at(&plain, 48, 38));
        assert!(top.r() > left.r() && left.r() > right.r(), "lit from above");
        assert!(left.r() > left.b() + 40, "{left:?}");
        let stripes = Pattern::Stripes {
            pitch: 0.5,
            width: 0.5,
        };
        let striped = material(stripes, Vec3::ZERO);
        let row = (4..30).map(|x| at(&striped, x, 40));
        assert!(
            row.clone()
                .any(|pixel| pixel.r() > pixel.b().saturating_add(20))
        );
        assert!(
            row.clone()
                .any(|pixel| pixel.b() > pixel.r().saturating_add(20))
        );
        let green = material(Pattern::Plain, Vec3::new(0.0, 5.0, 0.0));
        assert!(at(&green, 48, 38).g() > at(&plain, 48, 38).g().saturating_add(40));
    }

    #[test]
    fn a_lamp_has_its_colour_and_a_spot_shines_down() {
        let lamp = |form| LampBlock {
            form,
            colour: LampColour::Blue,
            power: 100.0,
            radius: 0.25,
            soft_radius: 0.0,
            motion: LampMotion::Still,
        };
        let (point, spot) = (
            of_lamp(&lamp(LampForm::Point)),
            of_lamp(&lamp(LampForm::Spot)),
        );
        let middle = at(&point, 24, 36);
        assert!(middle.a() == 255 && middle.b() > middle.r());
        let (above, below) = (at(&point, 32, 6), at(&point, 32, 57));
        assert!(above.a() > 0 && below.a() > 0);
        assert_eq!(at(&spot, 32, 6).a(), 0);
        assert_eq!(at(&spot, 32, 57), below);
    }
}
