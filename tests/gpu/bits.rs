//! Bits: small cubes that fly off dug voxels, and the bulbs of lamps. Their places against rays in f64, their light
//! against that of walls, and that they change nothing but the picture.

use glam::{DVec2, DVec3, UVec3, Vec3};
use grotto::{
    gpu::{Gpu, Recorder, Timing},
    measure::picture::Picture,
    parameters::{Antialias, ProbeParameters},
    passes::view::bits::{Bits, GpuBit},
    reference::march::{Outcome, Ray, march},
    world::{View, World},
};

use crate::support::{
    frames::{Drawn, apart, mean},
    gpu, parsed,
    scenes::{flat, lattice},
    shipped, with_faults,
};

const SIZE: [u32; 2] = [60, 44];

/// A floor with a pillar, in the sun.
fn yard() -> World {
    parsed(
        "(title: \"A yard.\", size: (32, 24, 32), origin: (-16, -8, -16),
          shape: Union([
            Plane(normal: (0, 1, 0), offset: 0),
            Translate(by: (3, 5, -2), of: Box(half: (1, 5, 1))),
          ]),
          materials: {\"stone\": (a: Flat(0.5, 0.4, 0.3))},
          sun: (towards: (2, 3, 1), irradiance: (3, 2.7, 2.3)),
          sky: (zenith: (0.3, 0.5, 1)),
          cameras: [(name: \"front\", position: (1, 4.3, 13), look_at: (1, 2.5, -2), fov_deg: 70)])",
    )
}

fn drawn_of(gpu: Gpu, size: [u32; 2]) -> Drawn {
    let layout = lattice(UVec3::splat(2), Vec3::splat(12.0), Vec3::new(0.0, 6.0, 0.0));
    let probes = ProbeParameters {
        rays: 8,
        // In pictures as small as these, light of the floor's own would be noise behind the bits.
        face_pixels: 2.0,
        ..Default::default()
    };
    Drawn::new(gpu, yard(), &layout, probes, size)
}

/// A cube that glows and reflects nothing.
fn glowing(centre: DVec3, half_size: f32) -> GpuBit {
    GpuBit {
        centre_ws: centre.as_vec3().to_array(),
        half_size,
        emission: [7.0, 0.25, 5.0],
        flies: 1,
        ..Default::default()
    }
}

/// A hundred bits before, beside and behind the pillar: more than one batch of a workgroup.
fn swarm() -> Vec<GpuBit> {
    let number = |n: u32, of: u32| f64::from(n * 37 % of) / f64::from(of);
    let bit = |n: u32| {
        let place = DVec3::new(number(n, 101), number(n, 67), number(n, 59));
        let centre = DVec3::new(-4.0, 0.3, -8.0) + place * DVec3::new(11.0, 6.0, 12.0);
        glowing(centre, 0.12 + 0.2 * number(n, 7) as f32)
    };
    // One is larger than a tile of pixels.
    let large = glowing(DVec3::new(-3.0, 1.5, 6.0), 0.9);
    (0..100).map(bit).chain([large]).collect()
}

fn with_bits(drawn: &mut Drawn, bits: &[GpuBit]) -> Picture {
    drawn.frame.set_bits(&drawn.gpu, bits).expect("they fit");
    drawn.draw(1);
    drawn.radiance()
}

/// Whether the camera sees a bit through each pixel, by slabs in f64; `None` within `margin` voxels of an edge.
fn seen(drawn: &Drawn, bits: &[GpuBit], margin: f64) -> Vec<Option<bool>> {
    let voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
    let [width, height] = SIZE.map(f64::from);
    let basis = drawn.shot.camera.basis(width / height);
    let is_met = |through: DVec3, grow: f64| {
        let origin = basis.origin - drawn.world.origin.as_dvec3();
        let ray = Ray::new(origin, through.normalize());
        let reach = match march(&voxels, &ray) {
            Outcome::Hit(hit) => hit.distance / through.length(),
            Outcome::Inside(_) => 0.0,
            Outcome::Miss => f64::INFINITY,
        };
        bits.iter().any(|bit| {
            let offset = Vec3::from(bit.centre_ws).as_dvec3() - basis.origin;
            let half = DVec3::splat(f64::from(bit.half_size) + grow);
            let (a, b) = ((offset - half) / through, (offset + half) / through);
            let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
            enters > 0.0 && enters <= leaves && enters < reach - grow.min(0.0)
        })
    };
    let pixel = |index: u32| {
        let centre = DVec2::new(f64::from(index % SIZE[0]), f64::from(index / SIZE[0])) + 0.5;
        let through = basis.direction_ws(centre, DVec2::new(width, height));
        let found = is_met(through, margin);
        (found == is_met(through, -margin)).then_some(found)
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

/// Pixels that show a bit where none is to be seen, or none where one is; and those that rightly show one.
fn misplaced(gpu: Gpu) -> [usize; 2] {
    let mut drawn = drawn_of(gpu, SIZE);
    let before = {
        drawn.draw(1);
        drawn.radiance()
    };
    let bits = swarm();
    let picture = with_bits(&mut drawn, &bits);
    let mut counts = [0; 2];
    let pixels = picture.rgb.iter().zip(&before.rgb);
    for ((now, before), expected) in pixels.zip(seen(&drawn, &bits, 1e-3)) {
        let shows = *now == [7.0, 0.25, 5.0];
        match expected {
            Some(expected) if expected != shows => counts[0] += 1,
            Some(true) => counts[1] += 1,
            // The light of the yard still settles.
            Some(false) => counts[0] += usize::from(now[0] > 2.0 * before[0] + 0.5),
            None => {}
        }
    }
    counts
}

#[test]
fn bits_are_seen_where_they_are_and_hidden_behind_voxels() {
    let gpu = gpu();
    let [wrong, right] = misplaced(gpu.clone());
    assert_eq!(wrong, 0);
    assert!(right > 60, "{right}");
    for (sound, faulty) in [
        // What stands before a bit does not hide it.
        ("met.distance < nearest", "true"),
        // A tile sees less than the cone around its rays.
        ("let radius = 1.7321 * bit.half_size;", "let radius = 0.0;"),
        // One batch only.
        ("first < bit_count", "first < min(bit_count, 64u)"),
    ] {
        let faulty_gpu = with_faults(&gpu, &[("view/bits.wesl", sound, faulty)]);
        let [wrong, _] = misplaced(faulty_gpu);
        assert!(wrong > 3, "{wrong} with `{faulty}`");
    }
}

#[test]
fn the_nearest_bit_is_seen_and_a_bit_around_the_eye_is_looked_through() {
    let mut drawn = drawn_of(gpu(), SIZE);
    let eye = drawn.shot.camera.position.as_dvec3();
    let ahead = drawn.shot.camera.basis(1.0).forward;
    let mut near = glowing(eye + 3.0 * ahead, 0.2);
    near.emission = [0.0, 9.0, 0.0];
    let far = glowing(eye + 4.0 * ahead, 0.2);
    let around = glowing(eye, 0.3);
    let centre = (SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize;
    for bits in [[near, far, around], [around, far, near]] {
        let picture = with_bits(&mut drawn, &bits);
        assert_eq!(picture.rgb[centre], [0.0, 9.0, 0.0]);
    }
}

#[test]
fn without_bits_a_frame_is_what_it_was_and_with_bits_nothing_but_its_picture_changes() {
    let mut never = drawn_of(gpu(), SIZE);
    let mut drawn = drawn_of(never.gpu.clone(), SIZE);
    let gpu = drawn.gpu.clone();
    drawn.frame.prepare_bits(&gpu).expect("fits");
    let mut timing = Timing::new(&gpu).expect("a clock");
    let mut runs = |drawn: &mut Drawn| {
        drawn.shot.frame = drawn.frame.frames();
        let mut recorder = Recorder::new(&drawn.gpu, Some(&mut timing));
        let (shot, lights) = (&drawn.shot, &drawn.lights);
        drawn
            .frame
            .record(&drawn.gpu, &mut recorder, shot, lights, &drawn.probes);
        recorder.submit(&drawn.gpu).expect("submits");
        drawn.gpu.wait().expect("the device lives");
        let times = timing.next_frame().expect("one frame was drawn");
        times.passes_ms.contains_key("view/bits")
    };
    assert!(!runs(&mut drawn), "without bits their pass does not run");
    never.draw(1);
    assert!(never.radiance() == drawn.radiance());
    // They glow, but nothing is lit by them.
    let swarm = swarm();
    for _ in 0..6 {
        let picture = with_bits(&mut drawn, &swarm);
        never.draw(1);
        assert!(picture != never.radiance());
    }
    assert!(runs(&mut drawn));
    never.draw(1);
    let picture = with_bits(&mut drawn, &[]);
    never.draw(1);
    assert!(picture == never.radiance());
    // Views of data show voxels alone.
    drawn.shot.view = View::Depth;
    never.shot.view = View::Depth;
    let picture = with_bits(&mut drawn, &swarm);
    never.draw(1);
    assert!(picture == never.radiance());
    // A resized frame still has them.
    drawn.shot.view = View::Full;
    let before = with_bits(&mut drawn, &swarm);
    drawn.frame.resize(&gpu, SIZE).expect("fits");
    drawn.draw(1);
    let lit = |picture: &Picture| picture.rgb.iter().filter(|rgb| rgb[0] == 7.0).count();
    assert_eq!(lit(&drawn.radiance()), lit(&before));
    assert!(swarm.len() < Bits::MOST);
}

/// The mean of the pixels that show a bit (there the picture differs from one without it).
fn of_bit(drawn: &mut Drawn, bit: GpuBit) -> f64 {
    let without = with_bits(drawn, &[]);
    let picture = with_bits(drawn, &[bit]);
    let pairs = picture.rgb.iter().zip(&without.rgb);
    let changed = pairs.filter(|(now, before)| {
        let [now, before] = [now, before].map(|rgb| f64::from(rgb[1]));
        (now - before).abs() > 0.02 * before.max(1e-3)
    });
    let (mut sum, mut count) = (0.0, 0);
    for (now, _) in changed {
        sum += f64::from(now[1]);
        count += 1;
    }
    assert!(count > 4, "{count} pixels show it");
    sum / f64::from(count)
}

fn reflecting(centre: Vec3, half_size: f32, albedo: f32) -> GpuBit {
    GpuBit {
        centre_ws: centre.to_array(),
        half_size,
        albedo: [albedo; 3],
        flies: 1,
        ..Default::default()
    }
}

#[test]
fn in_a_furnace_bits_reflect_what_arrives_everywhere() {
    let world = shipped("furnace");
    let layout = world.layouts[1].clone();
    let probes = ProbeParameters::default();
    let mut drawn = Drawn::new(gpu(), world, &layout, probes, SIZE);
    drawn.draw(100);
    // Every surface has a radiance of 2.
    for albedo in [0.25, 0.8] {
        for centre in [Vec3::new(-4.3, 0.4, 4.6), Vec3::new(-6.2, -1.4, 6.7)] {
            let found = of_bit(&mut drawn, reflecting(centre, 0.4, albedo));
            let expected = 2.0 * f64::from(albedo);
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{found} for {expected}"
            );
        }
    }
}

/// A closed room with a lamp, seen from above at its floor.
fn lamp_room(power: f64) -> Drawn {
    let mut world = parsed(&format!(
        "(title: \"A room.\", size: (24, 24, 24), origin: (-12, -12, -12),
          shape: Subtraction([Box(half: (12, 12, 12)), Box(half: (8, 8, 8))]),
          lamps: [(name: \"lamp\", lamps: [(position: (3.7, 2.3, -2.9), power: {power})])],
          sky: (zenith: (0, 0, 0)),
          cameras: [(name: \"down\", position: (0.3, -3, 0.4), look_at: (0.31, -8, 0.4), fov_deg: 60)],
          layouts: [(name: \"lattice\", counts: (4, 4, 4), spacing: 6)])"
    ));
    world.materials = vec![flat(0.5, 0.0)];
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters::default();
    let mut drawn = Drawn::new(gpu(), world, &layout, probes, SIZE);
    drawn.draw(if power > 0.0 { 120 } else { 4 });
    drawn
}

#[test]
fn bits_are_as_bright_as_the_wall_beside_them_and_dark_in_a_dark_room() {
    let mut lit = lamp_room(1000.0);
    let floor = with_bits(&mut lit, &[]);
    let centre = (SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize;
    let expected = f64::from(floor.rgb[centre][1]);
    // Flat on the floor, and of its albedo: one cannot tell it from the floor.
    let bit = reflecting(Vec3::new(0.3, -7.9, 0.4), 0.1, 0.5);
    let found = f64::from(with_bits(&mut lit, &[bit]).rgb[centre][1]);
    assert!(
        (found / expected - 1.0).abs() < 0.06,
        "{found} beside {expected}"
    );
    // Twice the albedo, in twice the light.
    let bright = reflecting(Vec3::new(0.3, -7.9, 0.4), 0.1, 1.0);
    let bright = f64::from(with_bits(&mut lit, &[bright]).rgb[centre][1]);
    assert!((bright / found - 2.0).abs() < 0.01, "{bright}");
    let mut dark = lamp_room(0.0);
    let bit = reflecting(Vec3::new(0.3, -6.0, 0.4), 0.3, 0.9);
    let picture = with_bits(&mut dark, &[bit]);
    assert_eq!(mean(&picture), 0.0);
    // At the place of the lamp only the light of the walls falls on a bulb: its own lamp has no direction there.
    let at_lamp = Vec3::new(3.7, 2.3, -2.9);
    lit.shot.camera.position = at_lamp + Vec3::new(0.0, 2.0, 0.0);
    let bulb = of_bit(&mut lit, reflecting(at_lamp, 0.2, 0.5));
    assert!(
        bulb > 0.5 * expected && bulb < 1.2 * expected,
        "{bulb} against {expected}"
    );
}

/// Some frames at rest, and then a bit that flies across the picture. Returns the share of the pixels that it crossed
/// that differ from a picture without it in the frame after it is gone.
fn ghosts(gpu: Gpu) -> f64 {
    let mut drawn = drawn_of(gpu, SIZE);
    let gpu = drawn.gpu.clone();
    drawn.frame.prepare_bits(&gpu).expect("fits");
    let mut never = drawn_of(gpu.clone(), SIZE);
    for drawn in [&mut drawn, &mut never] {
        let smoothed = drawn.frame.antialias(&gpu, Antialias::Temporal);
        smoothed.expect("fits");
        // History is clipped in the 40 frames of warm-up and in 16 more, and then averages ever more frames.
        drawn.draw(80);
    }
    let mut crossed = vec![false; never.radiance().rgb.len()];
    for frame in 0..8 {
        let x = -4.0 + 1.3 * f64::from(frame);
        let bits = [glowing(DVec3::new(x, 1.2, 5.0), 0.6)];
        with_bits(&mut drawn, &bits);
        for (crossed, seen) in crossed.iter_mut().zip(seen(&drawn, &bits, 0.0)) {
            *crossed |= seen == Some(true);
        }
    }
    let after = with_bits(&mut drawn, &[]);
    never.draw(9);
    let [mut count, mut kept] = [0, 0];
    let clean = never.radiance();
    let pairs = after.rgb.iter().zip(&clean.rgb).zip(crossed);
    for ((now, clean), _) in pairs.filter(|(_, crossed)| *crossed) {
        count += 1;
        kept += u32::from((now[0] - clean[0]).abs() > 0.1);
    }
    assert!(count > 60, "{count}");
    f64::from(kept) / f64::from(count)
}

#[test]
fn what_flies_leaves_no_ghost() {
    let gpu = gpu();
    let right = ghosts(gpu.clone());
    // A pixel begins again with one ray, which may see another of the surfaces at its edge.
    assert!(right < 0.2, "{right}");
    // Planted: it is averaged like a surface.
    let flies = "select(1.0, SHOWN_AS_LIGHT, bits[owner / BIT_FACES].flies == 1u)";
    let wrong = ghosts(with_faults(&gpu, &[("view/bits.wesl", flies, "1.0")]));
    assert!(wrong > 0.5, "{wrong}");
}

#[test]
fn a_bulb_is_smoothed_like_a_voxel_and_gone_at_once() {
    let mut bulb = glowing(DVec3::new(-1.0, 3.0, 4.0), 0.8);
    bulb.flies = 0;
    bulb.emission = [1.0, 0.9, 0.6];
    let mut drawn = drawn_of(gpu(), SIZE);
    let gpu = drawn.gpu.clone();
    drawn.frame.set_bits(&gpu, &[bulb]).expect("fits");
    let plain = {
        drawn.draw(30);
        drawn.radiance()
    };
    drawn
        .frame
        .antialias(&gpu, Antialias::Temporal)
        .expect("fits");
    drawn.draw(90);
    let smooth = drawn.radiance();
    let mixed = |picture: &Picture| {
        let is_mixed = |rgb: &&[f32; 3]| {
            // Between the bulb and the darker floor and sky behind it.
            rgb[2] < 0.55 && rgb[0] > 0.62 && rgb[0] < 0.95
        };
        picture.rgb.iter().filter(is_mixed).count()
    };
    assert!(
        mixed(&smooth) >= mixed(&plain) + 5,
        "{} {}",
        mixed(&smooth),
        mixed(&plain)
    );
    // It goes out and is taken away, without any change of voxels, lamps or camera.
    let gone = with_bits(&mut drawn, &[]);
    drawn.draw(90);
    let clean = drawn.radiance();
    let ghost = apart(&gone, &clean) / apart(&smooth, &clean);
    assert!(ghost < 0.35, "{ghost}");
}
