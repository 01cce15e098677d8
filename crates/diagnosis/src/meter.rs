//! What recordings tell second by second, beside the inputs.

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
