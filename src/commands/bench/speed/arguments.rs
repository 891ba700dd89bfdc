//! The options of every suite that times frames.

use std::path::PathBuf;

use clap::Args;

use super::super::super::{
    options::{RunOptions, picture_size, world_file, world_time},
    shard::Shard,
};

#[derive(Args)]
pub struct Arguments {
    /// World files [default: those of the suite]
    #[arg(value_name = "WORLD", value_parser = world_file())]
    pub worlds: Vec<PathBuf>,
    /// The folder for bench.json, rows.csv, frames.csv.gz and index.html, created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace results that the folder holds
    #[arg(long)]
    pub overwrite: bool,
    /// Only this camera (repeatable) [default: the world's first]
    #[arg(long = "camera", value_name = "NAME")]
    pub cameras: Vec<String>,
    /// Only this probe layout (repeatable); suites that vary something else take the first one
    #[arg(long = "layout", value_name = "NAME")]
    pub layouts: Vec<String>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: [u32; 2],
    /// Settling frames before each run [default: 400 for layouts, 80 for tables and probes, 160 for other suites, fewer for large
    /// worlds and with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), allow_negative_numbers = true)]
    pub frames: Option<u32>,
    /// Measured frames of each run [default: 240 for layouts, 60 for tables and probes, 120 for other suites, fewer for
    /// large worlds and with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000), allow_negative_numbers = true)]
    pub measured: Option<u32>,
    /// Runs of each row [default: 5 to 20, until the median is known to ±1 %; 3 with --quick; 1 for probes]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), allow_negative_numbers = true)]
    pub runs: Option<u32>,
    /// World time of the first frame, in seconds
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = world_time, allow_negative_numbers = true)]
    pub time: f64,
    /// Seed of the random rays
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub seed: u32,
    /// Measure less of everything: about a minute on a fast GPU
    #[arg(long)]
    pub quick: bool,
    /// Also judge the pictures of rows that do not move, by FLIP and by energy against the path-traced
    /// reference
    #[arg(long)]
    pub quality: bool,
    /// Anti-alias the pictures, as players see them, where tables have none; rows are called …/displayed
    #[arg(long)]
    pub displayed: bool,
    /// Paths per pixel of references
    #[arg(long, value_name = "N", default_value_t = 1024, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub spp: u32,
    /// Where references are stored [default: the user's cache folder]
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// Only part I of N of the rows; `grotto merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub shard: Option<Shard>,
    #[command(flatten)]
    pub run: RunOptions,
}
