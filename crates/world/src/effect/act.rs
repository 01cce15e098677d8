//! What effects see and what they can change.

/// What an effect sees of the robot, a few times in a hundredth of a second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Surroundings {
    /// Time since the last look [s].
    pub(crate) step_s: f64,
    pub(crate) place_m: [f64; 2],
    pub(crate) height_m: f64,
    pub(crate) heading_rad: f64,
    /// Forward speed [m/s] and yaw rate [rad/s].
    pub(crate) speed_mps: f64,
    pub(crate) yaw_rate_radps: f64,
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
    /// Rim speeds, left and right [m/s], and how far the rims have turned [m].
    pub(crate) rim_mps: [f64; 2],
    pub(crate) rim_m: [f64; 2],
    pub(crate) wheel_radius_m: f64,
    /// Drag areas of the robot, head-on and from the side [m²].
    pub(crate) drag_area_m2: [f64; 2],
    /// Mass of the robot without effects [kg].
    pub(crate) mass_kg: f64,
    /// Duty of both drivers, −1 to 1.
    pub(crate) duty: [f64; 2],
    /// Battery voltage over the nominal one.
    pub(crate) relative_voltage: f64,
    /// Mean height of the ground two metres around [m].
    pub(crate) around_m: f64,
}

/// What effects change; the default changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conditions {
    pub(crate) mass_kg: f64,
    /// Shift of the centre of mass forward, left and up [m].
    pub(crate) center_m: [f64; 3],
    pub(crate) roll_factor: f64,
    pub(crate) skid_factor: f64,
    /// Rolling coefficient on top, at nominal load; it grows with the cube root of the load.
    pub(crate) sinkage: f64,
    /// Slip per pull over load on top.
    pub(crate) compliance: f64,
    /// Dry friction against the turning of each side's wheels, whichever way they turn [N].
    pub(crate) drag_n: [f64; 2],
    /// Mass that is drawn along but carried by no wheel of the robot [kg].
    pub(crate) towed_kg: f64,
    /// Force on the body, forward and left [N].
    pub(crate) push_n: [f64; 2],
    /// Moment on the body, positive to the left [N m].
    pub(crate) moment_nm: f64,
    /// Inertia of each side at the rim on top [kg].
    pub(crate) rim_kg: f64,
    /// How much of the warming of winding and magnets shows.
    pub(crate) warming: f64,
    /// Fraction of the returned power that comes through.
    pub(crate) returned: f64,
    /// Power that each driver draws on top [W].
    pub(crate) driver_w: [f64; 2],
    /// Power that the electronics draw on top [W].
    pub(crate) hotel_w: f64,
}

impl Default for Conditions {
    fn default() -> Self {
        Conditions {
            mass_kg: 0.0,
            center_m: [0.0; 3],
            roll_factor: 1.0,
            skid_factor: 1.0,
            sinkage: 0.0,
            compliance: 0.0,
            drag_n: [0.0; 2],
            towed_kg: 0.0,
            push_n: [0.0; 2],
            moment_nm: 0.0,
            rim_kg: 0.0,
            warming: 0.0,
            returned: 1.0,
            driver_w: [0.0; 2],
            hotel_w: 0.0,
        }
    }
}

/// What effects do to readings; the default does nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Distortion {
    pub(crate) pitch_rad: f64,
    pub(crate) rim_factor: f64,
    pub(crate) power_factor: f64,
    pub(crate) power_w: f64,
    pub(crate) power_late_s: f64,
}

impl Default for Distortion {
    fn default() -> Self {
        Distortion { pitch_rad: 0.0, rim_factor: 1.0, power_factor: 1.0, power_w: 0.0, power_late_s: 0.0 }
    }
}

/// An effect at work.
pub(crate) trait Act: std::fmt::Debug {
    /// Changes the conditions while it acts.
    fn act(&mut self, _seen: &Surroundings, _out: &mut Conditions) {}

    /// Changes readings while it acts.
    fn distort(&self, _out: &mut Distortion) {}
}

/// −1 to 1, the direction of a speed, smooth through standstill.
pub(crate) fn direction(speed_mps: f64) -> f64 {
    /// Speed over which forces turn round [m/s].
    const TURNAROUND_MPS: f64 = 0.02;
    (speed_mps / TURNAROUND_MPS).tanh()
}
