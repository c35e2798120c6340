use super::*;
use crate::gear::{Pair, PairData, PinionData, RackData};

fn base() -> Mesh {
    let radians = |degrees: f64| degrees * std::f64::consts::PI / 180.0;
    let pair = Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: radians(19.9),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 19.7, addendum_mm: 1.7, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 8,
            helix_angle_rad: radians(21.0),
            profile_shift: 0.3,
            tip_diameter_mm: 19.738,
            root_form_diameter_mm: None,
            face_width_mm: 30.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .unwrap();
    Mesh::nominal(pair).unwrap()
}

fn of<'a>(base: &'a Mesh, scatter: &'a Scatter) -> Racks<'a> {
    Racks { base, scatter, limit: None, yoke: None }
}

fn settings(racks: u64) -> RackSettings {
    RackSettings { seed: 1, range: RackRange { first_rack: 0, racks }, from_mm: 0.0, to_mm: 50.0, threads: None }
}

fn all() -> Scatter {
    Scatter {
        rack_pitch: Some(Uncertainty::standard(0.004)),
        rack_thickness: Some(Uncertainty::half_width(0.005, Distribution::Rectangular)),
        pinion_pitch: Some(Uncertainty::standard(0.003)),
        pinion_runout: Some(Uncertainty::half_width(0.01, Distribution::Rectangular)),
        ..Scatter::default()
    }
}

#[test]
fn equal_steps_meet_the_extremes_and_the_mean_of_the_adaptive_curve() {
    let base = base();
    let (scatter, settings) = (all(), settings(12));
    let racks = of(&base, &scatter);
    let draw = Draw::new(&racks, &settings).unwrap();
    for rack in 0..settings.range.racks {
        let mesh = draw.mesh(&mut [Random::of_block(1, rack)]).unwrap().unwrap();
        let exact = mesh.curve(0.0, 50.0, 1e-6).unwrap().summary(&mesh).unwrap();
        let sampled = draw.rack(rack).unwrap();
        assert!((exact.mean_mm - sampled.mean_mm).abs() < 1e-4, "{rack}: {} {}", exact.mean_mm, sampled.mean_mm);
        for (exact, sampled) in [(exact.min_mm, sampled.min_mm), (exact.max_mm, sampled.max_mm)] {
            assert!((exact - sampled).abs() < 3e-4, "{rack}: {exact} {sampled}");
        }
    }
}

/// Standard deviation as asked for, bounds reached and kept, mean 0, and a fourth moment of each shape's own.
#[test]
fn values_are_spread_as_asked_for() {
    let base = base();
    let scatter = all();
    let racks = of(&base, &scatter);
    let draw = Draw::new(&racks, &settings(1)).unwrap();
    let mut random = Random::of_block(3, 0);
    // E x⁴ / (E x²)²
    let shapes = [
        (Distribution::Normal, 3.0),
        (Distribution::Rectangular, 1.8),
        (Distribution::Triangular, 2.4),
        (Distribution::Arcsine, 1.5),
    ];
    for (distribution, kurtosis) in shapes {
        let spread = Uncertainty::half_width(3.0, distribution);
        let values: Vec<f64> = (0..40_000).map(|_| random.spread(&spread, &draw.ziggurat)).collect();
        let mean = |f: fn(f64) -> f64| values.iter().map(|x| f(*x)).sum::<f64>() / 40_000.0;
        let (square, fourth, u) = (mean(|x| x * x), mean(|x| x * x * x * x), spread.standard);
        assert!(mean(|x| x).abs() < 0.03 * u, "{distribution:?}");
        assert!((square.sqrt() / u - 1.0).abs() < 0.02, "{distribution:?} {square}");
        assert!((fourth / (square * square) - kurtosis).abs() < 0.12, "{distribution:?} {fourth}");
        if distribution != Distribution::Normal {
            let largest = values.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            assert!(largest <= 3.0 && largest > 2.95, "{distribution:?} {largest}");
        }
    }
}

/// Racks drawn with one kind of deviation only, each as its own definition says; and pinions.
#[test]
fn each_kind_of_deviation_goes_where_it_belongs() {
    let data = PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: 0.35,
        rack: RackData {
            helix_angle_rad: std::f64::consts::FRAC_PI_3,
            face_width_mm: 20.0,
            addendum_mm: 1.7,
            tooth_thickness_mm: None,
        },
        pinion: PinionData {
            teeth: 12,
            helix_angle_rad: -1.0,
            profile_shift: 0.0,
            tip_diameter_mm: 48.0,
            root_form_diameter_mm: None,
            face_width_mm: 30.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    };
    // thickness across the teeth is twice as much along a rack of 60°
    let base = Mesh::nominal(Pair::new(&data).unwrap()).unwrap();
    let settings = settings(1);
    let drawn = |scatter: Scatter, seed| {
        let racks = of(&base, &scatter);
        let draw = Draw::new(&racks, &settings).unwrap();
        let mesh = draw.mesh(&mut [Random::of_block(seed, 0)]).unwrap().unwrap();
        let rack: Vec<RackTooth> = draw.teeth.clone().map(|tooth| mesh.rack().tooth(tooth)).collect();
        let pinion = mesh.pinion().teeth().to_vec();
        (rack, pinion, mesh.pinion().eccentricity_mm())
    };
    let half = Uncertainty::half_width(0.01, Distribution::Rectangular);
    let spread = Some(half);
    let reaches = |values: &mut dyn Iterator<Item = f64>, half: f64| {
        let largest = values.fold(0.0_f64, |largest, x| largest.max(x.abs()));
        assert!(largest <= half * (1.0 + 1e-12) && largest > 0.6 * half, "{largest} {half}");
    };
    let none = Scatter::default();

    // a step from tooth to tooth stays within the half-width, so each place within half of it
    let (rack, ..) = drawn(Scatter { rack_pitch: spread, ..none }, 1);
    assert!(rack.iter().all(|tooth| tooth.left == tooth.right && tooth.left.along_z_mm == 0.0));
    reaches(&mut rack.iter().map(|tooth| tooth.left.along_x_mm), 0.005);

    let (rack, ..) = drawn(Scatter { rack_thickness: spread, ..none }, 2);
    assert!(rack.iter().all(|tooth| tooth.left.along_x_mm == -tooth.right.along_x_mm));
    reaches(&mut rack.iter().map(|tooth| tooth.right.along_x_mm), 0.01);

    let (rack, ..) = drawn(Scatter { rack_pitch: spread, rack_thickness: spread, ..none }, 3);
    let middle = |tooth: &RackTooth| 0.5 * (tooth.left.along_x_mm + tooth.right.along_x_mm);
    reaches(&mut rack.iter().map(middle), 0.005);
    reaches(&mut rack.iter().map(|tooth| tooth.right.along_x_mm - middle(tooth)), 0.01);

    let (rack, ..) = drawn(Scatter { rack_lead: spread, ..none }, 4);
    assert!(rack.iter().all(|tooth| tooth.left == tooth.right && tooth.left.along_x_mm == 0.0));
    reaches(&mut rack.iter().map(|tooth| tooth.right.lead_rad), 0.01);

    let (rack, ..) = drawn(Scatter { rack_over_roller: spread, ..none }, 5);
    reaches(&mut rack.iter().map(|tooth| tooth.right.along_z_mm), 0.01);
    assert!(rack.iter().all(|tooth| tooth.left == tooth.right && tooth.left.lead_rad == 0.0));

    let (_, pinion, _) = drawn(Scatter { pinion_pitch: spread, ..none }, 6);
    assert!(pinion.iter().all(|tooth| tooth.left == tooth.right));
    reaches(&mut pinion.iter().map(|tooth| tooth.left.arc_mm), 0.005);

    let (_, pinion, _) = drawn(Scatter { pinion_lead: spread, ..none }, 6);
    assert!(pinion.iter().all(|tooth| tooth.left == tooth.right && tooth.left.arc_mm == 0.0));
    let largest = pinion_lead_angle_rad(base.pair(), 0.01);
    reaches(&mut pinion.iter().map(|tooth| tooth.left.lead_rad), largest);

    let (_, pinion, offset) = drawn(Scatter { pinion_thickness: spread, ..none }, 7);
    assert!(pinion.iter().all(|tooth| tooth.left.arc_mm == -tooth.right.arc_mm));
    reaches(&mut pinion.iter().map(|tooth| tooth.right.arc_mm), 0.005);
    assert_eq!(offset, (0.0, 0.0));

    // one offset a pinion: half the runout in any direction
    let offsets = |runout: Uncertainty, seeds: std::ops::Range<u64>| -> Vec<(f64, f64)> {
        seeds.map(|seed| drawn(Scatter { pinion_runout: Some(runout), ..none }, seed).2).collect()
    };
    let any = offsets(half, 0..60);
    reaches(&mut any.iter().map(|(along, across)| (along * along + across * across).sqrt()), 0.005);
    for (right, above) in [(true, true), (true, false), (false, true), (false, false)] {
        let count = any.iter().filter(|(along, across)| (*along > 0.0, *across > 0.0) == (right, above)).count();
        assert!(count >= 5, "{count}");
    }
    let normal = offsets(Uncertainty::standard(0.01), 0..400);
    for square in [
        normal.iter().map(|(along, _)| along * along).sum::<f64>() / 400.0,
        normal.iter().map(|(_, across)| across * across).sum::<f64>() / 400.0,
    ] {
        assert!((square.sqrt() / 0.005 - 1.0).abs() < 0.15, "{square}");
    }
}

fn run(base: &Mesh, scatter: &Scatter, settings: &RackSettings) -> Result<Vec<RackResult>, RacksError> {
    stopped_by(&AtomicBool::new(false), base, scatter, settings)
}

fn stopped_by(
    stop: &AtomicBool,
    base: &Mesh,
    scatter: &Scatter,
    settings: &RackSettings,
) -> Result<Vec<RackResult>, RacksError> {
    let mut all = Vec::new();
    of(base, scatter).simulate(settings, stop, |first_rack, results| {
        assert_eq!(first_rack, settings.range.first_rack + all.len() as u64);
        all.extend_from_slice(results);
        Ok::<_, RacksError>(())
    })?;
    Ok(all)
}

#[test]
fn a_run_that_is_stopped_has_the_first_racks() {
    let (base, scatter, stop) = (base(), all(), AtomicBool::new(false));
    let most = RackSettings { threads: Some(2), ..settings(1_000_000) };
    let some = std::thread::scope(|scope| {
        let running = scope.spawn(|| stopped_by(&stop, &base, &scatter, &most));
        std::thread::sleep(std::time::Duration::from_millis(300));
        stop.store(true, Ordering::Relaxed);
        running.join().unwrap().unwrap()
    });
    assert!(some.len() < 1_000_000, "{}", some.len());
    let few = some.len().min(5);
    assert_eq!(some[..few], run(&base, &scatter, &settings(5)).unwrap()[..few]);
    assert_eq!(stopped_by(&AtomicBool::new(true), &base, &scatter, &settings(5)).unwrap(), []);
}

#[test]
fn the_same_bits_at_any_number_of_threads() {
    let (base, scatter) = (base(), all());
    let with = |threads| run(&base, &scatter, &RackSettings { threads, ..settings(20) }).unwrap();
    let one = with(Some(1));
    assert_eq!(one, with(Some(3)));
    assert_eq!(one, with(None));
    assert_eq!(one[..5], run(&base, &scatter, &settings(5)).unwrap());
}

#[test]
fn what_scatters_alone_or_most_makes_the_spread() {
    let (base, stop) = (base(), AtomicBool::new(false));
    let racks = |scatter| of(&base, scatter);
    let settings = RackSettings { to_mm: 15.0, ..settings(120) };
    let runout = Scatter { pinion_runout: Some(Uncertainty::standard(0.01)), ..Scatter::default() };
    let alone = racks(&runout).contributions(&settings, &stop, |_| ()).unwrap();
    assert_eq!((alone.samples, alone.racks, alone.indices.len()), (120, 360, 3));
    for Contribution { first_order, total, .. } in &alone.indices {
        let [first_order, total] = [first_order, total].map(|of| of.unwrap());
        assert!((first_order.value - 1.0).abs() < 0.3 && first_order.lower < 1.0, "{first_order:?}");
        assert!((total.value - 1.0).abs() < 0.3 && total.upper > 1.0, "{total:?}");
    }
    // one that is a tenth of the other makes a hundredth
    let two = Scatter { rack_thickness: Some(Uncertainty::standard(0.000_5)), ..runout };
    let found = racks(&two).contributions(&settings, &stop, |_| ()).unwrap();
    let total = |of: &str| found.indices.iter().find(|index| index.of == of && index.delta_cd == "peak_to_peak");
    let total = |of| total(of).unwrap().total.unwrap();
    assert!(total("rack_thickness").upper < 0.1 && total("pinion_runout").lower > 0.6, "{found:?}");
    let one_thread = RackSettings { threads: Some(1), ..settings };
    assert_eq!(racks(&two).contributions(&one_thread, &stop, |_| ()).unwrap(), found);
}

#[test]
fn contributions_that_are_stopped_are_of_the_first_samples() {
    let (base, scatter, stop) = (base(), all(), AtomicBool::new(false));
    let racks = of(&base, &scatter);
    let settings = RackSettings { to_mm: 10.0, threads: Some(2), ..settings(60) };
    let found = racks.contributions(&settings, &stop, |done| stop.store(done >= 20, Ordering::Relaxed)).unwrap();
    assert!((20..60).contains(&found.samples) && found.asked == 60, "{found:?}");
    let first = RackSettings { range: RackRange { racks: found.samples, ..settings.range }, ..settings };
    let again = racks.contributions(&first, &AtomicBool::new(false), |_| ()).unwrap();
    assert_eq!(again.indices, found.indices);
    let none = racks.contributions(&settings, &AtomicBool::new(true), |_| ()).unwrap();
    assert!(none.samples == 0 && none.indices.iter().all(|index| index.total.is_none()), "{none:?}");
}

#[test]
fn of_teeth_that_sit_high_and_low_the_high_ones_carry() {
    // so the mean lies above 0, and below the standard deviation: two or three teeth share the contact
    let base = base();
    let scatter = Scatter { rack_over_roller: Some(Uncertainty::standard(0.003)), ..Scatter::default() };
    let results = run(&base, &scatter, &settings(40)).unwrap();
    let mean = results.iter().map(|result| result.mean_mm).sum::<f64>() / 40.0;
    assert!(mean > 0.0 && mean < 0.003, "{mean}");
    assert!(results.iter().all(|result| result.min_mm <= result.mean_mm && result.mean_mm <= result.max_mm));
}

#[test]
fn what_cannot_be_drawn_says_why() {
    let base = base();
    let run = |scatter: &Scatter, settings: &RackSettings| run(&base, scatter, settings).unwrap_err();
    assert_eq!(run(&Scatter::default(), &settings(1)), RacksError::NothingScatters);
    assert_eq!(run(&all(), &settings(0)), RacksError::Count { first_rack: 0, racks: 0 });
    let empty = RackSettings { to_mm: 0.0, ..settings(1) };
    assert!(matches!(run(&all(), &empty), RacksError::Stroke { .. }));
    // as many as have numbers are not too many; one more is
    let from = |first_rack, racks| RackSettings { range: RackRange { first_rack, racks }, ..empty };
    assert!(matches!(run(&all(), &from(1, u64::MAX - 1)), RacksError::Stroke { .. }));
    assert_eq!(run(&all(), &from(1, u64::MAX)), RacksError::Count { first_rack: 1, racks: u64::MAX });
    let huge = Scatter { rack_pitch: Some(Uncertainty::standard(50.0)), ..Scatter::default() };
    assert!(matches!(run(&huge, &settings(3)), RacksError::Mesh { .. }));
}
