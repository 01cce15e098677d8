//! Sentences that a person reads.

use crate::{
    discovered::UNKNOWN,
    event::Event,
    refused::Refused,
    report::{Diagnosis, Finding, Verdict},
    weigh::BLOCK_S,
};

/// Percents of an error that follow from what was recorded and are not worth a word.
const LITTLE_LEFT: f64 = 6.0;

/// The verdict in a sentence, and what comes closest without being it; `event` is what happened here and there and follows nothing.
pub(crate) fn sentence(found: &Diagnosis, refused: &[Refused], event: Option<&Event>) -> String {
    let mut text = match (event, found.verdict) {
        (Some(event), Verdict::Consistent) if event.places.len() == 1 => {
            format!("Nothing that comes again is missing, but {}", seldom(found, event))
        }
        (Some(event), Verdict::Consistent) => {
            let [often, seldom] = [often(event), seldom(found, event)];
            format!("Nothing that comes often is missing, but most of what is left came {often}: {seldom}")
        }
        (Some(event), _) => match event.recurs {
            Some(stretches) => again(found, event, stretches),
            None => {
                let verdict = verdict(found, !refused.is_empty());
                format!("{verdict} Most of it came {}: {}", often(event), seldom(found, event))
            }
        },
        (None, _) => verdict(found, !refused.is_empty()),
    };
    // What is not sure enough to be missing is not worth a reason.
    let is_else = event.is_some_and(Event::comes_again);
    let told = if found.verdict == Verdict::Consistent || is_else { &[] } else { refused };
    for Refused { mechanism, why, .. } in told {
        text += &format!(" {} would explain part of it, but {why}.", capital(plain(mechanism)));
    }
    text
}

/// How often that was.
fn often(event: &Event) -> String {
    match event.places.len() {
        1 => "once".to_owned(),
        few => format!("in {few} stretches of {BLOCK_S:.0} s, the most of it in one"),
    }
}

/// What happened too seldom to be evidence.
fn seldom(found: &Diagnosis, event: &Event) -> String {
    format!(
        "{}, where {:.1} W are noise; so seldom is no evidence of what it was: drive the same again.",
        event.words, found.baseline.noise_floor_w
    )
}

/// What comes again and again though nothing recorded tells when, in some of all stretches.
fn again(found: &Diagnosis, event: &Event, [far, all]: [usize; 2]) -> String {
    format!(
        "Something is missing that comes again and again, and nothing that was recorded tells when: in {far} of {all} stretches of \
         {BLOCK_S:.0} s power is further off than in healthy drives. Most of all, {}, where {:.1} W are noise.",
        event.words, found.baseline.noise_floor_w
    )
}

/// That drives are not what they seem, in a sentence.
pub(crate) fn mistaken(mistake: &str) -> String {
    format!("The recording is not what it seems: {mistake}. Mend that first; nothing else is told of it.")
}

fn verdict(found: &Diagnosis, is_refused: bool) -> String {
    let left = 100.0 * found.explainable[1];
    let said = said(&found.findings);
    match found.verdict {
        Verdict::Consistent => format!(
            "Nothing is missing: where it was not fitted, the model is off by {:.1} W, of which {:.1} W are noise, and {}.",
            found.corrected.held_out_rmse_w,
            found.baseline.noise_floor_w,
            if left < LITTLE_LEFT {
                "what is left follows nothing that was recorded"
            } else {
                "what is left follows what was recorded no more than models usually miss"
            }
        ),
        Verdict::Explained | Verdict::Ambiguous => format!("{said}."),
        Verdict::Unexplained if found.findings.iter().any(|f| f.mechanism == UNKNOWN) => {
            format!("{said}{}.", described(found))
        }
        Verdict::Unexplained if found.findings.is_empty() && is_refused => {
            "Something is missing that no known mechanism describes.".into()
        }
        Verdict::Unexplained if found.findings.is_empty() => format!(
            "Something is missing that no known mechanism describes: {left:.0} % of the remaining error follows from what was \
             recorded."
        ),
        Verdict::Unexplained if is_refused => format!("{said}; but that is not all."),
        Verdict::Unexplained if left < LITTLE_LEFT => format!(
            "{said}; but that is not all: where it was not fitted the model is off by {:.1} W, of which {:.1} W are noise.",
            found.corrected.held_out_rmse_w, found.baseline.noise_floor_w
        ),
        Verdict::Unexplained => format!(
            "{said}; but that is not all: {left:.0} % of the remaining error still follows from what was recorded, and no known \
             mechanism describes it."
        ),
    }
}

/// How many terms more a description has than the first, and how much all that was found takes.
fn described(found: &Diagnosis) -> String {
    let more = found.findings.iter().filter(|f| f.mechanism == UNKNOWN).count() - 1;
    let and_more = match more {
        0 => return String::new(),
        1 => "one more term describes".to_owned(),
        more => format!("{more} more terms describe"),
    };
    let squared_w2 = |rmse_w: f64| rmse_w.powi(2) - found.baseline.noise_floor_w.powi(2);
    let [before, after] = [found.baseline.held_out_rmse_w, found.corrected.held_out_rmse_w].map(squared_w2);
    let taken = 100.0 * (1.0 - after / before.max(1e-12)).clamp(0.0, 1.0);
    format!("; {and_more} the rest, and all together take {taken:.0} % of what is not noise")
}

/// All findings, each with what it cannot be told from; of those outside the list the first one.
fn said(findings: &[Finding]) -> String {
    let mut text = String::new();
    let first = findings.iter().position(|finding| finding.mechanism == UNKNOWN);
    let is_told = |(i, finding): &(usize, &Finding)| finding.mechanism != UNKNOWN || Some(*i) == first;
    for (_, finding) in findings.iter().enumerate().filter(is_told) {
        if text.is_empty() {
            text += &finding.statement;
        } else {
            text += "; besides, ";
            text += &small(&finding.statement);
        }
        if !finding.indistinguishable_from.is_empty() {
            let others: Vec<String> =
                finding.indistinguishable_from.iter().map(|name| plain(name).to_owned()).collect();
            text += &format!(" (or it is {}: these drives cannot tell)", listed(&others));
        }
    }
    text
}

/// A mechanism's name as people say it.
pub(crate) fn plain(mechanism: &str) -> &str {
    match mechanism {
        "motor_heating" => "motors that grow warm",
        "payload" => "a load on board",
        "center_of_mass" => "a shifted centre of mass",
        "load_transfer" => "a high centre of mass",
        "surface_change" => "other ground",
        "speed_dependent_friction" => "friction that grows with speed",
        "inertia" => "spinning masses in the drive train",
        "hotel_load" => "other electronics",
        "regeneration" => "more or less energy returned downhill",
        "wind" => "wind",
        "soft_soil" => "soft soil",
        "wheel_slip" => "slipping wheels",
        "drivetrain_drag" => "drag in one side's drive train",
        "towed_load" => "something towed",
        "grade_dependent_friction" => "friction that grows with the slope",
        "pitch_bias" => "a pitch sensor mounted askew",
        "wheel_radius" => "wheels of another size than the encoders assume",
        "power_scale" => "a power meter that reads in proportion too much or little",
        "power_offset" => "a power meter that is off by a constant",
        "clock_offset" => "power recorded late",
        other => other,
    }
}

/// `a, b or c`.
pub(crate) fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

/// The first letter made a capital.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

/// The first letter made small.
fn small(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mechanism_has_a_name_in_plain_words() {
        for mechanism in model::mechanism::ALL {
            let words = plain(mechanism.name());
            assert!(!words.contains('_') && (words.contains(' ') || words == "wind"), "{words}");
        }
    }

    #[test]
    fn names_are_listed_as_people_do() {
        let names = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(
            (listed(&names), listed(&names[..1]), listed(&[])),
            ("a, b or c".into(), "a".into(), String::new())
        );
    }
}
