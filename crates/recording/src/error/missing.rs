//! Names that a file lacks, with those in it that come nearest.

use super::{Error, excerpt};
use crate::{Channel, inspect::Side};

impl Error {
    /// The missing channels that a recording cannot do without, with the names in the file that come nearest.
    pub(crate) fn missing(lacks: &[Channel], power: bool, found: &[String]) -> Error {
        let mut missing: Vec<String> = lacks.iter().map(|channel| channel.name().to_owned()).collect();
        let mut wanted: Vec<&str> = lacks.iter().map(|channel| channel.name()).collect();
        if power {
            missing.push(
                "power (power_left_w and power_right_w, or power_w, or current_a and voltage_v, \
                 or motor_current_left_a and motor_current_right_a)"
                    .into(),
            );
            wanted.extend(Channel::all().filter(|channel| channel.tells_power()).map(Channel::name));
        }
        Error::missing_names(&missing, &wanted, found)
    }

    /// Missing names, whatever they stand for.
    pub(crate) fn missing_names(missing: &[String], wanted: &[&str], found: &[String]) -> Error {
        let near = |name: &&str| {
            // A channel's own name is no slip, and one side is never the other.
            let is_free = |other: &&String| {
                Channel::from_name(other).is_none()
                    && !wanted.contains(&other.as_str())
                    && !are_opposite(other, name)
            };
            let best = found.iter().filter(is_free).map(|f| (strsim::normalized_levenshtein(f, name), f));
            let (likeness, best) = best.max_by(|a, b| a.0.total_cmp(&b.0))?;
            (likeness >= WORTH_NAMING).then(|| (best.clone(), (*name).to_owned()))
        };
        let nearest = wanted.iter().filter_map(near).collect();
        let verb = if missing.len() == 1 { "is" } else { "are" };
        Error::Missing {
            missing: format!("{} {verb}", missing.join(", ")),
            found: shortened(found),
            nearest,
            unread: Vec::new(),
        }
    }
}

/// Whether two names are of different sides of the robot.
fn are_opposite(one: &str, other: &str) -> bool {
    let sides = [one, other].map(Side::of_name);
    matches!(sides, [Some(one), Some(other)] if one != other)
}

/// Names that share at least so much of their letters are worth naming as a likely slip (`power_kw` for `power_w`: 0.88).
const WORTH_NAMING: f64 = 0.6;

/// Most names that a message lists.
const MOST_NAMES: usize = 40;

fn shortened(names: &[String]) -> Vec<String> {
    let mut some: Vec<String> = names.iter().take(MOST_NAMES).map(|name| excerpt(name)).collect();
    if names.len() > MOST_NAMES {
        some.push(format!("and {} more", names.len() - MOST_NAMES));
    }
    some
}

pub(super) fn hints(nearest: &[(String, String)]) -> String {
    let hint = |(found, wanted): &(String, String)| format!("`{}` for {wanted}", excerpt(found));
    match nearest {
        [] => "; rename the columns or name them in a map (`joulepath inspect LOG --write-map my-map.json` proposes one)".into(),
        _ => {
            let hints: Vec<String> = nearest.iter().map(hint).collect();
            format!("; did you mean {}? Rename it, or name it with its unit in a map", hints.join(", "))
        }
    }
}

pub(super) fn reasons(unread: &[String]) -> String {
    match unread {
        [] => String::new(),
        some => format!("; not read: {}", some.join("; ")),
    }
}
