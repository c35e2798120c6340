//! A small plot in the terminal, drawn with braille dots. Called by the reports of curves where the screen can show it.

use super::number::signed;

/// Columns left of the dots.
const AXIS: usize = 10;

/// Draws a curve along the stroke in width by height characters, with the range of y at the left and that of x below. `None`
/// if there is no room or no curve.
pub(super) fn sketch(points: &[(f64, f64)], label: &str, size: [usize; 2]) -> Option<String> {
    let (first, last) = (points.first()?, points.last()?);
    labelled(points, size, label, [format!("{:.1}", first.0), format!("{:.1} mm", last.0)])
}

/// Draws `points` in the order of x, with the name of y and the texts below the ends of x.
pub(super) fn labelled(
    points: &[(f64, f64)],
    [width, height]: [usize; 2],
    label: &str,
    [from, to]: [String; 2],
) -> Option<String> {
    let (first, last) = (points.first()?, points.last()?);
    let columns = width.checked_sub(AXIS + 1).filter(|columns| *columns >= 10)?;
    let (low, high) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.1), high.max(p.1)));
    if !(last.0 > first.0 && (high - low).is_finite()) || height == 0 {
        return None;
    }
    let (dots_x, dots_y) = (2 * columns, 4 * height);
    let mut cells = vec![vec![0_u8; columns]; height];
    // a level curve runs through the middle
    let scale = if high > low { 1.0 / (high - low) } else { 0.0 };
    let row = |y: f64| {
        let share = if scale > 0.0 { (high - y) * scale } else { 0.5 };
        // the share lies between 0 and 1
        let dot = (share * (dots_y - 1) as f64).round() as usize;
        dot.min(dots_y - 1)
    };
    let mut previous: Option<usize> = None;
    let mut next = 0;
    for dot in 0..dots_x {
        let x = first.0 + (last.0 - first.0) * dot as f64 / (dots_x - 1) as f64;
        while next + 1 < points.len() && points[next + 1].0 < x {
            next += 1;
        }
        let (a, b) = (points[next], points[(next + 1).min(points.len() - 1)]);
        let y = if b.0 > a.0 { a.1 + (b.1 - a.1) * ((x - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { b.1 };
        let here = row(y);
        let from = previous.unwrap_or(here);
        for line in from.min(here)..=from.max(here) {
            cells[line / 4][dot / 2] |= braille_bit(dot % 2, line % 4);
        }
        previous = Some(here);
    }
    let mut out = String::new();
    for (index, line) in cells.iter().enumerate() {
        let label = match index {
            0 => signed(high, 4),
            _ if index + 1 == height => signed(low, 4),
            _ => String::new(),
        };
        out.push_str(&format!("{label:>AXIS$} "));
        out.extend(line.iter().map(|bits| char::from_u32(0x2800 + u32::from(*bits)).unwrap_or(' ')));
        out.push('\n');
    }
    let gap = columns.saturating_sub(from.chars().count() + to.chars().count());
    out.push_str(&format!("{label:AXIS$} {from}{:gap$}{to}", ""));
    Some(out)
}

/// The bit of a dot in a braille character of two columns and four lines.
fn braille_bit(column: usize, line: usize) -> u8 {
    const BITS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];
    BITS[column][line]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_a_step() {
        let points = [(0.0, 0.0), (5.0, 0.0), (5.0, 0.02), (10.0, 0.02)];
        let drawn = sketch(&points, "ΔCD [mm]", [21, 2]).unwrap();
        let lines: Vec<_> = drawn.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[0].starts_with("   +0.0200 ⠀⠀⠀⠀") && lines[0].ends_with('⠉'), "{drawn}");
        assert!(lines[1].starts_with("    0.0000 ⣀⣀⣀⣀") && lines[1].ends_with('⠀'), "{drawn}");
        assert!(lines[2].ends_with("10.0 mm"), "{drawn}");
        assert!(sketch(&points, "ΔCD [mm]", [15, 2]).is_none());
        assert!(sketch(&[(0.0, f64::NAN), (1.0, 0.0)], "", [60, 2]).is_some());
        assert!(sketch(&[], "", [60, 2]).is_none());
    }
}
