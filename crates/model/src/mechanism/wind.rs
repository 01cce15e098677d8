//! `wind`: air that stands or moves against the robot.

use crate::{
    Robot, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// ρ of the standard atmosphere at sea level and 15 °C (ISO 2533) [kg/m³].
const AIR_KG_PER_M3: f64 = 1.225;

/// Drag areas that a robot may have, in areas between its wheels: a mast and a tarpaulin on a small robot.
const MOST_FOOTPRINTS: f64 = 4.0;

/// Air that stands or moves against the robot.
pub(super) struct Wind;

impl Mechanism for Wind {
    fn name(&self) -> &'static str {
        "wind"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "drag_area_m2", unit: "m²", bounds: [0.0, 8.0], probe: 0.05 },
            Parameter { name: "east_mps", unit: "m/s", bounds: [-25.0, 25.0], probe: 0.1 },
            Parameter { name: "north_mps", unit: "m/s", bounds: [-25.0, 25.0], probe: 0.1 },
        ]
    }

    /// A body of several times the footprint is no robot's.
    fn bounds(&self, robot: &Robot, parameter: usize) -> [f64; 2] {
        let [low, high] = self.parameters()[parameter].bounds;
        let most_m2 = MOST_FOOTPRINTS * robot.track_m * robot.wheelbase_m;
        if parameter == 0 { [low, high.min(most_m2)] } else { [low, high] }
    }

    fn equation(&self) -> &'static str {
        "F = ½ ρ C_d A |v − w| (v − w), w the wind along the heading, half on each side"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "air drags: {:.2} m² in a wind of {:.1} m/s towards east and {:.1} m/s towards north",
            values[0], values[1], values[2]
        )
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let along_mps = moment.motion.heading_rad.map_or(0.0, |heading_rad| {
            let (sin, cos) = heading_rad.sin_cos();
            values[1] * cos + values[2] * sin
        });
        let towards_mps = moment.motion.speed_mps - along_mps;
        let force_n = 0.5 * AIR_KG_PER_M3 * values[0] * towards_mps * towards_mps.abs();
        Adjustment { force_n: Sides::both(force_n / 2.0), ..Adjustment::default() }
    }
}
