//! Every formula against an independent implementation with 256-bit numbers, over the whole range for which
//! `explain precision` promises something.
//!
//! The reference takes the inputs as they are kept (whole femtometres and nano-arcseconds), evaluates the equations of
//! the formulas' pages, and uses another library's trigonometry. The default run is short; `RACKMESH_LONG_TESTS=1` runs
//! a million inputs.

use astro_float_num::{BigFloat, Consts, RoundingMode};
use rackmesh::deviation::DeviationValue;
use rackmesh::formula::law::lead_slope;
use rackmesh::formula::over_pin::OverPin;
use rackmesh::formula::{Law, Model, ideal_pin, roller_change};
use rackmesh::quantity::{Angle, DomainError, Length};

/// Some 75 decimal digits.
const BITS: usize = 256;
const ROUNDING: RoundingMode = RoundingMode::ToEven;
const SHORT_RUN: usize = 4_000;
const LONG_RUN: usize = 250_000;

/// A big number.
#[derive(Clone)]
struct Big(BigFloat);

macro_rules! operator {
    ($operator:ident, $method:ident) => {
        impl std::ops::$operator for Big {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(&other.0, BITS, ROUNDING))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

fn whole(number: i64) -> Big {
    Big(BigFloat::from_i64(number, BITS))
}

impl Big {
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    fn sqrt(self) -> Self {
        Self(self.0.sqrt(BITS, ROUNDING))
    }

    /// The number to some 15 digits.
    fn approx(&self) -> f64 {
        self.0.to_string().parse().unwrap()
    }
}

/// The functions, and random inputs.
pub struct Reference {
    constants: Consts,
    state: u64,
}

impl Reference {
    fn new(seed: u64) -> Self {
        Self { constants: Consts::new().unwrap(), state: seed }
    }

    fn pi(&mut self) -> Big {
        Big(self.constants.pi(BITS, ROUNDING))
    }

    fn radians(&mut self, angle: Angle) -> Big {
        whole(angle.nas()) * self.pi() / whole(648_000_000_000_000)
    }

    fn sin(&mut self, angle: Angle) -> Big {
        Big(self.radians(angle).0.sin(BITS, ROUNDING, &mut self.constants))
    }

    fn cos(&mut self, angle: Angle) -> Big {
        Big(self.radians(angle).0.cos(BITS, ROUNDING, &mut self.constants))
    }

    fn tan(&mut self, angle: Angle) -> Big {
        self.sin(angle) / self.cos(angle)
    }

    /// splitmix64, uniform in [0, 1)
    fn unit(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from_bits(0x3ff0_0000_0000_0000 | ((z ^ (z >> 31)) >> 12)) - 1.0
    }

    /// An end of the range, a number of few decimals in it, or any.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let any = low + (high - low) * self.unit();
        match (self.unit() * 6.0) as u32 {
            0 => low,
            1 => high,
            2 => format!("{any:.1}").parse::<f64>().unwrap().clamp(low, high),
            _ => any,
        }
    }

    /// As likely in each decade; of either sign.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        let magnitude = libm::exp(libm::log(low) + (libm::log(high) - libm::log(low)) * self.unit());
        if self.unit() < 0.5 { magnitude } else { -magnitude }
    }

    fn pressure_angle(&mut self) -> Angle {
        angle(self.between(5.0, 45.0))
    }

    fn helix_angle(&mut self) -> Angle {
        angle(self.between(-45.0, 45.0))
    }

    /// Up to 10 m.
    fn size(&mut self) -> Length {
        length(self.decades(0.1, 1e4).abs())
    }

    /// Up to 10 mm.
    fn deviation(&mut self) -> Length {
        length(self.decades(1e-9, 10.0))
    }
}

pub fn length(mm: f64) -> Length {
    Length::from_mm(mm).unwrap()
}

pub fn angle(degrees: f64) -> Angle {
    Angle::from_degrees(degrees).unwrap()
}

/// What was compared of one formula, and how far off it was at most: in parts of 1e-12 mm + 8 ulp.
pub struct Checked {
    pub formula: &'static str,
    pub compared: usize,
    pub worst: f64,
}

/// One result, and what it should be in femtometres.
type Case = (Result<Length, DomainError>, Big);

/// Compares random cases; each must keep the promise.
fn run(formula: &'static str, mut case: impl FnMut(&mut Reference) -> Vec<Case>) -> Checked {
    let runs = if std::env::var_os("RACKMESH_LONG_TESTS").is_some() { LONG_RUN } else { SHORT_RUN };
    let mut reference = Reference::new(2026);
    let mut checked = Checked { formula, compared: 0, worst: 0.0 };
    for _ in 0..runs {
        for (got, want) in case(&mut reference) {
            let got = got.unwrap();
            let mm = want.approx().abs() / 1e12;
            let allowed_fm = 1.0 + 8.0 * (mm.next_up() - mm) * 1e12;
            let share = (whole(got.fm()) - want.clone()).abs().approx() / allowed_fm;
            assert!(share <= 1.0, "{formula}: {got} is off by {share} of what is promised: {} fm", want.0);
            checked.worst = checked.worst.max(share);
            checked.compared += 1;
        }
    }
    checked
}

/// The largest error within a ΔCD keeps it, read again as printed, and the next one does not.
fn check_inverse(law: Law, delta_cd: Length, model: Model) {
    let Ok(largest) = law.largest_error(delta_cd, model) else { return };
    let (printed, next): (DeviationValue, DeviationValue) = match largest {
        DeviationValue::Length(error) => {
            (error.to_string().parse::<Length>().unwrap().into(), (error + Length::from_fm(1)).into())
        }
        DeviationValue::Angle(error) => {
            (error.to_string().parse::<Angle>().unwrap().into(), (error + Angle::from_nas(36)).into())
        }
        DeviationValue::Slope(_) => unreachable!("an inverse is a length or an angle"),
    };
    assert!(law.delta_cd(printed, model).unwrap() <= delta_cd, "{law:?} {delta_cd} {printed}");
    assert!(law.delta_cd(next, model).map_or(true, |beyond| beyond > delta_cd), "{law:?} {delta_cd} {next}");
}

fn pitch(formula: &'static str, law: fn(Angle, Angle) -> Result<Law, DomainError>) -> Checked {
    run(formula, |reference| {
        let (alpha, beta, error) = (reference.pressure_angle(), reference.helix_angle(), reference.deviation());
        let law = law(alpha, beta).unwrap();
        let paper = whole(error.fm()).abs() / (whole(2) * reference.tan(alpha));
        let exact = paper.clone() * reference.cos(beta);
        check_inverse(law, error.abs(), Model::Exact);
        vec![(law.delta_cd(error, Model::Exact), exact), (law.delta_cd(error, Model::Paper), paper)]
    })
}

pub fn rack_pitch() -> Checked {
    pitch("rack pitch", Law::rack_pitch)
}

pub fn pinion_pitch() -> Checked {
    pitch("pinion pitch", Law::pinion_pitch)
}

pub fn pinion_lead() -> Checked {
    run("pinion lead", |reference| {
        let (alpha, beta, error) = (reference.pressure_angle(), reference.helix_angle(), reference.deviation());
        let law = Law::pinion_lead(alpha, beta).unwrap();
        let base_sine = reference.sin(beta) * reference.cos(alpha);
        let base_cosine = (whole(1) - base_sine.clone() * base_sine).sqrt();
        let exact = whole(error.fm()).abs() * base_cosine / (whole(2) * reference.sin(alpha));
        check_inverse(law, error.abs(), Model::Exact);
        vec![(law.delta_cd(error, Model::Exact), exact.clone()), (law.delta_cd(error, Model::Paper), exact)]
    })
}

pub fn rack_lead() -> Checked {
    run("rack lead", |reference| {
        let (alpha, beta, width) = (reference.pressure_angle(), reference.helix_angle(), reference.size());
        let error = angle(reference.decades(1e-8, 45.0));
        let law = Law::rack_lead(alpha, beta, width).unwrap();
        let gain = whole(width.fm()) / (whole(2) * reference.tan(alpha));
        let exact = gain.clone() * reference.sin(error).abs() / reference.cos(beta);
        let paper = gain * reference.tan(error).abs();
        check_inverse(law, reference.deviation().abs(), Model::Exact);
        check_inverse(law, reference.deviation().abs(), Model::Paper);
        vec![(law.delta_cd(error, Model::Exact), exact), (law.delta_cd(error, Model::Paper), paper)]
    })
}

pub fn rack_lead_by_slope() -> Checked {
    run("rack lead by f_Hβ over a length", |reference| {
        let (alpha, beta, width) = (reference.pressure_angle(), reference.helix_angle(), reference.size());
        let (slope, over) = (reference.deviation(), length(reference.decades(10.0, 1e4).abs()));
        let law = Law::rack_lead(alpha, beta, width).unwrap();
        let error = lead_slope(slope, over).unwrap();
        let tangent = whole(slope.fm()).abs() / whole(over.fm());
        let sine = tangent.clone() / (whole(1) + tangent.clone() * tangent.clone()).sqrt();
        let gain = whole(width.fm()) / (whole(2) * reference.tan(alpha));
        let exact = gain.clone() * sine / reference.cos(beta);
        vec![(law.delta_cd(error, Model::Exact), exact), (law.delta_cd(error, Model::Paper), gain * tangent)]
    })
}

pub fn pins() -> Checked {
    run("ideal pin, measure over a pin, change of rollers", |reference| {
        let alpha = reference.pressure_angle();
        let module = length(reference.decades(0.1, 100.0).abs());
        let [pin, other, datum] = [(); 3].map(|()| length(reference.decades(0.1, 1e3).abs()));
        let thickness = (reference.unit() < 0.5).then(|| length(1.4 * module.mm()));
        let pitch = reference.pi() * whole(module.fm());
        let space = thickness.map_or(pitch.clone() / whole(2), |thickness| pitch - whole(thickness.fm()));
        let one_and_cosecant = whole(1) + whole(1) / reference.sin(alpha);
        let height = whole(pin.fm()) / whole(2) * one_and_cosecant.clone();
        let depth = space.clone() / (whole(2) * reference.tan(alpha));
        let over_pin = OverPin {
            normal_module: module,
            normal_pressure_angle: alpha,
            tooth_thickness: thickness,
            pin_diameter: pin,
            datum,
        };
        // a difference of two sizes is as exact as the larger of them
        let above = (height - depth).approx().abs() > 0.1 * datum.fm() as f64;
        let mut cases = vec![
            (ideal_pin::diameter(module, alpha, thickness), space.clone() / reference.cos(alpha)),
            (
                roller_change::difference(pin, other, alpha),
                whole((other - pin).fm()) / whole(2) * one_and_cosecant.clone(),
            ),
        ];
        if above {
            let height = whole(pin.fm()) / whole(2) * one_and_cosecant;
            let depth = space / (whole(2) * reference.tan(alpha));
            cases.push((over_pin.measure(), whole(datum.fm()) + height - depth));
        }
        cases
    })
}

/// Every formula that is compared.
pub const ALL: [fn() -> Checked; 6] = [rack_pitch, pinion_pitch, pinion_lead, rack_lead, rack_lead_by_slope, pins];
