//! What a material sounds like.

use glam::Vec3;
use serde::Deserialize;

use super::Colour;

/// The sound of a material that is walked on, dug or placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum MaterialSound {
    /// Hard and bright; echoes.
    Stone,
    /// Soft and dull.
    Soil,
    /// Rustles.
    Grass,
    /// Hollow.
    Wood,
    /// Rings softly, like glass: what shines.
    Glow,
}

/// Parts of names that tell what a material is. The first that fits counts: a `moss stone` is green on top.
const NAMES: [(MaterialSound, &[&str]); 4] = [
    (
        MaterialSound::Grass,
        &[
            "grass", "moss", "leaf", "leaves", "fern", "lichen", "ivy", "lawn",
        ],
    ),
    (
        MaterialSound::Wood,
        &[
            "wood", "plank", "trunk", "bark", "stem", "timber", "beam", "board", "oak", "door",
        ],
    ),
    (
        MaterialSound::Soil,
        &[
            "soil", "dirt", "earth", "ground", "gravel", "sand", "mud", "clay", "snow", "cap",
        ],
    ),
    (
        MaterialSound::Stone,
        &[
            "stone", "rock", "brick", "tile", "marble", "granite", "slate", "plaster", "wall",
        ],
    ),
];

impl MaterialSound {
    pub const ALL: [Self; 5] = [Self::Stone, Self::Soil, Self::Grass, Self::Wood, Self::Glow];

    /// The sound of a material whose file names none: by its light, its name, its colour.
    pub fn of_look(name: &str, colour: &Colour, emission: Vec3) -> Self {
        if emission != Vec3::ZERO {
            return Self::Glow;
        }
        let name = name.to_lowercase();
        let named = NAMES
            .iter()
            .find(|(_, parts)| parts.iter().any(|part| name.contains(part)));
        named.map_or_else(|| Self::of_colour(typical(colour)), |(sound, _)| *sound)
    }

    /// Green is grass, brown is soil, and all else is stone.
    fn of_colour(albedo: Vec3) -> Self {
        let Vec3 {
            x: red,
            y: green,
            z: blue,
        } = albedo;
        if green > 1.25 * red && green > 1.25 * blue {
            Self::Grass
        } else if red > 1.2 * green && green > 1.2 * blue && red < 0.6 {
            Self::Soil
        } else {
            Self::Stone
        }
    }
}

/// One colour for all voxels of a material.
fn typical(colour: &Colour) -> Vec3 {
    match colour {
        Colour::Flat(albedo) | Colour::Bands { above: albedo, .. } => *albedo,
        Colour::DitherX { low, high, .. } | Colour::Hash(low, high) => 0.5 * (*low + *high),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_goes_before_the_name_and_the_name_before_the_colour() {
        let sound = |name: &str, albedo: [f32; 3], emission: f32| {
            let colour = Colour::Flat(albedo.into());
            MaterialSound::of_look(name, &colour, Vec3::splat(emission))
        };
        let (grey, green, brown) = ([0.5; 3], [0.1, 0.4, 0.1], [0.3, 0.18, 0.08]);
        assert_eq!(sound("lava", grey, 4.0), MaterialSound::Glow);
        assert_eq!(sound("Oak planks", green, 0.0), MaterialSound::Wood);
        assert_eq!(sound("mossy stone", grey, 0.0), MaterialSound::Grass);
        assert_eq!(sound("floor", green, 0.0), MaterialSound::Grass);
        assert_eq!(sound("floor", brown, 0.0), MaterialSound::Soil);
        assert_eq!(sound("floor", grey, 0.0), MaterialSound::Stone);
        assert_eq!(sound("red", [0.6, 0.05, 0.05], 0.0), MaterialSound::Stone);
    }
}
