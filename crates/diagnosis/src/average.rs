//! One second of one meter, and what drove the robot then.

use crate::span::Span;

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

/// What a meter is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// Power.
    Power,
    /// Speed over ground.
    Speed,
    /// Yaw rate.
    YawRate,
    /// Voltage.
    Voltage,
    /// Climb.
    Height,
}

impl Quantity {
    /// All.
    pub(crate) const ALL: [Quantity; 5] =
        [Quantity::Power, Quantity::Speed, Quantity::YawRate, Quantity::Voltage, Quantity::Height];
}

impl Average {
    /// What its meter is of.
    pub(crate) fn quantity(&self) -> Quantity {
        match self.channel {
            3 => Quantity::Speed,
            4 => Quantity::YawRate,
            5 => Quantity::Voltage,
            6 => Quantity::Height,
            _ => Quantity::Power,
        }
    }

    /// The same with time since a span began, where that was in its drive.
    pub(crate) fn since(&self, span: Span) -> Average {
        let from_s = match span {
            Span::EachDrive(from_s) => from_s,
            Span::From { run, t_s } if run == self.run => t_s,
            _ => 0.0,
        };
        Average { t_s: self.t_s - from_s, ..*self }
    }

    /// Whether what acts in a span acts on it.
    pub(crate) fn is_in(&self, span: Span) -> bool {
        span.acts(self.run, self.t_s, self.input.position_m)
    }
}

/// Means of what drives the robot, over one average.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// Mean of both rim speeds, and right less left [m/s].
    pub speed_mps: f64,
    /// See [`Input::speed_mps`].
    pub difference_mps: f64,
    /// Rim speed of the channel's own side, or the mean [m/s].
    pub rim_mps: f64,
    /// Pitch and roll [rad].
    pub pitch_rad: f64,
    /// See [`Input::pitch_rad`].
    pub roll_rad: f64,
    /// Rate of change of speed [m/s²].
    pub accel_mps2: f64,
    /// Rate of change of the difference [m/s²].
    pub swing_mps2: f64,
    /// Heading; NaN where unknown [rad].
    pub heading_rad: f64,
    /// Height above the mean of the drives of the same kind; NaN where unknown [m].
    pub height_m: f64,
    /// Towards east and north; NaN where unknown [m].
    pub position_m: [f64; 2],
    /// Time since the robot last stood still [s].
    pub moving_s: f64,
    /// Way driven in the last minutes, of which less and less counts the longer ago it was [m].
    pub of_late_m: f64,
    /// How near the wheels are to where each turn takes most, 0 to 1, of the side and in the drives in which turns show; else 0.
    pub nearness: f64,
}
