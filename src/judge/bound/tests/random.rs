//! Random pairs, errors, and places for them on teeth.

use std::f64::consts::PI;

use crate::deviation::{Part, PinionForm, RackForm};
use crate::formula::Law;
use crate::gear::{Pair, PairData, PinionData, RackData};
use crate::judge::bound::error::ErrorEffect;
use crate::judge::bound::{ExtendedError, Extent, GivenPair};
use crate::judge::reached::placed::{BySide, Placed};
use crate::quantity::{Angle, Length};
use crate::trig;

/// A generator (splitmix64).
pub(in crate::judge) struct Random(pub(in crate::judge) u64);

impl Random {
    pub(in crate::judge) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(in crate::judge) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(in crate::judge) fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(in crate::judge) fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    pub(in crate::judge) fn below(&mut self, count: u32) -> u32 {
        u32::try_from(self.next() % u64::from(count)).unwrap_or(0)
    }

    pub(in crate::judge) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }
}

const DEGREE: f64 = PI / 180.0;

/// A pair that can be made: undercut, short teeth, thick and thin ones, any shaft angle.
pub(in crate::judge) fn pair(random: &mut Random) -> Pair {
    loop {
        let m = random.range(1.0, 4.0);
        let alpha = random.range(14.5, 25.0) * DEGREE;
        let teeth = 5 + random.below(26);
        let mut helix = |share| if random.chance(share) { 0.0 } else { random.range(-40.0, 40.0) * DEGREE };
        let (beta_r, beta_p) = (helix(0.4), helix(0.3));
        let x = random.range(-0.3, 0.8);
        let r = m * f64::from(teeth) / 2.0 / trig::cos(beta_p);
        let with_root = random.chance(0.6);
        let thickness = random.chance(0.3).then(|| 0.5 * PI * m + random.range(-0.1, 0.05));
        let data = PairData {
            normal_module_mm: m,
            normal_pressure_angle_rad: alpha,
            rack: RackData {
                helix_angle_rad: beta_r,
                face_width_mm: random.range(4.0, 15.0) * m,
                addendum_mm: random.range(0.6, 1.2) * m,
                tooth_thickness_mm: thickness,
            },
            pinion: PinionData {
                teeth,
                helix_angle_rad: beta_p,
                profile_shift: x,
                tip_diameter_mm: 2.0 * (r + m * (x + random.range(0.6, 1.2))),
                root_form_diameter_mm: with_root.then(|| 2.0 * (r + m * (x - random.range(0.9, 1.3)))),
                face_width_mm: random.range(4.0, 15.0) * m,
                tooth_thickness_deviation_mm: if random.chance(0.3) { random.range(-0.1, 0.05) } else { 0.0 },
            },
        };
        if let Ok(pair) = Pair::new(&data)
            && pair.contact_ratio().total > 0.6
        {
            return pair;
        }
    }
}

/// The same pair with flank form.
pub(in crate::judge) fn with_form(random: &mut Random, given: GivenPair) -> GivenPair {
    let mut amount = |share: f64, low: f64| if random.chance(share) { random.range(low, 0.015) } else { 0.0 };
    let addendum = given.pair.rack().addendum_mm;
    let rack_form = RackForm {
        crowning_mm: amount(0.5, 0.0),
        tip_relief_mm: amount(0.4, 0.0),
        tip_relief_start_mm: 0.4 * addendum,
    };
    let pinion_form = PinionForm { crowning_mm: amount(0.4, 0.0), profile_slope_mm: amount(0.4, -0.015) };
    GivenPair { rack_form, pinion_form, ..given }
}

/// An error as its user knows it, beside what the bound is given.
#[derive(Debug, Clone, Copy)]
pub(in crate::judge) struct Drawn {
    pub(in crate::judge) error: ExtendedError,
    /// mm; rad for a rack lead; f_Hβ in mm for a pinion lead.
    pub(in crate::judge) value: f64,
    pub(in crate::judge) cap: Option<f64>,
}

fn length(mm: f64) -> Length {
    Length::from_mm(mm).unwrap()
}

fn angle(rad: f64) -> Angle {
    format!("{:.11}", rad / DEGREE).parse().unwrap()
}

/// An error of this kind (5: the pinion's lead) and extent.
pub(in crate::judge) fn drawn(pair: &Pair, kind: u32, extent: Extent, value: f64, cap: Option<f64>) -> Drawn {
    let alpha = angle(pair.normal_pressure_angle_rad());
    let (rack, pinion) = (pair.rack(), pair.pinion());
    let law = match kind {
        0 => Law::rack_over_roller(),
        1 => Law::rack_pitch(alpha, angle(rack.helix_angle_rad)).unwrap(),
        2 => {
            let law = Law::rack_lead(alpha, angle(rack.helix_angle_rad), length(rack.face_width_mm)).unwrap();
            let value = angle(value);
            let error = ExtendedError::new(law, value, extent).unwrap();
            return Drawn { error, value: value.radians(), cap };
        }
        3 => Law::pinion_radial(),
        4 => Law::pinion_pitch(alpha, angle(pinion.helix_angle_rad)).unwrap(),
        _ => Law::pinion_lead(alpha, angle(pinion.helix_angle_rad)).unwrap(),
    };
    let value = length(value);
    let mut error = ExtendedError::new(law, value, extent).unwrap();
    if let Some(cap) = cap {
        error = error.within_total(cap);
    }
    Drawn { error, value: value.mm(), cap }
}

/// An error of any kind and extent.
pub(in crate::judge) fn error(random: &mut Random, pair: &Pair) -> Drawn {
    let kind = random.below(6);
    let is_pitch = matches!(kind, 1 | 4);
    let extent = Extent::EVERY[random.below(if is_pitch { 5 } else { 4 }) as usize];
    let size = if random.chance(0.3) { random.range(0.0, 0.003) } else { random.range(0.0, 0.05) };
    let value = random.sign() * if kind == 2 { size * 6.0 * DEGREE } else { size };
    let cap = (is_pitch && extent == Extent::Each && random.chance(0.5)).then(|| size * random.range(1.0, 3.0));
    drawn(pair, kind, extent, value, cap)
}

/// A tooth in the middle of the strokes that are solved.
const MIDDLE: i64 = 2;

/// The same error as a tolerance between two shares of its value.
pub(in crate::judge) fn between(drawn: Drawn, [a, b]: [f64; 2]) -> Drawn {
    let [nearer, farther] = if a.abs() > b.abs() { [b, a] } else { [a, b] };
    let nearer_end = (nearer != -farther).then_some(nearer * drawn.value);
    let error = ExtendedError { value: farther * drawn.value, nearer_end, ..drawn.error };
    Drawn { error, value: error.value, ..drawn }
}

fn value_within(random: &mut Random, [lower, upper]: [f64; 2]) -> f64 {
    match random.unit() {
        share if share < 0.3 => lower,
        share if share < 0.6 => upper,
        _ => random.range(lower, upper),
    }
}

impl Placed {
    /// Puts an error on teeth that its extent allows.
    pub(in crate::judge) fn put(&mut self, random: &mut Random, drawn: &Drawn) {
        let ExtendedError { part, value, effect, .. } = drawn.error;
        match effect {
            ErrorEffect::Size => {
                let on = Self::teeth_of(random, drawn.error.extent);
                for space in self.teeth(part) {
                    let value = match drawn.error.extent {
                        Extent::Each => value_within(random, drawn.error.ends()),
                        _ if self.is_on(part, &on, space) => value,
                        _ => continue,
                    };
                    self.raise_space(part, space, value);
                }
            }
            ErrorEffect::Pitch { .. } => self.put_pitch(random, drawn, part, value),
            ErrorEffect::RackLead(_) | ErrorEffect::PinionLead { .. } => {
                let on = Self::teeth_of(random, drawn.error.extent);
                for tooth in self.teeth(part) {
                    let mut value = || match drawn.error.extent {
                        Extent::Each => value_within(random, drawn.error.ends()),
                        _ => drawn.value,
                    };
                    let values = BySide { left: value(), right: value() };
                    if drawn.error.extent != Extent::Each && !self.is_on(part, &on, tooth) {
                        continue;
                    }
                    self.turn(part, tooth, values);
                }
            }
        }
    }

    fn teeth_of(random: &mut Random, extent: Extent) -> std::ops::Range<i64> {
        let first = MIDDLE - 1 + i64::from(random.below(3));
        match extent {
            Extent::One => first..first + 1,
            Extent::Part => {
                let length = 2 + i64::from(random.below(8));
                let first = first - if random.chance(0.5) { length } else { 0 };
                first..first + length
            }
            _ => i64::MIN..i64::MAX,
        }
    }

    fn is_on(&self, part: Part, on: &std::ops::Range<i64>, tooth: i64) -> bool {
        let z = self.teeth(Part::Pinion).end() + 1;
        match part {
            Part::Rack => on.contains(&tooth),
            Part::Pinion if on.start == i64::MIN => true,
            Part::Pinion => (tooth - on.start).rem_euclid(z) < (on.end - on.start),
        }
    }

    fn put_pitch(&mut self, random: &mut Random, drawn: &Drawn, part: Part, value: f64) {
        let teeth: Vec<i64> = self.teeth(part).collect();
        if drawn.error.extent == Extent::Total {
            let sides = [(); 2].map(|()| total(random, teeth.len(), value.abs(), part == Part::Pinion));
            for (index, tooth) in teeth.into_iter().enumerate() {
                self.shift(part, tooth, BySide { left: sides[0][index], right: sides[1][index] });
            }
            return;
        }
        let start = MIDDLE - 1 + i64::from(random.below(3));
        let ends = steps_within(drawn);
        let sums = match part {
            Part::Rack => {
                let on = Self::teeth_of(random, drawn.error.extent);
                let mut sum = 0.0;
                let step = |tooth: i64, random: &mut Random| match drawn.error.extent {
                    Extent::Each => value_within(random, ends),
                    _ if on.contains(&tooth) => value,
                    _ => 0.0,
                };
                teeth
                    .iter()
                    .map(|&tooth| {
                        let next = sum + step(tooth, random);
                        if drawn.cap.is_none_or(|cap| next >= 0.0 && next <= cap) {
                            sum = next;
                        }
                        sum
                    })
                    .collect()
            }
            Part::Pinion => around(random, drawn, teeth.len(), value),
        };
        for (index, tooth) in teeth.into_iter().enumerate() {
            let tooth = if part == Part::Pinion { tooth + start } else { tooth };
            self.shift(part, tooth, BySide::both(sums[index]));
        }
    }
}

/// From what to what a step is off; some are none of a turn, and within a total.
fn steps_within(drawn: &Drawn) -> [f64; 2] {
    let [lower, upper] = drawn.error.ends();
    let turns_back = drawn.error.part == Part::Pinion || drawn.cap.is_some();
    if turns_back { [lower.min(0.0), upper.max(0.0)] } else { [lower, upper] }
}

/// Positions of pinion teeth whose pitches are off by up to a value, and close after a turn.
fn around(random: &mut Random, drawn: &Drawn, z: usize, value: f64) -> Vec<f64> {
    let mut steps = vec![0.0; z];
    match drawn.error.extent {
        Extent::One => {
            steps[0] = value;
            steps[1 + random.below(u32::try_from(z - 1).unwrap()) as usize] = -value;
        }
        Extent::Each => {
            let [lower, upper] = steps_within(drawn);
            steps.fill_with(|| value_within(random, [lower, upper]));
            // all go towards the one end or the other until they close
            let sum: f64 = steps.iter().sum();
            let end = if sum > 0.0 { lower } else { upper };
            let farther: f64 = steps.iter().map(|step| (step - end).abs()).sum();
            if farther > 0.0 {
                let share = sum.abs() / farther;
                for step in &mut steps {
                    *step += share * (end - *step);
                }
            }
        }
        _ => {
            let run = 1 + random.below(u32::try_from(z / 2).unwrap()) as usize;
            let back = run + random.below(u32::try_from(z - 2 * run + 1).unwrap()) as usize;
            for index in 0..run {
                (steps[index], steps[back + index]) = (value, -value);
            }
        }
    }
    let mut sum = 0.0;
    let sums: Vec<f64> = steps
        .iter()
        .map(|step| {
            sum += step;
            sum
        })
        .collect();
    let (low, high) = sums.iter().fold((0.0_f64, 0.0_f64), |(low, high), &sum| (low.min(sum), high.max(sum)));
    let share = drawn.cap.map_or(1.0, |cap| (cap / (high - low).max(1e-12)).min(1.0));
    sums.into_iter().map(|sum| sum * share).collect()
}

/// Cumulative deviations of one flank side within a range, of a turn's mean 0.
fn total(random: &mut Random, count: usize, range: f64, turn: bool) -> Vec<f64> {
    let sign = random.sign();
    let often = random.range(0.05, 0.6);
    let mut sums: Vec<f64> = (0..count)
        .map(|_| {
            if random.chance(often) { sign * range * if random.chance(0.7) { 1.0 } else { random.unit() } } else { 0.0 }
        })
        .collect();
    if turn {
        let mean = sums.iter().sum::<f64>() / count as f64;
        for sum in &mut sums {
            *sum -= mean;
        }
    }
    sums
}
