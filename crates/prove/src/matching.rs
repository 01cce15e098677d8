//! Which finding answers to which truth: each finding to one at most.

use crate::Finding;

/// Names in a finding's set up to which it counts as an answer.
pub(crate) const LARGEST_ANSWER: usize = 2;

/// How well a finding answers to a truth; more is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Answer {
    /// Not at all.
    None,
    /// The truth is one of many.
    OneOfMany,
    /// The truth is one of two.
    OneOfTwo,
    /// The truth comes first.
    First,
}

/// How a finding answers to a truth. A name that comes first with more than two beside it is one of many.
pub(crate) fn answer(finding: &Finding, truth: &str) -> Answer {
    let set = finding.set();
    match set.iter().position(|name| *name == truth) {
        None => Answer::None,
        Some(_) if set.len() > LARGEST_ANSWER => Answer::OneOfMany,
        Some(0) => Answer::First,
        Some(_) => Answer::OneOfTwo,
    }
}

/// For each truth the finding that answers to it, so that all together answer best; of equals the earlier finding.
pub(crate) fn best(findings: &[Finding], truths: &[String]) -> Vec<Option<usize>> {
    let mut taken = vec![false; findings.len()];
    search(findings, truths, &mut taken).1
}

fn search(findings: &[Finding], truths: &[String], taken: &mut [bool]) -> (usize, Vec<Option<usize>>) {
    let Some((truth, rest)) = truths.split_first() else { return (0, Vec::new()) };
    let mut best = search(findings, rest, taken);
    best.1.insert(0, None);
    for i in 0..findings.len() {
        let worth = answer(&findings[i], truth) as usize;
        if taken[i] || worth == 0 {
            continue;
        }
        taken[i] = true;
        let (sum, mut chosen) = search(findings, rest, taken);
        taken[i] = false;
        if sum + worth > best.0 {
            chosen.insert(0, Some(i));
            best = (sum + worth, chosen);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(names: &[&str]) -> Finding {
        Finding {
            mechanism: names[0].into(),
            parameters: Vec::new(),
            indistinguishable_from: names[1..].iter().map(|name| (*name).to_owned()).collect(),
            fit: crate::report::HeldOut::default(),
            scope: None,
        }
    }

    fn truths(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn a_set_of_three_is_no_answer_and_repeating_a_name_makes_no_set_larger() {
        assert_eq!(answer(&finding(&["wind", "payload"]), "payload"), Answer::OneOfTwo);
        assert_eq!(answer(&finding(&["payload", "wind", "inertia"]), "payload"), Answer::OneOfMany);
        assert_eq!(answer(&finding(&["payload", "payload", "wind"]), "payload"), Answer::First);
        assert_eq!(answer(&finding(&["wind"]), "payload"), Answer::None);
    }

    #[test]
    fn one_finding_does_not_answer_to_two_truths() {
        let one = [finding(&["wind", "payload"])];
        assert_eq!(best(&one, &truths(&["payload", "wind"])), [None, Some(0)]);
    }

    #[test]
    fn findings_are_dealt_so_that_all_truths_are_answered() {
        let both = [finding(&["wind", "payload"]), finding(&["wind"])];
        assert_eq!(best(&both, &truths(&["wind", "payload"])), [Some(1), Some(0)]);
    }
}
