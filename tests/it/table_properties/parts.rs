//! Measured parts, before anybody writes them down: the errors with their units and nominal values, and the columns that are
//! no errors. What must come out of every table of them is computed here, by the quantities' own parser and nothing else.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use rackmesh::deviation::{DeviationKind, DeviationValue};
use rackmesh::quantity::{Angle, Length};

use super::words::{ANGLES, LENGTHS, Language, Title, UnitWord};

/// Parts at most.
pub const MOST_PARTS: usize = 12;
/// The largest deviation, mm and degrees.
const LARGEST: f64 = 0.5;
/// The rack's face width in every spec, mm.
pub const FACE_WIDTH_MM: f64 = 19.7;

/// A number as it was typed: `-12345` with three decimals is -12.345.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    pub digits: i64,
    pub decimals: usize,
}

impl Number {
    /// With a decimal point, and nothing else.
    pub fn plain(self) -> String {
        let digits = format!("{:0>width$}", self.digits.unsigned_abs(), width = self.decimals + 1);
        let (whole, decimals) = digits.split_at(digits.len() - self.decimals);
        let sign = if self.digits < 0 { "-" } else { "" };
        let point = if decimals.is_empty() { "" } else { "." };
        format!("{sign}{whole}{point}{decimals}")
    }
}

/// Where the nominal value stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NominalIn {
    Spec,
    Table,
}

/// What is measured minus this is the deviation.
#[derive(Debug, Clone, Copy)]
pub struct Nominal {
    pub digits: i64,
    pub stands_in: NominalIn,
}

/// Further columns about an error.
#[derive(Debug, Clone, Copy, Default)]
pub struct Companions {
    pub tolerances: bool,
    /// Only beside measured values.
    pub deviation: bool,
}

/// One error of every part.
#[derive(Debug, Clone)]
pub struct Measured {
    pub kind: DeviationKind,
    pub title: Title,
    pub unit: UnitWord,
    pub decimals: usize,
    /// In units of the last digit, one per part.
    pub deviations: Vec<i64>,
    pub nominal: Option<Nominal>,
    pub companions: Companions,
}

/// Parts and what was measured of them.
#[derive(Debug, Clone)]
pub struct Parts {
    pub language: Language,
    pub errors: Vec<Measured>,
    /// Empty if parts have no names.
    pub names: Vec<String>,
    /// The title of the names.
    pub name_title: &'static str,
    /// The context columns, by their place among those of the language.
    pub context: Vec<usize>,
    pub count: usize,
}

impl Measured {
    /// What a table holds of a part.
    pub fn value(&self, part: usize) -> Number {
        self.number(self.nominal.map_or(0, |nominal| nominal.digits) + self.deviations[part])
    }

    pub fn number(&self, digits: i64) -> Number {
        Number { digits, decimals: self.decimals }
    }

    /// The largest deviation, in units of the last digit.
    pub fn largest(&self) -> i64 {
        largest(self.unit, self.decimals)
    }

    fn quantity(&self, digits: i64) -> DeviationValue {
        let text = format!("{} {}", self.number(digits).plain(), self.unit.symbol);
        if self.unit.is_angle {
            DeviationValue::Angle(text.parse::<Angle>().unwrap())
        } else {
            DeviationValue::Length(text.parse::<Length>().unwrap())
        }
    }

    /// The deviation that must be read of a part.
    pub fn expected(&self, part: usize) -> DeviationValue {
        let nominal = self.nominal.map_or(0, |nominal| nominal.digits);
        match self.quantity(nominal + self.deviations[part]).less(self.quantity(nominal)) {
            // f_Hβ over the face width
            DeviationValue::Length(length) if self.kind == DeviationKind::RackLead => {
                DeviationValue::Slope(length.mm() / FACE_WIDTH_MM)
            }
            deviation => deviation,
        }
    }
}

impl Parts {
    /// The spec for these parts with a limit on the centre distance, mm, and perhaps one on each error.
    pub fn spec(&self, limit: &str, on_each: bool) -> String {
        let mut errors = String::new();
        let mut columns = String::new();
        let mut limits = format!("center_distance = \"±{limit}\"\n");
        for error in &self.errors {
            let key = error.kind.key();
            match error.nominal {
                Some(Nominal { digits, stands_in: NominalIn::Spec }) => {
                    let nominal = format!("{} {}", error.number(digits).plain(), error.unit.symbol);
                    errors += &format!("{key} = {{ nominal = {nominal:?} }}\n");
                }
                Some(_) => columns += &format!("{key} = {{ kind = \"measured\" }}\n"),
                None => columns += &format!("{key} = {{ kind = \"deviation\" }}\n"),
            }
            if on_each {
                limits += &format!("{key} = \"±{limit}\"\n");
            }
        }
        format!(
            "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[rack]\nface_width = {FACE_WIDTH_MM}\n\
             [pinion]\nteeth = 7\nhelix_angle = 25\n[limits]\n{limits}[errors]\n{errors}[batch.columns]\n{columns}"
        )
    }

    /// Whether every name starts with a letter, so that it can head a column.
    pub fn names_are_words(&self) -> bool {
        !self.names.is_empty() && self.names.iter().all(|name| name.starts_with(char::is_alphabetic))
    }
}

/// The largest deviation that is generated, in units of the last digit.
fn largest(unit: UnitWord, decimals: usize) -> i64 {
    let step = (0..decimals).fold(unit.size, |size, _| size / 10.0);
    (LARGEST / step) as i64
}

/// What an error is made of, so that it shrinks to something simple.
#[derive(Debug, Clone)]
struct Raw {
    title: Index,
    unit: Index,
    of_length: bool,
    decimals: usize,
    /// Ten-thousandths of the largest deviation.
    deviations: Vec<i64>,
    nominal: usize,
    nominal_at: i64,
    companions: u8,
}

prop_compose! {
    fn raw()(
        title in any::<Index>(),
        unit in any::<Index>(),
        of_length in any::<bool>(),
        decimals in 0..=4_usize,
        deviations in vec(-10_000..=10_000_i64, MOST_PARTS),
        nominal in 0..6_usize,
        nominal_at in 0..=10_000_i64,
        companions in 0..8_u8,
    ) -> Raw {
        Raw { title, unit, of_length, decimals, deviations, nominal, nominal_at, companions }
    }
}

impl Raw {
    fn error(self, kind: DeviationKind, language: Language, count: usize) -> Measured {
        let is_angle = kind == DeviationKind::RackLead && !self.of_length;
        let mut title = *self.title.get(language.titles(kind));
        // behind the name of an angle ″ is an arcsecond
        let is_possible = |unit: &&UnitWord| kind != DeviationKind::RackLead || is_angle || unit.spelling != "\u{2033}";
        let units: Vec<_> = if is_angle { ANGLES } else { LENGTHS }.iter().filter(is_possible).collect();
        let unit = **self.unit.get(&units);
        // enough decimals for a value that is not 0
        let decimals = (self.decimals..=9).find(|decimals| largest(unit, *decimals) > 0).unwrap();
        let largest = largest(unit, decimals);
        let is_slope = kind == DeviationKind::RackLead && !is_angle;
        let stands_in = match self.nominal {
            0 | 1 => Some(NominalIn::Spec),
            2 | 3 => Some(NominalIn::Table),
            _ => None,
        };
        let nominal = stands_in.filter(|_| !title.is_deviation && !is_slope).map(|stands_in| {
            // a measure is far larger than its deviation; in a table a nominal value may be 0, too
            let is_zero = stands_in == NominalIn::Table && self.nominal_at < 1000;
            let digits = if is_zero { 0 } else { largest * (30 + self.nominal_at / 100) + self.nominal_at % 10 };
            Nominal { digits, stands_in }
        });
        if nominal.is_none() && title.is_measured {
            title = language.titles(kind)[0];
        }
        let deviations = self.deviations.iter().take(count).map(|share| share * largest / 10_000).collect();
        let tolerances = self.companions & 1 > 0 && !is_slope;
        let deviation = self.companions & 2 > 0 && nominal.is_some();
        Measured { kind, title, unit, decimals, deviations, nominal, companions: Companions { tolerances, deviation } }
    }
}

prop_compose! {
    /// Any parts.
    pub fn parts()(
        count in 1..=MOST_PARTS,
        language in proptest::sample::select(Language::ALL.to_vec()),
        chosen in proptest::sample::subsequence(DeviationKind::OF_PAPER.to_vec(), 1..=DeviationKind::OF_PAPER.len()),
        raws in vec(raw(), DeviationKind::OF_PAPER.len()),
        naming in 0..6_usize,
        name_title in any::<Index>(),
        context in proptest::sample::subsequence(vec![0, 1, 2, 3, 4], 0..=3),
    ) -> Parts {
        let errors = chosen.iter().zip(raws).map(|(kind, raw)| raw.error(*kind, language, count)).collect();
        let name = |part: usize| match naming {
            1 => format!("{}", 17 + 3 * part),
            2 => format!("4711-{part:03}"),
            3 => format!("{} {}", language.part(), part + 1),
            4 => format!("SN{:05}", 815 + part),
            _ => format!("P{}", part + 1),
        };
        let names = if naming == 0 { Vec::new() } else { (0..count).map(name).collect() };
        Parts { language, errors, names, name_title: name_title.get::<&str>(language.part_names()), context, count }
    }
}
