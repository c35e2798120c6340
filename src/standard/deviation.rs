//! The deviations that the standards limit, with their symbols.

named! {
    /// A deviation of a toothed wheel that a standard limits.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    #[non_exhaustive]
    pub enum Deviation {
        /// Single pitch deviation f_pt (± in the standards).
        SinglePitch = "single pitch",
        /// Cumulative pitch deviation F_pk over an eighth of the teeth, F_pz/8.
        SectorPitch = "cumulative pitch over z/8",
        /// Total cumulative pitch deviation F_p.
        TotalPitch = "total cumulative pitch",
        /// Profile form deviation f_fα.
        ProfileForm = "profile form",
        /// Profile slope deviation f_Hα.
        ProfileSlope = "profile slope",
        /// Total profile deviation F_α.
        TotalProfile = "total profile",
        /// Helix form deviation f_fβ.
        HelixForm = "helix form",
        /// Helix slope deviation f_Hβ.
        HelixSlope = "helix slope",
        /// Total helix deviation F_β.
        TotalHelix = "total helix",
        /// Runout F_r.
        Runout = "runout",
        /// Total radial composite deviation F_i''.
        RadialComposite = "radial composite",
        /// Tooth-to-tooth radial composite deviation f_i''.
        ToothRadialComposite = "tooth-to-tooth radial composite",
    }
}

impl Deviation {
    /// Its symbol in ASCII, the symbol of its tolerance in ASCII, and its key.
    const fn names(self) -> [&'static str; 3] {
        match self {
            Self::SinglePitch => ["f_pt", "f_pT", "f_pt"],
            Self::SectorPitch => ["F_pz/8", "F_pz/8T", "f_pz8"],
            Self::TotalPitch => ["F_p", "F_pT", "f_p_total"],
            Self::ProfileForm => ["f_falpha", "f_falphaT", "f_f_alpha"],
            Self::ProfileSlope => ["f_Halpha", "f_HalphaT", "f_h_alpha"],
            Self::TotalProfile => ["F_alpha", "F_alphaT", "f_alpha_total"],
            Self::HelixForm => ["f_fbeta", "f_fbetaT", "f_f_beta"],
            Self::HelixSlope => ["f_Hbeta", "f_HbetaT", "f_h_beta"],
            Self::TotalHelix => ["F_beta", "F_betaT", "f_beta_total"],
            Self::Runout => ["F_r", "F_rT", "f_r"],
            Self::RadialComposite => ["F_i''", "F_i''T", "f_i_total"],
            Self::ToothRadialComposite => ["f_i''", "f_i''T", "f_i_tooth"],
        }
    }

    /// The symbol in ASCII: `f_Hbeta`.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        self.names()[0]
    }

    /// The symbol of its tolerance in the 2013 edition.
    pub(super) const fn tolerance_symbol(self) -> &'static str {
        self.names()[1]
    }

    /// Its key in specs: `f_h_beta`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.names()[2]
    }
}

display_by_name!(Deviation);
