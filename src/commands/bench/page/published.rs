//! Measurements of the source documents, by the numbers of their tables.

/// A curve that others published.
pub struct Published {
    /// Author, document and hardware.
    pub source: &'static str,
    pub points: &'static [(f64, f64)],
}

/// What a plot shows next to our rows.
pub struct Comparison {
    pub title: &'static str,
    /// Unit of our rows and of the published values.
    pub unit: Unit,
    pub x_name: &'static str,
    pub published: &'static [Published],
    /// The rows of ours to show: suite, world, and condition (empty: the first that there is).
    pub suite: &'static str,
    pub world: &'static str,
    pub condition: &'static str,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    Fps,
    Ms,
}

const PUBLISHED: &str = "published (Minecraft; GPU not named)";
const THEIRS_HERE: &str = "their shaders on an H200, 400 rays, measured for us";

pub const COMPARISONS: [Comparison; 5] = [
    Comparison {
        title: "Cave: frames per second by layout",
        unit: Unit::Fps,
        x_name: "layout",
        published: &[
            Published {
                source: PUBLISHED,
                points: &[(1.0, 140.0), (2.0, 63.0), (3.0, 34.0), (4.0, 20.0)],
            },
            Published {
                source: THEIRS_HERE,
                points: &[(1.0, 300.0), (2.0, 177.0), (3.0, 122.0), (4.0, 70.0)],
            },
        ],
        suite: "layouts",
        world: "cave",
        condition: "moving",
    },
    Comparison {
        title: "Cornell box: frames per second by layout",
        unit: Unit::Fps,
        x_name: "layout",
        published: &[
            Published {
                source: PUBLISHED,
                points: &[(1.0, 1100.0), (2.0, 850.0), (3.0, 400.0), (4.0, 180.0)],
            },
            Published {
                source: THEIRS_HERE,
                points: &[(1.0, 869.0), (2.0, 815.0), (3.0, 644.0), (4.0, 422.0)],
            },
        ],
        suite: "layouts",
        world: "cornell",
        condition: "moving",
    },
    Comparison {
        title: "Cave: frames per second by rays per probe",
        unit: Unit::Fps,
        x_name: "rays per probe",
        // The counts in between appear only in a picture; `FIGURES` lists all five rates.
        published: &[Published {
            source: PUBLISHED,
            points: &[(144.0, 126.0), (2025.0, 18.0)],
        }],
        suite: "rays",
        world: "cave",
        condition: "",
    },
    Comparison {
        title: "Cave: frames per second by lamps",
        unit: Unit::Fps,
        x_name: "lamps",
        published: &[Published {
            source: PUBLISHED,
            points: &[(1.0, 60.0), (2.0, 41.0), (3.0, 31.0), (4.0, 29.0)],
        }],
        suite: "lights",
        world: "cave",
        condition: "",
    },
    Comparison {
        title: "Milliseconds of a frame by rays per probe",
        unit: Unit::Ms,
        x_name: "rays per probe",
        published: &[Published {
            source: "Fibix, Table 4.6: 11×10×15 probes, 1080p, their scene",
            points: &[
                (8.0, 1.14),
                (16.0, 1.44),
                (32.0, 2.13),
                (64.0, 3.36),
                (128.0, 5.94),
                (256.0, 11.01),
            ],
        }],
        suite: "rays",
        world: "cave",
        condition: "",
    },
];

/// Figures of their tables without a curve of ours next to them: place, quantity, values.
pub const FIGURES: [[&str; 3]; 10] = [
    [
        "Minecraft, chart of rays",
        "FPS at five ray counts from 144 to 2025 a probe",
        "126 · 60 · 35 · 25 · 18",
    ],
    [
        "Minecraft, textures",
        "FPS flat against textured",
        "75 · 60",
    ],
    [
        "Minecraft's shaders on an H200",
        "ms of probe + camera pass, cave layouts 1–4, 1920×1080, 400 rays",
        "2.05 + 1.27 · 4.37 + 1.27 · 6.91 + 1.27 · 12.91 + 1.27",
    ],
    [
        "Fibix, Table 4.7",
        "ms at distance maps of 2, 16, 32, 64 texels",
        "3.14 · 3.35 · 4.17 · 7.00",
    ],
    [
        "G3D, Tables 7.3 and 7.5 (RTX 3080)",
        "Mrays/s of the whole update by grid, without and with culling",
        "16³: 55–297, 59–327 · 32×16×32: 201–487, 213–596 · 32³: 312–537, 343–706",
    ],
    [
        "G3D, Tables 7.4 and 7.6",
        "ms at 32×16×32 probes of 64 and 512 rays: cast, shade, update, mark inactive",
        "cast 2.245, 4.357 · shade 0.23 + 0.21, 2.2 + 2.6 · update 0.057 + 0.056, 1.86 + 2.10 · mark 0.044, 0.226",
    ],
    [
        "G3D, Table 7.7",
        "ms of the atlas update without and with culling",
        "2048 probes: 0.13, 0.12 · 32768 probes: 1.21, 0.84",
    ],
    [
        "G3D, Table 7.8",
        "ms of the occlusion field at 32×16×32 probes of 16×16 texels: making rays, cast, ray occlusion, update",
        "0.06 + 0.07 · 2.58 · 0.11 · 0.5",
    ],
    [
        "G3D, Table 7.9",
        "probes alive, sleeping, dead: box, 16³",
        "2636 · 480 · 980",
    ],
    [
        "Fibix, Table 4.6",
        "ms of tracing alone at 256 rays a probe, of 11.01 in all",
        "9.56",
    ],
];
