//! What no mechanism of the list describes gets no name of the list.

#![allow(clippy::unwrap_used)]

mod worlds;

use diagnosis::{Diagnosis, Question, Verdict, diagnose};
use model::Robot;
use recording::{Channel, Recording};
use world::{Effect, EffectName, Side};
use worlds::{drawn, drive};

fn record(seed: u64, effects: Vec<Effect>) -> Recording {
    drive(seed, 480.0, effects)
}

/// A drive of the same robot in order.
fn in_order() -> Recording {
    drive(31, 320.0, vec![])
}

fn said(robot: &Robot, suspect: &Recording, healthy: &Recording) -> Diagnosis {
    diagnose(&Question::new(robot, suspect, Some(healthy)), &|_, _| {}).unwrap()
}

fn names(found: &Diagnosis) -> Vec<&str> {
    found.findings.iter().map(|finding| finding.mechanism.as_str()).collect()
}

/// That a robot on which something acts lacks something, and that nothing of the list is named.
fn has_no_name(effect: Effect) {
    let what = format!("{effect:?}");
    let found = said(&model::builtin::husky_a200(), &record(32, vec![effect]), &in_order());
    assert_eq!(found.verdict, Verdict::Unexplained, "{what}: {}", found.sentence);
    assert!(names(&found).iter().all(|name| *name == "unknown"), "{what}: {}", found.sentence);
}

#[test]
fn a_frame_that_rings_at_one_speed_with_four_per_cent_of_power_gets_no_name_of_the_list() {
    has_no_name(Effect::new(EffectName::Resonance, 15.0));
}

#[test]
fn furrows_that_take_six_per_cent_of_power_get_no_name_of_the_list() {
    has_no_name(Effect::new(EffectName::Furrows, 15.0));
}

#[test]
fn turns_on_slopes_that_take_three_per_cent_of_power_get_no_name_of_the_list() {
    has_no_name(Effect::new(EffectName::TurnOnSlope, 80.0));
}

#[test]
fn what_a_robot_in_order_does_as_well_is_nothing_that_is_missing() {
    let robot = model::builtin::husky_a200();
    for (effect, strength) in [(EffectName::LowDutyLoss, 10.0), (EffectName::TurnOnSlope, 80.0)] {
        let effect = || vec![Effect::new(effect, strength)];
        let found = said(&robot, &record(32, effect()), &record(31, effect()));
        assert_eq!(found.verdict, Verdict::Consistent, "{}", found.sentence);
    }
}

#[test]
fn drag_that_is_gone_once_a_brake_is_warm_is_not_called_drag() {
    let robot = model::builtin::husky_a200();
    for seed in [32, 34] {
        let brake = Effect { side: Some(Side::Right), ..Effect::new(EffectName::BindingBrake, 20.0) };
        let found = said(&robot, &record(seed, vec![brake]), &in_order());
        assert_eq!(found.verdict, Verdict::Unexplained, "{}", found.sentence);
        assert!(!names(&found).contains(&"drivetrain_drag"), "{}", found.sentence);
        assert!(found.probability.is_some_and(|all| all.unlisted > 0.9), "{:?}", found.probability);
    }
}

/// Where it starts moving it sticks, of which there is too little to say more than that something rolls harder.
#[test]
fn what_sticks_at_starts_is_no_soft_soil_that_is_hardly_seen() {
    let [suspect, healthy] = drawn(1_927_103_851_437_243, EffectName::StickyStart, 0.012);
    let found = said(&model::builtin::husky_a200(), &suspect, &healthy);
    assert!(names(&found).iter().all(|name| *name == "unknown"), "{}", found.sentence);
}

#[test]
fn a_brake_that_binds_for_half_a_minute_is_not_called_drag() {
    // From when it sets in it takes hundreds of watts, and a minute later hardly any: drag follows the little that stays.
    let brake =
        Effect { side: Some(Side::Left), onset_s: 187.0, ..Effect::new(EffectName::BindingBrake, 80.0) };
    let found = said(&model::builtin::husky_a200(), &drive(34, 900.0, vec![brake]), &in_order());
    assert!(names(&found).iter().all(|name| *name == "unknown"), "{}", found.sentence);
}

#[test]
fn what_comes_again_and_again_is_missing_though_nothing_recorded_tells_when() {
    // A bearing that seizes for seven seconds, at times that follow nothing.
    let robot = model::builtin::husky_a200();
    let mut suspect = drive(32, 600.0, vec![]);
    for channel in [Channel::LeftPower, Channel::Power] {
        let Some(power_w) = suspect.channels.get_mut(&channel) else { continue };
        for from_s in [41, 66, 131, 158, 217, 284, 303, 381, 419, 457, 512, 568] {
            power_w[10 * from_s..10 * from_s + 70].iter_mut().for_each(|w| *w += 40.0);
        }
    }
    let found = said(&robot, &suspect, &record(31, vec![]));
    assert_eq!(found.verdict, Verdict::Unexplained, "{}", found.sentence);
    assert!(names(&found).iter().all(|name| *name == "unknown"), "{}", found.sentence);
}

#[test]
fn water_in_hollows_gets_no_name_of_the_list() {
    let puddles = Effect::new(EffectName::Puddles, 400.0);
    let found = said(&model::builtin::husky_a200(), &record(32, vec![puddles]), &in_order());
    assert!(names(&found).iter().all(|name| *name == "unknown"), "{}", found.sentence);
}
