//! One second of one meter, and what drove the robot then.

use recording::PowerForm;

/// A quantity that is recorded and predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meter {
    /// Power of the left side [W].
    Left,
    /// Power of the right side [W].
    Right,
    /// Power of the battery [W].
    Battery,
    /// Power of the battery beyond that of both sides [W].
    Rest,
    /// Speed over ground, from positions [m/s].
    Ground,
    /// Yaw rate of the gyroscope [rad/s].
    Yaw,
    /// Voltage of the battery beyond that of the seconds around [V].
    Sag,
    /// Climb over the seconds before, by heights [m].
    Climb,
}

impl Meter {
    /// Those that a form of recorded power may come with, power first.
    pub(crate) fn of(form: PowerForm) -> Vec<Meter> {
        match form {
            PowerForm::Sides | PowerForm::MotorCurrents => {
                vec![
                    Meter::Left,
                    Meter::Right,
                    Meter::Rest,
                    Meter::Ground,
                    Meter::Yaw,
                    Meter::Sag,
                    Meter::Climb,
                ]
            }
            PowerForm::Battery | PowerForm::CurrentAndVoltage => {
                vec![Meter::Battery, Meter::Ground, Meter::Yaw, Meter::Sag, Meter::Climb]
            }
        }
    }

    /// Its place among an average's channels; see [`crate::Average::channel`].
    pub(crate) fn channel(self) -> usize {
        match self {
            Meter::Left | Meter::Battery => 0,
            Meter::Right => 1,
            Meter::Rest => 2,
            Meter::Ground => 3,
            Meter::Yaw => 4,
            Meter::Sag => 5,
            Meter::Climb => 6,
        }
    }

    /// Whether it is power that a diagnosis explains.
    pub(crate) fn is_power(self) -> bool {
        matches!(self, Meter::Left | Meter::Right | Meter::Battery)
    }
}

/// What one value is an average of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Average {
    /// 0 and 1 for left and right power, or 0 for that of the battery; 2 for what the battery gives beyond both sides, 3 for the
    /// speed over ground, 4 for the yaw rate, 5 for the battery's voltage and 6 for the climb.
    pub channel: usize,
    /// Which drive; drives under suspicion and healthy ones count on.
    pub run: usize,
    /// Whether the drive is under suspicion.
    pub suspect: bool,
    /// Time since the drive began [s].
    pub t_s: f64,
    /// Means of the inputs.
    pub input: Input,
}

/// Means of what drives the robot, over one average.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// Mean of both rim speeds, and right less left [m/s].
    pub speed_mps: f64,
    /// See [`Input::speed_mps`].
    pub difference_mps: f64,
    /// Pitch and roll [rad].
    pub pitch_rad: f64,
    /// See [`Input::pitch_rad`].
    pub roll_rad: f64,
    /// Rate of change of speed [m/s²].
    pub accel_mps2: f64,
    /// Heading; NaN where unknown [rad].
    pub heading_rad: f64,
    /// Towards east and north; NaN where unknown [m].
    pub position_m: [f64; 2],
    /// Time since the robot last stood still [s].
    pub moving_s: f64,
    /// How near the wheels are to where each turn takes most, 0 to 1, of the side and in the drives in which turns show; else 0.
    pub nearness: f64,
}
