//! Permissible deviations of toothed wheels: accuracy standards, one file per standard and edition.
//!
//! The spec calls this for an error that is given as a class, the command line for `class`, and the Monte
//! Carlo of random parts for the width of their deviations. It takes the sizes of a wheel ([`Wheel`]) and gives
//! a [`Permissible`] value with all that it follows from: standard, edition, grade, ranges, the value before and
//! after rounding. It does not extrapolate, and it does not choose a diameter: these standards grade toothed
//! wheels and name no racks, so the user chooses the diameter that stands for a rack.
//!
//! | standard | file | deviations | grades |
//! |---|---|---|---|
//! | ISO 1328-1:1995 | `iso_1328_1_1995.rs` | pitch, profile, helix | 0 … 12 |
//! | ISO 1328-2:1997 | `iso_1328_2_1997.rs` | runout, radial composite | 4 … 12 |
//! | ISO 1328-1:2013 | `iso_1328_1_2013.rs` | pitch, profile, helix, runout | 1 … 11 |
//! | DIN 3962:1978 | `din_3962.rs` | pitch, helix; the cells that are confirmed | by cell |
//! | JIS B 1702-1976 | `jis_b_1702_1976.rs` | pitch | 0 … 8 |
//!
//! # How a value is made
#![doc = include_str!("method.md")]
//!
//! # Exactness
//! Values are computed in double precision and put on the grid of lengths (1e-9 µm) before they are rounded, so that a
//! value exactly half way between two steps is recognised. A size on the limit of a range belongs to the lower range.
//!
//! ```
//! use rackmesh::standard::{Deviation, Standard, Wheel};
//!
//! let wheel = Wheel {
//!     normal_module: Some("21".parse()?),
//!     diameter: Some("378".parse()?),
//!     face_width: Some("550".parse()?),
//!     teeth: Some(18),
//!     helix_angle: None,
//! };
//! let pitch = Standard::Iso1328Part1Of1995.permissible(Deviation::SinglePitch, 6, &wheel)?;
//! assert_eq!(pitch.value_um(), 18.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod deviation;
mod din_3962;
mod error;
mod formula;
mod iso_1328_1_1995;
mod iso_1328_1_2013;
mod iso_1328_2_1997;
mod jis_b_1702_1976;
mod permissible;
mod range;
mod rounding;
#[cfg(test)]
mod tests;

pub use deviation::Deviation;
pub use error::{StandardError, UnknownStandard};
pub use permissible::{Permissible, RangeUse, Remark};
pub use range::SizeRange;

use std::ops::RangeInclusive;
use std::str::FromStr;

use crate::quantity::{Angle, Length};
use formula::Formula;

named! {
    /// A standard and its edition.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Standard {
        /// ISO 1328-1:1995, the same as ANSI/AGMA ISO 1328-1.
        Iso1328Part1Of1995 = "ISO 1328-1:1995",
        /// ISO 1328-2:1997.
        Iso1328Part2Of1997 = "ISO 1328-2:1997",
        /// ISO 1328-1:2013, the same as DIN ISO 1328-1:2018.
        Iso1328Part1Of2013 = "ISO 1328-1:2013",
        /// DIN 3962-1 and DIN 3962-2, of 1978.
        Din3962 = "DIN 3962:1978",
        /// JIS B 1702-1976.
        JisB1702Of1976 = "JIS B 1702-1976",
    }
}

impl Standard {
    /// Its name in specs, arguments and results, and its grades.
    const fn row(self) -> (&'static str, RangeInclusive<u8>) {
        match self {
            Self::Iso1328Part1Of1995 => ("iso1328-1:1995", 0..=12),
            Self::Iso1328Part2Of1997 => ("iso1328-2:1997", 4..=12),
            Self::Iso1328Part1Of2013 => ("iso1328-1:2013", 1..=11),
            // few of its cells are confirmed
            Self::Din3962 => ("din3962:1978", 1..=12),
            Self::JisB1702Of1976 => ("jisb1702:1976", 0..=8),
        }
    }

    /// Its name in specs, arguments and results: `iso1328-1:1995`.
    #[must_use]
    pub const fn id(self) -> &'static str {
        self.row().0
    }

    /// Its grades, the finest first. DIN 3962 has 1 to 12; few of its cells are confirmed.
    #[must_use]
    pub const fn grades(self) -> RangeInclusive<u8> {
        self.row().1
    }

    /// The other part of the same system, whose values are given beside this one's.
    #[must_use]
    pub const fn companion(self) -> Option<Self> {
        match self {
            Self::Iso1328Part1Of1995 => Some(Self::Iso1328Part2Of1997),
            _ => None,
        }
    }

    /// Its formulas; empty for a standard that has tables.
    const fn formulas(self) -> &'static [Formula] {
        match self {
            Self::Iso1328Part1Of1995 => iso_1328_1_1995::FORMULAS,
            Self::Iso1328Part2Of1997 => iso_1328_2_1997::FORMULAS,
            Self::Iso1328Part1Of2013 => iso_1328_1_2013::FORMULAS,
            Self::Din3962 | Self::JisB1702Of1976 => &[],
        }
    }

    /// The deviations for which it gives permissible values here.
    #[must_use]
    pub fn deviations(self) -> Vec<Deviation> {
        match self {
            Self::Din3962 => din_3962::DEVIATIONS.to_vec(),
            Self::JisB1702Of1976 => jis_b_1702_1976::DEVIATIONS.to_vec(),
            _ => self.formulas().iter().map(|formula| formula.deviation).collect(),
        }
    }

    /// The one that limits a deviation: this standard or its companion.
    #[must_use]
    pub fn that_limits(self, deviation: Deviation) -> Option<Self> {
        [Some(self), self.companion()].into_iter().flatten().find(|one| one.deviations().contains(&deviation))
    }

    /// The symbol of a deviation; in the 2013 edition with the T of tolerance.
    #[must_use]
    pub const fn symbol(self, deviation: Deviation) -> &'static str {
        match self {
            Self::Iso1328Part1Of2013 => deviation.tolerance_symbol(),
            _ => deviation.symbol(),
        }
    }

    /// The permissible value of a deviation, µm, by the formulas or tables of the standard.
    ///
    /// # Errors
    /// [`StandardError`] if the standard has no such grade or deviation, if a size that it needs is missing,
    /// or if one lies outside the standard's scope.
    pub fn permissible(self, deviation: Deviation, grade: u8, wheel: &Wheel) -> Result<Permissible, StandardError> {
        if !self.grades().contains(&grade) {
            return Err(StandardError::Grade { standard: self, grade });
        }
        if self == Self::Iso1328Part1Of2013 {
            iso_1328_1_2013::check_scope(wheel)?;
        }
        match self {
            Self::Din3962 => din_3962::permissible(deviation, grade, wheel),
            Self::JisB1702Of1976 => jis_b_1702_1976::permissible(deviation, grade, wheel),
            _ => formula::permissible(self, self.formulas(), deviation, grade, wheel),
        }
    }

    /// The sizes that the permissible values of a grade depend on and the wheel lacks.
    #[must_use]
    pub fn sizes_missing(self, grade: u8, wheel: &Wheel) -> Vec<Size> {
        self.sizes_missing_for(&self.deviations(), grade, wheel)
    }

    /// The sizes that the permissible values of these deviations depend on and the wheel lacks.
    #[must_use]
    pub fn sizes_missing_for(self, deviations: &[Deviation], grade: u8, wheel: &Wheel) -> Vec<Size> {
        let (mut wheel, mut missing) = (wheel.clone(), Vec::new());
        let lacks = |wheel: &Wheel| {
            let errors = deviations.iter().map(|deviation| self.permissible(*deviation, grade, wheel));
            errors.filter_map(Result::err).find_map(|error| match error {
                StandardError::Missing { size, .. } => Some(size),
                _ => None,
            })
        };
        while let Some(size) = lacks(&wheel).filter(|size| !missing.contains(size)) {
            missing.push(size);
            // with any value here, the next size that is missing shows
            match size {
                Size::NormalModule => wheel.normal_module = Length::from_mm(2.0).ok(),
                Size::Diameter => wheel.diameter = Length::from_mm(50.0).ok(),
                Size::FaceWidth => wheel.face_width = Length::from_mm(20.0).ok(),
                Size::Teeth => wheel.teeth = Some(20),
                Size::HelixAngle => wheel.helix_angle = Some(Angle::ZERO),
            }
        }
        missing
    }
}

display_by_name!(Standard);

/// Reads a standard's name in any of its spellings: `iso1328-1:1995`, `ISO 1328-1:1995`, `ANSI/AGMA ISO 1328-1`,
/// `DIN ISO 1328-1:2018`, `JIS B 1702-1976`.
impl FromStr for Standard {
    type Err = UnknownStandard;

    fn from_str(text: &str) -> Result<Self, UnknownStandard> {
        let letters: String = text.chars().filter(char::is_ascii_alphanumeric).collect();
        Ok(match letters.to_ascii_lowercase().as_str() {
            "iso132811995" | "ansiagmaiso13281" | "agmaiso13281" | "ansiagmaiso13281a01" => Self::Iso1328Part1Of1995,
            "iso132821997" | "ansiagmaiso13282" => Self::Iso1328Part2Of1997,
            // the American edition of 2014 is that of 2013
            "iso132812013" | "diniso132812018" | "eniso132812013" | "ansiagmaiso13281b14" => Self::Iso1328Part1Of2013,
            "din3962" | "din39621978" | "din39621" | "din39622" | "din396211978" | "din396221978" => Self::Din3962,
            "jisb17021976" | "jisb1702" => Self::JisB1702Of1976,
            _ => return Err(UnknownStandard { text: text.to_owned() }),
        })
    }
}

/// The known sizes of a toothed wheel, with which formulas and tables are entered.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wheel {
    /// Normal module m_n.
    pub normal_module: Option<Length>,
    /// Reference diameter d; for a rack, the diameter that its user chose.
    pub diameter: Option<Length>,
    /// Face width b.
    pub face_width: Option<Length>,
    /// Number of teeth z.
    pub teeth: Option<u32>,
    /// Helix angle β.
    pub helix_angle: Option<Angle>,
}

/// A size of a toothed wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Size {
    /// m_n
    NormalModule,
    /// d
    Diameter,
    /// b
    FaceWidth,
    /// z
    Teeth,
    /// β
    HelixAngle,
}

impl Size {
    /// Its name, its unit as it stands behind a number, and its key.
    const fn row(self) -> [&'static str; 3] {
        match self {
            Self::NormalModule => ["normal module m_n", " mm", "normal_module"],
            Self::Diameter => ["reference diameter d", " mm", "diameter"],
            Self::FaceWidth => ["face width b", " mm", "face_width"],
            Self::Teeth => ["number of teeth z", "", "teeth"],
            Self::HelixAngle => ["helix angle β", "°", "helix_angle"],
        }
    }

    /// Its name: `face width b`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row()[0]
    }

    /// Its unit as it stands behind a number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.row()[1]
    }

    /// Its key in results: `face_width`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.row()[2]
    }
}

impl Wheel {
    /// A size in mm, degrees or teeth; `None` if it is not known.
    #[must_use]
    pub fn size(&self, size: Size) -> Option<f64> {
        match size {
            Size::NormalModule => self.normal_module.map(Length::mm),
            Size::Diameter => self.diameter.map(Length::mm),
            Size::FaceWidth => self.face_width.map(Length::mm),
            Size::Teeth => self.teeth.map(f64::from),
            Size::HelixAngle => self.helix_angle.map(Angle::degrees),
        }
    }
}
