//! Vectors in space, and systems of at most three linear equations. Called by the multibody model; larger systems have
//! no place here.

/// The scalar product.
pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Adds to each entry of a matrix what belongs to its row and column.
pub(crate) fn increase<const N: usize>(matrix: &mut [[f64; N]; N], by: impl Fn(usize, usize) -> f64) {
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += by(i, j);
        }
    }
}

/// Gaussian elimination of n ≤ 3 equations with pivots on the diagonal; `None` if one is not positive.
pub(crate) fn solve(mut k: [[f64; 3]; 3], mut r: [f64; 3], n: usize) -> Option<[f64; 3]> {
    for i in 0..n {
        let pivot = k[i];
        if pivot[i] <= 0.0 || !pivot[i].is_finite() {
            return None;
        }
        for j in i + 1..n {
            let factor = k[j][i] / pivot[i];
            for (entry, above) in k[j].iter_mut().zip(pivot) {
                *entry -= factor * above;
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
