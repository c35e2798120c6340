//! The outcome of a limit in words, for reports and for the column `reason` of batches.

use super::limits::{Bounds, Check, Judged, Target};
use crate::judge::Verdict;
use crate::quantity::{signed, tidy};

impl Target {
    /// A value without its unit: forces to 0.1 N, the others to four decimals.
    #[must_use]
    pub fn in_words(self, value: f64) -> String {
        let decimals = if self == Self::LiftOffForce { 1 } else { 4 };
        signed(tidy(value), decimals).trim_start_matches('+').to_owned()
    }
}

impl Bounds {
    /// The permitted values in words: `at most 0.1 mm`.
    #[must_use]
    pub fn in_words(&self, unit: &str) -> String {
        match (self.lower, self.upper) {
            (Some(lower), Some(upper)) => format!("{lower} … {upper} {unit}"),
            (None, Some(upper)) => format!("at most {upper} {unit}"),
            (Some(lower), None) => format!("at least {lower} {unit}"),
            (None, None) => "none".to_owned(),
        }
    }
}

impl Check {
    /// The outcome of the limit in a sentence; `scope` says where it was judged.
    #[must_use]
    pub fn sentence(&self, scope: &str) -> String {
        let (what, unit) = (self.on.words(), self.on.unit());
        let limit = self.bounds.in_words(unit);
        match &self.judged {
            Judged::Values(values) => {
                let [smallest, largest] = values.map(|value| self.on.in_words(value));
                let shown = if smallest == largest { largest } else { format!("{smallest} … {largest}") };
                let came = match self.beyond() {
                    _ if self.verdict == Some(Verdict::Pass) => "is within the limit".to_owned(),
                    by if by > 0.0 => format!("leaves the limit by {} {unit}", self.on.in_words(by)),
                    _ => "leaves the limit".to_owned(),
                };
                format!("{what}: {shown} {unit} {came} ({limit}; {scope})")
            }
            Judged::NoSetting => {
                format!("{what}: no position of the plug keeps {limit}, because ΔCD varies by more ({scope})")
            }
            Judged::SomeSetting => format!("{what}: a position of the plug keeps {limit} ({scope})"),
            _ => self.open_because().unwrap_or_default(),
        }
    }

    /// Why the limit is open; `None` for a limit that is met or broken.
    #[must_use]
    pub fn open_because(&self) -> Option<String> {
        let why = match &self.judged {
            Judged::Lacks(keys) => format!("not judged without {}", keys.join(", ")),
            Judged::NoUncertainty => {
                "not judged by this rule, because the uncertainty of the yoke's play and forces is not known".to_owned()
            }
            Judged::NotMeasured => {
                "not judged, because flanks that carry on the travel, or where the play is set, were not measured"
                    .to_owned()
            }
            Judged::Unsolved => "not judged, because some strokes are not solved".to_owned(),
            Judged::Rolls => "not judged for a rack that may roll".to_owned(),
            Judged::NotProven => {
                "not proven: the bound of ΔCD is too wide for a pass, and no placement that was found fails; measured teeth decide it".to_owned()
            }
            Judged::Values(_) | Judged::NoSetting | Judged::SomeSetting => return None,
        };
        Some(format!("{}: {why}", self.on.words()))
    }

    /// Why the limit is not met; `None` for a limit that is met.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        match self.verdict {
            Some(Verdict::Pass) => None,
            Some(_) => Some(self.sentence("over the travel")),
            None => self.open_because(),
        }
    }
}
