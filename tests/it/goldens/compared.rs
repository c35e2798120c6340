//! Answers as files, and what differs between two of them.

use super::*;

pub(super) fn write(folder: &Path, answers: &Answers) {
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).unwrap();
    for (name, text) in answers {
        std::fs::write(folder.join(format!("{name}.txt")), text).unwrap();
    }
}

pub(super) fn read(folder: &Path) -> Answers {
    let files = std::fs::read_dir(folder).expect("tests/goldens has been written").map(|file| file.unwrap().path());
    let name = |file: &Path| file.file_stem().unwrap().to_str().unwrap().to_owned();
    files.map(|file| (name(&file), std::fs::read_to_string(&file).unwrap())).collect()
}

/// Every run by its file and command line.
fn runs(answers: &Answers) -> BTreeMap<(&str, &str), &str> {
    let mut runs = BTreeMap::new();
    for (name, text) in answers {
        for run in text.split("=== rackmesh ").skip(1) {
            let (command, output) = run.split_once('\n').unwrap();
            runs.insert((name.as_str(), command), output);
        }
    }
    runs
}

/// Prints every run that differs, the first ones with their lines, and fails if there is any.
pub(super) fn compare(stored: &Answers, answers: &Answers) {
    let (before, now) = (runs(stored), runs(answers));
    let keys: BTreeSet<_> = before.keys().chain(now.keys()).collect();
    let mut differing = 0;
    for key in &keys {
        let (kind, lines) = match (before.get(key), now.get(key)) {
            (Some(before), Some(now)) if before == now => continue,
            (Some(before), Some(now)) => (difference(before, now), differing_lines(before, now)),
            (Some(_), None) => ("not run any more".to_owned(), String::new()),
            (None, _) => ("not stored yet".to_owned(), String::new()),
        };
        differing += 1;
        println!("{}: rackmesh {}: {kind}", key.0, key.1);
        if differing <= SHOWN {
            print!("{lines}");
        }
    }
    assert!(differing == 0, "{differing} of {} answers are not those in tests/goldens", keys.len());
}

/// What kind of difference it is, and how large where only numbers differ.
fn difference(before: &str, now: &str) -> String {
    let exit = |text: &str| text.lines().next().unwrap_or_default().to_owned();
    if exit(before) != exit(now) {
        return format!("exit status `{}` is now `{}`", exit(before), exit(now));
    }
    let ((text_before, before), (text_now, now)) = (skeleton(before), skeleton(now));
    if text_before != text_now {
        return "the text differs".to_owned();
    }
    let (mut count, mut absolute, mut relative) = (0, 0.0_f64, 0.0_f64);
    for (a, b) in before.iter().zip(&now).filter(|(a, b)| a != b) {
        count += 1;
        absolute = absolute.max((a - b).abs());
        relative = relative.max((a - b).abs() / a.abs().max(b.abs()));
    }
    match count {
        0 => "only digests or spaces differ: something between the stored rows".to_owned(),
        _ => format!("{count} of {} numbers differ, by at most {absolute:.2e}, relatively {relative:.2e}", now.len()),
    }
}

/// The first lines that differ, from shortly before the difference.
fn differing_lines(before: &str, now: &str) -> String {
    let count = before.lines().count().max(now.lines().count());
    let padded = |text: &str| -> Vec<String> {
        text.lines().chain(std::iter::repeat("")).take(count).map(str::to_owned).collect()
    };
    let (before, now) = (padded(before), padded(now));
    let mut text = String::new();
    for (before, now) in before.iter().zip(&now).filter(|(before, now)| before != now).take(3) {
        let same = before.chars().zip(now.chars()).take_while(|(a, b)| a == b).count();
        for (sign, line) in [('-', before), ('+', now)] {
            let part: String = line.chars().skip(same.saturating_sub(60)).take(160).collect();
            text += &format!("  {sign} {part}\n");
        }
    }
    text
}

/// A text without its numbers, digests and repeated spaces, and its numbers. Digits within a word are no number.
pub(super) fn skeleton(text: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers, mut rest) = (String::new(), Vec::new(), text);
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let end = match first {
            '0'..='9' => number_length(rest),
            _ if is_word(first) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        let token = &rest[..end];
        if first.is_ascii_digit() {
            let negative = words.ends_with('-');
            if negative || words.ends_with('+') {
                words.pop();
            }
            let magnitude: f64 = token.parse().unwrap();
            numbers.push(if negative { -magnitude } else { magnitude });
            words.push('#');
        } else if token.starts_with("fnv_") {
            words += "fnv_";
        } else if token != " " || !words.ends_with(' ') {
            words += token;
        }
        rest = &rest[end..];
    }
    (words, numbers)
}

/// How many bytes the number has that a text starts with.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| from + text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end = if digits(end + 1) > end + 1 { digits(end + 1) } else { end };
    }
    let exponent = text[end..].strip_prefix('e').map_or(0, |rest| 1 + usize::from(rest.starts_with(['-', '+'])));
    if exponent > 0 && digits(end + exponent) > end + exponent { digits(end + exponent) } else { end }
}
