//! Parameters whose values are words.

use super::{Kind, Value};

/// Declares a choice: an enum whose values are words.
macro_rules! choice {
    (
        $(#[$meta:meta])*
        $Choice:ident { $($(#[$variant_meta:meta])* $Variant:ident = $word:literal,)+ }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $Choice {
            $($(#[$variant_meta])* $Variant,)+
        }

        impl $Choice {
            pub(super) const KIND: Kind = Kind::Choice { words: &[$($word),+] };
        }

        impl From<$Choice> for Value {
            fn from(choice: $Choice) -> Self {
                Value::Choice(match choice { $($Choice::$Variant => $word,)+ })
            }
        }

        impl TryFrom<Value> for $Choice {
            type Error = Value;

            fn try_from(value: Value) -> Result<Self, Value> {
                match value {
                    $(Value::Choice($word) => Ok($Choice::$Variant),)+
                    other => Err(other),
                }
            }
        }
    };
}

choice! {
    /// How a probe behind a wall loses its weight.
    Visibility {
        /// By the mean and the variance of the distances that the probe's rays measured (Majercik et
        /// al. 2019).
        Chebyshev = "chebyshev",
        /// By marching: one bit for every voxel of air that borders on a solid voxel within 20 voxels of the probe in its
        /// cages; the gather itself marches from points farther off.
        Exact = "exact",
        /// Exact, but by distances for nested levels that follow the camera, where that is more accurate and much faster.
        Auto = "auto",
    }
}

choice! {
    /// What happens to a probe whose lattice point lies in a solid voxel.
    Relocation {
        /// The probe is dead.
        Off = "off",
        /// The probe moves to the nearest air, if that is near enough.
        Exact = "exact",
    }
}

choice! {
    /// The algorithm that lights the picture.
    Method {
        /// Ours.
        Grotto = "grotto",
        /// The algorithm of the published DDGI systems that grotto is compared with: probes alone,
        /// which estimate visibility from distances.
        Source = "source",
    }
}

choice! {
    /// Weights of a cage's probes at a point under [`Method::Source`]. Each variant includes the
    /// previous ones.
    SourceWeights {
        /// By position on the lattice alone: walls hide nothing.
        Trilinear = "trilinear",
        /// Also reduced, the farther a probe lies behind the surface.
        Direction = "direction",
        /// Also by Chebyshev's bound on the probe's visibility.
        Visibility = "visibility",
        /// Small weights are reduced further, because the eye is sensitive to faint light.
        Perception = "perception",
        /// A moved probe also moves its corner of the cage.
        Adjusted = "adjusted",
    }
}

choice! {
    /// What happens to a probe in a solid voxel under [`Method::Source`].
    SourceRelocation {
        /// The probe is dead.
        Off = "off",
        /// The probe walks along the axes until its rays start in air.
        Surface = "surface",
        /// The probe also walks until it is a voxel away from surfaces.
        Clear = "clear",
    }
}

choice! {
    /// What happens to a distance that is too long for any cage under [`Method::Source`].
    SourceDepth {
        /// It counts as the longest possible distance: the mean says "far".
        Clamp = "clamp",
        /// It is left out: the mean covers only near surfaces.
        Reject = "reject",
    }
}

choice! {
    /// Whether probes that no pixel requests sleep.
    ProbeStates {
        /// Every probe outside solid voxels is updated in every frame.
        Off = "off",
        /// Probes that nothing needs now are updated only occasionally.
        On = "on",
    }
}

choice! {
    /// Whether visible surfaces trace rays for their own light.
    FinalGather {
        /// Surfaces take their light from the surrounding probes.
        Off = "off",
        /// Rays from each face find its light; the probes light what those rays hit.
        On = "on",
    }
}

choice! {
    /// What the view of occlusion shows of the occlusion field.
    OcclusionShown {
        /// The product of the visibilities of all lamps that the field keeps.
        All = "all",
        /// How open the surroundings of each point are.
        Ambient = "ambient",
        /// The visibility of one lamp: the field's first, second, and so on.
        First = "1",
        Second = "2",
        Third = "3",
        Fourth = "4",
        Fifth = "5",
        Sixth = "6",
        Seventh = "7",
        Eighth = "8",
    }
}

impl OcclusionShown {
    /// Which of the field's lamps is shown alone, counted from 0.
    pub fn lamp(self) -> Option<u32> {
        match self {
            Self::All | Self::Ambient => None,
            Self::First => Some(0),
            Self::Second => Some(1),
            Self::Third => Some(2),
            Self::Fourth => Some(3),
            Self::Fifth => Some(4),
            Self::Sixth => Some(5),
            Self::Seventh => Some(6),
            Self::Eighth => Some(7),
        }
    }
}

choice! {
    /// What says whether a point of the picture sees a lamp.
    #[derive(Default)]
    Shadows {
        /// Shadow rays.
        #[default]
        Rays = "rays",
        /// The occlusion field, for the lamps that it keeps.
        Field = "field",
    }
}

choice! {
    /// How edges are smoothed.
    #[derive(Default)]
    Antialias {
        /// One ray through the centre of each pixel.
        #[default]
        Off = "off",
        /// Frames with jittered rays are averaged.
        Temporal = "temporal",
    }
}
