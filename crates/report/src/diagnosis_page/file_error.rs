//! The error of the robot file as it is.

use diagnosis::Diagnosis;
use maud::{Markup, html};

use super::power_chart;
use crate::{document, figures::watts, labels::capitalized};

/// The section: bias, root mean square error and noise in a sentence, and recorded power against the file's prediction.
pub(super) fn section(found: &Diagnosis) -> Markup {
    let inside = html! {
        p.lead { (sentence(found)) }
        (power_chart::recorded_and_file(found))
        (shared(found))
    };
    document::section("Error of the robot file", &inside)
}

/// Mechanisms that all drives share, healthy ones included; nothing where there are none.
fn shared(found: &Diagnosis) -> Markup {
    let findings = found.file.as_ref().map_or(&[][..], |file| &file.findings);
    if findings.is_empty() {
        return html! {};
    }
    html! {
        p { "The healthy drives need this beside the robot file as well, so that it is a property of this robot and sets no verdict:" }
        ul { @for finding in findings { li { (capitalized(&finding.statement)) "." } } }
    }
}

/// Errors of the file: those of the whole power where they are known, else those of each meter.
struct Error {
    bias_w: f64,
    rmse_w: f64,
    noise_w: f64,
    mean_power_w: Option<f64>,
}

impl Error {
    fn of(found: &Diagnosis) -> Self {
        found.file.as_ref().map(|file| file.error).map_or(
            Error {
                bias_w: found.baseline.bias_w,
                rmse_w: found.baseline.rmse_w,
                noise_w: found.baseline.noise_floor_w,
                mean_power_w: None,
            },
            |file| Error {
                bias_w: file.bias_w,
                rmse_w: file.rmse_w,
                noise_w: file.noise_w,
                mean_power_w: Some(file.mean_power_w),
            },
        )
    }
}

/// The error in a sentence. The bias is recorded less predicted power.
fn sentence(found: &Diagnosis) -> String {
    let Error { bias_w, rmse_w, noise_w, mean_power_w } = Error::of(found);
    let share = mean_power_w.filter(|mean_w| *mean_w > 0.0).map_or(String::new(), |mean_w| {
        format!(", {:.1}\u{a0}% of the mean power of {}", 100.0 * bias_w.abs() / mean_w, watts(mean_w))
    });
    format!(
        "The robot file predicts these drives {} {} on average{share} ({} RMSE; noise {}).",
        watts(bias_w.abs()),
        way(bias_w),
        watts(rmse_w),
        watts(noise_w)
    )
}

fn way(bias_w: f64) -> &'static str {
    if bias_w >= 0.0 { "too low" } else { "too high" }
}

#[cfg(test)]
mod tests {
    use super::{super::example, *};

    #[test]
    fn a_file_whose_prediction_lies_below_what_was_recorded_is_too_low() {
        let mut found = example::explained();
        let plain = |found: &Diagnosis| sentence(found).replace('\u{a0}', " ");
        assert_eq!(
            plain(&found),
            "The robot file predicts these drives 27.0 W too low on average, 27.0 % of the mean power of 100.0 W (35.0 W RMSE; noise 1.9 W)."
        );
        found.file = None;
        assert_eq!(
            plain(&found),
            "The robot file predicts these drives 13.0 W too high on average (18.0 W RMSE; noise 1.9 W)."
        );
    }
}
