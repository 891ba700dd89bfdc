//! A part of a reference: the sums of some of its samples. Also the picture made of all parts.

use std::{ops::Range, path::Path, sync::atomic::AtomicBool, time::Instant};

use clap::ValueEnum as _;
use serde::{Deserialize, Serialize};

use super::{
    super::{
        Failure,
        judge::cache::fnv1a,
        options::Setup,
        output,
        part::{self, Head, Part, PartFile},
        render,
        shard::Shard,
    },
    Arguments, Job, content, sources,
};
use crate::{
    frame::trace_blocks,
    gpu::{AdapterSummary, Gpu},
    lights::Lights,
    measure::{
        block_sums::{BlockSums, Node},
        picture::Picture,
    },
    passes::path_trace::Sampled,
    world::View,
};

pub const COMMAND: &str = "reference";

/// Describes the numbers that follow it: the light that is not random, then each node, with three f32 per
/// pixel.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Description {
    /// Width and height in pixels.
    size: [u32; 2],
    /// As `--view` spells it.
    view: String,
    exposure_ev: f32,
    /// Samples of the whole picture, and the blocks in which they are summed.
    samples: u32,
    blocks: u32,
    /// The blocks of this part.
    first_block: u32,
    end_block: u32,
    /// The blocks that each sum covers.
    nodes: Vec<Range<u32>>,
}

/// The whole that this part belongs to. It lists everything that the picture depends on.
///
/// # Errors
/// When the tracer's shader cannot be composed.
pub fn head(
    arguments: &Arguments,
    scene: &Setup,
    lights: &Lights,
    gpu: &Gpu,
    shard: Shard,
) -> Result<Head, Failure> {
    let options = &arguments.picture;
    let name = |text: &str| format!("{:032x}", fnv1a(text.as_bytes()));
    let [width, height] = options.size;
    let basis = scene.camera.basis(f64::from(width) / f64::from(height));
    let AdapterSummary {
        name: adapter,
        driver,
        backend,
        ..
    } = &gpu.summary;
    let facts = [
        (
            "grotto",
            format!(
                "{} {}",
                env!("CARGO_PKG_VERSION"),
                name(&sources(gpu.shaders())?)
            ),
        ),
        ("the adapter", format!("{adapter} ({driver}, {backend})")),
        (
            "the world",
            format!(
                "{} {}",
                scene.world.name,
                name(&content(&scene.world, lights, scene.time_s))
            ),
        ),
        (
            "the camera",
            format!("{} {}", scene.camera.name, name(&format!("{basis:?}"))),
        ),
        ("the size", format!("{width}x{height}")),
        ("the view", render::view_name(options.view)),
        ("the samples a pixel", arguments.spp.to_string()),
        ("the seed", options.seed.to_string()),
        ("textures", scene.parameters.textures.enabled.to_string()),
        ("antialiasing", arguments.antialias.to_string()),
        (
            "the exposure",
            scene.parameters.picture.exposure_ev.to_string(),
        ),
    ];
    let file_name = arguments.output.file_name().unwrap_or_default();
    Ok(Head {
        command: COMMAND.to_owned(),
        whole: file_name.to_string_lossy().into_owned(),
        shard,
        facts: facts.map(|(name, value)| (name.to_owned(), value)).into(),
    })
}

/// The file of a part, beside the picture that it belongs to.
///
/// # Errors
/// See [`PartFile::new`].
pub fn file(picture: &Path, head: Head) -> Result<PartFile, Failure> {
    let folder = picture.parent().filter(|path| !path.as_os_str().is_empty());
    PartFile::new(folder.unwrap_or(Path::new(".")), head)
}

/// Traces a part and writes it. A part has no samples when there are more parts than blocks of samples.
///
/// # Errors
/// When the adapter fails, and when the user stops the run: then nothing is written.
pub fn run(job: &Job<'_>, file: PartFile, cancel: &AtomicBool) -> Result<(), Failure> {
    let (arguments, run) = (job.arguments, &job.arguments.run);
    let shard = file.shard();
    let request = job.request();
    let blocks = request.blocks(&job.lights);
    let mine = shard.range(blocks.count());
    let bar = output::progress(run, "tiles × samples", 1);
    let progress = |done, total| {
        bar.set_length(total);
        bar.set_position(done);
    };
    let start = Instant::now();
    let sampled = trace_blocks(
        job.gpu,
        &job.stage,
        &job.lights,
        &request,
        &mine,
        &progress,
        cancel,
    )?;
    let seconds = start.elapsed().as_secs_f64();
    bar.finish_and_clear();
    if !sampled.is_complete() {
        return Err(Failure::interrupted(format!(
            "stopped: part {shard} of {} is not written",
            arguments.output.display()
        )));
    }
    let description = Description {
        size: request.size,
        view: render::view_name(arguments.picture.view),
        exposure_ev: job.scene.parameters.picture.exposure_ev,
        samples: blocks.samples(&(0..blocks.count())).end,
        blocks: blocks.count(),
        first_block: mine.start,
        end_block: mine.end,
        nodes: sampled
            .sums
            .nodes()
            .iter()
            .map(|n| n.blocks.clone())
            .collect(),
    };
    let path = file.write(&encode(&description, &sampled))?;
    let record = job.record(sampled.samples, Some(shard), seconds);
    if run.json {
        return output::print_json(&record);
    }
    let samples = blocks.samples(&mine);
    let what = match samples.is_empty() {
        true => format!(
            "no samples, as {} are too few for {} parts",
            description.samples, shard.count
        ),
        false => format!(
            "samples {} to {} of {}",
            samples.start + 1,
            samples.end,
            description.samples
        ),
    };
    output::note(
        run,
        &format!("{}: {what}, {}", path.display(), record.speed()),
    );
    Ok(())
}

/// Makes the picture from all parts, which must be in order, in a folder.
///
/// # Errors
/// When a part does not fit the others, and when the picture cannot be written.
pub fn merge(parts: &[Part], out: &Path) -> Result<(), Failure> {
    let mut sums = BlockSums::new(0);
    let mut first: Option<(Description, Picture)> = None;
    for part in parts {
        const UNFIT: &str = "the part does not fit the others; run all parts again";
        let decoded = decode(&part.body);
        let (description, certain, own) =
            decoded.ok_or_else(|| part.refused("the part is damaged; run it again"))?;
        if !sums.join(own) {
            return Err(part.refused(UNFIT));
        }
        match &first {
            None => first = Some((description, certain)),
            // The same adapter must give the same bits.
            Some((_, known)) if bits(known).ne(bits(&certain)) => {
                return Err(part.refused(UNFIT));
            }
            Some(_) => {}
        }
    }
    let (Some((description, certain)), Some(part)) = (first, parts.first()) else {
        return Err(Failure::bad_input("there are no parts"));
    };
    let view = View::from_str(&description.view, false);
    let (Ok(view), true) = (view, sums.blocks() == (0..description.blocks)) else {
        return Err(part.refused("the parts do not hold all samples; run them again"));
    };
    let mut picture = sums.mean(&certain, description.samples);
    if view == View::Depth {
        render::show_depth(&mut picture);
    }
    let path = out.join(&part.head.whole);
    render::store(&path, &picture, view, description.exposure_ev)
}

fn bits(picture: &Picture) -> impl Iterator<Item = u32> {
    picture
        .rgb
        .as_flattened()
        .iter()
        .map(|value| value.to_bits())
}

fn encode(description: &Description, sampled: &Sampled) -> Vec<u8> {
    let text = ron::to_string(description).expect("numbers and strings can be written");
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.extend(text.as_bytes());
    let nodes = sampled.sums.nodes().iter().map(|node| &node.rgb);
    for picture in std::iter::once(&sampled.certain.rgb).chain(nodes) {
        for value in picture.as_flattened() {
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// `None` for bytes that are not an encoded part.
fn decode(bytes: &[u8]) -> Option<(Description, Picture, BlockSums)> {
    let (length, rest) = part::number(bytes)?;
    let (text, values) = rest.split_at_checked(length as usize)?;
    let description: Description = ron::de::from_bytes(text).ok()?;
    let [width, height] = description.size;
    let pixels = width as usize * height as usize;
    let (values, []) = values.as_chunks::<4>() else {
        return None;
    };
    let values: Vec<f32> = values.iter().map(|v| f32::from_le_bytes(*v)).collect();
    let (rgb, []) = values.as_chunks::<3>() else {
        return None;
    };
    if pixels == 0 || rgb.len() != pixels * (1 + description.nodes.len()) {
        return None;
    }
    let mut pictures = rgb.chunks_exact(pixels).map(<[_]>::to_vec);
    let certain = Picture {
        width,
        height,
        rgb: pictures.next()?,
    };
    let mut sums = BlockSums::new(description.first_block);
    for (blocks, rgb) in description.nodes.iter().zip(pictures) {
        let blocks = blocks.clone();
        if !sums.push_node(Node { blocks, rgb }) {
            return None;
        }
    }
    (sums.blocks().end == description.end_block).then_some((description, certain, sums))
}
