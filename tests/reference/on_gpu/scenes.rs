//! Scenes with colours and every kind of light.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::world::{Camera, Colour, Lamp, LampKind, Material, Pattern, Sky, Sun};

use super::super::closed_forms::spheres::sphere_lamp;
use super::super::stage::{Stage, flat, point_lamp, square_camera};

fn coloured(albedo: Vec3, emission: Vec3, pattern: Pattern) -> Material {
    Material {
        a: Colour::Flat(albedo),
        b: Colour::Flat(albedo * 0.3),
        pattern,
        emission,
        ..flat(0.5, 0.0)
    }
}

/// A rough cave lit only by coloured lights in its walls.
pub fn glow() -> (Stage, Camera) {
    let list = vec![
        coloured(
            Vec3::new(0.7, 0.5, 0.4),
            Vec3::ZERO,
            Pattern::Checker { squares: 2 },
        ),
        coloured(Vec3::splat(0.2), Vec3::new(0.5, 6.0, 9.0), Pattern::Plain),
        coloured(Vec3::splat(0.4), Vec3::new(4.0, 0.5, 1.0), Pattern::Plain),
    ];
    let stage = Stage::of(UVec3::splat(20), list, |voxel| {
        let from_middle = voxel.as_vec3() - 9.5;
        let hash = (voxel.x * 71 + voxel.y * 193 + voxel.z * 389) % 23;
        let radius = 7.5 + 0.1 * hash as f32;
        match hash {
            _ if from_middle.length() < radius => 0,
            5 => 2,
            13 => 3,
            _ => 1,
        }
    });
    (
        stage,
        square_camera(DVec3::new(9.5, 9.0, 12.5), 20.0, -10.0),
    )
}

/// A slab with pillars under sun, sky and a spot, away from the origin.
pub fn outdoors() -> (Stage, Camera) {
    let list = vec![
        coloured(Vec3::new(0.3, 0.5, 0.2), Vec3::ZERO, Pattern::Plain),
        coloured(Vec3::new(0.8, 0.7, 0.6), Vec3::ZERO, Pattern::Plain),
    ];
    let mut stage = Stage::of(UVec3::new(24, 10, 24), list, |voxel| {
        let pillar = voxel.x % 6 == 3 && voxel.z % 7 == 2;
        match voxel.y {
            0 => 1,
            y if pillar && y < 8 => 2,
            8 if voxel.x < 12 => 2,
            _ => 0,
        }
    });
    stage.origin = IVec3::new(-8, 16, 40);
    let low = stage.origin.as_vec3();
    let spot = Lamp {
        kind: LampKind::Spot {
            direction: Vec3::new(0.2, -1.0, -0.3),
            inner_deg: 20.0,
            outer_deg: 45.0,
        },
        colour: Vec3::new(1.0, 0.6, 0.2),
        ..point_lamp(low + Vec3::new(8.0, 7.0, 9.0), 400.0)
    };
    let sun = Sun {
        towards: Vec3::new(0.5, 0.7, 0.3).normalize(),
        irradiance: Vec3::new(3.0, 2.8, 2.2),
    };
    let sky = Sky {
        zenith: Vec3::new(0.2, 0.4, 0.9),
        horizon: Vec3::new(0.8, 0.8, 0.9),
        ground: Vec3::splat(0.1),
    };
    let camera = square_camera(low.as_dvec3() + DVec3::new(12.0, 5.0, 22.0), 15.0, -15.0);
    (stage.lit_by(&[spot], Some(sun)).under(sky), camera)
}

/// A room with pillars under lamps of every size: one in the open, one that a wall cuts, one that is a spot, and a point.
pub fn soft() -> (Stage, Camera) {
    let list = vec![
        coloured(Vec3::new(0.7, 0.6, 0.5), Vec3::ZERO, Pattern::Plain),
        coloured(Vec3::new(0.5, 0.6, 0.8), Vec3::ZERO, Pattern::Plain),
    ];
    let stage = Stage::of(UVec3::splat(20), list, |voxel| {
        let wall = voxel.cmpeq(IVec3::ZERO) | voxel.cmpeq(IVec3::splat(19));
        let pillar = voxel.x % 5 == 3 && voxel.z % 6 == 4 && voxel.y < 9;
        if pillar { 2 } else { u8::from(wall.any()) }
    });
    let spot = Lamp {
        kind: LampKind::Spot {
            direction: Vec3::new(0.1, -1.0, 0.2),
            inner_deg: 25.0,
            outer_deg: 55.0,
        },
        colour: Vec3::new(0.3, 1.0, 0.5),
        ..sphere_lamp(Vec3::new(6.0, 17.0, 12.0), 500.0, 0.8)
    };
    let in_the_wall = Lamp {
        colour: Vec3::new(1.0, 0.4, 0.2),
        ..sphere_lamp(Vec3::new(17.5, 6.0, 6.0), 120.0, 2.25)
    };
    let lamps = [
        sphere_lamp(Vec3::new(9.0, 13.0, 8.0), 400.0, 1.5),
        in_the_wall,
        spot,
        point_lamp(Vec3::new(3.0, 9.0, 3.0), 80.0),
    ];
    let camera = square_camera(DVec3::new(9.5, 8.0, 17.5), 5.0, -15.0);
    (stage.lit_by(&lamps, None), camera)
}
