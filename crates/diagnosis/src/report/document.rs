//! The report put together.

use model::Robot;
use recording::{Channel, Recording};

use crate::{
    Applied, Error,
    fit::member::Member,
    observe::observations::Observations,
    report::{
        assumed::{assumed, farthest, strays},
        constants::constants,
        corrected::corrected,
        detectable::{detectable, untold},
        diagnosis::{
            BaselineFit, CorrectedFit, Diagnosis, ExplanationFigures, FileReport, Finding, FindingFit, Trace,
            Verdict,
        },
        finding::{Reading, UNKNOWN, members, size_is_untold},
        next_drive::next_drive,
        place::places,
        predictions::{Corrected, file_error},
        sentence::{mistaken, sentence},
        verdict::{Circumstances, is_beyond_uncertainty, is_named, probability, verdict},
    },
    search::{
        engine::Found,
        explanation::{Explanation, credible},
    },
};

/// What a report is about.
pub(crate) struct Subject<'a> {
    /// The robot's file.
    pub(crate) file: &'a Robot,
    /// The test drives.
    pub(crate) suspect: &'a Recording,
    /// Rows.
    pub(crate) observed: &'a Observations<'a>,
    /// Names of the test drives.
    pub(crate) drives: &'a [String],
    /// Why these are no drives of this robot as its file has it; nothing else is told of them before that is mended.
    pub(crate) mistakes: &'a [String],
    /// What the file lacks of this robot, as all drives show it.
    pub(crate) shared: &'a [Finding],
    /// What predicts the drives, as the sentence calls it.
    pub(crate) predicted_by: &'static str,
    /// What is doubtful about them, the mistakes among it.
    pub(crate) doubts: &'a [String],
}

/// The report of what was found.
///
/// # Errors
/// A surface that the robot does not know; a watch that breaks.
pub(crate) fn document(subject: &Subject<'_>, found: &Found) -> Result<Diagnosis, Error> {
    let Subject { file, observed, .. } = *subject;
    let filed = observed.series.predict(file, &[])?;
    let error = file_error(observed, &found.baseline, &filed);
    let said = match subject.mistakes.is_empty() {
        true => verdict(&found.explanations, circumstances(observed, found)),
        false => Verdict::Unexplained,
    };
    let is_told = is_named(said, &found.explanations) && subject.mistakes.is_empty();
    let findings = if is_told { findings(subject, found) } else { Vec::new() };
    let first = found.explanations.first().filter(|one| !one.names.is_empty() || one.unlisted);
    let first = first.filter(|_| !findings.is_empty());
    let applied: Vec<Applied> = first.map_or(&[][..], members).iter().map(Member::applied).collect();
    let constants = constants(subject, found, first, &applied)?;
    let (corrected_robot, of_corrected) =
        corrected(&constants.robot, &applied, &observed.series.surfaces(), subject.drives);
    let mut notes = subject.doubts.to_vec();
    notes.extend(of_corrected);
    notes.push(constants.note);
    notes.extend(farthest(first.map_or(&[][..], members)));
    notes.extend(assumed(file, observed, found));
    notes.extend(untold(&found.detectable, &observed.covered(0..observed.rows()), file));
    notes.extend(strays(found.held_out[usize::from(!findings.is_empty())]));
    let named: Vec<&str> = findings.iter().map(|one| one.mechanism.as_str()).collect();
    let information: Vec<_> = found.detectable.iter().map(|(effect, g)| (effect, *g)).collect();
    let (detectable, not_judged) = detectable(&information, &named);
    let [nothing_w, named_w] = found.held_out.map(|one| one.rmse_w);
    let held_out_rmse_w = if findings.is_empty() { nothing_w } else { named_w };
    let corrected = Corrected::of(observed, found, first);
    let trace = trace(subject, &filed, &corrected);
    let is_off = said != Verdict::Consistent && subject.mistakes.is_empty();
    let (coverage, reference_coverage) = observed.series.coverage();
    let next_drive = if is_off { next_drive(file, observed, found)? } else { None };
    Ok(Diagnosis {
        verdict: said,
        sentence: match subject.mistakes.first() {
            Some(mistake) => mistaken(mistake),
            None => sentence(subject.predicted_by, said, &error, &findings, &found.explanations),
        },
        file: Some(FileReport { error, findings: subject.shared.to_vec() }),
        probability: Some(probability(&found.explanations)),
        explanations: credible(&found.explanations).iter().map(figures).collect(),
        baseline: baseline(observed, &filed, found),
        places: if is_off { places(observed, file, found, &corrected) } else { Vec::new() },
        findings,
        corrected: CorrectedFit { rmse_w: rmse_w(&trace), held_out_rmse_w },
        next_drive,
        detectable,
        not_judged,
        notes,
        coverage,
        reference_coverage,
        corrected_robot,
        trace,
    })
}

fn circumstances(observed: &Observations<'_>, found: &Found) -> Circumstances {
    let nothing = found.explanations.iter().find(|one| one.names.is_empty() && !one.unlisted);
    let u = nothing.and_then(|one| one.fitted.as_ref()).map(|fitted| fitted.u.as_slice().to_vec());
    Circumstances {
        held_out_ratio: found.held_out[0].over_noise,
        file_is_off: !observed.series.has_healthy() && is_beyond_uncertainty(&u.unwrap_or_default()),
        size_is_untold: found.explanations.first().is_some_and(size_is_untold),
    }
}

fn findings(subject: &Subject<'_>, found: &Found) -> Vec<Finding> {
    let [held_out_rmse_before_w, held_out_rmse_after_w] = found.held_out.map(|one| one.rmse_w);
    let reading = Reading {
        series: subject.observed.series,
        drives: subject.drives,
        explanations: &found.explanations,
        fit: FindingFit { held_out_rmse_before_w, held_out_rmse_after_w },
        blocks: &found.blocks,
    };
    reading.findings()
}

/// Findings of drives that are known to be healthy, where the posterior names any.
pub(crate) fn shared_findings(observed: &Observations<'_>, drives: &[String], found: &Found) -> Vec<Finding> {
    let said = verdict(&found.explanations, circumstances(observed, found));
    if !matches!(said, Verdict::Explained | Verdict::Ambiguous) {
        return Vec::new();
    }
    let [held_out_rmse_before_w, held_out_rmse_after_w] = found.held_out.map(|one| one.rmse_w);
    let reading = Reading {
        series: observed.series,
        drives,
        explanations: &found.explanations,
        fit: FindingFit { held_out_rmse_before_w, held_out_rmse_after_w },
        blocks: &found.blocks,
    };
    reading.findings()
}

fn figures(explanation: &Explanation) -> ExplanationFigures {
    let mut mechanisms: Vec<String> = explanation.names.iter().map(|name| (*name).to_owned()).collect();
    if explanation.unlisted {
        mechanisms.push(UNKNOWN.to_owned());
    }
    ExplanationFigures { mechanisms, probability: explanation.probability }
}

fn baseline(observed: &Observations<'_>, filed: &[f64], found: &Found) -> BaselineFit {
    let errors: Vec<f64> = (0..observed.test_rows).map(|i| observed.series.recorded[i] - filed[i]).collect();
    let power: Vec<f64> = (0..errors.len()).filter(|i| observed.is_power(*i)).map(|i| errors[i]).collect();
    BaselineFit {
        rmse_w: observed.power_rms(&errors),
        bias_w: power.iter().sum::<f64>() / power.len().max(1) as f64,
        held_out_rmse_w: found.held_out[0].rmse_w,
        noise_floor_w: found.noise_floor_w,
    }
}

/// Power of the test drives over time, all channels of power together.
fn trace(subject: &Subject<'_>, filed: &[f64], corrected: &Corrected) -> Trace {
    let Subject { suspect, observed, drives, .. } = *subject;
    let count = (0..observed.test_rows).filter(|i| observed.averages()[*i].channel == 0).count();
    let all = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (0..count).map(|i| (0..observed.series.channels()).map(|c| value(i + c * count)).sum()).collect()
    };
    let averages = &observed.averages()[..count];
    Trace {
        run: averages.iter().map(|a| a.run).collect(),
        t_s: averages.iter().map(|a| a.t_s).collect(),
        recorded_w: all(&|i| observed.series.recorded[i]),
        filed_w: all(&|i| filed[i]),
        corrected_w: all(&|i| corrected.predicted[i]),
        runs: drives.to_vec(),
        position_m: averages.iter().map(|a| position_m(suspect, a.run, a.t_s)).collect(),
    }
}

fn rmse_w(trace: &Trace) -> f64 {
    let squares = trace.recorded_w.iter().zip(&trace.corrected_w).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / trace.recorded_w.len().max(1) as f64).sqrt()
}

/// Where the robot was so long after a drive began.
fn position_m(recording: &Recording, run: usize, t_s: f64) -> Option<[f64; 2]> {
    let rows = recording.runs.get(run)?.rows.clone();
    let times = recording.t_s.get(rows.clone())?;
    let wanted_s = times.first()? + t_s;
    let row = rows.start + times.partition_point(|t| *t < wanted_s).min(times.len() - 1);
    let at = [Channel::X, Channel::Y].map(|channel| recording.channel(channel).map(|values| values[row]));
    match at {
        [Some(x), Some(y)] if x.is_finite() && y.is_finite() => Some([x, y]),
        _ => None,
    }
}
