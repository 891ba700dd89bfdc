//! What was measured, where and when; warnings; and the worlds.

use super::{
    super::model::{Adapter, Build, GpuState, Machine, Report, WorldRecord},
    html::{facts, paragraph, plots, warning},
    names::distinct,
};
use crate::measure::plot::escaped;

pub fn heading(report: &Report) -> String {
    let mut text = format!("<h1>grotto bench {}</h1>\n", escaped(&report.suite));
    for words in warnings(report) {
        text += &warning(&words);
    }
    let adapters = distinct(report.rows.iter().map(|row| &row.adapter));
    let mut general: Vec<(&str, String)> = adapters
        .into_iter()
        .map(|adapter| ("Adapter", adapter_words(adapter)))
        .collect();
    let seeds = distinct(report.rows.iter().map(|row| row.seed));
    let seeds: Vec<String> = seeds.iter().map(u32::to_string).collect();
    general.push(("Seed of the rays", seeds.join(", ")));
    if report.parts.is_empty() {
        general.extend(origin(
            &report.machine,
            &report.build,
            &report.started,
            report.elapsed_s,
            &report.command,
        ));
    }
    text += &facts(&general);
    if !report.parts.is_empty() {
        text += &paragraph(
            "Results of several cards or machines: the names of rows end with `@` and one of these labels.",
        );
    }
    for part in &report.parts {
        text += &format!("<h3>{}</h3>\n", escaped(&part.label));
        text += &facts(&origin(
            &part.machine,
            &part.build,
            &part.started,
            part.elapsed_s,
            &part.command,
        ));
    }
    text + &worlds(report)
}

pub fn adapter_words(adapter: &Adapter) -> String {
    let Adapter {
        name,
        kind,
        driver,
        backend,
    } = adapter;
    format!("{name} ({kind}, {backend}, {driver})")
}

/// Warnings that a reader must know before the figures.
fn warnings(report: &Report) -> Vec<String> {
    let mut all = Vec::new();
    if !report.complete {
        all.push(
            "Partial: the run is in progress, or was stopped before all rows were measured."
                .to_owned(),
        );
    }
    if report.quick {
        all.push("Measured with --quick: fewer rows, shorter runs.".to_owned());
    }
    if !report.shard.is_whole() {
        all.push(format!(
            "Part {} of a run: `grotto merge` joins them.",
            report.shard
        ));
    }
    if report.build.profile != "release" {
        all.push(format!(
            "Measured with a {} build: CPU times are not those of a release.",
            report.build.profile
        ));
    }
    let software = report.rows.iter().filter(|row| row.is_software()).count();
    if software > 0 {
        all.push(format!(
            "{software} of {} rows ran on a software adapter. They have tables and plots of their own.",
            report.rows.len()
        ));
    }
    let noisy = report.rows.iter().filter(|row| row.is_noisy()).count();
    if noisy > 0 {
        all.push(format!(
            "{noisy} rows are noisy (marked ~): after the largest number of runs, the 95 % interval of the median \
             is still wider than ±1 %."
        ));
    }
    if !report.missing.is_empty() {
        all.push(format!(
            "Rows that are missing: {}. The end of the page says why.",
            report.missing.len()
        ));
    }
    all
}

fn origin(
    machine: &Machine,
    build: &Build,
    started: &str,
    elapsed_s: f64,
    command: &[String],
) -> Vec<(&'static str, String)> {
    let gib = machine.memory_bytes as f64 / f64::from(1 << 30);
    vec![
        ("Started", format!("{started}, took {elapsed_s:.0} s")),
        ("Command", format!("grotto {}", command.join(" "))),
        (
            "Build",
            format!(
                "grotto {}, commit {}, {}",
                build.version, build.commit, build.profile
            ),
        ),
        (
            "CPU",
            format!(
                "{}, {} cores, {gib:.0} GiB of memory",
                machine.cpu, machine.cores
            ),
        ),
        ("System", machine.os.clone()),
        ("Warm-up", machine.warm_up.clone()),
        (
            "Clocks and power",
            format!(
                "before: {}; after: {}",
                state(machine.gpu_before),
                state(machine.gpu_after)
            ),
        ),
    ]
}

fn state(state: Option<GpuState>) -> String {
    let Some(state) = state else {
        return "not reported by the system".to_owned();
    };
    let parts = [
        state.graphics_mhz.map(|mhz| format!("graphics {mhz} MHz")),
        state.memory_mhz.map(|mhz| format!("memory {mhz} MHz")),
        state.power_w.map(|watts| format!("{watts:.0} W")),
        state.temperature_c.map(|degrees| format!("{degrees} °C")),
    ];
    let known: Vec<String> = parts.into_iter().flatten().collect();
    match known[..] {
        [] => "not reported by the system".to_owned(),
        _ => known.join(", "),
    }
}

/// One figure for each world, with its picture. Other sizes and seeds of a world are lines below the picture.
fn worlds(report: &Report) -> String {
    if report.worlds.is_empty() {
        return String::new();
    }
    let mut figures = String::new();
    for (at, world) in report.worlds.iter().enumerate() {
        let named_alike = |other: &&WorldRecord| other.name == world.name;
        if report.worlds[..at].iter().any(|other| named_alike(&other)) {
            continue;
        }
        let variants: Vec<&WorldRecord> = report.worlds.iter().filter(named_alike).collect();
        figures += &world_figure(&variants);
    }
    format!("<h2>Worlds</h2>\n{}", plots(&figures))
}

/// The figure of a world that was measured in these variants (at least one).
fn world_figure(variants: &[&WorldRecord]) -> String {
    let world = variants[0];
    let picture = variants.iter().find_map(|variant| {
        let uri = variant.picture.as_deref()?;
        uri.starts_with("data:image/").then_some(uri)
    });
    let image = picture.map_or(String::new(), |uri| {
        format!(
            "<img alt=\"{}\" src=\"{}\">",
            escaped(&world.title),
            escaped(uri)
        )
    });
    let lines: String = variants
        .iter()
        .map(|variant| variant_line(variant))
        .collect();
    format!(
        "<figure><figcaption>{}</figcaption>{image}<p>{}</p>{lines}</figure>\n",
        escaped(&world.name),
        escaped(&world.title)
    )
}

fn variant_line(world: &WorldRecord) -> String {
    let [x, y, z] = world.size;
    format!(
        "<p>{x} × {y} × {z} voxels, seed {}, hash <code>{}</code></p>",
        world.seed,
        escaped(&world.hash)
    )
}
