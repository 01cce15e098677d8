//! Names that explain the same.

use crate::search::{AS_GOOD, Found};

/// Mechanisms whose fits fall short of the best by less are as good: twice the log of a likelihood ratio of e. Of 93 weak effects that were
/// noticed in worlds that none is scored on, the truth stood in a set of two at most 82 times and 6 sets of two were without it; with 3 it
/// was 78 and 5, as more sets were larger.
const AS_GOOD_A_NAME: f64 = 2.0;

/// Names beside that of the winner.
pub(crate) struct Names {
    /// Of all that explain as much, or else of the next, if it falls short by too little to leave the winner alone.
    pub(crate) as_good: Vec<String>,
    /// Of the others that fall short by as little, best first: each of them is the next if those before it turn out to be none.
    pub(crate) next: Vec<String>,
}

/// What stands beside the winner.
pub(crate) fn names(rivals: &[&str], costs: &[f64], winner: usize) -> Names {
    let mut order: Vec<usize> = (0..costs.len()).filter(|i| costs[*i] < costs[winner] + AS_GOOD).collect();
    order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    let mut as_good: Vec<String> = Vec::new();
    let (mut near, own) = (0, rivals[winner]);
    // A mechanism may be a rival all over the ground and in a part of it.
    for i in order.into_iter().filter(|i| rivals[*i] != own) {
        if as_good.iter().all(|other| other != rivals[i]) {
            near += usize::from(costs[i] < costs[winner] + AS_GOOD_A_NAME);
            as_good.push(rivals[i].to_owned());
        }
    }
    let next = as_good.split_off(near.max(1).min(as_good.len()));
    Names { as_good, next }
}

/// What was found itself is no other name of what was found beside it.
pub(crate) fn tell_apart(found: &mut [Found]) {
    let names: Vec<&str> = found.iter().map(|one| one.applied.mechanism.name()).collect();
    for one in found {
        one.indistinguishable_from.retain(|other| !names.contains(&other.as_str()));
    }
}

#[cfg(test)]
mod tests {
    use model::mechanism;

    use super::*;
    use crate::{series::Applied, span::Span};

    #[test]
    fn a_rival_is_another_name_once_and_never_its_own() {
        let rivals = ["surface_change", "payload", "power_scale", "payload", "surface_change"];
        let names = names(&rivals, &[10.0, 10.5, 11.0, 10.2, 10.1], 0);
        assert_eq!(names.as_good, ["payload", "power_scale"]);
    }

    #[test]
    fn the_next_name_stands_beside_one_that_is_alone_if_it_is_near_and_others_do_only_if_they_explain_as_much()
     {
        let rivals = ["payload", "towed_load", "soft_soil", "payload"];
        let beside = |costs: [f64; 4]| {
            let Names { as_good, next } = names(&rivals, &costs, 0);
            [as_good.join(" "), next.join(" ")]
        };
        assert_eq!(beside([10.0, 15.0, 14.0, 11.0]), ["soft_soil", "towed_load"]);
        assert_eq!(beside([10.0, 11.5, 14.0, 10.5]), ["towed_load", "soft_soil"]);
        assert_eq!(beside([10.0, 11.5, 11.0, 10.5]), ["soft_soil towed_load", ""]);
        assert_eq!(beside([10.0, 16.5, 17.0, 10.5]), ["", ""]);
    }

    #[test]
    fn what_was_found_is_no_other_name_of_what_was_found_beside_it() {
        let one = |name: &str, others: &[&str]| Found {
            applied: Applied {
                mechanism: mechanism::by_name(name).unwrap(),
                values: Vec::new(),
                span: Span::ALL,
            },
            half_widths: Vec::new(),
            limits_95: Vec::new(),
            p_value: 0.0,
            delta_bic: 0.0,
            held_out_gain: 0.0,
            indistinguishable_from: others.iter().map(|other| (*other).to_owned()).collect(),
            next_names: Vec::new(),
        };
        let mut found = [one("surface_change", &["center_of_mass", "soft_soil"]), one("center_of_mass", &[])];
        tell_apart(&mut found);
        assert_eq!(found[0].indistinguishable_from, ["soft_soil"]);
    }
}
