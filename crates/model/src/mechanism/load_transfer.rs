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

    /// Higher up, the robot would tip over on the side slope that its limits allow: tan φ = b / (2 h).
    fn bounds(&self, robot: &Robot, _: usize) -> [f64; 2] {
        let tips_m = robot.track_m / 2.0 / robot.limits.max_roll_rad.tan();
        let [low_m, high_m] = self.parameters()[0].bounds;
        [low_m.max(-tips_m), high_m.min(tips_m)]
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
