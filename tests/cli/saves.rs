//! Saves as a user meets them: in the place of worlds, in lists, and after a program was killed while it wrote.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use glam::{IVec3, UVec3};
use grotto::world::{
    Overlay,
    file::{self, Overrides},
    save::{self, Head, Save, SavedHotbar, State},
};

use crate::{
    MINIMAL, grotto, refused, root,
    support::binary::{Ended, end},
};

/// A save of the smallest world at `path`, with these changes (grid space).
fn write(path: &Path, overlay: Overlay) {
    save::write(path, &save_of(path, overlay)).expect("writable");
}

pub fn save_of(path: &Path, overlay: Overlay) -> Save {
    let world_file = root().join(MINIMAL);
    let world = file::load(&world_file, &Overrides::default()).expect("it loads");
    let mut save = Save {
        head: Head {
            world: String::new(),
            world_file: String::new(),
            world_beside: None,
            world_crc32: file::fingerprint(&world_file).expect("it loads"),
            saved_s: 1_790_000_000,
            voxels: overlay.count(),
            lamps: 0,
            bodies: 0,
            grotto: "0.1.0".into(),
        },
        state: State {
            time_s: 2.5,
            paused: false,
            rate: 1.0,
            eye: [12.0, 12.0, 22.0],
            yaw_deg: 25.0,
            pitch_deg: -15.0,
            fov_deg: 70.0,
            layout: world.layouts[0].name.clone(),
            set: vec!["probes.rays=32".into()],
            materials: world.materials.iter().map(|m| m.name.clone()).collect(),
            origin: world.origin.to_array(),
            hotbar: SavedHotbar::default(),
        },
        overlay,
        lamps: Vec::new(),
        bodies: Default::default(),
    };
    save.belongs_to(&world_file, path);
    save
}

/// A tower of stone, and nothing where the ball was.
pub fn tower() -> Overlay {
    let mut overlay = Overlay::default();
    for y in 8..26 {
        for (x, z) in [(40, 40), (41, 40), (40, 41), (41, 41)] {
            overlay.set(UVec3::new(x, y, z), 1);
        }
    }
    overlay
}

fn saves(folder: &Path, arguments: &[&str]) -> Ended {
    end(grotto()
        .env(save::VARIABLE, folder)
        .arg("saves")
        .args(arguments))
}

#[test]
fn saves_are_listed_copied_renamed_and_deleted() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = place.path().join("saves");
    let none = saves(&folder, &["list"]);
    assert!(
        none.code == 0 && none.stdout.contains("no saves yet"),
        "{}",
        none.stderr
    );
    for _ in 0..2 {
        write(&folder.join("tower.grotto"), tower());
    }
    let listed = saves(&folder, &["list"]);
    for part in ["tower", "minimal", "72 voxels", "2026-09-21 14:13:20 UTC"] {
        assert!(listed.stdout.contains(part), "{part}: {}", listed.stdout);
    }
    assert_eq!(saves(&folder, &["copy", "tower", "high tower"]).code, 0);
    assert_eq!(saves(&folder, &["rename", "tower", "first"]).code, 0);
    let list = saves(&folder, &["list", "--json"]).json();
    let mut names: Vec<_> = list["saves"].as_array().expect("rows").iter().collect();
    names.sort_by_key(|row| row["name"].to_string());
    assert_eq!(names[0]["name"], "first");
    assert_eq!(names[1]["name"], "high tower");
    assert_eq!(names[1]["voxels"], 72);
    assert!(folder.join("first.grotto.bak").exists());
    let mut command = grotto();
    let bad = |arguments: &[&str]| {
        command = grotto();
        command
            .env(save::VARIABLE, &folder)
            .arg("saves")
            .args(arguments);
        end(&mut command)
    };
    let cases: [(&[&str], &str); 5] = [
        (&["delete", "first"], "--yes deletes"),
        (&["copy", "first", "high tower"], "already"),
        (&["copy", "none", "other"], "`first`"),
        (&["rename", "first", "../first"], "no slashes"),
        (&["rename", "first", ".first"], "dot"),
    ];
    let mut bad = bad;
    for (arguments, part) in cases {
        let ended = bad(arguments);
        assert!(
            ended.code == 2 && ended.stderr.contains(part),
            "{}",
            ended.stderr
        );
    }
    assert_eq!(saves(&folder, &["delete", "first", "--yes"]).code, 0);
    assert_eq!(fs::read_dir(&folder).expect("readable").count(), 1);
}

#[test]
fn a_save_stands_where_a_world_stands() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("tower.grotto");
    write(&path, tower());
    let path = path.to_str().expect("UTF-8");
    let checked = end(grotto().args(["check", path]));
    assert!(
        checked.code == 0 && checked.stdout.contains("save"),
        "{}",
        checked.stdout
    );
    let picture = |world: &str, name: &str| {
        let output = place.path().join(name);
        let ended = end(grotto()
            .args([
                "render", world, "--cpu", "--spp", "1", "--size", "48x27", "--camera", "front",
                "--view", "albedo", "-o",
            ])
            .arg(&output));
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        fs::read(output).expect("a picture")
    };
    assert!(picture(path, "save.png") != picture(MINIMAL, "world.png"));
    let own = end(grotto()
        .args([
            "render", path, "--cpu", "--spp", "1", "--size", "16x9", "--camera", "none", "-o",
        ])
        .arg(place.path().join("x.png")));
    assert!(
        own.stderr.contains("it has `save`, `front`"),
        "{}",
        own.stderr
    );
}

#[test]
fn what_cannot_be_opened_says_so_once() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("tower.grotto");
    let check = |code: i32, parts: &[&str]| refused(grotto().arg("check").arg(&path), code, parts);
    check(2, &["no such save"]);
    write(&path, tower());
    let bytes = fs::read(&path).expect("readable");
    fs::write(&path, &bytes[..100]).expect("writable");
    check(
        2,
        &[
            "it ends in its head",
            "tower.grotto.damaged",
            "none was made",
        ],
    );
    assert!(!path.exists() && place.path().join("tower.grotto.damaged").exists());
    // With a backup, it is opened, and that is said.
    write(&path, tower());
    write(&path, tower());
    fs::write(&path, &bytes[..bytes.len() - 1]).expect("writable");
    let output = place.path().join("picture.png");
    let ended = end(grotto()
        .arg("render")
        .arg(&path)
        .args(["--cpu", "--spp", "1", "--size", "8x8", "-o"])
        .arg(output));
    assert!(
        ended.code == 0 && ended.stderr.contains("Its backup was opened"),
        "{}",
        ended.stderr
    );
}

#[test]
fn an_export_is_a_model_that_grotto_reads() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("tower.grotto");
    write(&path, tower());
    let model = place.path().join("tower.vox");
    let ended = end(grotto()
        .arg("export")
        .arg(&path)
        .arg("-o")
        .arg(&model)
        .arg("--json"));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let world = "(title: \"A model.\", size: (64, 34, 64), origin: (0, 0, 0), shape: Empty, \
                 models: [(file: \"tower.vox\", at: (0, 0, 0))], \
                 cameras: [(name: \"c\", position: (0, 0, 0), look_at: (1, 1, 1))])";
    let world_file = place.path().join("model.ron");
    fs::write(&world_file, world).expect("writable");
    let voxels = |path: &Path| {
        let world = file::load(path, &Overrides::default()).expect("it loads");
        grotto::world::generate::generate(&world)
    };
    let (saved, read) = (voxels(&path), voxels(&world_file));
    let mut count = 0;
    for z in 0..64 {
        for y in 0..32 {
            for x in 0..64 {
                let at = IVec3::new(x, y, z);
                assert_eq!(saved.material(at) == 0, read.material(at) == 0, "{at}");
                count += u64::from(saved.material(at) != 0);
            }
        }
    }
    assert_eq!(ended.json()["voxels"], count);
    refused(
        grotto().arg("export").arg(&path).args(["-o", "a.obj"]),
        2,
        &[".vox"],
    );
}

/// Tells the program below where to write.
const WRITER: &str = "GROTTO_TEST_WRITER";
/// How often the writer is killed; some dozens unless this says otherwise.
const KILLS: &str = "GROTTO_TEST_KILLS";

/// The number of a save is its world time.
fn numbered(path: &Path, number: u32) -> Save {
    let mut overlay = tower();
    for index in 0..20_000 {
        let mixed = 2_654_435_761u32.wrapping_mul(index).wrapping_add(number);
        overlay.set(
            UVec3::new(mixed >> 8 & 63, mixed >> 16 & 31, mixed >> 24 & 63),
            1,
        );
    }
    let mut save = save_of(path, overlay);
    save.state.time_s = f64::from(number);
    save
}

/// A program that saves without end, when it is started as one.
#[test]
fn writes_for_ever_where_it_is_told_to() {
    let Some(path) = env::var_os(WRITER).map(PathBuf::from) else {
        return;
    };
    let first = save::read(&path).map_or(0, |save| save.state.time_s as u32);
    for number in first + 1.. {
        save::write(&path, &numbered(&path, number)).expect("writable");
    }
}

#[test]
fn a_killed_writer_leaves_the_old_save_or_the_new_one() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("cave.grotto");
    let kills = env::var(KILLS).ok().and_then(|text| text.parse().ok());
    let kills: u32 = kills.unwrap_or(24);
    let number = |path: &Path| save::read(path).map(|save| save.state.time_s as u32);
    write(&path, tower());
    let mut last = number(&path).expect("whole");
    let mut moved = 0;
    for kill in 0..kills {
        let mut writer = Command::new(env::current_exe().expect("this program"))
            .args(["--exact", "saves::writes_for_ever_where_it_is_told_to"])
            .env(WRITER, &path)
            .stdout(Stdio::null())
            .spawn()
            .expect("it starts");
        // It writes after its first save; then any moment will do.
        let start = Instant::now();
        let modified = || fs::metadata(&path).and_then(|known| known.modified()).ok();
        let before = modified();
        while modified() == before && start.elapsed() < Duration::from_secs(20) {
            thread::sleep(Duration::from_millis(1));
        }
        thread::sleep(Duration::from_micros(u64::from(kill * 7919 % 20_011)));
        writer.kill().expect("it runs");
        writer.wait().expect("it ended");
        let now = number(&path).expect("the save is whole");
        let backup = number(&save::backup_of(&path)).expect("the backup is whole");
        assert!(
            now >= last && (backup == now || backup + 1 == now),
            "{last} {backup} {now}"
        );
        moved += u32::from(now > last);
        last = now;
    }
    assert!(moved > kills / 2, "{moved} of {kills} saw a new save");
}
