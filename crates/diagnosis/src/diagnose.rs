//! A diagnosis from beginning to end.

use model::{
    Robot,
    mechanism::{self, Mechanism},
};
use recording::{Channel, Recording, Watch, unwatched};

use crate::{
    Error,
    alternatives::{Explanation, alternatives, detectable},
    average::Quantity,
    baseline::{Baseline, differences},
    caveats::caveats,
    corrected::corrected,
    discover::{Sure, discover},
    doubts::{doubts, mistakes, moved_far},
    gates,
    judged::Judged,
    needed::shown_in,
    next_drive::next_drive,
    null::Null,
    posterior,
    prepared::Prepared,
    report::{Diagnosis, Verdict},
    search::{Search, TOLD, search},
    series::{Applied, Look, Series},
    weigh::{BLOCK_S, share},
    words,
};

/// Driving that a diagnosis needs [s]: six blocks, the visits that evidence takes.
pub(crate) const NEEDED_S: usize = 6 * BLOCK_S as usize;

/// Drives that a robot's model may not describe, and what is known of them.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    /// The robot, as its file has it.
    pub robot: &'a Robot,
    /// The drives.
    pub suspect: &'a Recording,
    /// Drives of the same robot known to be in order; what they share with the suspect ones is not looked for.
    pub healthy: Option<&'a Recording>,
    /// Mechanisms that are known not to act.
    pub ruled_out: &'a [&'static dyn Mechanism],
    /// By what it is answered.
    pub engine: Engine,
}

/// Ways of diagnosing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// Candidates one after the other, each through a row of tests.
    Gates,
    /// The posterior over sets of mechanisms by one Gaussian model.
    #[default]
    Posterior,
}

impl<'a> Question<'a> {
    /// A question about drives of which nothing is ruled out.
    pub fn new(robot: &'a Robot, suspect: &'a Recording, healthy: Option<&'a Recording>) -> Self {
        Question { robot, suspect, healthy, ruled_out: &[], engine: Engine::default() }
    }
}

/// Says where model and recording differ, which physics was left out, how big it is, and how sure that is.
///
/// `progress` is told the step and how much of all is done, 0 to 1.
///
/// # Errors
/// Drives that are too short, tell no power, or drove on a surface that the robot does not know.
pub fn diagnose(question: &Question<'_>, progress: &dyn Fn(&str, f64)) -> Result<Diagnosis, Error> {
    diagnose_watched(question, progress, &unwatched())
}

/// Diagnoses as [`diagnose()`] does, followed by a watch, which is asked before every prediction.
///
/// # Errors
/// As [`diagnose()`], and [`calibration::Error::Stopped`] soon after the watch breaks.
pub fn diagnose_watched(
    question: &Question<'_>,
    progress: &dyn Fn(&str, f64),
    watch: &Watch,
) -> Result<Diagnosis, Error> {
    if question.engine == Engine::Posterior {
        return posterior::diagnose::diagnose(question, progress, watch);
    }
    let Question { robot, ruled_out, .. } = *question;
    progress("preparing the drives", 0.0);
    let Prepared { suspect, healthy, as_recorded, by_current, contradictions } =
        Prepared::new(question, watch)?;
    let (suspect, healthy) = (&suspect, healthy.as_ref());
    let series = Series::watched(robot, suspect, healthy, watch)?;
    let mut series = series.without(ruled_out).without(&impossible(suspect)).with_turns(robot)?;
    let seconds = series.averages.iter().filter(|a| a.suspect && a.channel == 0).count();
    if seconds < NEEDED_S {
        return Err(Error::TooShort { seconds, needed: NEEDED_S });
    }
    let told = |step: &str, share: f64| progress(step, 0.1 + 0.6 * share.min(1.0));
    let begun = Search::begin(&series, robot, healthy, &told)?;
    let mistakes = mistakes(robot, (suspect, &as_recorded, contradictions), &series, &begun.before.robot)?;
    // Nothing else is told of what is not what it seems.
    let found = if mistakes.is_empty() { search(&series, robot, begun, &told)? } else { begun };
    progress("judging what is left", 0.7);
    let mut judged = Judged::new(&series, robot, &found)?;
    progress("looking outside the list", 0.72);
    let mut found = found;
    if mistakes.is_empty() {
        look_outside(&series, &found, &mut judged)?;
        let closer =
            |_: &str, share: f64| progress("looking closer for what is weak", 0.75 + 0.05 * share.min(1.0));
        if judged.verdict(&found) == Verdict::Consistent
            && let Some(closer) = look_closer(&mut series, robot, healthy, &closer)?
        {
            (found, judged) = closer;
        }
    }
    let applied: Vec<Applied> = found.found.iter().map(|f| f.applied.clone()).collect();
    progress("locating the difference", 0.8);
    let places = if mistakes.is_empty() { judged.places(&series, robot, &found)? } else { Vec::new() };
    progress("planning the next drive", 0.85);
    let next_drive = decisive_drive(&series, robot, &found)?;
    let (corrected_robot, mut notes) =
        corrected(&found.after.robot, &applied, &series.surfaces(), &series.names);
    progress("weighing what could have been seen", 0.95);
    let (detectable, not_judged) = detectable(&series, &found.after, &applied, &found.null)?;
    let mut doubts = doubts(robot, suspect, &series, &mistakes)?;
    let moved = found.after.knobs.iter().map(|knob| &knob.name[..]).zip(found.after.moved.iter().copied());
    doubts.extend(moved_far(moved));
    doubts.append(&mut notes);
    doubts.extend(judged.left_beside_names(&found));
    let is_outside = !judged.discovered.is_empty();
    doubts.extend(caveats(suspect, healthy.is_none(), by_current, is_outside).map(str::to_owned));
    let findings = judged.findings(&series, robot, &found);
    let mut diagnosis = Diagnosis {
        verdict: judged.verdict(&found),
        sentence: String::new(),
        file: None,
        probability: None,
        explanations: Vec::new(),
        baseline: judged.baseline,
        places,
        findings,
        corrected: judged.corrected,
        next_drive,
        explainable: judged.explainable,
        detectable,
        not_judged,
        notes: doubts,
        corrected_robot,
        trace: judged.trace(&series, suspect),
    };
    diagnosis.sentence = match mistakes.first() {
        Some(mistake) => {
            diagnosis.verdict = Verdict::Unexplained;
            words::mistaken(mistake)
        }
        None => words::sentence(&diagnosis, &found.refused, judged.event()),
    };
    progress("done", 1.0);
    Ok(diagnosis)
}

/// Mechanisms that cannot act in drives: an inclinometer that is askew where none was read.
pub(crate) fn impossible(suspect: &Recording) -> Vec<&'static dyn Mechanism> {
    let is_read = suspect.channel(Channel::Pitch).is_some();
    mechanism::by_name("pitch_bias").filter(|_| !is_read).into_iter().collect()
}

/// Takes up terms outside the list, if what was found leaves it open whether something else acts.
fn look_outside(series: &Series, found: &Search, judged: &mut Judged) -> Result<(), Error> {
    // That something comes again and again says nothing of what it would follow.
    let sure = match judged.verdict_by_inputs(found) {
        Verdict::Unexplained if series.has_healthy() => Sure::AsUsual,
        Verdict::Consistent if series.has_healthy() => Sure::Very,
        _ if series.turning.is_some() => Sure::AsUsual,
        _ => return Ok(()),
    };
    let applied: Vec<Applied> = found.found.iter().map(|f| f.applied.clone()).collect();
    let terms = discover(series, &found.after, &applied, &found.refused, (&found.null, sure))?;
    judged.take_up(series, found, terms)
}

/// What is weak and has a name, where nothing else is missing: beside what models miss of healthy drives, noise is less.
fn look_closer(
    series: &mut Series,
    robot: &Robot,
    healthy: Option<&Recording>,
    progress: &dyn Fn(&str, f64),
) -> Result<Option<(Search, Judged)>, Error> {
    series.look = Look::Closer;
    let named = if healthy.is_some() && seems_missing(series, robot)? {
        named(series, robot, healthy, progress)?
    } else {
        None
    };
    if named.is_none() {
        series.look = Look::Usual;
    }
    Ok(named)
}

/// Whether any mechanism passes while nothing is discounted for what healthy drives differ by, which takes longest to tell and makes
/// evidence less only.
fn seems_missing(series: &Series, robot: &Robot) -> Result<bool, Error> {
    let base = Baseline::fit(series, robot, &[])?;
    Ok(gates::best(series, &base, &[], &Null::default())?.is_some())
}

/// What has a name and changes power by more than a model may miss.
fn named(
    series: &Series,
    robot: &Robot,
    healthy: Option<&Recording>,
    progress: &dyn Fn(&str, f64),
) -> Result<Option<(Search, Judged)>, Error> {
    let begun = Search::begin(series, robot, healthy, progress)?;
    let found = search(series, robot, begun, progress)?;
    let without_w = series.predict(&found.after.robot, &[])?;
    let effect_w = differences(&found.after.predicted_w, &without_w);
    let white = found.after.whitening(series);
    // However surely long drives tell it: that little a model may miss.
    let is_little = shown_in(series, &white.of(&effect_w)) == Quantity::Power
        && share(series, &found.after, &effect_w) < TOLD;
    if found.found.is_empty() || is_little {
        return Ok(None);
    }
    let judged = Judged::new(series, robot, &found)?;
    let is_named = matches!(judged.verdict(&found), Verdict::Explained | Verdict::Ambiguous);
    Ok(is_named.then_some((found, judged)))
}

/// The drive that tells the first ambiguous finding from its alternatives.
fn decisive_drive(series: &Series, file: &Robot, found: &Search) -> Result<Option<String>, Error> {
    let ambiguous = found.found.iter().position(|f| !f.indistinguishable_from.is_empty());
    let Some(which) = ambiguous else { return Ok(None) };
    let others = alternatives(series, file, &found.found, which)?;
    let best = Explanation {
        name: found.found[which].applied.mechanism.name(),
        applied: found.found.iter().map(|f| f.applied.clone()).collect(),
        robot: found.after.robot.clone(),
    };
    let surfaces = series.surfaces();
    let surface = surfaces.first().unwrap_or(&file.default_surface);
    Ok(next_drive(&best, &others, &found.after.noise, surface, series.channels() == 2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hills::missed_by;

    #[test]
    fn what_a_model_may_miss_is_not_missing_however_surely_it_is_told() {
        let verdict = |size_w: f64| {
            let [suspect, healthy] = [missed_by(size_w, 0.0, &[]), missed_by(0.0, 1.0, &[])];
            let robot = model::builtin::husky_a200();
            diagnose(&Question::new(&robot, &suspect, Some(&healthy)), &|_, _| {}).unwrap().verdict
        };
        assert_eq!(verdict(0.15), Verdict::Consistent);
        assert_eq!(verdict(2.0), Verdict::Unexplained);
    }
}
