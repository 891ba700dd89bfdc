//! From a scene that fails to a simpler one that fails by the same check.

use std::sync::atomic::{AtomicBool, Ordering};

use super::{
    checks::Check,
    examine::{Examination, examine},
    fault::Fault,
    scene::Scene,
    watched::Watched,
};

/// Most scenes that are played on the way: a bound on the time that a failure takes.
pub const MOST_TRIES: u32 = 60;

/// The simplest scene that was found, and why it fails.
pub struct Shrunk {
    pub scene: Scene,
    pub message: String,
    pub tries: u32,
}

/// Takes away parameters and parts of the world, and makes numbers simpler, as long as `check` still fails:
/// greedily, the steps that take most away first. A world that cannot be read counts as no try.
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
    // A world that cannot be read has a message with a place; a smaller one would have another.
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
        // After a step that fails the same, what stands at its place is another.
        at += usize::from(!better);
    }
    shrunk
}
