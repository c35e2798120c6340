//! The command line: arguments in, a library call, a report out.
//!
//! One file per subcommand. This is the only module that reads files and prints.

mod batch;
mod budget;
mod calc;
mod class;
mod completions;
mod decision;
mod eval;
mod explain;
mod init;
mod long;
mod man;
mod measure;
mod mesh;
mod monte_carlo;
mod office;
mod output;
mod page;
mod paste;
mod picture;
mod read;
mod report;
mod reproduce;
mod schema;
mod set;
mod simulate;
mod stream;
mod tables;
mod target;
mod teeth;
mod terminal;

use std::process::ExitCode;

use clap::{Arg, ArgMatches, Args as _, ColorChoice, Command, FromArgMatches as _};

use output::{Failure, Output, Status};

const EXAMPLES: &str = "Examples:
  rackmesh init > rack.toml      write a commented spec to start from
  rackmesh eval rack.toml        ΔCD of every error in it, combined and judged
  rackmesh mesh rack.toml        ΔCD along the stroke, by the exact mesh
  rackmesh simulate rack.toml    the same with elastic teeth and forces
  rackmesh calc pitch 20um --pressure-angle 20
  rackmesh explain rack-pitch    the formula behind a number

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge, 3 indeterminate.";

type Run = fn(&ArgMatches, &mut Output) -> Result<Status, Failure>;

/// A subcommand: its name, what it does, its arguments, and how it is run.
struct Subcommand {
    name: &'static str,
    about: &'static str,
    arguments: fn(Command) -> Command,
    run: Run,
}

macro_rules! subcommand {
    ($name:literal, $module:ident) => {
        Subcommand {
            name: $name,
            about: $module::ABOUT,
            // a set of arguments taken in by another one would put its own description in place of the subcommand's
            arguments: |command| $module::Args::augment_args(command).about($module::ABOUT).long_about(None::<&str>),
            run: |matches, output| $module::Args::from_arg_matches(matches).map_err(Failure::Usage)?.run(output),
        }
    };
}

/// Every subcommand, in the order of the help.
const SUBCOMMANDS: &[Subcommand] = &[
    subcommand!("eval", eval),
    subcommand!("calc", calc),
    subcommand!("mesh", mesh),
    subcommand!("monte-carlo", monte_carlo),
    subcommand!("measure", measure),
    subcommand!("batch", batch),
    subcommand!("paste", paste),
    subcommand!("read", read),
    subcommand!("report", report),
    subcommand!("class", class),
    subcommand!("simulate", simulate),
    subcommand!("budget", budget),
    subcommand!("reproduce", reproduce),
    subcommand!("init", init),
    subcommand!("explain", explain),
    subcommand!("schema", schema),
    subcommand!("completions", completions),
    subcommand!("man", man),
];

/// The program's arguments. Those of a subcommand are built only when it is the one that is called (or
/// when its help, completions or manual page is made), which is a third of the start-up time.
fn command() -> Command {
    let mut command = Command::new("rackmesh")
        .about("How far manufacturing errors move the operating centre distance (ΔCD) of a rack and pinion")
        .version(env!("CARGO_PKG_VERSION"))
        .after_help(EXAMPLES)
        .subcommand_required(true)
        .arg_required_else_help(true)
        .arg(
            Arg::new("color")
                .long("color")
                .global(true)
                .value_name("WHEN")
                .help("When to use colours")
                .default_value("auto")
                .value_parser(clap::value_parser!(ColorChoice)),
        );
    for subcommand in SUBCOMMANDS {
        let arguments = Command::new(subcommand.name).about(subcommand.about).defer(subcommand.arguments);
        command = command.subcommand(arguments);
    }
    command
}

/// Runs the program with the process's own arguments.
#[must_use]
pub fn run() -> ExitCode {
    let matches = match command().try_get_matches() {
        Ok(matches) => matches,
        Err(error) => {
            // help and version go to standard output and are no failure; a closed pipe is none either
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let mut output = Output::new(matches.get_one("color").copied().unwrap_or(ColorChoice::Auto));
    let called = matches.subcommand().and_then(|(name, matches)| {
        let subcommand = SUBCOMMANDS.iter().find(|subcommand| subcommand.name == name)?;
        Some((subcommand.run)(matches, &mut output))
    });
    // a subcommand is required, so there always is one
    output.finish(called.unwrap_or(Ok(Status::Pass))).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_of_each_subcommand_begins_with_what_it_does() {
        for subcommand in SUBCOMMANDS {
            let mut command = (subcommand.arguments)(Command::new(subcommand.name));
            for help in [command.render_help(), command.render_long_help()] {
                let help = help.to_string();
                assert!(help.starts_with(subcommand.about), "{}: {help}", subcommand.name);
            }
        }
    }
}
