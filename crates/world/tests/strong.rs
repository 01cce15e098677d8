//! Strong effects can be drawn as well as weak ones.

#![allow(clippy::unwrap_used)]

use world::{Case, CaseKind, EffectName, example_robot};

#[test]
fn faults_that_power_does_not_show_are_no_stronger_than_their_range() {
    let robot = example_robot();
    for name in [EffectName::WheelRadius, EffectName::PitchBias] {
        let case = Case::draw(3, CaseKind::One(name), 0.4, &robot).unwrap();
        let [_, most] = name.range();
        assert!(case.world.effects[0].strength <= most, "{name:?}: {:?}", case.world.effects);
        case.key(&robot).unwrap();
    }
}
