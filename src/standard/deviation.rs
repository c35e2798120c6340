//! The deviations that the standards limit, with their symbols. Named by all files of standards; holds no values.

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

    /// Its symbol in letters that any file can hold, that of its tolerance, its key, its name.
    const fn names(self) -> [&'static str; 4] {
        match self {
            Self::SinglePitch => ["f_pt", "f_pT", "f_pt", "single pitch"],
            Self::SectorPitch => ["F_pz/8", "F_pz/8T", "f_pz8", "cumulative pitch over z/8"],
            Self::TotalPitch => ["F_p", "F_pT", "f_p_total", "total cumulative pitch"],
            Self::ProfileForm => ["f_falpha", "f_falphaT", "f_f_alpha", "profile form"],
            Self::ProfileSlope => ["f_Halpha", "f_HalphaT", "f_h_alpha", "profile slope"],
            Self::TotalProfile => ["F_alpha", "F_alphaT", "f_alpha_total", "total profile"],
            Self::HelixForm => ["f_fbeta", "f_fbetaT", "f_f_beta", "helix form"],
            Self::HelixSlope => ["f_Hbeta", "f_HbetaT", "f_h_beta", "helix slope"],
            Self::TotalHelix => ["F_beta", "F_betaT", "f_beta_total", "total helix"],
            Self::Runout => ["F_r", "F_rT", "f_r", "runout"],
            Self::RadialComposite => ["F_i''", "F_i''T", "f_i_total", "radial composite"],
            Self::ToothRadialComposite => ["f_i''", "f_i''T", "f_i_tooth", "tooth-to-tooth radial composite"],
        }
    }

    /// The symbol in letters that any file can hold: `f_Hbeta`.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        self.names()[0]
    }

    /// The symbol of its tolerance in the 2013 edition.
    pub(super) const fn tolerance_symbol(self) -> &'static str {
        self.names()[1]
    }

    /// The key that specs call it by: `f_h_beta`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.names()[2]
    }

    /// The name that people read: `single pitch`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.names()[3]
    }
}

display_by_name!(Deviation);
