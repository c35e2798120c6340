//! The kinds of problems and their documentation. Every diagnostic has one; `explain` prints its page, a test keeps
//! names unique.

/// Declares the codes: each has a variant, a stable name, and a page in `pages/`.
macro_rules! codes {
    ($($(#[$doc:meta])* $variant:ident = $name:literal,)*) => {
        /// A kind of problem, with a stable kebab-case name and a page that explains it.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Code {
            $($(#[$doc])* $variant,)*
        }

        impl Code {
            /// Every code.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The stable name.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// What it means and what to do, in Markdown.
            #[must_use]
            pub const fn page(self) -> &'static str {
                match self { $(Self::$variant => include_str!(concat!("pages/", $name, ".md"))),* }
            }
        }
    };
}

codes! {
        /// Arguments that together make no request.
    Usage = "usage",
    /// A file cannot be read or written.
    FileAccess = "file-access",
    /// The spec is not valid TOML.
    TomlSyntax = "toml-syntax",
    /// A key or section that the spec does not know.
    UnknownKey = "unknown-key",
    /// A value of the wrong type.
    WrongType = "wrong-type",
    /// A text that is not a length or an angle.
    BadQuantity = "bad-quantity",
    /// A value outside its domain.
    OutOfDomain = "out-of-domain",
    /// A value that no part has, or hardly any: a unit or a size may be mistaken.
    Implausible = "implausible",
        /// Teeth that cannot exist.
    BadGeometry = "bad-geometry",
        /// A key is missing that a requested result needs.
    MissingKey = "missing-key",
    /// An error entry whose keys do not make an error.
    BadErrorEntry = "bad-error-entry",
        /// A range of teeth that cannot be read, is empty or leaves the part.
    BadTeeth = "bad-teeth",
    /// A table of measured values that cannot be read.
    BadTable = "bad-table",
    /// A column or line that may be a measurement and is not understood.
    NotUnderstood = "not-understood",
    /// A pasted block that can be read in more than one way.
    AmbiguousBlock = "ambiguous-block",
        /// A row of a batch that cannot be read as a part.
    BadRow = "bad-row",
    /// A limit that is not a limit.
    BadLimit = "bad-limit",
    /// A class that has no permissible value.
    NoClass = "no-class",
        /// A name that no standard has.
    UnknownStandard = "unknown-standard",
    /// An uncertainty or a correlation that makes no sense.
    BadUncertainty = "bad-uncertainty",
        /// A decision rule that is not known, or lacks what it needs.
    BadRule = "bad-rule",
    /// A Monte Carlo simulation that cannot be made.
    NoMonteCarlo = "no-monte-carlo",
    /// A budget with nothing to distribute.
    NoBudget = "no-budget",
    /// There is nothing to evaluate.
    NoErrors = "no-errors",
    /// A limit on an error that is not given.
    UnjudgedLimit = "unjudged-limit",
    /// A result that has no value.
    NoResult = "no-result",
    /// A stroke without a solution of the exact mesh.
    NoMesh = "no-mesh",
    /// A simulation that cannot be set up, or that had to stop.
    NoSimulation = "no-simulation",
    /// A name that `explain` does not know.
    UnknownTopic = "unknown-topic",
}

display_by_name!(Code);

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_unique_and_kebab_case() {
        let names: BTreeSet<_> = Code::ALL.iter().map(|code| code.name()).collect();
        assert_eq!(names.len(), Code::ALL.len());
        for name in names {
            assert!(name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{name}");
        }
    }

    #[test]
    fn every_page_starts_with_its_code_and_says_what_to_do() {
        for code in Code::ALL {
            let page = code.page();
            assert!(page.starts_with(&format!("# {code}\n")), "{code}");
            for heading in ["## What is wrong", "## What to do"] {
                assert!(page.contains(heading), "{code} lacks {heading}");
            }
        }
    }
}
