//! Finds places that no light can reach: air that is connected, through faces of voxels, to no lamp, to no
//! emissive voxel and not to the outside. Light does not pass an edge or a corner between voxels, so such a
//! space is exactly black. The check has no noise, and it also covers the path tracer.
//!
//! Bodies let no light through walls. One that glows lights the air around it; and where the camera sees a body in
//! front of the voxels, nothing is said.

use glam::{DVec2, DVec3, IVec3};

use super::super::play::{Play, SIZE};
use super::voxels::all;
use crate::{
    lights::{LampShape, Lights},
    measure::picture::Picture,
    reference::{
        PosedBodies,
        bodies::BodyOutcome,
        march::{FACE_NORMALS, Outcome, Ray, march},
    },
    world::{Camera, World, bodies::Pose, voxels::Voxels},
};

/// Light below this counts as none: rounding of halves may leave that much.
const NOTHING: f32 = 1e-4;

/// For each pixel, whether its surface is in the dark.
pub struct Darkness {
    pub pixels: Vec<bool>,
}

/// States of a voxel.
const UNKNOWN: u8 = 0;
const LIT: u8 = 1;
const SOLID: u8 = 2;

/// Where light may have come in any of the frames so far: light that was there may stay for some frames.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// For each voxel, in the order x, y, z. Empty before the first frame.
    voxels: Vec<bool>,
}

impl Reached {
    /// Adds what light may reach in one more frame.
    pub fn add(&mut self, world: &World, voxels: &Voxels, lights: &Lights, time_s: f64) {
        let now = lit_air(world, voxels, lights, &world.bodies.poses(time_s));
        self.voxels.resize(now.len(), false);
        for (reached, now) in self.voxels.iter_mut().zip(now) {
            *reached |= now == LIT;
        }
    }
}

impl Darkness {
    /// That of the play's last frame; `None` where the play does not follow the light.
    pub fn of(play: &Play<'_>) -> Option<Self> {
        let reached = play.reached.as_ref()?;
        Some(Self::seen_by(
            &play.shot.camera,
            &play.case.world,
            &play.voxels,
            reached,
            play.shot.time_s,
        ))
    }

    /// The darkness in the view of a camera.
    fn seen_by(
        camera: &Camera,
        world: &World,
        voxels: &Voxels,
        reached: &Reached,
        time_s: f64,
    ) -> Self {
        let poses = world.bodies.poses(time_s);
        let bodies = PosedBodies::new(&world.bodies, world.origin, &poses);
        let size = world.size.as_ivec3();
        let index = |at: IVec3| (at.x + size.x * (at.y + size.y * at.z)) as usize;
        let inside = |at: IVec3| at.cmpge(IVec3::ZERO).all() && at.cmplt(size).all();
        let [width, height] = SIZE;
        let basis = camera.basis(f64::from(width) / f64::from(height));
        let picture = DVec2::new(f64::from(width), f64::from(height));
        let origin = basis.origin - world.origin.as_dvec3();
        let pixels = (0..width * height).map(|pixel| {
            let at = DVec2::new(f64::from(pixel % width), f64::from(pixel / width)) + 0.5;
            let ray = Ray::new(origin, basis.direction_ws(at, picture));
            let Outcome::Hit(hit) = march(voxels, &ray) else {
                return false;
            };
            let to_voxel = Ray {
                max_distance: hit.distance,
                ..ray
            };
            if !matches!(bodies.march(&to_voxel, None, None), BodyOutcome::Miss) {
                return false;
            }
            let before = hit.voxel + FACE_NORMALS[usize::from(hit.face)];
            // No light reaches the air in front of the face, and no voxel next to that air shines into it.
            inside(before) && !reached.voxels[index(before)]
        });
        Self {
            pixels: pixels.collect(),
        }
    }

    /// Fails for light in a dark place of a picture.
    pub fn light_in(&self, picture: &Picture) -> Result<(), String> {
        let lit = self.pixels.iter().zip(&picture.rgb).enumerate();
        let mut bright = lit.filter(|(_, (dark, rgb))| **dark && rgb.iter().any(|v| *v > NOTHING));
        let Some((pixel, (_, rgb))) = bright.next() else {
            return Ok(());
        };
        let (x, y) = (pixel as u32 % picture.width, pixel as u32 / picture.width);
        Err(format!(
            "{rgb:?} at pixel ({x}, {y}) and light at {} more of {} pixels, in a space that no light can reach",
            bright.count(),
            self.pixels.iter().filter(|dark| **dark).count()
        ))
    }
}

/// The state of each voxel, in the order x, y, z.
fn lit_air(world: &World, voxels: &Voxels, lights: &Lights, poses: &[Pose]) -> Vec<u8> {
    let shines = |material: u8| {
        let emission = world.materials[usize::from(material) - 1].emission;
        emission.max_element() > 0.0
    };
    let size = voxels.size().as_ivec3();
    let index = |at: IVec3| (at.x + size.x * (at.y + size.y * at.z)) as usize;
    let inside = |at: IVec3| at.cmpge(IVec3::ZERO).all() && at.cmplt(size).all();
    let mut known: Vec<u8> = all(voxels.size())
        .map(|at| {
            if voxels.material(at) == 0 {
                UNKNOWN
            } else {
                SOLID
            }
        })
        .collect();
    let mut open: Vec<IVec3> = Vec::new();
    let reach = |at: IVec3, known: &mut Vec<u8>, open: &mut Vec<IVec3>| {
        if inside(at) && known[index(at)] == UNKNOWN {
            known[index(at)] = LIT;
            open.push(at);
        }
    };
    // A lamp inside solid voxels, or on a border, is assumed to light everything that it touches: a sphere shines wherever
    // its surface lies in air, on both sides of a wall.
    for lamp in lights
        .lamps
        .iter()
        .filter(|lamp| lamp.shape != LampShape::Directional)
    {
        let at: DVec3 = lamp.position_ws - world.origin.as_dvec3();
        let low = (at - lamp.soft_radius).floor().as_ivec3() - 1;
        let high = (at + lamp.soft_radius).floor().as_ivec3() + 1;
        let (low, high) = (low.max(IVec3::ZERO), high.min(size - 1));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let voxel = IVec3::new(x, y, z);
                    let (near, far) = ((voxel - 1).as_dvec3(), (voxel + 2).as_dvec3());
                    if at.clamp(near, far).distance(at) <= lamp.soft_radius {
                        reach(voxel, &mut known, &mut open);
                    }
                }
            }
        }
    }
    // A voxel of a body that shines is assumed to light everything that it may touch.
    for (body, pose) in world.bodies.bodies.iter().zip(poses) {
        let model = &world.bodies.models[body.model];
        for voxel in model.solid().filter(|voxel| shines(model.material(*voxel))) {
            let offset = voxel.as_vec3() + 0.5 - body.pivot;
            let at = (pose.position + pose.rotation * offset).as_dvec3() - world.origin.as_dvec3();
            let at = at.floor().as_ivec3();
            for k in 0..27 {
                let beside = IVec3::new(k % 3, k / 3 % 3, k / 9) - 1;
                reach(at + beside, &mut known, &mut open);
            }
        }
    }
    for at in all(voxels.size()) {
        let on_the_edge = at.cmpeq(IVec3::ZERO).any() || at.cmpeq(size - 1).any();
        if on_the_edge {
            reach(at, &mut known, &mut open);
        }
        let material = voxels.material(at);
        if material != 0 && shines(material) {
            for side in FACE_NORMALS {
                reach(at + side, &mut known, &mut open);
            }
        }
    }
    while let Some(at) = open.pop() {
        for side in FACE_NORMALS {
            reach(at + side, &mut known, &mut open);
        }
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{
        file::{Overrides, parse},
        generate::generate,
    };

    #[test]
    fn closed_rooms_are_dark_and_rooms_with_a_lamp_are_not() {
        let text = "(title: \"\", size: (16, 8, 8), shape: Subtraction([
                Translate(by: (8, 4, 4), of: Box(half: (8, 4, 4))),
                Translate(by: (4, 4, 4), of: Box(half: (2, 2, 2))),
                Translate(by: (12, 4, 4), of: Box(half: (2, 2, 2)))]),
            lamps: [Preset(name: \"p\", lamps: [(position: (4, 4, 4), power: 10)])])";
        let world = parse(text, "rooms", None, &Overrides::default()).expect("sound");
        let lights = Lights::at(&world, &world.lamp_presets[0], 0.0);
        let known = lit_air(&world, &generate(&world), &lights, &world.bodies.poses(0.0));
        let at = |x: usize| known[x + 16 * (4 + 8 * 4)];
        assert_eq!((at(4), at(8), at(12)), (LIT, SOLID, UNKNOWN));
        // A sphere that sticks through the wall lights both sides.
        let sphere = text.replace("power: 10", "power: 10, soft_radius: 5.5");
        let world = parse(&sphere, "rooms", None, &Overrides::default()).expect("sound");
        let lights = Lights::at(&world, &world.lamp_presets[0], 0.0);
        let known = lit_air(&world, &generate(&world), &lights, &world.bodies.poses(0.0));
        assert_eq!(known[12 + 16 * (4 + 8 * 4)], LIT);
    }

    /// The left of two closed rooms, which has no lamp, with a body in it.
    #[test]
    fn a_body_that_glows_lights_its_room_and_one_that_does_not_hides_what_is_behind_it() {
        let room = |material: &str, bodies: &str| {
            let text = format!(
                "(title: \"\", size: (16, 8, 8), shape: Subtraction([
                    Translate(by: (8, 4, 4), of: Box(half: (8, 4, 4))),
                    Translate(by: (4, 4, 4), of: Box(half: (2, 2, 2))),
                    Translate(by: (12, 4, 4), of: Box(half: (2, 2, 2)))]),
                materials: {{\"dull\": (a: Flat(1, 1, 1)), \"glow\": (a: Flat(1, 1, 1), emission: (1, 1, 1))}},
                bodies: [{bodies}], cameras: [(name: \"c\", position: (5.9, 4, 4), yaw_deg: 90)])"
            );
            let text = text.replace("MATERIAL", material);
            let world = parse(&text, "room", None, &Overrides::default()).expect("sound");
            let lights = Lights::at(&world, &world.lamp_presets[0], 0.0);
            let voxels = generate(&world);
            let mut reached = Reached::default();
            reached.add(&world, &voxels, &lights, 0.0);
            let darkness = Darkness::seen_by(&world.cameras[0], &world, &voxels, &reached, 0.0);
            darkness.pixels.iter().filter(|dark| **dark).count()
        };
        let all = (SIZE[0] * SIZE[1]) as usize;
        let body =
            "(model: Shape(size: (1, 1, 1), shape: Sphere(radius: 1), material: \"MATERIAL\"),
            position: (4, 4, 4), degrees: (20, 30, 0))";
        assert_eq!(room("dull", ""), all);
        let beside = room("dull", body);
        assert!(beside > all / 4 && beside < all, "{beside} of {all}");
        assert_eq!(room("glow", body), 0);
    }

    #[test]
    fn what_light_has_reached_stays_reached() {
        let text = "(title: \"\", size: (8, 8, 8), shape: Subtraction([
                Translate(by: (4, 4, 4), of: Box(half: (4, 4, 4))),
                Translate(by: (4, 4, 4), of: Box(half: (2, 2, 2)))]),
            lamps: [(name: \"p\", lamps: [(position: (4, 4, 4), power: 10)])])";
        let world = parse(text, "room", None, &Overrides::default()).expect("sound");
        let voxels = generate(&world);
        let one = Lights::at(&world, &world.lamp_presets[0], 0.0);
        let none = Lights {
            lamps: Vec::new(),
            ..one.clone()
        };
        let mut reached = Reached::default();
        let count = |reached: &Reached| reached.voxels.iter().filter(|lit| **lit).count();
        reached.add(&world, &voxels, &none, 0.0);
        assert_eq!(count(&reached), 0);
        reached.add(&world, &voxels, &one, 0.0);
        assert_eq!(count(&reached), 64);
        reached.add(&world, &voxels, &none, 0.0);
        assert_eq!(count(&reached), 64);
    }

    #[test]
    fn light_in_the_dark_is_found() {
        let darkness = Darkness {
            pixels: vec![false, true],
        };
        let of = |value| Picture {
            width: 2,
            height: 1,
            rgb: vec![[9.0; 3], [value; 3]],
        };
        assert_eq!(darkness.light_in(&of(0.0)), Ok(()));
        let found = darkness.light_in(&of(0.01)).expect_err("light in the dark");
        assert!(found.contains("(1, 0)"), "{found}");
    }
}
