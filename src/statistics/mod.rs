//! Statistics that know nothing of gears: [distribution](self) functions and quantiles, [`capability`].

pub mod capability;
mod distribution;
mod moments;

pub use distribution::*;
pub(crate) use moments::LengthMoments;

/// Where the quantile of a share of some values lies: how many lie before its lower order statistic, and how far it is from that one
/// to the next, 0 to 1: at rank 1 + (n − 1) q (type 7 of Hyndman and Fan, "Sample quantiles in statistical packages", 1996).
#[cfg(feature = "batch")]
pub(crate) fn quantile_place(share: f64, count: u64) -> (u64, f64) {
    let last = count.saturating_sub(1);
    let place = share.clamp(0.0, 1.0) * last as f64;
    let before = (place.floor() as u64).min(last);
    (before, place - before as f64)
}
