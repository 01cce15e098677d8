//! Driving a journey to its end: motors warm, the battery drains and sags, hotel load counts by time.

use model::{
    Acceleration, Grade, Manoeuvre, Power, Sides,
    thermal::{MotorHeat, ThermalModel, losses_w},
};

use crate::{
    Error,
    chance::Chance,
    journey::{Journey, Part, Step, Stop},
    meter::Meter,
    pack::Delivery,
};

/// How it is when the robot sets out, and how far it may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Temperature of the air [°C].
    pub ambient_c: f64,
    /// Temperature of both motors when it sets out [°C].
    pub motor_c: f64,
    /// Charge that must stay, 0 to 1.
    pub reserve: f64,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Drawn from the battery, less what it took back; chargers are not counted [J].
    pub energy_j: f64,
    /// What the battery did not take of what came back [J].
    pub refused_j: f64,
    /// Put in by chargers [J].
    pub charged_j: f64,
    /// Time with its stops [s].
    pub duration_s: f64,
    /// Charge at the end, 1 full; below 0 it tells by how much the battery was too small.
    pub arrival_charge: f64,
    /// The least charge on the way.
    pub least_charge: f64,
    /// The least voltage on the way [V].
    pub least_voltage_v: f64,
    /// Energy drawn between the place where the reserve was reached and that of the least charge; 0 where it never was [J].
    pub missing_j: f64,
    /// Why the robot stopped on the way, apart from its charge.
    pub stalled: Option<Stall>,
    /// Temperatures of the motors at the end.
    pub heat: Sides<MotorHeat>,
    /// The hottest that a winding was [°C].
    pub hottest_c: f64,
}

impl Outcome {
    /// Whether the robot gets there with its reserve.
    pub fn succeeds(&self) -> bool {
        self.missing_j == 0.0 && self.stalled.is_none()
    }
}

/// What stops a robot that still has charge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stall {
    /// The voltage sagged below that at which drives are switched off.
    CutOff,
    /// The sagging voltage left a side less force than it needed.
    Force,
    /// A charger could not bring the battery to the level asked for.
    Charger,
}

/// One part of the journey as it was driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Number of the part.
    pub part: usize,
    /// Since the start, at its end [s].
    pub t_s: f64,
    /// Drawn since the start, at its end [J].
    pub energy_j: f64,
    /// Charge at its end.
    pub charge: f64,
    /// Voltage in it [V].
    pub voltage_v: f64,
    /// Winding temperatures at its end [°C].
    pub winding_c: Sides<f64>,
}

/// Motors may warm by so much before the manoeuvre is prepared anew [K]: k1 changes by less than 0.2 % meanwhile.
const STALE_K: f64 = 0.25;

/// The robot under way.
pub(crate) struct Traveller<'a> {
    journey: &'a Journey,
    chance: &'a Chance,
    conditions: &'a Conditions,
    thermal: ThermalModel,
    /// Manoeuvres of each kind of step at the temperature that they were prepared for.
    ready: Vec<Option<(Sides<f64>, Manoeuvre)>>,
    out: Outcome,
    pub(crate) charge: f64,
    /// Drawn where the charge was first below the reserve, and since then where it was least [J].
    below_j: Option<f64>,
}

/// Work of a stop beside that of a step: its delivery may have as many stretches as a charge has thousandths.
const WORK_PER_STOP: usize = 200;

impl Journey {
    /// Drives the journey and shows every part of it to `visit`.
    ///
    /// # Errors
    /// Patience that ends before the journey.
    pub(crate) fn run(
        &self,
        chance: &Chance,
        conditions: &Conditions,
        meter: &mut Meter<'_>,
        mut visit: impl FnMut(&Passage),
    ) -> Result<Outcome, Error> {
        let mut traveller = Traveller::new(self, chance, conditions);
        for (number, part) in self.parts.iter().enumerate() {
            let voltage_v = match part {
                Part::Step(step) => {
                    meter.spend(1)?;
                    traveller.step(step)
                }
                Part::Stop(stop) => {
                    meter.spend(WORK_PER_STOP)?;
                    traveller.stay(stop)
                }
            };
            visit(&Passage {
                part: number,
                t_s: traveller.out.duration_s,
                energy_j: traveller.out.energy_j,
                charge: traveller.charge,
                voltage_v,
                winding_c: traveller.out.heat.map(|h| h.winding_c),
            });
        }
        Ok(Outcome { arrival_charge: traveller.charge, ..traveller.out })
    }
}

impl<'a> Traveller<'a> {
    /// A robot that sets out on a journey.
    pub(crate) fn new(journey: &'a Journey, chance: &'a Chance, conditions: &'a Conditions) -> Self {
        let heat = Sides::both(MotorHeat { winding_c: conditions.motor_c, case_c: conditions.motor_c });
        Traveller {
            journey,
            chance,
            conditions,
            thermal: ThermalModel::of(&chance.robot),
            ready: vec![None; journey.kinds.len()],
            out: Outcome {
                energy_j: 0.0,
                refused_j: 0.0,
                charged_j: 0.0,
                duration_s: 0.0,
                arrival_charge: chance.charge,
                least_charge: chance.charge,
                least_voltage_v: chance.pack.open_voltage_v(chance.charge),
                missing_j: 0.0,
                stalled: None,
                heat,
                hottest_c: conditions.motor_c,
            },
            charge: chance.charge,
            below_j: None,
        }
    }

    /// Drives a step; the voltage in it [V].
    pub(crate) fn step(&mut self, step: &Step) -> f64 {
        let winding_c = self.out.heat.map(|h| h.winding_c);
        let Some((power, standing_w, hidden_w)) = self.power(step, winding_c) else {
            return self.out.least_voltage_v;
        };
        let losses = losses_w(&self.chance.robot, &power, winding_c);
        let ambient_c = self.conditions.ambient_c;
        for (motor, (copper_w, gear_w)) in
            [(&mut self.out.heat.left, losses.left), (&mut self.out.heat.right, losses.right)]
        {
            motor.advance(&self.thermal, copper_w, gear_w, ambient_c, step.duration_s);
            self.out.hottest_c = self.out.hottest_c.max(motor.winding_c);
        }
        let drawn_w = standing_w + self.drives_w(&power, standing_w) + hidden_w;
        let delivered = self.deliver(drawn_w, step.duration_s);
        self.sag(&power, step, standing_w, delivered.voltage_v);
        delivered.voltage_v
    }

    /// Change of the charge while a step is driven as warm as the motors are [1/s]; `None` where it cannot be driven.
    pub(crate) fn charge_per_s(&mut self, step: &Step) -> Option<f64> {
        let (power, standing_w, hidden_w) = self.power(step, self.out.heat.map(|h| h.winding_c))?;
        let drawn_w = standing_w + self.drives_w(&power, standing_w) + hidden_w;
        Some(self.chance.pack.charge_per_s(self.charge, drawn_w))
    }

    /// What drives draw, with what the model says too little [W].
    fn drives_w(&self, power: &Power, standing_w: f64) -> f64 {
        let drives_w = power.bus_w - standing_w;
        drives_w + self.chance.model_error * drives_w.abs()
    }

    /// The power on the ground as it may be, how much of it is hotel load and electronics, and what hidden relief adds to it [W].
    fn power(&mut self, step: &Step, winding_c: Sides<f64>) -> Option<(Power, f64, f64)> {
        let kind = &self.journey.kinds[step.kind];
        let stale = |(at_c, _): &(Sides<f64>, Manoeuvre)| {
            (at_c.left - winding_c.left).abs() > STALE_K || (at_c.right - winding_c.right).abs() > STALE_K
        };
        let ready = &mut self.ready[step.kind];
        if ready.as_ref().is_none_or(stale) {
            let robot = &self.chance.robot;
            let surface = robot.surfaces.get(&self.journey.surfaces[kind.surface])?;
            let manoeuvre = Manoeuvre::new(self.journey.model, robot, surface, kind.motion, winding_c);
            *ready = Some((winding_c, manoeuvre));
        }
        let (_, manoeuvre) = ready.as_ref()?;
        let facing = if kind.motion.speed_mps < 0.0 { -1.0 } else { 1.0 };
        let error = if step.moves { facing * self.chance.grade_error(step.middle_m) } else { 0.0 };
        let grade = Grade { along: step.grade.along + error, ..step.grade };
        let power = manoeuvre.power_on_grade(grade, Acceleration::NONE);
        let hidden_w = self.chance.hidden_w(step, manoeuvre, grade);
        Some((power, manoeuvre.kernel().standing_w, hidden_w))
    }

    /// What a sagging voltage does to the drives: less speed, so that more time passes, or not enough force.
    fn sag(&mut self, power: &Power, step: &Step, standing_w: f64, voltage_v: f64) {
        let robot = &self.chance.robot;
        let share = self.chance.pack.motor_share(voltage_v);
        let fastest_mps = self.journey.kinds[step.kind].motion.rim_speeds_mps.map(f64::abs);
        let fastest_mps = fastest_mps.left.max(fastest_mps.right);
        let left_mps = share * robot.max_wheel_speed_mps;
        if fastest_mps > left_mps {
            let longer_s = step.duration_s * (fastest_mps / left_mps - 1.0);
            self.deliver(standing_w, longer_s);
        }
        let force_n = power.force_n.left.abs().max(power.force_n.right.abs());
        if robot.limits.max_side_force_n.is_some_and(|most_n| force_n > share * most_n) {
            self.out.stalled.get_or_insert(Stall::Force);
        }
        if self.chance.pack.is_cut_off(voltage_v) {
            self.out.stalled.get_or_insert(Stall::CutOff);
        }
    }

    fn stay(&mut self, stop: &Stop) -> f64 {
        let hotel_w = self.chance.robot.hotel_power_w;
        let (duration_s, power_w) = match *stop {
            Stop::Work { duration_s, power_w } => (duration_s, hotel_w + power_w),
            Stop::Charge { level, power_w } => {
                match self.chance.pack.charging_time_s(self.charge.max(0.0), level, power_w) {
                    Some(duration_s) => (duration_s, -power_w),
                    None => {
                        self.out.stalled.get_or_insert(Stall::Charger);
                        (0.0, 0.0)
                    }
                }
            }
        };
        self.cool(duration_s);
        let before = self.out;
        let delivered = self.deliver(power_w, duration_s);
        if let Stop::Charge { level, .. } = stop {
            self.out = Outcome {
                energy_j: before.energy_j,
                refused_j: before.refused_j,
                charged_j: before.charged_j - delivered.drawn_j,
                ..self.out
            };
            // Who charges starts anew: what was missing before is kept.
            self.below_j = None;
            if self.out.stalled != Some(Stall::Charger) {
                self.charge = self.charge.max(*level);
            }
        }
        delivered.voltage_v
    }

    /// Motors at rest.
    fn cool(&mut self, duration_s: f64) {
        for motor in [&mut self.out.heat.left, &mut self.out.heat.right] {
            motor.advance(&self.thermal, 0.0, 0.0, self.conditions.ambient_c, duration_s);
        }
    }

    fn deliver(&mut self, power_w: f64, duration_s: f64) -> Delivery {
        let delivered = self.chance.pack.deliver(self.charge, power_w, duration_s);
        self.charge = delivered.charge;
        let out = &mut self.out;
        out.energy_j += delivered.drawn_j;
        out.refused_j += delivered.refused_j;
        out.duration_s += duration_s;
        out.least_voltage_v = out.least_voltage_v.min(delivered.voltage_v);
        if delivered.charge < self.conditions.reserve {
            // Within this part the charge crossed the reserve; what lies before is not missing.
            let crossed_j = *self.below_j.get_or_insert_with(|| {
                let part = (out.least_charge.max(self.conditions.reserve) - self.conditions.reserve)
                    / (out.least_charge - delivered.charge).max(1e-12);
                out.energy_j - delivered.drawn_j * (1.0 - part.clamp(0.0, 1.0))
            });
            if delivered.charge < out.least_charge {
                out.missing_j = out.missing_j.max(out.energy_j - crossed_j).max(f64::MIN_POSITIVE);
            }
        }
        out.least_charge = out.least_charge.min(delivered.charge);
        delivered
    }
}
