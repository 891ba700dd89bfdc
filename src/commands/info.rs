//! `grotto info`: the adapters of this machine, which one would run, and every parameter.

use std::fmt::Write as _;

use clap::Args;
use serde::Serialize;

use super::{Failure, options::OutputOptions, output};
use crate::{
    gpu::{AdapterReport, AdapterSummary, GpuError, adapters},
    parameters::KEYS,
};

/// Show adapters, limits and what would run; or every parameter
#[derive(Args)]
pub struct Arguments {
    /// List every parameter of --set with its default, its range and its cost
    #[arg(long)]
    keys: bool,
    #[command(flatten)]
    output: OutputOptions,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.keys {
        return if arguments.output.json {
            output::print_json(&KeyTable::new())
        } else {
            output::print(&key_table())
        };
    }
    let found = adapters();
    let chosen = found.iter().position(|adapter| adapter.usable);
    if arguments.output.json {
        output::print_json(&Report::new(&found, chosen))?;
    } else if !found.is_empty() {
        output::print(&description(&found, chosen))?;
    }
    match chosen {
        Some(_) => Ok(()),
        None => Err(GpuError::NoAdapter {
            reason: match found.len() {
                0 => "no Vulkan, Metal or Direct3D 12 adapter was found".to_owned(),
                count => format!("none of the {count} adapters found fits grotto's needs"),
            },
        }
        .into()),
    }
}

/// The `--json` of `grotto info`.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    adapters: Vec<Adapter>,
}

#[derive(Serialize)]
struct Adapter {
    #[serde(flatten)]
    summary: AdapterSummary,
    usable: bool,
    /// Whether this adapter runs when `--adapter` names none.
    chosen: bool,
    limits: Limits,
    features: Features,
}

/// The limits that decide how large worlds, layouts and pictures may be.
#[derive(Serialize)]
struct Limits {
    max_buffer_size: u64,
    max_storage_buffer_binding_size: u64,
    max_storage_buffers_per_shader_stage: u32,
    max_texture_dimension_2d: u32,
    max_texture_array_layers: u32,
    max_compute_workgroups_per_dimension: u32,
}

/// Optional features; each has a fallback.
#[derive(Serialize)]
struct Features {
    timestamps: bool,
    subgroups: bool,
    f16: bool,
}

impl Report {
    fn new(found: &[AdapterReport], chosen: Option<usize>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            adapters: found
                .iter()
                .enumerate()
                .map(|(index, adapter)| Adapter {
                    summary: adapter.summary.clone(),
                    usable: adapter.usable,
                    chosen: Some(index) == chosen,
                    limits: Limits::of(&adapter.limits),
                    features: Features::of(adapter.features),
                })
                .collect(),
        }
    }
}

impl Limits {
    fn of(limits: &wgpu::Limits) -> Self {
        Self {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            max_storage_buffers_per_shader_stage: limits.max_storage_buffers_per_shader_stage,
            max_texture_dimension_2d: limits.max_texture_dimension_2d,
            max_texture_array_layers: limits.max_texture_array_layers,
            max_compute_workgroups_per_dimension: limits.max_compute_workgroups_per_dimension,
        }
    }
}

impl Features {
    fn of(features: wgpu::Features) -> Self {
        Self {
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            subgroups: features.contains(wgpu::Features::SUBGROUP),
            f16: features.contains(wgpu::Features::SHADER_F16),
        }
    }
}

fn description(found: &[AdapterReport], chosen: Option<usize>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let mut line = |args: std::fmt::Arguments<'_>| {
        let _ = writeln!(text, "{args}");
    };
    if let Some(summary) = chosen.map(|index| &found[index].summary) {
        let AdapterSummary {
            name,
            kind,
            backend,
            ..
        } = summary;
        line(format_args!("Would run on: {name} ({kind}, {backend})"));
        if summary.is_software() {
            line(format_args!(
                "  A software adapter: pictures are the same, but hundreds of times slower than a GPU's."
            ));
        }
    }
    for adapter in found {
        let AdapterSummary {
            name,
            kind,
            driver,
            backend,
        } = &adapter.summary;
        let unusable = if adapter.usable {
            ""
        } else {
            " — not usable: too few storage buffers"
        };
        line(format_args!("\n{name}{unusable}"));
        line(format_args!(
            "  kind      {kind}, through {backend}, driver {driver}"
        ));
        let limits = Limits::of(&adapter.limits);
        line(format_args!(
            "  memory    buffers to {}, bindings to {}, {} storage buffers a shader",
            bytes(limits.max_buffer_size),
            bytes(limits.max_storage_buffer_binding_size),
            limits.max_storage_buffers_per_shader_stage
        ));
        line(format_args!(
            "  textures  edge to {}, layers to {}; workgroups to {} an axis",
            limits.max_texture_dimension_2d,
            limits.max_texture_array_layers,
            limits.max_compute_workgroups_per_dimension
        ));
        let Features {
            timestamps,
            subgroups,
            f16,
        } = Features::of(adapter.features);
        let [timestamps, subgroups, f16] =
            [timestamps, subgroups, f16].map(|there| if there { "yes" } else { "no" });
        line(format_args!(
            "  features  timestamps {timestamps}, subgroups {subgroups}, f16 {f16}"
        ));
    }
    text
}

/// Bytes with a binary unit, to three digits.
pub fn bytes(count: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = count as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    let digits = if value >= 100.0 || unit == 0 { 0 } else { 1 };
    format!("{value:.digits$} {}", UNITS[unit])
}

/// The `--json` of `grotto info --keys`.
#[derive(Serialize)]
struct KeyTable {
    keys: Vec<KeyRow>,
}

#[derive(Serialize)]
struct KeyRow {
    key: &'static str,
    default: String,
    range: String,
    about: &'static str,
}

impl KeyTable {
    fn new() -> Self {
        let row = |key: &crate::parameters::Key| KeyRow {
            key: key.name,
            default: key.default().to_string(),
            range: key.kind.range(),
            about: key.doc,
        };
        Self {
            keys: KEYS.iter().map(row).collect(),
        }
    }
}

fn key_table() -> String {
    let rows = KeyTable::new().keys;
    let width = |cell: fn(&KeyRow) -> usize| rows.iter().map(cell).max().unwrap_or(0);
    let key_width = width(|row| row.key.len());
    let default_width = width(|row| row.default.chars().count()).max("default".len());
    let range_width = width(|row| row.range.chars().count());
    let mut text = format!(
        "{:key_width$}  {:default_width$}  {:range_width$}  about\n",
        "key", "default", "range"
    );
    for KeyRow {
        key,
        default,
        range,
        about,
    } in &rows
    {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{key:key_width$}  {default:default_width$}  {range:range_width$}  {about}"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_read_well_at_every_size() {
        for (count, text) in [
            (0, "0 B"),
            (1023, "1023 B"),
            (1536, "1.5 KiB"),
            (128 << 20, "128 MiB"),
            (u64::MAX, "16777216 TiB"),
        ] {
            assert_eq!(bytes(count), text);
        }
    }
}
