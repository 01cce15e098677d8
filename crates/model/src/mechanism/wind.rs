//! `wind`: air that stands or moves against the robot.

use crate::{
    Robot, Sides,
    mechanism::{Adjustment, Form, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// ρ of the standard atmosphere at sea level and 15 °C (ISO 2533) [kg/m³].
const AIR_KG_PER_M3: f64 = 1.225;

/// Drag areas that a robot may have, in areas between its wheels: a mast and a tarpaulin on a small robot.
const MOST_FOOTPRINTS: f64 = 4.0;

/// Drag area that a robot usually has, in areas between its wheels: a body seen from ahead is about
/// as large as what lies between its wheels, with the drag coefficient of a cube, 0.8 to 1.05 (Hoerner, Fluid-Dynamic Drag, 1965,
/// chapter 3), bare or with a mast.
const USUAL_FOOTPRINTS: f64 = 1.0;

/// Winds that are tried \[m/s\]: a breeze, a strong wind, a gale (Beaufort 2, 4 and 5).
const WINDS_MPS: [f64; 3] = [3.0, 6.0, 10.0];
/// Directions that winds are tried towards.
const DIRECTIONS: u32 = 8;

/// Air that stands or moves against the robot.
pub(super) struct Wind;

impl Mechanism for Wind {
    fn name(&self) -> &'static str {
        "wind"
    }

    fn label(&self) -> &'static str {
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
        let [low, high] = self.parameters()[parameter].bounds_of(robot);
        let most_m2 = MOST_FOOTPRINTS * robot.track_m * robot.wheelbase_m;
        if parameter == 0 { [low, high.min(most_m2)] } else { [low, high] }
    }

    /// A drag area as large as what lies between the wheels, and winds up to a gale.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        let footprint_m2 = scale.robot.track_m * scale.robot.wheelbase_m;
        let area = SizePrior::positive(USUAL_FOOTPRINTS * footprint_m2);
        vec![area, SizePrior::either(WINDS_MPS[1]), SizePrior::either(WINDS_MPS[1])]
    }

    /// Still air, and winds of several speeds towards eight directions.
    fn forms(&self, _: &Robot) -> Vec<Form> {
        let towards = |wind_mps: f64| {
            (0..DIRECTIONS).map(move |i| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(DIRECTIONS)).sin_cos();
                Form::one_free(vec![0.0, wind_mps * cos, wind_mps * sin], 0)
            })
        };
        let still = Form::one_free(vec![0.0; 3], 0);
        std::iter::once(still).chain(WINDS_MPS.into_iter().flat_map(towards)).collect()
    }

    fn equation(&self) -> &'static str {
        "F = ½ ρ C_d A |v − w| (v − w∥), |v − w| of the whole stream, w∥ the wind along the heading, half on each side"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "air drags: {:.2} m² in a wind of {:.1} m/s towards east and {:.1} m/s towards north",
            values[0], values[1], values[2]
        )
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let [along_mps, across_mps] = moment.motion.heading_rad.map_or([0.0; 2], |heading_rad| {
            let (sin, cos) = heading_rad.sin_cos();
            [values[1] * cos + values[2] * sin, values[2] * cos - values[1] * sin]
        });
        let towards_mps = moment.motion.speed_mps - along_mps;
        let force_n = 0.5 * AIR_KG_PER_M3 * values[0] * towards_mps.hypot(across_mps) * towards_mps;
        Adjustment { force_n: Sides::both(force_n / 2.0), ..Adjustment::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, builtin};

    /// Force of 0.5 m² of air on a robot at 1 m/s, in a wind of 6 m/s [N].
    fn force_n(heading_rad: f64, towards_rad: f64) -> f64 {
        let robot = builtin::husky_a200();
        let motion = Motion::of_body(&robot, 1.0, 0.0).heading(heading_rad);
        let values = [0.5, 6.0 * towards_rad.cos(), 6.0 * towards_rad.sin()];
        let adjustment = Wind.adjust(&robot, &values, &Moment::steady(motion));
        adjustment.force_n.left + adjustment.force_n.right
    }

    #[test]
    fn wind_from_ahead_behind_and_the_side_pushes_by_the_square_of_the_whole_stream() {
        use std::f64::consts::{FRAC_PI_2, PI};
        // 0.30625 N per (m/s)²: against 7 m/s, with 5 m/s, and √37 m/s of which 1 m/s is from ahead.
        for (towards_rad, expected_n) in [(PI, 15.006_25), (0.0, -7.656_25), (FRAC_PI_2, 1.862_85)] {
            let found_n = force_n(0.0, towards_rad);
            assert!((found_n - expected_n).abs() < 1e-4, "{found_n} N of {expected_n} N");
        }
    }

    #[test]
    fn only_the_angle_between_wind_and_heading_counts() {
        for turned_rad in [0.3, 1.9, -2.6] {
            let difference_n = force_n(turned_rad, 0.7 + turned_rad) - force_n(0.0, 0.7);
            assert!(difference_n.abs() < 1e-12, "{difference_n} N");
        }
    }
}
