//! What really happened, before any sensor looked at it.

/// The truth at one instant. Sums run from the start of the drive, so that a mean over any window is a difference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// Time [s].
    pub t_s: f64,
    /// Position of the geometric centre [m].
    pub x_m: f64,
    /// See `x_m` [m].
    pub y_m: f64,
    /// Height of the ground under it [m].
    pub z_m: f64,
    /// Heading, unwrapped [rad].
    pub heading_rad: f64,
    /// Forward speed over the ground [m/s].
    pub speed_mps: f64,
    /// Yaw rate [rad/s].
    pub yaw_rate_radps: f64,
    /// Pitch, positive climbing [rad].
    pub pitch_rad: f64,
    /// Roll, positive left side up [rad].
    pub roll_rad: f64,
    /// How far the rims have turned, left and right [m].
    pub rim_m: [f64; 2],
    /// Energy drawn by the drivers, left and right, and from the battery [J].
    pub drawn_j: [f64; 3],
    /// Charge of both motors, without sign [A s].
    pub motor_as: [f64; 2],
    /// Case temperatures [°C].
    pub case_c: [f64; 2],
    /// Battery voltage [V].
    pub voltage_v: f64,
    /// Index of the surface under the middle.
    pub surface: usize,
}

impl Instant {
    /// Between two instants, `share` of the way.
    pub(crate) fn between(&self, later: &Instant, share: f64) -> Instant {
        let mix = |a: f64, b: f64| a + share * (b - a);
        let pair = |a: [f64; 2], b: [f64; 2]| [mix(a[0], b[0]), mix(a[1], b[1])];
        Instant {
            t_s: mix(self.t_s, later.t_s),
            x_m: mix(self.x_m, later.x_m),
            y_m: mix(self.y_m, later.y_m),
            z_m: mix(self.z_m, later.z_m),
            heading_rad: mix(self.heading_rad, later.heading_rad),
            speed_mps: mix(self.speed_mps, later.speed_mps),
            yaw_rate_radps: mix(self.yaw_rate_radps, later.yaw_rate_radps),
            pitch_rad: mix(self.pitch_rad, later.pitch_rad),
            roll_rad: mix(self.roll_rad, later.roll_rad),
            rim_m: pair(self.rim_m, later.rim_m),
            drawn_j: [0, 1, 2].map(|i| mix(self.drawn_j[i], later.drawn_j[i])),
            motor_as: pair(self.motor_as, later.motor_as),
            case_c: pair(self.case_c, later.case_c),
            voltage_v: mix(self.voltage_v, later.voltage_v),
            surface: if share < 0.5 { self.surface } else { later.surface },
        }
    }
}
