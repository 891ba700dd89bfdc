//! The worlds that come with grotto match their titles, judged by their voxels on the CPU.

use std::{f64::consts::PI, sync::atomic::AtomicBool};

use glam::{DVec2, IVec3, UVec3, Vec3};
use grotto::{
    probes::{Layout as _, Volume},
    reference::{
        march::{FACE_NORMALS, Outcome, Ray, march},
        render::{FilmOptions, RenderOptions, render},
    },
    world::{Camera, View, World, generate, voxels::Voxels},
};

use crate::support::{layout_of, scenes::volume_of, shipped};

/// A world and its voxels.
struct Built {
    world: World,
    voxels: Voxels,
}

fn build(name: &str) -> Built {
    let world = shipped(name);
    let voxels = generate::generate(&world);
    Built { world, voxels }
}

impl Built {
    /// Material of a world-space voxel; 0 is air, as is everything beyond the box.
    fn at(&self, voxel: IVec3) -> u8 {
        self.voxels.material(voxel - self.world.origin)
    }

    fn within(&self, voxel: IVec3) -> bool {
        let local = voxel - self.world.origin;
        local.cmpge(IVec3::ZERO).all() && local.cmplt(self.world.size.as_ivec3()).all()
    }

    /// The air connected with the voxel at `from`; `None` if it reaches the box's border.
    fn closed_air(&self, from: Vec3) -> Option<Vec<IVec3>> {
        let size = self.world.size;
        let mut seen = vec![false; (size.x * size.y * size.z) as usize];
        let index = |voxel: IVec3| {
            let local: UVec3 = (voxel - self.world.origin).as_uvec3();
            ((local.z * size.y + local.y) * size.x + local.x) as usize
        };
        let first = from.floor().as_ivec3();
        let mut air = vec![first];
        seen[index(first)] = true;
        let mut next = 0;
        while next < air.len() {
            for normal in FACE_NORMALS {
                let voxel = air[next] + normal;
                if !self.within(voxel) {
                    return None;
                }
                if self.at(voxel) == 0 && !seen[index(voxel)] {
                    seen[index(voxel)] = true;
                    air.push(voxel);
                }
            }
            next += 1;
        }
        Some(air)
    }

    /// The volume of a layout.
    fn volume(&self, name: &str) -> Volume {
        volume_of(layout_of(&self.world, name))
    }

    /// Whether a probe lies in a solid voxel.
    fn in_solid(&self, position_ws: Vec3) -> bool {
        self.at(position_ws.floor().as_ivec3()) != 0
    }

    /// The outcomes of the rays of a coarse picture of a camera.
    fn outcomes(&self, camera: &Camera) -> Vec<Outcome> {
        let [width, height] = [96, 54];
        let size = DVec2::new(f64::from(width), f64::from(height));
        let basis = camera.basis(size.x / size.y);
        let origin = basis.origin - self.world.origin.as_dvec3();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let rays = pixels.map(|[x, y]| {
            let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            Ray::new(origin, basis.direction_ws(pixel, size).normalize())
        });
        rays.map(|ray| march(&self.voxels, &ray)).collect()
    }
}

/// The smallest box that holds all of these voxels: its lowest corner and its highest.
fn bounds(air: &[IVec3]) -> [Vec3; 2] {
    let low = air.iter().copied().reduce(IVec3::min).expect("some air");
    let high = air.iter().copied().reduce(IVec3::max).expect("some air");
    [low.as_vec3(), (high + 1).as_vec3()]
}

#[test]
fn cameras_stand_in_the_air_and_see_something() {
    // The cavern is too large to build here.
    let names = [
        "beam",
        "bleed",
        "cave",
        "cornell",
        "corner",
        "door",
        "furnace",
        "glow",
        "house",
        "minimal",
        "sealed",
        "small_emitter",
        "soft_shadows",
        "split",
    ];
    for name in names {
        let built = build(name);
        for camera in &built.world.cameras {
            let outcomes = built.outcomes(camera);
            let hits = outcomes
                .iter()
                .filter(|outcome| matches!(outcome, Outcome::Hit(_)));
            let share = hits.count() as f64 / outcomes.len() as f64;
            assert!(
                share > 0.3,
                "{name}, camera {}: {share} of its rays hit solid voxels from the air",
                camera.name
            );
        }
    }
}

#[test]
fn closed_worlds_see_no_sky_and_their_probes_enclose_them() {
    for name in [
        "bleed",
        "corner",
        "furnace",
        "glow",
        "sealed",
        "small_emitter",
    ] {
        let built = build(name);
        let rooms = built.world.cameras.iter().map(|camera| {
            let air = built.closed_air(camera.position);
            air.unwrap_or_else(|| panic!("{name} is open at camera {}", camera.name))
        });
        let [low, high] = bounds(&rooms.flatten().collect::<Vec<_>>());
        // The furnace and the sealed rooms have layouts of their own kind.
        if ["furnace", "sealed"].contains(&name) {
            continue;
        }
        for layout in &built.world.layouts {
            let volume = built.volume(&layout.name);
            let coarsest = volume.levels().last().expect("a volume has a level");
            let (first, spacing) = (coarsest.first(), coarsest.spacing());
            let last = first + (volume.counts() - 1).as_vec3() * spacing;
            let enclosed = first.cmple(low - spacing) & last.cmpge(high + spacing);
            assert!(
                enclosed.all(),
                "{name}, layout {}: probes from {first} to {last}, air from {low} to {high}",
                layout.name
            );
        }
    }
}

#[test]
fn open_worlds_are_open_only_where_intended() {
    for name in ["beam", "door", "split"] {
        let mut built = build(name);
        let camera = built.world.cameras[0].position;
        assert!(built.closed_air(camera).is_none(), "{name} lets light in");
        // With the one opening walled up, the air is closed.
        let (low, high) = match name {
            "beam" => (IVec3::new(-8, 0, 16), IVec3::new(9, 8, 19)),
            "door" => (IVec3::new(-3, 0, 12), IVec3::new(4, 8, 14)),
            _ => (IVec3::new(-9, 12, -3), IVec3::new(-3, 14, 5)),
        };
        let origin = built.world.origin;
        built.voxels.fill_box(low - origin, high - origin - 1, 1);
        assert!(built.closed_air(camera).is_some(), "{name} leaks elsewhere");
    }
}

#[test]
fn the_small_emitter_shows_one_face_and_no_camera_sees_it() {
    let built = build("small_emitter");
    let material = built
        .world
        .materials
        .iter()
        .position(|m| m.emission != Vec3::ZERO);
    let emitter = 1 + material.expect("an emitter") as u8;
    let air = built.closed_air(built.world.cameras[0].position);
    let air = air.expect("a closed room");
    let neighbours = air
        .iter()
        .flat_map(|voxel| FACE_NORMALS.map(|normal| *voxel + normal));
    let faces = neighbours.filter(|voxel| built.at(*voxel) == emitter);
    assert_eq!(faces.count(), 1);
    for camera in &built.world.cameras {
        let sees =
            |outcome: &Outcome| matches!(outcome, Outcome::Hit(hit) if hit.material == emitter);
        assert!(!built.outcomes(camera).iter().any(sees), "{}", camera.name);
    }
}

/// The floor below the emitter receives L times the form factor of a square above it.
#[test]
fn the_small_emitter_gives_the_floor_its_form_factor() {
    let built = build("small_emitter");
    let camera = Camera {
        name: "down".into(),
        position: Vec3::new(0.5, 4.0, 0.5),
        yaw_deg: 0.0,
        pitch_deg: -90.0,
        fov_deg: 10.0,
    };
    let samples = 500_000;
    let picture = render(
        &built.world,
        &built.voxels,
        &RenderOptions {
            lamps: &built.world.lamp_presets[0],
            time_s: 0.0,
            lamp_time_s: 0.0,
            textures: true,
            film: FilmOptions {
                camera: &camera,
                size: [1, 1],
                samples,
                seed: 1,
                view: View::Irradiance,
                antialias: false,
                // Direct light of the emitter, without bounces.
                max_bounces: 1,
            },
        },
        &|_, _| {},
        &AtomicBool::new(false),
    );
    let slope = (0.5 / 8.0) / f64::hypot(1.0, 0.5 / 8.0);
    let form_factor = 4.0 / PI * slope * slope.atan();
    // Random paths hit the emitter with the form factor as their probability.
    let error = 3.0 * ((1.0 - form_factor) / (form_factor * f64::from(samples))).sqrt();
    let ratio = f64::from(picture.rgb[0][0]) / (100.0 * form_factor);
    assert!(
        (ratio - 1.0).abs() < error,
        "{ratio}, not within {error} of 1"
    );
    assert!(error < 0.07, "{error}");
}

#[test]
fn eight_rooms_meet_behind_walls_of_one_voxel() {
    let built = build("corner");
    for corner in 0..8 {
        let side = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
        // The voxel of the room that touches the corner, and the one across the wall.
        let room = side * 2 - 1;
        assert_eq!(built.at(room), 0);
        let air = built.closed_air(room.as_vec3() + 0.5).expect("closed");
        assert_eq!(air.len(), 1000, "room {corner}");
        // Each lamp of `faint` lights a room of its own.
        let lamps = &built.world.lamp_presets[0].lamps;
        let here = lamps
            .iter()
            .filter(|lamp| air.contains(&lamp.position.floor().as_ivec3()));
        assert_eq!(here.count(), 1, "room {corner}");
    }
}

#[test]
fn most_probes_of_the_cages_under_the_roof_stand_in_wood() {
    let built = build("beam");
    // Points below the boards of the roof, halfway between rafters.
    let mut points = Vec::new();
    for bay in -3..3 {
        for across in 1..14 {
            let z = 4.0 * bay as f32 + 2.5;
            points.push(Vec3::new(0.5 + across as f32, 21.0 - across as f32, z));
            points.push(Vec3::new(0.5 - across as f32, 21.0 - across as f32, z));
        }
    }
    let lost = |layout: &str| {
        let volume = built.volume(layout);
        let cages = points.iter().map(|point| {
            assert!(!built.in_solid(*point), "{point} is air");
            let cage = volume.cage(*point);
            let probes = cage.iter().filter(|(_, weight)| *weight > 0.0);
            let stands = probes.map(|(slot, _)| volume.position(*slot));
            let roof = |p: Vec3| (p.x - 0.5).abs() + p.y > 22.0;
            let [hidden, all] = stands.fold([0, 0], |[hidden, all], position| {
                let is_hidden = built.in_solid(position) || roof(position);
                [hidden + usize::from(is_hidden), all + 1]
            });
            hidden as f64 / all as f64
        });
        cages.sum::<f64>() / points.len() as f64
    };
    let [wood, between] = [lost("in the wood"), lost("between")];
    assert!(wood > 0.6, "{wood} of the probes are lost in the wood");
    assert!(between < wood - 0.2, "{between} of them beside it");
}
