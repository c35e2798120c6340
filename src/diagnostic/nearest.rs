//! The name that a misspelt one most likely stands for. Called by whoever refuses a name.

/// The name most like a misspelt one, if any is like it at all. Capitals, `-` and `_` make no difference.
pub(crate) fn nearest<S: AsRef<str>>(name: &str, candidates: impl IntoIterator<Item = S>) -> Option<S> {
    const LIKE: f64 = 0.85;
    /// No name is half as long, and to compare two names takes time that grows with the square of their lengths.
    const LONGEST: usize = 100;
    let letters = |name: &str| name.to_lowercase().replace(['-', '_'], "");
    let name = letters(Some(name).filter(|name| name.len() <= LONGEST)?);
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name, &letters(candidate.as_ref())), candidate))
        .filter(|(likeness, _)| *likeness >= LIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// Which of these names is meant, as a question; `others` if none is like it.
pub(crate) fn nearest_or<S: AsRef<str>>(
    name: &str,
    candidates: impl IntoIterator<Item = S>,
    others: impl FnOnce() -> String,
) -> String {
    nearest(name, candidates).map_or_else(others, |nearest| format!("did you mean `{}`?", nearest.as_ref()))
}
