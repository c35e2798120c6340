//! How far an error extends: over one tooth, a run of teeth, or all of them. Written by users, read by the bound.

use std::str::FromStr;

named! {
    /// On which teeth an error is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
    pub enum Extent {
        /// One space, one step between teeth, or one tooth; which one is not known.
        One = "one",
        /// A run of successive spaces, pitches or teeth.
        Part = "part",
        /// Every one, with the same value.
        All = "all",
        /// Every one, each with a value of its own, of either sign, within ± the value.
        Each = "each",
        /// Of a pitch: the total cumulative deviation F_p of either flank side, which deviate independently.
        Total = "total",
    }
}

named! {
    /// What an extent counts.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Countable {
        /// A space between teeth, for sizes.
        Space = "space",
        /// A step from tooth to tooth, for pitches.
        Pitch = "pitch",
        /// A tooth, for leads.
        Tooth = "tooth",
    }
}

/// A text that names no extent.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not an extent; write `one`, `part`, `all`, `each` or `total`")]
pub struct UnknownExtent {
    /// What was written.
    pub text: String,
}

impl Extent {
    /// Every extent.
    pub const EVERY: [Self; 5] = [Self::One, Self::Part, Self::All, Self::Each, Self::Total];

    /// Why an error cannot have an extent that does not fit.
    pub const NO_TOTAL: &str = "only a pitch has a total cumulative deviation";

    /// Whether an error that counts these can have the extent: only a pitch has a total.
    #[must_use]
    pub const fn fits(self, counted: Countable) -> bool {
        !matches!(self, Self::Total) || matches!(counted, Countable::Pitch)
    }

    /// The names of the extents that an error that counts these can have.
    #[must_use]
    pub fn names(counted: Countable) -> Vec<&'static str> {
        Self::EVERY.into_iter().filter(|extent| extent.fits(counted)).map(Self::name).collect()
    }

    /// In words: `one space`, `every pitch, any sign`. Where pitches add up, `in_contact` says how many at most.
    #[must_use]
    pub fn words(self, counted: Countable, in_contact: Option<u32>) -> String {
        let one = counted.name();
        let mut words = match self {
            Self::One => format!("one {one}"),
            Self::Part => format!("a run of {}", if one == "tooth" { "teeth".to_owned() } else { plural(one) }),
            Self::All => format!("every {one}"),
            Self::Each => format!("every {one}, any sign"),
            Self::Total => "in total, either flank side".to_owned(),
        };
        if let Some(count) =
            in_contact.filter(|&count| count > 1 && matches!(self, Self::Part | Self::All | Self::Each))
        {
            words.push_str(&format!(", up to {count} in contact"));
        }
        words
    }
}

fn plural(one: &str) -> String {
    format!("{one}{}", if one == "pitch" { "es" } else { "s" })
}

display_by_name!(Extent);

impl FromStr for Extent {
    type Err = UnknownExtent;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Self::EVERY.into_iter().find(|extent| extent.name() == text.trim());
        known.ok_or_else(|| UnknownExtent { text: text.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_are_read_as_they_are_named() {
        for extent in Extent::EVERY {
            assert_eq!(extent.name().parse(), Ok(extent));
        }
        assert_eq!("some".parse::<Extent>(), Err(UnknownExtent { text: "some".to_owned() }));
    }

    #[test]
    fn extents_in_words() {
        assert_eq!(Extent::One.words(Countable::Space, None), "one space");
        assert_eq!(Extent::One.words(Countable::Pitch, Some(3)), "one pitch");
        assert_eq!(Extent::All.words(Countable::Pitch, Some(3)), "every pitch, up to 3 in contact");
        assert_eq!(Extent::Each.words(Countable::Tooth, None), "every tooth, any sign");
        assert_eq!(Extent::Part.words(Countable::Tooth, None), "a run of teeth");
        assert_eq!(Extent::Part.words(Countable::Pitch, None), "a run of pitches");
    }
}
