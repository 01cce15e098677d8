//! Findings: what is missing, how large it is, and when and where it acts.

use diagnosis::{
    Diagnosis, UNKNOWN,
    report::{Finding, FoundParameter, Scope},
};
use maud::{Markup, html};

use crate::{
    document,
    figures::{probability, quantity, three_figures, watts},
    labels::{capitalized, either, mechanism_label, parameter_label},
};

/// The section; nothing where nothing was found.
pub(super) fn section(found: &Diagnosis) -> Markup {
    if found.findings.is_empty() {
        return html! {};
    }
    document::section("Findings", &html! { @for finding in &found.findings { (card(finding)) } })
}

fn card(finding: &Finding) -> Markup {
    let fit = &finding.fit;
    // The window stands under the scope where there is one.
    let has_scope = finding.scope.is_some();
    let is_size = |one: &&FoundParameter| !has_scope || !matches!(one.name, "from_s" | "until_s");
    let sizes: Vec<&FoundParameter> = finding.parameters.iter().filter(is_size).collect();
    html! {
        article {
            h3 {
                (capitalized(&mechanism_label(&finding.mechanism)))
                @if let Some(p) = finding.probability { " " span.badge { (probability(p)) " probable" } }
            }
            p { (capitalized(&finding.statement)) "." }
            p.equation { code { (finding.equation) } }
            @if !sizes.is_empty() {
                table.parameters {
                    thead { tr { th { "parameter" } th { "value" } th { "95 % interval" } th { span.hidden { "interval drawn" } } } }
                    tbody { @for one in sizes { (parameter(one)) } }
                }
            }
            dl.facts {
                @if let Some(scope) = &finding.scope {
                    dt { "When" } dd { (time_words(scope)) }
                    @if let Some(region) = &scope.region { dt { "Where" } dd { (region) } }
                }
                dt { "Held-out RMSE" }
                dd { (watts(fit.held_out_rmse_before_w)) " before, " (watts(fit.held_out_rmse_after_w)) " after" }
                @if finding.probability.is_none() {
                    dt { "By chance" } dd { (chance(finding.evidence.p_value)) }
                }
                @if finding.mechanism != UNKNOWN { dt { "Alternatives" } dd { (alternatives(finding)) } }
            }
        }
    }
}

fn parameter(one: &FoundParameter) -> Markup {
    html! {
        tr {
            th scope="row" { (parameter_label(one.name)) }
            td.number { (quantity(one.value, one.unit)) }
            @match one.interval_95 {
                Some([low, high]) => {
                    td.number { (three_figures(low)) " to " (quantity(high, one.unit)) }
                    td.drawn { (interval(one.value, [low, high])) }
                }
                None => { td.quiet colspan="2" { "taken from a grid" } }
            }
        }
    }
}

/// An interval on an axis that holds it and zero.
fn interval(value: f64, [low, high]: [f64; 2]) -> Markup {
    let scale =
        crate::axis::Scale { values: crate::axis::extent([0.0, low, high, value]), pixels: [4.0, 156.0] };
    let [zero, low, high, value] = [0.0, low, high, value].map(|at| scale.pixel(at));
    html! {
        svg.interval viewBox="0 0 160 16" width="160" height="16" aria-hidden="true" {
            path.axis d={ "M4 14H156M" (format!("{zero:.1}")) " 2V14" } {}
            rect.range x=(format!("{low:.1}")) y="5" width=(format!("{:.1}", (high - low).max(1.0))) height="5" rx="2.5" {}
            rect.value x=(format!("{:.1}", value - 1.5)) y="2" width="3" height="11" rx="1.5" {}
        }
    }
}

/// When a finding acts.
fn time_words(scope: &Scope) -> String {
    let drive = scope.run.as_ref().map_or(String::new(), |run| format!(" of drive {run}"));
    let each = if scope.run.is_none() { " of each drive" } else { "" };
    match (scope.from_s, scope.until_s) {
        (Some(from_s), Some(until_s)) => {
            format!("from {from_s:.0}\u{a0}s to {until_s:.0}\u{a0}s{drive}{each}")
        }
        (Some(from_s), None) => format!("from {from_s:.0}\u{a0}s{drive}{each} on"),
        (None, Some(until_s)) => format!("until {until_s:.0}\u{a0}s{drive}{each}"),
        (None, None) => "all the time, in all test drives".to_owned(),
    }
}

fn alternatives(finding: &Finding) -> String {
    match &finding.indistinguishable_from[..] {
        [] => "no other mechanism explains the drives as well".to_owned(),
        others => format!("these drives cannot distinguish it from {}", either(others)),
    }
}

fn chance(p_value: f64) -> String {
    /// Beyond, the exact figure says nothing.
    const LEAST: f64 = 1e-6;
    if p_value < LEAST {
        "as much in fewer than one of a million drives".into()
    } else {
        format!("as much in one of {:.0} drives", 1.0 / p_value)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::example, *};

    #[test]
    fn a_finding_says_how_large_how_probable_and_since_when() {
        let shown = section(&example::explained()).into_string().replace('\u{a0}', " ");
        for part in [
            "<h3>Payload <span class=\"badge\">97.8 % probable</span></h3>",
            "Payload of 25.3 kg, from about 400 s on.",
            "22.1 to 28.4 kg",
            "from 400 s of drive tuesday on",
            "these drives cannot distinguish it from towed load",
        ] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
        assert!(!shown.contains("acts from"), "the window is not said twice: {shown}");
    }

    #[test]
    fn what_is_outside_the_list_is_headed_so_and_has_no_alternatives_in_it() {
        let mut found = example::explained();
        let finding = &mut found.findings[0];
        (finding.mechanism, finding.probability, finding.scope) = (UNKNOWN.to_owned(), None, None);
        let shown = section(&found).into_string();
        assert!(shown.contains("<h3>Something outside the list</h3>"), "{shown}");
        assert!(!shown.contains("Alternatives") && shown.contains("one of 100 drives"), "{shown}");
        assert!(shown.contains("acts from"), "without a scope the window is a parameter: {shown}");
    }
}
