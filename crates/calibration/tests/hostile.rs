//! Recordings that hold next to nothing, floods of gaps and numbers out of all proportion are judged, fitted or refused;
//! nothing panics.

#![allow(clippy::unwrap_used)]

use calibration::{Method, Options, predict};
use proptest::prelude::*;
use recording::{Format, Recording, read};

/// One cell: mostly a usual number, at times a gap, nought, or far out.
fn cell(usual: std::ops::Range<f64>) -> impl Strategy<Value = String> {
    prop_oneof![
        6 => usual.prop_map(|v| format!("{v:.4}")),
        2 => Just("nan".to_owned()),
        1 => Just("0".to_owned()),
        1 => prop_oneof![Just("1e9"), Just("-1e9"), Just("1e-12"), Just("1e300")].prop_map(str::to_owned),
    ]
}

const POWERS: [&str; 4] = [
    "power_left_w,power_right_w",
    "power_w,voltage_v",
    "current_a,voltage_v",
    "motor_current_left_a,motor_current_right_a",
];

fn table() -> impl Strategy<Value = Recording> {
    let row = (
        0u8..3,
        0.01..2.0f64,
        prop::collection::vec(cell(-1.0..1.0), 4),
        prop::collection::vec(cell(0.5..90.0), 2),
    );
    let surface = prop_oneof![Just("marble"), Just("lava"), Just("")];
    (0..POWERS.len(), prop::collection::vec((row, surface), 1..60)).prop_filter_map(
        "no recording",
        |(power, rows)| {
            let mut text = format!(
                "run,t_s,surface,v_left_mps,v_right_mps,yaw_rate_radps,pitch_rad,{}\n",
                POWERS[power]
            );
            let mut t_s = 0.0;
            for ((run, step_s, motion, power), surface) in rows {
                t_s += step_s;
                text += &format!("{run},{t_s},{surface},{},{}\n", motion.join(","), power.join(","));
            }
            read(text.into_bytes(), Format::Csv, "hostile", None).ok().map(|reading| reading.recording)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, max_shrink_iters: 0, ..ProptestConfig::default() })]

    #[test]
    fn any_recording_is_judged_and_fitted_or_refused(recording in table()) {
        let mut robot = model::builtin::husky_a200();
        robot.motors.left.force_n_per_a = Some(12.0);
        robot.motors.right.force_n_per_a = Some(12.0);
        let _ = predict(&robot, &recording);
        for method in [Method::Fit, Method::DogruMarques] {
            if let Ok(found) = method.calibrate(&robot, &recording, &Options::default()) {
                prop_assert!(found.robot.validate().is_ok());
            }
        }
    }
}
