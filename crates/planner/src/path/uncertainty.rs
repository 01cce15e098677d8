//! How far a path's energy may be off, given what is known of the robot.

use std::collections::{HashMap, hash_map::Entry};

use model::{
    Acceleration, Grade, Manoeuvre, Motion, PowerModel, Robot, Sides,
    robot::{NORMAL_95, interval},
};

use crate::{
    lattice::{graph::Lattice, ground_class::surface_names},
    path::{
        coarse::{HiddenRelief, hidden_relief},
        route::Route,
    },
    patience::{Patience, work},
};

/// Steps whose interval is worked out whether patience is over or not, so that an answer that is there is not lost.
const STEPS_AT_LEAST: usize = 1 << 14;

/// Central 95 % interval of a path's energy [J]; `None` where patience ends first on a long path.
///
/// Parameters are independent. The energy is computed anew with each at both ends of its own interval; [`interval`] puts them
/// together with the least that the path can take ([`Replay::least_j`]), so that no doubt makes it less: where nothing is gained,
/// no less than 0. Cells far coarser than the robot hide ups and downs, which are one more doubt ([`Replay::over_relief_j`]).
pub(crate) fn energy_interval_j(route: &Route, lattice: &Lattice, patience: &Patience) -> Option<[f64; 2]> {
    let robot = &lattice.robot;
    let forever = Patience::default();
    let patience = if route.steps.len() <= STEPS_AT_LEAST { &forever } else { patience };
    let replay = Replay::new(route, lattice, patience);
    let energy_j = route.total.energy_j;
    let least_j = replay.least_j(robot)?;
    let mut ends_j = Vec::new();
    for parameter in robot.uncertain() {
        let [upper, lower] = parameter.ends(robot);
        ends_j.push([replay.energy_j(&upper)?, replay.energy_j(&lower)?]);
    }
    let hidden = hidden_relief(route, lattice);
    if !hidden.is_empty() {
        ends_j.push([replay.over_relief_j(robot, &hidden)?, energy_j]);
    }
    Some(interval(energy_j, least_j, &ends_j))
}

/// The steps of a path, ready to be driven by other robots: power is prepared once for each of the few motions and surfaces.
struct Replay<'a> {
    model: PowerModel,
    surfaces: Vec<String>,
    patience: &'a Patience,
    motor_c: Sides<f64>,
    /// Motions on surfaces.
    kinds: Vec<(Motion, usize)>,
    /// Kind, grade and time [s] of each step.
    steps: Vec<(usize, Grade<f64>, f64)>,
}

impl<'a> Replay<'a> {
    fn new(route: &Route, lattice: &Lattice, patience: &'a Patience) -> Self {
        let mut kinds = Vec::new();
        let mut known = HashMap::new();
        let mut kind_of = |motion: Motion, surface: usize| {
            let Motion { speed_mps, yaw_rate_radps, rim_speeds_mps: rim, heading_rad } = motion;
            let speeds = [speed_mps, yaw_rate_radps, rim.left, rim.right].map(f64::to_bits);
            match known.entry((speeds, heading_rad.map(f64::to_bits), surface)) {
                Entry::Occupied(kind) => *kind.get(),
                Entry::Vacant(new) => {
                    kinds.push((motion, surface));
                    *new.insert(kinds.len() - 1)
                }
            }
        };
        let steps = route.steps.iter();
        let steps = steps.map(|s| (kind_of(s.motion, s.surface), s.grade, s.duration_s)).collect();
        let (model, motor_c) = (lattice.settings.power_model, lattice.settings.motor_temperature_c);
        let motor_c = Sides::both(motor_c);
        Replay { model, surfaces: surface_names(lattice), patience, motor_c, kinds, steps }
    }

    /// Energy of the same steps with another robot; `None` where patience ends first [J].
    fn energy_j(&self, robot: &Robot) -> Option<f64> {
        self.sum_j(robot, |manoeuvre, grade| manoeuvre.power_on_grade(grade, Acceleration::NONE).bus_w)
    }

    /// The least that the steps can take, whatever the doubt: standing loads at the lower end of their interval, and everything back that descents hold, of the mass
    /// at the upper end of its interval and through gears without losses [J].
    fn least_j(&self, robot: &Robot) -> Option<f64> {
        let mut heavy = robot.clone();
        heavy.mass_kg *= (NORMAL_95 * robot.uncertainty.mass_kg).exp();
        heavy.hotel_power_w /= (NORMAL_95 * robot.uncertainty.hotel_power_w).exp();
        (heavy.motors.left.k2, heavy.motors.right.k2) = (1.0, 1.0);
        self.sum_j(&heavy, |manoeuvre, grade| {
            let kernel = manoeuvre.kernel();
            let [up_w, down_w] = kernel.floor_w;
            let held_w = grade.along * if grade.along >= 0.0 { up_w } else { down_w };
            kernel.standing_w + held_w.min(0.0)
        })
    }

    /// Upper end of the energy over relief that cells hide ([`HiddenRelief::added_w`]) [J]. Each cell may add more or less, by as much
    /// as it adds on average, independently of the others.
    fn over_relief_j(&self, robot: &Robot, hidden: &[HiddenRelief]) -> Option<f64> {
        let mut added_j: HashMap<usize, f64> = HashMap::new();
        let mut energy_j = 0.0;
        self.each(robot, |step, manoeuvre, grade, duration_s| {
            energy_j += manoeuvre.power_on_grade(grade, Acceleration::NONE).bus_w * duration_s;
            if let Some(hidden) = hidden.get(step) {
                *added_j.entry(hidden.cell).or_default() += hidden.added_w(manoeuvre, grade) * duration_s;
            }
        })?;
        let (sum_j, squares) =
            added_j.values().fold((0.0, 0.0), |(sum, squares), j| (sum + j, squares + j * j));
        Some(energy_j + sum_j + NORMAL_95 * f64::sqrt(squares))
    }

    /// Sum of a power over the time of all steps [J].
    fn sum_j(&self, robot: &Robot, power_w: impl Fn(&Manoeuvre, Grade<f64>) -> f64) -> Option<f64> {
        let mut sum_j = 0.0;
        self.each(robot, |_, manoeuvre, grade, duration_s| sum_j += power_w(manoeuvre, grade) * duration_s)?;
        Some(sum_j)
    }

    /// Visits all steps, as position, manoeuvre, grade and time [s]; `None` where patience ends first.
    fn each(&self, robot: &Robot, mut visit: impl FnMut(usize, &Manoeuvre, Grade<f64>, f64)) -> Option<()> {
        let prepared = self.kinds.iter().map(|(motion, surface)| {
            let surface = robot.surfaces.get(self.surfaces.get(*surface)?)?;
            Some(Manoeuvre::new(self.model, robot, surface, *motion, self.motor_c))
        });
        let prepared: Vec<Option<Manoeuvre>> = prepared.collect();
        let mut pacer = self.patience.pacer();
        for (step, (kind, grade, duration_s)) in self.steps.iter().enumerate() {
            pacer.after(work::STATE)?;
            if let Some(Some(manoeuvre)) = prepared.get(*kind) {
                visit(step, manoeuvre, *grade, *duration_s);
            }
        }
        Some(())
    }
}
