//! Small scenes: voxels, materials, lights and layouts that many tests build on.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::{
    probes::Volume,
    world::{
        Camera, Colour, LayoutSpec, Material, MaterialSound, Pattern, Sky,
        voxels::{BRICK_VOXELS, CELL, NewCell, Voxels, brick_index},
    },
};

/// Voxels of `size` with the material that the function gives (grid space; 0 is air).
pub fn voxels_from(size: UVec3, material: impl Fn(IVec3) -> u8 + Sync) -> Voxels {
    Voxels::from_cells(size, |cell| {
        let mut brick = Box::new([0; BRICK_VOXELS]);
        let edge = 0..CELL;
        for (z, y) in edge.clone().flat_map(|z| edge.clone().map(move |y| (z, y))) {
            for x in edge.clone() {
                let local = UVec3::new(x, y, z);
                let voxel = cell * CELL + local;
                if voxel.cmplt(size).all() {
                    brick[brick_index(local)] = material(voxel.as_ivec3());
                }
            }
        }
        NewCell::Voxels(brick)
    })
}

/// A grey material without a texture.
pub fn flat(albedo: f32, emission: f32) -> Material {
    Material {
        name: format!("albedo {albedo} emission {emission}"),
        a: Colour::Flat(Vec3::splat(albedo)),
        b: Colour::Flat(Vec3::splat(albedo)),
        pattern: Pattern::Plain,
        emission: Vec3::splat(emission),
        sound: MaterialSound::Stone,
    }
}

pub fn uniform_sky(radiance: f32) -> Sky {
    let colour = Vec3::splat(radiance);
    Sky {
        zenith: colour,
        horizon: colour,
        ground: colour,
    }
}

/// One level of probes that stays where it is.
pub fn lattice(counts: UVec3, spacing: Vec3, centre: Vec3) -> LayoutSpec {
    LayoutSpec {
        name: "test".into(),
        counts,
        spacing,
        centre,
        follow: false,
        cascades: 1,
        octree: None,
    }
}

pub fn volume_of(layout: &LayoutSpec) -> Volume {
    Volume::new(layout).expect("a good layout")
}

/// A camera with a view of 90° along `yaw` and `pitch`. At distance d from a wall that it faces it sees a
/// square of edge 2d, every part of it equally large.
pub fn square_camera(position: DVec3, yaw_deg: f32, pitch_deg: f32) -> Camera {
    Camera {
        name: "square".into(),
        position: position.as_vec3(),
        yaw_deg,
        pitch_deg,
        fov_deg: 90.0,
    }
}

/// The six cameras from one point, which together see every direction once.
pub fn all_around(position: DVec3) -> [Camera; 6] {
    [
        (0.0, 0.0),
        (90.0, 0.0),
        (180.0, 0.0),
        (270.0, 0.0),
        (0.0, 90.0),
        (0.0, -90.0),
    ]
    .map(|(yaw, pitch)| square_camera(position, yaw, pitch))
}
