//! What repeats with every turn of the wheels.

#![allow(clippy::unwrap_used)]

mod worlds;

use diagnosis::{Diagnosis, Question, Verdict, diagnose};
use recording::Recording;
use world::{Effect, EffectName, Side};
use worlds::drive;

fn said(suspect: &Recording, healthy: Option<&Recording>) -> Diagnosis {
    diagnose(&Question::new(&model::builtin::husky_a200(), suspect, healthy), &|_, _| {}).unwrap()
}

fn turns(found: &Diagnosis) -> Option<&String> {
    found.notes.iter().find(|note| note.contains("once in every turn of its wheels"))
}

#[test]
fn a_stone_in_a_tyre_is_not_taken_for_drag() {
    let bump = Effect { side: Some(Side::Right), ..Effect::new(EffectName::WheelBump, 12.0) };
    let (suspect, healthy) = (drive(52, 800.0, vec![bump]), drive(51, 800.0, vec![]));
    let found = said(&suspect, Some(&healthy));
    assert_eq!(found.verdict, Verdict::Unexplained, "{}", found.sentence);
    assert!(found.findings.iter().all(|f| f.mechanism == "unknown"), "{}", found.sentence);
    assert!(turns(&found).unwrap().contains("the right side"), "{:?}", found.notes);
    // It is told without healthy drives too.
    let alone = said(&suspect, None);
    assert!(alone.verdict == Verdict::Unexplained && turns(&alone).is_some(), "{}", alone.sentence);
}

#[test]
fn a_stone_in_a_tyre_is_told_of_a_short_drive_too() {
    // Nine minutes at changing speeds are some 170 turns.
    let bump = Effect { side: Some(Side::Right), ..Effect::new(EffectName::WheelBump, 28.0) };
    let (suspect, healthy) = (drive(54, 540.0, vec![bump]), drive(51, 540.0, vec![]));
    let found = said(&suspect, Some(&healthy));
    assert!(found.findings.iter().all(|f| f.mechanism == "unknown"), "{}", found.sentence);
    assert!(turns(&found).unwrap().contains("the right side"), "{:?}", found.notes);
}

#[test]
fn drag_on_one_side_and_robots_in_order_show_no_turns() {
    let dragging = Effect::new(EffectName::DrivetrainDrag, 8.0);
    let healthy = drive(51, 800.0, vec![]);
    let found = said(&drive(52, 800.0, vec![dragging]), Some(&healthy));
    assert_eq!(found.verdict, Verdict::Explained, "{}", found.sentence);
    assert_eq!(found.findings[0].mechanism, "drivetrain_drag");
    assert!(turns(&found).is_none(), "{:?}", found.notes);
    let found = said(&drive(52, 800.0, vec![]), Some(&healthy));
    assert!(found.verdict == Verdict::Consistent && turns(&found).is_none(), "{}", found.sentence);
}
