//! `load_transfer`: a centre of mass high above the ground shifts load to the lower and to the outer side.

use crate::{
    Robot, STANDARD_GRAVITY_MPS2,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// A centre of mass high above the ground shifts load to the lower and to the outer side.
pub(super) struct LoadTransfer;

impl Mechanism for LoadTransfer {
    fn name(&self) -> &'static str {
        "load_transfer"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "height_m", unit: "m", bounds: [-1.0, 3.0], probe: 0.02 }]
    }

    fn equation(&self) -> &'static str {
        "n_l = ½ − h/b (tan φ + v ω / g)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("the centre of mass is {:.2} m higher than the model takes it for", values[0])
    }

    fn adjust(&self, robot: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let outward = moment.motion.speed_mps * moment.motion.yaw_rate_radps / STANDARD_GRAVITY_MPS2;
        let load_left_per_tilt = -values[0] / robot.track_m;
        Adjustment { load_left: load_left_per_tilt * outward, load_left_per_tilt, ..Adjustment::default() }
    }
}
