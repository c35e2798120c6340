//! Every formula against an independent implementation with 448-bit numbers, in ulps of its result.
//!
//! The reference takes the same decimal texts, evaluates the equations of the documentation in another
//! order, and uses another library's trigonometry. Cases are random, log-uniform over all of `f64` and
//! uniform over everyday sizes, mixed with adversarial ones: the ends of the domains, exact angles,
//! subnormal and huge lengths, and cancellations. A result that no `f64` holds must be an error.
//!
//! The default run is short; `RACKMESH_LONG_TESTS=1` runs more than a million inputs. `--nocapture`
//! shows the largest error of each result.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt::{self, Debug, Display};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use astro_float::{BigFloat, Consts, Radix, RoundingMode};
use rackmesh::formula::over_pin::OverPin;
use rackmesh::formula::{
    Input, Model, PinionPitch, RackLead, RackPitch, Sensitivity, ideal_pin, over_roller, pinion_radial, roller_change,
};
use rackmesh::quantity::{Angle, DomainError, Length};

/// Rounded once to the nearest `f64`, which is what the formulas promise.
const ROUNDED_ONCE: f64 = 0.500_000_1;
/// Of an inverse, which is rounded towards zero until its shortest decimal keeps the bound.
const TOWARDS_ZERO: f64 = 2.0;

/// Inputs per formula.
const SHORT_RUN: usize = 3_000;
const LONG_RUN: usize = 150_000;
/// A run is cut into chunks with a seed each, so that its inputs do not depend on the number of threads.
const CHUNKS: usize = 60;

// ---- big numbers -----------------------------------------------------------------------------------

/// Some 130 decimal digits: two cancellations of 17 digits leave far more than an `f64` has.
const BITS: usize = 448;
const ROUNDING: RoundingMode = RoundingMode::None;

#[derive(Clone)]
struct Big(BigFloat);

macro_rules! operator {
    ($operator:ident, $method:ident) => {
        impl $operator<&Big> for &Big {
            type Output = Big;
            fn $method(self, other: &Big) -> Big {
                Big(self.0.$method(&other.0, BITS, ROUNDING))
            }
        }
        impl $operator<Big> for &Big {
            type Output = Big;
            fn $method(self, other: Big) -> Big {
                self.$method(&other)
            }
        }
        impl $operator<&Big> for Big {
            type Output = Big;
            fn $method(self, other: &Big) -> Big {
                (&self).$method(other)
            }
        }
        impl $operator<Big> for Big {
            type Output = Big;
            fn $method(self, other: Big) -> Big {
                (&self).$method(&other)
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Big {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.neg())
    }
}

impl PartialEq for Big {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Big {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.cmp(&other.0).map(|sign| sign.cmp(&0))
    }
}

impl Big {
    /// Exactly that `f64`.
    fn of(value: f64) -> Self {
        // astro-float 0.9 reads a subnormal number as half of what it is; scaled to normal, all are right
        let scale = if value.is_subnormal() { f64::from_bits((1023 + 100) << 52) } else { 1.0 };
        let scaled = BigFloat::from_f64(value * scale, BITS);
        Self(scaled.div(&BigFloat::from_f64(scale, BITS), BITS, ROUNDING))
    }

    fn abs(&self) -> Self {
        Self(self.0.abs())
    }

    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// Close to the number, not always the nearest.
    fn approx(&self) -> f64 {
        let Some((mantissa, _, sign, mut exponent, _)) = self.0.as_raw_parts() else { return f64::NAN };
        let words: Vec<u64> = mantissa.iter().rev().take(2).copied().collect();
        #[expect(clippy::cast_precision_loss, reason = "the leading bits are all that is wanted")]
        let mut value = words.iter().rev().fold(0.0, |low, word| (low + *word as f64) / 18_446_744_073_709_551_616.0);
        while exponent > 0 && value.is_finite() {
            value *= 2.0;
            exponent -= 1;
        }
        while exponent < 0 && value > 0.0 {
            value /= 2.0;
            exponent += 1;
        }
        if sign.is_negative() { -value } else { value }
    }

    /// Whether the nearest `f64` is infinite: from half a unit above the largest on.
    fn overflows(&self) -> bool {
        self.abs() >= Big::of(f64::MAX) + (Big::of(f64::MAX) - Big::of(f64::MAX.next_down())) / Big::of(2.0)
    }
}

impl Debug for Big {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// The distance from `got` to `want` in units of the last place of an `f64` there.
fn ulps(got: f64, want: &Big) -> f64 {
    let got_big = Big::of(got);
    let magnitude = got.abs();
    let ulp = if magnitude == 0.0 {
        f64::from_bits(1)
    } else if want.abs() < got_big.abs() || magnitude == f64::MAX {
        magnitude - magnitude.next_down()
    } else {
        magnitude.next_up() - magnitude
    };
    ((got_big - want).abs() / Big::of(ulp)).approx()
}

/// Functions of angles in degrees.
struct Trig {
    constants: Consts,
    pi: Big,
}

impl Trig {
    fn new() -> Self {
        let mut constants = Consts::new().unwrap();
        let pi = Big(constants.pi(BITS, ROUNDING));
        Self { constants, pi }
    }

    fn read(&mut self, text: &str) -> Big {
        Big(BigFloat::parse(text, Radix::Dec, BITS, ROUNDING, &mut self.constants))
    }

    fn radians(&self, degrees: &Big) -> Big {
        degrees * &self.pi / Big::of(180.0)
    }

    fn degrees(&self, radians: &Big) -> Big {
        radians * Big::of(180.0) / &self.pi
    }

    /// Below 2⁻¹⁰⁰ two terms of a series have 400 correct bits, and the library takes very long.
    fn tiny(x: &Big) -> bool {
        x.abs() < Big::of(f64::from_bits((1023 - 100) << 52))
    }

    /// x (1 + coefficient x²)
    fn two_terms(x: &Big, coefficient: &Big) -> Big {
        x * (Big::of(1.0) + coefficient * x * x)
    }

    fn sin(&mut self, degrees: &Big) -> Big {
        let x = self.radians(degrees);
        if Self::tiny(&x) {
            return Self::two_terms(&x, &(Big::of(-1.0) / Big::of(6.0)));
        }
        Big(x.0.sin(BITS, ROUNDING, &mut self.constants))
    }

    /// Within ±90°, as the sine of the complement, which is known without a rounding of π.
    fn cos(&mut self, degrees: &Big) -> Big {
        if degrees.abs() > Big::of(45.0) {
            return self.sin(&(Big::of(90.0) - degrees.abs()));
        }
        let x = self.radians(degrees);
        if Self::tiny(&x) {
            return Big::of(1.0) - &x * &x / Big::of(2.0);
        }
        Big(x.0.cos(BITS, ROUNDING, &mut self.constants))
    }

    fn asin(&mut self, x: &Big) -> Big {
        if Self::tiny(x) {
            return self.degrees(&Self::two_terms(x, &(Big::of(1.0) / Big::of(6.0))));
        }
        let radians = Big(x.0.asin(BITS, ROUNDING, &mut self.constants));
        self.degrees(&radians)
    }

    fn atan(&mut self, x: &Big) -> Big {
        if x.abs() > Big::of(1.0) {
            let quarter = Big::of(if x.0.is_negative() { -90.0 } else { 90.0 });
            return quarter - self.atan(&(Big::of(1.0) / x));
        }
        if Self::tiny(x) {
            return self.degrees(&Self::two_terms(x, &(Big::of(-1.0) / Big::of(3.0))));
        }
        let radians = Big(x.0.atan(BITS, ROUNDING, &mut self.constants));
        self.degrees(&radians)
    }
}

// ---- inputs ----------------------------------------------------------------------------------------

/// splitmix64
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn pick(&mut self, values: &[f64]) -> f64 {
        values[usize::try_from(self.below(values.len() as u64)).unwrap()]
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        f64::from_bits(0x3ff0_0000_0000_0000 | (self.next() >> 12)) - 1.0
    }

    /// Log-uniform over every positive finite `f64` up to `largest`, subnormal ones included.
    fn magnitude_up_to(&mut self, largest: f64) -> f64 {
        let exponents = (largest.to_bits() >> 52) + 1;
        loop {
            let value = f64::from_bits((self.below(exponents) << 52) | (self.next() >> 12));
            if value > 0.0 && value <= largest {
                return value;
            }
        }
    }

    /// A decimal as drawings have it: up to four digits before the point and after it.
    fn short_decimal(&mut self) -> f64 {
        let decimals = self.below(5);
        let digits = self.below(9999) + 1;
        format!("{digits}e-{decimals}").parse().unwrap()
    }

    fn signed(&mut self, magnitude: f64) -> f64 {
        if self.next() & 1 == 0 { magnitude } else { -magnitude }
    }

    /// A few `f64`s up or down.
    fn nearby(&mut self, value: f64) -> f64 {
        let steps = self.below(7);
        (0..steps / 2).fold(value, |v, _| if steps.is_multiple_of(2) { v.next_up() } else { v.next_down() })
    }

    fn pressure_angle(&mut self) -> f64 {
        const ENDS: [f64; 20] = [
            5e-324,
            1e-323,
            2.225_073_858_507_201e-308,
            2.225_073_858_507_201_4e-308,
            1e-300,
            1e-200,
            1e-160,
            1e-100,
            1e-20,
            1e-9,
            0.1,
            14.5,
            19.9,
            20.0,
            30.0,
            30.000_000_000_000_004,
            29.999_999_999_999_996,
            44.999_999_999_999_99,
            45.0,
            1.0,
        ];
        match self.below(4) {
            0 => self.pick(&ENDS),
            1 => self.magnitude_up_to(45.0),
            2 => 45.0 * (1.0 - self.unit()),
            _ => self.short_decimal() % 40.0 + 0.5,
        }
    }

    /// A helix angle or lead error, between −90° and 90°.
    fn any_angle(&mut self) -> f64 {
        const ENDS: [f64; 20] = [
            0.0,
            5e-324,
            1e-310,
            1e-300,
            1e-30,
            1e-9,
            0.25,
            0.5,
            12.0,
            30.0,
            30.000_000_000_000_004,
            45.0,
            45.000_000_000_000_01,
            59.999_999_999_999_99,
            60.0,
            75.0,
            89.9,
            89.999_999_999,
            89.999_999_999_999,
            89.999_999_999_999_99,
        ];
        let magnitude = match self.below(5) {
            0 | 1 => self.pick(&ENDS),
            2 => self.magnitude_up_to(89.999_999_999_999_99),
            3 => 90.0 * (self.unit() * (1.0 - f64::EPSILON)),
            _ => self.short_decimal() % 89.0,
        };
        self.signed(magnitude)
    }

    fn positive_length(&mut self) -> f64 {
        const ENDS: [f64; 12] = [
            5e-324,
            1e-323,
            2.225_073_858_507_201_4e-308,
            1e-300,
            1e-9,
            0.0131,
            0.1,
            1.0,
            19.7,
            25.0131,
            1e300,
            f64::MAX,
        ];
        match self.below(6) {
            0 => self.pick(&ENDS),
            1 => self.magnitude_up_to(f64::MAX),
            2 => (1.0 - self.unit()) * 100.0,
            3 => (1.0 - self.unit()) * 0.1,
            _ => self.short_decimal(),
        }
    }

    fn any_length(&mut self) -> f64 {
        if self.below(12) == 0 {
            return 0.0;
        }
        let magnitude = self.positive_length();
        self.signed(magnitude)
    }
}

pub fn length(mm: f64) -> Length {
    Length::from_mm(mm).unwrap()
}

pub fn angle(degrees: f64) -> Angle {
    Angle::from_degrees(degrees).unwrap()
}

// ---- the comparison --------------------------------------------------------------------------------

/// What was compared of one formula, and how far off it was at most.
pub struct Checked {
    pub formula: String,
    /// Each result with the values compared and the largest error in ulps.
    pub results: Vec<(String, u64, f64)>,
}

#[derive(Default)]
struct Worst {
    compared: u64,
    overflows: u64,
    ulps: f64,
    inputs: String,
}

/// The checks of one formula.
struct Checks {
    random: Random,
    trig: Trig,
    worst: BTreeMap<String, Worst>,
    failures: Vec<String>,
    inputs: String,
}

impl Checks {
    fn new(seed: u64) -> Self {
        Self {
            random: Random(seed),
            trig: Trig::new(),
            worst: BTreeMap::new(),
            failures: vec![],
            inputs: String::new(),
        }
    }

    /// The decimal that stands for an `f64`, read by the reference.
    fn big(&mut self, value: f64) -> Big {
        self.trig.read(&format!("{value:e}"))
    }

    fn fail(&mut self, result: &str, problem: impl Display) {
        self.failures.push(format!("{result} at {}: {problem}", self.inputs));
    }

    /// `got` is within `bound` ulp of `want`, or the overflow error if `want` overflows.
    fn value(&mut self, result: &str, got: Result<f64, DomainError>, want: &Big, bound: f64) {
        let worst = self.worst.entry(result.to_owned()).or_default();
        worst.compared += 1;
        match got {
            Err(DomainError::Overflow(_)) if want.overflows() => worst.overflows += 1,
            Ok(got) if !want.overflows() && got.is_finite() => {
                let ulps = ulps(got, want);
                if ulps > worst.ulps {
                    worst.ulps = ulps;
                    worst.inputs.clone_from(&self.inputs);
                }
                if ulps.is_nan() || ulps > bound {
                    self.fail(result, format_args!("{got:e} is off by {ulps} ulp, {want:?}"));
                }
            }
            got => self.fail(result, format_args!("{got:?} is not {want:?}")),
        }
    }

    fn length(&mut self, result: &str, got: Result<Length, DomainError>, want: &Big) {
        self.value(result, got.map(|got| got.mm()), want, ROUNDED_ONCE);
    }

    /// Every entry, `None` at a kink; an error if one of them overflows.
    fn sensitivities(
        &mut self,
        result: &str,
        got: Result<Vec<Sensitivity>, DomainError>,
        want: &[(Input, Option<Big>)],
    ) {
        let overflow = want.iter().any(|(_, value)| value.as_ref().is_some_and(Big::overflows));
        let got = match got {
            Ok(got) if !overflow => got,
            Err(DomainError::Overflow(_)) if overflow => {
                self.worst.entry(format!("{result}, any")).or_default().overflows += 1;
                return;
            }
            got => return self.fail(result, format_args!("{got:?} is not {want:?}")),
        };
        if got.iter().map(|s| s.input).ne(want.iter().map(|(input, _)| *input)) {
            return self.fail(result, format_args!("{got:?} is not {want:?}"));
        }
        for (got, (input, want)) in got.iter().zip(want) {
            match (got.value, want) {
                (None, None) => {}
                (Some(got), Some(want)) => {
                    self.value(&format!("{result}, by {input:?}"), Ok(got), want, ROUNDED_ONCE);
                }
                _ => self.fail(result, format_args!("{got:?} is not {want:?}")),
            }
        }
    }
}

/// Runs `case` on as many inputs as the run has, over all processors, and judges the outcome.
fn run(formula: &str, case: impl Fn(&mut Checks) + Sync) -> Checked {
    let start = Instant::now();
    let inputs = if super::is_long() { LONG_RUN } else { SHORT_RUN };
    let name_seed = formula.bytes().fold(0_u64, |seed, byte| seed.wrapping_mul(131).wrapping_add(byte.into()));
    let next_chunk = AtomicUsize::new(0);
    let finished = Mutex::new((BTreeMap::<String, Worst>::new(), Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let chunk = next_chunk.fetch_add(1, Relaxed);
                    if chunk >= CHUNKS {
                        break;
                    }
                    let mut checks = Checks::new(name_seed ^ (chunk as u64).wrapping_mul(0x5851_f42d_4c95_7f2d));
                    for _ in 0..inputs / CHUNKS {
                        case(&mut checks);
                    }
                    let mut finished = finished.lock().unwrap();
                    finished.1.extend(checks.failures);
                    for (result, worst) in checks.worst {
                        let all = finished.0.entry(result).or_default();
                        all.compared += worst.compared;
                        all.overflows += worst.overflows;
                        if worst.ulps > all.ulps {
                            (all.ulps, all.inputs) = (worst.ulps, worst.inputs);
                        }
                    }
                }
            });
        }
    });
    let (worst, failures) = finished.into_inner().unwrap();
    eprintln!("{formula}: {inputs} inputs in {:.1} s", start.elapsed().as_secs_f64());
    for (result, worst) in &worst {
        eprintln!(
            "  {result}: at most {:.6} ulp ({} values, {} overflows) at {}",
            worst.ulps, worst.compared, worst.overflows, worst.inputs
        );
    }
    let shown: Vec<_> = failures.iter().take(10).map(String::as_str).collect();
    assert!(failures.is_empty(), "{formula}: {} failures:\n{}", failures.len(), shown.join("\n"));
    let results = worst.iter().map(|(result, worst)| (result.clone(), worst.compared, worst.ulps));
    Checked { formula: formula.to_owned(), results: results.collect() }
}

// ---- the formulas ----------------------------------------------------------------------------------

/// The tooth thickness that a case gives, often close below the pitch.
fn some_thickness(checks: &mut Checks, module: f64) -> Option<f64> {
    let pitch = module * std::f64::consts::PI;
    match checks.random.below(4) {
        0 => None,
        1 if pitch.is_finite() => Some(checks.random.nearby(pitch)).filter(|thickness| *thickness > 0.0),
        2 if pitch.is_finite() => Some(pitch * checks.random.unit()).filter(|thickness| *thickness > 0.0),
        _ => Some(checks.random.positive_length()),
    }
}

/// π m_n − s_n, or `None` if the tooth fills the pitch.
fn space(checks: &mut Checks, module: f64, thickness: Option<f64>) -> Option<Big> {
    let pitch = checks.big(module) * &checks.trig.pi;
    let space = match thickness {
        None => pitch / Big::of(2.0),
        Some(thickness) => pitch - checks.big(thickness),
    };
    (space > Big::of(0.0)).then_some(space)
}

/// ∂(π m_n − s_n)/∂m_n
fn space_per_module(checks: &Checks, thickness: Option<f64>) -> Big {
    checks.trig.pi.clone() / Big::of(if thickness.is_some() { 1.0 } else { 2.0 })
}

fn per_degree(checks: &Checks, per_radian: &Big) -> Big {
    per_radian * &checks.trig.pi / Big::of(180.0)
}

fn module(checks: &mut Checks) -> f64 {
    // between 5.7e307 and 1.1e308 the pitch overflows, and half of it does not
    if checks.random.below(40) == 0 { 8e307 } else { checks.random.positive_length() }
}

pub fn the_ideal_pin() -> Checked {
    run("ideal pin", |checks| {
        let module = module(checks);
        let alpha = checks.random.pressure_angle();
        let thickness = some_thickness(checks, module);
        checks.inputs = format!("m_n {module:e} α_n {alpha:e} s_n {thickness:?}");
        let given = thickness.map(length);
        let (m, a) = (length(module), angle(alpha));
        let diameter = ideal_pin::diameter(&m, &a, given.as_ref());
        let sensitivities = ideal_pin::sensitivities(&m, &a, given.as_ref());
        let Some(space) = space(checks, module, thickness) else {
            if !matches!((diameter, sensitivities), (Err(DomainError::NoSpace { .. }), Err(_))) {
                checks.fail("ideal pin", "the tooth leaves no space");
            }
            return;
        };
        let alpha = checks.big(alpha);
        let (sin, cos) = (checks.trig.sin(&alpha), checks.trig.cos(&alpha));
        checks.length("ideal pin", diameter, &(&space / &cos));
        let by_alpha = per_degree(checks, &(&space * &sin / (&cos * &cos)));
        let mut want = vec![
            (Input::NormalModule, Some(space_per_module(checks, thickness) / &cos)),
            (Input::NormalPressureAngle, Some(by_alpha)),
        ];
        if thickness.is_some() {
            want.push((Input::ToothThickness, Some(Big::of(-1.0) / &cos)));
        }
        checks.sensitivities("ideal pin", sensitivities, &want);
    })
}

/// Pin and datum where the terms of M cancel, once or twice, to the last digits of an `f64`.
fn cancelling_pin(checks: &mut Checks, space: &Big, alpha: f64) -> (f64, f64) {
    let alpha = checks.big(alpha);
    let (sin, cos) = (checks.trig.sin(&alpha), checks.trig.cos(&alpha));
    let matching = (space * &cos / (Big::of(1.0) + &sin)).approx();
    let pin = checks.random.nearby(matching);
    let scaled = if checks.random.next() & 1 == 0 { pin } else { matching * checks.random.unit() };
    let pin = if scaled > 0.0 && scaled.is_finite() { scaled } else { 1.0 };
    let remainder = (space * &cos - checks.big(pin) * (Big::of(1.0) + &sin)) / (Big::of(2.0) * &sin);
    let datum = remainder.approx();
    let datum = checks.random.nearby(datum);
    (pin, if datum >= 0.0 && datum.is_finite() { datum } else { 0.0 })
}

pub fn the_measure_over_a_pin() -> Checked {
    run("over-pin", |checks| {
        let module = module(checks);
        let alpha = checks.random.pressure_angle();
        let thickness = some_thickness(checks, module);
        let space = space(checks, module, thickness);
        let (pin, datum) = match &space {
            Some(space) if checks.random.next() & 1 == 0 => cancelling_pin(checks, space, alpha),
            _ => {
                let datum = checks.random.any_length().abs();
                (checks.random.positive_length(), datum)
            }
        };
        checks.inputs = format!("m_n {module:e} α_n {alpha:e} s_n {thickness:?} d_p {pin:e} K {datum:e}");
        let over_pin = OverPin {
            normal_module: length(module),
            normal_pressure_angle: angle(alpha),
            tooth_thickness: thickness.map(length),
            pin_diameter: length(pin),
            datum: length(datum),
        };
        let Some(space) = space else {
            if !matches!(over_pin.measure(), Err(DomainError::NoSpace { .. })) || over_pin.sensitivities().is_ok() {
                checks.fail("over-pin", "the tooth leaves no space");
            }
            return;
        };
        let (alpha, pin, datum) = (checks.big(alpha), checks.big(pin), checks.big(datum));
        let (sin, cos) = (checks.trig.sin(&alpha), checks.trig.cos(&alpha));
        let (one, two) = (Big::of(1.0), Big::of(2.0));
        // over one denominator: M = K + (d (1 + sin α) - w cos α) / (2 sin α)
        let want = datum + (&pin * (&one + &sin) - &space * &cos) / (&two * &sin);
        checks.length("over-pin", over_pin.measure(), &want);
        let by_space = -(&cos / (&two * &sin));
        let by_alpha = per_degree(checks, &((&space - &pin * &cos) / (&two * &sin * &sin)));
        let mut want = vec![
            (Input::Datum, Some(one.clone())),
            (Input::PinDiameter, Some((&one + &sin) / (&two * &sin))),
            (Input::NormalModule, Some(&by_space * space_per_module(checks, thickness))),
            (Input::NormalPressureAngle, Some(by_alpha)),
        ];
        if thickness.is_some() {
            want.push((Input::ToothThickness, Some(-by_space)));
        }
        checks.sensitivities("over-pin", over_pin.sensitivities(), &want);
    })
}

pub fn the_change_of_rollers() -> Checked {
    run("roller change", |checks| {
        let from = checks.random.positive_length();
        let to = if checks.random.below(3) == 0 { checks.random.nearby(from) } else { checks.random.positive_length() };
        let to = if to > 0.0 && to.is_finite() { to } else { from };
        let alpha = checks.random.pressure_angle();
        checks.inputs = format!("D_1 {from:e} D_2 {to:e} α_n {alpha:e}");
        let (d_1, d_2, a) = (length(from), length(to), angle(alpha));
        let (from, to, alpha) = (checks.big(from), checks.big(to), checks.big(alpha));
        let (sin, cos) = (checks.trig.sin(&alpha), checks.trig.cos(&alpha));
        let two_sin = Big::of(2.0) * &sin;
        let by_diameter = (&sin + Big::of(1.0)) / &two_sin;
        checks.length("roller change", roller_change::difference(&d_1, &d_2, &a), &((&to - &from) * &by_diameter));
        let by_alpha = per_degree(checks, &((from - to) * cos / (two_sin * sin)));
        let want = [(Input::PinDiameter, Some(by_diameter)), (Input::NormalPressureAngle, Some(by_alpha))];
        checks.sensitivities("roller change", roller_change::sensitivities(&d_1, &d_2, &a), &want);
    })
}

pub fn over_roller_and_radial_errors() -> Checked {
    run("over-roller and pinion radial", |checks| {
        let nominal = checks.random.any_length();
        let measured =
            if checks.random.below(3) == 0 { checks.random.any_length() } else { checks.random.nearby(nominal) };
        let measured = if measured.is_finite() { measured } else { nominal };
        checks.inputs = format!("{measured:e} - {nominal:e}");
        let error = &length(measured) - &length(nominal);
        let want = checks.big(measured) - checks.big(nominal);
        if want.overflows() {
            return;
        }
        checks.length("over-roller", Ok(over_roller::delta_cd(&error)), &want);
        checks.length("over-roller inverse", Ok(over_roller::largest_error(&error)), &want);
        checks.length("pinion radial", Ok(pinion_radial::delta_cd(&error)), &want);
        checks.length("pinion radial inverse", Ok(pinion_radial::largest_error(&error)), &want);
        let one = [(Input::Error, Some(Big::of(1.0)))];
        checks.sensitivities("over-roller", Ok(over_roller::sensitivities()), &one);
        checks.sensitivities("pinion radial", Ok(pinion_radial::sensitivities()), &one);
    })
}

/// The derivative by an error that enters with its magnitude.
fn by_magnitude(error: &Big, slope: Big) -> Option<Big> {
    if error.is_zero() {
        None
    } else if error.0.is_negative() {
        Some(-slope)
    } else {
        Some(slope)
    }
}

/// What the two pitch formulas have in common.
trait PitchFormula {
    fn delta_cd(&self, error: &Length, model: Model) -> Result<Length, DomainError>;
    fn largest_error(&self, delta_cd: &Length, model: Model) -> Result<Length, DomainError>;
    fn sensitivities(&self, error: &Length, model: Model) -> Result<Vec<Sensitivity>, DomainError>;
}

macro_rules! pitch_formula {
    ($formula:ident) => {
        impl PitchFormula for $formula {
            fn delta_cd(&self, error: &Length, model: Model) -> Result<Length, DomainError> {
                self.delta_cd(error, model)
            }
            fn largest_error(&self, delta_cd: &Length, model: Model) -> Result<Length, DomainError> {
                self.largest_error(delta_cd, model)
            }
            fn sensitivities(&self, error: &Length, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
                self.sensitivities(error, model)
            }
        }
    };
}
pitch_formula!(RackPitch);
pitch_formula!(PinionPitch);

fn pitch_case<F: PitchFormula>(
    checks: &mut Checks,
    name: &str,
    prepare: impl Fn(&Angle, &Angle) -> Result<F, DomainError>,
) {
    let (alpha, beta) = (checks.random.pressure_angle(), checks.random.any_angle());
    let (error, bound) = (checks.random.any_length(), checks.random.any_length().abs());
    checks.inputs = format!("α_n {alpha:e} β {beta:e} error {error:e}, or ΔCD {bound:e}");
    let formula = prepare(&angle(alpha), &angle(beta)).unwrap();
    let (pitch_error, delta_cd) = (length(error), length(bound));
    let (alpha, beta) = (checks.big(alpha), checks.big(beta));
    let (error, bound) = (checks.big(error), checks.big(bound));
    let (sin, cos) = (checks.trig.sin(&alpha), checks.trig.cos(&alpha));
    let (sin_beta, cos_beta) = (checks.trig.sin(&beta), checks.trig.cos(&beta));
    let two = Big::of(2.0);
    for model in [Model::Exact, Model::Paper] {
        let helix = if model == Model::Exact { cos_beta.clone() } else { Big::of(1.0) };
        let label = format!("{name} {model}");
        let want = error.abs() * &helix * &cos / (&two * &sin);
        checks.length(&label, formula.delta_cd(&pitch_error, model), &want);

        let inverse = formula.largest_error(&delta_cd, model);
        if let Ok(inverse) = &inverse
            && !formula.delta_cd(inverse, model).is_ok_and(|reached| reached <= delta_cd)
        {
            checks.fail(&label, format_args!("the inverse {inverse} exceeds its ΔCD"));
        }
        let want = &bound * (&two * &sin) / (&helix * &cos);
        let inverse = inverse.map(|inverse| inverse.mm());
        checks.value(&format!("{label} inverse"), inverse, &want, TOWARDS_ZERO);

        let by_error = &helix * &cos / (&two * &sin);
        let by_alpha = per_degree(checks, &-(error.abs() * &helix / (&two * &sin * &sin)));
        let mut want =
            vec![(Input::Error, by_magnitude(&error, by_error)), (Input::NormalPressureAngle, Some(by_alpha))];
        if model == Model::Exact {
            let by_beta = per_degree(checks, &-(error.abs() * &sin_beta * &cos / (&two * &sin)));
            want.push((Input::HelixAngle, Some(by_beta)));
        }
        checks.sensitivities(&label, formula.sensitivities(&pitch_error, model), &want);
    }
}

pub fn the_rack_pitch_error() -> Checked {
    run("rack pitch", |checks| pitch_case(checks, "rack pitch", RackPitch::new))
}

pub fn the_pinion_pitch_error() -> Checked {
    run("pinion pitch", |checks| pitch_case(checks, "pinion pitch", PinionPitch::new))
}

pub fn the_rack_lead_error() -> Checked {
    run("rack lead", |checks| {
        let (alpha, beta) = (checks.random.pressure_angle(), checks.random.any_angle());
        let (error, width) = (checks.random.any_angle(), checks.random.positive_length());
        let largest_reached = {
            let (alpha, beta, width) = (checks.big(alpha), checks.big(beta), checks.big(width));
            let gain =
                width * checks.trig.cos(&alpha) / (Big::of(2.0) * checks.trig.sin(&alpha) * checks.trig.cos(&beta));
            gain.approx()
        };
        // any ΔCD, or one that the exact model just reaches or does not
        let bound = match checks.random.below(3) {
            0 => checks.random.any_length().abs(),
            1 => checks.random.nearby(largest_reached),
            _ => largest_reached * checks.random.unit(),
        };
        let bound = if bound.is_finite() { bound.max(0.0) } else { 0.05 };
        checks.inputs = format!("α_n {alpha:e} β_r {beta:e} k {width:e} Δβ {error:e}, or ΔCD {bound:e}");
        let formula = RackLead::new(&angle(alpha), &angle(beta), &length(width)).unwrap();
        let (lead_error, delta_cd) = (angle(error), length(bound));
        let (alpha, beta) = (checks.big(alpha), checks.big(beta));
        let (error, width, bound) = (checks.big(error), checks.big(width), checks.big(bound));
        let (sin, cos) = (checks.trig.sin(&alpha), checks.trig.cos(&alpha));
        let (sin_beta, cos_beta) = (checks.trig.sin(&beta), checks.trig.cos(&beta));
        let (sin_error, cos_error) = (checks.trig.sin(&error).abs(), checks.trig.cos(&error));
        let two_sin = Big::of(2.0) * &sin;
        for model in [Model::Exact, Model::Paper] {
            let label = format!("rack lead {model}");
            // gain is ΔCD per mm of face width and sine or tangent
            let (gain, ratio, slope) = match model {
                Model::Exact => (&cos / (&two_sin * &cos_beta), sin_error.clone(), cos_error.clone()),
                Model::Paper => (&cos / &two_sin, &sin_error / &cos_error, Big::of(1.0) / (&cos_error * &cos_error)),
            };
            let want = &width * &ratio * &gain;
            checks.length(&label, formula.delta_cd(&lead_error, model), &want);

            let inverse = formula.largest_error(&delta_cd, model);
            if let Ok(inverse) = &inverse
                && !formula.delta_cd(inverse, model).is_ok_and(|reached| reached <= delta_cd)
            {
                checks.fail(&label, format_args!("the inverse {inverse} exceeds its ΔCD"));
            }
            let reached = &bound / (&width * &gain);
            let never = model == Model::Exact && reached > Big::of(1.0) - Big::of(1e-60);
            if never || matches!(inverse, Err(DomainError::NeverReached { .. })) {
                if !never || !matches!(inverse, Err(DomainError::NeverReached { .. })) {
                    checks.fail(&label, format_args!("{inverse:?}, and the sine is {reached:?}"));
                }
            } else {
                let want = if model == Model::Exact { checks.trig.asin(&reached) } else { checks.trig.atan(&reached) };
                let inverse = inverse.map(|inverse| inverse.degrees());
                checks.value(&format!("{label} inverse"), inverse, &want, TOWARDS_ZERO);
            }

            let by_alpha = per_degree(checks, &-(&width * &ratio * &gain / (&sin * &cos)));
            let by_error = per_degree(checks, &(&width * &gain * &slope));
            let mut want = vec![
                (Input::Error, by_magnitude(&error, by_error)),
                (Input::NormalPressureAngle, Some(by_alpha)),
                (Input::FaceWidth, Some(&ratio * &gain)),
            ];
            if model == Model::Exact {
                let by_beta = per_degree(checks, &(&width * &ratio * &gain * &sin_beta / &cos_beta));
                want.push((Input::HelixAngle, Some(by_beta)));
            }
            checks.sensitivities(&label, formula.sensitivities(&lead_error, model), &want);
        }
    })
}

pub fn the_lead_error_of_a_slope() -> Checked {
    run("slope", |checks| {
        let (slope, over) = (checks.random.any_length(), checks.random.positive_length());
        checks.inputs = format!("f_Hβ {slope:e} L {over:e}");
        let got = RackLead::error_from_slope(&length(slope), &length(over)).map(|angle| angle.degrees());
        let ratio = checks.big(slope) / checks.big(over);
        let want = checks.trig.atan(&ratio);
        checks.value("lead error of a slope", got, &want, ROUNDED_ONCE);
    })
}

/// Every formula that is compared.
pub const ALL: [fn() -> Checked; 8] = [
    the_ideal_pin,
    the_measure_over_a_pin,
    the_change_of_rollers,
    over_roller_and_radial_errors,
    the_rack_pitch_error,
    the_pinion_pitch_error,
    the_rack_lead_error,
    the_lead_error_of_a_slope,
];
