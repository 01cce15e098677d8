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
    assert!(found.findings[0].equation.contains("cos(α"), "{}", found.findings[0].equation);
    assert!(turns(&found).unwrap().contains("the right side"), "{:?}", found.notes);
    // The first finding takes most of what is missing: half of the way down to the noise.
    let fit = found.findings[0].fit;
    let squares = |a: f64, b: f64| a * a - b * b;
    let whole =
        squares(fit.held_out_rmse_before_w, found.baseline.noise_floor_w.min(fit.held_out_rmse_after_w));
    assert!(squares(fit.held_out_rmse_before_w, fit.held_out_rmse_after_w) > 0.5 * whole, "{fit:?}");
    // What was told is no noise.
    let (floor_w, corrected_w) = (found.baseline.noise_floor_w, found.corrected.rmse_w);
    assert!(floor_w <= corrected_w, "{floor_w} {corrected_w}");
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
