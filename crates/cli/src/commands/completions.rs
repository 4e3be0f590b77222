//! `etendue completions` and `etendue man`: files for shells and for `man`.

use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

use crate::failure::{Failure, Status};
use crate::{arguments, terminal};

/// The arguments of `etendue completions`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Prints the completions of a shell.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let mut command = arguments::Arguments::command();
    let mut script = Vec::new();
    generate(arguments.shell, &mut command, "etendue", &mut script);
    terminal::result_bytes(&script)?;
    Ok(Status::Success)
}

/// Prints the manual page of all commands.
pub(crate) fn manual() -> Result<Status, Failure> {
    let unwritten = |error| Failure::failed(format!("cannot write the manual: {error}"));
    let mut command = arguments::Arguments::command();
    command.build();
    let mut page = Vec::new();
    let main = clap_mangen::Man::new(command.clone());
    main.render(&mut page).map_err(unwritten)?;
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        let title = format!("ETENDUE {}", sub.get_name().to_uppercase());
        let man = clap_mangen::Man::new(sub.clone());
        page.extend_from_slice(format!(".SH \"{title}\"\n").as_bytes());
        man.render_description_section(&mut page).map_err(unwritten)?;
        man.render_synopsis_section(&mut page).map_err(unwritten)?;
        man.render_options_section(&mut page).map_err(unwritten)?;
    }
    terminal::result_bytes(&page)?;
    Ok(Status::Success)
}
