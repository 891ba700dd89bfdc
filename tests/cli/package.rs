//! The archive of `scripts/package`, and the binary alone in a foreign folder.

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Command, Output},
};

use crate::{
    folder, listing, root,
    support::binary::{end, grotto, text},
};

fn script(arguments: &[&str]) -> Output {
    let mut command = Command::new(root().join("scripts/package"));
    command.args(arguments).output().expect("bash is there")
}

fn stdout(mut command: Command) -> String {
    let output = command.output().expect("it starts");
    assert!(
        output.status.success(),
        "{command:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// What must be in the archive, found without the script.
fn wanted() -> BTreeSet<String> {
    let mut wanted: BTreeSet<String> = [
        "bin/grotto",
        "share/applications/grotto.desktop",
        "share/icons/hicolor/256x256/apps/grotto.png",
        "share/doc/grotto/README.md",
        "share/doc/grotto/LICENSE-APACHE",
        "share/doc/grotto/LICENSE-MIT",
        "share/doc/grotto/THIRD-PARTY.txt",
    ]
    .map(str::to_owned)
    .into();
    for path in listing(&root().join("worlds")) {
        let name = path.file_name().expect("a name").to_string_lossy();
        wanted.insert(format!("share/grotto/worlds/{name}"));
    }
    wanted
}

#[test]
fn the_archive_holds_everything_and_its_checksum_is_right() {
    let listed = script(&["--list"]);
    let listed: BTreeSet<String> = text(&listed.stdout).lines().map(str::to_owned).collect();
    assert_eq!(listed, wanted());

    let folder = folder();
    // A stand-in: the debug binary takes minutes to pack.
    let binary = folder.path().join("stand-in");
    fs::write(&binary, "a binary").expect("writable");
    let out = folder.path().join("out");
    let paths = [&binary, &out].map(|path| path.to_str().expect("UTF-8").to_owned());
    let packed = script(&["--binary", &paths[0], "--out", &paths[1]]);
    assert!(packed.status.success(), "{}", text(&packed.stderr));
    let archive = text(&packed.stdout).trim().to_owned();
    let name = Path::new(&archive).file_name().expect("a name");
    let top = name.to_str().and_then(|name| name.strip_suffix(".tar.gz"));
    let top = top.expect("a tar.gz").to_owned();
    assert!(top.contains(env!("CARGO_PKG_VERSION")), "{top}");

    let mut sum = Command::new("sha256sum");
    sum.current_dir(&out)
        .arg("--check")
        .arg(format!("{top}.tar.gz.sha256"));
    assert!(stdout(sum).contains("OK"));
    let mut unpack = Command::new("tar");
    unpack.args(["-xvzf", &archive, "-C", &paths[1]]);
    let unpacked: BTreeSet<String> = stdout(unpack)
        .lines()
        .filter(|line| !line.ends_with('/'))
        .filter_map(|line| line.strip_prefix(&format!("{top}/")))
        .map(str::to_owned)
        .collect();
    assert_eq!(unpacked, listed);
    let prefix = out.join(&top);
    assert_eq!(
        fs::read(prefix.join("bin/grotto")).expect("it is there"),
        b"a binary"
    );
    let world = |folder: &Path| fs::read(folder.join("worlds/cave.ron")).expect("it is there");
    assert_eq!(world(&prefix.join("share/grotto")), world(root()));
    let licences = prefix.join("share/doc/grotto/THIRD-PARTY.txt");
    let licences = fs::read_to_string(licences).expect("text");
    for part in ["wgpu v30", "Permission is hereby granted", "Apache License"] {
        assert!(licences.contains(part), "{part}");
    }
}

#[test]
fn the_script_refuses_what_it_does_not_know() {
    for arguments in [&["--binary", "/nowhere/grotto"][..], &["--everything"]] {
        let refused = script(arguments);
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(text(&refused.stderr).contains("scripts/package"));
    }
}

#[test]
fn the_binary_alone_knows_its_worlds_by_name() {
    let folder = folder();
    let home = folder.path().join("home");
    let foreign = folder.path().join("empty");
    fs::create_dir(&foreign).expect("writable");
    let alone = |arguments: &[&str]| {
        let mut command = grotto();
        command
            .current_dir(&foreign)
            .args(arguments)
            .env("HOME", &home);
        for variable in ["XDG_DATA_HOME", "XDG_CACHE_HOME"] {
            command.env_remove(variable);
        }
        end(&mut command)
    };
    for name in ["cave", "furnace.ron", "worlds/minimal.ron"] {
        let checked = alone(&["check", name]);
        assert_eq!(checked.code, 0, "{name}: {}", checked.stderr);
    }
    let size = ["--size", "16x9", "--quiet"];
    let drawn = alone(
        &[
            &["render", "furnace.ron", "-o", "a.png", "--cpu"][..],
            &size,
        ]
        .concat(),
    );
    assert_eq!(drawn.code, 0, "{}", drawn.stderr);
    assert!(foreign.join("a.png").is_file());
    let missing = alone(&["check", "nothing.ron"]);
    assert_eq!(missing.code, 2);
    assert!(missing.stderr.contains("nothing.ron"), "{}", missing.stderr);
    assert_eq!(
        listing(&foreign),
        [foreign.join("a.png")],
        "nothing else is left there"
    );
}
