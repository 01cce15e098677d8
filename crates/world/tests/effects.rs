//! Every effect does what its physics says, from its onset on, and nothing before.

#![allow(clippy::unwrap_used)]

use world::{
    Case, CaseKind, Drive, DriveKind, Effect, EffectName, Family, Key, RobotFile, Row, Sensors, Side, World,
    example_robot, simulate,
};

fn hills(sensors: Sensors, effects: Vec<Effect>) -> World {
    let world =
        World::from_json(r#"{"terrain": {"rolling": {"grade": 0.06, "seed": 2}}, "seed": 9}"#).unwrap();
    World { sensors, effects, ..world }
}

/// An effect of plain strength.
fn plain(name: EffectName) -> Effect {
    let [low, high] = name.typical();
    Effect::new(name, (low * high).sqrt() * 1.5)
}

/// Equal numbers, gaps included.
fn same(a: &Row, b: &Row) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

#[test]
fn before_its_onset_no_effect_changes_a_bit_and_after_it_every_one_shows() {
    let drive = Drive::new(DriveKind::StopAndGo, 120.0, 3);
    let healthy = simulate(&hills(Sensors::default(), vec![]), &example_robot(), &drive).unwrap();
    for name in EffectName::all() {
        let onset_s = 40.0;
        let world = hills(Sensors::default(), vec![Effect { onset_s, ..plain(name) }]);
        let log = simulate(&world, &example_robot(), &drive).unwrap();
        let first = log.rows.iter().zip(&healthy.rows).find(|(a, b)| !same(a, b)).map(|(row, _)| row.t_s);
        assert!(first.is_some_and(|t_s| t_s >= onset_s), "{name:?} shows first at {first:?}");
    }
}

#[test]
fn effects_change_power_the_way_physics_says() {
    use EffectName as E;
    let drive = Drive::new(DriveKind::Rich, 240.0, 6);
    let share = |effect: Effect| {
        let key = Key::of(&hills(Sensors::perfect(), vec![effect]), &example_robot(), &drive).unwrap();
        key.truths[0].clone()
    };
    for name in EffectName::all() {
        let truth = share(plain(name));
        match name {
            // Power does not change, its readings beside it do.
            E::PitchBias => {
                assert!(truth.power_change == 0.0 && truth.channel_changes[2] > 0.003, "{truth:?}");
            }
            E::WheelRadius => {
                assert!(truth.power_change == 0.0 && truth.channel_changes[0] > 0.003, "{truth:?}");
            }
            // Late, not more.
            E::ClockOffset => {
                assert!(truth.power_share.abs() < 0.01 && truth.power_change > 0.05, "{truth:?}");
            }
            // Load that moves can help or hinder.
            E::CenterOfMass | E::LoadTransfer | E::LooseLoad => {
                assert!(truth.power_change > 0.001, "{truth:?}");
            }
            // Wind pushes as often as it brakes; inertia is given back but for the losses on the way.
            E::Wind | E::Inertia => assert!(truth.power_change > 0.003, "{truth:?}"),
            _ => assert!(truth.power_share > 0.001, "{truth:?}"),
        }
    }
    let reading = share(Effect::new(E::PowerScale, 0.1));
    assert!((reading.power_share - 0.1).abs() < 1e-9, "{reading:?}");
    let still =
        World::from_json(r#"{"terrain": "level", "effects": [{"effect": "hotel_load", "strength": 12}]}"#)
            .unwrap();
    let still = World { sensors: Sensors::perfect(), ..still };
    let key = Key::of(&still, &example_robot(), &drive).unwrap();
    assert!((key.truths[0].power_share * key.healthy_mean_w - 12.0).abs() < 0.2, "{key:?}");
}

#[test]
fn twice_the_strength_is_about_twice_the_power() {
    use EffectName as E;
    let drive = Drive::new(DriveKind::Rich, 240.0, 6);
    for name in
        [E::Payload, E::SurfaceChange, E::DrivetrainDrag, E::SoftSoil, E::HotelLoad, E::TowedLoad, E::Furrows]
    {
        let power_share = |factor: f64| {
            let effect = Effect::new(name, name.typical()[0] * 2.0 * factor);
            let world = hills(Sensors::perfect(), vec![effect]);
            Key::of(&world, &example_robot(), &drive).unwrap().truths[0].power_share
        };
        let ratio = power_share(2.0) / power_share(1.0);
        assert!((1.6..2.5).contains(&ratio), "{name:?}: {ratio}");
    }
}

#[test]
fn a_place_and_a_side_are_kept() {
    let drive = Drive::new(DriveKind::Rich, 200.0, 6);
    let place = world::Place { x_m: [-100.0, 0.0], y_m: [-100.0, 100.0] };
    let mud = Effect { place: Some(place), ..plain(EffectName::SoftSoil) };
    let healthy = simulate(&hills(Sensors::perfect(), vec![]), &example_robot(), &drive).unwrap();
    let muddy = simulate(&hills(Sensors::perfect(), vec![mud]), &example_robot(), &drive).unwrap();
    let first = muddy.rows.iter().zip(&healthy.rows).find(|(a, b)| !same(a, b)).unwrap().0;
    assert!(first.position_m[0] < 0.1, "{first:?}");
    let drag = Effect { side: Some(Side::Right), ..plain(EffectName::DrivetrainDrag) };
    let dragging = simulate(&hills(Sensors::perfect(), vec![drag]), &example_robot(), &drive).unwrap();
    let more = |side: usize| {
        dragging.rows.iter().zip(&healthy.rows).map(|(a, b)| a.side_w[side] - b.side_w[side]).sum::<f64>()
    };
    assert!(more(1) > 5.0 * more(0).abs(), "{} {}", more(0), more(1));
}

#[test]
fn a_brake_that_warms_lets_go_and_windings_that_warm_do_not() {
    let drive = Drive::new(DriveKind::Straight, 600.0, 1);
    let more_w = |name: EffectName, from: f64, to: f64| {
        let run = |effects| simulate(&hills(Sensors::perfect(), effects), &example_robot(), &drive).unwrap();
        let (with, without) = (run(vec![plain(name)]), run(vec![]));
        let rows = with.rows.iter().zip(&without.rows).filter(|(row, _)| (from..to).contains(&row.t_s));
        rows.map(|(a, b)| a.battery_w - b.battery_w).sum::<f64>() / (to - from) / 10.0
    };
    let brake = EffectName::BindingBrake;
    assert!(more_w(brake, 0.0, 60.0) > 3.0 * more_w(brake, 500.0, 600.0).max(0.1));
    let heat = EffectName::MotorHeating;
    assert!(more_w(heat, 400.0, 600.0) > 2.0 * more_w(heat, 0.0, 60.0));
}

#[test]
fn cases_are_reproducible_and_their_keys_tell_what_they_hold() {
    let robot = example_robot();
    let kind = CaseKind::Two(EffectName::Payload, EffectName::HotelLoad);
    let case = Case::draw(11, kind, 0.03, &robot).unwrap();
    assert_eq!(case, Case::draw(11, kind, 0.03, &robot).unwrap());
    assert_ne!(case, Case::draw(12, kind, 0.03, &robot).unwrap());
    assert!(case.twin().world.effects.is_empty() && case.twin().drive == case.drive);
    let names: Vec<EffectName> = case.world.effects.iter().map(|e| e.effect).collect();
    assert_eq!(names, [EffectName::Payload, EffectName::HotelLoad]);
    let quiet = World { sensors: Sensors::perfect(), ..case.world.clone() };
    for truth in Key::of(&quiet, &robot, &case.drive).unwrap().truths {
        assert!((truth.power_change / 0.03 - 1.0).abs() < 0.1, "{truth:?}");
    }
    let kinds: Vec<CaseKind> = (0..300).map(Case::any_kind).collect();
    let healthy = kinds.iter().filter(|kind| matches!(kind, CaseKind::Healthy | CaseKind::Decoy)).count();
    assert!((60..125).contains(&healthy), "{healthy} of 300");
    for kind in [CaseKind::Healthy, CaseKind::Decoy] {
        assert!(Case::draw(5, kind, 0.03, &robot).unwrap().key(&robot).unwrap().truths.is_empty());
    }
}

#[test]
fn every_family_has_its_name_in_files() {
    for name in EffectName::all() {
        let text = format!(
            r#"{{"terrain": "level", "effects": [{{"effect": "{}", "strength": {}}}]}}"#,
            name.name(),
            name.typical()[0]
        );
        assert_eq!(World::from_json(&text).unwrap().effects[0].effect, name);
    }
    assert_eq!(EffectName::all().filter(|name| name.family() == Family::Measurement).count(), 5);
}

#[test]
fn keys_tell_sizes_by_the_names_of_reports() {
    use EffectName as E;
    let drive = Drive::new(DriveKind::Straight, 10.0, 1);
    let told = |effect: Effect| -> Vec<(&'static str, f64)> {
        let key = Key::of(&hills(Sensors::perfect(), vec![effect]), &example_robot(), &drive).unwrap();
        key.truths[0].parameters.iter().map(|p| (p.name, p.value)).collect()
    };
    assert_eq!(told(Effect::new(E::Inertia, 30.0)), [("kg_per_side", 15.0)]);
    let right = Effect { side: Some(Side::Right), ..Effect::new(E::DrivetrainDrag, 7.0) };
    assert_eq!(told(right), [("left_n", 0.0), ("right_n", 7.0)]);
    let ahead = Effect { direction_rad: std::f64::consts::PI, ..Effect::new(E::CenterOfMass, 0.05) };
    assert_eq!(told(ahead)[0], ("forward_m", -0.05));
    // Encoders that report a quarter too much belong to wheels that turn a fifth slower than reported.
    assert!((told(Effect::new(E::WheelRadius, 0.25))[0].1 + 0.2).abs() < 1e-12);
}

#[test]
fn a_load_so_high_that_a_robot_would_tip_over_is_as_high_as_it_can_be_driven() {
    // Six hundredths of its power take a centre of mass so high that this robot tips over in its turns.
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/robots/small.json"));
    let robot = RobotFile::from_json(&text.unwrap()).unwrap();
    let case =
        Case::draw(2_639_225_645_871_671, CaseKind::One(EffectName::LoadTransfer), 0.06, &robot).unwrap();
    let height_m = case.world.effects[0].strength;
    assert!((0.1..3.0).contains(&height_m), "{height_m}");
    assert!(case.key(&robot).is_ok());
}
