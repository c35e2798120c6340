//! How the rack is moved: a smooth start, then constant speed. The runs in time call it; it knows no bodies.
//!
//! With x = t/T the speed rises as v (10 x³ − 15 x⁴ + 6 x⁵), whose first and second derivatives vanish at both ends, so
//! the start excites nothing; it takes the travel v T/2.

use super::Parameters;

/// The stroke as a function of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drive {
    start_mm: f64,
    speed: f64,
    /// T.
    ramp_s: f64,
    /// Where the rack is half way there, and when, if it comes back.
    middle: Option<(f64, f64)>,
}

/// Where the rack is driven to, and how fast.
#[derive(Debug, Clone, Copy)]
pub(super) struct Driven {
    pub(super) time: f64,
    pub(super) stroke: f64,
    pub(super) speed: f64,
}

impl Drive {
    pub(super) fn new(p: &Parameters) -> Self {
        let ramp_mm = if p.returns { p.ramp_mm.min(0.5 * p.stroke_mm) } else { p.ramp_mm };
        let (start_mm, speed) = (p.start_mm, p.speed_mm_per_s);
        let there = Self { start_mm, speed, ramp_s: 2.0 * ramp_mm / speed, middle: None };
        let middle = start_mm + 0.5 * p.stroke_mm;
        Self { middle: p.returns.then(|| (middle, there.time_rising(middle))), ..there }
    }

    /// How long the rack takes to reach its speed.
    pub(super) fn run_up_s(&self) -> f64 {
        self.ramp_s
    }

    /// Where the rack is at a time since the start. It comes to rest as it starts, and goes back as it has come.
    pub(super) fn at(&self, time: f64) -> Driven {
        let Some((middle, half)) = self.middle else { return self.rising(time) };
        let there = 2.0 * half - (2.0 * half - time).abs();
        let at = self.rising(half - (half - there).abs());
        let stroke = if there > half { 2.0 * middle - at.stroke } else { at.stroke };
        Driven { time, stroke, speed: if time > 2.0 * half { -at.speed } else { at.speed } }
    }

    fn rising(&self, time: f64) -> Driven {
        if time >= self.ramp_s {
            let stroke = self.start_mm + self.speed * (time - 0.5 * self.ramp_s);
            return Driven { time, stroke, speed: self.speed };
        }
        let x = (time / self.ramp_s).max(0.0);
        let cube = x * x * x;
        let travel = self.speed * self.ramp_s * cube * x * (2.5 - x * (3.0 - x));
        let speed = self.speed * cube * (10.0 - x * (15.0 - 6.0 * x));
        Driven { time, stroke: self.start_mm + travel, speed }
    }

    /// The time at which a stroke is reached, there or on the way back.
    pub(super) fn time(&self, stroke_mm: f64, is_back: bool) -> f64 {
        let Some((middle, half)) = self.middle else { return self.time_rising(stroke_mm) };
        let beyond = stroke_mm > middle;
        let rising = self.time_rising(if beyond { 2.0 * middle - stroke_mm } else { stroke_mm });
        let there = if beyond { 2.0 * half - rising } else { rising };
        if is_back { 4.0 * half - there } else { there }
    }

    fn time_rising(&self, stroke_mm: f64) -> f64 {
        let travel = stroke_mm - self.start_mm;
        let even = travel / self.speed + 0.5 * self.ramp_s;
        if even >= self.ramp_s {
            return even;
        }
        let (mut low, mut high) = (0.0, self.ramp_s);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return high;
            }
            if self.rising(middle).stroke - self.start_mm < travel {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_at_rest_reaches_its_speed_and_inverts() {
        let drive = Drive::new(&Parameters { start_mm: 3.0, ..Parameters::default() });
        let at = |time| {
            let Driven { stroke, speed, .. } = drive.at(time);
            (stroke, speed)
        };
        assert_eq!(at(0.0), (3.0, 0.0));
        let (stroke, speed) = at(0.1 - 1e-12);
        assert!((stroke - 4.0).abs() < 1e-9 && (speed - 20.0).abs() < 1e-9);
        let mut last = (3.0, 0.0);
        for step in 1..=400 {
            let time = 0.0005 * f64::from(step);
            let now = at(time);
            assert!((now.0 - last.0 - 0.00025 * (now.1 + last.1)).abs() < 1e-6, "speed is the stroke's rate");
            assert!((drive.time(now.0, false) - time).abs() < 1e-5);
            last = now;
        }
    }
    #[test]
    fn comes_back_as_it_has_gone() {
        for stroke_mm in [0.5, 10.0] {
            let drive = Drive::new(&Parameters { start_mm: 3.0, stroke_mm, returns: true, ..Parameters::default() });
            let turn = drive.time(3.0 + stroke_mm, false);
            assert!(drive.at(turn).speed.abs() < 1e-9 && (drive.at(turn).stroke - 3.0 - stroke_mm).abs() < 1e-9);
            for share in [0.05, 0.3, 0.5, 0.77, 0.98] {
                let (there, back) = (drive.at(share * turn), drive.at((2.0 - share) * turn));
                assert!((there.stroke - back.stroke).abs() < 1e-12 && (there.speed + back.speed).abs() < 1e-12);
                let inner = 3.0 + share * stroke_mm;
                for is_back in [false, true] {
                    assert!((drive.at(drive.time(inner, is_back)).stroke - inner).abs() < 1e-9, "{inner} {is_back}");
                }
            }
        }
    }
}
