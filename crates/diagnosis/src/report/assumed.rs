//! What a report has to say of its own assumptions: of the file, of its constants, and of seconds far off.

use model::{Robot, knowledge::Provenance};

use crate::{
    evidence::width::WIDTHS,
    fit::{
        held_out::{HeldOut, STRAY_SIGMAS},
        member::Member,
        parameter::Parameter,
        temperature::UNTOLD,
    },
    observe::{observations::Observations, reach::Beyond},
    search::engine::Found,
};

/// Standard deviations from which a parameter is worth a note: among a dozen parameters one in seven robots has one by chance.
const FAR_OFF_SIGMAS: f64 = 2.5;

/// What was assumed of the file, and which of its numbers would have to be far off with nothing missing.
pub(crate) fn assumed(file: &Robot, observed: &Observations<'_>, found: &Found) -> Vec<String> {
    let source = match (observed.series.has_healthy(), &file.model_error) {
        (true, _) => "by the healthy drives",
        (false, Some(_)) if !found.beyond.is_empty() => {
            "as of any fitted constants, since these drives go beyond those of its calibration"
        }
        (false, Some(_)) => "as its file has it of the drives that it was calibrated on",
        (false, None) => "by where its constants come from",
    };
    let share = 100.0 * found.missed.power;
    let wider = match observed.series.has_healthy() {
        true => String::new(),
        false => format!(" or, less probably, up to {:.0} times as much", WIDTHS[WIDTHS.len() - 1]),
    };
    let mut notes =
        vec![format!("the model is taken to miss {share:.1} % of power smoothly{wider}, {source}")];
    notes.push(known_to(file, &found.baseline.parameters.list));
    notes.extend(said_of_reach(&found.beyond));
    if found.run_variation > 0.0 {
        let share = 100.0 * found.run_variation;
        notes.push(format!(
            "ground seems to differ from run to run by {share:.0} % of its resistance, which is no finding"
        ));
    }
    if found.temperature > UNTOLD {
        let times = (found.temperature / UNTOLD).sqrt();
        notes.push(format!(
            "healthy drives lie farther from the model than it and its noise allow, so that everything counts as {times:.1} times less sure"
        ));
    }
    let nothing = found.explanations.iter().find(|one| one.names.is_empty() && !one.unlisted);
    let parameters = &found.baseline.parameters;
    let z = nothing.and_then(|one| one.fitted.as_ref()).map(|fitted| parameters.z(&fitted.u));
    for (parameter, z) in parameters.list.iter().zip(z.iter().flat_map(|z| z.iter())) {
        if z.abs() > FAR_OFF_SIGMAS {
            let name = &parameter.name;
            notes.push(format!(
                "with nothing missing, `{name}` would lie {z:+.1} standard deviations from its file"
            ));
        }
    }
    notes
}

/// How well the file's constants are known, and by what.
fn known_to(file: &Robot, parameters: &[Parameter]) -> String {
    let one = |parameter: &Parameter| {
        let name = &parameter.name;
        let is_fitted = file.posterior.as_ref().is_some_and(|posterior| posterior.parameters.contains(name));
        let source = match file.provenance_of(name) {
            _ if is_fitted => "fitted",
            _ if parameter.is_as_usual() => "as usual",
            Some(Provenance::Measured) => "measured",
            Some(Provenance::Fitted) => "fitted",
            Some(Provenance::DataSheet) => "data sheet",
            Some(Provenance::Borrowed) => "borrowed",
            None => "`uncertainty`",
        };
        format!("{name} {} ({source})", parameter.width())
    };
    let all: Vec<String> = parameters.iter().map(one).collect();
    format!("the file's constants are taken to be known, one standard deviation, to: {}", all.join(", "))
}

/// Sizes that ended where no farther ones are looked at.
pub(crate) fn farthest(members: &[Member]) -> Vec<String> {
    let of = |member: &Member| {
        let name = member.mechanism.name();
        let said = move |parameter| {
            format!(
                "`{parameter}` of `{name}` ends at the farthest size that is looked at: it may be larger, and its interval is too short"
            )
        };
        member.farthest().into_iter().map(said).collect::<Vec<String>>()
    };
    members.iter().flat_map(of).collect()
}

/// That more seconds than chance has lie far off.
pub(crate) fn strays(held_out: HeldOut) -> Option<String> {
    /// Share beyond [`STRAY_SIGMAS`] standard deviations of a normal distribution, ten times.
    const MANY: f64 = 0.0047;
    (held_out.strays > MANY).then(|| {
        format!(
            "{:.1} % of seconds lie more than {STRAY_SIGMAS} standard deviations of the noise off, as quick moves and strays of meters do; \
             they count as that far off",
            100.0 * held_out.strays
        )
    })
}

/// What these drives do that those of a calibration did not.
fn said_of_reach(beyond: &[Beyond]) -> Option<String> {
    let words: Vec<String> = beyond.iter().map(Beyond::words).collect();
    (!words.is_empty()).then(|| {
        format!("these drives go beyond those that the robot was calibrated on, where its model may miss more: {}", words.join(", "))
    })
}
