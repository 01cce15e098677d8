//! Scores are what the rules say, whatever a diagnosis claims for itself.

#![allow(clippy::unwrap_used)]

use prove::{
    CaseScore, Kind, Outcome, Parameter, Report, Scoreboard, SealedKey, Truth, Twin, score, scoreboard,
};
use world::{Drive, EffectName, World};

fn key(case: &str, kind: Kind, effects: &[EffectName]) -> SealedKey {
    let truth = |effect: &EffectName| Truth {
        effect: *effect,
        family: effect.family(),
        parameters: vec![Parameter { name: "mass_kg".into(), value: 10.0, unit: "kg".into() }],
        onset_s: 0.0,
        power_change: 0.03,
    };
    SealedKey {
        case: case.into(),
        kind,
        share: if kind.conceals() { 0.03 } else { 0.0 },
        seed: 1,
        truths: effects.iter().map(truth).collect(),
        files: Default::default(),
        world: World::from_json(r#"{"terrain": "level"}"#).unwrap(),
        drive: Drive::from_json(r#"{"kind": "rich", "duration_s": 60}"#).unwrap(),
    }
}

fn says(verdict: &str, findings: &str) -> Outcome {
    fits(verdict, findings, [4.0, 2.1])
}

fn fits(verdict: &str, findings: &str, [before_w, after_w]: [f64; 2]) -> Outcome {
    // Noise is nine tenths of what is left.
    let noise_w = 0.9 * after_w;
    let text = format!(
        r#"{{"verdict": "{verdict}", "baseline": {{"held_out_rmse_w": {before_w}, "bias_w": 0.1, "noise_floor_w": {noise_w}}}, "where": [],
            "findings": [{findings}], "corrected": {{"held_out_rmse_w": {after_w}}}, "next_drive": null}}"#
    );
    Outcome::Report(serde_json::from_str::<Report>(&text).unwrap())
}

fn finding(name: &str, others: &str) -> String {
    fitting(name, others, [4.0, 2.5])
}

fn fitting(name: &str, others: &str, [before_w, after_w]: [f64; 2]) -> String {
    format!(
        r#"{{"mechanism": "{name}", "indistinguishable_from": [{others}],
            "parameters": [{{"name": "mass_kg", "value": 11.0, "unit": "kg", "interval_95": [9.0, 13.0]}}],
            "fit": {{"held_out_rmse_before_w": {before_w}, "held_out_rmse_after_w": {after_w}}}}}"#
    )
}

fn twin() -> Option<Twin> {
    Some(Twin::new(&fits("consistent", "", [2.0, 2.0])))
}

fn board(scores: Vec<CaseScore>) -> Scoreboard {
    scoreboard(7, "abc".into(), scores)
}

fn one(effect: EffectName, outcome: &Outcome) -> CaseScore {
    let kind = if effect.family() == world::Family::Unlisted { Kind::Unlisted } else { Kind::One };
    score(&key("case-0001", kind, &[effect]), &[40.0], outcome, twin())
}

#[test]
fn abstaining_and_failing_count_against_what_was_found() {
    let found = one(EffectName::Payload, &says("explained", &finding("payload", "")));
    let quiet = one(EffectName::Payload, &says("consistent", ""));
    let failed = one(EffectName::Payload, &Outcome::Failed("exit status: 1".into()));
    let board = board(vec![found, quiet, failed]);
    assert_eq!((board.in_two.hits, board.in_two.of), (1, 3));
    assert_eq!((board.named_first.hits, board.named_first.of), (1, 3));
    assert_eq!((board.abstained.hits, board.abstained.of), (1, 3));
    assert_eq!((board.errors.hits, board.errors.of), (1, 3));
    assert_eq!(board.cases, 3, "a failed diagnosis is not dropped");
}

#[test]
fn sets_of_three_are_no_answer_and_the_truth_in_second_place_is_not_named_first() {
    let second = one(EffectName::Payload, &says("ambiguous", &finding("towed_load", r#""payload""#)));
    let many = one(EffectName::Payload, &says("ambiguous", &finding("payload", r#""towed_load", "wind""#)));
    let board = board(vec![second, many]);
    assert_eq!((board.in_two.hits, board.in_two.of), (1, 2));
    assert_eq!(board.mean_set_size, Some(2.5));
    let second = &board.scores[0].truths[0];
    assert!(second.in_two && !second.named_first && second.parameters.is_empty());
    assert!(!board.scores[1].truths[0].in_two);
}

#[test]
fn numbers_are_compared_only_by_the_same_name_and_unit() {
    let right = one(EffectName::Payload, &says("explained", &finding("payload", "")));
    let number = &right.truths[0].parameters[0];
    assert!((number.relative_error.unwrap() - 0.1).abs() < 1e-12 && number.covered == Some(true));
    let other_unit = finding("payload", "").replace(r#""unit": "kg""#, r#""unit": "t""#);
    assert!(one(EffectName::Payload, &says("explained", &other_unit)).truths[0].parameters.is_empty());
    assert_eq!(right.rmse_ratio, Some(2.1 / 2.0));
}

#[test]
fn faults_called_physics_and_the_reverse_are_told_apart() {
    let sensor = one(EffectName::PitchBias, &says("explained", &finding("payload", "")));
    let physics = one(EffectName::Payload, &says("explained", &finding("power_scale", "")));
    let undecided = one(EffectName::PitchBias, &says("ambiguous", &finding("payload", r#""pitch_bias""#)));
    let board = board(vec![sensor, physics, undecided]);
    assert_eq!((board.sensor_called_physics.hits, board.sensor_called_physics.of), (1, 2));
    assert_eq!((board.physics_called_sensor.hits, board.physics_called_sensor.of), (1, 1));
}

#[test]
fn effects_outside_the_list_may_be_unknown_but_not_something_else() {
    let unknown = one(EffectName::Puddles, &says("unexplained", &finding("unknown", "")));
    let misnamed = one(EffectName::Puddles, &says("explained", &finding("soft_soil", "")));
    let failed = one(EffectName::Puddles, &Outcome::Failed("killed".into()));
    let board = board(vec![unknown, misnamed, failed]);
    assert_eq!((board.unlisted_not_misnamed.hits, board.unlisted_not_misnamed.of), (1, 3));
    assert_eq!(board.unlisted_strong_not_misnamed, board.unlisted_not_misnamed, "3 % of power is strong");
    // With nothing for those that have no term, and of those that have one.
    let explained = (16.0 - 6.25) / (16.0 - 4.0);
    assert_eq!(board.unlisted_explained_median, Some(0.0));
    assert_eq!(board.unlisted_terms_explain_median, Some(explained));
    // From 4 W down to 2.5 W, of a mismatch that ends at the 2 W of the twin's drive.
    assert_eq!(board.scores[0].discovered, Some((16.0 - 6.25) / (16.0 - 4.0)));
    assert_eq!((board.in_two.of, board.detected.of), (0, 0), "they are no part of the list's figures");
}

#[test]
fn errors_after_correction_are_told_apart_of_effects_with_and_without_a_name() {
    let after = |effect, after_w| one(effect, &fits("explained", &finding("payload", ""), [4.0, after_w]));
    // The twin's drive ends at 2 W.
    let payloads = [2.0, 2.04, 2.2].map(|after_w| after(EffectName::Payload, after_w));
    let puddles = [3.0, 3.2].map(|after_w| after(EffectName::Puddles, after_w));
    let board = board(payloads.into_iter().chain(puddles).collect());
    assert_eq!(board.rmse_ratio_listed_median, Some(2.04 / 2.0));
    assert_eq!(board.noise_ratio_listed_median, Some(0.9 * 2.04 / (0.9 * 2.0)));
    assert_eq!(board.rmse_ratio_unlisted_median, Some(3.1 / 2.0));
}

#[test]
fn terms_that_are_discovered_count_together() {
    let terms = [fitting("unknown", "", [4.0, 3.5]), fitting("unknown", "", [3.5, 2.5])].join(", ");
    let found = one(EffectName::Puddles, &says("unexplained", &terms));
    assert_eq!(found.discovered, Some((16.0 - 6.25) / (16.0 - 4.0)));
    // The twin's drive ends at 2 W: more than all of the mismatch there is not.
    let below = one(EffectName::Puddles, &says("unexplained", &fitting("unknown", "", [2.1, 1.5])));
    assert_eq!(below.discovered, Some(1.0));
}

#[test]
fn both_of_two_needs_two_findings() {
    let kind = [EffectName::Payload, EffectName::Wind];
    let half = score(
        &key("case-0001", Kind::Two, &kind),
        &[40.0, 50.0],
        &says("ambiguous", &finding("wind", r#""payload""#)),
        twin(),
    );
    let both = says("explained", &[finding("wind", ""), finding("payload", "")].join(","));
    let both = score(&key("case-0002", Kind::Two, &kind), &[40.0, 50.0], &both, twin());
    let board = board(vec![half, both]);
    assert_eq!((board.both_of_two.hits, board.both_of_two.of), (1, 2));
    assert_eq!(board.scores.iter().map(|s| s.wrong_names).sum::<usize>(), 0);
}

#[test]
fn alarms_on_healthy_drives_and_decoys_and_twins_are_false() {
    let alarm = says("unexplained", &finding("unknown", ""));
    let healthy = score(&key("a", Kind::Healthy, &[]), &[], &alarm, None);
    let decoy = score(&key("b", Kind::Decoy, &[]), &[], &says("consistent", ""), None);
    let failed = score(&key("d", Kind::Healthy, &[]), &[], &Outcome::Failed("killed".into()), None);
    let shaken = score(
        &key("c", Kind::One, &[EffectName::Payload]),
        &[40.0],
        &says("consistent", ""),
        Some(Twin::new(&alarm)),
    );
    let board = board(vec![healthy, decoy, failed, shaken]);
    assert_eq!(
        (board.false_alarms_healthy.hits, board.false_alarms_healthy.of),
        (2, 2),
        "failing is not keeping quiet"
    );
    assert_eq!((board.false_alarms_decoy.hits, board.false_alarms_decoy.of), (0, 1));
    assert_eq!((board.false_alarms_twin.hits, board.false_alarms_twin.of), (1, 1));
}

#[test]
fn other_names_and_another_order_of_cases_change_no_figure() {
    let outcomes = [
        (EffectName::Payload, says("explained", &finding("payload", ""))),
        (EffectName::Wind, says("explained", &finding("payload", ""))),
        (EffectName::Puddles, says("unexplained", &finding("unknown", ""))),
        (EffectName::Payload, says("consistent", "")),
    ];
    let scores: Vec<CaseScore> = outcomes.iter().map(|(effect, outcome)| one(*effect, outcome)).collect();
    let mut other: Vec<CaseScore> = scores.iter().rev().cloned().collect();
    for (i, score) in other.iter_mut().enumerate() {
        score.case = format!("renamed-{i}");
    }
    let [mut a, mut b] = [board(scores), board(other)];
    a.scores.clear();
    b.scores.clear();
    assert_eq!(a, b);
}

#[test]
fn a_score_that_was_written_is_read_as_it_was_without_a_strength_too() {
    let said = says("explained", &finding("payload", ""));
    let known = one(EffectName::Payload, &said);
    let unknown = score(&key("case-0002", Kind::One, &[EffectName::Payload]), &[], &said, twin());
    for case in [known, unknown] {
        let read: CaseScore = serde_json::from_str(&serde_json::to_string(&case).unwrap()).unwrap();
        assert_eq!(format!("{read:?}"), format!("{case:?}"));
    }
}

#[test]
fn a_miss_is_too_small_only_by_what_the_report_says_of_that_effects_own_number() {
    let quiet = |detectable: &str| {
        let text = format!(
            r#"{{"verdict": "consistent", "baseline": {{"held_out_rmse_w": 2.0}}, "findings": [], "detectable": [{detectable}]}}"#
        );
        one(EffectName::Payload, &Outcome::Report(serde_json::from_str::<Report>(&text).unwrap()))
    };
    let least = |mechanism: &str, parameter: &str, value: f64| {
        format!(
            r#"{{"mechanism": "{mechanism}", "parameter": "{parameter}", "value": {value}, "unit": "kg"}}"#
        )
    };
    // The truth is 10 kg.
    let scores = vec![
        quiet(&least("payload", "mass_kg", 12.0)),
        quiet(&least("payload", "mass_kg", 8.0)),
        quiet(&least("towed_load", "mass_kg", 12.0)),
        quiet(&least("payload", "other", 12.0)),
        one(EffectName::Payload, &says("explained", &finding("payload", ""))),
    ];
    let board = board(scores);
    let told: Vec<Option<bool>> = board.scores.iter().map(|case| case.truths[0].too_small).collect();
    assert_eq!(told, [Some(true), Some(false), None, None, None]);
    assert_eq!((board.missed_too_small.hits, board.missed_too_small.of), (1, 4), "what was named is no miss");
}
