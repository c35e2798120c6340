//! The deviations that the standards limit, with their symbols. Named by all files of standards; holds no values.

use std::fmt;

/// A deviation of a toothed wheel that a standard limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Deviation {
    /// Single pitch deviation f_pt (± in the standards).
    SinglePitch,
    /// Cumulative pitch deviation F_pk over an eighth of the teeth, F_pz/8.
    SectorPitch,
    /// Total cumulative pitch deviation F_p.
    TotalPitch,
    /// Profile form deviation f_fα.
    ProfileForm,
    /// Profile slope deviation f_Hα.
    ProfileSlope,
    /// Total profile deviation F_α.
    TotalProfile,
    /// Helix form deviation f_fβ.
    HelixForm,
    /// Helix slope deviation f_Hβ.
    HelixSlope,
    /// Total helix deviation F_β.
    TotalHelix,
    /// Runout F_r.
    Runout,
    /// Total radial composite deviation F_i''.
    RadialComposite,
    /// Tooth-to-tooth radial composite deviation f_i''.
    ToothRadialComposite,
}

impl Deviation {
    /// Every deviation.
    pub const ALL: [Self; 12] = [
        Self::SinglePitch,
        Self::SectorPitch,
        Self::TotalPitch,
        Self::ProfileForm,
        Self::ProfileSlope,
        Self::TotalProfile,
        Self::HelixForm,
        Self::HelixSlope,
        Self::TotalHelix,
        Self::Runout,
        Self::RadialComposite,
        Self::ToothRadialComposite,
    ];

    /// The symbol in letters that any file can hold: `f_Hbeta`.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::SinglePitch => "f_pt",
            Self::SectorPitch => "F_pz/8",
            Self::TotalPitch => "F_p",
            Self::ProfileForm => "f_falpha",
            Self::ProfileSlope => "f_Halpha",
            Self::TotalProfile => "F_alpha",
            Self::HelixForm => "f_fbeta",
            Self::HelixSlope => "f_Hbeta",
            Self::TotalHelix => "F_beta",
            Self::Runout => "F_r",
            Self::RadialComposite => "F_i''",
            Self::ToothRadialComposite => "f_i''",
        }
    }

    /// The symbol of its tolerance in the 2013 edition.
    pub(super) const fn tolerance_symbol(self) -> &'static str {
        match self {
            Self::SinglePitch => "f_pT",
            Self::SectorPitch => "F_pz/8T",
            Self::TotalPitch => "F_pT",
            Self::ProfileForm => "f_falphaT",
            Self::ProfileSlope => "f_HalphaT",
            Self::TotalProfile => "F_alphaT",
            Self::HelixForm => "f_fbetaT",
            Self::HelixSlope => "f_HbetaT",
            Self::TotalHelix => "F_betaT",
            Self::Runout => "F_rT",
            Self::RadialComposite => "F_i''T",
            Self::ToothRadialComposite => "f_i''T",
        }
    }

    /// The key that specs call it by: `f_h_beta`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::SinglePitch => "f_pt",
            Self::SectorPitch => "f_pz8",
            Self::TotalPitch => "f_p_total",
            Self::ProfileForm => "f_f_alpha",
            Self::ProfileSlope => "f_h_alpha",
            Self::TotalProfile => "f_alpha_total",
            Self::HelixForm => "f_f_beta",
            Self::HelixSlope => "f_h_beta",
            Self::TotalHelix => "f_beta_total",
            Self::Runout => "f_r",
            Self::RadialComposite => "f_i_total",
            Self::ToothRadialComposite => "f_i_tooth",
        }
    }

    /// The name that people read: `single pitch`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SinglePitch => "single pitch",
            Self::SectorPitch => "cumulative pitch over z/8",
            Self::TotalPitch => "total cumulative pitch",
            Self::ProfileForm => "profile form",
            Self::ProfileSlope => "profile slope",
            Self::TotalProfile => "total profile",
            Self::HelixForm => "helix form",
            Self::HelixSlope => "helix slope",
            Self::TotalHelix => "total helix",
            Self::Runout => "runout",
            Self::RadialComposite => "radial composite",
            Self::ToothRadialComposite => "tooth-to-tooth radial composite",
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
