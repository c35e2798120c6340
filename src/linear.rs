//! Systems of at most three linear equations. Called by the multibody model's iterations; larger systems have no place
//! here.

/// Gaussian elimination of n ≤ 3 equations with pivots on the diagonal; `None` if one is not positive.
#[allow(clippy::needless_range_loop)] // matrices read as in the books
pub(crate) fn solve(mut k: [[f64; 3]; 3], mut r: [f64; 3], n: usize) -> Option<[f64; 3]> {
    for i in 0..n {
        if k[i][i] <= 0.0 || !k[i][i].is_finite() {
            return None;
        }
        for j in i + 1..n {
            let factor = k[j][i] / k[i][i];
            for l in i..n {
                k[j][l] -= factor * k[i][l];
            }
            r[j] -= factor * r[i];
        }
    }
    for i in (0..n).rev() {
        for l in i + 1..n {
            r[i] -= k[i][l] * r[l];
        }
        r[i] /= k[i][i];
    }
    Some(r)
}
