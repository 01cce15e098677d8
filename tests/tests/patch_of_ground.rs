//! Ground that is another in one part of the map only.

#![allow(clippy::unwrap_used)]

mod worlds;

use diagnosis::{Diagnosis, Question, Verdict, diagnose};
use recording::{Channel, Recording};
use world::{Effect, EffectName, Place};
use worlds::drive;

fn middle(values: &[f64]) -> f64 {
    let mut known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    known.sort_by(f64::total_cmp);
    known[known.len() / 2]
}

fn said(suspect: &Recording, healthy: &Recording) -> Diagnosis {
    diagnose(&Question::new(&model::builtin::husky_a200(), suspect, Some(healthy)), &|_, _| {}).unwrap()
}

#[test]
fn other_ground_in_one_half_of_the_map_is_named_and_said_where() {
    let (plain, healthy) = (drive(42, 800.0, vec![]), drive(41, 800.0, vec![]));
    let border_m = middle(plain.channel(Channel::X).unwrap());
    let east = Place { x_m: [border_m, 1e6], y_m: [-1e6, 1e6] };
    let effect = Effect { place: Some(east), ..Effect::new(EffectName::SurfaceChange, 0.3) };
    let found = said(&drive(42, 800.0, vec![effect]), &healthy);
    assert_ne!(found.verdict, Verdict::Consistent, "{}", found.sentence);
    let named: Vec<&str> = found.findings.iter().map(|finding| finding.mechanism.as_str()).collect();
    assert!(named.contains(&"surface_change"), "{}", found.sentence);
    assert!(named.iter().all(|name| ["surface_change", "unknown"].contains(name)), "{}", found.sentence);
    let place = found.places.iter().find(|place| place.kind == "place").unwrap();
    let [from, to] = place.range.x_m.unwrap();
    assert!(from.is_some_and(|from| (from - border_m).abs() < 8.0) && to.is_none(), "{place:?}");
}

#[test]
fn a_healthy_drive_has_no_place_of_its_own() {
    let found = said(&drive(42, 800.0, vec![]), &drive(41, 800.0, vec![]));
    assert_eq!(found.verdict, Verdict::Consistent, "{}", found.sentence);
}
