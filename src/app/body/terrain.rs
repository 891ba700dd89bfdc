//! What stops a body: the voxels of a world, and bodies of voxels that move.

use glam::IVec3;

use super::super::clock::ClockReading;
use super::obstacles::{self, Obstacles};
use crate::world::{bodies::Bodies, voxels::Voxels};

/// What stops a body. World space.
pub trait Terrain {
    fn is_solid(&self, voxel: IVec3) -> bool;

    /// Where moving bodies are at a simulated time (nanoseconds).
    fn obstacles(&self, _at_ns: u64) -> Obstacles<'_> {
        Obstacles::default()
    }

    /// The moving bodies, if the terrain is that of one moment.
    fn in_the_way(&self) -> &Obstacles<'_> {
        &obstacles::NONE
    }

    /// The terrain at a simulated time (nanoseconds).
    fn at(&self, at_ns: u64) -> Moment<'_, Self>
    where
        Self: Sized,
    {
        Moment {
            terrain: self,
            obstacles: self.obstacles(at_ns),
        }
    }
}

/// A terrain at one moment.
pub struct Moment<'a, T> {
    terrain: &'a T,
    obstacles: Obstacles<'a>,
}

impl<T: Terrain> Terrain for Moment<'_, T> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.terrain.is_solid(voxel)
    }

    fn in_the_way(&self) -> &Obstacles<'_> {
        &self.obstacles
    }
}

/// The voxels of a world as terrain. Outside of the world there is nothing.
pub struct Ground<'a> {
    pub voxels: &'a Voxels,
    pub origin: IVec3,
    moving: Option<(&'a Bodies, ClockReading)>,
}

impl<'a> Ground<'a> {
    pub fn new(voxels: &'a Voxels, origin: IVec3) -> Self {
        Self {
            voxels,
            origin,
            moving: None,
        }
    }

    /// With bodies, which are where the clock says.
    pub fn with_bodies(self, bodies: &'a Bodies, clock: ClockReading) -> Self {
        let moving = (!bodies.bodies.is_empty()).then_some((bodies, clock));
        Self { moving, ..self }
    }
}

/// The voxels of a world that no body leaves: its sides and what lies below it are solid.
pub struct Walled<'a>(pub Ground<'a>);

impl Terrain for Walled<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        let at = voxel - self.0.origin;
        let size = self.0.voxels.size().as_ivec3();
        let is_beside = at.x < 0 || at.z < 0 || at.x >= size.x || at.z >= size.z;
        is_beside || at.y < 0 || self.0.is_solid(voxel)
    }
}

impl Terrain for Ground<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.voxels.material(voxel - self.origin) != 0
    }

    fn obstacles(&self, at_ns: u64) -> Obstacles<'_> {
        let at = |(bodies, clock): (_, ClockReading)| Obstacles::at(bodies, clock.time_s(at_ns));
        self.moving.map_or_else(Obstacles::default, at)
    }
}
