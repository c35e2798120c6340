//! The command line: arguments in, a library call, a report out.
//!
//! One file per subcommand. This is the only module that reads files and prints.

mod calc;
mod completions;
mod eval;
mod explain;
mod init;
mod man;
mod measure;
mod mesh;
mod output;
mod reproduce;
mod schema;

use std::io::Read as _;
use std::process::ExitCode;

use clap::{ColorChoice, CommandFactory, Parser, Subcommand};

use crate::diagnostic::{Code, Diagnostic};
use crate::spec::Spec;
use output::{Failure, Output};

/// How far manufacturing errors move the operating centre distance (ΔCD) of a rack and pinion.
#[derive(Debug, Parser)]
#[command(
    name = "rackmesh",
    version,
    arg_required_else_help = true,
    after_help = "Examples:
  rackmesh init > rack.toml      write a commented spec to start from
  rackmesh eval rack.toml        ΔCD of every error in it, combined and judged
  rackmesh calc pitch 20um --pressure-angle 20
  rackmesh explain rack-pitch    the formula behind a number

Exit status: 0 inside the limits or none given, 1 outside, 2 could not judge."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
    /// When to use colours.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    color: ColorChoice,
}

#[derive(Debug, Subcommand)]
enum Command {
    Eval(eval::Args),
    Calc(Box<calc::Args>),
    Mesh(mesh::Args),
    Measure(measure::Args),
    Reproduce(reproduce::Args),
    Init(init::Args),
    Explain(explain::Args),
    Schema(schema::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// Runs the program with the process's own arguments.
#[must_use]
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // help and version go to standard output and are no failure; a closed pipe is none either
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let mut output = Output::new(cli.color);
    let result = match cli.command {
        Command::Eval(args) => args.run(&mut output),
        Command::Calc(args) => args.run(&mut output),
        Command::Mesh(args) => args.run(&mut output),
        Command::Measure(args) => args.run(&mut output),
        Command::Reproduce(args) => args.run(&mut output),
        Command::Init(args) => args.run(&mut output),
        Command::Explain(args) => args.run(&mut output),
        Command::Schema(args) => args.run(&mut output),
        Command::Completions(args) => args.run(&mut output),
        Command::Man(args) => args.run(&mut output),
    };
    output.finish(result).into()
}

/// The program's arguments, as completions and manual pages describe them.
fn command() -> clap::Command {
    Cli::command()
}

/// The largest spec that is read: far beyond any that a person writes.
const LARGEST_SPEC: u64 = 16 << 20;

/// Reads and parses the spec at `path`; `-` is standard input.
fn read_spec(path: &str) -> Result<Spec, Failure> {
    let mut bytes = Vec::new();
    let (name, read) = if path == "-" {
        ("<stdin>", std::io::stdin().lock().take(LARGEST_SPEC + 1).read_to_end(&mut bytes))
    } else {
        let read = std::fs::File::open(path).and_then(|file| file.take(LARGEST_SPEC + 1).read_to_end(&mut bytes));
        (path, read)
    };
    let unreadable = |reason: String| Diagnostic::error(Code::FileAccess, format!("cannot read {name}: {reason}"));
    if let Err(error) = read {
        return Err(unreadable(error.to_string()).into());
    }
    if bytes.len() as u64 > LARGEST_SPEC {
        return Err(unreadable("it is larger than 16 MiB".to_owned()).into());
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Spec::parse(name, &text)?),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            Err(unreadable(format!("it is not text in UTF-8 (byte {at})")).into())
        }
    }
}
