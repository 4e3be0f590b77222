//! The arguments shared by all commands that load scenes.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use etendue::bvh::Tier;
use etendue::document::{Class, list_names, near_names};
use etendue::integrators::{INTEGRATORS, IntegratorOptions};
use etendue::scene::{BuildOptions, registry};
use etendue::{Files, Loaded, SceneOptions, Workers, load};

use crate::diagnostics::Detail;
use crate::failure::Failure;
use crate::{memory, parsers};

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
    #[arg(long, value_name = "NAME", value_parser = KnownNames(integrator_names))]
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
    /// Replace plugins that nobody knows by the plainest of their family, with a warning each
    #[arg(long)]
    lenient: bool,
    /// Treat missing files as warnings, and load the scene without them
    #[arg(long)]
    skip_missing: bool,
    /// Memory for pictures, meshes and their trees, such as 512MB or 8GB; most of what is available
    /// by default
    #[arg(long, value_name = "SIZE", value_parser = parsers::memory)]
    pub(crate) memory: Option<u64>,
    /// Number of threads; one per processor by default. Does not change the picture
    #[arg(short = 't', long, value_name = "COUNT", value_parser = parsers::threads)]
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
fn integrator_names() -> Vec<&'static str> {
    INTEGRATORS.iter().map(|plugin| plugin.name).collect()
}

/// Parses the name of an integrator. Other names get advice that knows what they mean: `bdpt` has
/// letters in common with `depth`, but computes what `path` does.
#[derive(Clone)]
struct KnownNames(fn() -> Vec<&'static str>);

impl TypedValueParser for KnownNames {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        let (names, value) = ((self.0)(), value.to_string_lossy());
        if names.contains(&value.as_ref()) {
            return Ok(value.into_owned());
        }
        let argument = argument.map(ToString::to_string).unwrap_or_default();
        let means = match registry::instead(Class::Integrator, &value) {
            Some(known) => vec![known],
            None => near_names(&value, names.iter().copied()),
        };
        let advice = match means.as_slice() {
            [] => String::new(),
            near => format!("\n\n  tip: did you mean {}?", list_names(near.iter().copied())),
        };
        let message = format!(
            "invalid value '{value}' for '{argument}'\n  [possible values: {}]{advice}\n",
            names.join(", ")
        );
        Err(clap::Error::raw(clap::error::ErrorKind::InvalidValue, message).with_cmd(command))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.0)().into_iter().map(PossibleValue::new)))
    }
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
        let files = Files::default();
        let size_limit = options.build.memory_limit.unwrap_or(files.size_limit);
        let files = Files { size_limit: size_limit.min(files.size_limit) };
        Ok(workers.run(|| load(path, folder, &files, &options)))
    }

    fn options(&self) -> SceneOptions {
        SceneOptions {
            defines: self.define.clone(),
            search_paths: self.search_path.clone(),
            build: BuildOptions {
                film_size: self.size,
                filter: self.filter.clone(),
                skip_missing: self.skip_missing,
                memory_limit: self.memory.or_else(memory::for_scene),
                tier: self.portable.then_some(Tier::Portable),
                ..BuildOptions::default()
            },
            integrator: IntegratorOptions {
                name: self.integrator.clone(),
                emitter_sampling: !self.no_emitter_sampling,
                clamp_indirect: self.clamp_indirect,
            },
            strict: self.strict,
            lenient: self.lenient,
            editable: false,
        }
    }
}
