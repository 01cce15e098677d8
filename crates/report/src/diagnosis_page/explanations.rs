//! The posterior: explanations with their probabilities and odds.

use diagnosis::{
    Diagnosis,
    report::{ExplanationFigures, Probability},
};
use maud::{Markup, html};

use crate::{
    bar::{Bar, bars},
    document,
    figures::{odds, probability},
    labels::explanation_label,
};

/// Probability outside the credible set from which it has a bar of its own.
const WORTH_A_BAR: f64 = 5e-4;

/// The section; nothing where there is no posterior.
pub(super) fn section(found: &Diagnosis) -> Markup {
    if found.explanations.is_empty() {
        return html! {};
    }
    let nothing = found.probability.map(|all| all.nothing);
    let rest = 1.0 - found.explanations.iter().map(|one| one.probability).sum::<f64>();
    let rows: Vec<Row> = found.explanations.iter().map(|one| row(one, nothing)).collect();
    let rest_text = probability(rest);
    let mut all: Vec<Bar<'_>> = rows.iter().map(Row::bar).collect();
    if rest > WORTH_A_BAR {
        let note = "outside the credible set";
        all.push(Bar { label: "all others together", share: rest, value: &rest_text, note, class: "muted" });
    }
    let inside = html! {
        p.quiet { "Posterior probability of each explanation, and its odds against nothing missing." }
        (bars(&all))
        p { (lead(&found.explanations, rest)) }
        @if let Some(all) = &found.probability { (classes(all)) }
    };
    document::section("Explanations", &inside)
}

/// A bar's texts.
struct Row {
    label: String,
    share: f64,
    value: String,
    note: String,
    class: &'static str,
}

impl Row {
    fn bar(&self) -> Bar<'_> {
        let Row { label, share, value, note, class } = self;
        Bar { label, share: *share, value, note, class }
    }
}

fn row(explanation: &ExplanationFigures, nothing: Option<f64>) -> Row {
    let names = &explanation.mechanisms;
    let is_unlisted = names.iter().any(|name| name == diagnosis::UNKNOWN);
    let class = match () {
        () if names.is_empty() => "nothing",
        () if is_unlisted => "unlisted",
        () => "listed",
    };
    Row {
        label: explanation_label(names),
        share: explanation.probability,
        value: probability(explanation.probability),
        note: nothing
            .filter(|_| !names.is_empty())
            .map_or(String::new(), |nothing| format!("odds {}", odds(explanation.probability, nothing))),
        class,
    }
}

/// The likeliest explanation against the second, or against all others where the credible set holds no second.
fn lead(explanations: &[ExplanationFigures], rest: f64) -> String {
    match explanations {
        [first, second, ..] => format!(
            "Odds of “{}” against the runner-up, “{}”: {}.",
            explanation_label(&first.mechanisms),
            explanation_label(&second.mechanisms),
            odds(first.probability, second.probability)
        ),
        [only] => format!(
            "Odds of “{}” against all others together: {}.",
            explanation_label(&only.mechanisms),
            odds(only.probability, rest.max(0.0))
        ),
        [] => String::new(),
    }
}

/// Probabilities of the three classes.
fn classes(all: &Probability) -> Markup {
    let classes = [
        ("Nothing missing", "nothing", all.nothing),
        ("Listed mechanisms", "listed", all.listed),
        ("Outside the list", "unlisted", all.unlisted),
    ];
    html! {
        dl.tiles {
            @for (name, class, p) in classes {
                div { dt { i class={ "dot " (class) } {} (name) } dd { b { (probability(p)) } } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::example, *};

    fn plain(text: &str) -> String {
        text.replace(['\u{a0}', '\u{202f}'], " ")
    }

    #[test]
    fn every_bar_has_a_name_a_value_and_odds() {
        let shown = plain(&section(&example::explained()).into_string());
        for part in [
            r#"aria-label="payload" aria-valuemin="0" aria-valuemax="100" aria-valuenow="90.0" aria-valuetext="90.0 % odds 45 : 1""#,
            r#"aria-label="payload + something outside the list""#,
            r#"aria-label="nothing missing" aria-valuemin="0" aria-valuemax="100" aria-valuenow="2.0" aria-valuetext="2.0 %""#,
            r#"aria-label="all others together""#,
            "Odds of “payload” against the runner-up, “payload + something outside the list”: 18 : 1.",
        ] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
    }

    #[test]
    fn one_explanation_is_held_against_all_others() {
        let only = [ExplanationFigures { mechanisms: Vec::new(), probability: 0.98 }];
        assert_eq!(
            plain(&lead(&only, 0.02)),
            "Odds of “nothing missing” against all others together: 49 : 1."
        );
    }
}
