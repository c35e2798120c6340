//! The hand of teeth, as drawings name it: the sign of the helix angle.

named! {
    /// The hand of the helix.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Hand {
        /// A positive helix angle.
        Right = "right",
        /// A negative helix angle.
        Left = "left",
        /// No helix angle.
        Spur = "spur",
    }
}

impl Hand {
    /// The hand of teeth with this helix angle.
    #[must_use]
    pub fn of(helix_angle_rad: f64) -> Self {
        if helix_angle_rad > 0.0 {
            Self::Right
        } else if helix_angle_rad < 0.0 {
            Self::Left
        } else {
            Self::Spur
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_hands_are_positive() {
        assert_eq!([0.3, -0.3, 0.0, -0.0].map(|angle| Hand::of(angle).name()), ["right", "left", "spur", "spur"]);
    }
}
