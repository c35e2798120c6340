//! The command line: arguments in, a library call, a report out.
//!
//! One file per subcommand. This is the only module that reads files and prints.

mod answer;
mod bar;
mod batch;
mod budget;
mod calc;
mod class;
mod compare;
mod completions;
mod confirm;
mod decision;
mod eval;
mod explain;
mod function;
mod held;
mod init;
mod line;
mod man;
mod measure;
mod mesh;
mod monte_carlo;
mod office;
mod output;
mod page;
mod paste;
mod picture;
mod question;
mod read;
mod report;
mod reproduce;
mod results;
mod rows;
mod rows_format;
mod schema;
mod set;
mod signals;
mod simulate;
mod spec_files;
mod stream;
mod sweep;
mod tables;
mod target;
mod teeth;
mod terminal;
mod trace;
mod written;

use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;

use clap::{ArgAction, ArgMatches, Args as _, ColorChoice, Command, FromArgMatches as _};

pub use answer::{answer, compare, judged_spec};
pub use held::{Answer, ColumnTable, HeldSpec};
use output::{Failure, Output, Status, print_usage};

const EXAMPLES: &str = "Examples:
  rackmesh init > rack.toml         write a commented spec to start from
  rackmesh eval rack.toml           ΔCD of every error in it, combined and judged
  rackmesh mesh rack.toml           ΔCD along the stroke, by the exact mesh
  rackmesh simulate rack.toml       the same with elastic teeth and forces
  rackmesh monte-carlo rack.toml    the same of random racks
  rackmesh calc pitch 20um --pressure-angle 20
  rackmesh explain rack-pitch       the formula behind a number

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
            // a flattened set of arguments would replace the subcommand's description by its own
            arguments: |command| {
                let command = $module::Args::augment_args(command);
                with_short_help(command).about($module::ABOUT).long_about(None::<&str>)
            },
            run: |matches, output| $module::Args::from_arg_matches(matches).map_err(Failure::Usage)?.run(output),
        }
    };
}

/// The groups of subcommands in the help.
struct Group {
    heading: &'static str,
    subcommands: &'static [Subcommand],
}

/// Every subcommand, in the order of the help.
const GROUPS: &[Group] = &[
    Group {
        heading: "Judge parts",
        subcommands: &[
            subcommand!("eval", eval),
            subcommand!("batch", batch),
            subcommand!("paste", paste),
            subcommand!("read", read),
            subcommand!("report", report),
        ],
    },
    Group {
        heading: "Follow the teeth",
        subcommands: &[
            subcommand!("mesh", mesh),
            subcommand!("simulate", simulate),
            subcommand!("monte-carlo", monte_carlo),
            subcommand!("measure", measure),
        ],
    },
    Group {
        heading: "Design",
        subcommands: &[
            subcommand!("calc", calc),
            subcommand!("class", class),
            subcommand!("budget", budget),
            subcommand!("sweep", sweep),
            subcommand!("compare", compare),
        ],
    },
    Group {
        heading: "Start, and set up",
        subcommands: &[
            subcommand!("init", init),
            subcommand!("schema", schema),
            subcommand!("completions", completions),
            subcommand!("man", man),
        ],
    },
    Group {
        heading: "About the method",
        subcommands: &[subcommand!("explain", explain), subcommand!("reproduce", reproduce)],
    },
];

fn subcommands() -> impl Iterator<Item = &'static Subcommand> {
    GROUPS.iter().flat_map(|group| group.subcommands)
}

/// The help of the program, with its subcommands in groups.
fn help_template() -> String {
    let mut template = "{about}\n\n{usage-heading} {usage}\n".to_owned();
    for group in GROUPS {
        template.push_str(&format!("\n{}:\n", group.heading));
        for Subcommand { name, about, .. } in group.subcommands {
            template.push_str(&format!("  {name:<11}  {about}\n"));
        }
    }
    template + "\nOptions:\n{options}{after-help}"
}

/// Options that `-h` leaves out because they are rarely used, by their ids.
const SELDOM: &str = "model seed digits tolerance decimals columns rejects strict junit annotations threads partial \
                      first_rack study merge conforming distribution unit explain f_h_beta length no_worst_teeth worst_teeth only_failures";

/// A subcommand whose `-h` fits a screen; `--help` has all.
fn with_short_help(command: Command) -> Command {
    const MOST_EXAMPLES: usize = 3;
    let is_seldom = |argument: &clap::Arg| {
        let is_of_tables = argument.get_help_heading().is_some();
        is_of_tables || SELDOM.split_whitespace().any(|seldom| argument.get_id() == seldom)
    };
    let command = command.mut_subcommands(with_short_help).mut_args(|argument| {
        let is_hidden = is_seldom(&argument) || argument.is_hide_short_help_set();
        argument.hide_short_help(is_hidden)
    });
    let Some(all) = command.get_after_help().map(ToString::to_string) else { return command };
    let examples = all.split("\n\n").find(|part| part.starts_with("Example")).unwrap_or_default();
    let hidden = command.get_arguments().filter(|argument| argument.is_hide_short_help_set());
    let hidden: Vec<_> = hidden.filter_map(|argument| Some(format!("--{}", argument.get_long()?))).collect();
    let is_shown = |line: &&str| !line.split_whitespace().any(|word| hidden.iter().any(|option| option == word));
    let examples: Vec<_> = examples.lines().filter(is_shown).take(1 + MOST_EXAMPLES).collect();
    let examples = if examples.len() > 1 { examples.join("\n") } else { String::new() };
    command.after_help(examples).after_long_help(all)
}

/// The place of common options: behind a subcommand's own.
const LAST: usize = 1000;

// the options of every subcommand; without documentation, which would replace the program's own
#[derive(clap::Args)]
struct Global {
    /// Print help; --help has all of it.
    #[arg(long, short, global = true, display_order = LAST, action = ArgAction::Help)]
    help: Option<bool>,
    /// Show every remark on a result, not the first two.
    #[arg(long, short, global = true, display_order = LAST, conflicts_with = "quiet")]
    verbose: bool,
    /// Leave out remarks and progress; warnings and errors stay.
    #[arg(long, short, global = true, display_order = LAST)]
    quiet: bool,
    /// Put an apostrophe before texts in CSV that a spreadsheet would compute.
    #[arg(long, global = true, display_order = LAST, hide_short_help = true)]
    safe_csv: bool,
    /// When to use colours: auto, always or never.
    #[arg(long, global = true, display_order = LAST, value_name = "WHEN", default_value = "auto")]
    #[arg(hide_possible_values = true, hide_short_help = true)]
    color: ColorChoice,
}

/// The program's arguments. Those of a subcommand are built only when it is the one that is called (or
/// when its help, completions or manual page is made), which is a third of the start-up time.
#[must_use]
pub fn command() -> Command {
    let mut command = Global::augment_args(Command::new("rackmesh"))
        .about("How far manufacturing errors move the operating centre distance (ΔCD) of a rack and pinion")
        .version(env!("CARGO_PKG_VERSION"))
        .help_template(help_template())
        .after_long_help(EXAMPLES)
        .subcommand_required(true)
        .arg_required_else_help(true)
        .disable_help_flag(true);
    for subcommand in subcommands() {
        let arguments = Command::new(subcommand.name).about(subcommand.about).defer(subcommand.arguments);
        command = command.subcommand(arguments);
    }
    command
}

/// Runs the program with the process's own arguments.
#[must_use]
pub fn run() -> ExitCode {
    run_with(std::env::args_os()).into()
}

/// Runs the program with these arguments, the first of which is its name; the exit status.
#[must_use]
pub fn run_with(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let _watched = signals::watch();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let matches = command().try_get_matches_from(&arguments);
    let (Global { quiet, verbose, color, safe_csv, .. }, matches) =
        match matches.and_then(|found| Ok((Global::from_arg_matches(&found)?, found))) {
            Ok(matches) => matches,
            Err(error) => {
                let mut output = Output::new(ColorChoice::Auto, false, false);
                batch::report_of_usage(&arguments, &error, &mut output);
                target::end_reports(&output.errors());
                return printed(&set::with_settings(&arguments, error));
            }
        };
    let mut output = Output::new(color, quiet, safe_csv);
    output.show_all_remarks(verbose);
    let waiting = bar::Waiting::begin(matches.subcommand_name().unwrap_or_default(), &output);
    let called = called(&matches, &mut output);
    drop(waiting);
    // a subcommand is required, so there always is one
    let status = output.finish(called.unwrap_or(Ok(Status::Pass)));
    target::end_reports(&output.errors());
    for name in target::written() {
        output.remark(&format!("wrote {name}"));
    }
    for line in target::said() {
        output.message(&line);
    }
    status.code()
}

/// Prints the error in the arguments, or the help or the version. These are a failure only if they cannot be written, and not if
/// the pipe is closed.
fn printed(error: &clap::Error) -> u8 {
    let printed = print_usage(error).and_then(|()| std::io::stdout().flush());
    match printed {
        Err(failed) if !error.use_stderr() && failed.kind() != std::io::ErrorKind::BrokenPipe => {
            let mut output = Output::new(ColorChoice::Auto, false, false);
            output.finish(Err(target::named(output::STDOUT, &failed).into())).code()
        }
        _ => u8::try_from(error.exit_code()).unwrap_or(2),
    }
}

/// Runs the subcommand that is called.
fn called(matches: &ArgMatches, output: &mut Output) -> Option<Result<Status, Failure>> {
    let (name, matches) = matches.subcommand()?;
    let subcommand = subcommands().find(|subcommand| subcommand.name == name)?;
    Some((subcommand.run)(matches, output))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines_of_short_help(command: &mut Command, found: &mut Vec<(String, usize)>) {
        let mut alone = command.clone().term_width(80);
        found.push((command.get_name().to_owned(), alone.render_help().to_string().lines().count()));
        command.get_subcommands_mut().for_each(|inner| lines_of_short_help(inner, found));
    }

    #[test]
    fn the_short_help_fits_a_screen_and_the_long_one_has_all() {
        let mut command = command().disable_help_subcommand(true);
        command.build();
        let mut found = Vec::new();
        lines_of_short_help(&mut command, &mut found);
        let too_long: Vec<_> = found.iter().filter(|(_, lines)| *lines > 40).collect();
        assert!(found.len() > 20 && too_long.is_empty(), "{too_long:?}");
        let template = help_template();
        assert_eq!(template.lines().find(|line| line.chars().count() > 80), None);
        let batch = command.find_subcommand_mut("batch").expect("a subcommand");
        assert!(!batch.render_help().to_string().contains("--strict"));
        let help = batch.render_long_help().to_string();
        for argument in batch.get_arguments().filter_map(clap::Arg::get_long) {
            assert!(help.contains(&format!("--{argument}")), "{argument}");
        }
    }

    #[test]
    fn the_help_of_each_subcommand_begins_with_what_it_does() {
        for subcommand in subcommands() {
            let mut command = (subcommand.arguments)(Command::new(subcommand.name));
            for help in [command.render_help(), command.render_long_help()] {
                let help = help.to_string();
                assert!(help.starts_with(subcommand.about), "{}: {help}", subcommand.name);
            }
        }
    }
}
