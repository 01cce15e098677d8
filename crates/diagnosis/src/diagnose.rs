//! The posterior diagnosis from recordings to the report.

use calibration::slopes_note;
use model::{
    Robot, Sides,
    mechanism::{self, Mechanism},
};
use recording::{Channel, Recording, Watch, unwatched};

use crate::{
    Error, Series,
    fit::baseline::Baseline,
    hypothesis::window::Windows,
    observe::{
        observations::Observations,
        prepared::Prepared,
        sanity::{doubts, mistakes},
    },
    report::{
        about_simulation::about_simulation,
        diagnosis::{Diagnosis, Finding},
        document::{Subject, document, shared_findings},
    },
    search::engine::find_about,
};

/// Driving that a diagnosis needs \[s\]: six stretches of 20 s, so that some can be held out.
pub(crate) const NEEDED_S: usize = 120;

/// Drives that a robot's model may not describe, and what is known of them.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    /// The robot, as its file has it.
    pub robot: &'a Robot,
    /// The drives.
    pub suspect: &'a Recording,
    /// Drives of the same robot known to be in order; what they share with the suspect ones is not looked for.
    pub healthy: Option<&'a Recording>,
    /// Another simulator's log of the same drives, in the place of what the robot's file predicts.
    pub simulated: Option<&'a Recording>,
    /// Mechanisms that are known not to act.
    pub ruled_out: &'a [&'static dyn Mechanism],
}

impl<'a> Question<'a> {
    /// A question about drives of which nothing is ruled out.
    pub fn new(robot: &'a Robot, suspect: &'a Recording, healthy: Option<&'a Recording>) -> Self {
        Question { robot, suspect, healthy, simulated: None, ruled_out: &[] }
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
    let Question { robot, ruled_out, .. } = *question;
    progress("preparing the drives", 0.0);
    let Prepared { suspect, healthy, contradictions, offset_w } = Prepared::new(question, watch)?;
    let suspect = &suspect;
    let series = Series::watched(robot, suspect, healthy.as_ref(), watch)?.with_turns(robot)?;
    let averages = series.averages.iter().filter(|a| a.suspect && a.channel == 0).count();
    let seconds = (averages as f64 * series.average_s()) as usize;
    if seconds < NEEDED_S {
        return Err(Error::TooShort { seconds, needed: NEEDED_S });
    }
    let observed = Observations::new(&series, robot);
    progress("fitting the robot", 0.05);
    let baseline = Baseline::fit(&observed, robot)?;
    // A file that has learnt from healthy drives is as good a place to begin at as a fit, in which constants make up for what is missing.
    let is_learnt = !series.has_healthy() && robot.posterior.is_some();
    let of_file = if is_learnt { Some(Baseline::of_file(&observed, robot)?) } else { None };
    let mistakes = mistakes(robot, (suspect, contradictions), &series, &baseline.robot)?;
    let mut doubts = doubts(robot, suspect, &series, &mistakes)?;
    doubts.extend(series.sampled());
    doubts.extend(covered(&series));
    doubts.extend(series.meter_note());
    doubts.extend(series.watts_per_a().map(by_current));
    doubts.extend(slopes_note(suspect).map(str::to_owned));
    let excluded: Vec<&str> = ruled_out.iter().chain(&impossible(suspect)).map(|one| one.name()).collect();
    let is_possible = |one: &&'static dyn Mechanism| !excluded.contains(&one.name());
    // Nothing else is told of what is not what it seems.
    let is_looked_for = |one: &&'static dyn Mechanism| mistakes.is_empty() && is_possible(one);
    let library: Vec<&'static dyn Mechanism> = mechanism::ALL.into_iter().filter(is_looked_for).collect();
    // What all drives share is looked for at the same time.
    let is_asked = healthy.as_ref().filter(|_| mistakes.is_empty());
    let (found, shared) = std::thread::scope(|scope| {
        let by_themselves = is_asked.map(|healthy| scope.spawn(|| shared(robot, healthy, &library, watch)));
        let found = find_about(&observed, (robot, baseline, of_file), &library, Windows::All, progress);
        (found, by_themselves.map(|thread| thread.join()))
    });
    let found = found?;
    let shared = match shared {
        None => Vec::new(),
        Some(Ok(findings)) => findings?,
        Some(Err(panic)) => std::panic::resume_unwind(panic),
    };
    let drives: Vec<String> = suspect.runs.iter().map(|run| run.name.clone()).collect();
    let subject = Subject {
        file: robot,
        suspect,
        observed: &observed,
        drives: &drives,
        mistakes: &mistakes,
        shared: &shared,
        doubts: &doubts,
        predicted_by: if offset_w.is_empty() { "robot file" } else { "simulation" },
    };
    let mut report = document(&subject, &found)?;
    if !offset_w.is_empty() {
        about_simulation(&mut report, suspect, &offset_w);
    }
    progress("done", 1.0);
    Ok(report)
}

/// Mechanisms that cannot act in drives: an inclinometer that is askew where none was read.
pub(crate) fn impossible(suspect: &Recording) -> Vec<&'static dyn Mechanism> {
    let is_read = suspect.channel(Channel::Pitch).is_some();
    mechanism::by_name("pitch_bias").filter(|_| !is_read).into_iter().collect()
}

/// What a report says of drives of which less than all is compared.
fn covered(series: &Series) -> Vec<String> {
    let (suspect, healthy) = series.coverage();
    let of_healthy = healthy.and_then(|healthy| healthy.total.words());
    let of_healthy = of_healthy.map(|words| format!("of the healthy drives, {words}"));
    suspect.total.words().into_iter().chain(of_healthy).collect()
}

/// What a diagnosis of motor currents has to say of itself.
fn by_current(watts_per_a: Sides<f64>) -> String {
    let Sides { left, right } = watts_per_a;
    format!(
        "motor currents are compared as currents, by `force_n_per_a` of the robot's file: an ampere counts as the {left:.1} W (left) and {right:.1} W \
         (right) that it stands for on average in these drives"
    )
}

/// Mechanisms that healthy drives need beside the robot's file, by themselves: what the file lacks of this robot.
fn shared(
    robot: &Robot,
    healthy: &Recording,
    library: &[&'static dyn Mechanism],
    watch: &Watch,
) -> Result<Vec<Finding>, Error> {
    let excluded = impossible(healthy);
    let is_possible = |one: &&'static dyn Mechanism| !excluded.iter().any(|other| other.name() == one.name());
    let library: Vec<&'static dyn Mechanism> = library.iter().copied().filter(is_possible).collect();
    let series = Series::watched(robot, healthy, None, watch)?;
    if library.is_empty() || series.averages.iter().filter(|a| a.channel == 0).count() < NEEDED_S {
        return Ok(Vec::new());
    }
    let observed = Observations::new(&series, robot);
    let baseline = Baseline::fit(&observed, robot)?;
    let found = find_about(&observed, (robot, baseline, None), &library, Windows::AlwaysOnly, &|_, _| {})?;
    let drives: Vec<String> = healthy.runs.iter().map(|run| run.name.clone()).collect();
    Ok(shared_findings(&observed, &drives, &found))
}

#[cfg(test)]
mod tests {
    use model::knowledge::{ModelError, Regimes};

    use super::*;
    use crate::{Applied, Span, observe::hills::drive, report::diagnosis::Verdict};

    fn drag(left_n: f64, from_s: f64) -> Vec<Applied> {
        let mechanism = mechanism::by_name("drivetrain_drag").unwrap();
        vec![Applied { mechanism, values: vec![left_n, 0.0], span: Span::From { run: 0, t_s: from_s } }]
    }

    fn asked(applied: &[Applied], with_healthy: bool) -> Diagnosis {
        let robot = model::builtin::husky_a200();
        let (suspect, healthy) = (drive(&robot, 0.0, applied), drive(&robot, 1.0, &[]));
        let question = Question::new(&robot, &suspect, with_healthy.then_some(&healthy));
        crate::diagnose(&question, &|_, _| {}).unwrap()
    }

    #[test]
    fn a_drag_that_sets_in_is_named_with_its_side_size_and_onset_with_and_without_healthy_drives() {
        for with_healthy in [false, true] {
            let found = asked(&drag(8.0, 400.0), with_healthy);
            assert_eq!(found.verdict, Verdict::Explained, "{}", found.sentence);
            let [finding] = &found.findings[..] else { panic!("{}", found.sentence) };
            assert_eq!(finding.mechanism, "drivetrain_drag");
            assert!(finding.probability.unwrap() > 0.9);
            let left = &finding.parameters[0];
            let [low, high] = left.interval_95.unwrap();
            assert!(low <= 8.0 && 8.0 <= high && (left.value - 8.0).abs() < 1.0, "{left:?}");
            // No drive tells a form that is off by 7 % everywhere from another size.
            assert!(high - low > 2.0 * 1.96 * 0.07 * left.value, "{left:?}");
            let scope = finding.scope.as_ref().unwrap();
            assert!((scope.from_s.unwrap() - 400.0).abs() < 20.0, "{scope:?}");
            assert!(found.corrected.held_out_rmse_w < found.baseline.held_out_rmse_w);
        }
    }

    #[test]
    fn a_healthy_robot_is_consistent_with_and_without_healthy_drives() {
        for with_healthy in [false, true] {
            let found = asked(&[], with_healthy);
            assert_eq!(found.verdict, Verdict::Consistent, "{}", found.sentence);
            let probability = found.probability.unwrap();
            let sum = probability.nothing + probability.listed + probability.unlisted;
            assert!((sum - 1.0).abs() < 1e-9 && probability.nothing > 0.5, "{probability:?}");
            assert!(found.file.unwrap().error.bias_w.abs() < 0.5);
        }
    }

    #[test]
    fn drives_of_another_robot_get_no_names_and_no_panic() {
        let robot = model::builtin::husky_a200();
        let mut suspect = drive(&robot, 0.0, &[]);
        let [left_w, right_w] = [recording::Channel::LeftPower, recording::Channel::RightPower]
            .map(|side| suspect.channels.remove(&side).unwrap());
        suspect.channels.insert(recording::Channel::LeftPower, right_w.iter().map(|w| -w).collect());
        suspect.channels.insert(recording::Channel::RightPower, left_w.iter().map(|w| -w).collect());
        let question = Question::new(&robot, &suspect, None);
        let found = crate::diagnose(&question, &|_, _| {}).unwrap();
        assert!(found.verdict == Verdict::Unexplained && found.findings.is_empty(), "{}", found.sentence);
    }

    #[test]
    fn what_is_ruled_out_is_never_named() {
        let robot = model::builtin::husky_a200();
        let suspect = drive(&robot, 0.0, &drag(8.0, 400.0));
        let drags = [mechanism::by_name("drivetrain_drag").unwrap()];
        let question = Question { ruled_out: &drags, ..Question::new(&robot, &suspect, None) };
        let found = crate::diagnose(&question, &|_, _| {}).unwrap();
        let names: Vec<&String> = found.explanations.iter().flat_map(|one| &one.mechanisms).collect();
        assert!(!names.iter().any(|name| *name == "drivetrain_drag") && found.verdict != Verdict::Consistent);
    }

    #[test]
    fn drives_on_level_ground_at_one_speed_say_what_they_cannot_tell_and_how_well_the_file_is_known() {
        let mut robot = model::builtin::husky_a200();
        robot.provenance = [("mass_kg".to_owned(), model::knowledge::Provenance::Borrowed)].into();
        let mut level = drive(&robot, 0.0, &[]);
        level.channels.remove(&Channel::YawRate);
        for (channel, value) in [(Channel::LeftSpeed, 0.5), (Channel::RightSpeed, 0.5), (Channel::Pitch, 0.0)]
        {
            level.channels.insert(channel, vec![value; level.rows()]);
        }
        let [predicted] = [Series::new(&robot, &level, None).unwrap()];
        let mean_w = predicted.predict(&robot, &[]).unwrap()[10];
        for side in [Channel::LeftPower, Channel::RightPower] {
            let noisy = (0..level.rows()).map(|i| mean_w + 0.3 * (1.7 * i as f64).sin());
            level.channels.insert(side, noisy.collect());
        }
        let found = crate::diagnose(&Question::new(&robot, &level, None), &|_, _| {}).unwrap();
        let notes = found.notes.join("\n");
        assert!(
            notes.contains("drive at one speed only and hardly turn and stay on level ground"),
            "{notes}"
        );
        let untold =
            found.notes.iter().find(|note| note.contains("cannot tell a plausible size of")).unwrap();
        assert!(untold.contains("`pitch_bias`") || untold.contains("`speed_dependent_friction`"), "{untold}");
        assert!(notes.contains("mass_kg 100 % (borrowed)"), "{notes}");
        let hilly =
            crate::diagnose(&Question::new(&robot, &drive(&robot, 0.0, &[]), None), &|_, _| {}).unwrap();
        assert!(!hilly.notes.join("").contains("level ground"), "{:?}", hilly.notes);
    }

    #[test]
    fn what_a_calibration_found_is_not_believed_of_drives_that_do_what_its_own_did_not() {
        let mut robot = model::builtin::husky_a200();
        let suspect = drive(&robot, 0.0, &[]);
        let wide = Regimes { speed_mps: [-1.0, 1.0], difference_mps: [-2.0, 2.0], pitch_rad: [-0.5, 0.5] };
        let straight = Regimes { difference_mps: [-0.01, 0.01], ..wide };
        let mut missed = |regimes: Regimes| {
            robot.model_error = Some(ModelError { fraction: 0.006, hours: 1.0, regimes });
            let found = crate::diagnose(&Question::new(&robot, &suspect, None), &|_, _| {}).unwrap();
            found.notes.join("\n")
        };
        let (known, new) = (missed(wide), missed(straight));
        assert!(known.contains("miss 0.6 %") && !known.contains("go beyond"), "{known}");
        assert!(new.contains("miss 3.0 %") && new.contains("go beyond"), "{new}");
    }

    #[test]
    fn a_drive_is_proposed_where_no_gyroscope_was_recorded() {
        let robot = model::builtin::husky_a200();
        let load = mechanism::by_name("payload").unwrap();
        let applied = [Applied { mechanism: load, values: vec![12.0], span: Span::ALL }];
        let mut level = drive(&robot, 0.0, &applied);
        // Without slopes a load, a gain and other ground look alike.
        level.channels.retain(|channel, _| ![Channel::Pitch, Channel::YawRate].contains(channel));
        let found = crate::diagnose(&Question::new(&robot, &level, None), &|_, _| {}).unwrap();
        assert!(found.explanations.len() > 1, "{:?}", found.explanations);
        assert!(found.next_drive.is_some(), "{}", found.sentence);
    }

    #[test]
    fn one_row_that_no_robot_can_drive_is_named_and_not_fitted_to() {
        let robot = model::builtin::husky_a200();
        let mut glitch = drive(&robot, 0.0, &[]);
        glitch.channels.get_mut(&Channel::LeftSpeed).unwrap()[4500] = 99_999.0;
        let failed = crate::diagnose(&Question::new(&robot, &glitch, None), &|_, _| {}).unwrap_err();
        assert!(
            failed.to_string().contains("drive `hills`") && failed.to_string().contains("at 4"),
            "{failed}"
        );
    }

    #[test]
    fn a_watch_that_breaks_ends_the_search() {
        let robot = model::builtin::husky_a200();
        let suspect = drive(&robot, 0.0, &[]);
        let question = Question::new(&robot, &suspect, None);
        let asked = std::sync::atomic::AtomicUsize::new(0);
        let watch: Watch = std::sync::Arc::new(move |_| {
            let so_often = asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if so_often < 40 { std::ops::ControlFlow::Continue(()) } else { std::ops::ControlFlow::Break(()) }
        });
        let stopped = crate::diagnose_watched(&question, &|_, _| {}, &watch);
        assert!(matches!(stopped, Err(Error::Calibration(calibration::Error::Stopped))));
    }
}
