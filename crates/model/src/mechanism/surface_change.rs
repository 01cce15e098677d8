//! `surface_change`: other ground than the recording says.

use crate::{
    Robot, Sides,
    mechanism::{Adjustment, Form, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Which parameter changes the scale of the slip angle.
const SLIP_SCALE: usize = 2;

/// Change of the scale of the slip angle; none where only resistances are given.
fn scale_change(values: &[f64]) -> f64 {
    values.get(SLIP_SCALE).copied().unwrap_or(0.0)
}

/// Other ground than the recording says.
pub(super) struct SurfaceChange;

impl Mechanism for SurfaceChange {
    fn name(&self) -> &'static str {
        "surface_change"
    }

    fn label(&self) -> &'static str {
        "other ground"
    }

    fn filed(&self, robot: &Robot, values: &[f64], surfaces: &[String]) -> Option<Robot> {
        let mut changed = robot.clone();
        for (_, surface) in changed.surfaces.iter_mut().filter(|(name, _)| surfaces.contains(name)) {
            *surface = surface.scaled(1.0 + values[0], 1.0 + values[1]);
            surface.slip_angle_scale_rad *= 1.0 + scale_change(values);
        }
        Some(changed)
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "roll_change", unit: "1", bounds: [-0.9, 10.0], probe: 0.05 },
            Parameter { name: "skid_change", unit: "1", bounds: [-0.9, 5.0], probe: 0.05 },
            Parameter { name: "slip_scale_change", unit: "1", bounds: [-0.95, 5.0], probe: 0.05 },
        ]
    }

    /// A file has it as the surface's own `slip_angle_scale_rad`.
    fn is_optional(&self, parameter: usize) -> bool {
        parameter == SLIP_SCALE
    }

    /// Half as much rolling and a third as much skid resistance: what hard floors, asphalt and loam differ by (Dogru & Marques 2018, Fig. 13;
    /// BorealTC). Scales of the slip angle differ between kinds of ground only, by factors of 3 to 10 (BorealTC: ice 0.01 rad, floors 0.1 rad,
    /// loam 0.3 rad).
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        [0.5, 0.3, 0.25].map(SizePrior::either).into()
    }

    /// Another floor or field, and another kind of ground altogether: asphalt has three to four times the skid resistance of ice (BorealTC).
    fn forms(&self, _: &Robot) -> Vec<Form> {
        let floor = Form { values: vec![0.0; 3], free: vec![0, 1], widening: 1.0 };
        let kind = Form { values: vec![0.0; 3], free: vec![0, 1, SLIP_SCALE], widening: 4.0 };
        vec![floor, kind]
    }

    /// Ground that rolls harder skids harder.
    fn size_correlation(&self) -> f64 {
        0.8
    }

    fn equation(&self) -> &'static str {
        "μ_R → μ_R (1 + c_R), μ_S → μ_S (1 + c_S), α_0 → α_0 (1 + c_α)"
    }

    fn statement(&self, values: &[f64]) -> String {
        // Adding nothing makes a zero of either sign positive.
        let [rolls, skids] = [values[0], values[1]].map(|change| (100.0 * change).round() + 0.0);
        format!(
            "the ground is another: it rolls {rolls:+.0} % and skids {skids:+.0} % against what was fitted"
        )
    }

    fn robot(&self, robot: &Robot, values: &[f64]) -> Option<Robot> {
        let change = scale_change(values);
        (change != 0.0).then(|| {
            let mut changed = robot.clone();
            changed.surfaces.values_mut().for_each(|surface| surface.slip_angle_scale_rad *= 1.0 + change);
            changed
        })
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        Adjustment {
            mu_roll: Sides::both(1.0 + values[0]),
            mu_skid: 1.0 + values[1],
            ..Adjustment::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_has_no_sign() {
        let statement = SurfaceChange.statement(&[0.57, -0.001]);
        assert!(statement.contains("rolls +57 % and skids +0 %"), "{statement}");
    }
}
