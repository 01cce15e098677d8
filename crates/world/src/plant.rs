//! The robot as a body on four wheels, advanced step by step.

use crate::{
    Effect, Error, Instant, Ledger, RobotFile, Wind,
    battery::Battery,
    contact::Brush,
    effect::{Act, Conditions, Surroundings},
    ground::Ground,
    heat::Heat,
    motor::{DriveTrain, TURNAROUND_MPS},
};

pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;
/// Share of the file's rolling resistance that bearings and belts make, whatever the load.
const BEARING_SHARE: f64 = 0.05;
/// Inertia of one side's wheels at the rim over the robot's mass: 1.5 kg of a Husky's 90 kg.
const WHEELS_SHARE: f64 = 1.0 / 60.0;
/// Load that a wheel gains per metre of twist of the ground over a quarter of the weight [1/m]: 8 N/mm of a Husky.
const TWIST_PER_M: f64 = 36.0;
/// Steps between two looks at ground, loads and effects: 5 ms, in which a robot moves by millimetres.
const LOOK_STEPS: u32 = 5;
/// How long loads take to follow accelerations [s].
const LOAD_FOLLOWS_S: f64 = 0.05;
/// Gains of the speed controller over what the magnets induce [- and 1/s].
const PROPORTIONAL: f64 = 2.2;
const INTEGRAL_PER_S: f64 = 18.0;
/// A side that is told to stand is held by its brake from this rim speed down [m/s].
const BRAKE_HOLDS_MPS: f64 = 0.01;
/// Rim speed from which on a side's driver is awake [m/s].
const AWAKE_MPS: f64 = 0.004;

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
    /// A robot at rest; `place` needs no slope.
    pub(crate) fn new(robot: &'a RobotFile, world: &crate::World, ground: &'a Ground) -> Self {
        let reference_c = robot.motors.reference_temperature_c;
        let ambient_c = world.ambient_temp_c.unwrap_or(reference_c);
        let side = |left| SideState {
            train: DriveTrain::new(robot, left),
            heat: Heat::at_rest(ambient_c),
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
            step_s: world.step_s,
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
        if self.speed.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(Error::Diverged { t_s: self.t_s }) }
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
        let body = self.mass_kg() * (forward * forward + left * left) + self.yaw_inertia_kgm2() * yaw * yaw;
        [0.5 * (body + self.rim_kg() * rims), self.mass_kg() * GRAVITY_MPS2 * self.lie.z_m]
    }

    /// Looks at the ground, at what effects do, and at the loads that follow from both.
    fn look(&mut self) -> Result<(), Error> {
        let (sin, cos) = self.heading_rad.sin_cos();
        let (mut z, mut along, mut across, mut twist_m) = ([0.0; 4], 0.0, 0.0, 0.0);
        let mut surface = [0; 4];
        for (i, wheel) in self.wheels.iter().enumerate() {
            let [x, y] = wheel.at_m;
            let (x_m, y_m) = (self.place_m[0] + x * cos - y * sin, self.place_m[1] + x * sin + y * cos);
            let spot = self.ground.spot(x_m, y_m).ok_or(Error::UnknownGround { t_s: self.t_s, x_m, y_m })?;
            let forward = spot.slope[0] * cos + spot.slope[1] * sin;
            let left = spot.slope[1] * cos - spot.slope[0] * sin;
            z[i] = spot.z_m;
            along += forward / 4.0;
            across += left / 4.0;
            twist_m += (x * left - y * forward) / 4.0;
            surface[i] = self.ground.surface(x_m, y_m);
        }
        let (pitch_rad, roll_rad) = (along.atan(), across.atan());
        self.lie = Lie {
            z_m: z.iter().sum::<f64>() / 4.0,
            pitch: pitch_rad.sin_cos(),
            roll: roll_rad.sin_cos(),
            twist_m,
            pitch_rad,
            roll_rad: (across * pitch_rad.cos()).atan(),
        };
        self.apply_effects();
        self.load(&surface, (z[0] - z[1] - z[2] + z[3]) / 4.0);
        Ok(())
    }

    fn apply_effects(&mut self) {
        let seen = self.surroundings();
        let mut conditions = Conditions::default();
        for (effect, actor) in &mut self.effects {
            if effect.acts(self.t_s, self.place_m) {
                actor.act(&seen, &mut conditions);
            }
        }
        if let Some(wind) = self.wind {
            let force_n = crate::effect::air_force_n(&seen, wind.speed_mps, wind.toward_rad);
            conditions.push_n[0] += force_n[0];
            conditions.push_n[1] += force_n[1];
        }
        // Drives that change mass under way take its energies with them.
        let before = self.mechanical_j();
        self.conditions = conditions;
        let after = self.mechanical_j();
        self.ledger.kinetic_j -= after[0] - before[0];
        self.ledger.potential_j -= after[1] - before[1];
    }

    fn surroundings(&self) -> Surroundings {
        Surroundings {
            step_s: self.step_s * f64::from(LOOK_STEPS),
            place_m: self.place_m,
            height_m: self.lie.z_m,
            heading_rad: self.heading_rad,
            speed_mps: self.speed[0],
            yaw_rate_radps: self.speed[2],
            pitch_rad: self.lie.pitch_rad,
            roll_rad: self.lie.roll_rad,
            rim_mps: [0, 1].map(|i| self.sides[i].rim_mps),
            rim_m: [0, 1].map(|i| self.sides[i].rim_m),
            wheel_radius_m: self.robot.wheel_radius_m,
            mass_kg: self.robot.mass_kg,
            duty: [0, 1].map(|i| self.sides[i].duty),
            relative_voltage: self.battery.relative_voltage(),
            around_m: if self.wants_surroundings { self.around_m() } else { self.lie.z_m },
        }
    }

    /// Mean height of the ground around [m].
    fn around_m(&self) -> f64 {
        /// How far around: wider than a puddle, closer than the next hill [m].
        const AROUND_M: f64 = 2.0;
        let [x, y] = self.place_m;
        let at = |dx: f64, dy: f64| self.ground.spot(x + dx, y + dy).map_or(self.lie.z_m, |spot| spot.z_m);
        (at(AROUND_M, 0.0) + at(-AROUND_M, 0.0) + at(0.0, AROUND_M) + at(0.0, -AROUND_M)) / 4.0
    }

    /// Loads of the wheels from attitude, centre of mass, accelerations and twisted ground; what they make of rolling.
    fn load(&mut self, surface: &[usize; 4], warp_m: f64) {
        let normal_n = self.mass_kg() * GRAVITY_MPS2 * self.lie.pitch.1 * self.lie.roll.1;
        let height_m = self.robot.center_of_mass.height_m + self.conditions.center_m[2];
        let center_m = self.center_m();
        let front = (center_m[0] - height_m * self.carried_n[0] / normal_n) / self.robot.wheelbase_m;
        let left = (center_m[1] - height_m * self.carried_n[1] / normal_n) / self.robot.track_m;
        let nominal_n = self.robot.mass_kg * GRAVITY_MPS2 / 4.0;
        let track_ratio = self.robot.slip_track_m() / self.robot.track_m;
        self.sides.iter_mut().for_each(|side| side.rolling_n = 0.0);
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let (ahead, beside) = (wheel.at_m[0].signum(), wheel.at_m[1].signum());
            let share = (0.5 + ahead * front) * (0.5 + beside * left);
            wheel.load_n = (normal_n * share + TWIST_PER_M * nominal_n * warp_m * ahead * beside).max(0.0);
            let law = &self.ground.surfaces[surface[i]];
            let c = &self.conditions;
            wheel.brush =
                Brush::new(law.mu_skid * c.skid_factor, law.slip_angle_scale_rad, track_ratio, c.compliance);
            let carcass = law.mu_roll * c.roll_factor * (1.0 - BEARING_SHARE);
            let coefficient = carcass + c.sinkage * (wheel.load_n / nominal_n).cbrt();
            self.sides[i % 2].rolling_n += coefficient * wheel.load_n;
        }
    }

    /// Controller, winding and gears of one side; returns the force at the rim [N].
    fn drive(&mut self, side: usize, command_mps: f64) -> f64 {
        let s = &mut self.sides[side];
        s.braked = command_mps == 0.0 && s.rim_mps.abs() < BRAKE_HOLDS_MPS;
        if s.braked {
            (s.current_a, s.integral_v, s.duty) = (0.0, 0.0, 0.0);
            return 0.0;
        }
        let error_mps = command_mps - s.rim_mps;
        let wanted_v = s.train.open_voltage_v(command_mps + PROPORTIONAL * error_mps) + s.integral_v;
        let limit_v = self.battery.voltage_v;
        let applied_v = wanted_v.clamp(-limit_v, limit_v);
        if applied_v == wanted_v {
            s.integral_v += s.train.open_voltage_v(INTEGRAL_PER_S * error_mps) * self.step_s;
        }
        s.duty = applied_v / limit_v;
        let winding_c = warmed(s, &self.conditions, self.robot);
        s.current_a = s.train.current_a(s.current_a, applied_v, s.rim_mps, winding_c, self.step_s);
        let (motor_n, rim_n) = s.train.force_n(s.current_a, s.rim_mps, winding_c);
        self.ledger.gears_j += (motor_n - rim_n) * s.rim_mps * self.step_s;
        rim_n
    }

    /// Forces of all tyres on the body [N], their moment [N m], and the force that holds each side's wheels [N].
    fn tyres(&mut self) -> ([f64; 2], f64, [f64; 2]) {
        let center_m = self.center_m();
        let (mut force_n, mut moment_nm, mut held_n) = ([0.0; 2], 0.0, [0.0; 2]);
        let [forward, left, yaw] = self.speed;
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let (x, y) = (wheel.at_m[0] - center_m[0], wheel.at_m[1] - center_m[1]);
            let rim_mps = self.sides[i % 2].rim_mps;
            let slide_mps = [rim_mps - (forward - yaw * y), -(left + yaw * x)];
            let contact =
                wheel.brush.advance(wheel.load_n, wheel.deflection_m, slide_mps, rim_mps, self.step_s);
            wheel.deflection_m = contact.deflection_m;
            let [along_n, across_n] = contact.force_n;
            force_n[0] += along_n;
            force_n[1] += across_n;
            moment_nm += x * across_n - y * along_n;
            held_n[i % 2] += along_n;
            self.ledger.sliding_j += (along_n * slide_mps[0] + across_n * slide_mps[1]) * self.step_s;
        }
        (force_n, moment_nm, held_n)
    }

    /// Newton's law for the body, in its own turning frame.
    fn accelerate(&mut self, tyres_n: [f64; 2], tyre_moment_nm: f64) {
        let (mass_kg, c) = (self.mass_kg(), &self.conditions);
        let weight_n = mass_kg * GRAVITY_MPS2;
        let forward_n = tyres_n[0] + c.push_n[0] - weight_n * self.lie.pitch.0;
        let left_n = tyres_n[1] + c.push_n[1] - weight_n * self.lie.roll.0;
        let moment_nm = tyre_moment_nm + c.moment_nm - weight_n * self.lie.twist_m;
        let [forward, left, yaw] = self.speed;
        let before_yaw = yaw;
        self.speed = [
            forward + self.step_s * (forward_n / mass_kg + yaw * left),
            left + self.step_s * (left_n / mass_kg - yaw * forward),
            yaw + self.step_s * moment_nm / self.yaw_inertia_kgm2(),
        ];
        let outside_w = c.push_n[0] * (forward + self.speed[0]) / 2.0
            + c.push_n[1] * (left + self.speed[1]) / 2.0
            + c.moment_nm * (before_yaw + self.speed[2]) / 2.0;
        self.ledger.outside_j -= outside_w * self.step_s;
        let follow = self.step_s / LOAD_FOLLOWS_S;
        for (carried_n, tyre_n) in self.carried_n.iter_mut().zip(tyres_n) {
            *carried_n += follow * (tyre_n - *carried_n);
        }
    }

    /// Newton's law for the wheels of each side; dry friction is taken implicitly, since it stops what it brakes.
    fn turn_wheels(&mut self, drive_n: [f64; 2], held_n: [f64; 2]) {
        let bearing_n = BEARING_SHARE * self.nominal_rolling() * self.robot.mass_kg * GRAVITY_MPS2 / 2.0;
        let rim_kg = self.rim_kg();
        for i in 0..2 {
            let s = &mut self.sides[i];
            let before_mps = s.rim_mps;
            if s.braked {
                self.ledger.gears_j +=
                    0.5 * rim_kg * before_mps * before_mps - held_n[i] * before_mps * self.step_s;
                s.rim_mps = 0.0;
                continue;
            }
            let direction = (before_mps / TURNAROUND_MPS).tanh();
            let gear_n = bearing_n * direction + self.conditions.drag_n[i];
            let rolling_n = s.rolling_n * direction;
            s.rim_mps += self.step_s * (drive_n[i] - held_n[i] - gear_n - rolling_n) / rim_kg;
            let mean_mps = (before_mps + s.rim_mps) / 2.0;
            s.rim_m += mean_mps * self.step_s;
            self.ledger.gears_j += gear_n * mean_mps * self.step_s;
            self.ledger.rolling_j += rolling_n * mean_mps * self.step_s;
        }
    }

    /// Rolling coefficient of the default surface, which bearings were measured on.
    fn nominal_rolling(&self) -> f64 {
        self.robot.surfaces.get(&self.robot.default_surface).map_or(0.0, |s| s.mu_roll)
    }

    /// What motors, electronics and battery draw and how they warm.
    fn draw(&mut self) {
        let mut bus_w = self.robot.hotel_power_w + self.conditions.hotel_w;
        self.ledger.electronics_j += bus_w * self.step_s;
        for i in 0..2 {
            let s = &mut self.sides[i];
            let winding_c = warmed(s, &self.conditions, self.robot);
            let power = s.train.power(s.current_a, s.rim_mps, winding_c, self.conditions.returned);
            let awake_w = if s.rim_mps.abs() > AWAKE_MPS { self.robot.drive_electronics_w } else { 0.0 };
            let own_w = awake_w + self.conditions.driver_w[i];
            s.heat.advance(
                power.copper_w,
                0.4 * power.conversion_w.abs(),
                self.ambient_c,
                self.speed[0],
                self.step_s,
            );
            self.drawn_j[i] += (power.drawn_w + own_w) * self.step_s;
            self.motor_as[i] += s.current_a.abs() * self.step_s;
            self.ledger.copper_j += power.copper_w * self.step_s;
            self.ledger.conversion_j += power.conversion_w * self.step_s;
            self.ledger.electronics_j += own_w * self.step_s;
            bus_w += power.drawn_w + own_w;
        }
        let given_j = self.battery.deliver_j(bus_w, self.step_s);
        self.drawn_j[2] += bus_w * self.step_s;
        self.ledger.given_j += given_j;
        self.ledger.battery_j += given_j - bus_w * self.step_s;
    }

    /// Where the geometric centre goes.
    fn move_on(&mut self) {
        let center_m = self.center_m();
        let forward = (self.speed[0] + self.speed[2] * center_m[1]) * self.lie.pitch.1;
        let left = (self.speed[1] - self.speed[2] * center_m[0]) * self.lie.roll.1;
        let (sin, cos) = self.heading_rad.sin_cos();
        self.place_m[0] += self.step_s * (forward * cos - left * sin);
        self.place_m[1] += self.step_s * (forward * sin + left * cos);
        self.heading_rad += self.step_s * self.speed[2];
    }
}

/// Winding temperature that resistance and magnets follow [°C]: the reference, unless an effect lets the warming show.
fn warmed(side: &SideState, conditions: &Conditions, robot: &RobotFile) -> f64 {
    let reference_c = robot.motors.reference_temperature_c;
    reference_c + conditions.warming * (side.heat.winding_c - reference_c)
}
