//! Single mistakes in a valid world.

use super::{FULL, read, refused, with};

/// Each of these edits is refused at its place, with a message that names the mistake and the remedy.
#[test]
fn mistakes_are_shown_at_their_place() {
    // Text to replace, its replacement, the offending text, part of the message, part of the remedy.
    #[rustfmt::skip] // One line per case.
    let cases: &[[&str; 5]] = &[
        ["title:", "titl:", "titl", "not a key", "did you mean `title`"],
        ["origin:", "wibble:", "wibble", "not a key", "`origin`"],
        ["basis: Value", "basys: Value", "basys", "not a key", "did you mean `basis`"],
        ["basis: Value", "basis: Valu", "Valu", "not known", "did you mean `Value`"],
        ["Sphere(radius: 5)", "Spere(radius: 5)", "Spere", "not known", "did you mean `Sphere`"],
        ["Sphere(radius: 5)", "Sphere(radios: 5)", "radios", "not a key", "did you mean `radius`"],
        ["Sphere(radius: 5)", "Sphere()", ")", "`radius`", "add `radius: …`"],
        ["Sphere(radius: 5)", "Sphere(radius: -5)", "-5", "above 0", "above 0"],
        ["Sphere(radius: 5)", "Sphere(radius: 0)", "0", "above 0", "above 0"],
        ["Sphere(radius: 5)", "Sphere(radius: NaN)", "NaN", "not a finite", "finite"],
        ["Sphere(radius: 5)", "Sphere(radius: inf)", "inf", "not a finite", "finite"],
        ["Sphere(radius: 5)", "Sphere(radius: 1e99)", "1e99", "not a finite", "finite"],
        ["Sphere(radius: 5)", "Sphere(radius: \"5\")", "\"5\"", "must be a number", "without quotes"],
        ["Sphere(radius: 5)", "Sphere(radius: (1, 2))", "(1, 2)", "must be a number", "number"],
        ["Sphere(radius: 5)", "Sphere(5)", "5", "", "key: value"],
        ["by: 2,", "by: 0,", "0", "above 0", "above 0"],
        ["by: 2,", "by: -1,", "-1", "above 0", "above 0"],
        ["(64, 48, 64)", "(64, 0, 64)", "0", "between 1 and 4096", "whole number"],
        ["(64, 48, 64)", "(64, 48, 5000)", "5000", "between 1 and 4096", "whole number"],
        ["(64, 48, 64)", "(64, 4.5, 64)", "4.5", "whole number", "whole number"],
        ["(64, 48, 64)", "(4096, 4096, 4096)", "4096, 4096, 4096", "cannot be built", "4294967296"],
        ["(64, 48, 64)", "(64, 48)", "", "", "three numbers"],
        ["(64, 48, 64)", "[64, 48, 64]", "[", "", "(x, y, z)"],
        ["(64, 48, 64)", "64", "64", "", "(x, y, z)"],
        ["seed: 7", "seed: -7", "-7", "between 0", "whole number"],
        ["voxel_m: 0.5", "voxel_m: 0", "0", "between", "number"],
        ["title: \"Everything at once.\"", "title: 5", "5", "must be a text", "quotes"],
        ["octaves: 3, lacunarity", "octaves: 99, lacunarity", "99", "between 1 and 24", "whole"],
        ["frequency: 0.05", "frequency: (1, 2)", "", "(x, y, z)", "README"],
        ["frequency: 0.05", "frequency: \"high\"", "\"high\"", "must be a number", "number"],
        ["frequency: 0.05", "frequency: 1e18", "1e18", "between -1000 and 1000", "between -1000"],
        ["frequency: (0.1, 0.05, 0.1)", "frequency: (0.1, -1e30, 0.1)", "-1e30", "between", "between -1000"],
        ["by: 2,", "by: 1e-40,", "1e-40", "between 0.0001", "between 0.0001"],
        ["by: 2,", "by: 1e30,", "1e30", "between 0.0001", "and 10000"],
        ["scale: (0.5, 1.2)", "scale: (1e-40, 1.2)", "1e-40", "between 0.0001", "between 0.0001"],
        ["\"ridges\":", "\"floor\":", "\"floor\"", "two noises called `floor`", "rename"],
        ["\"dots\":", "\"rock\":", "\"rock\"", "two materials called `rock`", "rename"],
        ["HeightField(noise: \"floor\"", "HeightField(noise: \"flor\"", "\"flor\"", "no noise", "did you mean `floor`"],
        ["(material: \"moss\",", "(material: \"mos\",", "\"mos\"", "no material", "did you mean `moss`"],
        ["At(kind: \"tiny\"", "At(kind: \"tinny\"", "\"tinny\"", "no kind", "did you mean `tiny`"],
        ["Flat(1, 0.2, 0)", "Flat(1, 1.2, 0)", "1.2", "between 0 and 1", "between"],
        ["Flat(1, 0.2, 0)", "Flat(1, 0.2)", "", "", "three"],
        ["emission: (4, 1, 0.1)", "emission: (4, -1, 0.1)", "-1", "negative", "at least 0"],
        ["(4, (0.2, 0.2, 0.7))", "(-9, (0.2, 0.2, 0.7))", "-9", "ends at -9", "lowest to the highest"],
        ["DitherX(from: -1", "DitherX(from: 8", "6", "from 8 to 6", "less than"],
        ["squares: 2", "squares: 0", "0", "squares is 0", "between 1 and 64"],
        ["reach: 4", "reach: 11", "11", "more than the cell", "make the cell larger"],
        ["period: (16, 0, 16)", "period: (1, 0, 16)", "1, 0, 16", "sub-tree spans", "make the period larger"],
        ["scale: (0.5, 1.2)", "scale: (1.5, 1.2)", "1.2", "from 1.5 down to 1.2", "smaller factor first"],
        ["without_corners: true", "without_corners: 1", "1", "true or false", "true"],
        ["min: (0, -3, 0)", "min: (0, 3, 0)", "0, 0, 0", "empty", "at most"],
        ["density: 4,", "density: 4, count: 3,", "3", "both", "one of the two"],
        ["density: 4,", "", "\"tiny\"", "how many", "count"],
        ["density: 4,", "density: 1e9,", "1e9", "in this box", "lower the density"],
        ["on: Ceiling", "on: Wall", "Wall", "not known", "`Floor`"],
        ["(lamp: (power: 20)", "(lamp: (power: 20, motion: [Path(points: [], speed: 1)])", "20", "Path", "Orbit"],
        ["(kind: Spot(direction: (0, -1, 0)", "(kind: Spot(direction: (0, 0, 0)", "0, 0, 0", "no direction", "longer"],
        ["inner_deg: 20", "inner_deg: 40", "40", "more than the `outer_deg`", "swap"],
        ["outer_deg: 30", "outer_deg: 300", "300", "between", "between"],
        ["soft_radius: 1.5", "soft_radius: -1.5", "-1.5", "between 0 and 64", "between"],
        ["soft_radius: 1.5", "soft_radius: 65", "65", "between 0 and 64", "between"],
        ["soft_radius: 1.5", "soft_radius: NaN", "NaN", "not a finite", "finite"],
        ["soft_radius: 1.5", "soft_radius: \"big\"", "\"big\"", "must be a number", "without quotes"],
        ["power: 1,\n", "power: 1, soft_radius: 2,\n", "2", "directional lamp", "remove"],
        ["power: 50,", "power: -50,", "-50", "negative", "at least 0"],
        ["position: (0, 8, 0),", "", "50", "no `position`", "add `position"],
        ["name: \"many\"", "name: \"one\"", "\"one\"", "two lamp presets", "rename"],
        ["points: [(0, 0, 0), (4, 0, 0)]", "points: [(0, 0, 0)]", "2", "1 points", "at least 2"],
        ["towards: (0.3, 1, 0.2)", "towards: (0, 0, 0)", "0, 0, 0", "no direction", "longer"],
        ["height: 3.5", "height: 0", "0", "between 0.1 and 100", "between"],
        ["height: 3.5", "height: 1e4", "1e4", "between 0.1 and 100", "between"],
        ["height: 3.5", "heigt: 3.5", "heigt", "not a key", "did you mean `height`"],
        ["fov_deg: 75", "fov_deg: 0", "0", "between 1 and 170", "between"],
        ["fov_deg: 75", "fov_deg: 171", "171", "between 1 and 170", "between"],
        ["look_at: (0, 0, 0)", "look_at: (0, 2, 20)", "0, 2, 20", "where it stands", "middle"],
        ["yaw_deg: 180", "yaw_deg: 180, look_at: (0, 0, 0)", "180", "both", "keep"],
        ["name: \"back\"", "name: \"entrance\"", "\"entrance\"", "two cameras", "rename"],
        ["name: \"fine\"", "name: \"\"", "\"\"", "empty", "called"],
        ["counts: (5, 4, 5)", "counts: (5, 0, 5)", "0", "between 1", "whole"],
        ["counts: (5, 4, 5)", "counts: (500, 400, 500)", "500, 400, 500", "100000000 probes", "widen"],
        ["spacing: 12", "spacing: 0", "0", "between 0.25", "between 0.25"],
        ["spacing: 12", "spacing: 1e30", "1e30", "between 0.25", "1048576"],
        ["spacing: 12", "spacing: 1000000", "5, 4, 5", "reaches", "1048576"],
        ["cascades: 3", "cascades: 7", "7", "between 1 and 6", "whole"],
        ["cascades: 3", "cascades: 0", "0", "between 1 and 6", "whole"],
        ["counts: (8, 6, 8)", "counts: (8, 3, 8)", "8, 3, 8", "too thin", "at least 4"],
        ["counts: (8, 6, 8)", "counts: (256, 256, 8)", "256, 256, 8", "1572864 probes", "widen"],
        ["spacing: 12", "spacing: 12, colour: 3", "colour", "not a key", "counts"],
        ["seed: 7,", "seed: 7, seed: 8,", "seed", "twice", "remove"],
        ["models: []", "models: [(file: \"a.vox\", at: (0, 0, 0))]", "\"a.vox\"", "no models", "save"],
        ["lamp: \"key\"", "lamp: \"kay\"", "\"kay\"", "no lamp", "did you mean `key`"],
        ["lamp: \"key\"", "lamp: \"rays\"", "1, 2, 3", "no lamp to move", "point or spot"],
        ["lamp_to: (1, 2, 3)", "lamp_to: (1, 2)", "", "", "three numbers"],
        ["max: (4, 6, 2)", "max: (-5, 6, 2)", "-5, 6, 2", "empty", "at most"],
        ["max: (4, 6, 2)", "max: (4, 6.5, 2)", "6.5", "whole number", "whole number"],
        ["max: (4, 6, 2)", "max: (400, 600, 200)", "400, 600, 200", "48437595 voxels", "1048576"],
        ["min: (-4, 0, 2)", "min: (-4, 0, 2000)", "4, 6, 2", "empty", "at most"],
        ["(min: (-4, 0, 2), max: (4, 6, 2), material: \"moss\")", "(min: (-4, 90, 2), max: (4, 96, 2), material: \"moss\")", "-4, 90, 2", "outside", "world space"],
        ["(4, 6, 2), material: \"moss\"", "(4, 6, 2), material: \"mos\"", "\"mos\"", "no material", "did you mean `moss`"],
        ["(4, 6, 2), material: \"moss\"", "(4, 6, 2), stuff: \"moss\"", "stuff", "not a key", "`material`"],
        ["size: (5, 7, 1)", "size: (5, 0, 1)", "0", "between 1 and 64", "whole number"],
        ["size: (5, 7, 1)", "size: (5, 65, 1)", "65", "between 1 and 64", "whole number"],
        ["size: (5, 7, 1)", "size: (5, 7.5, 1)", "7.5", "whole number", "whole number"],
        ["size: (5, 7, 1), shape: Box(half: (3, 4, 1))", "size: (5, 7, 1), shape: Empty", "5, 7, 1", "no voxels", "larger"],
        ["Sphere(radius: 3.5)", "Sphere(radius: -3.5)", "-3.5", "above 0", "above 0"],
        ["Sphere(radius: 3.5)", "Repeat(period: (1, 0, 0), of: Sphere(radius: 3.5))", "1, 0, 0", "sub-tree spans", "make the period larger"],
        ["material: \"bricks\"),", "material: \"brics\"),", "\"brics\"", "no material", "did you mean `bricks`"],
        ["position: (0.5, 3.5, 13)", "position: (0.5, NaN, 13)", "NaN", "not a finite", "finite"],
        ["position: (0.5, 3.5, 13)", "position: (0.5, 1e9, 13)", "1e9", "between", "between"],
        ["degrees: (0, 30, 0)", "degrees: (0, inf, 0)", "inf", "not a finite", "finite"],
        ["name: \"stone\"", "name: \"leaf\"", "\"leaf\"", "two bodies called `leaf`", "rename"],
        ["name: \"stone\"", "name: \"\"", "\"\"", "empty", "called"],
        ["Like(body: \"stone\")", "Like(body: \"stome\")", "\"stome\"", "no body further up", "did you mean `stone`"],
        ["Like(body: \"stone\")", "Like(body: \"second stone\")", "\"second stone\"", "no body further up", "`stone`"],
        ["Like(body: \"stone\")", "Vox(file: \"stone.vox\")", "\"stone.vox\"", "no models", "save"],
        ["Like(body: \"stone\")", "Ball(radius: 2)", "Ball", "not known", "`Shape`"],
        ["axis: (0, 1, 0)", "axis: (0, 0, 0)", "0, 0, 0", "no direction", "longer"],
        ["axis: (1, 0.5, 0)", "axis: (0, 0, 0)", "0, 0, 0", "no direction", "longer"],
        ["degrees: -100", "degrees: NaN", "NaN", "not a finite", "finite"],
        ["degrees: -100", "degrees: 1e9", "1e9", "between", "between"],
        ["rate: 0.7", "rate: 1e9", "1e9", "between", "between"],
        ["period_s: 11", "period_s: 0", "0", "between 0.01 and 86400", "between"],
        ["rest_s: 2.5", "rest_s: 5.5", "5.5", "no time to move", "less than half"],
        ["rest_s: 2.5", "rest_s: -2.5", "-2.5", "negative", "at least 0"],
        ["end_s: 5.8", "end_s: 3.3", "3.3", "from 3.3 s to 3.3 s", "less than"],
        ["ease: Linear", "ease: Fast", "Fast", "not known", "`Smooth`"],
        ["points: [(-8, 9, 10), (-8, 9, 2)]", "points: []", "1.5", "0 points", "at least 2"],
        ["phase_s: 1)", "phase: 1)", "phase", "not a key", "did you mean `phase_s`"],
        ["models: [],", "models: []", "", "comma", "`,`"],
    ];
    let mut failures = Vec::new();
    for [old, new, offending, message, remedy] in cases {
        let before = &FULL[..FULL.find(old).expect("it is in the file")];
        let line = 1 + before.matches('\n').count();
        let problem = refused(read(&with(old, new)));
        let (found_line, _) = problem.line_and_column().expect("it has a place");
        // Of two equal names the second is at fault. A missing key is shown at the end of the value that
        // should hold it.
        let lines = match (*remedy, offending.is_empty() || new.is_empty()) {
            ("rename", _) => line - 1..=line + 40,
            (_, true) => line..=line + 1,
            (_, false) => line..=line,
        };
        let text_fits = offending.is_empty() || problem.offending_text() == Some(offending);
        let fits = text_fits
            && lines.contains(&found_line)
            && problem.to_string().contains(message)
            && problem.remedy().contains(remedy);
        if !fits {
            let found = problem.offending_text();
            let help = problem.remedy();
            failures.push(format!(
                "{new}: {problem} at {found_line}, not {line}, {found:?}; {help}"
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn texts_that_are_no_worlds_are_refused() {
    let nested = |levels| {
        let (open, close) = ("Not(".repeat(levels), ")".repeat(levels));
        with("Inside(Sphere(radius: 5))", &format!("{open}Always{close}"))
    };
    let shapes = format!(
        "(title: \"\", size: (8, 8, 8), shape: {}Empty{})",
        "Translate(by: (0, 0, 0), of: ".repeat(60),
        ")".repeat(60)
    );
    assert!(read(&nested(60)).is_ok());
    assert!(read(&shapes).is_ok());
    for (text, message) in [
        (nested(64), "more than 64 deep"),
        (nested(100_000), "more than 64 deep"),
        ("(".repeat(1_000_000), "more than 64 deep"),
        ("[[[".to_owned(), "expected"),
        ("hello".to_owned(), "expected"),
        ("{\"a\": 1}".to_owned(), "expected"),
        (format!("{FULL} and more"), "after the end"),
        (FULL[..FULL.len() / 2].to_owned(), ""),
        ("(title: \"never closed".to_owned(), ""),
        ("/* never closed".to_owned(), ""),
        ("()".to_owned(), "`title` of World is missing"),
        ("#![enable(wibble)] ()".to_owned(), ""),
    ] {
        let problem = refused(read(&text));
        assert!(
            problem.to_string().contains(message),
            "{problem} lacks {message}"
        );
        assert!(problem.line_and_column().is_some(), "{problem}");
    }
}

#[test]
fn too_much_of_anything_is_refused() {
    let materials: String = (0..256)
        .map(|index| format!("\"m{index}\": (a: Flat(0, 0, 0)),\n"))
        .collect();
    let cameras: String = (0..1025)
        .map(|index| format!("(name: \"c{index}\", position: (0, 0, 0)),\n"))
        .collect();
    let lamps = "(position: (0, 0, 0), power: 1),".repeat(65_537);
    let bodies = "(model: Like(body: \"first\"), position: (0, 0, 0)),".repeat(4096);
    let bodies = format!(
        "bodies: [(name: \"first\", model: Shape(size: (1, 1, 1), shape: Sphere(radius: 1)), position: (0, 0, 0)),\n{bodies}]"
    );
    let large =
        "(model: Shape(size: (64, 64, 64), shape: Sphere(radius: 1)), position: (0, 0, 0)),\n";
    let large = format!("bodies: [\n{}]", large.repeat(65));
    let places = "(0, 0, 0),".repeat(50_001);
    let parts = "(min: (0, 0, 0), max: (0, 0, 0), material: \"rock\"),".repeat(40);
    let places = format!(
        "features: (kinds: {{\"a\": [{parts}]}}, place: [\nAt(kind: \"a\", places: [{places}])])"
    );
    for (more, line, message) in [
        (
            format!("materials: {{\n{materials}}}"),
            3 + 255,
            "more than 255",
        ),
        (
            format!("cameras: [\n{cameras}]"),
            3 + 1024,
            "more than 1024 cameras",
        ),
        (
            format!("lamps: [\n(name: \"a\", lamps: [{lamps}])]"),
            3,
            "65537 lamps",
        ),
        (places, 3, "2000040 boxes"),
        (bodies, 3, "4097 bodies"),
        (large, 3 + 64, "more than 16777216 voxels"),
    ] {
        let problem = refused(read(&format!(
            "(title: \"\", size: (32, 32, 32), shape: Sphere(radius: 9),\n{more})"
        )));
        assert!(
            problem.to_string().contains(message),
            "{problem} lacks {message}"
        );
        assert_eq!(problem.line_and_column().map(|place| place.0), Some(line));
    }
}

#[test]
fn a_long_line_is_not_shown_but_its_place_is() {
    let title = "x".repeat(100_000);
    let text = format!("(title: \"{title}\", size: (8, 8, 8), shape: Emty)");
    let report = read(&text).expect_err("refused");
    let rendered = format!("{report:?}");
    assert!(rendered.len() < 2000, "{} bytes", rendered.len());
    assert!(rendered.contains("test.ron:1:100037"), "{rendered}");
}

#[test]
fn features_that_crowd_the_cells_are_refused() {
    let places = "(0, 0, 0), ".repeat(200);
    let text = format!(
        "(title: \"t\", size: (512, 512, 512), shape: Plane(normal: (0, 1, 0), offset: 0),
          materials: {{ \"stone\": (a: Flat(1, 1, 1)) }},
          features: (
            kinds: {{ \"all\": [(min: (0, 0, 0), max: (511, 511, 511), material: \"stone\")] }},
            place: [At(kind: \"all\", places: [{places}])],
          ))"
    );
    let problem = refused(read(&text));
    assert!(problem.to_string().contains("overlap"), "{problem}");
}

/// Escape sequences in a file never reach the terminal: a valid world has none, and messages about an invalid one
/// write them out.
#[test]
fn escape_sequences_are_refused_and_written_out() {
    let sequences = ["\u{1b}[31m", "\u{9b}31m", "\u{202e}", "\u{7}"];
    for sequence in sequences {
        let escaped: String = sequence.chars().flat_map(char::escape_unicode).collect();
        for (old, new) in [
            ("Everything at once.", format!("Everything {sequence}")),
            ("Everything at once.", format!("Everything {escaped}")),
            ("name: \"entrance\"", format!("name: \"{escaped}\"")),
            ("name: \"fine\"", format!("name: \"{sequence}\"")),
            ("name: \"many\"", format!("name: \"{sequence}\"")),
            (
                "HeightField(noise: \"floor\"",
                format!("HeightField(noise: \"{sequence}\""),
            ),
            ("titl", format!("{sequence}titl")),
            ("octaves: 4,", format!("octaves: {sequence},")),
            ("octaves: 4,", format!("/*{sequence}*/ octaves: 99,")),
        ] {
            let report = read(&with(old, &new)).expect_err("must be refused");
            let rendered = format!("{report:?}{report}");
            let obeyed = |c: &char| c.is_control() && *c != '\n' || *c == '\u{202e}';
            // The report's own colours, if any, do not come from the file.
            let found: Vec<char> = rendered.chars().filter(obeyed).collect();
            assert!(found.is_empty(), "{new:?}: {found:?} {rendered}");
        }
    }
    let folded = read(&with("Everything at once.", "Two\nlines.")).expect("sound");
    assert_eq!(folded.title, "Two lines.");
}
