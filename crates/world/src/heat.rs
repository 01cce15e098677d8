//! Heat of one motor: winding and case.

/// Heat capacity of the winding of a Husky's motor [J/K]: 0.4 kg of copper at 385 J/(kg K). Motors grow with the robot.
const WINDING_J_PER_K: f64 = 150.0;
/// Heat capacity of case, rotor and gearbox [J/K]: 2.3 kg at about 500 J/(kg K).
const CASE_J_PER_K: f64 = 1150.0;
/// Conductance from winding to case [W/K]; brushed motors of this size have 2 to 5.
const WINDING_TO_CASE_W_PER_K: f64 = 3.0;
/// Conductance from case to still air [W/K], and how much of it comes on top at one metre per second.
const CASE_TO_AIR_W_PER_K: f64 = 1.4;
const DRAUGHT: f64 = 0.25;

/// Temperatures of one motor [°C].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Heat {
    pub(crate) winding_c: f64,
    pub(crate) case_c: f64,
    /// Size over that of a Husky's motor.
    size: f64,
}

impl Heat {
    /// A motor as warm as the air, of a robot so many times a Husky's size.
    pub(crate) fn at_rest(ambient_c: f64, size: f64) -> Self {
        Heat { winding_c: ambient_c, case_c: ambient_c, size }
    }

    /// Advances by a step that is short against the winding's minute.
    pub(crate) fn advance(
        &mut self,
        copper_w: f64,
        gear_w: f64,
        ambient_c: f64,
        speed_mps: f64,
        step_s: f64,
    ) {
        let to_air_w_per_k = CASE_TO_AIR_W_PER_K * (1.0 + DRAUGHT * speed_mps.abs());
        let to_case_w = self.size * WINDING_TO_CASE_W_PER_K * (self.winding_c - self.case_c);
        let to_air_w = self.size * to_air_w_per_k * (self.case_c - ambient_c);
        self.winding_c += step_s * (copper_w - to_case_w) / (self.size * WINDING_J_PER_K);
        self.case_c += step_s * (to_case_w + gear_w - to_air_w) / (self.size * CASE_J_PER_K);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_spin_warms_the_case_as_the_paper_measured_and_rest_cools_it() {
        // Dogru & Marques (2018), §V-B: 23 min of spinning with 106 to 150 W a side warm the case from 20 to 76 °C; of that
        // some 40 W heat copper and 45 W gears and motor iron.
        let mut heat = Heat::at_rest(20.0, 1.0);
        for _ in 0..23 * 60 * 10 {
            heat.advance(42.0, 45.0, 20.0, 0.0, 0.1);
        }
        assert!((heat.case_c - 76.0).abs() < 12.0, "{heat:?}");
        assert!(heat.winding_c > heat.case_c + 5.0);
        for _ in 0..4 * 3600 * 10 {
            heat.advance(0.0, 0.0, 20.0, 0.0, 0.1);
        }
        assert!((heat.winding_c - 20.0).abs() < 0.1 && (heat.case_c - 20.0).abs() < 0.1, "{heat:?}");
    }
}
