//! `hotel_load`: electronics that take power whatever the robot does.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Electronics that take power whatever the robot does.
pub(super) struct HotelLoad;

impl Mechanism for HotelLoad {
    fn name(&self) -> &'static str {
        "hotel_load"
    }

    fn label(&self) -> &'static str {
        "other electronics"
    }

    fn filed(&self, robot: &Robot, values: &[f64], _: &[String]) -> Option<Robot> {
        Some(Robot { hotel_power_w: robot.hotel_power_w + values[0], ..robot.clone() })
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "power_w", unit: "W", bounds: [-300.0, 1000.0], probe: 1.0 }]
    }

    /// A quarter of mean power, as of a computer beside small motors; a file that gives none cannot give too much.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        let sigma_w = 0.25 * scale.mean_power_w;
        let is_given = scale.robot.hotel_power_w > 0.0;
        vec![if is_given { SizePrior::either(sigma_w) } else { SizePrior::positive(sigma_w) }]
    }

    fn equation(&self) -> &'static str {
        "P = P_drive + P_hotel"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("electronics take {:.1} W more than the robot's file says", values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        Adjustment { standing_w: values[0], ..Adjustment::default() }
    }
}
