//! How well a robot's parameters are known, one by one, and what that leaves of a figure that follows from them.

use serde::{Deserialize, Serialize};

use super::Robot;

/// Half width of the central 95 % of a normal distribution, in standard deviations.
pub const NORMAL_95: f64 = 1.959_964;

/// Relative one-sigma uncertainty of the parameters, 0.1 meaning 10 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Uncertainty {
    /// Of every surface's μ_R. Default 0.10.
    pub mu_roll: f64,
    /// Of every surface's μ_S. Default 0.10.
    pub mu_skid: f64,
    /// Of both sides' k1. Default 0.05.
    pub k1: f64,
    /// Of both sides' k2. Default 0.02.
    pub k2: f64,
    /// Of the mass. Default 0.02.
    pub mass_kg: f64,
    /// Of the hotel power. Default 0: it is taken to be measured.
    #[serde(skip_serializing_if = "is_zero")]
    pub hotel_power_w: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Uncertainty { mu_roll: 0.10, mu_skid: 0.10, k1: 0.05, k2: 0.02, mass_kg: 0.02, hotel_power_w: 0.0 }
    }
}

fn is_zero(sigma: &f64) -> bool {
    *sigma == 0.0
}

/// A parameter that is not known for sure: positive, and so log-normal.
#[derive(Clone, Copy, Debug)]
pub struct Uncertain {
    /// Its field of [`Uncertainty`].
    pub name: &'static str,
    /// Its relative one-sigma uncertainty [-].
    pub sigma: f64,
    scale: fn(&mut Robot, f64),
}

impl Uncertain {
    /// The robot with the parameter multiplied.
    pub fn scaled(&self, robot: &Robot, factor: f64) -> Robot {
        let mut changed = robot.clone();
        (self.scale)(&mut changed, factor);
        changed
    }

    /// The robots at the upper and the lower end of the parameter's central 95 %.
    pub fn ends(&self, robot: &Robot) -> [Robot; 2] {
        let factor = (NORMAL_95 * self.sigma).exp();
        [self.scaled(robot, factor), self.scaled(robot, 1.0 / factor)]
    }
}

impl Robot {
    /// The parameters that energy depends on, each with the uncertainty that the file states; those known for sure are left out.
    pub fn uncertain(&self) -> Vec<Uncertain> {
        let u = &self.uncertainty;
        let all = [
            Uncertain {
                name: "mu_roll",
                sigma: u.mu_roll,
                scale: |robot, factor| {
                    robot.surfaces.values_mut().for_each(|s| *s = s.scaled(factor, 1.0));
                },
            },
            Uncertain {
                name: "mu_skid",
                sigma: u.mu_skid,
                scale: |robot, factor| {
                    robot.surfaces.values_mut().for_each(|s| *s = s.scaled(1.0, factor));
                },
            },
            Uncertain {
                name: "k1",
                sigma: u.k1,
                scale: |robot, factor| {
                    robot.motors.left.k1_w_per_n2 *= factor;
                    robot.motors.right.k1_w_per_n2 *= factor;
                },
            },
            Uncertain {
                name: "k2",
                sigma: u.k2,
                scale: |robot, factor| {
                    robot.motors.left.k2 = (robot.motors.left.k2 * factor).max(1.0);
                    robot.motors.right.k2 = (robot.motors.right.k2 * factor).max(1.0);
                },
            },
            Uncertain { name: "mass_kg", sigma: u.mass_kg, scale: |robot, factor| robot.mass_kg *= factor },
            Uncertain {
                name: "hotel_power_w",
                sigma: u.hotel_power_w,
                scale: |robot, factor| robot.hotel_power_w *= factor,
            },
        ];
        all.into_iter().filter(|parameter| parameter.sigma > 0.0).collect()
    }
}

/// Central 95 % interval of a figure, from its values at both ends of each parameter's own interval.
///
/// ```text
/// high = E + √(Σ (E⁺ − E)²)
/// low  = L + (E − L) exp(−√(Σ ln² ((E⁻ − L)/(E − L))))
/// ```
///
/// E the figure as the file has it, L the least that it can be, E⁺ and E⁻ the higher and the lower value of each pair of ends. One
/// parameter alone gives the figures at its own quantiles, small ones add up as variances do, and no doubt makes the figure less
/// than it can be.
pub fn interval(value: f64, least: f64, ends: &[[f64; 2]]) -> [f64; 2] {
    let least = least.min(value);
    let (mut above_2, mut below_ln2) = (0.0, 0.0);
    for [one, other] in ends {
        let (highest, lowest) = (one.max(*other), one.min(*other));
        above_2 += (highest - value).max(0.0).powi(2);
        let share = (lowest - least).max(0.0) / (value - least);
        if share < 1.0 {
            below_ln2 += share.ln().powi(2);
        }
    }
    let low = least + (value - least) * (-below_ln2.sqrt()).exp();
    [low.min(value), value + above_2.sqrt()]
}
