//! A diagnosis to test pages with.

use diagnosis::{
    Diagnosis, Verdict,
    report::{
        BaselineFit, CorrectedFit, Detectable, EvidenceFigures, ExplanationFigures, FileError, FileReport,
        Finding, FindingFit, FoundParameter, Place, Probability, Range, Scope, Trace,
    },
};

/// A payload that was taken on at 400 s of a drive of ten minutes.
pub(super) fn explained() -> Diagnosis {
    let explanation = |mechanisms: &[&str], probability| ExplanationFigures {
        mechanisms: mechanisms.iter().map(|name| (*name).to_owned()).collect(),
        probability,
    };
    Diagnosis {
        verdict: Verdict::Explained,
        sentence: "The robot carries 25.3 kg more, from about 400 s on.".into(),
        file: Some(FileReport {
            error: FileError { rmse_w: 35.0, bias_w: 27.0, mean_power_w: 100.0, noise_w: 1.9 },
            findings: Vec::new(),
        }),
        probability: Some(Probability { nothing: 0.02, listed: 0.928, unlisted: 0.052 }),
        explanations: vec![
            explanation(&["payload"], 0.9),
            explanation(&["payload", "unknown"], 0.05),
            explanation(&[], 0.02),
        ],
        baseline: BaselineFit { rmse_w: 18.0, bias_w: -13.0, held_out_rmse_w: 6.0, noise_floor_w: 1.9 },
        places: vec![time_place()],
        findings: vec![finding()],
        corrected: CorrectedFit { rmse_w: 2.0, held_out_rmse_w: 2.1 },
        next_drive: Some("drive a slope of 5° up and down".into()),
        detectable: vec![Detectable { mechanism: "wind", parameter: "east_mps", value: 2.0, unit: "m/s" }],
        not_judged: vec!["motor_heating"],
        notes: vec!["`payload` stands in the corrected robot's file".into()],
        coverage: calibration::DrivesCoverage::default(),
        reference_coverage: None,
        corrected_robot: model::builtin::by_name("husky-a200").unwrap(),
        trace: trace(),
    }
}

fn finding() -> Finding {
    let parameter = |name, value, unit, interval_95| FoundParameter { name, value, unit, interval_95 };
    Finding {
        mechanism: "payload".into(),
        statement: "payload of 25.3 kg, from about 400 s on".into(),
        equation: "m → m + m_p".into(),
        parameters: vec![
            parameter("mass_kg", 25.3, "kg", Some([22.1, 28.4])),
            parameter("from_s", 400.0, "s", None),
        ],
        evidence: EvidenceFigures { p_value: 0.01, delta_bic: 20.0, held_out_gain: 0.8 },
        indistinguishable_from: vec!["towed_load".into()],
        fit: FindingFit { held_out_rmse_before_w: 6.0, held_out_rmse_after_w: 2.1 },
        probability: Some(0.978),
        scope: Some(Scope { from_s: Some(400.0), until_s: None, run: Some("tuesday".into()), region: None }),
    }
}

fn time_place() -> Place {
    Place {
        kind: "time",
        statement: "from about 450 s on".into(),
        range: Range { quantity: "t_s", from: Some(450.0), to: None, name: None, x_m: None, y_m: None },
        share_of_excess: 0.9,
    }
}

fn trace() -> Trace {
    let seconds = 0..600;
    let t_s: Vec<f64> = seconds.map(|second| f64::from(second) + 0.5).collect();
    let recorded_w: Vec<f64> = t_s.iter().map(|t| if *t < 400.0 { 100.0 } else { 130.0 }).collect();
    Trace {
        run: vec![0; t_s.len()],
        filed_w: vec![100.0; t_s.len()],
        corrected_w: recorded_w.clone(),
        runs: vec!["tuesday".into()],
        position_m: t_s.iter().map(|t| Some([*t, 0.5 * t])).collect(),
        recorded_w,
        t_s,
    }
}
