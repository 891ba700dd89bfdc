//! What a picture of a world shows: one list for the frame, both path tracers and `--view`.
//!
//! Direct light is the sky and the emission that the camera itself sees, and the light that surfaces reflect straight
//! from lamps and sun. Indirect light is the rest: light that has met another surface before, or that comes from
//! the sky or from emissive voxels, reflected by the surface.

/// What a picture shows. The command line's `--view` spells these in kebab case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum View {
    /// Direct light + albedo · indirect irradiance + emission.
    #[default]
    Full,
    /// Direct light and emission alone.
    Direct,
    /// Light that has bounced at least once, reflected by the surface.
    Indirect,
    /// Incoming indirect irradiance (over π), before the albedo.
    Irradiance,
    Albedo,
    Normal,
    /// White near, half as bright with every 32 voxels.
    Depth,
    /// Steps of the camera ray, in the colours of magma.
    Steps,
    /// The cage of probes that lights each point, one colour each.
    Cage,
    /// As full, with every texture replaced by its mean.
    TexturesOff,
    /// What the probes that light each point are doing, weighted as their light. Green: alive; yellow: alive
    /// and moved out of a solid voxel; pink: back-side probes; light blue: updated now and then; indigo: asleep; wine:
    /// none gives light there.
    States,
    /// What the occlusion field keeps at each point: white sees the lamps, black does not; wine: the field keeps
    /// nothing there. `occlusion.shown` chooses what is shown.
    Occlusion,
}

crate::shared! {
    in frame;

    enum View as VIEW {
        Full, Direct, Indirect, Irradiance, Albedo, Normal, Depth, Steps, Cage, TexturesOff, States,
        Occlusion,
    }

    /// Voxels over which the view of depth loses half its light.
    const DEPTH_HALF: f32 = 32.0;
}

impl View {
    /// Views of data are not light: no exposure and no tone mapping.
    pub fn is_data(self) -> bool {
        use View::{Albedo, Cage, Depth, Normal, Occlusion, States, Steps};
        matches!(
            self,
            Albedo | Normal | Depth | Steps | Cage | States | Occlusion
        )
    }

    /// Whether path tracers have this view. The other views show how probes light a picture.
    pub fn is_traceable(self) -> bool {
        !matches!(
            self,
            Self::Steps | Self::Cage | Self::States | Self::Occlusion
        )
    }

    /// Whether a path tracer's samples of one camera ray differ. Direct light is random where lamps are spheres.
    pub fn is_random(self, has_spheres: bool) -> bool {
        self.shows_bounces() || (self == Self::Direct && has_spheres)
    }

    /// Whether it shows light that has met another surface before.
    pub fn shows_bounces(self) -> bool {
        use View::{Full, Indirect, Irradiance, TexturesOff};
        matches!(self, Full | Indirect | Irradiance | TexturesOff)
    }

    /// What the view of depth shows of a surface at a distance of N voxels.
    pub fn depth_shown(distance: f32) -> f32 {
        (-distance / DEPTH_HALF).exp2()
    }
}
