//! The sentence of a report: the file's error first, then what was found.

use model::mechanism;

use crate::{
    report::{
        diagnosis::{FileError, Finding, Verdict},
        finding::UNKNOWN,
        verdict::probability,
    },
    search::explanation::{Explanation, credible},
};

/// Probability from which something is likelier than not.
const LIKELIER_THAN_NOT: f64 = 0.5;

/// The sentence.
pub(crate) fn sentence(
    predicted_by: &str,
    verdict: Verdict,
    file: &FileError,
    findings: &[Finding],
    explanations: &[Explanation],
) -> String {
    let way = if file.bias_w >= 0.0 { "low" } else { "high" };
    let about = format!(
        "The {predicted_by} predicts these drives {:.1} W too {way} on average ({:.1} W RMSE; noise {:.1} W).",
        file.bias_w.abs(),
        file.rmse_w,
        file.noise_w
    );
    format!("{about} {}", found(verdict, findings, explanations))
}

fn found(verdict: Verdict, findings: &[Finding], explanations: &[Explanation]) -> String {
    let named: Vec<&Finding> = findings.iter().filter(|finding| finding.mechanism != UNKNOWN).collect();
    let statements: Vec<String> = named.iter().map(|finding| stated(finding)).collect();
    let nothing = probability(explanations).nothing;
    match verdict {
        Verdict::Consistent => consistent(explanations),
        Verdict::Ambiguous if statements.is_empty() => {
            "These drives do not tell whether something is missing: the model describes them poorly, and with nothing missing about as well as with \
             the likeliest explanation."
                .to_owned()
        }
        Verdict::Explained | Verdict::Ambiguous => capital(&format!("{}.", statements.join("; "))),
        Verdict::Unexplained if findings.iter().any(|finding| finding.mechanism == UNKNOWN) => {
            let all: Vec<String> = findings.iter().map(|finding| finding.statement.clone()).collect();
            capital(&format!("{}.", all.join("; and ")))
        }
        Verdict::Unexplained if statements.is_empty() && nothing >= LIKELIER_THAN_NOT => format!(
            "Nothing of the list seems to be missing ({:.0} %), but the drives lie farther from the model than its uncertainty and noise allow: its form fits them poorly.",
            100.0 * nothing
        ),
        Verdict::Unexplained if statements.is_empty() => {
            "That is more than its uncertainty and noise allow, and no mechanism of the list explains it."
                .to_owned()
        }
        Verdict::Unexplained => {
            format!("Several explanations are about as likely, among them: {}.", statements.join("; "))
        }
    }
}

/// That nothing is missing, or what is likelier than that.
fn consistent(explanations: &[Explanation]) -> String {
    let nothing = probability(explanations).nothing;
    if nothing >= LIKELIER_THAN_NOT {
        return "Within its uncertainty nothing is missing.".to_owned();
    }
    let likelier = credible(explanations).iter().filter(|one| !one.names.is_empty() || one.unlisted);
    let likelier: Vec<String> = likelier
        .map(|one| {
            let names: Vec<&str> = one.names.iter().map(|name| label(name)).collect();
            let names =
                if names.is_empty() { "something outside the list".to_owned() } else { names.join(" with ") };
            format!("{names} ({:.0} %)", 100.0 * one.probability)
        })
        .collect();
    format!(
        "That nothing is missing is possible ({:.0} %), but something is likelier: {}. These drives do not settle it.",
        100.0 * nothing,
        listed(&likelier)
    )
}

/// That drives are not what they seem.
pub(crate) fn mistaken(mistake: &str) -> String {
    format!("The recording is not what it seems: {mistake}. Mend that first; nothing else is told of it.")
}

fn stated(finding: &Finding) -> String {
    if finding.indistinguishable_from.is_empty() {
        return finding.statement.clone();
    }
    let others: Vec<String> =
        finding.indistinguishable_from.iter().map(|name| label(name).to_owned()).collect();
    format!("{} (or {})", finding.statement, listed(&others))
}

/// A mechanism in plain words.
fn label(name: &str) -> &str {
    mechanism::by_name(name).map_or(name, |one| one.label())
}

/// Names in a row.
fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

/// The first letter made a capital.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_without_names_says_that_the_drives_do_not_tell() {
        let said = found(Verdict::Ambiguous, &[], &[]);
        assert!(said.starts_with("These drives do not tell whether something is missing"), "{said}");
    }

    #[test]
    fn what_is_likelier_than_nothing_is_told_where_nothing_is_not_ruled_out() {
        let parts: [(&[&'static str], f64); 3] =
            [(&["power_scale"], 0.53), (&["payload"], 0.40), (&[], 0.07)];
        let explanations = parts.map(|(names, probability)| Explanation {
            names: names.to_vec(),
            unlisted: false,
            log: probability.ln(),
            fitted: None,
            block: None,
            probability,
        });
        let said = found(Verdict::Consistent, &[], &explanations);
        assert!(
            said.contains("is possible (7 %)") && said.contains("(53 %) or a load on board (40 %)"),
            "{said}"
        );
        let likely =
            found(Verdict::Consistent, &[], &[Explanation { probability: 0.9, ..explanations[2].clone() }]);
        assert_eq!(likely, "Within its uncertainty nothing is missing.");
    }

    #[test]
    fn a_model_that_fits_poorly_with_nothing_missing_is_said_to() {
        let nothing = |probability: f64| Explanation {
            names: Vec::new(),
            unlisted: false,
            log: 0.0,
            fitted: None,
            block: None,
            probability,
        };
        let said = found(Verdict::Unexplained, &[], &[nothing(0.92)]);
        assert!(said.starts_with("Nothing of the list seems to be missing (92 %), but"), "{said}");
        assert!(found(Verdict::Unexplained, &[], &[nothing(0.1)]).starts_with("That is more than"));
    }

    #[test]
    fn names_are_listed_as_people_do() {
        let names = ["a", "b", "c"].map(str::to_owned);
        assert_eq!([listed(&names), listed(&names[..1])], ["a, b or c", "a"]);
        assert_eq!(capital("slope"), "Slope");
    }
}
