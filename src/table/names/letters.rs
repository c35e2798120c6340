//! The letters of a name, however they are written: blanks, `_`, `-`, case and accents tell nothing, so that `Rack-Pitch`,
//! `rackPitch` and `RACK PITCH` are the same. Called by everything that compares names.

/// A text in lower case, without accents, with blanks between words and nothing but letters and digits in them; a mark that says
/// more is a word of its own.
pub(super) fn fold(text: &str) -> String {
    let chars: Vec<char> = plain_widths(text).trim_start_matches(is_bullet).replace("(s)", "s").chars().collect();
    let mut out = String::with_capacity(text.len() + 8);
    for (index, &c) in chars.iter().enumerate() {
        let before = index.checked_sub(1).map(|index| chars[index]);
        let after = chars.get(index + 1).copied();
        if before.is_some_and(|before| starts_word(before, c)) {
            out.push(' ');
        }
        match c {
            '+' if after == Some('/') || after == Some('-') => out.push_str(" ± "),
            '±' => out.push_str(" ± "),
            '+' => out.push_str(" + "),
            '-' | '\u{2212}' | '\u{207b}' | '\u{2010}'..='\u{2015}' if is_sign(before, after) => out.push_str(" - "),
            c if c == '#' || says_more(c) => out.extend([' ', c, ' ']),
            c => fold_letter(c, &mut out),
        }
    }
    // an umlaut may be written as two letters
    let mut before = ' ';
    out.retain(|c| !(matches!(std::mem::replace(&mut before, c), 'a' | 'o' | 'u') && c == 'e'));
    out
}

/// Whether a mark says more than letters do: a question, a relation, a rejection. No word of the vocabulary has one.
pub(crate) fn says_more(c: char) -> bool {
    // an empty set or a difference stands for Ø and Δ, and what is ticked is as it should be
    let is_harmless = matches!(c, '∅' | '∆' | '\u{2212}' | '∙' | '✓' | '✔' | '☑' | '✅');
    let is_symbol =
        matches!(c, '\u{2190}'..='\u{22ff}' | '\u{25a0}'..='\u{27bf}' | '\u{2900}'..='\u{2bff}' | '\u{1f000}'..);
    is_symbol && !is_harmless || matches!(c, '?' | '!' | '~' | '〜' | '¬' | '×' | '÷')
}

/// Whether a mark may stand before each line of a list: an arrow or a geometric figure.
fn is_bullet(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\u{2190}'..='\u{21ff}' | '\u{25a0}'..='\u{25ff}' | '\u{2794}'..='\u{27bf}')
}

/// A text as names are compared that are no words of the vocabulary: folded, with a blank between words.
pub(super) fn joined(text: &str) -> String {
    fold(text).replace(['_', '-'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a capital follows a small letter (`rackPitch`), or a digit a letter or the reverse.
fn starts_word(before: char, c: char) -> bool {
    (before.is_lowercase() && c.is_uppercase())
        || (before.is_alphabetic() && c.is_ascii_digit())
        || (before.is_ascii_digit() && c.is_alphabetic())
}

/// Whether a dash is a minus rather than a hyphen: `-Tol`, `- Tol`, `Tol -`, `Tol-`.
fn is_sign(before: Option<char>, after: Option<char>) -> bool {
    let blank = |c: Option<char>| c.is_none_or(|c| c.is_whitespace() || matches!(c, '[' | '('));
    let last = after.is_none_or(|c| matches!(c, '[' | '('));
    match before {
        None => true,
        Some('/' | '+') => false,
        before if blank(before) => !blank(after) || last,
        _ => blank(after),
    }
}

fn fold_letter(c: char, out: &mut String) {
    for c in c.to_lowercase() {
        match c {
            'à' | 'á' | 'â' | 'ä' => out.push('a'),
            'è' | 'é' | 'ê' | 'ë' => out.push('e'),
            'î' | 'ï' | 'í' => out.push('i'),
            'ô' | 'ö' | 'ó' | 'œ' => out.push('o'),
            'ù' | 'û' | 'ü' | 'ú' => out.push('u'),
            'ç' => out.push('c'),
            'ß' => out.push_str("ss"),
            'α' => out.push_str("alpha"),
            'β' => out.push_str("beta"),
            'δ' | '∆' => out.push_str("delta "),
            '№' => out.push_str("no"),
            // ローラ and ローラー are the same word; accents that follow their letter say nothing either
            'ー' | '\u{300}'..='\u{36f}' => {}
            c if c.is_alphanumeric() => out.push(c),
            _ => out.push(' '),
        }
    }
}

/// Full-width letters as plain ones, half-width katakana as full ones, their marks joined to them.
pub(crate) fn plain_widths(text: &str) -> String {
    const KATAKANA: &str = "ヲァィゥェォャュョッーアイウエオカキクケコサシスセソタチツテトナニヌネノハヒフヘホマミムメモヤユヨラリルレロワン";
    let katakana = |c: char| KATAKANA.chars().nth(c as usize - 0xff66);
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{ff9e}' | '\u{3099}' | '\u{ff9f}' | '\u{309a}' => {
                let step = if matches!(c, '\u{ff9e}' | '\u{3099}') { 1 } else { 2 };
                let last = out.chars().next_back().filter(|last| ('\u{3041}'..='\u{30ff}').contains(last));
                if let Some(joined) = last.and_then(|last| char::from_u32(last as u32 + step)) {
                    out.pop();
                    out.push(joined);
                }
            }
            '\u{ff01}'..='\u{ff5e}' => out.extend(char::from_u32(c as u32 - 0xfee0)),
            '\u{ff66}'..='\u{ff9d}' => out.extend(katakana(c)),
            '\u{3000}' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_the_same_however_they_are_written() {
        for (text, folded) in [
            ("Rollenmaß", "rollenmass"),
            ("ROLLENMASS", "rollenmass"),
            ("Zahnlu\u{308}cke", "zahnlucke"),
            ("Zahnluecke", "zahnlucke"),
            ("RackPitch", "rack pitch"),
            ("Ｍ　（ｍｍ）", "m mm"),
            ("ﾋﾟｯﾁ誤差", "ピッチ誤差"),
            ("ローラー", "ロラ"),
            ("Écart d'hélice", "ecart d helice"),
            ("Δβ", "delta beta"),
            ("roller(s)", "rollers"),
            ("Tol +", "tol +"),
            ("-Tol", "- tol"),
            ("- Tol", "- tol"),
            ("Tol-", "tol -"),
            ("+/-", "±"),
            ("Soll-Ist", "soll ist"),
            ("Pitch - rack", "pitch rack"),
        ] {
            let words: Vec<_> = fold(text).split_whitespace().map(str::to_owned).collect();
            assert_eq!(words.join(" "), folded, "{text}");
        }
    }
}
