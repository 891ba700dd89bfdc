//! `grotto compare`: a picture against a reference.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, memory, options::OutputOptions, output};
use crate::{
    measure::{
        comparison::{Comparison, Shown, compare},
        magma::heat_map,
        metrics,
        picture::Picture,
        picture_file::{self, Encoding, PictureFormat},
        selection::Selection,
    },
    parameters::nearest,
};

/// Compare two pictures: FLIP, absolute and relative error, energy
///
/// FLIP (Andersson et al. 2020, 67 pixels per degree) and the sum over RGB of the absolute difference (0 to 3)
/// compare the pictures as a display shows them: an EXR is tone-mapped first, as `grotto render` does for a
/// PNG. Relative MSE and energy ratio (A over B) compare linear light: a PNG is sRGB-decoded first, so that its
/// light is the display's, not the world's. Compare EXR files to judge light.
#[derive(Args)]
pub struct Arguments {
    /// The picture to judge: .png or .exr
    #[arg(value_name = "A")]
    picture: PathBuf,
    /// The reference: .png or .exr
    #[arg(value_name = "B")]
    reference: PathBuf,
    /// Write FLIP of every pixel, coloured from black (0) to pale yellow (1) with the colour map magma
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Measure only where this picture has a channel above one half
    #[arg(long, value_name = "FILE", conflicts_with = "region")]
    mask: Option<PathBuf>,
    /// With --mask: measure only where the mask's red channel lies between LOW and HIGH. A depth view shows d
    /// voxels as 2^(-d/32)
    #[arg(long, value_name = "LOW,HIGH", requires = "mask", value_parser = band, allow_hyphen_values = true)]
    mask_band: Option<[f32; 2]>,
    /// Measure only this rectangle, counted in pixels from the top left
    #[arg(long, value_name = "X,Y,WxH", value_parser = region, allow_hyphen_values = true)]
    region: Option<[u32; 4]>,
    /// Stops by which EXR pictures are brightened before tone mapping
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = exposure, allow_negative_numbers = true)]
    exposure: f32,
    /// Exit with 4 when this metric is greater (repeatable): flip.mean, flip.p99, flip.max,
    /// abs_sum.mean, abs_sum.max, rel_mse, energy_ratio, energy_error (its distance from 1)
    #[arg(long, value_name = "METRIC=VALUE", value_parser = gate)]
    fail_over: Vec<Gate>,
    #[command(flatten)]
    output: OutputOptions,
}

/// A metric with its upper limit.
#[derive(Clone, Debug, PartialEq)]
struct Gate {
    metric: &'static str,
    limit: f64,
}

fn gate(text: &str) -> Result<Gate, String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("write METRIC=VALUE, as in flip.mean=0.05")?;
    let names = || Comparison::METRICS.iter().map(|(name, _)| *name);
    let metric = names().find(|known| *known == name.trim()).ok_or_else(|| {
        let near = nearest(name.trim(), names());
        let hint = match &near[..] {
            [] => String::new(),
            near => format!("did you mean `{}`? ", near.join("` or `")),
        };
        let all: Vec<&str> = names().collect();
        format!("no metric `{name}`; {hint}there are {}", all.join(", "))
    })?;
    let limit: Option<f64> = value.trim().parse().ok();
    match limit.filter(|limit| limit.is_finite() && *limit >= 0.0) {
        Some(limit) => Ok(Gate { metric, limit }),
        None => Err(format!("`{value}` is not a number of at least 0")),
    }
}

fn region(text: &str) -> Result<[u32; 4], String> {
    let parse = || {
        let (x, rest) = text.split_once(',')?;
        let (y, size) = rest.split_once(',')?;
        let (width, height) = size.split_once(['x', 'X', '×'])?;
        let number = |text: &str| text.trim().parse().ok();
        Some([number(x)?, number(y)?, number(width)?, number(height)?])
    };
    parse().ok_or_else(|| "write X,Y,WIDTHxHEIGHT, as in 100,50,320x180".to_owned())
}

fn band(text: &str) -> Result<[f32; 2], String> {
    let parse = || {
        let (low, high) = text.split_once(',')?;
        Some([low.trim().parse().ok()?, high.trim().parse().ok()?])
    };
    let band: Option<[f32; 2]> = parse();
    band.filter(|[low, high]| low <= high)
        .ok_or_else(|| "write LOW,HIGH, as in 0.1,0.2".to_owned())
}

fn exposure(text: &str) -> Result<f32, String> {
    let stops = text.parse().ok().filter(|stops: &f32| stops.abs() <= 20.0);
    stops.ok_or_else(|| "write stops as a number from -20 to 20".to_owned())
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.heatmap {
        check_heat_map(path)?;
    }
    let picture = read(&arguments.picture)?;
    let reference = read(&arguments.reference)?;
    let size = same_size(arguments, &picture.0, &reference.0)?;
    let selection = selection(arguments, size)?;
    // The planes of filtered values take about forty numbers per pixel at a time.
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    memory::check("comparing pictures of this size", pixels * 160)?;

    let shown = |(picture, encoding)| Shown::from_file(picture, encoding, arguments.exposure);
    let (comparison, map) =
        compare(&shown(picture), &shown(reference), &selection).map_err(Failure::bad_input)?;
    if let Some(path) = &arguments.heatmap {
        let measured = map.iter().enumerate();
        let values: Vec<f32> = measured
            .map(|(index, &value)| if selection.has(index) { value } else { 0.0 })
            .collect();
        picture_file::write_png(path, &heat_map(size, &values))?;
    }
    if arguments.output.json {
        output::print_json(&comparison)?;
    } else {
        output::print(&table(&comparison))?;
    }
    hold(&comparison, &arguments.fail_over)
}

/// A heat map is data: it has no light that an EXR could store.
fn check_heat_map(path: &Path) -> Result<(), Failure> {
    match picture_file::check_writable(path)? {
        PictureFormat::Png => Ok(()),
        PictureFormat::Exr => Err(Failure::bad_input(format!(
            "{}: a heat map is a .png; name one",
            path.display()
        ))),
    }
}

/// Reads a picture and refuses one that is not finite; the error names the pixel.
fn read(path: &Path) -> Result<(Picture, Encoding), Failure> {
    let (picture, encoding) = picture_file::read(path)?;
    let Some([x, y]) = metrics::first_not_finite(&picture) else {
        return Ok((picture, encoding));
    };
    let [r, g, b] = picture.rgb[y as usize * picture.width as usize + x as usize];
    Err(Failure::bad_input(format!(
        "{}: pixel ({x}, {y}) is not a finite colour: red {r}, green {g}, blue {b}; a picture with \
         such pixels cannot be measured, render it again",
        path.display()
    )))
}

fn same_size(arguments: &Arguments, a: &Picture, b: &Picture) -> Result<[u32; 2], Failure> {
    if (a.width, a.height) == (b.width, b.height) {
        return Ok([a.width, a.height]);
    }
    Err(Failure::bad_input(format!(
        "{} is {}×{} pixels and {} is {}×{}; render both with the same --size",
        arguments.picture.display(),
        a.width,
        a.height,
        arguments.reference.display(),
        b.width,
        b.height
    )))
}

fn selection(arguments: &Arguments, size: [u32; 2]) -> Result<Selection, Failure> {
    match (&arguments.mask, arguments.region) {
        (Some(path), _) => {
            let (mask, _) = read(path)?;
            let selection = match arguments.mask_band {
                Some(band) => Selection::band(size, &mask, band),
                None => Selection::mask(size, &mask),
            };
            selection.map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))
        }
        (None, Some(region)) => Selection::region(size, region)
            .map_err(|error| Failure::bad_input(format!("--region: {error}"))),
        (None, None) => Ok(Selection::ALL),
    }
}

fn table(comparison: &Comparison) -> String {
    let Comparison {
        flip,
        abs_sum,
        rel_mse,
        energy_ratio,
        size: [width, height],
        pixels,
    } = comparison;
    format!(
        "size                {width} × {height}, {pixels} pixels measured\n\
         FLIP                mean {:.5}   p99 {:.5}   max {:.5}\n\
         absolute sum (of 3) mean {:.5}   max {:.5}\n\
         relative MSE        {rel_mse:.6}\n\
         energy ratio        {energy_ratio:.5}\n",
        flip.mean, flip.p99, flip.max, abs_sum.mean, abs_sum.max
    )
}

/// # Errors
/// One line for each metric that exceeds its limit or is not a number.
fn hold(comparison: &Comparison, gates: &[Gate]) -> Result<(), Failure> {
    let over = gates.iter().filter_map(|gate| {
        let value = comparison.metric(gate.metric)?;
        (value > gate.limit || value.is_nan())
            .then(|| format!("{} is {value:.6}, over {}", gate.metric, gate.limit))
    });
    let over: Vec<String> = over.collect();
    if over.is_empty() {
        Ok(())
    } else {
        Err(Failure::gate(over.join("\n")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_metric_is_a_gate_and_every_gate_is_in_the_help() {
        let command = <Arguments as clap::Args>::augment_args(clap::Command::new("compare"));
        let argument = command.get_arguments().find(|a| a.get_id() == "fail_over");
        let help = argument.and_then(|a| a.get_help()).expect("a help text");
        for (name, _) in Comparison::METRICS {
            let parsed = gate(&format!("{name}=0.5")).expect(name);
            assert_eq!((parsed.metric, parsed.limit), (name, 0.5));
            assert!(help.to_string().contains(name), "{name}");
        }
    }

    #[test]
    fn gates_that_are_none_say_what_would_be_right() {
        for (text, part) in [
            ("flip.mean", "METRIC=VALUE"),
            ("flip.men=1", "`flip.mean`"),
            ("flip=1", "flip.p99"),
            ("zzz=1", "there are flip.mean"),
            ("rel_mse=NaN", "not a number"),
            ("rel_mse=-1", "not a number"),
            ("rel_mse=", "not a number"),
        ] {
            let refused = gate(text).expect_err(text);
            assert!(refused.contains(part), "{text}: {refused}");
        }
    }

    #[test]
    fn regions_are_read_or_refused() {
        assert_eq!(region("1,2,3x4"), Ok([1, 2, 3, 4]));
        assert_eq!(region(" 1, 2, 3 × 4"), Ok([1, 2, 3, 4]));
        for text in ["", "1,2", "1,2,3", "-1,2,3x4", "1,2,3x4x5", "a,2,3x4"] {
            assert!(region(text).is_err(), "{text}");
        }
    }
}
