//! Lines that fit a screen. Called by whoever shows text there.

/// Characters that take room: all but escape sequences for colours.
fn visible(word: &str) -> usize {
    let mut parts = word.split('\u{1b}');
    let first = parts.next().map_or(0, |text| text.chars().count());
    first + parts.map(|rest| rest.split_once('m').map_or(0, |(_, text)| text.chars().count())).sum::<usize>()
}

/// Breaks text at blanks to fit `width`, if there is one. Lines keep their indent.
#[must_use]
pub fn wrap(text: &str, width: Option<u16>) -> String {
    let Some(width) = width else { return text.to_owned() };
    let width = usize::from(width.max(20));
    let lines: Vec<_> = text.split('\n').map(|line| wrapped(line, width)).collect();
    lines.join("\n")
}

fn wrapped(line: &str, width: usize) -> String {
    let indent = line.len() - line.trim_start_matches(' ').len();
    let mut out = line[..indent].to_owned();
    let mut column = indent;
    for (place, word) in line[indent..].split(' ').enumerate() {
        let length = visible(word);
        if column > indent && column + 1 + length > width {
            out.truncate(out.trim_end_matches(' ').len());
            out.push('\n');
            out.push_str(&line[..indent]);
            column = indent;
        } else if column == indent && word.is_empty() {
            // blanks at a break
            continue;
        } else if place > 0 && column > indent {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_take_no_room() {
        assert_eq!(visible("\u{1b}[1m\u{1b}[32mPASS\u{1b}[0m:"), 5);
        assert_eq!(
            wrap("\u{1b}[1mPASS\u{1b}[0m: the limit is met by far", Some(20)),
            "\u{1b}[1mPASS\u{1b}[0m: the limit is\nmet by far"
        );
    }
}
