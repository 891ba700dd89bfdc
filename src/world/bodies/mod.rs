//! Rigid bodies of voxels that move: a door that swings, a lift, a mill wheel. A body has its own small grid of voxels
//! (its model), which a pose carries into the world; rays march through it in its own space.

pub mod changed;
mod motion;
mod whole;

use std::fmt;

use glam::{IVec3, Mat3, Quat, UVec3, Vec3};

pub use changed::{ChangedBodies, MovedBody, PlacedBody};
use motion::Moment;
pub use motion::{BodyMotion, Cycle, Ease};
pub use whole::WholeBody;

/// Most voxels along an edge of a model.
pub const MAX_BODY_EDGE: u32 = 64;

/// Most bodies in a world.
pub const MAX_BODIES: usize = 4096;

/// Most voxels, air included, of all models of a world.
pub const MAX_MODEL_VOXELS: u32 = 1 << 24;

/// Axes that differ by less than this from those of the world are theirs.
const ALIGNED: f32 = 1e-4;

/// The voxels of a body, shared by all bodies of the same shape.
#[derive(Clone, PartialEq, Eq)]
pub struct BodyModel {
    /// Extent in voxels, each 1 … [`MAX_BODY_EDGE`].
    pub size: UVec3,
    /// A material of the world (1-based) for each voxel, 0 for air; x runs fastest, then y, then z.
    pub materials: Vec<u8>,
}

/// A body as the world file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub name: String,
    /// Index in [`Bodies::models`].
    pub model: usize,
    /// The point of the model (model space: voxels from its lowest corner) about which it turns.
    pub pivot: Vec3,
    /// Where the pivot is and how the body is turned before its motion.
    pub rest: Pose,
    /// Applied in order. Axes are those of the model, as the motions before have turned it.
    pub motion: Vec<BodyMotion>,
    pub put_by: PutBy,
}

/// Who put a body where it rests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PutBy {
    #[default]
    WorldFile,
    /// The world file, and then a player pushed it.
    Pushed,
    /// A player placed it.
    Placed,
}

/// Where a body is at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The pivot in world space.
    pub position: Vec3,
    /// Turns model space into world space.
    pub rotation: Quat,
}

/// All bodies of a world; a pose of each, in the same order, says where they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies {
    pub models: Vec<BodyModel>,
    pub bodies: Vec<Body>,
    /// Names of those of the world file that a player has set into the world as voxels.
    pub gone: Vec<String>,
}

impl BodyModel {
    /// The material of a voxel of the model; 0 (air) outside of it.
    pub fn material(&self, voxel: IVec3) -> u8 {
        let size = self.size.as_ivec3();
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(size).any() {
            return 0;
        }
        self.materials[(voxel.x + size.x * (voxel.y + size.y * voxel.z)) as usize]
    }

    /// Every voxel that is not air.
    pub fn solid(&self) -> impl Iterator<Item = IVec3> + '_ {
        let size = self.size;
        let voxels = (0..size.z).flat_map(move |z| (0..size.y).map(move |y| (y, z)));
        let voxels =
            voxels.flat_map(move |(y, z)| (0..size.x).map(move |x| UVec3::new(x, y, z).as_ivec3()));
        let solid = voxels
            .zip(&self.materials)
            .filter(|(_, material)| **material != 0);
        solid.map(|(voxel, _)| voxel)
    }
}

/// With a checksum in place of the voxels: worlds are told apart by their debug texts, which may not be long.
impl fmt::Debug for BodyModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let checksum = crc32fast::hash(&self.materials);
        write!(f, "{} voxels, CRC-32 {checksum:08x}", self.size)
    }
}

impl Body {
    /// Where the body is at a world time (seconds).
    pub fn pose(&self, time: f64) -> Pose {
        let rest = Moment {
            position: self.rest.position.as_dvec3(),
            rotation: self.rest.rotation.as_dquat().normalize(),
        };
        let now = self
            .motion
            .iter()
            .fold(rest, |now, motion| motion.apply(now, time));
        Pose {
            position: now.position.as_vec3(),
            rotation: now.rotation.normalize().as_quat(),
        }
    }

    /// Where the axes of the model lie in the world, if they lie along the world's.
    pub fn axes(&self) -> Option<[IVec3; 3]> {
        let turn = Mat3::from_quat(self.rest.rotation.normalize());
        let axes = [turn.x_axis, turn.y_axis, turn.z_axis];
        let is_aligned = |axis: &Vec3| (*axis - axis.round()).abs().max_element() < ALIGNED;
        (axes.iter().all(is_aligned)).then(|| axes.map(|axis| axis.round().as_ivec3()))
    }

    /// Whether the body never moves.
    pub fn is_still(&self) -> bool {
        self.motion.iter().all(BodyMotion::is_still)
    }
}

impl Bodies {
    /// Where all bodies are at a world time (seconds).
    pub fn poses(&self, time: f64) -> Vec<Pose> {
        self.bodies.iter().map(|body| body.pose(time)).collect()
    }
}
