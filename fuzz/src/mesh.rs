//! The mesh solver on arbitrary pairs that look valid: every position is solved with its two sides agreeing,
//! or refused with a reason; nothing is NaN and nothing hangs.

use rackmesh::deviation::{
    PinionDeviation, PinionDeviationKind, PinionFlanks, PinionForm, RackDeviation, RackDeviationKind, RackFlanks,
    RackForm, ToothRange,
};
use rackmesh::gear::{Pair, PairData, PinionData, RackData};
use rackmesh::mesh::{Mesh, Support};

/// The input read as numbers, two bytes each; zero once it is used up.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    fn next(&mut self) -> u16 {
        let (head, rest) = self.0.split_at(self.0.len().min(2));
        self.0 = rest;
        u16::from_le_bytes([head.first().copied().unwrap_or(0), head.get(1).copied().unwrap_or(0)])
    }

    fn in_range(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * f64::from(self.next()) / f64::from(u16::MAX)
    }

    fn whole(&mut self, from: i64, to: i64) -> i64 {
        from + i64::from(self.next()) % (to - from + 1)
    }

    fn teeth(&mut self, from: i64, to: i64) -> ToothRange {
        let first = self.whole(from, to);
        match self.whole(0, 2) {
            0 => ToothRange::ALL,
            1 => ToothRange::new(Some(first), None).unwrap_or(ToothRange::ALL),
            _ => ToothRange::single(first).unwrap_or(ToothRange::ALL),
        }
    }
}

/// Builds a pair from the input and solves it at some strokes and along a short one.
pub fn check(data: &[u8]) {
    let mut numbers = Numbers(data);
    let Some(mesh) = read(&mut numbers) else { return };
    for _ in 0..4 {
        let stroke = numbers.in_range(-20.0, 120.0);
        if let Ok(point) = mesh.at(stroke) {
            assert!(point.delta_cd_mm.is_finite() && point.pinion_angle_rad.is_finite(), "{point:?}");
            assert!(point.residual_mm.is_finite(), "{point:?}");
            // an answer that says it converged means it
            assert!(!point.converged() || point.residual_mm.abs() < 1e-6, "{point:?}");
        }
    }
    if let Ok(curve) = mesh.curve(0.0, 2.0, 1e-4) {
        assert!(curve.points.iter().all(|point| point.delta_cd_mm.is_finite()));
    }
}

/// The mesh that an input stands for, if it is one.
fn read(numbers: &mut Numbers<'_>) -> Option<Mesh> {
    let pair = Pair::new(&pair(numbers)).ok()?;
    deviating(numbers, pair)
}

fn pair(numbers: &mut Numbers<'_>) -> PairData {
    let normal_module_mm = numbers.in_range(0.1, 5.0);
    let teeth = u32::try_from(numbers.whole(1, 120)).unwrap_or(1);
    let helix = |numbers: &mut Numbers<'_>| match numbers.whole(0, 2) {
        0 => 0.0,
        _ => numbers.in_range(-0.8, 0.8),
    };
    let (rack_helix, pinion_helix) = (helix(numbers), helix(numbers));
    let profile_shift = numbers.in_range(-1.0, 1.5);
    let reference = normal_module_mm * f64::from(teeth) / rackmesh::trig::cos(pinion_helix);
    PairData {
        normal_module_mm,
        normal_pressure_angle_rad: numbers.in_range(0.01, 0.785),
        rack: RackData {
            helix_angle_rad: rack_helix,
            face_width_mm: numbers.in_range(0.1, 60.0),
            addendum_mm: normal_module_mm * numbers.in_range(0.1, 1.6),
            tooth_thickness_mm: (numbers.whole(0, 3) == 0).then(|| normal_module_mm * numbers.in_range(0.2, 3.0)),
        },
        pinion: PinionData {
            teeth,
            helix_angle_rad: pinion_helix,
            profile_shift,
            tip_diameter_mm: reference + 2.0 * normal_module_mm * (profile_shift + numbers.in_range(0.1, 1.6)),
            root_form_diameter_mm: (numbers.whole(0, 1) == 0)
                .then(|| reference + 2.0 * normal_module_mm * (profile_shift - numbers.in_range(0.1, 1.6))),
            face_width_mm: numbers.in_range(0.1, 60.0),
            tooth_thickness_deviation_mm: numbers.in_range(-0.2, 0.1),
        },
    }
}

fn deviating(numbers: &mut Numbers<'_>, pair: Pair) -> Option<Mesh> {
    let mut on_rack = Vec::new();
    for _ in 0..numbers.whole(0, 4) {
        let teeth = numbers.teeth(-4, 12);
        let value = numbers.in_range(-0.3, 0.3);
        let kind = match numbers.whole(0, 6) {
            0 => RackDeviationKind::OverRoller(value),
            1 => RackDeviationKind::Pitch(value),
            2 => RackDeviationKind::Shift(value),
            3 => RackDeviationKind::Thickness(value),
            4 => RackDeviationKind::Lead(value / 10.0),
            5 => RackDeviationKind::Left(value),
            _ => RackDeviationKind::Right(value),
        };
        on_rack.push(RackDeviation { teeth, kind });
    }
    let last = i64::from(pair.pinion().teeth) - 1;
    let mut on_pinion = Vec::new();
    for _ in 0..numbers.whole(0, 4) {
        let teeth = numbers.teeth(0, last);
        let value = numbers.in_range(-0.3, 0.3);
        let kind = match numbers.whole(0, 5) {
            0 => PinionDeviationKind::Shift(value),
            1 => PinionDeviationKind::Thickness(value),
            2 => PinionDeviationKind::Lead(value / 10.0),
            3 => PinionDeviationKind::Left(value),
            4 => PinionDeviationKind::Right(value),
            _ => PinionDeviationKind::Radial(value),
        };
        on_pinion.push(PinionDeviation { teeth, kind });
    }
    let mut rack = RackFlanks::new(&pair, &on_rack).ok()?;
    if numbers.whole(0, 3) == 0 {
        let kind = PinionDeviationKind::Eccentricity(numbers.in_range(-0.2, 0.2));
        on_pinion.push(PinionDeviation { teeth: ToothRange::single(numbers.whole(0, last)).ok()?, kind });
    }
    let mut pinion = PinionFlanks::new(&pair, &on_pinion).ok()?;
    let (rolls, formed) = match numbers.whole(0, 5) {
        0 => (true, false),
        1 => (false, true),
        2 => (true, true),
        _ => (false, false),
    };
    if formed {
        let crowning_mm = numbers.in_range(0.0, 0.05);
        let form =
            PinionForm { crowning_mm: numbers.in_range(0.0, 0.05), profile_slope_mm: numbers.in_range(-0.02, 0.02) };
        let tip_relief_mm = numbers.in_range(0.0, 0.05);
        let below_tip = pair.normal_module_mm() * numbers.in_range(0.0, 1.2);
        let tip_relief_start_mm = pair.rack().addendum_mm - below_tip;
        rack = rack.with_form(&pair, RackForm { crowning_mm, tip_relief_mm, tip_relief_start_mm }).ok()?;
        pinion = pinion.with_form(form).ok()?;
    }
    let support =
        if rolls { Support::FreeRoll { axis_depth_mm: numbers.in_range(-5.0, 20.0) } } else { Support::Fixed };
    Mesh::new(pair, rack, pinion, support).ok()
}
