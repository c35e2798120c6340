//! The words of headings and labels, and what each can mean: those of `vocabulary.txt`. What words mean together is told
//! elsewhere.

use std::collections::{BTreeSet, HashMap};
use std::sync::LazyLock;

use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};

use super::Field;
use super::letters::{fold, joined};

/// What a column says, of a table with a row per characteristic or beside a value; companions of a value come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Role {
    /// Measured minus nominal.
    Deviation,
    /// The nominal value.
    Nominal,
    /// The upper tolerance or limit, or the tolerance to both sides.
    Upper,
    /// The lower tolerance or limit.
    Lower,
    /// How uncertain the measured value is.
    Uncertainty,
    /// The unit of the row.
    Unit,
    /// The evaluation length of f_Hβ.
    Length,
    /// The measured value.
    Measured,
    /// Which part the row is of.
    Part,
    /// What was measured.
    Name,
    /// Whether the value is within its tolerance, or by how much it is not.
    Status,
}

impl Role {
    /// The key by which a contract names it.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Deviation => "deviation",
            Self::Nominal => "nominal",
            Self::Upper => "upper",
            Self::Lower => "lower",
            Self::Uncertainty => "uncertainty",
            Self::Unit => "unit",
            Self::Length => "length",
            Self::Measured => "actual",
            Self::Part => "part_id",
            Self::Name => "name",
            Self::Status => "status",
        }
    }

    /// That of a key.
    pub(crate) fn of_key(key: &str) -> Option<Self> {
        const ALL: [Role; 11] = [
            Role::Deviation,
            Role::Nominal,
            Role::Upper,
            Role::Lower,
            Role::Uncertainty,
            Role::Unit,
            Role::Length,
            Role::Measured,
            Role::Part,
            Role::Name,
            Role::Status,
        ];
        ALL.into_iter().find(|role| role.key() == key)
    }

    /// Whether it says something of a value that stands elsewhere.
    pub(crate) fn is_beside_value(self) -> bool {
        matches!(self, Self::Nominal | Self::Deviation | Self::Upper | Self::Lower | Self::Uncertainty)
    }
}

/// What a word can mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Sense {
    /// It names what is measured.
    #[serde(skip)]
    Name(&'static [Field]),
    /// It names what is measured, and that as a deviation.
    #[serde(skip)]
    Error(&'static [Field]),
    /// It names what is measured where no other word does.
    #[serde(skip)]
    Alone(&'static [Field]),
    /// Something else that is easily taken for it.
    #[serde(skip)]
    Near(&'static [Field]),
    Rack,
    Pinion,
    Left,
    Right,
    Deviation,
    Measured,
    Nominal,
    Upper,
    Lower,
    Plus,
    Minus,
    Tolerance,
    /// A tolerance if it is said which side.
    Limit,
    Uncertainty,
    Greatest,
    Least,
    /// The greatest of values, and no limit of them.
    Largest,
    /// It changes nothing.
    Filling,
    /// What no error is called.
    Context,
    /// It adds up over the teeth.
    Total,
    /// What a gear is, rather than what is wrong with it.
    Gear,
    /// It looks like a known word and is none.
    Other,
    /// What a column of a table with a row per characteristic is called.
    #[serde(skip)]
    Role(Role),
    /// The number of a line or of a part.
    Ordinal,
    #[serde(skip)]
    Number,
}

impl Sense {
    /// The sense of a row of the vocabulary: its name, and the keys of fields or the role behind it.
    fn of_row(meaning: &str) -> Option<Self> {
        let (word, names) = meaning.split_once(' ').unwrap_or((meaning, ""));
        // the vocabulary lives as long as the program
        let fields = || names.split(' ').map(|name| name.parse().ok()).collect::<Option<Vec<Field>>>().map(Vec::leak);
        match word {
            "name" => Some(Self::Name(fields()?)),
            "error" => Some(Self::Error(fields()?)),
            "alone" => Some(Self::Alone(fields()?)),
            "near" => Some(Self::Near(fields()?)),
            "role" => Role::deserialize(StrDeserializer::<Error>::new(names)).ok().map(Self::Role),
            word => Self::deserialize(StrDeserializer::<Error>::new(word)).ok(),
        }
    }

    /// Whether a heading with such a word names no field.
    pub(super) const fn is_foreign(self) -> bool {
        matches!(
            self,
            Self::Near(_)
                | Self::Least
                | Self::Context
                | Self::Total
                | Self::Gear
                | Self::Other
                | Self::Role(_)
                | Self::Ordinal
                | Self::Number
        )
    }
}

/// A word or phrase.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    /// Folded, without blanks.
    pub(super) letters: String,
    pub(super) senses: Vec<Sense>,
}

impl Entry {
    /// Whether it may be followed by letters that join it to the next word of a compound.
    pub(super) fn takes_link(&self) -> bool {
        self.letters.is_ascii() && self.letters.len() > 4
    }

    /// Whether it is Japanese, which has no blanks between words.
    pub(super) fn is_japanese(&self) -> bool {
        self.letters.chars().next().is_some_and(is_japanese)
    }
}

/// Whether it is a Japanese letter.
pub(super) fn is_japanese(c: char) -> bool {
    matches!(c, '\u{3041}'..='\u{30ff}' | '\u{4e00}'..='\u{9fff}')
}

/// Digits.
pub(super) static NUMBER: LazyLock<Entry> =
    LazyLock::new(|| Entry { letters: String::new(), senses: vec![Sense::Number] });

/// All words.
pub(super) static VOCABULARY: LazyLock<Vocabulary> = LazyLock::new(|| Vocabulary::of(include_str!("vocabulary.txt")));

/// Names and words that say one thing as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum WordList {
    /// Rows and columns beside the parts that are made of them.
    Statistic,
    /// Those of them that are no value of a part.
    Apart,
    /// So are those that add up the values, or count them.
    Sum,
    /// Those of them that are no larger than values are apart.
    Spread,
    /// Those of them that lie among the values.
    Mean,
    /// What counts how often a part was measured, or holds what was measured once more.
    Again,
    /// What calls a number in a remark a value, or says by how much one is off.
    CallsValue,
    /// What may stand beside it there, and says nothing.
    BesideValue,
    /// What a row is called that changes all values.
    Correction,
    /// What is wanted of a value, its size or a limit, and where it stands.
    Requirement,
    /// What names a part for good, whatever other number it has.
    Serial,
    /// What parts of one name may be told apart by.
    Batch,
    /// What numbers parts in a line above their values.
    PieceNumber,
    /// What tells one of several parts from the others there.
    OneOfSeveral,
    /// What counts rows, and names a part where nothing else does.
    RowNumber,
    /// What a title calls a report of measurements.
    Report,
    /// What a part is measured or paired with stands behind it, in a title.
    Mate,
    /// What a part is made for stands behind it, where another is named before.
    ToMate,
    /// That the part of which a line speaks is no part that was measured here.
    Elsewhere,
    /// Who measured.
    Person,
    /// What may be called by letters that say something else of parts: a machine `NC 3`.
    Place,
    /// Who measured, for whom, and what they say: words, and no numbers with decimals.
    Words,
    /// Who may measure a part once more.
    Verifier,
    /// What stands between a value and the temperature at which it was measured.
    At,
    /// That somebody is content with a value.
    Approval,
    /// That somebody is not.
    Disapproval,
    /// The faults of a machine, in a column.
    Fault,
    /// Whether a value counts or a part is good, that it is, and that it is not.
    Validity,
    Yes,
    Negation,
    /// That there is none of something, beside its name.
    NoneOfIt,
    /// That a paper counts for nothing unless somebody signed it.
    Paper,
    /// The diameter of the roller over which a rack is measured.
    Roller,
    /// The face width.
    FaceWidth,
    /// The normal module.
    NormalModule,
    /// The signs of numbers in another column.
    Sign,
    /// What stands between a name and its value.
    Verb,
    /// What else is measured of flanks.
    OtherFlank,
    /// The probe, in a line above a table.
    Probe,
    /// A line between the pages of a table.
    Page,
    /// The grade of an accuracy, below the teeth.
    Grade,
    /// How many teeth there are: a number without a unit.
    ToothCount,
    /// What a line calls the number of parts.
    PartCount,
    /// What may stand between a page's number and that of all.
    PageCount,
    /// What a database counts at the end of its answer.
    Rows,
    /// That values are no lengths or angles as they stand: by a factor, in parts of a tolerance, with the other sign.
    Scale,
    /// What a sheet is called that holds values beside nominal ones.
    Comparison,
    /// What says that values or a part do not count.
    Rejected,
    /// What says of values by how much they are off.
    Shift,
    /// What a line speaks of that states a unit for a whole table.
    UnitSubject,
    /// What says of a whole table that it is in inches.
    Imperial,
    /// What may stand between that and the unit.
    BeforeUnit,
    /// The length over which f_Hβ is evaluated.
    EvaluationLength,
    /// The unit of what is neither a length nor an angle.
    ForeignUnit,
}

impl WordList {
    /// The list that a row of the vocabulary is of.
    fn of_row(meaning: &str) -> Option<Self> {
        Self::deserialize(StrDeserializer::<Error>::new(&meaning.replace(' ', "_"))).ok()
    }

    /// Whether its names are those of columns, which are compared folded.
    pub(super) fn is_folded(self) -> bool {
        matches!(
            self,
            Self::Requirement
                | Self::Mate
                | Self::ToMate
                | Self::Elsewhere
                | Self::Serial
                | Self::Batch
                | Self::OneOfSeveral
                | Self::PieceNumber
                | Self::Person
                | Self::Words
                | Self::Verifier
                | Self::OtherFlank
                | Self::EvaluationLength
                | Self::Roller
                | Self::FaceWidth
                | Self::NormalModule
        )
    }
}

/// All words.
#[derive(Debug, Default)]
pub(super) struct Vocabulary {
    /// By their first letter.
    words: HashMap<char, Vec<Entry>>,
    lists: HashMap<WordList, BTreeSet<String>>,
}

impl Vocabulary {
    fn of(rows: &'static str) -> Self {
        let mut vocabulary = Self::default();
        for row in rows.lines().filter(|row| !row.starts_with('#')) {
            let Some((meaning, words)) = row.split_once("; ") else { continue };
            let words = words.split(", ");
            if let Some(list) = WordList::of_row(meaning) {
                let words = words.map(|word| if list.is_folded() { joined(word) } else { word.to_owned() });
                vocabulary.lists.entry(list).or_default().extend(words);
            } else if let Some(sense) = Sense::of_row(meaning) {
                words.for_each(|word| vocabulary.add(word, sense));
            } else {
                debug_assert!(false, "no meaning: {row}");
            }
        }
        vocabulary
    }

    fn add(&mut self, word: &str, sense: Sense) {
        let letters: String = fold(word).split_whitespace().collect();
        let Some(first) = letters.chars().next() else { return };
        let same_first = self.words.entry(first).or_default();
        match same_first.iter_mut().find(|entry| entry.letters == letters) {
            Some(entry) => entry.senses.push(sense),
            None => same_first.push(Entry { letters, senses: vec![sense] }),
        }
    }

    /// The words of a list.
    pub(super) fn list(&self, list: WordList) -> impl Iterator<Item = &String> {
        self.lists.get(&list).into_iter().flatten()
    }

    /// Whether a list has a word.
    pub(super) fn has(&self, list: WordList, word: &str) -> bool {
        self.lists.get(&list).is_some_and(|words| words.contains(word))
    }

    /// Whether one of its lists has a word.
    pub(super) fn lists(&self, word: &str) -> bool {
        self.lists.values().any(|words| words.contains(word))
    }

    /// The words that have the first letter of a text.
    pub(super) fn starting_like(&self, text: &str) -> &[Entry] {
        text.chars().next().and_then(|first| self.words.get(&first)).map_or(&[], Vec::as_slice)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Entry> {
        self.words.values().flatten()
    }
}
