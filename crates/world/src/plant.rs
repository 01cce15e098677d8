//! The robot as a body on four wheels, advanced step by step.

mod drive_train;
mod look;
mod motion;

use crate::{
    Effect, Error, Instant, Ledger, RobotFile, Wind,
    battery::Battery,
    contact::Brush,
    effect::{Act, Conditions},
    ground::Ground,
    heat::Heat,
    motor::DriveTrain,
};

/// Standard acceleration of free fall [m/s²].
pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;
/// Share of the file's rolling resistance that bearings and belts make, whatever the load.
const BEARING_SHARE: f64 = 0.05;
/// Inertia of one side's wheels at the rim over the robot's mass: 1.5 kg of a Husky's 90 kg.
const WHEELS_SHARE: f64 = 1.0 / 60.0;
/// Steps between two looks at ground, loads and effects: 5 ms, in which a robot moves by millimetres.
const LOOK_STEPS: u32 = 5;

/// One wheel as it stands.
#[derive(Clone, Copy, Debug)]
struct Wheel {
    /// From the geometric centre, forward and left [m].
    at_m: [f64; 2],
    brush: Brush,
    load_n: f64,
    deflection_m: [f64; 2],
}

/// How the ground lies under the robot.
#[derive(Clone, Copy, Debug, Default)]
struct Lie {
    z_m: f64,
    pitch: (f64, f64),
    roll: (f64, f64),
    /// Moment of the weight about the vertical on twisted ground, per newton [m].
    twist_m: f64,
    pitch_rad: f64,
    roll_rad: f64,
}

/// One side's drive train as it runs.
#[derive(Clone, Copy, Debug)]
struct SideState {
    train: DriveTrain,
    heat: Heat,
    current_a: f64,
    integral_v: f64,
    duty: f64,
    rim_mps: f64,
    rim_m: f64,
    rolling_n: f64,
    /// The parking brake holds.
    braked: bool,
}

/// The robot in its world.
#[derive(Debug)]
pub(crate) struct Plant<'a> {
    robot: &'a RobotFile,
    ground: &'a Ground,
    effects: Vec<(Effect, Box<dyn Act>)>,
    wind: Option<Wind>,
    ambient_c: f64,
    step_s: f64,
    steps: u32,
    t_s: f64,
    place_m: [f64; 2],
    heading_rad: f64,
    /// Forward and left at the centre of mass [m/s], and yaw rate [rad/s].
    speed: [f64; 3],
    sides: [SideState; 2],
    wheels: [Wheel; 4],
    battery: Battery,
    lie: Lie,
    conditions: Conditions,
    /// Force of the tyres on the body, smoothed [N].
    carried_n: [f64; 2],
    drawn_j: [f64; 3],
    motor_as: [f64; 2],
    ledger: Ledger,
    wants_surroundings: bool,
}

impl<'a> Plant<'a> {
    /// A robot at rest, advanced in steps of `step_s`.
    pub(crate) fn new(robot: &'a RobotFile, world: &crate::World, ground: &'a Ground, step_s: f64) -> Self {
        let reference_c = robot.motors.reference_temperature_c;
        let ambient_c = world.ambient_temp_c.unwrap_or(reference_c);
        let side = |left| SideState {
            train: DriveTrain::new(robot, left),
            heat: Heat::at_rest(ambient_c, robot.size()),
            current_a: 0.0,
            integral_v: 0.0,
            duty: 0.0,
            rim_mps: 0.0,
            rim_m: 0.0,
            rolling_n: 0.0,
            braked: true,
        };
        let (a, b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
        let wheel =
            |at_m| Wheel { at_m, brush: Brush::new(0.3, 0.3, 1.0, 0.0), load_n: 0.0, deflection_m: [0.0; 2] };
        let effects: Vec<_> = world.effects.iter().map(|e| (e.clone(), e.actor())).collect();
        Plant {
            robot,
            ground,
            wants_surroundings: effects.iter().any(|(e, _)| e.effect == crate::EffectName::Puddles),
            effects,
            wind: world.wind,
            ambient_c,
            step_s,
            steps: 0,
            t_s: 0.0,
            place_m: [0.0; 2],
            heading_rad: 0.0,
            speed: [0.0; 3],
            sides: [side(true), side(false)],
            wheels: [[a, b], [a, -b], [-a, b], [-a, -b]].map(wheel),
            battery: Battery::full(robot),
            lie: Lie::default(),
            conditions: Conditions::default(),
            carried_n: [0.0; 2],
            drawn_j: [0.0; 3],
            motor_as: [0.0; 2],
            ledger: Ledger::default(),
        }
    }

    /// Sets the robot down, at rest; heat, charge and what effects remember stay.
    pub(crate) fn place(&mut self, place_m: [f64; 2], heading_rad: f64) -> Result<(), Error> {
        self.place_m = place_m;
        self.heading_rad = heading_rad;
        self.speed = [0.0; 3];
        self.carried_n = [0.0; 2];
        for side in &mut self.sides {
            (side.current_a, side.integral_v, side.rim_mps, side.duty) = (0.0, 0.0, 0.0, 0.0);
        }
        self.wheels.iter_mut().for_each(|wheel| wheel.deflection_m = [0.0; 2]);
        self.steps = 0;
        self.look()?;
        let energy = self.mechanical_j();
        self.ledger.kinetic_j -= energy[0];
        self.ledger.potential_j -= energy[1];
        Ok(())
    }

    /// Where the robot is and how it heads.
    pub(crate) fn pose(&self) -> ([f64; 2], f64) {
        (self.place_m, self.heading_rad)
    }

    /// Where the energy went; kinetic and potential energies are brought up to now.
    pub(crate) fn ledger(&self) -> Ledger {
        let [kinetic_j, potential_j] = self.mechanical_j();
        let mut ledger = self.ledger;
        ledger.kinetic_j += kinetic_j;
        ledger.potential_j += potential_j;
        ledger
    }

    /// The truth now.
    pub(crate) fn instant(&self) -> Instant {
        let center_m = self.center_m();
        Instant {
            t_s: self.t_s,
            x_m: self.place_m[0],
            y_m: self.place_m[1],
            z_m: self.lie.z_m,
            heading_rad: self.heading_rad,
            speed_mps: self.speed[0] + self.speed[2] * center_m[1],
            yaw_rate_radps: self.speed[2],
            pitch_rad: self.lie.pitch_rad,
            roll_rad: self.lie.roll_rad,
            rim_m: [0, 1].map(|i| self.sides[i].rim_m),
            drawn_j: self.drawn_j,
            motor_as: self.motor_as,
            case_c: [0, 1].map(|i| self.sides[i].heat.case_c),
            voltage_v: self.battery.voltage_v,
            surface: self.ground.surface(self.place_m[0], self.place_m[1]),
        }
    }

    /// Advances by one step under commanded rim speeds.
    pub(crate) fn step(&mut self, command_mps: [f64; 2]) -> Result<(), Error> {
        if self.steps.is_multiple_of(LOOK_STEPS) {
            self.look()?;
        }
        self.steps += 1;
        let drive_n = [0, 1].map(|side| self.drive(side, command_mps[side]));
        let (tyres_n, tyre_moment_nm, held_n) = self.tyres();
        self.accelerate(tyres_n, tyre_moment_nm);
        self.turn_wheels(drive_n, held_n);
        self.draw();
        self.move_on();
        self.t_s += self.step_s;
        let is_finite = self.speed.iter().all(|v| v.is_finite()) && self.battery.voltage_v.is_finite();
        if is_finite { Ok(()) } else { Err(Error::Diverged { t_s: self.t_s }) }
    }

    fn mass_kg(&self) -> f64 {
        self.robot.mass_kg + self.conditions.mass_kg
    }

    fn yaw_inertia_kgm2(&self) -> f64 {
        self.robot.yaw_inertia_kgm2() * self.mass_kg() / self.robot.mass_kg
    }

    fn rim_kg(&self) -> f64 {
        WHEELS_SHARE * self.robot.mass_kg + self.conditions.rim_kg
    }

    /// Centre of mass from the geometric centre, forward and left [m].
    fn center_m(&self) -> [f64; 2] {
        let com = self.robot.center_of_mass;
        [com.forward_m + self.conditions.center_m[0], com.left_m + self.conditions.center_m[1]]
    }

    /// Kinetic and potential energy [J].
    fn mechanical_j(&self) -> [f64; 2] {
        let [forward, left, yaw] = self.speed;
        let rims: f64 = self.sides.iter().map(|s| s.rim_mps * s.rim_mps).sum();
        let body = self.mass_kg() * (forward * forward + left * left)
            + self.conditions.towed_kg * forward * forward
            + self.yaw_inertia_kgm2() * yaw * yaw;
        [0.5 * (body + self.rim_kg() * rims), self.mass_kg() * GRAVITY_MPS2 * self.lie.z_m]
    }
}
