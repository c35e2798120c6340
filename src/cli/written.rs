//! Writes a contract into a spec: the rest of the text does not change, and existing entries are not written again. `[batch]` becomes
//! `[table]`.

use std::collections::HashSet;

use toml_edit::{Array, DocumentMut, Item, Key, TableLike, Value};

use crate::diagnostic::{Code, Diagnostic};

/// What stands before a line that is a guess.
const GUESS: &str = "# a guess: ";

/// The date and the version that writes.
pub(super) fn stamp() -> String {
    let today = chrono::Utc::now().date_naive();
    format!("# rackmesh {}, {today}", env!("CARGO_PKG_VERSION"))
}

/// The remark that a contract which was written into a spec leaves something to a person.
pub(super) fn not_all(name: &str) -> String {
    format!("{name}: not all has an owner yet: what stands there as a comment is for you to say")
}

/// The text of a spec with the lines of a contract; the same text if it has them all.
///
/// # Errors
/// If the text is not TOML, or its `table` is not a table.
pub(super) fn merged(name: &str, spec: &str, block: &str, stamp: &str) -> Result<String, Diagnostic> {
    let plain = spec.replace("\r\n", "\n");
    let cannot = |what: &str| {
        let message = format!("cannot write the contract into {name}: {what}");
        Diagnostic::error(Code::FileAccess, message).help("paste the [table] that `rackmesh read` shows")
    };
    let mut document: DocumentMut = plain.parse().map_err(|_| cannot("it is no TOML"))?;
    let new: DocumentMut = block.parse().map_err(|_| cannot("its texts cannot stand in TOML"))?;
    if document.to_string().trim_end() != plain.trim_end() {
        return Err(cannot("it cannot be edited without changing more of it"));
    }
    let is_renamed = !document.contains_key("table") && document.contains_key("batch");
    if is_renamed {
        let batch = document.remove("batch").unwrap_or_default();
        document.insert("table", batch);
    }
    let Some(table) = document.get_mut("table") else {
        let gap = if plain.is_empty() || plain.ends_with("\n\n") { "" } else { "\n" };
        let end = if plain.is_empty() || plain.ends_with('\n') { "" } else { "\n" };
        let text = format!("{plain}{end}{gap}{stamp}\n{block}");
        return Ok(with_line_ends(as_it_ends(&text, &plain), spec));
    };
    let Some(table) = table.as_table_like_mut() else { return Err(cannot("its `table` is no table")) };
    let mut is_changed = is_renamed;
    for (key, item) in new.get("table").and_then(Item::as_table_like).into_iter().flat_map(TableLike::iter) {
        is_changed |= put(table, (key, None), item);
    }
    let lines: Vec<&str> = block.lines().map(str::trim).collect();
    // what is said of a line that is no comment goes with that line
    let is_alone = |at: usize| !lines.get(at + 1).is_some_and(|next| next.starts_with('#'));
    let is_said = |at: usize| lines[at].starts_with(GUESS) && is_alone(at);
    let is_new = |at: &usize| lines[*at].starts_with('#') && !is_said(*at) && !plain.contains(lines[*at]);
    let comments: Vec<&str> = (0..lines.len()).filter(is_new).map(|at| lines[at]).collect();
    if let Some(Item::Table(table)) = document.get_mut("table").filter(|_| is_changed || !comments.is_empty()) {
        let before = table.decor().prefix().and_then(|prefix| prefix.as_str()).unwrap_or_default();
        let lines: String = std::iter::once(stamp).chain(comments).flat_map(|line| [line, "\n"]).collect();
        let prefix = if before.contains(stamp) { lines.replacen(&format!("{stamp}\n"), "", 1) } else { lines };
        let prefix = format!("{before}{prefix}");
        table.decor_mut().set_prefix(prefix);
    } else if !is_changed {
        return Ok(spec.to_owned());
    }
    let text = document.to_string();
    Ok(with_line_ends(as_it_ends(&format!("{}\n", text.strip_suffix('\n').unwrap_or(&text)), &plain), spec))
}

/// A text that ends in a line end, or without one, as another does.
fn as_it_ends<'t>(text: &'t str, like: &str) -> &'t str {
    if like.is_empty() || like.ends_with('\n') { text } else { text.strip_suffix('\n').unwrap_or(text) }
}

/// Adds the missing entries of an item; returns whether there were any.
///
/// A new item keeps what is said of it as a guess, which stands before its key.
fn put(table: &mut dyn TableLike, (key, written): (&str, Option<&Key>), item: &Item) -> bool {
    let Some(there) = table.get_mut(key) else {
        let mut item = item.clone();
        if let Item::Table(table) = &mut item {
            table.set_position(None);
        }
        let said = written.and_then(|key| key.leaf_decor().prefix()?.as_str()?.lines().last());
        let mut key = Key::new(key);
        if let Some(said) = said.filter(|line| line.starts_with(GUESS)) {
            key.leaf_decor_mut().set_prefix(format!("{said}\n"));
        }
        table.entry_format(&key).or_insert(item);
        return true;
    };
    if let (Some(there), Some(new)) = (there.as_array_mut(), item.as_array()) {
        return extend(there, new);
    }
    let Some(new) = item.as_table_like() else { return false };
    // "Teil" is { name = "Teil" }
    if there.is_str() && new.contains_key("name") {
        return false;
    }
    let Some(entries) = there.as_table_like_mut() else { return false };
    let mut is_changed = false;
    for (key, item) in new.iter() {
        is_changed |= put(entries, (key, new.key(key)), item);
    }
    if let Some(there) = there.as_inline_table_mut().filter(|_| is_changed) {
        there.fmt();
    }
    is_changed
}

/// Adds the missing entries of a list, laid out like its last one.
fn extend(there: &mut Array, new: &Array) -> bool {
    let bare = |value: &Value| value.clone().decorated("", "").to_string();
    let mut is_changed = false;
    let known: HashSet<String> = there.iter().map(bare).collect();
    for value in new.iter().filter(|value| !known.contains(&bare(value))) {
        let prefix = there.iter().last().and_then(|last| last.decor().prefix()?.as_str().map(str::to_owned));
        let indent = prefix.filter(|prefix| prefix.contains('\n')).map(|prefix| {
            let start = prefix.rfind('\n').unwrap_or(0);
            prefix[start..].to_owned()
        });
        let first = if there.is_empty() { "" } else { " " };
        there.push_formatted(value.clone().decorated(indent.unwrap_or_else(|| first.to_owned()), ""));
        is_changed = true;
    }
    is_changed
}

/// A text with the line ends of another one: lines of that text keep their own, new lines get the most frequent.
fn with_line_ends(text: &str, like: &str) -> String {
    let count = like.matches("\r\n").count();
    if count == 0 {
        return text.to_owned();
    }
    let usual = if count * 2 > like.matches('\n').count() { "\r\n" } else { "\n" };
    let mut old = like.split_inclusive('\n');
    let mut ended = String::new();
    for line in text.split_inclusive('\n') {
        let Some(bare) = line.strip_suffix('\n') else {
            ended += line;
            continue;
        };
        let same = |old: &&str| old.trim_end_matches(['\r', '\n']) == bare;
        let mut rest = old.clone();
        let found = rest.find(same).filter(|_| !bare.is_empty()).or_else(|| old.clone().next().filter(same));
        if found.is_some() {
            while old.next().is_some_and(|line| !same(&line)) {}
        }
        let own = found.filter(|old| old.ends_with('\n')).map(|old| if old.ends_with("\r\n") { "\r\n" } else { "\n" });
        ended += bare;
        ended += own.unwrap_or(usual);
    }
    ended
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const BLOCK: &str = "[table]\nignore = [\"Temp\"]\nignore_lines = [\n  \"Datum: 1\",\n  # a guess: x:\n  # \"Datum: #\",\n]\n\
                         [table.columns]\npart_id = \"Teil\"\n# a guess: z:\nrack_pitch = { name = \"fp\", unit = \"um\" }\n\
                         # a guess: y:\n# status = { name = \"Bew\" }\n";

    fn merge(spec: &str) -> String {
        merged("rack.toml", spec, BLOCK, "# stamp").unwrap()
    }

    #[test]
    fn a_spec_without_a_contract_gets_one_at_its_end() {
        assert_eq!(merge("[pair]\nx = 1 # one"), format!("[pair]\nx = 1 # one\n\n# stamp\n{}", BLOCK.trim_end()));
        assert_eq!(merge(""), format!("# stamp\n{BLOCK}"));
        assert_eq!(merge("a = 1\r\n\r\n"), format!("a = 1\n\n# stamp\n{BLOCK}").replace('\n', "\r\n"));
    }

    #[test]
    fn a_batch_becomes_the_contract() {
        assert_eq!(
            merged(
                "rack.toml",
                "[batch] # b\nignore = [\"a\"]\n[batch.columns]\npart_id = \"x\" # c\n[pair]\n",
                "[table]\nignore = [\"b\"]\n",
                "# s"
            )
            .unwrap(),
            "# s\n[table] # b\nignore = [\"a\", \"b\"]\n[table.columns]\npart_id = \"x\" # c\n[pair]\n"
        );
    }

    #[test]
    fn a_contract_gets_what_it_lacks() {
        let spec = "# mine\n[table] # here\nignore = [\n  \"Kraft\", # N\n  \"Temp\",\n]\n\n[table.columns]\n\
                    rack_pitch = { unit = \"um\" }   # as drawn\n[limits]\n";
        assert_eq!(
            merge(spec),
            "# mine\n# stamp\n# a guess: x:\n# \"Datum: #\",\n# a guess: y:\n# status = { name = \"Bew\" }\n[table] # here\n\
             ignore = [\n  \"Kraft\", # N\n  \"Temp\",\n]\nignore_lines = [\n  \"Datum: 1\",\n  # a guess: x:\n  # \"Datum: #\",\n]\n\n\
             [table.columns]\nrack_pitch = { unit = \"um\", name = \"fp\" }   # as drawn\npart_id = \"Teil\"\n[limits]\n"
        );
    }

    proptest! {
        #[test]
        fn nothing_else_changes_and_once_is_enough(
            lines in proptest::collection::vec("[a-z#\" =]{0,8}", 0..6),
            ends in proptest::collection::vec(any::<bool>(), 6),
            has_table in any::<bool>(),
        ) {
            let ends = ends.iter().map(|crlf| if *crlf { "\r\n" } else { "\n" });
            let mut spec: String = lines.iter().zip(ends).flat_map(|(line, end)| ["# ", line, end]).collect();
            if has_table {
                spec += "[table]\r\nignore = [\"Kraft\"]\r\n";
            }
            let once = merge(&spec);
            prop_assert_eq!(&merge(&once), &once);
            let kept: Vec<&str> = spec.split_inclusive('\n').filter(|line| line.starts_with('#')).collect();
            let mut rest = once.split_inclusive('\n');
            for line in kept {
                prop_assert!(rest.any(|other| other == line), "{:?} of {:?} in {:?}", line, spec, once);
            }
        }
    }
}
