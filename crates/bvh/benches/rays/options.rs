//! The command line.

use crate::workload::Kind;
use etendue_bvh::BuildOptions;
use std::error::Error;

/// The options.
pub(crate) struct Options {
    /// The file of triangles; generated hills without one.
    pub(crate) triangles: Option<String>,
    pub(crate) embree: Option<String>,
    pub(crate) rounds: usize,
    pub(crate) preset: BuildOptions,
    pub(crate) kinds: Vec<Kind>,
    pub(crate) json: bool,
    /// Also trace this many rays at a time.
    pub(crate) batch: Option<usize>,
}

impl Options {
    /// Parses the arguments after the program's name.
    pub(crate) fn parse(
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Self, Box<dyn Error>> {
        let mut options = Self {
            triangles: None,
            embree: None,
            rounds: 8,
            preset: BuildOptions::default(),
            kinds: Kind::ALL.to_vec(),
            json: false,
            batch: None,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            match argument.as_str() {
                "--embree" => options.embree = Some(value()?),
                "--rounds" => options.rounds = value()?.parse()?,
                "--preset" => options.preset = preset(&value()?)?,
                "--kind" => {
                    let name = value()?;
                    options.kinds.retain(|kind| kind.name() == name);
                }
                "--batch" => options.batch = Some(value()?.parse::<usize>()?.max(1)),
                "--json" => options.json = true,
                // Cargo passes this to every benchmark.
                "--bench" => {}
                path => options.triangles = Some(path.to_owned()),
            }
        }
        if options.kinds.is_empty() || options.rounds == 0 {
            return Err("usage: rays [TRIANGLES] [--embree LIBRARY] [--rounds COUNT] \
                        [--preset NAME] [--kind NAME] [--json] [--batch COUNT]"
                .into());
        }
        Ok(options)
    }
}

fn preset(name: &str) -> Result<BuildOptions, String> {
    match name {
        "fast" => Ok(BuildOptions::FAST),
        "balanced" => Ok(BuildOptions::BALANCED),
        "spatial" => Ok(BuildOptions::SPATIAL),
        _ => Err(format!("unknown preset `{name}`; the presets are fast, balanced and spatial")),
    }
}
