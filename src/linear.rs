//! Vectors in space, systems of at most three linear equations, and least squares. Called by the multibody model and for
//! measured curves.

/// The scalar product a · b.
pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Adds `by(row, column)` to each entry of a matrix.
pub(crate) fn increase<const N: usize>(matrix: &mut [[f64; N]; N], by: impl Fn(usize, usize) -> f64) {
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += by(i, j);
        }
    }
}

/// Solves K x = r for the first n ≤ 3 equations by Gaussian elimination, with pivots on the diagonal; `None` if a pivot is
/// not positive.
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

/// A least-squares fit of columns to values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeastSquares {
    /// The factor of each column.
    pub(crate) coefficients: Vec<f64>,
    /// The inverse of the normal matrix; σ² times it is the covariance of the coefficients.
    pub(crate) inverse: Vec<Vec<f64>>,
    /// The weighted sum of squares of values less fit.
    pub(crate) rest: f64,
}

/// Fits columns to values, each row with its weight; `None` if the columns are linearly dependent.
pub(crate) fn least_squares(columns: &[&[f64]], weights: &[f64], values: &[f64]) -> Option<LeastSquares> {
    /// A column is dependent if the others explain all of its square but this share.
    const DEPENDENT: f64 = 1e-9;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(weights).map(|((a, b), w)| w * a * b).sum::<f64>();
    let n = columns.len();
    let scale: Vec<f64> = columns.iter().map(|column| product(column, column).sqrt()).collect();
    if scale.iter().any(|scale| !(scale.is_finite() && *scale > 0.0)) {
        return None;
    }
    // the normal matrix of the columns scaled to length 1, and beside it the unit matrix, which becomes its inverse
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let entry = |j: usize| product(columns[i], columns[j]) / (scale[i] * scale[j]);
            let unit = (0..n).map(|j| if i == j { 1.0 } else { 0.0 });
            (0..n).map(entry).chain(unit).collect()
        })
        .collect();
    for i in 0..n {
        let pivot = rows[i][i];
        if pivot <= DEPENDENT {
            return None;
        }
        rows[i].iter_mut().for_each(|entry| *entry /= pivot);
        let row = rows[i].clone();
        for (_, other) in rows.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let factor = other[i];
            other.iter_mut().zip(&row).for_each(|(entry, by)| *entry -= factor * by);
        }
    }
    let inverse: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| rows[i][n + j] / (scale[i] * scale[j])).collect()).collect();
    let right: Vec<f64> = columns.iter().map(|column| product(column, values)).collect();
    let coefficients: Vec<f64> = inverse.iter().map(|row| row.iter().zip(&right).map(|(a, b)| a * b).sum()).collect();
    let rest = values.iter().enumerate().map(|(at, value)| {
        let fitted: f64 = columns.iter().zip(&coefficients).map(|(column, by)| column[at] * by).sum();
        weights[at] * (value - fitted) * (value - fitted)
    });
    let rest = rest.sum();
    Some(LeastSquares { coefficients, inverse, rest })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through four points; dependent columns.
    #[test]
    fn least_squares_fit_and_refuse_what_is_said_twice() {
        let (ones, x) = ([1.0; 4], [0.0, 1.0, 2.0, 3.0]);
        let fit = least_squares(&[&ones, &x], &[1.0; 4], &[1.0, 2.9, 5.1, 7.0]).unwrap();
        assert!((fit.coefficients[0] - 0.97).abs() < 1e-12 && (fit.coefficients[1] - 2.02).abs() < 1e-12);
        assert!((fit.rest - 0.018).abs() < 1e-12 && (fit.inverse[1][1] - 0.2).abs() < 1e-12);
        assert_eq!(least_squares(&[&ones, &x, &[2.0, 3.0, 4.0, 5.0]], &[1.0; 4], &x), None);
        let weighted = least_squares(&[&ones], &[1.0, 0.0, 0.0, 3.0], &x).unwrap();
        assert!((weighted.coefficients[0] - 2.25).abs() < 1e-12);
    }
}
