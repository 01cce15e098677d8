//! How the robot moves at one instant.

use crate::{Robot, Sides};

/// Body and wheel speeds at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// v: forward speed of the geometric centre over the ground [m/s].
    pub speed_mps: f64,
    /// ω: yaw rate, positive turning left [rad/s].
    pub yaw_rate_radps: f64,
    /// u: rim speeds of both sides [m/s].
    pub rim_speeds_mps: Sides<f64>,
    /// Heading, counter-clockwise from east, where it is known; only wind asks for it [rad].
    pub heading_rad: Option<f64>,
}

/// How fast a robot's wheels turn for a motion of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RimSpeeds {
    /// Rim speed per body speed: more than 1 where wheels slip [-].
    per_speed: f64,
    /// Half the slip track, wider where turns slip besides [m].
    half_m: f64,
}

impl RimSpeeds {
    pub(crate) fn of(robot: &Robot) -> Self {
        RimSpeeds {
            per_speed: 1.0 / (1.0 - robot.wheel_slip()),
            half_m: robot.half_slip_track_m() / (1.0 - robot.turning_slip()),
        }
    }

    /// Rim speeds at a body speed and yaw rate [m/s].
    #[inline(always)]
    pub(crate) fn at_mps(&self, speed_mps: f64, yaw_rate_radps: f64) -> Sides<f64> {
        let half_mps = yaw_rate_radps * self.half_m;
        Sides {
            left: self.per_speed * (speed_mps - half_mps),
            right: self.per_speed * (speed_mps + half_mps),
        }
    }
}

impl Motion {
    /// The motion whose wheels turn as the slip track says.
    pub fn of_body(robot: &Robot, speed_mps: f64, yaw_rate_radps: f64) -> Self {
        let rim_speeds_mps = robot.rim_speeds_mps(speed_mps, yaw_rate_radps);
        Motion { speed_mps, yaw_rate_radps, rim_speeds_mps, heading_rad: None }
    }

    /// The same motion with a heading.
    #[must_use]
    #[inline]
    pub fn heading(self, heading_rad: f64) -> Self {
        Motion { heading_rad: Some(heading_rad).filter(|rad| rad.is_finite()), ..self }
    }

    /// The motion that wheel encoders report, when no gyroscope says otherwise.
    #[inline]
    pub fn of_wheels(robot: &Robot, rim_speeds_mps: Sides<f64>) -> Self {
        let moved = 1.0 - robot.wheel_slip();
        let turned = moved * (1.0 - robot.turning_slip());
        Motion {
            speed_mps: moved * rim_speeds_mps.sum() / 2.0,
            yaw_rate_radps: turned * (rim_speeds_mps.right - rim_speeds_mps.left) / robot.slip_track_m,
            rim_speeds_mps,
            heading_rad: None,
        }
    }

    /// R0 = v/ω of eq. 11, signed: positive with the centre on the left; infinite when straight [m].
    pub fn turning_radius_m(&self) -> f64 {
        if self.yaw_rate_radps == 0.0 { f64::INFINITY } else { self.speed_mps / self.yaw_rate_radps }
    }
}

/// How fast the motion changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Acceleration {
    /// dv/dt [m/s²].
    pub forward_mps2: f64,
    /// dω/dt [rad/s²].
    pub yaw_radps2: f64,
    /// v ω, to the left [m/s²]: what keeps a turning robot on its circle, and tyres have to hold beside the skid. The paper's quasi-static
    /// balance leaves it out like the others: without it the outer side's mean of Table II is 0.133, and 0.134 was measured.
    pub left_mps2: f64,
}

impl Acceleration {
    /// Steady motion.
    pub const NONE: Acceleration = Acceleration { forward_mps2: 0.0, yaw_radps2: 0.0, left_mps2: 0.0 };
}
