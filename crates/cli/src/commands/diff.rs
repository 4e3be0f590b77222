//! `etendue diff`: compares a picture with a reference.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use etendue::image::metrics::{
    BlockReport, BlockThresholds, DEFAULT_PIXELS_PER_DEGREE, ErrorMap, Estimate, block_test, flip,
    mean_difference, mse, relative_mse,
};
use etendue::image::{ColorImage, EncodeOptions, ImageError, encode};
use serde_json::{Map, Value, json};

use crate::failure::{Failure, Status};
use crate::output::Target;
use crate::parsers::{self, VarianceFile};
use crate::{pictures, terminal, text, variances};

/// The arguments of `etendue diff`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The picture to compare
    picture: PathBuf,
    /// The reference picture
    reference: PathBuf,
    /// Print only this metric, and map it with --output
    #[arg(long, value_enum, value_name = "METRIC")]
    metric: Option<Metric>,
    /// Variance files for the picture and the reference, in this order; a picture with `variance`
    /// layers needs none. FILE@COUNT: variance of single samples, where the mean has COUNT samples
    #[arg(long, value_name = "FILE[@COUNT]", value_parser = parsers::variance_file)]
    variance: Vec<VarianceFile>,
    /// Write an error map as a picture, of relmse unless --metric is given
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Compare this layer of both pictures, such as albedo, or this channel, such as depth.T
    #[arg(long, value_name = "NAME", conflicts_with = "variance")]
    layer: Option<String>,
    /// Print JSON, for other programs
    #[arg(long)]
    json: bool,
    /// End with exit code 1 if the metric, relmse unless --metric is given, is above this or not a
    /// number
    #[arg(long, value_name = "LIMIT", value_parser = parsers::limit)]
    fail_above: Option<f64>,
}

/// A measure of the difference between two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Metric {
    /// Relative mean squared error, (x - r)² / (r² + 0.01)
    Relmse,
    /// Mean squared error
    Mse,
    /// Perceived difference on a display, from 0 to 1
    Flip,
}

impl Metric {
    fn name(self) -> &'static str {
        match self {
            Self::Relmse => "relmse",
            Self::Mse => "mse",
            Self::Flip => "flip",
        }
    }

    fn compute(self, image: &ColorImage, reference: &ColorImage) -> Result<ErrorMap, ImageError> {
        match self {
            Self::Relmse => relative_mse(image, reference),
            Self::Mse => mse(image, reference),
            Self::Flip => flip(image, reference, DEFAULT_PIXELS_PER_DEGREE),
        }
    }
}

/// In the second count, blocks must also differ by more than this share, because references have
/// errors of their own, such as rounding to single precision.
const RELEVANT_DIFFERENCE: f64 = 0.02;

/// The quantile of the error that the brightest colour of a map stands for.
const MAP_QUANTILE: f32 = 0.99;

/// Compares the pictures, prints the result, and writes the map.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let target = arguments.output.as_deref().map(Target::new).transpose()?;
    let paths = [&arguments.picture, &arguments.reference];
    let pictures = [pictures::read(paths[0])?, pictures::read(paths[1])?];
    let (pictures, estimates) = match &arguments.layer {
        None => {
            let estimates = variances::find(&pictures, &arguments.variance)?;
            (pictures, estimates)
        }
        Some(name) => {
            let [picture, reference] = &pictures;
            let layer = pictures::layer(picture, name, paths[0])?;
            ([layer, pictures::layer(reference, name, paths[1])?], None)
        }
    };
    let [image, reference] = &pictures;
    let image = image.to_color_image().map_err(Failure::bad_input)?;
    let reference = reference.to_color_image().map_err(Failure::bad_input)?;
    let reports = match &estimates {
        None => Vec::new(),
        Some([variance, reference_variance]) => {
            let image = Estimate { mean: &image, variance };
            let reference = Estimate { mean: &reference, variance: reference_variance };
            block_reports(image, reference).map_err(Failure::bad_input)?
        }
    };
    let shown = show(arguments, [&image, &reference], &reports).map_err(Failure::bad_input)?;
    terminal::result(&shown)?;
    let metric = arguments.metric.unwrap_or(Metric::Relmse);
    if let Some(target) = target {
        let map = metric.compute(&image, &reference).map_err(Failure::bad_input)?;
        let maximum = map.quantile(MAP_QUANTILE);
        let options = EncodeOptions::default();
        target.write(encode(&map.to_picture(maximum), target.format, &options))?;
    }
    match arguments.fail_above {
        Some(limit) => judge(metric, metric.compute(&image, &reference), limit),
        None => Ok(Status::Success),
    }
}

/// Whether a metric stays within its limit. Pixels that are not finite have no error, so that any of
/// them exceeds it.
fn judge(metric: Metric, map: Result<ErrorMap, ImageError>, limit: f64) -> Result<Status, Failure> {
    let map = map.map_err(Failure::bad_input)?;
    let name = metric.name();
    if map.non_finite > 0 {
        let count = text::counted(map.non_finite, "pixel");
        return Err(Failure::failed(format!("{name}: {count} not finite")));
    }
    if map.mean <= limit {
        return Ok(Status::Success);
    }
    Err(Failure::failed(format!("{name} is {}, above {limit}", map.mean)))
}

/// The result as text or JSON.
fn show(
    arguments: &Arguments,
    [image, reference]: [&ColorImage; 2],
    reports: &[(BlockThresholds, BlockReport)],
) -> Result<String, ImageError> {
    if arguments.json {
        let mut object = match arguments.metric {
            Some(metric) => {
                let mut object = Map::new();
                let mean = metric.compute(image, reference)?.mean;
                object.insert(metric.name().to_owned(), json!(mean));
                object
            }
            None => metrics_as_json(image, reference)?,
        };
        if !reports.is_empty() {
            object.insert("blocks".to_owned(), reports.iter().map(block_json).collect());
        }
        return Ok(format!("{}\n", Value::Object(object)));
    }
    let mut shown = match arguments.metric {
        Some(metric) => format!("{}\n", metric.compute(image, reference)?.mean),
        None => compare(image, reference)?,
    };
    for (thresholds, report) in reports {
        let also = if thresholds.relative_difference > 0.0 { " and 2 %" } else { "" };
        shown.push_str(&format!(
            "blocks  {:.3} % off by more than {} standard errors{also} ({} of {})\n",
            report.share() * 100.0,
            thresholds.standard_errors,
            report.off_count,
            report.block_count,
        ));
    }
    Ok(shown)
}

/// All metrics, as an object.
fn metrics_as_json(
    image: &ColorImage,
    reference: &ColorImage,
) -> Result<Map<String, Value>, ImageError> {
    let squared = mse(image, reference)?;
    let difference = mean_difference(image, reference)?;
    let entries = [
        ("mse", json!(squared.mean)),
        ("relmse", json!(relative_mse(image, reference)?.mean)),
        ("flip", json!(flip(image, reference, DEFAULT_PIXELS_PER_DEGREE)?.mean)),
        ("mean_difference", json!(difference.signed)),
        ("relative_mean_difference", json!(difference.relative)),
        ("non_finite_pixels", json!(squared.non_finite)),
    ];
    Ok(entries.map(|(name, value)| (name.to_owned(), value)).into_iter().collect())
}

/// The result of one block test, as an object.
fn block_json((thresholds, report): &(BlockThresholds, BlockReport)) -> Value {
    json!({
        "standard_errors": thresholds.standard_errors,
        "relative_difference": thresholds.relative_difference,
        "share": report.share(),
        "off": report.off_count,
        "count": report.block_count,
    })
}

/// Formats all metrics.
fn compare(image: &ColorImage, reference: &ColorImage) -> Result<String, ImageError> {
    let squared = mse(image, reference)?;
    let difference = mean_difference(image, reference)?;
    let [red, green, blue] = difference.signed;
    let [relative_red, relative_green, relative_blue] = difference.relative.map(|d| d * 100.0);
    let mut shown = format!("MSE     {:.6e}\n", squared.mean);
    shown.push_str(&format!("relMSE  {:.6e}\n", relative_mse(image, reference)?.mean));
    let perceived = flip(image, reference, DEFAULT_PIXELS_PER_DEGREE)?;
    shown.push_str(&format!("FLIP    {:.6}\n", perceived.mean));
    shown.push_str(&format!("means   {red:+.6} {green:+.6} {blue:+.6}\n"));
    shown.push_str(&format!(
        "        {relative_red:+.3} % {relative_green:+.3} % {relative_blue:+.3} %\n"
    ));
    if squared.non_finite > 0 {
        shown.push_str(&format!("left out: {} non-finite pixels\n", squared.non_finite));
    }
    Ok(shown)
}

/// How many blocks differ by more than noise explains, and how many of these also by more than 2 %.
fn block_reports(
    image: Estimate<'_>,
    reference: Estimate<'_>,
) -> Result<Vec<(BlockThresholds, BlockReport)>, ImageError> {
    let strict = BlockThresholds::default();
    let relevant = BlockThresholds { relative_difference: RELEVANT_DIFFERENCE, ..strict };
    let report = |thresholds| Ok((thresholds, block_test(image, reference, &thresholds)?));
    [strict, relevant].into_iter().map(report).collect()
}
