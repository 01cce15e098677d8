//! Sentences that a person reads.

use crate::report::{Diagnosis, Verdict};

/// The verdict in one sentence.
pub(crate) fn sentence(found: &Diagnosis) -> String {
    let findings = &found.findings;
    let said: Vec<&str> = findings.iter().map(|finding| finding.statement.as_str()).collect();
    let left = 100.0 * found.explainable[1];
    match found.verdict {
        Verdict::Consistent => format!(
            "Nothing is missing: where it was not fitted, the model is off by {:.1} W, and what is left follows nothing that was \
             recorded.",
            found.corrected.held_out_rmse_w
        ),
        Verdict::Explained => format!("{}.", said.join("; besides, ")),
        Verdict::Ambiguous => {
            let mut others: Vec<String> = findings
                .iter()
                .flat_map(|f| f.indistinguishable_from.iter().map(|name| plain(name).to_owned()))
                .collect();
            others.sort();
            others.dedup();
            let others = listed(&others);
            format!("{}; or it is {others}, which these drives cannot tell apart.", said.join("; besides, "))
        }
        Verdict::Unexplained if findings.is_empty() => format!(
            "Something is missing that no known mechanism describes: {left:.0} % of the remaining error follows from what was \
             recorded."
        ),
        Verdict::Unexplained => format!(
            "{}; but that is not all: {left:.0} % of the remaining error still follows from what was recorded, and no known \
             mechanism describes it.",
            said.join("; besides, ")
        ),
    }
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
