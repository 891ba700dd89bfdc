use glam::{DVec3, I64Vec3, IVec3, Quat, UVec3, Vec3};
use proptest::prelude::*;

use super::super::tests::{DT_S, EDGE, Grid, HEIGHT, Random, ahead};
use super::super::{Body, Intent, Mode};
use super::*;
use crate::world::bodies::{self, BodyModel, BodyMotion, Cycle, Pose};

/// A world with bodies in it, and what stops the player there.
struct Stage {
    grid: Grid,
    bodies: Bodies,
    free: FreeBodies,
    time_s: f64,
}

impl Terrain for Stage {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.grid.is_solid(voxel)
    }

    fn obstacles(&self, at_ns: u64) -> Obstacles<'_> {
        Obstacles::at(&self.bodies, at_ns as f64 * 1e-9)
    }
}

fn full(size: UVec3) -> BodyModel {
    BodyModel {
        size,
        materials: vec![1; size.element_product() as usize],
    }
}

fn body(model: usize, corner: Vec3, put_by: PutBy) -> bodies::Body {
    bodies::Body {
        name: format!("body at {corner}"),
        model,
        pivot: Vec3::ZERO,
        rest: Pose {
            position: corner,
            rotation: Quat::IDENTITY,
        },
        motion: Vec::new(),
        put_by,
    }
}

impl Stage {
    fn new(grid: Grid, models: Vec<BodyModel>, bodies: Vec<bodies::Body>) -> Self {
        let bodies = Bodies {
            models,
            bodies,
            ..Bodies::default()
        };
        Self {
            grid,
            free: FreeBodies::of(&bodies),
            bodies,
            time_s: 0.0,
        }
    }

    /// Full bodies that a player placed in a closed room.
    fn placed(boxes: &[(UVec3, Vec3)]) -> Self {
        let models = boxes.iter().map(|(size, _)| full(*size));
        let bodies = boxes.iter().enumerate();
        let bodies = bodies.map(|(model, (_, corner))| body(model, *corner, PutBy::Placed));
        Self::new(Grid::room(0.0, 1), models.collect(), bodies.collect())
    }

    /// A step of all bodies and of the player, as a run does it.
    fn step(&mut self, player: &mut Body, intent: &Intent) -> Moved {
        self.time_s += DT_S;
        let level = |v: DVec3| DVec3::new(v.x, 0.0, v.z).normalize_or_zero();
        let course = level(intent.heading) * f64::from(intent.forward)
            + level(intent.rightwards) * f64::from(intent.right);
        let pusher = (player.mode != Mode::NoClip).then(|| Pusher {
            shape: player.shape(),
            course: course.normalize_or_zero(),
            velocity: player.velocity(),
        });
        let moved = self.free.step(
            &mut self.bodies,
            &self.grid,
            self.time_s,
            pusher.as_ref(),
            &player.measures,
            DT_S,
        );
        player.push(moved.pushed);
        let now = self.at((self.time_s * 1e9) as u64);
        player.step(&now, intent, DT_S);
        moved
    }

    fn play(&mut self, player: &mut Body, intent: &Intent, seconds: f64) {
        for _ in 0..(seconds / DT_S).round() as u32 {
            self.step(player, intent);
        }
    }

    fn corner(&self, index: usize) -> Vec3 {
        self.bodies.bodies[index].rest.position
    }

    /// Voxels that a body and stone both take, and pairs of bodies that overlap.
    fn overlaps(&self) -> Vec<String> {
        let cubes = |index: usize| {
            let body = &self.bodies.bodies[index];
            let at = point_to_units(body.rest.position.as_dvec3());
            let solid: Vec<Aabb> = (self.bodies.models[body.model].solid())
                .map(|voxel| {
                    let min = at + voxel.as_i64vec3() * ONE;
                    Aabb {
                        min,
                        max: min + I64Vec3::splat(ONE),
                    }
                })
                .collect();
            solid
        };
        let mut found = Vec::new();
        for index in 0..self.bodies.bodies.len() {
            let own = cubes(index);
            let in_stone = own.iter().any(|cube| cube.overlaps(&self.grid));
            found.extend(in_stone.then(|| format!("{index} in stone")));
            for other in 0..index {
                let others = cubes(other);
                let is_met = own.iter().any(|a| others.iter().any(|b| meet(a, b)));
                found.extend(is_met.then(|| format!("{index} in {other}")));
            }
        }
        found
    }
}

fn idle() -> Intent {
    Intent::default()
}

/// With the feet there.
fn player_at(feet: DVec3) -> Body {
    let eye = feet + DVec3::Y * 1.625;
    let measures = Measures::of_height(HEIGHT);
    Body::with_eye_at(eye, measures, 0.0, &Grid::room(0.0, 1))
}

/// Walks along +x from x = 3 over the floor at y = 1.
fn walker() -> Body {
    let mut player = player_at(DVec3::new(3.0, 1.0, 8.0));
    player.mode = Mode::Walk;
    player
}

#[test]
fn a_body_is_pushed_to_the_wall_at_an_even_speed_and_never_into_it() {
    let mut stage = Stage::placed(&[(UVec3::new(2, 3, 2), Vec3::new(5.0, 1.0, 7.0))]);
    let mut player = walker();
    let run = Intent {
        run: true,
        ..ahead(DVec3::X)
    };
    let mut speeds = Vec::new();
    for _ in 0..(12.0 / DT_S) as u32 {
        let feet = player.feet().x;
        let moved = stage.step(&mut player, &run);
        if moved.pushed.x > 0.0 {
            speeds.push((player.feet().x - feet) / DT_S);
        }
        assert_eq!(stage.overlaps(), [""; 0]);
        let now = stage.at(0);
        assert!(!player.shape().overlaps(&now), "never inside of the body");
    }
    assert_eq!(
        stage.corner(0),
        Vec3::new(13.0, 1.0, 7.0),
        "flush with the wall"
    );
    // The player keeps pace with what he pushes: his view does not tremble.
    let sneak = player.measures.sneak;
    let steady = &speeds[20..speeds.len() - 2];
    let uneven = steady
        .iter()
        .filter(|speed| (*speed - sneak).abs() > 0.1 * sneak);
    assert!(steady.len() > 300 && uneven.count() < 5, "{steady:?}");
    let gap = 13.0 - (player.feet().x + to_voxels(player.measures.half_width));
    assert!((0.0..1e-5).contains(&gap), "{gap}");
}

#[test]
fn a_body_falls_as_a_player_does_and_rests_on_the_floor_on_another_and_on_the_player() {
    let mut stage = Stage::placed(&[
        (UVec3::splat(2), Vec3::new(4.0, 9.0, 4.0)),
        (UVec3::splat(2), Vec3::new(5.0, 12.0, 5.0)),
        (UVec3::splat(2), Vec3::new(10.0, 10.0, 7.0)),
    ]);
    let mut player = player_at(DVec3::new(11.0, 1.0, 8.0));
    player.mode = Mode::Walk;
    let mut seconds = 0.0;
    while stage.corner(0).y > 1.0 {
        stage.play(&mut player, &idle(), DT_S);
        assert_eq!(stage.overlaps(), [""; 0]);
        seconds += DT_S;
    }
    let expected = (2.0f64 * 8.0 / player.measures.gravity).sqrt();
    assert!(
        (seconds - expected).abs() < 2.0 * DT_S,
        "{seconds} of {expected}"
    );
    stage.play(&mut player, &idle(), 2.0);
    assert_eq!(stage.corner(0).y, 1.0);
    assert_eq!(stage.corner(1).y, 3.0, "it lies on the first");
    let above = f64::from(stage.corner(2).y) - to_voxels(player.shape().max.y);
    assert!(
        (0.0..2.0 / 1024.0).contains(&above),
        "{above} above the head"
    );
    stage.play(&mut player, &ahead(DVec3::NEG_Z), 1.5);
    stage.play(&mut player, &idle(), 2.0);
    assert_eq!(stage.corner(2).y, 1.0, "the player went away");
    // Pushed off, the upper one falls; what it stood on stays.
    let mut player = player_at(DVec3::new(3.0, 3.0, 6.0));
    player.mode = Mode::Fly;
    stage.play(&mut player, &ahead(DVec3::X), 1.4);
    stage.play(&mut player, &idle(), 2.0);
    assert_eq!((stage.corner(0).x, stage.corner(1).y), (4.0, 1.0));
}

#[test]
fn digging_below_a_body_lets_it_fall_when_it_is_woken() {
    let mut stage = Stage::placed(&[(UVec3::splat(1), Vec3::new(8.0, 5.0, 8.0))]);
    stage.grid.set(IVec3::new(8, 4, 8), true);
    let mut player = walker();
    stage.play(&mut player, &idle(), 0.5);
    assert_eq!(stage.corner(0).y, 5.0);
    stage.grid.set(IVec3::new(8, 4, 8), false);
    stage.free.wake();
    stage.play(&mut player, &idle(), 2.0);
    assert_eq!(stage.corner(0).y, 1.0);
}

#[test]
fn a_body_of_the_world_file_stays_in_the_air_until_it_is_pushed() {
    let mut stage = Stage::placed(&[(UVec3::new(2, 2, 2), Vec3::new(5.0, 1.5, 7.03))]);
    stage.bodies.bodies[0].put_by = PutBy::WorldFile;
    let mut player = walker();
    stage.play(&mut player, &idle(), 1.0);
    assert_eq!(stage.corner(0), Vec3::new(5.0, 1.5, 7.03));
    assert!(stage.bodies.changes().is_empty());
    stage.play(&mut player, &ahead(DVec3::X), 2.0);
    assert_eq!(stage.corner(0).y, 1.0);
    assert!(stage.corner(0).x > 6.0);
    assert_eq!(stage.bodies.bodies[0].put_by, PutBy::Pushed);
    assert_eq!(stage.bodies.changes().moved[0].position, stage.corner(0));
}

#[test]
fn a_body_that_moves_or_is_turned_between_the_axes_is_not_pushed_and_one_that_is_turned_by_90_is() {
    for (degrees, motion, is_free) in [
        (30.0f32, vec![], false),
        (90.0, vec![], true),
        (180.0, vec![], true),
        (
            0.0,
            vec![BodyMotion::Turn {
                axis: Vec3::Y,
                rate: 0.1,
            }],
            false,
        ),
    ] {
        let mut turned = body(0, Vec3::new(8.0, 1.0, 8.0), PutBy::WorldFile);
        turned.pivot = Vec3::new(1.5, 0.0, 1.0);
        turned.rest.rotation = Quat::from_rotation_y(degrees.to_radians());
        turned.motion = motion;
        let models = vec![full(UVec3::new(3, 3, 2))];
        let mut stage = Stage::new(Grid::room(0.0, 1), models, vec![turned]);
        let mut player = walker();
        stage.play(&mut player, &ahead(DVec3::X), 3.0);
        let at = stage.corner(0);
        assert_eq!(at.x > 8.0, is_free, "{degrees}: {at}");
        assert_eq!(stage.free.exist(), is_free);
        if is_free {
            stage.play(&mut player, &ahead(DVec3::X), 20.0);
            let half = if degrees == 90.0 { 1.0 } else { 1.5 };
            assert_eq!(
                stage.corner(0).x,
                15.0 - half,
                "{degrees}: flush with the wall"
            );
        }
    }
}

#[test]
fn a_lift_carries_a_body_and_the_player_on_it() {
    let lift = BodyMotion::Lift {
        by: Vec3::Y * 5.0,
        cycle: Cycle {
            period_s: 8.0,
            rest_s: 1.0,
            phase_s: 0.0,
        },
    };
    let mut stage = Stage::placed(&[
        (UVec3::splat(2), Vec3::new(7.0, 2.0, 7.0)),
        (UVec3::new(4, 1, 4), Vec3::new(6.0, 1.0, 6.0)),
    ]);
    stage.bodies.bodies[1].motion = vec![lift];
    stage.free.follow(&stage.bodies);
    let mut player = player_at(DVec3::new(8.0, 4.0, 8.0));
    player.mode = Mode::Walk;
    for second in 0..16 {
        for _ in 0..120 {
            stage.step(&mut player, &idle());
            let lift_y = stage.bodies.bodies[1].pose(stage.time_s).position.y;
            let above = stage.corner(0).y - (lift_y + 1.0);
            assert!(
                (-0.002..0.03).contains(&above),
                "{above} in second {second}"
            );
            let feet = player.feet().y - f64::from(stage.corner(0).y) - 2.0;
            assert!((-0.01..0.05).contains(&feet), "{feet} in second {second}");
        }
        if second == 4 {
            assert!(stage.corner(0).y > 6.9);
        }
    }
}

#[test]
fn the_edges_of_a_solid_outside_stop_a_body() {
    let mut grid = Grid::new(|at| at.y == 0);
    grid.outside = true;
    let models = vec![full(UVec3::splat(2))];
    let bodies = vec![body(0, Vec3::new(9.0, 1.0, 7.0), PutBy::Placed)];
    let mut stage = Stage::new(grid, models, bodies);
    let mut player = walker();
    stage.play(&mut player, &ahead(DVec3::X), 15.0);
    assert_eq!(stage.corner(0).x, EDGE as f32 - 2.0);
}

#[test]
fn a_ray_meets_the_nearest_body() {
    let stage = Stage::placed(&[
        (UVec3::splat(2), Vec3::new(8.25, 1.0, 7.0)),
        (UVec3::splat(2), Vec3::new(5.0, 1.0, 7.0)),
    ]);
    let met = |from: DVec3, to: DVec3| stage.free.met(&stage.bodies, from, to);
    assert_eq!(met(DVec3::new(2.0, 2.0, 8.0), DVec3::X), Some((1, 3.0)));
    assert_eq!(
        met(DVec3::new(14.25, 2.0, 8.0), DVec3::NEG_X),
        Some((0, 4.0))
    );
    assert_eq!(met(DVec3::new(2.0, 2.0, 9.5), DVec3::X), None);
    assert_eq!(met(DVec3::new(6.0, 2.0, 8.0), DVec3::X), Some((1, 0.0)));
    let all = [IVec3::ZERO, IVec3::splat(EDGE)];
    let taken = |except| stage.free.within(&stage.bodies, all, except);
    let has = |x| taken(None).has(IVec3::new(x, 1, 7));
    assert_eq!([7, 8, 10, 11].map(has), [false, true, true, false]);
    assert!(!taken(Some(0)).has(IVec3::new(8, 1, 7)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// A player wanders at random through rubble and bodies of random shapes: nothing is ever inside of anything.
    #[test]
    fn nothing_ever_enters_stone_a_body_or_the_player(seed in any::<u64>()) {
        let mut random = Random(seed);
        let grid = Grid::room(0.12, seed);
        let models: Vec<BodyModel> = (0..3).map(|_| {
            let mut edge = || 1 + (random.next() % 3) as u32;
            let size = UVec3::new(edge(), edge(), edge());
            let mut model = full(size);
            for material in &mut model.materials[1..] {
                *material = u8::from(!random.next().is_multiple_of(4));
            }
            model
        }).collect();
        // Where there is room for them in the block of air in the middle.
        let places = [Vec3::new(6.0, 6.0, 6.0), Vec3::new(9.0, 6.0, 6.0), Vec3::new(6.0, 8.0, 9.0)];
        let mut bodies = Vec::new();
        for (model, place) in places.into_iter().enumerate() {
            bodies.push(body(model, place, PutBy::Placed));
            let stage = Stage::new(grid.clone(), models.clone(), bodies.clone());
            if !stage.overlaps().is_empty() {
                bodies.pop();
            }
        }
        let mut stage = Stage::new(grid, models, bodies);
        let mut player = player_at(DVec3::new(9.5, 8.0, 9.5));
        let is_free = |stage: &Stage, player: &Body| !player.shape().overlaps(&stage.at(0));
        prop_assume!(is_free(&stage, &player));
        for _ in 0..60 {
            let mut intent = random.intent();
            intent.fly_speed = intent.fly_speed.min(300.0);
            player.mode = if random.next().is_multiple_of(3) { Mode::Fly } else { Mode::Walk };
            for _ in 0..10 {
                stage.step(&mut player, &intent);
                prop_assert_eq!(stage.overlaps(), [""; 0]);
                prop_assert!(is_free(&stage, &player), "the player is in a body");
            }
        }
    }
}

#[test]
fn a_run_goes_on_where_the_player_stands_on_a_body() {
    let eye = DVec3::new(6.5, 3.0 + 1.625, 6.5);
    let mode = |stage: &Stage| Body::with_eye_at(eye, Measures::of_height(HEIGHT), 0.0, stage).mode;
    let corner = Vec3::new(5.0, 1.0, 5.0);
    let stage = Stage::placed(&[(UVec3::new(3, 2, 3), corner)]);
    assert_eq!(mode(&stage), Mode::Walk);
    assert_eq!(mode(&Stage::placed(&[])), Mode::Fly);
}
