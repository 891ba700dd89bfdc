//! Every tunable, declared once.
//!
//! The table below gives the typed structs with their defaults, and [`KEYS`], which `--set`, `grotto
//! info --keys` and the panel read. A key is `section.field`. Users read the one line above a field, so
//! it says what higher and lower values cost.

#[macro_use]
mod choices;
mod key;
mod nearest;
mod probes;
mod removed;
mod value;

use std::ops::RangeInclusive;

use glam::{UVec3, Vec3};

pub use choices::{
    Antialias, FinalGather, Method, OcclusionShown, ProbeStates, Relocation, Shadows, SourceDepth,
    SourceRelocation, SourceWeights, Visibility,
};
pub use key::{Key, ParameterError, Remake};
pub use nearest::nearest;
pub use probes::{ProbeHits, RayLattice};
pub use value::{Kind, Value};

/// Declares the sections: per field one doc line, type, default, kind, and what a change rebuilds. A
/// section may have others `within` it.
macro_rules! parameters {
    ($(
        #[doc = $section_doc:literal]
        $section:ident: $Section:ident {
            $(
                #[doc = $doc:literal]
                $field:ident: $type:ty = $default:expr, $kind:expr, $remake:ident;
            )+
            $(
                within
                #[doc = $inner_doc:literal]
                $inner:ident: $Inner:ident {
                    $(
                        #[doc = $inner_field_doc:literal]
                        $inner_field:ident: $inner_type:ty = $inner_default:expr,
                            $inner_kind:expr, $inner_remake:ident;
                    )+
                }
            )*
        }
    )+) => {
        /// All tunables. `Default` gives the values of a user who sets nothing.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Parameters {
            $(#[doc = $section_doc] pub $section: $Section,)+
        }

        $(
            #[doc = $section_doc]
            #[derive(Clone, Debug, PartialEq)]
            pub struct $Section {
                $(#[doc = $doc] pub $field: $type,)+
                $(#[doc = $inner_doc] pub $inner: $Inner,)*
            }

            impl Default for $Section {
                fn default() -> Self {
                    Self {
                        $($field: $default,)+
                        $($inner: $Inner::default(),)*
                    }
                }
            }

            $(
                #[doc = $inner_doc]
                #[derive(Clone, Debug, PartialEq)]
                pub struct $Inner {
                    $(#[doc = $inner_field_doc] pub $inner_field: $inner_type,)+
                }

                impl Default for $Inner {
                    fn default() -> Self {
                        Self { $($inner_field: $inner_default,)+ }
                    }
                }
            )*
        )+

        /// Every key, section by section.
        pub static KEYS: &[Key] = &[$(
            $(key!($section.$field, [$section], $field, $doc, $kind, $remake),)+
            $($(key!(
                $inner.$inner_field, [$section.$inner], $inner_field,
                $inner_field_doc, $inner_kind, $inner_remake
            ),)+)*
        )+];
    };
}

/// One entry of [`KEYS`]: its name, the path to its section, and its description.
macro_rules! key {
    (
        $prefix:ident.$name:ident, [$($path:ident).+], $field:ident, $doc:expr, $kind:expr, $remake:ident
    ) => {
        Key {
            name: concat!(stringify!($prefix), ".", stringify!($name)),
            doc: $doc,
            kind: $kind,
            remake: Remake::$remake,
            get: |parameters| parameters.$($path).+.$field.clone().into(),
            put: |parameters, value| {
                parameters.$($path).+.$field = value
                    .try_into()
                    .expect("a value is checked against its kind, which matches the type");
            },
        }
    };
}

parameters! {
    #[doc = "What is voxelised."]
    world: WorldParameters {
        #[doc = "Size of the world in voxels, instead of the file's. Memory and build time grow with the area of its surfaces."]
        size: Option<UVec3> = None, Kind::Size { max: 4096 }, World;
        #[doc = "Seed of noise, scatter and flicker, instead of the file's."]
        seed: Option<u32> = None, Kind::Seed, World;
        #[doc = "Whether the world has the bodies of its file. Off shows what they cost."]
        bodies: bool = true, Kind::Flag, World;
    }

    #[doc = "Overrides of every material of the world, for closed forms."]
    materials: MaterialParameters {
        #[doc = "Albedo of every material, instead of the file's. Values near 1 take many frames to settle."]
        albedo: Option<Vec3> = None, Kind::Colour { max: 1.0 }, World;
        #[doc = "Emitted radiance of every material, instead of the file's."]
        emission: Option<Vec3> = None, Kind::Colour { max: 65504.0 }, World;
    }

    #[doc = "The probe field."]
    probes: ProbeParameters {
        #[doc = "Rays per probe and update. Twice as many cost twice the tracing time and reduce noise by 30 %."]
        rays: u32 = 128, Kind::Count { min: LEAST_RAYS, max: 4096 }, Probes;
        #[doc = "Whether probes keep what their rays hit: traced marches every ray of every update in a new direction; kept marches a ray again only when voxels change on it or its probe moves, and lights what it hit in every update. kept is faster and takes 8 bytes per ray and set; its fixed directions miss what lies between them."]
        hits: ProbeHits = ProbeHits::Traced, ProbeHits::KIND, Probes;
        #[doc = "Sets of directions that updates take in turn under probes.hits=kept, each turned differently and each kept. 1 is a fixed pattern, whose error stays; more average it away and take as much more memory."]
        hit_sets: u32 = 1, Kind::Count { min: 1, max: MOST_HIT_SETS }, Probes;
        #[doc = "How the directions of a probe's rays lie on the sphere: fibonacci is the more even; latlong, rows of latitude, is there for comparison."]
        lattice: RayLattice = RayLattice::Fibonacci, RayLattice::KIND, Probes;
        #[doc = "Share of probes.rays that an update traces; probes.hits=kept always takes all. Less is faster and noisier. It changes at once and the probes keep their light."]
        ray_share: f32 = 1.0, Kind::Number { min: 0.05, max: 1.0 }, Nothing;
        #[doc = "Share of a probe's old light that each update keeps. More is steadier; less reacts sooner."]
        hysteresis: f32 = 0.97, Kind::Number { min: 0.0, max: 0.999 }, Nothing;
        #[doc = "How probes behind walls are left out. exact marches a ray to every surface voxel near a probe once and leaks nothing; where probes are more than 20 voxels apart, it also marches in every frame. chebyshev estimates from stored distances and leaks a little at thin walls. auto: exact, but chebyshev for cascades that follow the camera."]
        visibility: Visibility = Visibility::Auto, Visibility::KIND, Probes;
        #[doc = "Whether each visible voxel face traces rays of its own and keeps their light. on shows light as it falls on each face; off interpolates between probes, which is coarser."]
        final_gather: FinalGather = FinalGather::On, FinalGather::KIND, Probes;
        #[doc = "Final gather: most rays that are averaged per quadrant of a face. More is less noisy; less follows slow changes sooner."]
        face_samples: u32 = 8192, Kind::Count { min: 16, max: 1_000_000 }, Nothing;
        #[doc = "Final gather: share of a frame's budget of rays that faces may use. Less is faster; faces that come into view stay grainy longer."]
        face_share: f32 = 1.0, Kind::Number { min: 0.05, max: 1.0 }, Nothing;
        #[doc = "Final gather: faces of voxels narrower than this many pixels are lit by the probes instead. More is faster in the distance; less is truer there."]
        face_pixels: f32 = 1.0, Kind::Number { min: 0.5, max: 1000.0 }, Nothing;
        #[doc = "Whether probes that light nothing visible are updated less often. on saves most of the probes' time; off updates every probe outside of solid voxels in every frame."]
        states: ProbeStates = ProbeStates::On, ProbeStates::KIND, Nothing;
        #[doc = "Frames that a probe stays awake after a pixel last used it. 64 is enough for every pixel to have its turn; less sleeps sooner."]
        alive_frames: u32 = 64, Kind::Count { min: 1, max: 100_000 }, Nothing;
        #[doc = "How much a probe's light must change (0 to 1) for updates in every frame, even if no pixel uses it. Less follows lamps sooner; 1 switches this off."]
        variability: f32 = 0.1, Kind::Number { min: 0.0, max: 1.0 }, Nothing;
        #[doc = "Probes whose place lies in a solid voxel: exact moves them to the nearest air, off leaves them out. exact lights corners truer and traces more probes."]
        relocation: Relocation = Relocation::Exact, Relocation::KIND, Probes;
        #[doc = "Width of a probe's irradiance map in texels. More resolves sharper light; memory and time grow with its square."]
        irradiance_texels: u32 = 8, Kind::Count { min: 4, max: 32 }, Probes;
        #[doc = "Width of a probe's distance map in texels (visibility chebyshev). More leaks less at thin walls; memory and time grow with its square."]
        distance_texels: u32 = 16, Kind::Count { min: 4, max: 64 }, Probes;
        #[doc = "How far a surface point is moved along its normal before it reads the probes, in voxels. More leaks less from behind; less keeps contact shadows."]
        normal_bias: f32 = 0.1, Kind::Number { min: 0.0, max: 2.0 }, Nothing;
        #[doc = "First frames of new probes, in which each update replaces the light instead of averaging; each frame adds one bounce. Worlds with materials of albedo above 0.875 take more by themselves. More is truer where light is reflected often; fewer settle sooner."]
        warmup_frames: u32 = 40, Kind::Count { min: 0, max: 1000 }, Nothing;
        #[doc = "How far light must depart from a probe's average to count as a change, in standard deviations of its noise. Less reacts sooner; more flickers less; 1000 never reacts."]
        change_deviations: f32 = 3.0, Kind::Number { min: 0.0, max: 1000.0 }, Nothing;
        #[doc = "Limits the luminance of a probe ray to this multiple of the probe's mean. Less is steadier but loses light of small bright things; 0 does not limit."]
        firefly_clamp: f32 = 0.0, Kind::Number { min: 0.0, max: 65504.0 }, Nothing;
        #[doc = "The lighting algorithm: grotto's own, or source for classic DDGI as other systems have it (probes alone, without final gather). The keys source.* choose its parts."]
        method: Method = Method::Grotto, Method::KIND, Probes;
        within
        #[doc = "The algorithm of `probes.method=source`, part by part."]
        source: SourceParameters {
            #[doc = "Weights of probes; each choice includes the ones before. trilinear: by distance. direction: less from behind the surface. visibility: Chebyshev's test. perception: small weights are reduced further. adjusted: moved probes move their corner of the cell."]
            weights: SourceWeights = SourceWeights::Perception, SourceWeights::KIND, Probes;
            #[doc = "Probes in solid voxels: off leaves them out, surface moves them step by step until their rays start in air, clear also keeps them a voxel away from surfaces."]
            relocation: SourceRelocation = SourceRelocation::Off, SourceRelocation::KIND, Probes;
            #[doc = "Distances too long to matter for any surface point: clamp shortens them, reject ignores them and keeps near walls sharper."]
            depth: SourceDepth = SourceDepth::Clamp, SourceDepth::KIND, Probes;
        }
        within
        #[doc = "The occlusion field: what the surfaces around each probe see of lamps and of their surroundings."]
        occlusion: OcclusionParameters {
            #[doc = "Lamps whose visibility the probes keep: the brightest at the camera. Each costs a shadow ray per probe ray, and a value in each texel; 0 keeps none and costs nothing."]
            lamps: u32 = 0, Kind::Count { min: 0, max: MOST_OCCLUSION_LAMPS }, Probes;
            #[doc = "Whether probes keep how open the surroundings of surfaces are, and the picture's indirect light is multiplied by that. It darkens corners whose light is already dark; it is not physical."]
            ambient: bool = false, Kind::Flag, Probes;
            #[doc = "Length of the rays of occlusion.ambient in voxels. More darkens larger corners and takes longer; less keeps to contacts."]
            radius: f32 = 12.0, Kind::Number { min: 0.5, max: 1000.0 }, Nothing;
            #[doc = "Width of a map of the occlusion field in texels. More resolves sharper shadows; memory and time grow with its square."]
            texels: u32 = 16, Kind::Count { min: 4, max: 64 }, Probes;
            #[doc = "Exponent of every value that is read from the field. Above 1 shadows are darker and their edges steeper; 1 shows the mean itself."]
            sharpness: f32 = 1.0, Kind::Number { min: 0.1, max: 16.0 }, Nothing;
            #[doc = "What --view occlusion shows: all for the product of all lamps, 1 to 8 for one lamp of the field, ambient for the openness."]
            shown: OcclusionShown = OcclusionShown::All, OcclusionShown::KIND, Nothing;
        }
    }

    #[doc = "The lamps."]
    lights: LightParameters {
        #[doc = "Name of a lamp preset; empty takes the world's first. A lamp that moves costs a shadow ray per pixel; one that rests, only where a voxel face sees it in part."]
        preset: String = String::new(), Kind::Name, Nothing;
        #[doc = "Whether lamps move and flicker with world time. Off lets the light settle."]
        animate: bool = true, Kind::Flag, Nothing;
        #[doc = "Only this many lamps of the preset are lit, the first ones. Fewer are faster, above all when they move."]
        max_lamps: u32 = 65_536, Kind::Count { min: 0, max: 65_536 }, Nothing;
        #[doc = "Shadow rays per pixel to each lamp with a soft_radius, where a voxel face sees it in part. More is less grainy and costs as much more; with picture.antialias=off there are four times as many, because no frames are averaged."]
        soft_rays: u32 = 4, Kind::Count { min: 1, max: 256 }, Nothing;
        #[doc = "What shadows the direct light of lamps in the picture: rays, or field for the occlusion field in place of rays to the lamps that it keeps (occlusion.lamps). The field is soft, coarse and free of noise."]
        shadows: Shadows = Shadows::Rays, Shadows::KIND, Nothing;
    }

    #[doc = "From linear light to the display."]
    picture: PictureParameters {
        #[doc = "Exposure of PNG files and of the window in stops; 1 is twice as bright. EXR files stay linear."]
        exposure_ev: f32 = 0.0, Kind::Number { min: -20.0, max: 20.0 }, Nothing;
        #[doc = "How edges are smoothed in the window and in render: temporal averages jittered frames and takes 32 bytes per pixel; off shows steps. Tables always measure pixels at their centres."]
        antialias: Antialias = Antialias::Temporal, Antialias::KIND, Nothing;
        #[doc = "Edge length of the rendered picture, as a share of the one that is shown. Below 1 anti-aliasing fills in the other pixels from earlier frames. Time falls with the square of the scale; what has just come into view is coarser."]
        scale: f32 = 1.0, Kind::Number { min: *SCALES.start(), max: *SCALES.end() }, Nothing;
    }

    #[doc = "Block textures."]
    textures: TextureParameters {
        #[doc = "Whether voxel faces show their procedural textures. Off shows plain colours."]
        enabled: bool = true, Kind::Flag, Nothing;
    }
}

/// Values of `picture.scale`. Below one half fewer than one pixel of four would have a ray in a frame.
pub const SCALES: RangeInclusive<f32> = 0.5..=1.0;

/// Most lamps whose visibility probes can keep.
pub const MOST_OCCLUSION_LAMPS: u32 = 8;

/// Fewest rays of an update: the least value of `probes.rays`.
const LEAST_RAYS: u32 = 8;

/// Most sets of directions whose hits are kept.
const MOST_HIT_SETS: u32 = 64;

impl Parameters {
    /// Applies `KEY=VALUE`, as `--set` gives it.
    ///
    /// # Errors
    /// What is wrong with the assignment, what the key takes, and the nearest keys to an unknown one.
    pub fn set(&mut self, assignment: &str) -> Result<(), ParameterError> {
        let (name, text) = assignment
            .split_once('=')
            .ok_or_else(|| ParameterError::NotAnAssignment(assignment.to_owned()))?;
        let key = Key::find(name.trim())?;
        key.set(self, key.parse(text.trim())?)
    }

    /// Whether the values go together.
    ///
    /// # Errors
    /// [`ParameterError::Contradiction`] for direct light that a field without lamps would shadow.
    pub fn check(&self) -> Result<(), ParameterError> {
        if self.lights.shadows == Shadows::Field && self.probes.occlusion.lamps == 0 {
            return Err(ParameterError::Contradiction {
                assignment: "lights.shadows=field".to_owned(),
                needs: "lamps in the occlusion field: occlusion.lamps=1 or more".to_owned(),
            });
        }
        Ok(())
    }

    /// Whether the occlusion field keeps what the view of occlusion is to show.
    ///
    /// # Errors
    /// [`ParameterError::Contradiction`] otherwise.
    pub fn check_occlusion_shown(&self) -> Result<(), ParameterError> {
        let OcclusionParameters { lamps, ambient, .. } = self.probes.occlusion;
        let shown = self.probes.occlusion.shown;
        let needs = match shown.lamp() {
            _ if shown == OcclusionShown::Ambient && ambient => return Ok(()),
            _ if shown == OcclusionShown::Ambient => "occlusion.ambient=on".to_owned(),
            Some(lamp) if lamp >= lamps => format!("occlusion.lamps={} or more", lamp + 1),
            None if lamps == 0 => "occlusion.lamps=1 or more".to_owned(),
            Some(_) | None => return Ok(()),
        };
        Err(ParameterError::Contradiction {
            assignment: format!("occlusion.shown={}", Value::from(shown)),
            needs,
        })
    }

    /// The most that must be rebuilt when these parameters change to `next`.
    pub fn remake_for(&self, next: &Self) -> Remake {
        KEYS.iter()
            .filter(|key| key.get(self) != key.get(next))
            .map(|key| key.remake)
            .max()
            .unwrap_or(Remake::Nothing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(assignment: &str) -> String {
        let before = Parameters::default();
        let mut parameters = before.clone();
        let error = parameters.set(assignment).expect_err(assignment);
        assert_eq!(parameters, before, "{assignment} changed something");
        error.to_string()
    }

    #[test]
    fn every_default_is_a_value_that_its_key_takes_and_prints() {
        let defaults = Parameters::default();
        for key in KEYS {
            let mut parameters = defaults.clone();
            let value = key.get(&defaults);
            key.set(&mut parameters, value.clone()).expect(key.name);
            assert_eq!(parameters, defaults, "{}", key.name);
            assert_eq!(key.parse(&value.to_string()), Ok(value), "{}", key.name);
        }
    }

    #[test]
    fn keys_are_unique_and_documented_in_one_line() {
        for (index, key) in KEYS.iter().enumerate() {
            assert!(
                KEYS[..index].iter().all(|other| other.name != key.name),
                "{} twice",
                key.name
            );
            assert!(
                key.doc.ends_with('.') && !key.doc.contains('\n'),
                "{}",
                key.name
            );
        }
    }

    #[test]
    fn assignments_of_every_kind_arrive() {
        let mut parameters = Parameters::default();
        for assignment in [
            "probes.rays=400",
            "probes.hysteresis = 0.9",
            "probes.visibility=chebyshev",
            "probes.states=on",
            "lights.preset=four lamps",
            "lights.animate=off",
            "textures.enabled=false",
            "world.size=2048x512x2048",
            "world.seed=7",
            "materials.albedo=0.5",
            "materials.emission=1,0,0.25",
            "picture.exposure_ev=-1.5",
        ] {
            parameters.set(assignment).expect(assignment);
        }
        assert_eq!(parameters.probes.rays, 400);
        assert_eq!(parameters.probes.hysteresis, 0.9);
        assert_eq!(parameters.probes.visibility, Visibility::Chebyshev);
        assert_eq!(parameters.lights.preset, "four lamps");
        assert!(!parameters.lights.animate);
        assert!(!parameters.textures.enabled);
        assert_eq!(parameters.world.size, Some(UVec3::new(2048, 512, 2048)));
        assert_eq!(parameters.world.seed, Some(7));
        assert_eq!(parameters.materials.albedo, Some(Vec3::splat(0.5)));
        assert_eq!(
            parameters.materials.emission,
            Some(Vec3::new(1.0, 0.0, 0.25))
        );
        assert_eq!(parameters.picture.exposure_ev, -1.5);
    }

    #[test]
    fn bad_assignments_say_what_would_be_valid() {
        for (assignment, parts) in [
            ("probes.rays", ["`probes.rays`", "KEY=VALUE"]),
            ("probes.ray=8", ["`probes.ray`", "`probes.rays`"]),
            ("prbes.rays=8", ["`prbes.rays`", "`probes.rays`"]),
            ("hysteresis=0.9", ["`hysteresis`", "`probes.hysteresis`"]),
            ("qqqq=1", ["`qqqq`", "grotto info --keys"]),
            (
                "probes.rays=many",
                ["whole number from 8 to 4096", "`many`"],
            ),
            (
                "probes.rays=4097",
                ["whole number from 8 to 4096", "`4097`"],
            ),
            ("probes.rays=-1", ["whole number from 8 to 4096", "`-1`"]),
            ("probes.hysteresis=NaN", ["number from 0 to 0.999", "`NaN`"]),
            ("probes.hysteresis=inf", ["number from 0 to 0.999", "`inf`"]),
            ("probes.hysteresis=1", ["number from 0 to 0.999", "`1`"]),
            (
                "probes.visibility=some",
                ["chebyshev, exact, auto", "`some`"],
            ),
            ("probes.states=maybe", ["off, on", "`maybe`"]),
            (
                "probes.alive_frames=0",
                ["whole number from 1 to 100000", "`0`"],
            ),
            ("picture.scale=0.4", ["number from 0.5 to 1", "`0.4`"]),
            ("picture.scale=2", ["number from 0.5 to 1", "`2`"]),
            ("picture.scale=nan", ["number from 0.5 to 1", "`nan`"]),
            ("picture.scale=half", ["number from 0.5 to 1", "`half`"]),
            ("probes.method=theirs", ["grotto, source", "`theirs`"]),
            ("source.weights=even", ["trilinear, direction", "`even`"]),
            ("lights.animate=maybe", ["on or off", "`maybe`"]),
            ("world.size=0x1x1", ["from 1 to 4096", "`0x1x1`"]),
            ("world.size=64x64", ["WIDTHxHEIGHTxDEPTH", "`64x64`"]),
            ("world.size=9999x1x1", ["from 1 to 4096", "`9999x1x1`"]),
            ("world.seed=-3", ["whole number", "`-3`"]),
            ("materials.albedo=1.5", ["from 0 to 1", "`1.5`"]),
            ("materials.albedo=0.1,0.2", ["R,G,B", "`0.1,0.2`"]),
            ("materials.emission=nan", ["from 0 to 65504", "`nan`"]),
        ] {
            let message = refusal(assignment);
            for part in parts {
                assert!(message.contains(part), "{assignment}: {message}");
            }
        }
    }

    #[test]
    fn what_a_field_does_not_keep_is_neither_used_nor_shown() {
        let mut parameters = Parameters::default();
        let set = |parameters: &mut Parameters, assignment| {
            parameters.set(assignment).expect("a key and a value");
        };
        let fault = |found: Result<(), ParameterError>| found.expect_err("missing").to_string();
        assert_eq!(parameters.check(), Ok(()));
        assert!(fault(parameters.check_occlusion_shown()).contains("occlusion.lamps=1"));
        set(&mut parameters, "lights.shadows=field");
        assert!(fault(parameters.check()).contains("occlusion.lamps=1"));
        set(&mut parameters, "occlusion.lamps=2");
        assert_eq!(parameters.check(), Ok(()));
        assert_eq!(parameters.check_occlusion_shown(), Ok(()));
        set(&mut parameters, "occlusion.shown=3");
        let message = fault(parameters.check_occlusion_shown());
        assert_eq!(
            message,
            "`occlusion.shown=3` needs occlusion.lamps=3 or more"
        );
        set(&mut parameters, "occlusion.shown=ambient");
        assert!(fault(parameters.check_occlusion_shown()).contains("occlusion.ambient=on"));
        set(&mut parameters, "occlusion.ambient=on");
        assert_eq!(parameters.check_occlusion_shown(), Ok(()));
        assert!(parameters.set("occlusion.lamps=9").is_err());
    }

    #[test]
    fn a_panel_cannot_set_what_a_flag_cannot() {
        let key = Key::find("probes.rays").expect("a key");
        let mut parameters = Parameters::default();
        for value in [Value::Count(7), Value::Flag(true), Value::Number(64.0)] {
            assert!(key.set(&mut parameters, value).is_err());
        }
        let key = Key::find("probes.hysteresis").expect("a key");
        assert!(key.set(&mut parameters, Value::Number(f32::NAN)).is_err());
        assert_eq!(parameters, Parameters::default());
    }

    #[test]
    fn a_change_names_the_most_that_must_be_rebuilt() {
        let old = Parameters::default();
        let mut new = old.clone();
        assert_eq!(old.remake_for(&new), Remake::Nothing);
        new.picture.exposure_ev = 2.0;
        assert_eq!(old.remake_for(&new), Remake::Nothing);
        new.probes.distance_texels = 8;
        assert_eq!(old.remake_for(&new), Remake::Probes);
        new.world.seed = Some(1);
        assert_eq!(old.remake_for(&new), Remake::World);
    }
}
