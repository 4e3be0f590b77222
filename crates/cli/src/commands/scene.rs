//! The arguments shared by all commands that load scenes.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use etendue::bvh::Tier;
use etendue::document::Class;
use etendue::integrators::{INTEGRATORS, IntegratorOptions};
use etendue::scene::{BuildOptions, registry};
use etendue::{Files, Loaded, SceneOptions, Workers, load};

use crate::diagnostics::Detail;
use crate::failure::Failure;
use crate::parsers;

/// How scenes are loaded.
#[derive(Args, Debug)]
pub(crate) struct SceneArguments {
    /// Set $NAME in the scene
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parsers::define)]
    define: Vec<(String, String)>,
    /// Also look for the scene's files in this folder
    #[arg(long, value_name = "FOLDER")]
    search_path: Vec<PathBuf>,
    /// Width and height of the film, in pixels
    #[arg(long, value_name = "WxH", value_parser = parsers::size)]
    size: Option<[u32; 2]>,
    /// Reconstruction filter; overrides the film's
    #[arg(long, value_name = "NAME", value_parser = filter_names())]
    filter: Option<String>,
    /// Integrator; overrides the scene's
    #[arg(long, value_name = "NAME", value_parser = integrator_names())]
    integrator: Option<String>,
    /// Turn off emitter sampling, for comparison
    #[arg(long)]
    no_emitter_sampling: bool,
    /// Limit what one vertex of a path may add of light that was scattered more than once. Fewer
    /// bright single pixels, but a picture that is too dark
    #[arg(long, value_name = "RADIANCE", value_parser = parsers::radiance)]
    clamp_indirect: Option<f32>,
    /// Treat unknown parameters as errors
    #[arg(long)]
    strict: bool,
    /// Treat missing files as warnings, and load the scene without them
    #[arg(long)]
    skip_missing: bool,
    /// Number of threads; one per processor by default. Does not change the picture
    #[arg(short = 't', long, value_name = "COUNT")]
    pub(crate) threads: Option<std::num::NonZeroUsize>,
    /// Use only baseline CPU instructions. Does not change the picture
    #[arg(long)]
    portable: bool,
    /// Print only errors
    #[arg(short = 'q', long, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Print more details
    #[arg(short = 'v', long)]
    pub(crate) verbose: bool,
}

/// The names of all reconstruction filters.
fn filter_names() -> PossibleValuesParser {
    let filters =
        registry::plugins().into_iter().filter(|(class, ..)| *class == Class::ReconstructionFilter);
    PossibleValuesParser::new(filters.map(|(_, name, _)| name))
}

/// The names of all integrators.
fn integrator_names() -> PossibleValuesParser {
    PossibleValuesParser::new(INTEGRATORS.iter().map(|plugin| plugin.name))
}

impl SceneArguments {
    /// How many of the diagnostics to show.
    pub(crate) fn detail(&self) -> Detail {
        match (self.quiet, self.verbose) {
            (true, _) => Detail::Errors,
            (_, true) => Detail::Everything,
            _ => Detail::Warnings,
        }
    }

    /// Starts the requested number of threads.
    pub(crate) fn workers(&self) -> Result<Workers, Failure> {
        Workers::new(self.threads).map_err(Failure::failed)
    }

    /// Loads a scene, using these threads.
    pub(crate) fn load(&self, path: &Path, workers: &Workers) -> Result<Loaded, Failure> {
        let folder = std::env::current_dir().map_err(|error| {
            Failure::failed(format!("cannot determine the working directory: {error}"))
        })?;
        let options = self.options();
        Ok(workers.run(|| load(path, folder, &Files::default(), &options)))
    }

    fn options(&self) -> SceneOptions {
        SceneOptions {
            defines: self.define.clone(),
            search_paths: self.search_path.clone(),
            build: BuildOptions {
                film_size: self.size,
                filter: self.filter.clone(),
                skip_missing: self.skip_missing,
                tier: self.portable.then_some(Tier::Portable),
                ..BuildOptions::default()
            },
            integrator: IntegratorOptions {
                name: self.integrator.clone(),
                emitter_sampling: !self.no_emitter_sampling,
                clamp_indirect: self.clamp_indirect,
            },
            strict: self.strict,
            editable: false,
        }
    }
}
