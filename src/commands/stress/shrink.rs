//! Reduces a failing scene to a simpler one that fails the same check.

use std::sync::atomic::{AtomicBool, Ordering};

use super::{
    checks::Check,
    examine::{Examination, examine},
    fault::Fault,
    scene::Scene,
    watched::Watched,
};

/// Most scenes that are played for this: a bound on the time per failure.
pub const MOST_TRIES: u32 = 60;

/// The simplest failing scene that was found, and why it fails.
pub struct Shrunk {
    pub scene: Scene,
    pub message: String,
    pub tries: u32,
}

/// Removes parameters and parts of the world, and simplifies numbers, as long as `check` still fails. The
/// search is greedy and tries the steps first that remove most. A world that cannot be read does not count as a
/// try.
pub fn shrink(
    watched: &mut Watched,
    scene: &Scene,
    check: Check,
    message: &str,
    fault: Option<Fault>,
    most_tries: u32,
    stop: &AtomicBool,
) -> Shrunk {
    let mut shrunk = Shrunk {
        scene: scene.clone(),
        message: message.to_owned(),
        tries: 0,
    };
    let examination = Examination {
        fault,
        only: Some(check),
    };
    let mut fails = |shrunk: &mut Shrunk, candidate: Scene| {
        if candidate.load().is_err() {
            return false;
        }
        shrunk.tries += 1;
        let findings = examine(watched, &candidate, examination);
        let Some(message) = findings.failure(check) else {
            return false;
        };
        shrunk.message = message.to_owned();
        shrunk.scene = candidate;
        true
    };
    // The message for a world that cannot be read names a place; a smaller world would have another message.
    let most_tries = if check == Check::Loads { 0 } else { most_tries };
    let over = |shrunk: &Shrunk| shrunk.tries >= most_tries || stop.load(Ordering::Relaxed);
    let mut at = 0;
    while at < shrunk.scene.set.len() && !over(&shrunk) {
        let mut candidate = shrunk.scene.clone();
        candidate.set.remove(at);
        if !fails(&mut shrunk, candidate) {
            at += 1;
        }
    }
    let mut at = 0;
    while !over(&shrunk) {
        let Some(tree) = shrunk.scene.tree.clone() else {
            break;
        };
        let steps = tree.steps();
        let Some(step) = steps.get(at) else {
            break;
        };
        let simpler = tree.after(step).filter(|simpler| *simpler != tree);
        let better = simpler.is_some_and(|tree| {
            let candidate = shrunk.scene.with_tree(tree);
            fails(&mut shrunk, candidate)
        });
        // After a successful step, the next step has moved to this index.
        at += usize::from(!better);
    }
    shrunk
}
