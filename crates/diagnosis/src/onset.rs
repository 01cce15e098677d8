//! When a mechanism set in or ended: the profile of its evidence over that time.

use crate::{
    Error,
    baseline::Baseline,
    edges,
    profile::Profile,
    series::{Applied, Series},
    span::{Span, Timeline},
    weigh::Weighed,
};

/// Times are looked at on both sides of the first guess, as far as the neighbouring guesses lie, as a share of the drive.
const AROUND: f64 = 0.1;
/// Number of times looked at on each side.
const STEPS: i32 = 30;
/// Number of times looked at on each side of the best of these, where that is told to within a step, and so on: what is strong shows to the
/// second when it sets in, and what it does in a few seconds more would pass for something else.
const CLOSER: i32 = 6;
/// Averages are of a second: times are told no closer [s].
const CLOSEST_S: f64 = 1.0;
/// What evidence may fall short of the best within the interval. Where a jump lies, likelihoods have kinks and are not of χ²: their
/// ratio is below x with the chance (1 − e^(−x/2))², of which this is the 95 % quantile, −2 ln(1 − √0.95) (Hansen, "Sample splitting
/// and threshold estimation", Econometrica 68, 2000, theorem 2).
pub(crate) const JUMP_95: f64 = 7.35;

/// Standard errors by which blocks have to speak for a part of the drives instead of all of them: the 95 % interval of a normal
/// distribution.
const SIGMAS_95: f64 = 1.96;

/// A candidate in the part of the drives in which its evidence is strongest.
pub(crate) struct Bounded {
    pub(crate) weighed: Weighed,
    /// 95 % intervals of what bounds that part, by the profile, one for each of [`Series::bounds`].
    pub(crate) limits_95: Vec<[f64; 2]>,
}

/// Finds when a candidate that set in or ended during the drives did so, or where it acts; `None` for one that always does.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn refine(
    series: &Series,
    base: &Baseline,
    others: &[Applied],
    first: &Weighed,
    discount: f64,
) -> Result<Option<Bounded>, Error> {
    let guess = &first.candidate.applied;
    match guess.span {
        span if span.is_all() => return Ok(None),
        Span::Within(region) => return edges::refine(series, base, others, (first, region), discount),
        Span::EachDrive(_) | Span::From { .. } | Span::Until { .. } => {}
    }
    let profile = Profile::of(series, base, others, first)?;
    let looked_at = |spans: Vec<Span>| -> Vec<(Span, f64)> {
        let told = profile.told(&spans);
        spans.into_iter().zip(told).collect()
    };
    let (spans, mut step_s) = around(series, guess.span);
    let mut found = looked_at(spans);
    let line = series.timeline();
    let (best, within, interval_s) = loop {
        let Some((best, most_told)) = most(&found) else { return Ok(None) };
        let mut within = found.clone();
        within.retain(|(_, told)| (most_told - told) / discount <= JUMP_95);
        let driven_s = within.iter().map(|(span, _)| line.driven_s(*span));
        let interval_s = driven_s.fold([f64::INFINITY, 0.0], |[low, high], s| [s.min(low), s.max(high)]);
        let is_between = interval_s[1] - interval_s[0] <= 2.0 * step_s;
        if !is_between || step_s <= CLOSEST_S || is_border(best) {
            break (best, within, interval_s);
        }
        let closer_s = f64::max(step_s / f64::from(CLOSER), CLOSEST_S);
        let steps = (step_s / closer_s).ceil() as i32;
        found.extend(looked_at(near(series, best, steps, closer_s)));
        step_s = closer_s;
    };
    // What happens to a robot happens before a drive rather than a second after it began.
    let borders: Vec<(Span, f64)> = within.into_iter().filter(|(span, _)| is_border(*span)).collect();
    let mut span = most(&borders).map_or(best, |(border, _)| border);
    // What began so early that hardly a block speaks against it was there from the beginning, however strong it is.
    if first.is_strong && series.has_healthy() && profile.sigmas_against_always(span) < SIGMAS_95 {
        span = Span::ALL;
    }
    let Some(weighed) = profile.weighed(span, discount) else { return Ok(None) };
    // A step is as close as a time is told.
    let interval_s = [interval_s[0] - step_s, interval_s[1] + step_s];
    let limits_95 = if span.is_all() { Vec::new() } else { vec![interval_s.map(|s| s.max(0.0))] };
    Ok(Some(Bounded { weighed, limits_95 }))
}

/// Whether a span begins or ends with a drive.
fn is_border(span: Span) -> bool {
    span.is_all() || matches!(span, Span::From { t_s: 0.0, .. } | Span::Until { t_s: 0.0, .. })
}

fn most(found: &[(Span, f64)]) -> Option<(Span, f64)> {
    found.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Moments about a first guess, the beginnings of all drives, and the step between them [s].
///
/// The guess may lie far from where it begins: where it is strong, by what a few seconds show that outweigh all else.
fn around(series: &Series, guess: Span) -> (Vec<Span>, f64) {
    let step_s = AROUND * lasts_s(series, guess) / f64::from(STEPS);
    let mut spans = near(series, guess, STEPS, step_s);
    let line = series.timeline();
    if !matches!(guess, Span::EachDrive(_)) {
        spans.extend(line.borders_s().iter().map(|border_s| like(guess, &line, *border_s)));
    }
    // Without healthy drives, what acts all the time cannot be told.
    if series.has_healthy() && !matches!(guess, Span::Until { .. }) {
        spans.push(Span::ALL);
    }
    (spans, step_s)
}

/// Moments on both sides of one, so many seconds apart.
fn near(series: &Series, of: Span, steps: i32, step_s: f64) -> Vec<Span> {
    let line = series.timeline();
    let (at_s, end_s) = (line.driven_s(of), lasts_s(series, of));
    let times_s = (-steps..=steps).map(|step| at_s + f64::from(step) * step_s);
    times_s.filter(|s| *s > 0.0 && *s < end_s).map(|s| like(of, &line, s)).collect()
}

/// What begins or ends after so much driving, as another does.
fn like(other: Span, line: &Timeline, driven_s: f64) -> Span {
    match other {
        Span::EachDrive(_) => Span::EachDrive(driven_s),
        Span::Until { .. } => line.at(driven_s).until(),
        _ => line.at(driven_s),
    }
}

/// How long that takes in which it begins or ends [s].
fn lasts_s(series: &Series, span: Span) -> f64 {
    if matches!(span, Span::EachDrive(_)) { series.longest_s() } else { series.timeline().total_s() }
}
