//! `motor_heating`: motors that grow warm from their own losses: more resistance, weaker magnets (eqs. 7-10).

use crate::{
    Robot,
    mechanism::{Adjustment, Form, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Mean rise of temperature, one sigma \[K\].
const MEAN_RISE_K: f64 = 25.0;
/// Motors that lose less warm by nothing that could be told \[W\].
const LEAST_LOSS_W: f64 = 0.1;
/// Time constants that are tried \[s\].
const MEMORIES_S: [f64; 6] = [60.0, 180.0, 480.0, 900.0, 1800.0, 3600.0];

/// Motors that grow warm from their own losses: more resistance, weaker magnets (eqs. 7-10).
pub(super) struct MotorHeating;

impl Mechanism for MotorHeating {
    fn name(&self) -> &'static str {
        "motor_heating"
    }

    fn label(&self) -> &'static str {
        "motors that grow warm"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "rise_k_per_w", unit: "K/W", bounds: [0.0, 10.0], probe: 0.05 },
            Parameter { name: "time_constant_s", unit: "s", bounds: [20.0, 7200.0], probe: 10.0 },
        ]
    }

    /// A mean rise of 25 K, as of a motor at half of what its windings bear.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        let rise_k_per_w = MEAN_RISE_K / scale.mean_loss_w.max(LEAST_LOSS_W);
        vec![SizePrior::positive(rise_k_per_w), SizePrior::positive(MEMORIES_S[3])]
    }

    /// Time constants from that of a small winding to that of a heavy case.
    fn forms(&self, _: &Robot) -> Vec<Form> {
        MEMORIES_S.map(|memory_s| Form::one_free(vec![0.0, memory_s], 0)).into()
    }

    fn is_windowed(&self) -> bool {
        false
    }

    fn equation(&self) -> &'static str {
        "τ dΔT/dt = R_th k1 F² − ΔT; k1(T), k2(T) of eqs. 7-10"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "motors warm by {:.2} K for each watt lost in them, with a time constant of {:.0} s, and take more power warm than cold",
            values[0], values[1]
        )
    }

    fn memory_s(&self, values: &[f64]) -> Option<f64> {
        Some(values[1])
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        Adjustment { motor_k: moment.loss_w.map(|loss_w| values[0] * loss_w), ..Adjustment::default() }
    }
}
