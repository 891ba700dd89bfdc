//! Counts the frames between an input and the first picture that shows it.
//!
//! For each input a twin of the player lives on without it, and one ideal player gets every input at once. The
//! input is shown in the first frame in which the player sees the world from another place or in another direction
//! than the twin. Only inputs count that the ideal player sees in the very next frame: a key that is pressed
//! against a wall, or released in the middle of a jump, takes effect later because of the world, not because
//! anything is late.

use serde::Serialize;

use crate::app::{body::Terrain, input::Input, player::Player};

/// An input that is not shown in this many frames is lost.
const PATIENCE: u32 = 60;
/// Twins at a time; further inputs are not measured.
const MOST: usize = 64;

/// How many frames later than possible inputs were shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LatencyFigures {
    /// Inputs that were seen. An input shown in the very next frame has a latency of 0 frames.
    pub inputs: u64,
    pub mean_frames: f64,
    pub most_frames: u32,
    /// Inputs that were never shown.
    pub lost: u64,
    /// Inputs that could not be seen in the very next frame, such as a step against a wall.
    pub without_effect: u64,
}

#[derive(Default)]
pub struct Latency {
    /// Got every input at once.
    ideal: Option<Player>,
    twins: Vec<Twin>,
    figures: LatencyFigures,
    total_frames: u64,
}

/// A player who did not get one of the inputs.
struct Twin {
    player: Player,
    frames: u32,
}

impl Latency {
    /// The player is about to take this input.
    pub fn input(&mut self, player: &Player, input: &Input, terrain: &impl Terrain) {
        if matches!(input, Input::Camera(_) | Input::Reload) {
            // All are put in the same place: nothing could be told apart any more.
            self.twins.clear();
            self.ideal = None;
            return;
        }
        let ideal = self.ideal.get_or_insert_with(|| player.clone());
        for twin in &mut self.twins {
            twin.player.take(input, terrain);
        }
        let is_measured = matches!(input, Input::Press(_) | Input::Release(_) | Input::Look(..));
        if is_measured && self.twins.len() < MOST {
            self.twins.push(Twin {
                player: ideal.clone(),
                frames: 0,
            });
        }
        ideal.take(input, terrain);
    }

    /// The player is about to simulate until this time.
    pub fn advance(&mut self, to_ns: u64, terrain: &impl Terrain) {
        let twins = self.twins.iter_mut().map(|twin| &mut twin.player);
        for player in twins.chain(&mut self.ideal) {
            player.advance(to_ns, terrain);
            drop(player.take_notices());
        }
    }

    /// A frame shows what the player sees.
    pub fn shown(&mut self, player: &Player, terrain: &impl Terrain) {
        let Some(ideal) = &self.ideal else {
            return;
        };
        let (seen, possible) = (player.view(terrain), ideal.view(terrain));
        let (figures, total_frames) = (&mut self.figures, &mut self.total_frames);
        self.twins.retain_mut(|twin| {
            let without = twin.player.view(terrain);
            if without != seen {
                figures.inputs += 1;
                figures.most_frames = figures.most_frames.max(twin.frames);
                *total_frames += u64::from(twin.frames);
                return false;
            }
            if twin.frames == 0 && without == possible {
                figures.without_effect += 1;
                return false;
            }
            twin.frames += 1;
            figures.lost += u64::from(twin.frames == PATIENCE);
            twin.frames < PATIENCE
        });
    }

    /// Of all inputs whose effect is known.
    pub fn figures(&self) -> LatencyFigures {
        LatencyFigures {
            mean_frames: self.total_frames as f64 / self.figures.inputs.max(1) as f64,
            ..self.figures
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::IVec3;

    use super::*;
    use crate::{app::input::Key, world::file};

    struct Floor;

    impl Terrain for Floor {
        fn is_solid(&self, voxel: IVec3) -> bool {
            voxel.y < 0
        }
    }

    const FRAME_NS: u64 = 16_666_667;

    /// Frames of 1/60 s with these inputs before each, shown to the player `late` frames after they are told.
    fn measured(inputs: &[Option<Input>], late: usize) -> LatencyFigures {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = file::load(&path, &file::Overrides::default()).expect("it loads");
        let mut camera = world.cameras[0].clone();
        camera.position = glam::Vec3::new(0.0, 1.625, 0.0);
        let mut player = Player::new(&camera, &world, &Floor);
        let mut latency = Latency::default();
        for frame in 0..120 {
            let input = |index: Option<usize>| inputs.get(index?)?.as_ref();
            if let Some(told) = input(Some(frame)) {
                latency.input(&player, told, &Floor);
            }
            if let Some(taken) = input(frame.checked_sub(late)) {
                player.take(taken, &Floor);
            }
            let to_ns = (frame as u64 + 1) * FRAME_NS;
            latency.advance(to_ns, &Floor);
            player.advance(to_ns, &Floor);
            latency.shown(&player, &Floor);
        }
        latency.figures()
    }

    #[test]
    fn what_is_shown_at_once_is_not_late_and_what_is_held_back_is() {
        let walk = [None, Some(Input::Press(Key::Forward)), None];
        let look = [Some(Input::Look(5.0, 0.0)), None];
        for inputs in [&walk[..], &look] {
            for late in [0, 1, 3] {
                let figures = measured(inputs, late);
                let found = (figures.inputs, figures.most_frames, figures.mean_frames);
                assert_eq!(found, (1, late as u32, late as f64), "{inputs:?}");
            }
        }
    }

    #[test]
    fn a_key_that_does_nothing_has_no_latency() {
        let figures = measured(&[Some(Input::Press(Key::Run))], 0);
        assert_eq!((figures.inputs, figures.without_effect), (0, 1));
        let blocked = measured(&[Some(Input::Press(Key::Forward))], 1000);
        assert_eq!((blocked.inputs, blocked.lost), (0, 1), "it never arrives");
    }
}
