//! `cargo xtask gallery`.

use clap::Args;

#[derive(Args, Debug)]
pub(crate) struct Arguments {}

pub(crate) fn run(_arguments: &Arguments) -> Result<(), String> {
    Ok(())
}
