//! `motor_heating`: motors that grow warm from their own losses: more resistance, weaker magnets (eqs. 7-10).

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// Motors that grow warm from their own losses: more resistance, weaker magnets (eqs. 7-10).
pub(super) struct MotorHeating;

impl Mechanism for MotorHeating {
    fn name(&self) -> &'static str {
        "motor_heating"
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
