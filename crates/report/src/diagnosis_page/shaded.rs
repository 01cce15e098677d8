//! Times that a chart shades: places of time, or the windows of findings.

use diagnosis::{
    Diagnosis,
    report::{Range, Scope, Trace},
};

/// Ranges of points of the trace to shade, from the first up to behind the last.
pub(super) fn shaded(found: &Diagnosis) -> Vec<[f64; 2]> {
    let trace = &found.trace;
    let driven_s = driven_s(trace);
    let times = found.places.iter().filter(|place| place.kind == "time");
    let mut ranges: Vec<[f64; 2]> = times
        .filter_map(|place| stretch(trace, |i| is_in_range(trace, &driven_s, &place.range, i)))
        .collect();
    if ranges.is_empty() {
        let scopes = found.findings.iter().filter_map(|finding| finding.scope.as_ref());
        ranges = scopes.filter_map(|scope| stretch(trace, |i| is_in_scope(trace, scope, i))).collect();
    }
    ranges.dedup();
    ranges
}

/// Time driven until each point, drives one after another [s].
fn driven_s(trace: &Trace) -> Vec<f64> {
    let mut durations_s = vec![0.0; trace.runs.len()];
    for (run, t_s) in trace.run.iter().zip(&trace.t_s) {
        if let Some(duration_s) = durations_s.get_mut(*run) {
            *duration_s = f64::max(*duration_s, t_s + 0.5);
        }
    }
    let before_s = |run: usize| durations_s.iter().take(run).sum::<f64>();
    trace.run.iter().zip(&trace.t_s).map(|(run, t_s)| before_s(*run) + t_s).collect()
}

fn is_in_range(trace: &Trace, driven_s: &[f64], range: &Range, i: usize) -> bool {
    let t_s = if range.quantity == "driven_s" { driven_s[i] } else { trace.t_s[i] };
    let is_of_drive = range.name.as_ref().is_none_or(|name| trace.runs.get(trace.run[i]) == Some(name));
    is_of_drive && range.from.is_none_or(|from| t_s >= from) && range.to.is_none_or(|to| t_s < to)
}

/// A window in one drive goes on through all that follow it, or holds for all before.
fn is_in_scope(trace: &Trace, scope: &Scope, i: usize) -> bool {
    let (run, t_s) = (trace.run[i], trace.t_s[i]);
    let own = scope.run.as_ref().and_then(|name| trace.runs.iter().position(|other| other == name));
    let own = own.unwrap_or(run);
    let is_after = |bound_s: f64| run > own || run == own && t_s >= bound_s;
    scope.from_s.is_none_or(is_after) && scope.until_s.is_none_or(|until_s| !is_after(until_s))
}

/// The stretch from the first to the last point inside; none where that is all, or less than two points.
fn stretch(trace: &Trace, is_inside: impl Fn(usize) -> bool) -> Option<[f64; 2]> {
    let inside: Vec<usize> = (0..trace.t_s.len()).filter(|i| is_inside(*i)).collect();
    match inside[..] {
        [first, .., last] if inside.len() < trace.t_s.len() => Some([first as f64, last as f64 + 1.0]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{super::example, *};

    #[test]
    fn the_window_of_a_finding_is_shaded_where_no_place_of_time_is_given() {
        let mut found = example::explained();
        assert_eq!(shaded(&found), [[450.0, 600.0]], "the place comes first");
        found.places.clear();
        assert_eq!(shaded(&found), [[400.0, 600.0]]);
        found.findings[0].scope = Some(Scope::default());
        assert_eq!(shaded(&found), Vec::<[f64; 2]>::new(), "what always acts needs no shade");
    }
}
