//! Each formula restated once with dimensioned quantities, so that the compiler checks its units.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use approx::assert_relative_eq;
use model::{
    Acceleration, Attitude, Manoeuvre, Motion, PowerModel, STANDARD_GRAVITY_MPS2, Sides, builtin, rolling,
    skid,
};
use uom::si::{
    acceleration::meter_per_second_squared,
    angular_velocity::radian_per_second,
    f64::{Acceleration as LinearAcceleration, AngularVelocity, Force, Length, Mass, Power, Ratio, Velocity},
    force::newton,
    length::meter,
    mass::kilogram,
    power::watt,
    ratio::ratio,
    velocity::meter_per_second,
};

fn gravity() -> LinearAcceleration {
    LinearAcceleration::new::<meter_per_second_squared>(STANDARD_GRAVITY_MPS2)
}

#[test]
fn eq_2_adds_copper_loss_and_mechanical_power() {
    let robot = builtin::husky_a200();
    let motor = robot.motors.left.at_temperature(&robot.motors, 20.0);
    let force = Force::new::<newton>(120.0);
    let speed = Velocity::new::<meter_per_second>(0.4);
    let k1 = Power::new::<watt>(motor.k1_w_per_n2) / Force::new::<newton>(1.0) / Force::new::<newton>(1.0);
    let k2 = Ratio::new::<ratio>(motor.k2);
    let power: Power = k1 * force * force + k2 * speed * force;
    let motion = Motion::of_body(&robot, 0.4, 0.0);
    let marble = &robot.surfaces["marble"];
    let straight = Manoeuvre::new(PowerModel::ForceBalance, &robot, marble, motion, Sides::both(20.0));
    let side_w = straight.kernel().side_w(Sides::both(120.0)).left;
    assert_relative_eq!(side_w, power.get::<watt>(), epsilon = 1e-12);
}

#[test]
fn eqs_4_and_5_make_forces_of_mass_and_slope() {
    let robot = builtin::husky_a200();
    let attitude = Attitude { pitch_rad: 0.2, roll_rad: 0.1 };
    let motion = Motion::of_body(&robot, 0.5, 0.0);
    let marble = &robot.surfaces["marble"];
    let straight = Manoeuvre::new(PowerModel::ForceBalance, &robot, marble, motion, Sides::both(20.0));
    let acceleration = Acceleration { forward_mps2: 0.3, yaw_radps2: 0.0, left_mps2: 0.0 };
    let sides = straight.power_accelerating(attitude, acceleration).force_n;

    let mass = Mass::new::<kilogram>(robot.mass_kg);
    let along: Force = mass * gravity() * Ratio::new::<ratio>(0.2f64.sin());
    let rolling: Force = mass * gravity() * Ratio::new::<ratio>(0.063 * 0.2f64.cos() * 0.1f64.cos());
    let inertia: Force = mass * LinearAcceleration::new::<meter_per_second_squared>(0.3);
    assert_relative_eq!(sides.sum(), (along + rolling + inertia).get::<newton>(), epsilon = 1e-9);
}

#[test]
fn the_skid_moment_over_the_track_is_a_force() {
    let robot = builtin::husky_a200();
    let marble = &robot.surfaces["marble"];
    let load: Force = Mass::new::<kilogram>(robot.mass_kg) * gravity();
    let arm = Length::new::<meter>(skid::moment_per_load_m(&robot, marble, 0.0, 1.0));
    let force: Force = load * arm / Length::new::<meter>(robot.track_m);
    let rolling: Force = load * Ratio::new::<ratio>(0.063 * rolling::load_share(&robot).right);
    let spin = Manoeuvre::new(
        PowerModel::ForceBalance,
        &robot,
        marble,
        Motion::of_body(&robot, 0.0, 1.0),
        Sides::both(20.0),
    );
    let right_n = spin.power(Attitude::LEVEL).force_n.right;
    assert_relative_eq!(right_n, (force + rolling).get::<newton>(), epsilon = 1e-9);
}

#[test]
fn eq_11_divides_speed_by_yaw_rate() {
    let robot = builtin::husky_a200();
    let speed = Velocity::new::<meter_per_second>(0.6);
    let yaw = AngularVelocity::new::<radian_per_second>(0.4);
    let radius: Length = speed / yaw;
    assert_relative_eq!(
        Motion::of_body(&robot, 0.6, 0.4).turning_radius_m(),
        radius.get::<meter>(),
        epsilon = 1e-12
    );
}
