//! The control on machines whose frames take a known time.

use super::*;

/// A machine: milliseconds of a frame at full effort, split by what they depend on.
#[derive(Clone, Copy)]
struct Machine {
    fixed_ms: f64,
    pixels_ms: f64,
    rays_ms: f64,
    /// Standard deviation of a frame's time, relative to it.
    noise: f64,
    /// One in this many frames takes ten times as long; 0: none.
    hitches: u32,
}

/// Mostly pixels, as a software adapter is.
const SLOW: Machine = Machine {
    fixed_ms: 10.0,
    pixels_ms: 250.0,
    rays_ms: 120.0,
    noise: 0.0,
    hitches: 0,
};

impl Machine {
    fn frame_ms(&self, effort: Effort, random: &mut Random) -> f64 {
        let scale = f64::from(effort.scale);
        let even =
            self.fixed_ms + self.pixels_ms * scale * scale + self.rays_ms * f64::from(effort.rays);
        let is_hitch = self.hitches > 0 && random.next() < 1.0 / f64::from(self.hitches);
        even * (self.noise * random.normal()).exp() * if is_hitch { 10.0 } else { 1.0 }
    }

    fn times(self, factor: f64) -> Self {
        Self {
            fixed_ms: self.fixed_ms * factor,
            pixels_ms: self.pixels_ms * factor,
            rays_ms: self.rays_ms * factor,
            ..self
        }
    }
}

/// Knuth's 64-bit linear congruential generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// About normal: the sum of twelve even numbers.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

/// What a stretch of frames did.
struct Course {
    /// How often the effort, and the scale in it, changed.
    changes: u32,
    resizes: u32,
    /// Seconds until the effort changed last.
    settled_s: f64,
    /// Mean time of a frame at the effort of the end.
    end_ms: f64,
}

fn play(auto: &mut Auto, machine: Machine, seconds: f64, random: &mut Random) -> Course {
    let mut course = Course {
        changes: 0,
        resizes: 0,
        settled_s: 0.0,
        end_ms: 0.0,
    };
    let mut passed_s = 0.0;
    while passed_s < seconds {
        let before = auto.effort();
        let ms = machine.frame_ms(before, random);
        passed_s += 1e-3 * ms;
        auto.frame(ms);
        if auto.effort() != before {
            course.changes += 1;
            course.resizes += u32::from(auto.effort().scale != before.scale);
            course.settled_s = passed_s;
        }
    }
    let even = Machine {
        noise: 0.0,
        hitches: 0,
        ..machine
    };
    course.end_ms = even.frame_ms(auto.effort(), random);
    course
}

#[test]
fn a_slow_machine_reaches_its_target_in_seconds_and_stays() {
    let mut random = Random(1);
    let mut auto = Auto::new(150.0);
    let course = play(&mut auto, SLOW, 20.0, &mut random);
    assert!(course.settled_s < 15.0, "{} s", course.settled_s);
    assert!(course.end_ms < 1.1 * 150.0, "{} ms", course.end_ms);
    assert!(course.end_ms > 0.6 * 150.0, "more was given up than needed");
    let later = play(&mut auto, SLOW, 600.0, &mut random);
    assert_eq!(later.changes, 0);
}

#[test]
fn noise_and_hitches_change_nothing_for_long() {
    for (seed, noise) in [(2, 0.05), (3, 0.15), (4, 0.3)] {
        let mut random = Random(seed);
        let machine = Machine {
            noise,
            hitches: 40,
            ..SLOW
        };
        let mut auto = Auto::new(150.0);
        play(&mut auto, machine, 60.0, &mut random);
        let later = play(&mut auto, machine, 3600.0, &mut random);
        assert!(
            later.changes <= 20 && later.resizes <= 12,
            "noise {noise}: {} changes, {} sizes in an hour",
            later.changes,
            later.resizes
        );
        assert!(later.end_ms < 1.3 * 150.0, "{} ms", later.end_ms);
    }
}

#[test]
fn a_target_out_of_reach_ends_at_the_lowest_step_without_a_change_after() {
    let mut random = Random(5);
    let mut auto = Auto::new(16.7);
    let machine = Machine { noise: 0.1, ..SLOW };
    play(&mut auto, machine, 20.0, &mut random);
    assert_eq!(auto.effort(), Effort::of_step(Effort::LOWEST));
    let later = play(&mut auto, machine, 600.0, &mut random);
    assert_eq!(later.changes, 0);
}

#[test]
fn a_machine_that_becomes_faster_gets_everything_back() {
    let mut random = Random(6);
    let mut auto = Auto::new(150.0);
    play(&mut auto, SLOW, 30.0, &mut random);
    assert_ne!(auto.effort(), Effort::FULL);
    let course = play(&mut auto, SLOW.times(0.2), 60.0, &mut random);
    assert_eq!(auto.effort(), Effort::FULL);
    assert!(course.settled_s < 30.0, "{} s", course.settled_s);
    // And gives it up again.
    let course = play(&mut auto, SLOW, 30.0, &mut random);
    assert!(course.end_ms < 1.1 * 150.0, "{} ms", course.end_ms);
}

#[test]
fn a_fast_machine_is_left_alone() {
    let mut random = Random(7);
    let mut auto = Auto::new(16.7);
    let machine = Machine {
        noise: 0.2,
        hitches: 100,
        ..SLOW.times(0.004)
    };
    let course = play(&mut auto, machine, 600.0, &mut random);
    assert_eq!((course.changes, auto.effort()), (0, Effort::FULL));
}

#[test]
fn load_that_comes_and_goes_does_not_swing_the_picture() {
    let mut random = Random(8);
    let mut auto = Auto::new(150.0);
    play(&mut auto, SLOW, 30.0, &mut random);
    let mut changes = 0;
    // Who walks and stands in turn: standing costs half.
    for _ in 0..200 {
        changes += play(&mut auto, SLOW.times(0.5), 4.0, &mut random).changes;
        changes += play(&mut auto, SLOW, 4.0, &mut random).changes;
    }
    assert!(changes <= 60, "{changes} changes in 400 turns of 4 s each");
}

// No step upwards from the fast side ends on the slow side.
const _: () = assert!(Auto::FAST * Effort::DEAREST_STEP < Auto::SLOW);

#[test]
fn frames_after_an_interruption_do_not_count() {
    let mut auto = Auto::new(10.0);
    for _ in 0..100 {
        auto.interrupt();
        auto.frame(5000.0);
        auto.frame(5000.0);
        auto.frame(9.0);
    }
    assert_eq!(auto.effort(), Effort::FULL);
}
