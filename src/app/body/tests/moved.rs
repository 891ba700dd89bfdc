//! Bodies of voxels that move: they carry and push the player, and never keep him inside.

use glam::{DVec3, IVec3, Quat, UVec3, Vec3};

use super::super::obstacles::Obstacles;
use super::super::{Body, Intent, Mode, Terrain};
use super::{DT_S, EDGE, Grid, Random, ahead, body_at, in_the_middle};
use crate::world::Travel;
use crate::world::bodies::{self, Bodies, BodyModel, BodyMotion, Cycle, Pose};

/// A room with bodies in it.
struct Stage {
    grid: Grid,
    bodies: Bodies,
}

impl Terrain for Stage {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.grid.is_solid(voxel)
    }

    fn obstacles(&self, at_ns: u64) -> Obstacles<'_> {
        Obstacles::at(&self.bodies, at_ns as f64 * 1e-9)
    }
}

impl Stage {
    fn new(size: UVec3, pivot: Vec3, position: Vec3, motion: Vec<BodyMotion>) -> Self {
        let body = bodies::Body {
            name: "body".into(),
            model: 0,
            pivot,
            rest: Pose {
                position,
                rotation: Quat::IDENTITY,
            },
            motion,
            put_by: Default::default(),
        };
        Self {
            grid: Grid::room(0.0, 1),
            bodies: Bodies {
                models: vec![BodyModel {
                    size,
                    materials: vec![1; size.element_product() as usize],
                }],
                bodies: vec![body],
                gone: Vec::new(),
            },
        }
    }

    /// Plays a time, and calls `each` after every step with its end (seconds).
    fn play(
        &self,
        body: &mut Body,
        seconds: f64,
        intent: &Intent,
        mut each: impl FnMut(f64, &Body, &Obstacles<'_>),
    ) {
        for step in 1..=(seconds / DT_S).round() as u32 {
            let end_s = f64::from(step) * DT_S;
            let now = self.at((end_s * 1e9) as u64);
            assert_eq!(body.step(&now, intent, DT_S), None, "after {end_s} s");
            assert!(!body.shape().overlaps(&now), "inside after {end_s} s");
            each(end_s, body, now.in_the_way());
        }
    }
}

fn cycle(period_s: f32, rest_s: f32) -> Cycle {
    Cycle {
        period_s,
        rest_s,
        phase_s: 0.0,
    }
}

#[test]
fn a_lift_carries_the_player_up_and_down() {
    let lift = Stage::new(
        UVec3::new(4, 1, 4),
        Vec3::new(2.0, 0.5, 2.0),
        Vec3::new(8.0, 2.5, 8.0),
        vec![BodyMotion::Lift {
            by: Vec3::Y * 8.0,
            cycle: cycle(8.0, 1.0),
        }],
    );
    let mut body = body_at(DVec3::new(8.0, 3.0 + 1.7, 8.0), &lift.at(0));
    body.mode = Mode::Walk;
    let mut highest = 0.0f64;
    lift.play(&mut body, 16.0, &Intent::default(), |end_s, body, _| {
        let top = f64::from(lift.bodies.bodies[0].pose(end_s).position.y) + 0.5;
        let above = body.feet().y - top;
        // It falls the first tenth of a voxel.
        assert!(
            end_s < 0.3 || (0.0..0.01).contains(&above),
            "{above} at {end_s} s"
        );
        highest = highest.max(body.feet().y);
    });
    assert!((highest - 11.0).abs() < 0.01, "{highest}");
    assert_eq!(body.velocity(), DVec3::ZERO);
}

#[test]
fn a_door_pushes_who_stands_in_its_way_and_can_be_walked_up_to() {
    let door = |degrees: f32| {
        Stage::new(
            UVec3::new(5, 7, 1),
            Vec3::new(0.0, 3.5, 0.5),
            Vec3::new(6.0, 4.5, 8.0),
            vec![BodyMotion::Swing {
                axis: Vec3::Y,
                degrees,
                cycle: cycle(6.0, 0.5),
            }],
        )
    };
    let swinging = door(-90.0);
    // In the way of the leaf, which swings towards +z.
    let mut body = body_at(DVec3::new(9.0, 1.0 + 1.7, 10.0), &swinging.at(0));
    body.mode = Mode::Walk;
    swinging.play(&mut body, 3.0, &Intent::default(), |_, _, _| {});
    assert!(
        body.feet().z > 11.0 || body.feet().x < 6.0,
        "{}",
        body.feet()
    );
    // A door that stands still stops who walks.
    let shut = door(0.0);
    let mut body = body_at(DVec3::new(8.0, 1.0 + 1.7, 4.0), &shut.at(0));
    body.mode = Mode::Walk;
    shut.play(&mut body, 3.0, &ahead(DVec3::Z), |_, _, _| {});
    let gap = 7.5 - (body.feet().z + 0.3);
    assert!((0.0..1e-5).contains(&gap), "{gap}");
}

/// A body that sweeps through a room but leaves space beside it.
fn random_stage(random: &mut Random) -> Stage {
    let size = UVec3::new(
        1 + (random.next() % 5) as u32,
        1 + (random.next() % 3) as u32,
        1 + (random.next() % 5) as u32,
    );
    let mut vector = || Vec3::from_array([0; 3].map(|_| random.share() as f32 * 2.0 - 1.0));
    let middle = Vec3::splat(EDGE as f32 / 2.0);
    let (position, radius, axis) = (middle + vector(), vector() * 2.5, vector());
    let motion = vec![
        BodyMotion::Travel(Travel::Orbit {
            radius,
            rate: 2.0,
            phase: 0.4,
        }),
        BodyMotion::Turn {
            axis: axis + Vec3::Y * 0.1,
            rate: 1.5,
        },
    ];
    Stage::new(size, size.as_vec3() / 2.0, position, motion)
}

/// Random moves in rooms through which a body sweeps: the player is never in stone, nor in the body.
#[test]
fn a_body_that_moves_never_keeps_the_player_inside() {
    let (mut met, mut steps) = (0, 0);
    for seed in 0..150 {
        let mut random = Random(seed);
        let stage = random_stage(&mut random);
        let mut body = in_the_middle(&stage);
        body.mode = match random.next().is_multiple_of(2) {
            true => Mode::Walk,
            false => Mode::Fly,
        };
        let mut intent = random.intent();
        for step in 1..=600u64 {
            if random.next().is_multiple_of(8) {
                intent = random.intent();
            }
            let now = stage.at(step * 8_333_333);
            met += u32::from(now.in_the_way().overlaps(&body.shape()));
            steps += 1;
            assert_eq!(
                body.step(&now, &intent, DT_S),
                None,
                "world {seed}, step {step}"
            );
            assert!(!body.shape().overlaps(&now), "world {seed}, step {step}");
            let (low, high) = body.shape().voxels();
            let is_in_room = low.min_element() >= 1 && high.max_element() < EDGE - 1;
            assert!(is_in_room, "world {seed}, step {step}: {low} {high}");
        }
    }
    // The check sees bodies that move into a player who does not give way.
    assert!(met > steps / 100, "{met} of {steps}");
}
