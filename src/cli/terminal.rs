//! A block of values that a person pastes. On a terminal it extends to Ctrl-D, blank lines included, or to the terminal's mark for the
//! end of the paste: the shell would run unread lines as commands.

use std::io::{self, IsTerminal as _, Read, Write as _};
use std::sync::Arc;
use std::time::Duration;

use super::line;
use super::output::{Failure, Output, is_dumb};
use super::signals;
use super::stream::Stdin;
use crate::diagnostic::{Code, Diagnostic};
use crate::report::grouped;

/// The marks of a terminal before and behind a paste.
const PASTE_BEGINS: &[u8] = b"\x1b[200~";
const PASTE_ENDS: &[u8] = b"\x1b[201~";

/// A line of so many bytes may be the rest of a longer one: terminals cut lines.
const CUT: usize = if cfg!(target_os = "macos") { 1023 } else { 4095 };

/// The end of a typed block.
const END: &str = if cfg!(windows) { "Ctrl-Z and Enter" } else { "Ctrl-D" };

/// Reads the block from standard input, up to `largest` bytes, and leaves the rest there. If a signal comes first, it returns the
/// bytes so far; callers check for a signal before they use them.
pub(super) fn read_block(output: &mut Output, largest: u64, rest: &mut Option<Stdin>) -> Result<Vec<u8>, Failure> {
    let interruption = signals::signals(output);
    let stdin = rest.insert(Stdin::new(Arc::clone(interruption.stop())));
    let unread = |error: io::Error| Diagnostic::error(Code::FileAccess, format!("cannot read the block: {error}"));
    if !io::stdin().is_terminal() {
        let mut bytes = Vec::new();
        stdin.take(largest.saturating_add(1)).read_to_end(&mut bytes).map_err(unread)?;
        return if bytes.len() as u64 > largest { Err(too_large(largest)) } else { Ok(bytes) };
    }
    line::no_waiting();
    // the terminal is asked to mark pastes, which has to be switched off again
    let interruption = signals::interrupted(output);
    output.remark(&format!("Paste the values, then press {END} (on a line of its own):"));
    let marked = MarkedPaste::ask_for();
    let typed = Typed::read(stdin, largest, || once_more(output));
    drop(marked);
    let typed = typed.map_err(unread)?;
    if typed.bytes.ends_with(PASTE_ENDS) {
        // the terminal shows the mark, and goes on behind it
        output.remark("");
    }
    if interruption.came() { Ok(typed.bytes) } else { typed.checked(largest) }
}

/// Reads a block that was typed ahead to its end; it is not used.
pub(super) fn discard_block(output: &mut Output) {
    /// What was typed ahead is there by then.
    const AHEAD: Duration = Duration::from_millis(100);
    if !io::stdin().is_terminal() {
        return;
    }
    let interruption = signals::interrupted(output);
    let mut stdin = Stdin::new(Arc::clone(interruption.stop()));
    if stdin.comes_within(AHEAD) {
        output.remark(&format!("(what is typed up to {END} is not used)"));
        // an error here adds nothing to the failure that was reported
        let _ = Typed::read(stdin, 0, || once_more(output));
    }
}

/// Asks a question on a terminal; `None` if there is no more to read. `rest` is the text after a block.
pub(super) fn ask(
    question: &str,
    answers: &[&str],
    rest: &mut Option<Stdin>,
    output: &mut Output,
) -> Result<Option<String>, Failure> {
    line::no_waiting();
    let mut is_new = false;
    let mut is_asked = false;
    loop {
        if !std::mem::replace(&mut is_asked, true) {
            output.message(&format!("{question} [{}]", answers.join("/")));
        }
        let stdin = rest.get_or_insert_with(|| {
            is_new = true;
            Stdin::new(Arc::clone(signals::signals(output).stop()))
        });
        let mut answer = vec![0; CUT];
        let count = stdin.read(&mut answer)?;
        if count == 0 {
            // Ctrl-D ended the block, and what is typed behind it comes
            if is_new {
                return Ok(None);
            }
            *rest = None;
            continue;
        }
        let answer = String::from_utf8_lossy(&unmarked(&answer[..count])).trim().to_owned();
        if answers.contains(&answer.as_str()) {
            return Ok(Some(answer));
        }
        is_asked = false;
    }
}

fn once_more(output: &mut Output) {
    output.remark("");
    output.remark(&format!("(press {END} once more to end)"));
}

fn too_large(largest: u64) -> Failure {
    let message = format!("cannot read the block: it is larger than {} bytes", grouped(largest));
    Diagnostic::error(Code::FileAccess, message).help("`rackmesh batch` reads files of any size").into()
}

/// As long as it is there, the terminal marks where a paste begins and ends.
struct MarkedPaste;

impl MarkedPaste {
    fn ask_for() -> Option<Self> {
        let can = cfg!(unix) && io::stderr().is_terminal() && !is_dumb();
        can.then(|| {
            Self::say(b"\x1b[?2004h");
            Self
        })
    }

    fn say(what: &[u8]) {
        // without the request a terminal marks nothing, which is acceptable
        let _ = io::stderr().lock().write_all(what);
    }
}

impl Drop for MarkedPaste {
    fn drop(&mut self) {
        Self::say(b"\x1b[?2004l");
    }
}

/// The input from a terminal.
#[derive(Debug, Default)]
struct Typed {
    /// The first bytes, up to the limit.
    bytes: Vec<u8>,
    /// The number of all bytes.
    count: u64,
}

impl Typed {
    /// Reads to the end, also beyond the limit. A terminal hands over a line at a time; `unfinished` is called once when it hands over
    /// less: Ctrl-D was pressed in an unfinished line, where it ends nothing.
    fn read(mut terminal: impl Read, largest: u64, mut unfinished: impl FnMut()) -> io::Result<Self> {
        let mut typed = Self::default();
        let mut said = false;
        let mut line = vec![0; 1 << 16];
        loop {
            let count = terminal.read(&mut line)?;
            let line = &line[..count];
            let room = largest.saturating_sub(typed.count).min(count as u64);
            typed.bytes.extend_from_slice(&line[..usize::try_from(room).unwrap_or(count)]);
            typed.count += count as u64;
            let text = line.strip_suffix(b"\n");
            if count == 0 || text.unwrap_or(line).ends_with(PASTE_ENDS) {
                return Ok(typed);
            }
            if text.is_none() && !std::mem::replace(&mut said, true) {
                unfinished();
            }
        }
    }

    /// The block without the terminal's marks, if it is whole.
    fn checked(self, largest: u64) -> Result<Vec<u8>, Failure> {
        if self.count > largest {
            return Err(too_large(largest));
        }
        if self.bytes.split(|byte| *byte == b'\n').any(|line| line.len() >= CUT) {
            let message = format!("a line of the block has {} bytes or more, which terminals cut", grouped(CUT as u64));
            let help = "save the block as a file and give that, or pipe it in: `rackmesh paste rack.toml < values.txt`";
            return Err(Diagnostic::error(Code::FileAccess, message).help(help).into());
        }
        Ok(unmarked(&self.bytes))
    }
}

/// The bytes without the terminal's marks.
fn unmarked(bytes: &[u8]) -> Vec<u8> {
    let mut kept = Vec::with_capacity(bytes.len());
    let mut rest = bytes;
    while let Some((first, after)) = rest.split_first() {
        let mark = [PASTE_BEGINS, PASTE_ENDS].into_iter().find_map(|mark| rest.strip_prefix(mark));
        if mark.is_none() {
            kept.push(*first);
        }
        rest = mark.unwrap_or(after);
    }
    kept
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    /// A terminal that hands over one of these at a time.
    struct Lines(VecDeque<Vec<u8>>);

    impl Lines {
        fn new(lines: &[&str]) -> Self {
            Self(lines.iter().map(|line| line.as_bytes().to_vec()).collect())
        }
    }

    impl Read for Lines {
        fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
            let line = self.0.pop_front().unwrap_or_default();
            out[..line.len()].copy_from_slice(&line);
            Ok(line.len())
        }
    }

    struct Outcome {
        block: Result<Vec<u8>, Failure>,
        /// How often Ctrl-D was asked for once more.
        asked: usize,
        /// Lines that were not read.
        left: usize,
    }

    impl Outcome {
        fn text(self) -> String {
            String::from_utf8(self.block.unwrap()).unwrap()
        }

        fn message(self) -> String {
            match self.block {
                Err(Failure::Diagnostics(diagnostics)) => diagnostics[0].to_string(),
                _ => String::new(),
            }
        }
    }

    fn read(lines: &[&str], largest: u64) -> Outcome {
        let mut terminal = Lines::new(lines);
        let mut asked = 0;
        let typed = Typed::read(&mut terminal, largest, || asked += 1).unwrap();
        Outcome { block: typed.checked(largest), asked, left: terminal.0.len() }
    }

    #[test]
    fn blank_lines_belong_to_the_block() {
        let outcome = read(&["\n", "Hello,\n", "\n", "\n", "dp 12\n", "", "ls\n"], 100);
        assert_eq!((outcome.asked, outcome.left), (0, 1));
        assert_eq!(outcome.text(), "\nHello,\n\n\ndp 12\n");
    }

    #[test]
    fn a_line_without_an_end_is_ended_by_the_second_ctrl_d() {
        let outcome = read(&["dp 1", "2\n", "13", ""], 100);
        assert_eq!(outcome.asked, 1);
        assert_eq!(outcome.text(), "dp 12\n13");
    }

    #[test]
    fn the_end_of_a_marked_paste_is_the_end() {
        for (end, text) in [("\x1b[201~\n", "\n"), ("\x1b[201~", ""), ("14\x1b[201~", "14")] {
            let outcome = read(&["\x1b[200~dp\n", "\n", "12\n", end, "ls\n"], 100);
            assert_eq!((outcome.asked, outcome.left), (0, 1), "{end:?}");
            assert_eq!(outcome.text(), format!("dp\n\n12\n{text}"));
        }
        // where something is typed behind it the block goes on
        assert_eq!(read(&["\x1b[200~12\x1b[201~, 13\n", "14\n"], 100).text(), "12, 13\n14\n");
    }

    #[test]
    fn what_is_refused_is_read_to_its_end() {
        let refused = read(&["12\n", "13\n", "14\n", ""], 8);
        assert_eq!(refused.left, 0);
        assert!(refused.message().contains("larger than 8 bytes"));
        assert_eq!(read(&["12\n", "13\n", "14\n", ""], 9).text(), "12\n13\n14\n");
    }

    #[test]
    fn a_line_that_may_have_been_cut_is_refused() {
        let line = |length: usize| "7".repeat(length) + "\n";
        assert!(read(&[&line(CUT - 1)], 10_000).block.is_ok());
        assert!(read(&["12\n", &line(CUT)], 10_000).message().contains("which terminals cut"));
    }
}
