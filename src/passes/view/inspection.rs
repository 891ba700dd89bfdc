//! What a picture shows of the probes themselves.

use crate::probes::AtlasLayout;
use crate::world::View;

/// What a probe's sphere is coloured by. The command line's `--probes` spells these in kebab case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum ProbeColour {
    /// Light that arrives from the direction that the sphere's surface faces: the probe's map of irradiance.
    Irradiance,
    /// Green: alive; yellow: alive and moved; pink: a back-side probe; light blue: indirect-only; indigo: asleep;
    /// wine: dead. Lines start at the probes' lattice points.
    State,
    /// How far the probe has moved, in the colours of magma: black is not at all, white is a spacing. Lines start at
    /// the probes' lattice points.
    Offset,
    /// One colour for each level of cascades, as in the view `cage`.
    Cascade,
}

/// Which of the two textures that hold the probes' maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AtlasMap {
    /// Irradiance over π.
    Irradiance,
    /// Mean distance (red) and mean of squares (green), in units of the longest distance and its square.
    Distance,
}

crate::shared! {
    in view;
    enum ProbeColour as COLOUR { Irradiance, State, Offset, Cascade }
    enum AtlasMap as MAP { Irradiance, Distance }
}

/// One layer of an atlas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AtlasLayer {
    pub map: AtlasMap,
    pub layer: u32,
}

/// What is drawn of the probes themselves, besides their light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inspection {
    pub view: View,
    /// Spheres at the places of the probes, over any view.
    pub probes: Option<ProbeColour>,
    /// Shown in place of the picture.
    pub atlas: Option<AtlasLayer>,
}

/// Why there is nothing to show.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InspectionError {
    #[error(
        "the atlas of {map} has {layers} {}, numbered from 0: there is no layer {layer}",
        if *.layers == 1 { "layer" } else { "layers" }
    )]
    NoLayer {
        map: &'static str,
        layer: u32,
        layers: u32,
    },
    #[error(
        "these probes store no maps of distance, because their visibility is exact. \
         --set probes.visibility=chebyshev stores the maps."
    )]
    NoDistances,
}

impl AtlasMap {
    pub const ALL: [Self; 2] = [Self::Irradiance, Self::Distance];

    /// Edge of a probe's map, without its border.
    pub fn texels(self, atlas: &AtlasLayout) -> u32 {
        match self {
            Self::Irradiance => atlas.irradiance_texels,
            Self::Distance => atlas.distance_texels,
        }
    }

    /// As `--atlas` spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Irradiance => "irradiance",
            Self::Distance => "distance",
        }
    }
}

impl AtlasLayer {
    /// Reads `irradiance:LAYER` or `distance:LAYER`.
    ///
    /// # Errors
    /// A message with the right spelling.
    pub fn parse(text: &str) -> Result<Self, String> {
        let read = || {
            let (name, layer) = text.split_once(':')?;
            let map = AtlasMap::ALL.into_iter().find(|map| map.name() == name)?;
            Some(Self {
                map,
                layer: layer.parse().ok()?,
            })
        };
        read().ok_or_else(|| {
            "write irradiance:LAYER or distance:LAYER, as in irradiance:0; layers are numbered from 0"
                .to_owned()
        })
    }

    /// # Errors
    /// [`InspectionError`] when the maps have no such layer.
    pub fn check(self, atlas: &AtlasLayout) -> Result<(), InspectionError> {
        if self.map == AtlasMap::Distance && atlas.distance_texels == 0 {
            return Err(InspectionError::NoDistances);
        }
        let layers = atlas.layers;
        if self.layer >= layers {
            return Err(InspectionError::NoLayer {
                map: self.map.name(),
                layer: self.layer,
                layers,
            });
        }
        Ok(())
    }
}

impl Inspection {
    /// Whether the picture shows `view` and nothing else.
    pub fn is_plain(&self) -> bool {
        self.probes.is_none() && self.atlas.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_spelled_by_map_and_number() {
        let distance = AtlasLayer {
            map: AtlasMap::Distance,
            layer: 12,
        };
        assert_eq!(AtlasLayer::parse("distance:12"), Ok(distance));
        for wrong in [
            "",
            "distance",
            "distance:",
            "depth:0",
            "irradiance:-1",
            "irradiance:x",
        ] {
            let error = AtlasLayer::parse(wrong).expect_err(wrong);
            assert!(error.contains("irradiance:LAYER"), "{error}");
        }
    }
}
