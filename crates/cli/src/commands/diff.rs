//! `etendue diff`: compares a picture with a reference.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use etendue::image::metrics::{
    BlockThresholds, DEFAULT_PIXELS_PER_DEGREE, ErrorMap, Estimate, block_test, flip,
    mean_difference, mse, relative_mse,
};
use etendue::image::{ColorImage, EncodeOptions, ImageError, encode};

use crate::failure::{Failure, Status};
use crate::output::Target;
use crate::parsers::{self, VarianceFile};
use crate::{pictures, terminal, variances};

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
    let pictures = [pictures::read(&arguments.picture)?, pictures::read(&arguments.reference)?];
    let estimates = variances::find(&pictures, &arguments.variance)?;
    let [image, reference] = &pictures;
    let image = image.to_color_image().map_err(Failure::bad_input)?;
    let reference = reference.to_color_image().map_err(Failure::bad_input)?;

    let shown = match arguments.metric {
        Some(metric) => {
            format!("{}\n", metric.compute(&image, &reference).map_err(Failure::bad_input)?.mean)
        }
        None => compare(&image, &reference).map_err(Failure::bad_input)?,
    };
    terminal::result(&shown)?;
    if let Some([variance, reference_variance]) = &estimates {
        let image = Estimate { mean: &image, variance };
        let reference = Estimate { mean: &reference, variance: reference_variance };
        terminal::result(&blocks(image, reference).map_err(Failure::bad_input)?)?;
    }
    if let Some(target) = target {
        let metric = arguments.metric.unwrap_or(Metric::Relmse);
        let map = metric.compute(&image, &reference).map_err(Failure::bad_input)?;
        let maximum = map.quantile(MAP_QUANTILE);
        let options = EncodeOptions::default();
        target.write(encode(&map.to_picture(maximum), target.format, &options))?;
    }
    Ok(Status::Success)
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

/// Formats the shares of blocks that differ by more than noise explains.
fn blocks(image: Estimate<'_>, reference: Estimate<'_>) -> Result<String, ImageError> {
    let strict = BlockThresholds::default();
    let relevant = BlockThresholds { relative_difference: RELEVANT_DIFFERENCE, ..strict };
    let mut shown = String::new();
    for (thresholds, also) in [(strict, ""), (relevant, " and 2 %")] {
        let report = block_test(image, reference, &thresholds)?;
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
