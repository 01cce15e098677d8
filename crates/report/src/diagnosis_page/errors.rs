//! Errors before and after, down to the noise.

use diagnosis::Diagnosis;
use maud::{Markup, html};

use super::power_chart;
use crate::{
    bar::{Bar, bars},
    document,
    figures::watts,
};

/// The section: root mean square errors as bars, and errors of the robot file and of the corrected model over time.
pub(super) fn section(found: &Diagnosis) -> Markup {
    let baseline = &found.baseline;
    let mut rows = vec![
        ("robot file as it is", baseline.rmse_w, "file"),
        ("refitted, held out", baseline.held_out_rmse_w, "file"),
    ];
    if !found.findings.is_empty() {
        rows.push(("with the findings, held out", found.corrected.held_out_rmse_w, "corrected"));
    }
    rows.push(("noise", baseline.noise_floor_w, "muted"));
    let largest_w = rows.iter().map(|row| row.1).fold(1e-9, f64::max);
    let values: Vec<String> = rows.iter().map(|row| watts(row.1)).collect();
    let all: Vec<Bar<'_>> = rows
        .iter()
        .zip(&values)
        .map(|(&(label, error_w, class), value)| Bar {
            label,
            share: error_w / largest_w,
            value,
            note: "",
            class,
        })
        .collect();
    let inside = html! {
        (bars(&all))
        p.quiet {
            "Root mean square error over one-second averages of each power channel. Held out: judged on parts of the drives that were not \
             fitted. Noise: what no model predicts."
            @if let Some(file) = found.file.as_ref().map(|file| file.error).filter(|file| is_apart(file.rmse_w, baseline.rmse_w)) {
                " Each channel counts by itself here; of the whole power the robot file is off by " (watts(file.rmse_w)) "."
            }
        }
        (power_chart::errors(found))
    };
    document::section("Errors before and after", &inside)
}

/// Whether two errors read as different numbers.
fn is_apart(one_w: f64, other_w: f64) -> bool {
    (one_w - other_w).abs() > 0.05
}

#[cfg(test)]
mod tests {
    use super::{super::example, *};

    #[test]
    fn errors_of_channels_and_of_the_whole_power_are_not_mistaken_for_each_other() {
        let mut found = example::explained();
        let note = "of the whole power the robot file is off by 35.0\u{a0}W";
        assert!(section(&found).into_string().contains(note));
        found.file = None;
        assert!(!section(&found).into_string().contains("whole power"));
    }
}
