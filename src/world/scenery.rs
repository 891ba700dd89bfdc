//! Everything in a world that is not a voxel: lamps and their motion, sun, sky, cameras, layouts.

use glam::{IVec3, UVec3, Vec3};

use super::Travel;

/// Most lamps of one preset, not counting the sun.
pub const MAX_LAMPS: usize = 65_536;

/// Largest radius of a lamp that is a sphere (voxels).
pub const MAX_SOFT_RADIUS: f32 = 64.0;

/// Least radius of a lamp that is a sphere (voxels); smaller ones are points.
pub const LEAST_SOFT_RADIUS: f32 = 0.01;

/// Most probes of one layout (8 kB of maps and history each).
pub const MAX_PROBES: u32 = 1 << 20;

/// Most cascades of one layout.
pub const MAX_CASCADES: u32 = 6;

/// Least probes along an axis where light fades from one cascade to the next.
pub const LEAST_COUNT: u32 = 4;

/// Least voxels between probes: closer ones would share voxels.
pub const LEAST_SPACING: f32 = 0.25;

/// Coordinates lie within ± this many voxels, so that f32 still tells voxels apart.
pub const FARTHEST: f32 = 1_048_576.0;

/// Height of a player (metres) in a world that says nothing about it.
pub const PLAYER_HEIGHT_M: f64 = 1.77;

/// A lamp as the file gives it; `lights` evaluates its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    pub name: String,
    pub kind: LampKind,
    /// World space. Unused by directional lamps.
    pub position: Vec3,
    /// Linear Rec. 709, largest channel usually 1.
    pub colour: Vec3,
    /// Point and spot: radiant power W in watts per channel of white; radiant intensity is W/(4π),
    /// irradiance at distance d is W/(4π d²). Directional: irradiance in W/m² on a facing surface.
    /// (With `voxel_m` ≠ 1 the power is divided by voxel_m² on loading, so that lengths in voxels
    /// give the same irradiance.)
    pub power: f32,
    /// Smaller distances count as this radius, which bounds 1/d².
    pub radius: f32,
    /// Point and spot: radius of the sphere that shines (voxels), at most [`MAX_SOFT_RADIUS`]; 0 for a point. Its power
    /// is that of the point lamp.
    pub soft_radius: f32,
    /// Applied in order as a function of world time.
    pub motion: Vec<Motion>,
}

impl Lamp {
    /// Whether the lamp is a sphere, whose shadows are soft.
    pub fn is_sphere(&self) -> bool {
        !matches!(self.kind, LampKind::Directional { .. }) && self.soft_radius >= LEAST_SOFT_RADIUS
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampKind {
    Point,
    /// `direction` is where the light goes; full inside `inner_deg`, none outside `outer_deg` (half
    /// angles), smooth between them.
    Spot {
        direction: Vec3,
        inner_deg: f32,
        outer_deg: f32,
    },
    Directional {
        direction: Vec3,
    },
}

/// How a lamp changes with world time t (seconds).
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Moves its place.
    Travel(Travel),
    /// Multiplies the power by a smooth noise in [1 − amount, 1].
    Flicker { amount: f32, rate: f32 },
    /// Multiplies the power by 1 − amount · (½ + ½ sin(rate·t + phase)).
    Pulse { amount: f32, rate: f32, phase: f32 },
    /// Rotates the hue by `rate` full turns per second.
    HueCycle { rate: f32 },
}

/// A named set of at most [`MAX_LAMPS`] lamps.
#[derive(Clone, Debug, PartialEq)]
pub struct LampPreset {
    pub name: String,
    pub lamps: Vec<Lamp>,
}

/// A directional light without animation; it lights the world through its skylights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit vector from the world towards the sun.
    pub towards: Vec3,
    /// Irradiance on a facing surface (W/m², linear RGB).
    pub irradiance: Vec3,
}

/// Radiance of rays that leave the world, by the y of their direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    pub zenith: Vec3,
    pub horizon: Vec3,
    /// Below the horizon.
    pub ground: Vec3,
}

impl Sky {
    /// Whether it gives no light at all.
    pub fn is_dark(&self) -> bool {
        let colours = [self.zenith, self.horizon, self.ground];
        colours.iter().all(|colour| *colour == Vec3::ZERO)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub name: String,
    pub position: Vec3,
    /// Degrees; 0 looks towards −Z, positive turns left (counter-clockwise from above).
    pub yaw_deg: f32,
    /// Degrees; positive looks up.
    pub pitch_deg: f32,
    /// Vertical field of view in degrees.
    pub fov_deg: f32,
}

/// Largest number of times that an octree's roots are divided.
pub const MAX_DEPTH: u32 = 6;
/// Most cells of an octree's finest lattice, whether the tree has them or not: their surfaces are counted.
pub const MAX_OCTREE_CELLS: u64 = 1 << 24;

/// What decides whether a cell of an octree is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// Surface voxels (air beside a solid voxel) over the voxels of one of its faces: a flat wall through the cell
    /// counts 1, an edge 2.
    #[default]
    Surface,
    /// Share of the rays from its middle that hit a surface in it.
    Hits,
}

/// How the cells of a probe layout are divided. The layout's lattice has the corners of the undivided cells.
#[derive(Clone, Debug, PartialEq)]
pub struct OctreeSpec {
    /// 1 … [`MAX_DEPTH`].
    pub depth: u32,
    pub split: Split,
    /// Cells with more than this (`Hits`: as much) are divided.
    pub divide_at: f32,
    /// With `source`: leaves with a lower hit fraction have no probe.
    pub free_below: f32,
    /// Probes in the middles of leaves, all of which a gather visits: the published way, for comparison.
    pub source: bool,
}

impl Default for OctreeSpec {
    fn default() -> Self {
        Self {
            depth: 1,
            split: Split::Surface,
            divide_at: 0.0,
            free_below: 0.25,
            source: false,
        }
    }
}

/// Nested volumes of probes; each has twice the spacing of the previous one. In a single fixed volume,
/// position(index) = (index − (count−1)/2)·spacing + centre.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutSpec {
    pub name: String,
    /// Probes of each volume along each axis.
    pub counts: UVec3,
    /// Voxels between the probes of the finest volume.
    pub spacing: Vec3,
    /// World space; for volumes that follow the camera, the offset of their middle from it.
    pub centre: Vec3,
    /// Whether the volumes move with the camera.
    pub follow: bool,
    /// Number of volumes, 1 … [`MAX_CASCADES`].
    pub cascades: u32,
    /// Divides the cells of a single fixed volume.
    pub octree: Option<OctreeSpec>,
}

/// Changes with which measurements time the light's response; whatever is `None` they choose
/// themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResponseSpec {
    /// The name of the lamp that is switched and moved, in presets that have it.
    pub lamp: Option<String>,
    /// Position (world space) to which that lamp moves.
    pub lamp_to: Option<Vec3>,
    pub wall: Option<Wall>,
}

/// A box of voxels that is opened and closed. The world as loaded may have it open, closed or neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wall {
    /// World space, both ends inclusive.
    pub min: IVec3,
    pub max: IVec3,
    /// Its material (1-based) when closed; when open, it is air.
    pub material: u8,
}
