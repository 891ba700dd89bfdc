//! The keys of a world file, as they are written. `worlds/README.md` explains each with unit, default
//! and example; a test checks that it names them all.
//!
//! Numbers, names and texts stay `Leaf`s here: `resolve` reads them, so that a message about their
//! meaning can point at the exact characters. A key whose type is an `Option`, or that has a `default`,
//! may be left out.

#![allow(
    clippy::large_enum_variant,
    reason = "values of these types live only while a file is read"
)]

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};

use super::leaf::{Leaf, OneOrThree};
use crate::world::{materials::MaterialSound, sdf::WrittenSdf as Shape};

/// Three numbers: `(x, y, z)`, or `(r, g, b)` in linear Rec. 709.
#[derive(Clone, Debug, Deserialize)]
pub struct Vector(pub Leaf, pub Leaf, pub Leaf);

/// `{"name": value, …}` in the order of the file; `resolve` refuses a name that occurs twice.
#[derive(Clone, Debug)]
pub struct Named<T>(pub Vec<(Leaf, T)>);

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(std::marker::PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Named<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("names and their values, {\"name\": value, …}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Named(entries))
            }
        }

        deserializer.deserialize_map(Entries(std::marker::PhantomData))
    }
}

/// The whole file. Lengths are in voxels, +Y is up; only lamp powers use metres.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// One sentence: the purpose of the world.
    pub title: Leaf,
    /// Extent in voxels, whole numbers.
    pub size: Vector,
    /// World-space coordinates of the lowest corner, whole numbers. Default (0, 0, 0).
    pub origin: Option<Vector>,
    /// Metres per voxel. Default 1.
    pub voxel_m: Option<Leaf>,
    /// Seed of everything that names none. Default 0.
    pub seed: Option<Leaf>,
    /// `{"name": (basis: …), …}`
    #[serde(default)]
    pub noises: Named<Noise>,
    /// Where voxels are solid.
    pub shape: Shape,
    /// `{"name": (a: …), …}`. Default: one grey rock.
    #[serde(default)]
    pub materials: Named<Material>,
    /// The first rule that holds names a voxel's material; if none holds, the first material.
    #[serde(default)]
    pub rules: Vec<Rule>,
    #[serde(default)]
    pub features: Features,
    /// MagicaVoxel models.
    #[serde(default)]
    pub models: Vec<Model>,
    /// Voxels that move.
    #[serde(default)]
    pub bodies: Vec<Body>,
    /// Default: one preset `none` without lamps.
    #[serde(default)]
    pub lamps: Vec<Preset>,
    pub sun: Option<Sun>,
    /// Default: a dim grey.
    pub sky: Option<Sky>,
    /// Who walks through it.
    #[serde(default)]
    pub player: Player,
    /// Default: one camera that looks at the world's middle.
    #[serde(default)]
    pub cameras: Vec<Camera>,
    /// Default: one layout `auto` over the whole box.
    #[serde(default)]
    pub layouts: Vec<Layout>,
    /// Changes with which measurements time the light's response.
    #[serde(default)]
    pub response: Response,
}

/// A scalar field over space: `(basis: Perlin, fractal: Fbm(octaves: 4), frequency: 0.05)`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    pub basis: Basis,
    /// Default `Plain`.
    #[serde(default)]
    pub fractal: Fractal,
    /// Per voxel: one number, or one for each axis (0: constant along it).
    pub frequency: OneOrThree,
    /// Added to the coordinates after the frequency. Default (0, 0, 0).
    pub offset: Option<Vector>,
    /// Default: the world's.
    pub seed: Option<Leaf>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub enum Basis {
    Perlin,
    OpenSimplex,
    Worley,
    Value,
}

/// How octaves are summed. Default: lacunarity 2 and persistence 0.5.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Fractal {
    /// The basis alone.
    #[default]
    Plain,
    Fbm {
        octaves: Leaf,
        lacunarity: Option<Leaf>,
        persistence: Option<Leaf>,
    },
    Ridged {
        octaves: Leaf,
        lacunarity: Option<Leaf>,
        persistence: Option<Leaf>,
    },
    Billow {
        octaves: Leaf,
        lacunarity: Option<Leaf>,
        persistence: Option<Leaf>,
    },
}

/// `(a: Flat(r, g, b), b: …, pattern: …, emission: (r, g, b), sound: Stone)`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    pub a: Colour,
    /// Default: the same as `a`.
    pub b: Option<Colour>,
    /// Default `Plain`.
    #[serde(default)]
    pub pattern: Pattern,
    /// Emitted radiance. Default (0, 0, 0).
    pub emission: Option<Vector>,
    /// Default: by light, name and colour.
    pub sound: Option<MaterialSound>,
}

/// A colour of a voxel; [`crate::world::Colour`] describes each form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Colour {
    Flat(Leaf, Leaf, Leaf),
    Bands {
        below: Vec<(Leaf, Vector)>,
        above: Vector,
    },
    DitherX {
        from: Leaf,
        to: Leaf,
        low: Vector,
        high: Vector,
    },
    Hash(Vector, Vector),
}

/// The texture of a block; [`crate::world::Pattern`] describes each form.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Pattern {
    #[default]
    Plain,
    Stripes {
        pitch: Leaf,
        width: Leaf,
    },
    Dots {
        radius: Leaf,
        pitch: Leaf,
        angle_deg: Leaf,
    },
    Checker {
        squares: Leaf,
    },
    Bricks {
        rows: Leaf,
        joint: Leaf,
    },
    Worley {
        cells: Leaf,
        radius: Leaf,
    },
    Fbm {
        cells: Leaf,
        octaves: Leaf,
    },
    StripesFbm {
        cells: Leaf,
        octaves: Leaf,
    },
    Radial {
        rings: Leaf,
    },
}

/// `(material: "moss", when: Below(-18))`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rule {
    pub material: Leaf,
    /// Default `Always`.
    #[serde(default)]
    pub when: Condition,
}

/// Evaluated at a solid voxel's centre.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Condition {
    #[default]
    Always,
    Below(Leaf),
    Above(Leaf),
    InBox {
        min: Vector,
        max: Vector,
    },
    Inside(Shape),
    NoiseBelow {
        noise: Leaf,
        value: Leaf,
    },
    ShallowerThan(Leaf),
    FacesUp,
    FacesDown,
    All(Vec<Condition>),
    Any(Vec<Condition>),
    Not(Box<Condition>),
}

/// Boxes of voxels that are stamped into air.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Features {
    /// `{"tiny": [part, …], …}`
    #[serde(default)]
    pub kinds: Named<Vec<Part>>,
    #[serde(default)]
    pub place: Vec<Place>,
}

/// One box of a kind, both ends inclusive, whole numbers, relative to the feature's position.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    pub min: Vector,
    pub max: Vector,
    pub material: Leaf,
    /// Leaves out the four vertical edge columns.
    #[serde(default)]
    pub without_corners: bool,
}

/// Where features are placed. A feature's (0, 0, 0) is put at the named voxel; if scattered, at the
/// lowest free voxel above a floor or the highest free voxel below a ceiling.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Place {
    /// `At(kind: "tiny", places: [(x, y, z), …])`, whole numbers.
    At { kind: Leaf, places: Vec<Vector> },
    /// `Scatter(kinds: ["tiny", "large"], density: 4, on: Floor)`
    Scatter {
        /// Each place takes one of these at random; a kind named twice is twice as likely.
        kinds: Vec<Leaf>,
        /// Number of features. Or `density`: their number per 1000 columns of the box.
        count: Option<Leaf>,
        density: Option<Leaf>,
        /// Default `Floor`.
        #[serde(default)]
        on: Ground,
        /// Box to scatter in. Default: the world's.
        min: Option<Vector>,
        max: Option<Vector>,
        /// Free voxels required above the floor (below the ceiling). Default 1.
        clearance: Option<Leaf>,
        /// Least horizontal distance between two features, voxels. Default 0.
        spacing: Option<Leaf>,
        /// Default: the world's.
        seed: Option<Leaf>,
    },
}

/// What a scattered feature stands on or hangs from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Ground {
    #[default]
    Floor,
    Ceiling,
}

/// `(file: "model.vox", at: (x, y, z))`: the model's lowest corner is put at this voxel; its voxels
/// fill air, and its palette's colours become materials.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Relative to the world file, and within its folder.
    pub file: Leaf,
    pub at: Vector,
}

/// `(model: Shape(size: (5, 7, 1), shape: Box(half: (3, 4, 1))), position: (0.5, 3.5, 13))`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Default: `body 1`, `body 2`, …
    pub name: Option<Leaf>,
    pub model: BodyModel,
    /// Where the pivot is at rest (world space).
    pub position: Vector,
    /// How the body is turned at rest, about x, then y, then z. Default (0, 0, 0).
    pub degrees: Option<Vector>,
    /// The point about which it turns, as seen from the middle of the model. Default (0, 0, 0).
    pub pivot: Option<Vector>,
    #[serde(default)]
    pub motion: Vec<BodyMotion>,
}

/// The voxels of a body.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum BodyModel {
    /// A shape whose (0, 0, 0) is the middle of a box of voxels.
    Shape {
        /// Whole numbers, each 1 … 64.
        size: Vector,
        shape: Shape,
        /// Default: by the world's rules.
        material: Option<Leaf>,
    },
    /// A MagicaVoxel model.
    Vox { file: Leaf },
    /// The voxels of a body further up in the file.
    Like { body: Leaf },
}

/// How a body moves; [`crate::world::bodies::BodyMotion`] describes each form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum BodyMotion {
    Orbit {
        radius: Vector,
        rate: Leaf,
        phase: Option<Leaf>,
    },
    Bob {
        amplitude: Vector,
        rate: Leaf,
        phase: Option<Leaf>,
    },
    Path {
        points: Vec<Vector>,
        speed: Leaf,
    },
    Turn {
        axis: Vector,
        rate: Leaf,
    },
    TurnBetween {
        axis: Vector,
        degrees: Leaf,
        start_s: Leaf,
        end_s: Leaf,
        #[serde(default)]
        ease: Ease,
    },
    Swing {
        axis: Vector,
        degrees: Leaf,
        period_s: Leaf,
        rest_s: Option<Leaf>,
        phase_s: Option<Leaf>,
    },
    Lift {
        by: Vector,
        period_s: Leaf,
        rest_s: Option<Leaf>,
        phase_s: Option<Leaf>,
    },
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub enum Ease {
    #[default]
    Smooth,
    Linear,
}

/// `Preset(name: "one", lamps: [(position: …, power: …)])`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    pub name: Leaf,
    #[serde(default)]
    pub lamps: Vec<Lamp>,
    #[serde(default)]
    pub scatter: Vec<LampScatter>,
}

/// A lamp. For a scattered lamp, `position` is added to the place that was found.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// Default: `lamp 1`, `lamp 2`, …
    pub name: Option<Leaf>,
    /// Default `Point`.
    #[serde(default)]
    pub kind: LampKind,
    /// Required for point and spot lamps that are not scattered.
    pub position: Option<Vector>,
    /// Default (1, 1, 1).
    pub colour: Option<Vector>,
    /// Watts; for a directional lamp W/m² on a facing surface.
    pub power: Leaf,
    /// Voxels; smaller distances count as this radius. Default 0.5.
    pub radius: Option<Leaf>,
    /// Point and spot lamps: radius of the sphere that shines, voxels. Default 0: a point, with hard shadows.
    pub soft_radius: Option<Leaf>,
    #[serde(default)]
    pub motion: Vec<Motion>,
}

/// Lamps at random places.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LampScatter {
    pub lamp: Lamp,
    /// Each lamp takes one of these at random. Default: the lamp's own colour.
    #[serde(default)]
    pub colours: Vec<Vector>,
    /// Number of lamps. Or `density`: their number per 1000 columns of the box.
    pub count: Option<Leaf>,
    pub density: Option<Leaf>,
    /// Default `Floor`.
    #[serde(default)]
    pub on: Ground,
    /// Voxels from the floor (ceiling) to the lamp. Default 2.
    pub height: Option<Leaf>,
    /// Box to scatter in. Default: the world's.
    pub min: Option<Vector>,
    pub max: Option<Vector>,
    /// Free voxels above the floor (below the ceiling). Default: height + 1.
    pub clearance: Option<Leaf>,
    /// Least horizontal distance between two lamps, voxels. Default 0.
    pub spacing: Option<Leaf>,
    /// Default: the world's.
    pub seed: Option<Leaf>,
}

/// Angles are half angles, from the axis.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LampKind {
    #[default]
    Point,
    Spot {
        direction: Vector,
        inner_deg: Leaf,
        outer_deg: Leaf,
    },
    Directional {
        direction: Vector,
    },
}

/// How a lamp changes with time; [`crate::world::Motion`] describes each form. Rates in radians per
/// second (flicker: changes per second; hue: turns per second); `phase` default 0.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Motion {
    Orbit {
        radius: Vector,
        rate: Leaf,
        phase: Option<Leaf>,
    },
    Bob {
        amplitude: Vector,
        rate: Leaf,
        phase: Option<Leaf>,
    },
    Flicker {
        amount: Leaf,
        rate: Leaf,
    },
    Pulse {
        amount: Leaf,
        rate: Leaf,
        phase: Option<Leaf>,
    },
    Path {
        points: Vec<Vector>,
        speed: Leaf,
    },
    HueCycle {
        rate: Leaf,
    },
}

/// `(towards: (0.3, 1, 0.2), irradiance: (3, 3, 2.5))`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    pub towards: Vector,
    pub irradiance: Vector,
}

/// Radiance of the sky. `horizon` and `ground` default to `zenith`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    pub zenith: Vector,
    pub horizon: Option<Vector>,
    pub ground: Option<Vector>,
}

/// `(height: 3.5)`: all sizes and speeds of the player are in proportion.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Player {
    /// Voxels, 0.1 … 100. Default: 1.77 metres.
    pub height: Option<Leaf>,
}

/// `look_at`, or `yaw_deg` (default 0: towards −Z; positive turns left) and `pitch_deg` (default 0;
/// positive looks up).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    pub name: Leaf,
    pub position: Vector,
    pub look_at: Option<Vector>,
    pub yaw_deg: Option<Leaf>,
    pub pitch_deg: Option<Leaf>,
    /// Vertical, 1 … 170. Default 60.
    pub fov_deg: Option<Leaf>,
}

/// Volumes of probes: `(name: "layout1", counts: (7, 5, 5), spacing: 18)`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layout {
    pub name: Leaf,
    /// Whole numbers. Default with `octree`: (2, 2, 2).
    pub counts: Option<Vector>,
    /// Voxels between probes: one number, or one for each axis. Default with `octree`: the world's longest edge.
    pub spacing: Option<OneOrThree>,
    /// Default: the middle of the world's box, or the camera.
    pub centre: Option<Vector>,
    /// Whether the volume follows the camera. Default no.
    #[serde(default)]
    pub follow: bool,
    /// 1 … 6, default 1.
    pub cascades: Option<Leaf>,
    /// Divides the cells of the lattice where there is geometry.
    pub octree: Option<Octree>,
}

/// `(depth: 4, split: Surface, divide_at: 0)`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Octree {
    /// 1 … 6.
    pub depth: Leaf,
    #[serde(default)]
    pub split: Split,
    /// Default 0 for `Surface`, 0.5 for `Hits`.
    pub divide_at: Option<Leaf>,
    /// Default 0.25.
    pub free_below: Option<Leaf>,
    #[serde(default)]
    pub source: bool,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub enum Split {
    #[default]
    Surface,
    Hits,
}

/// `(lamp: "ceiling", wall: (min: (0, 0, 4), max: (3, 6, 4), material: "plaster"))`. Measurements
/// choose what is left out.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// The lamp that is switched and moved. Default: the preset's first.
    pub lamp: Option<Leaf>,
    /// Where the lamp moves. Default: towards the camera.
    pub lamp_to: Option<Vector>,
    /// Default: what the camera looks at.
    pub wall: Option<Wall>,
}

/// A box of voxels, both ends inclusive, whole numbers: all of `material`, or all air.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    pub min: Vector,
    pub max: Vector,
    pub material: Leaf,
}
