//! What a robot's file may leave out: physics and faults of measurement, each with its parameters and what it changes.
//!
//! A mechanism never computes power. It says how a moment differs from what was recorded of it and what is to be added to the
//! balance of forces; [`crate::Manoeuvre::adjusted`], on the same kernel that computes all power, does the rest.

mod center_of_mass;
mod clock_offset;
mod drivetrain_drag;
mod grade_dependent_friction;
mod hotel_load;
mod inertia;
mod load_transfer;
mod motor_heating;
mod payload;
mod pitch_bias;
mod power_offset;
mod power_scale;
mod regeneration;
mod size;
mod soft_soil;
mod speed_dependent_friction;
mod surface_change;
mod towed_load;
mod wheel_radius;
mod wheel_slip;
mod wind;

pub use size::{Form, Scale, Sign, SizePrior};

use crate::{Acceleration, Attitude, Motion, Robot, Sides};

/// Whether a mechanism acts on the robot or on what is recorded of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The power is really drawn.
    Physics,
    /// Only the recording says so.
    Measurement,
}

/// A number of a mechanism; at 0 all together it does nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// Its unit, `1` for none.
    pub unit: &'static str,
    /// Least and greatest value on a robot of a Husky's size.
    pub bounds: [f64; 2],
    /// A small step, in which the power changes in proportion.
    pub probe: f64,
}

impl Parameter {
    /// Least and greatest value on a robot: loads, forces and powers grow with its mass, and so do its motors, of which a watt warms
    /// larger ones less. All else is the same on large robots and on small ones.
    pub fn bounds_of(&self, robot: &Robot) -> [f64; 2] {
        let factor = match self.unit {
            "N" | "kg" | "W" => robot.size(),
            "K/W" => 1.0 / robot.size(),
            _ => 1.0,
        };
        self.bounds.map(|bound| factor * bound)
    }
}

/// One instant of a drive.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Body and wheel speeds.
    pub motion: Motion,
    /// How fast they change.
    pub acceleration: Acceleration,
    /// The same of the rims [m/s²].
    pub rim_mps2: Sides<f64>,
    /// How the robot stands. [`Mechanism::adjust`] must not ask for it: what follows the slope is a field of [`Adjustment`].
    pub attitude: Attitude,
    /// Copper loss of each side's motor, averaged over [`Mechanism::memory_s`] backwards [W].
    pub loss_w: Sides<f64>,
}

/// What a centre of mass high above the ground does, by its height: that of a robot's file counts without a mechanism in its list.
pub(crate) static OF_HEIGHT: &dyn Mechanism = &load_transfer::LoadTransfer;

/// What is added to the balance of forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustment {
    /// Mass that is carried [kg].
    pub mass_kg: f64,
    /// Factors of the rolling resistance.
    pub mu_roll: Sides<f64>,
    /// Factor of the skid resistance.
    pub mu_skid: f64,
    /// What steepness adds to the rolling resistance, as a share of it per sin γ.
    pub mu_roll_per_steepness: f64,
    /// Share of the load that is shifted from the right to the left side.
    pub load_left: f64,
    /// The same per tan φ, φ the roll.
    pub load_left_per_tilt: f64,
    /// Share of the load that is shifted from the rear to the front axle, per sin γ sin β.
    pub load_forward_per_along: f64,
    /// Wheel force of each side, forward [N].
    pub force_n: Sides<f64>,
    /// The same straight up, of which a slope has the share sin γ sin β [N].
    pub lifting_n: Sides<f64>,
    /// Force by which the right side drives and the left side brakes, of which a slope has the share sin γ sin β tan φ [N].
    pub leaning_n: f64,
    /// Temperature of each motor above what was recorded or the reference [K].
    pub motor_k: Sides<f64>,
    /// Share of back-driven power that returns besides.
    pub regeneration: f64,
    /// Power drawn from the battery besides that of the sides [W].
    pub standing_w: f64,
}

impl Default for Adjustment {
    /// Nothing.
    fn default() -> Self {
        Adjustment {
            mass_kg: 0.0,
            mu_roll: Sides::both(1.0),
            mu_skid: 1.0,
            mu_roll_per_steepness: 0.0,
            load_left: 0.0,
            load_left_per_tilt: 0.0,
            load_forward_per_along: 0.0,
            force_n: Sides::both(0.0),
            lifting_n: Sides::both(0.0),
            leaning_n: 0.0,
            motor_k: Sides::both(0.0),
            regeneration: 0.0,
            standing_w: 0.0,
        }
    }
}

impl Adjustment {
    /// Both at the same time.
    #[must_use]
    #[inline]
    pub fn and(self, other: Adjustment) -> Adjustment {
        Adjustment {
            mass_kg: self.mass_kg + other.mass_kg,
            mu_roll: self.mu_roll.zip(other.mu_roll).map(|(a, b)| a * b),
            mu_skid: self.mu_skid * other.mu_skid,
            mu_roll_per_steepness: self.mu_roll_per_steepness + other.mu_roll_per_steepness,
            load_left: self.load_left + other.load_left,
            load_left_per_tilt: self.load_left_per_tilt + other.load_left_per_tilt,
            load_forward_per_along: self.load_forward_per_along + other.load_forward_per_along,
            force_n: self.force_n.zip(other.force_n).map(|(a, b)| a + b),
            lifting_n: self.lifting_n.zip(other.lifting_n).map(|(a, b)| a + b),
            leaning_n: self.leaning_n + other.leaning_n,
            motor_k: self.motor_k.zip(other.motor_k).map(|(a, b)| a + b),
            regeneration: self.regeneration + other.regeneration,
            standing_w: self.standing_w + other.standing_w,
        }
    }
}

/// Physics or a fault of measurement that a robot's file does not describe. Values are in the order of the parameters.
pub trait Mechanism: Sync {
    /// Its name in reports.
    fn name(&self) -> &'static str;

    /// What it is in plain words, to go into a sentence.
    fn label(&self) -> &'static str;

    /// A robot whose file holds it in fields that files have anyway, acting on some surfaces; `None` for what goes into the file's list.
    fn filed(&self, _robot: &Robot, _values: &[f64], _surfaces: &[String]) -> Option<Robot> {
        None
    }

    /// Whether it acts on the robot or on the recording.
    fn kind(&self) -> Kind;

    /// Its parameters.
    fn parameters(&self) -> &'static [Parameter];

    /// Least and greatest value of a parameter that a robot can have: the parameter's own bounds, or closer ones.
    fn bounds(&self, robot: &Robot, parameter: usize) -> [f64; 2] {
        self.parameters()[parameter].bounds_of(robot)
    }

    /// Whether a robot's file may leave a parameter out.
    fn is_optional(&self, _parameter: usize) -> bool {
        false
    }

    /// Prior of each parameter: what a user could plausibly meet, in the robot's own units, with its reason.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior>;

    /// Prior correlation of the first two parameters' sizes. Default: none.
    fn size_correlation(&self) -> f64 {
        0.0
    }

    /// Share of its prior size by which drives of a healthy robot differ in it. Default: none.
    fn healthy_share(&self) -> f64 {
        0.0
    }

    /// Share of its prior size that healthy robots and good logs have of it all the time and no file states; healthy drives of the same
    /// robot show it. Default: as much as drives differ by.
    fn unstated_share(&self, _: &Scale<'_>) -> f64 {
        self.healthy_share()
    }

    /// Shapes that are tried side by side, where power does not follow all parameters in proportion. Default: one, with all of them free.
    fn forms(&self, _robot: &Robot) -> Vec<Form> {
        vec![Form::all_free(self.parameters().len())]
    }

    /// Whether it may set in or end during the drives. What remembers has no onset but the beginning.
    fn is_windowed(&self) -> bool {
        true
    }

    /// Its equation, in the symbols of the paper.
    fn equation(&self) -> &'static str;

    /// What it means in plain words.
    fn statement(&self, values: &[f64]) -> String;

    /// The robot as it is, where the mechanism changes what its file says.
    fn robot(&self, _robot: &Robot, _values: &[f64]) -> Option<Robot> {
        None
    }

    /// Corrects what was recorded of a moment.
    fn measure(&self, _values: &[f64], _moment: &mut Moment) {}

    /// What it adds to the balance of forces.
    fn adjust(&self, _robot: &Robot, _values: &[f64], _moment: &Moment) -> Adjustment {
        Adjustment::default()
    }

    /// What a power meter reads [W].
    fn reading_w(&self, _values: &[f64], true_w: f64) -> f64 {
        true_w
    }

    /// What the power meter of the battery reads beside those of the sides, or alone [W].
    fn battery_reading_w(&self, values: &[f64], true_w: f64) -> f64 {
        self.reading_w(values, true_w)
    }

    /// Time over which losses are averaged for [`Moment::loss_w`], if it asks for them [s].
    fn memory_s(&self, _values: &[f64]) -> Option<f64> {
        None
    }

    /// By how much power was recorded later than speeds [s].
    fn delay_s(&self, _values: &[f64]) -> f64 {
        0.0
    }
}

/// All mechanisms.
pub const ALL: [&dyn Mechanism; 20] = [
    &payload::Payload,
    &towed_load::TowedLoad,
    &drivetrain_drag::DrivetrainDrag,
    &wind::Wind,
    &inertia::Inertia,
    &hotel_load::HotelLoad,
    &regeneration::Regeneration,
    &speed_dependent_friction::SpeedDependentFriction,
    &grade_dependent_friction::GradeDependentFriction,
    &soft_soil::SoftSoil,
    &surface_change::SurfaceChange,
    &load_transfer::LoadTransfer,
    &center_of_mass::CenterOfMass,
    &motor_heating::MotorHeating,
    &wheel_slip::WheelSlip,
    &pitch_bias::PitchBias,
    &wheel_radius::WheelRadius,
    &power_scale::PowerScale,
    &power_offset::PowerOffset,
    &clock_offset::ClockOffset,
];

/// The mechanism of a name.
pub fn by_name(name: &str) -> Option<&'static dyn Mechanism> {
    ALL.into_iter().find(|mechanism| mechanism.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Friction, FrictionShape, Manoeuvre, builtin};

    #[test]
    fn prior_sizes_are_within_what_a_robot_can_have_and_forms_hold_one_value_for_each_parameter() {
        let robot = builtin::husky_a200();
        let scale =
            Scale { robot: &robot, meter_zero_w: 7.5, mean_power_w: 100.0, mean_loss_w: 5.0, row_s: 0.1 };
        for mechanism in ALL {
            let priors = mechanism.size_prior(&scale);
            assert_eq!(priors.len(), mechanism.parameters().len(), "{}", mechanism.name());
            for form in mechanism.forms(&robot) {
                assert_eq!(form.values.len(), priors.len(), "{}", mechanism.name());
                for free in form.free {
                    let [low, high] = mechanism.bounds(&robot, free);
                    let SizePrior { sigma, sign } = priors[free];
                    let in_reach = match sign {
                        Sign::Negative => -sigma >= low,
                        Sign::Positive | Sign::Either => sigma <= high,
                    };
                    assert!(sigma > 0.0 && in_reach, "{} {sigma} in {low}..{high}", mechanism.name());
                }
            }
        }
    }

    #[test]
    fn a_mechanism_at_nothing_changes_nothing_and_at_a_probe_changes_power_or_what_is_read() {
        let robot = builtin::husky_a200();
        let marble = &robot.surfaces["marble"];
        for mechanism in ALL {
            let seen = |values: &[f64]| {
                let motion = Motion::of_body(&robot, 0.5, 0.4).heading(0.7);
                let mut moment = Moment {
                    motion,
                    acceleration: Acceleration { forward_mps2: 0.1, yaw_radps2: 0.1, left_mps2: 0.0 },
                    rim_mps2: Sides { left: 0.05, right: 0.15 },
                    attitude: Attitude { pitch_rad: -0.25, roll_rad: 0.1 },
                    loss_w: Sides::both(10.0),
                };
                mechanism.measure(values, &mut moment);
                let own = mechanism.robot(&robot, values);
                let robot = own.as_ref().unwrap_or(&robot);
                let shape = FrictionShape::new(robot, marble.slip_angle_scale_rad, &moment.motion);
                let adjustment = mechanism.adjust(robot, values, &moment);
                let c = Sides::both(robot.motors.reference_temperature_c);
                let manoeuvre = Manoeuvre::adjusted(
                    robot,
                    &Friction::new(robot, marble),
                    moment.motion,
                    &shape,
                    c,
                    &adjustment,
                );
                let power = manoeuvre.power_accelerating(moment.attitude, moment.acceleration);
                // What follows the slope stands in the adjustment, so that a planner may prepare it once for all slopes.
                let elsewhere = Moment { attitude: Attitude::LEVEL, ..moment };
                assert_eq!(mechanism.adjust(robot, values, &elsewhere), adjustment, "{}", mechanism.name());
                let seen_w = mechanism.reading_w(values, power.bus_w) + power.side_w.left;
                (seen_w, mechanism.delay_s(values), moment.motion.speed_mps)
            };
            let count = mechanism.parameters().len();
            let nothing = seen(&vec![0.0; count]);
            let probes: Vec<f64> = mechanism.parameters().iter().map(|p| p.probe).collect();
            assert_ne!(seen(&probes), nothing, "{} does nothing", mechanism.name());
            assert_eq!(by_name(mechanism.name()).map(Mechanism::name), Some(mechanism.name()));
            for p in mechanism.parameters() {
                assert!(p.bounds[0] < p.probe && p.probe < p.bounds[1] || p.name == "time_constant_s");
            }
        }
    }
}
