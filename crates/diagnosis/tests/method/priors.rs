//! Priors of mechanisms and of the robot file's constants.

use std::{fmt::Write as _, io};

use model::{
    KnownMechanism, Robot,
    builtin::husky_a200,
    knowledge::{Provenance, Uncertainty},
    mechanism::{ALL, Form, Mechanism, Scale, Sign, SizePrior},
};

use crate::method::source::doc_of_mechanism;

/// Mean power that sizes in the table go with, and mean copper loss of a side, a fifth of half of it \[W\].
const MEAN_POWER_W: f64 = 100.0;
const MEAN_LOSS_W: f64 = 10.0;
const ROW_S: f64 = 0.1;

/// Drives of a robot that the tables are of.
fn scale(robot: &Robot) -> Scale<'_> {
    Scale {
        robot,
        meter_zero_w: 0.075 * MEAN_POWER_W,
        mean_power_w: MEAN_POWER_W,
        mean_loss_w: MEAN_LOSS_W,
        row_s: ROW_S,
    }
}

/// Prior of every parameter's size on a Husky A200.
///
/// # Errors
/// A mechanism without a source file.
pub(crate) fn sizes() -> io::Result<String> {
    let robot = husky_a200();
    let scale = scale(&robot);
    let mut text = String::from(
        "| mechanism | parameter | one σ | sign | correlation | windows | reason |\n| --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for mechanism in ALL {
        let priors = mechanism.size_prior(&scale);
        let reason = doc_of_mechanism(mechanism.name(), "size_prior")?;
        for (i, (parameter, SizePrior { sigma, sign })) in
            mechanism.parameters().iter().zip(&priors).enumerate()
        {
            if !is_ever_free(mechanism, &robot, i) {
                continue;
            }
            let sign = match sign {
                Sign::Either => "±",
                Sign::Positive => "+",
                Sign::Negative => "−",
            };
            let rho = mechanism.size_correlation();
            let correlation = if rho == 0.0 { String::new() } else { figure(rho) };
            let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
            let reason = if i == 0 { reason.as_str() } else { "" };
            let _ = writeln!(
                text,
                "| `{}` | `{}` | {}{unit} | {sign} | {correlation} | {} | {reason} |",
                mechanism.name(),
                parameter.name,
                figure(*sigma),
                windows(mechanism)
            );
        }
    }
    Ok(text)
}

/// Forms of mechanisms that have several.
///
/// # Errors
/// A mechanism without a source file.
pub(crate) fn forms() -> io::Result<String> {
    let robot = husky_a200();
    let mut text = String::from("| mechanism | forms | which | reason |\n| --- | --- | --- | --- |\n");
    for mechanism in ALL {
        let forms = mechanism.forms(&robot);
        if forms.len() < 2 {
            continue;
        }
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} |",
            mechanism.name(),
            forms.len(),
            described(mechanism, &forms),
            doc_of_mechanism(mechanism.name(), "forms")?
        );
    }
    Ok(text)
}

/// Shares of their prior size that healthy robots have of mechanisms.
///
/// # Errors
/// A mechanism without a source file.
pub(crate) fn shares() -> io::Result<String> {
    let mut text = String::from(
        "| mechanism | between drives | without healthy drives | reason |\n| --- | --- | --- | --- |\n",
    );
    let robot = husky_a200();
    for mechanism in ALL {
        let (between, unstated) = (mechanism.healthy_share(), mechanism.unstated_share(&scale(&robot)));
        if unstated <= 0.0 {
            continue;
        }
        let name = mechanism.name();
        let mut reason = doc_of_mechanism(name, "healthy_share")?;
        if unstated > between {
            reason = format!("{reason} {}", doc_of_mechanism(name, "unstated_share")?);
        }
        let _ = writeln!(text, "| `{name}` | {} | {} | {reason} |", figure(between), figure(unstated));
    }
    Ok(text)
}

/// What a robot file's constants are taken to be known to, by where they come from.
pub(crate) fn sources() -> String {
    let mut text = String::from(
        "| `provenance` | constant known to, one σ | power that the model misses, one σ |\n| --- | --- | --- |\n",
    );
    for (name, source) in [
        ("measured", Provenance::Measured),
        ("fitted", Provenance::Fitted),
        ("data-sheet", Provenance::DataSheet),
        ("borrowed", Provenance::Borrowed),
    ] {
        let known = source.relative_sigma().map_or("`posterior`, else `uncertainty`".into(), percent);
        let _ = writeln!(text, "| `{name}` | {known} | {} |", percent(source.model_error()));
    }
    let Uncertainty { mu_roll, mu_skid, k1, k2, mass_kg, .. } = Uncertainty::default();
    let [roll, skid, k1, k2, mass] = [mu_roll, mu_skid, k1, k2, mass_kg].map(percent);
    let _ = writeln!(
        text,
        "| none given | `uncertainty`; without it μ_R {roll}, μ_S {skid}, k1 {k1}, k2 {k2}, mass {mass} | {} |",
        percent(husky_a200().model_error_fraction())
    );
    text
}

/// Prior probabilities of the sets that a search scores: three mechanisms at most, or one and something unlisted.
pub(crate) fn sets(mechanism: f64, unlisted: f64) -> String {
    let odds = |prior: f64| prior / (1.0 - prior);
    let (one, other, count) = (odds(mechanism), odds(unlisted), ALL.len() as f64);
    let pairs = count * (count - 1.0) / 2.0;
    let weights = [
        ("nothing missing", 1.0),
        ("one mechanism", count * one),
        ("two", pairs * one.powi(2)),
        ("three", pairs * (count - 2.0) / 3.0 * one.powi(3)),
        ("something unlisted", other),
        ("one mechanism and something unlisted", count * one * other),
    ];
    let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let mut text = String::from("| set | prior |\n| --- | --- |\n");
    for (words, weight) in weights {
        let _ = writeln!(text, "| {words} | {} |", percent(weight / total));
    }
    text
}

fn is_ever_free(mechanism: &dyn Mechanism, robot: &Robot, parameter: usize) -> bool {
    mechanism.forms(robot).iter().any(|form| form.free.contains(&parameter))
}

fn windows(mechanism: &dyn Mechanism) -> &'static str {
    match (mechanism.is_windowed(), KnownMechanism::is_of_ground(mechanism)) {
        (false, _) => "always",
        (true, false) => "always, from",
        (true, true) => "always, from, until, place",
    }
}

/// Forms by what is free in them: what is held, or how many settings of it there are.
fn described(mechanism: &dyn Mechanism, forms: &[Form]) -> String {
    const MOST_LISTED: usize = 6;
    let name = |i: usize| format!("`{}`", mechanism.parameters()[i].name);
    let free = |form: &Form| form.free.iter().map(|i| name(*i)).collect::<Vec<_>>().join(" and ");
    let held = |form: &Form| {
        let of = |i: usize| {
            let begins = form.values[i];
            match form.free.contains(&i) {
                true if begins > 0.0 => Some(format!("{} > 0", name(i))),
                true if begins < 0.0 => Some(format!("{} < 0", name(i))),
                false if begins != 0.0 => Some(format!("{} = {}", name(i), figure(begins))),
                _ => None,
            }
        };
        let mut words: Vec<String> = (0..form.values.len()).filter_map(of).collect();
        if form.widening > 1.0 {
            words.push(format!("{} times as wide", figure(form.widening)));
        }
        words.join(", ")
    };
    if forms.len() > MOST_LISTED {
        return format!("{} free at {} settings of the others", free(&forms[0]), forms.len());
    }
    let words = |form: &Form| match held(form) {
        held if held.is_empty() => format!("{} free", free(form)),
        held => format!("{} free, {held}", free(form)),
    };
    forms.iter().map(words).collect::<Vec<_>>().join("<br>")
}

fn percent(share: f64) -> String {
    format!("{} %", figure(100.0 * share))
}

/// A number with three significant digits and no zeros at its end.
fn figure(value: f64) -> String {
    let digits = (2 - value.abs().max(1e-9).log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
