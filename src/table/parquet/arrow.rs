//! The metadata of fields in the schema that Arrow stores in a Parquet file. The schema is a flatbuffer in base64; no place outside its
//! bytes is read.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Fields within fields, at most.
const DEEPEST: u32 = 32;
/// Slots of the tables of Arrow's format: of a message its schema, of a schema its fields, and those of a field.
const HEADER: usize = 2;
const FIELDS: usize = 1;
const NAME: usize = 0;
const CHILDREN: usize = 5;
const METADATA: usize = 6;

/// The metadata of fields: the name of a field with a key, and the value. `None` if the schema is not understood.
pub(super) fn remarks_of_fields(schema: &str) -> Option<Vec<(String, String)>> {
    let bytes = STANDARD.decode(schema).ok()?;
    // newer files have a mark before the length
    let start = if bytes.get(..4)? == [0xff; 4] { 8 } else { 4 };
    let buffer = Buffer(bytes.get(start..)?);
    let message = buffer.behind(0)?;
    let schema = buffer.behind(buffer.slot(message, HEADER)?)?;
    let mut found = Vec::new();
    let mut left = buffer.0.len();
    let fields = buffer.slot(schema, FIELDS).map_or(Some(Vec::new()), |at| buffer.tables(at))?;
    fields.into_iter().try_for_each(|field| buffer.field(field, DEEPEST, &mut left, &mut found))?;
    Some(found)
}

struct Buffer<'b>(&'b [u8]);

impl Buffer<'_> {
    fn number(&self, at: usize) -> Option<usize> {
        let bytes = self.0.get(at..at.checked_add(4)?)?;
        usize::try_from(u32::from_le_bytes(bytes.try_into().ok()?)).ok()
    }

    /// Where an offset leads to.
    fn behind(&self, at: usize) -> Option<usize> {
        at.checked_add(self.number(at)?)
    }

    /// Where a table has the value of a slot, if it has one.
    fn slot(&self, table: usize, slot: usize) -> Option<usize> {
        let short = |at: usize| {
            let bytes = self.0.get(at..at.checked_add(2)?)?;
            Some(usize::from(u16::from_le_bytes(bytes.try_into().ok()?)))
        };
        let back = i64::from(i32::from_le_bytes(self.0.get(table..table.checked_add(4)?)?.try_into().ok()?));
        let slots = usize::try_from(i64::try_from(table).ok()?.checked_sub(back)?).ok()?;
        let entry = 4 + 2 * slot;
        let offset = if entry + 2 <= short(slots)? { short(slots.checked_add(entry)?)? } else { 0 };
        (offset > 0).then(|| table + offset)
    }

    /// The tables of a list.
    fn tables(&self, at: usize) -> Option<Vec<usize>> {
        let list = self.behind(at)?;
        let count = self.number(list).filter(|count| *count <= self.0.len() / 4)?;
        (0..count).map(|place| self.behind(list + 4 + 4 * place)).collect()
    }

    fn text(&self, at: usize) -> Option<String> {
        let text = self.behind(at)?;
        let bytes = self.0.get(text + 4..(text + 4).checked_add(self.number(text)?)?)?;
        Some(String::from_utf8_lossy(bytes).into_owned())
    }

    /// Adds the metadata of a field and of the fields within it. `left` bounds their number by the bytes of the schema.
    fn field(&self, field: usize, deepest: u32, left: &mut usize, found: &mut Vec<(String, String)>) -> Option<()> {
        *left = left.checked_sub(8)?;
        let text_at =
            |table: usize, slot: usize| self.slot(table, slot).map_or(Some(String::new()), |at| self.text(at));
        let name = text_at(field, NAME)?;
        let list = |slot: usize| self.slot(field, slot).map_or(Some(Vec::new()), |at| self.tables(at));
        for pair in list(METADATA)? {
            *left = left.checked_sub(8)?;
            found.push((format!("{name}: {}", text_at(pair, 0)?), text_at(pair, 1)?));
        }
        let children = list(CHILDREN)?;
        let deepest = if children.is_empty() { deepest } else { deepest.checked_sub(1)? };
        children.into_iter().try_for_each(|child| self.field(child, deepest, left, found))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `M: double` with `Einheit = in` and `r: struct<x: int64>` with `k = v` on x, as pyarrow writes it.
    const SCHEMA: &str = "/////0gBAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAIAAAC0AAAAFAAAABAAFAAIAAYABwAMAAAAEAAQAAAAAAABDRQAAAAcAAAABAAAAAEAAAAUAAAAAQAAAHIAAAAEAAQABAAAAKL///8AAAECFAAAAEQAAAAIAAAAEAAAAAAAAAABAAAAeAAAAAEAAAAEAAAAkP///xAAAAAEAAAAAQAAAHYAAAABAAAAawAAAAgADgAIAAcACAAAAAAAAAFAAAAAAAASABgACAAGAAcADAAAABAAFAASAAAAAAABAxQAAABQAAAACAAAABAAAAAAAAAAAQAAAE0AAAABAAAADAAAAAgADAAEAAgACAAAABAAAAAEAAAAAgAAAGluAAAHAAAARWluaGVpdAAAAAYACAAGAAYAAAAAAAIA";

    #[test]
    fn fields_say_what_they_are_said_to_be() {
        let found = remarks_of_fields(SCHEMA).unwrap();
        let said: Vec<_> = found.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        assert_eq!(said, ["M: Einheit = in", "x: k = v"]);
    }

    /// Whatever the bytes are, places outside of them are not read.
    #[test]
    fn bytes_that_are_changed_are_refused_or_read() {
        let bytes = STANDARD.decode(SCHEMA).unwrap();
        for at in 0..SCHEMA.len() {
            for other in ["A", "/", "8", "="] {
                let changed = SCHEMA[..at].to_owned() + other + &SCHEMA[at + 1..];
                let _ = remarks_of_fields(&changed);
            }
            let _ = remarks_of_fields(&SCHEMA[..at]);
        }
        assert!(bytes.len() > 300 && remarks_of_fields("").is_none());
    }
}
