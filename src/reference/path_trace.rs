//! Unbiased light transport: path tracing after Kajiya 1986, in f64.
//!
//! Surfaces are Lambertian and emit the same radiance in every direction. Lamps and the sun cannot
//! be hit and are sampled at every vertex (next-event estimation), one point of a lamp that is a sphere; emissive voxels and the sky have
//! extent and are found by hitting them, so no light is ever counted twice. That holds for the voxels of bodies too.

use std::f64::consts::PI;

use glam::{DVec3, IVec3};

use super::bodies::{BodyHit, BodyOutcome, BodyPoint, PosedBodies, cell_before};
use super::march::{FACE_NORMALS, Hit, Outcome, Ray, march};
use super::random::Pcg;
use super::sphere_lamp;
use crate::lights::{Lights, sky};
use crate::world::materials::MaterialSet;
use crate::world::voxels::Voxels;

/// From this bounce on, paths end at random (Russian roulette); before it, they always continue.
const ROULETTE_FROM: u32 = 3;
/// Even a path that has lost no light ends with probability 1 − this.
const MOST_LIKELY_SURVIVAL: f64 = 0.95;

/// The surfaces that rays can hit, and their lights.
#[derive(Clone, Copy, Debug)]
pub struct TracedWorld<'a> {
    pub voxels: &'a Voxels,
    /// At their poses.
    pub bodies: &'a PosedBodies,
    /// World-space coordinates of the grid's first voxel.
    pub origin: IVec3,
    pub materials: &'a MaterialSet,
    pub lights: &'a Lights,
    /// Whether textures are visible; otherwise every texture is its mean.
    pub textures: bool,
}

/// What a camera ray hits.
#[derive(Clone, Copy, Debug)]
pub enum CameraHit {
    /// The sky, with its radiance.
    Sky(DVec3),
    Surface(Vertex),
    /// The camera is inside a solid voxel, and sees its emission.
    Solid(DVec3),
}

/// A point of a surface. Grid space unless the name says otherwise; linear RGB.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    pub position: DVec3,
    /// Index into [`FACE_NORMALS`]: a face of a voxel of the grid, or of a model.
    pub face: u8,
    /// Outward unit normal.
    normal: DVec3,
    /// The cell of the grid before the face: rays that leave the surface start in it.
    air: IVec3,
    /// The point on the body that it belongs to, if it is not the grid's.
    body: Option<BodyPoint>,
    pub albedo: DVec3,
    pub emission: DVec3,
    /// Distance along the ray that found it, in voxels.
    pub distance: f64,
}

impl Vertex {
    /// Outward unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    fn ray(&self, direction: DVec3, max_distance: f64) -> Ray {
        Ray {
            origin: self.position,
            direction,
            start: self.air,
            max_distance,
        }
    }
}

/// What a ray meets first, in the grid or among the bodies.
enum Meeting {
    /// The ray starts in a solid voxel of this material.
    Inside(u8),
    Grid(Hit),
    Body(BodyHit),
    Nothing,
}

impl TracedWorld<'_> {
    /// Follows a camera ray (world space, unit direction). `pixel_angle` is the angle (radians)
    /// over which textures are averaged.
    pub fn look(&self, origin_ws: DVec3, direction: DVec3, pixel_angle: f64) -> CameraHit {
        let ray = Ray::new(origin_ws - self.origin.as_dvec3(), direction);
        match self.meet(&ray, None) {
            Meeting::Inside(material) => {
                CameraHit::Solid(self.materials.emission(material).as_dvec3())
            }
            Meeting::Nothing => CameraHit::Sky(sky::radiance(&self.lights.sky, direction)),
            Meeting::Grid(hit) => CameraHit::Surface(self.vertex(&ray, hit, pixel_angle)),
            Meeting::Body(hit) => CameraHit::Surface(self.body_vertex(&ray, &hit, pixel_angle)),
        }
    }

    /// Follows a ray that leaves a surface, or a camera's. Of a grid and a body at the same distance it meets the grid.
    fn meet(&self, ray: &Ray, leaves: Option<&Vertex>) -> Meeting {
        let in_grid = march(self.voxels, ray);
        let max_distance = match in_grid {
            Outcome::Inside(material) => return Meeting::Inside(material),
            Outcome::Hit(hit) => hit.distance,
            Outcome::Miss => ray.max_distance,
        };
        let ray = Ray {
            max_distance,
            ..*ray
        };
        let normal = leaves.map(Vertex::normal);
        let on_body = leaves.and_then(|vertex| vertex.body.as_ref());
        match (self.bodies.march(&ray, normal, on_body), in_grid) {
            (BodyOutcome::Inside(material), _) => Meeting::Inside(material),
            (BodyOutcome::Hit(hit), _) => Meeting::Body(hit),
            (BodyOutcome::Miss, Outcome::Hit(hit)) => Meeting::Grid(hit),
            (BodyOutcome::Miss, _) => Meeting::Nothing,
        }
    }

    /// Whether nothing is in the way of a ray that leaves a surface.
    fn is_free(&self, vertex: &Vertex, direction: DVec3, distance: f64) -> bool {
        let ray = vertex.ray(direction, distance);
        matches!(self.meet(&ray, Some(vertex)), Meeting::Nothing)
    }

    fn vertex(&self, ray: &Ray, hit: Hit, pixel_angle: f64) -> Vertex {
        let position = hit.position(ray);
        let normal = FACE_NORMALS[usize::from(hit.face)];
        let position_ws = position + self.origin.as_dvec3();
        let voxel_ws = hit.voxel + self.origin;
        let cosine = normal.as_dvec3().dot(ray.direction).abs();
        Vertex {
            position,
            face: hit.face,
            normal: normal.as_dvec3(),
            air: hit.voxel + normal,
            body: None,
            albedo: self.albedo(&hit, voxel_ws, position_ws, pixel_angle / cosine),
            emission: self.materials.emission(hit.material).as_dvec3(),
            distance: hit.distance,
        }
    }

    /// Colours and textures of a body count from the lowest corner of its model, so that they move with it.
    fn body_vertex(&self, ray: &Ray, found: &BodyHit, pixel_angle: f64) -> Vertex {
        let BodyHit {
            hit,
            point,
            position_gs,
            normal,
        } = *found;
        let cosine = normal.dot(ray.direction).abs();
        Vertex {
            position: position_gs,
            face: hit.face,
            normal,
            air: cell_before(position_gs, Some(normal)),
            body: Some(point),
            albedo: self.albedo(&hit, hit.voxel, point.position_ms, pixel_angle / cosine),
            emission: self.materials.emission(hit.material).as_dvec3(),
            distance: hit.distance,
        }
    }

    /// The albedo at a hit. `pixel_slope`: width of a pixel on the surface, per voxel of distance.
    fn albedo(&self, hit: &Hit, voxel: IVec3, position: DVec3, pixel_slope: f64) -> DVec3 {
        let albedo = if self.textures {
            let footprint = pixel_slope * hit.distance;
            self.materials
                .albedo(hit.material, voxel, hit.face, position, footprint)
        } else {
            self.materials.mean_albedo(hit.material, voxel)
        };
        albedo.as_dvec3()
    }

    /// Radiance that a surface reflects of the direct light from the sun and from lamps that are no spheres: the sum
    /// over all of them, with shadows. Nothing in it is random.
    pub fn lamps_reflected(&self, vertex: &Vertex) -> DVec3 {
        (0..self.lights.lamps.len())
            .filter(|&lamp| !self.lights.lamps[lamp].is_soft())
            .map(|lamp| self.lamp_reflected(vertex, lamp))
            .sum()
    }

    /// Radiance that a surface reflects of the direct light from lamps that are spheres, each by one sample.
    pub fn spheres_reflected(&self, vertex: &Vertex, random: &mut Pcg) -> DVec3 {
        (0..self.lights.lamps.len())
            .filter(|&lamp| self.lights.lamps[lamp].is_soft())
            .map(|lamp| self.sphere_reflected(vertex, lamp, random))
            .sum()
    }

    /// An unbiased estimate of the light of all lamps from one lamp, chosen with a probability
    /// proportional to its unshadowed contribution.
    fn one_lamp_reflected(&self, vertex: &Vertex, random: &mut Pcg) -> DVec3 {
        let point_ws = vertex.position + self.origin.as_dvec3();
        let weight = |lamp: usize| match &self.lights.lamps[lamp] {
            sphere if sphere.is_soft() => {
                let irradiance = sphere.irradiance(point_ws, vertex.normal());
                irradiance.element_sum()
            }
            _ => self.unshadowed(vertex, lamp).0.element_sum(),
        };
        let lamps = self.lights.lamps.len();
        let total: f64 = (0..lamps).map(weight).sum();
        let mut left = random.unit() * total;
        for lamp in 0..lamps {
            let weight = weight(lamp);
            if left < weight {
                let light = match self.lights.lamps[lamp].is_soft() {
                    true => self.sphere_reflected(vertex, lamp, random),
                    false => self.lamp_reflected(vertex, lamp),
                };
                return light * (total / weight);
            }
            left -= weight;
        }
        // No lamp reaches the surface, or rounding went past the last one.
        DVec3::ZERO
    }

    fn lamp_reflected(&self, vertex: &Vertex, lamp: usize) -> DVec3 {
        let (irradiance, towards, distance) = self.unshadowed(vertex, lamp);
        if irradiance == DVec3::ZERO {
            return DVec3::ZERO;
        }
        match self.is_free(vertex, towards, distance) {
            true => vertex.albedo / PI * irradiance,
            false => DVec3::ZERO,
        }
    }

    /// An unbiased estimate of the light of a sphere, by a ray to one of its points.
    fn sphere_reflected(&self, vertex: &Vertex, lamp: usize, random: &mut Pcg) -> DVec3 {
        let lamp = &self.lights.lamps[lamp];
        let offset = lamp.position_ws - self.origin.as_dvec3() - vertex.position;
        let sample = sphere_lamp::sample(offset, lamp.soft_radius, vertex.normal(), random);
        let cosine = vertex.normal().dot(sample.towards);
        if cosine <= 0.0 {
            return DVec3::ZERO;
        }
        // The cone of a spot starts at its centre.
        let spot = lamp.spot_factor(-offset.normalize_or_zero());
        match self.is_free(vertex, sample.towards, sample.distance) {
            true => vertex.albedo / PI * lamp.intensity * (spot * sample.weight * cosine),
            false => DVec3::ZERO,
        }
    }

    /// Irradiance from a lamp without shadows, the direction towards the lamp, and its distance.
    fn unshadowed(&self, vertex: &Vertex, lamp: usize) -> (DVec3, DVec3, f64) {
        let point_ws = vertex.position + self.origin.as_dvec3();
        let ray = self.lights.lamps[lamp].ray_from(point_ws);
        let cosine = vertex.normal().dot(ray.towards_ws).max(0.0);
        (ray.irradiance * cosine, ray.towards_ws, ray.distance)
    }

    /// One sample of the light that reaches a surface over at least one other surface, or from the sky
    /// or an emissive voxel, as the radiance that a white surface would reflect. Multiply by the albedo
    /// of `first`.
    ///
    /// `max_bounces` limits the number of surfaces after `first` whose light is gathered.
    pub fn bounced(&self, first: &Vertex, max_bounces: u32, random: &mut Pcg) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        // The contribution of a unit of light at the current end of the path to the result.
        let mut throughput = DVec3::ONE;
        let mut vertex = *first;
        for bounce in 1..=max_bounces {
            // Follow a cosine-weighted direction: density and cosine cancel, the albedo remains.
            let axis = usize::from(vertex.face / 2);
            let local = random.cosine_direction(axis, vertex.face % 2 == 1);
            let direction = match vertex.body {
                Some(point) => self.bodies.direction_gs(point.body, local),
                None => local,
            };
            let ray = vertex.ray(direction, f64::INFINITY);
            vertex = match self.meet(&ray, Some(&vertex)) {
                Meeting::Grid(hit) => self.vertex(&ray, hit, 0.0),
                Meeting::Body(hit) => self.body_vertex(&ray, &hit, 0.0),
                Meeting::Nothing => {
                    return radiance + throughput * sky::radiance(&self.lights.sky, direction);
                }
                // An edit or a body may have filled the cell before the face.
                Meeting::Inside(_) => return radiance,
            };
            // Gather what this surface emits and reflects from the lamps.
            radiance += throughput * (vertex.emission + self.one_lamp_reflected(&vertex, random));
            // End paths that carry little, and weight the survivors to compensate.
            throughput *= vertex.albedo;
            if bounce >= ROULETTE_FROM {
                let survival = throughput.max_element().min(MOST_LIKELY_SURVIVAL);
                if random.unit() >= survival {
                    return radiance;
                }
                throughput /= survival;
            }
        }
        radiance
    }
}
