//! What might be missing: every mechanism, at some of the values that its power does not follow in proportion, from some times on.

use model::{
    Robot,
    mechanism::{self, Kind},
};
use rayon::prelude::*;

use crate::{
    Error,
    as_hard::AsHard,
    meter::Meter,
    off_middle,
    region::regions,
    second_ground::{self, GROUND},
    series::{Applied, Series},
    span::{Span, Timeline},
    visits::Visits,
    weigh::blocks,
};

/// A mechanism with its sensitivities: the change of every prediction per unit of each of its linear parameters.
#[derive(Clone)]
pub(crate) struct Candidate {
    /// The mechanism at a probe.
    pub(crate) applied: Applied,
    /// Parameters that the columns belong to.
    pub(crate) linear: Vec<usize>,
    /// Change of predictions per unit [W].
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Candidate {
    /// Numbers that are fitted for it, those that bound the part of the drives in which it acts included.
    pub(crate) fn numbers(&self) -> usize {
        self.linear.len() + self.applied.span.bounds()
    }

    /// Change of every prediction with values of its linear parameters [W].
    pub(crate) fn effect_w(&self, values: &[f64]) -> Vec<f64> {
        let mut effect_w = vec![0.0; self.columns.first().map_or(0, Vec::len)];
        for (column, value) in self.columns.iter().zip(values) {
            effect_w.iter_mut().zip(column).for_each(|(sum, by)| *sum += by * value);
        }
        effect_w
    }
}

/// Moments at which a mechanism may set in, as shares of the time driven.
const ONSETS: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Beginnings of drives that are tried one by one; of more, the nearest will be found from the shares.
const MOST_BORDERS: usize = 16;
/// Time constants of heat that are tried [s].
const MEMORIES_S: [f64; 6] = [60.0, 180.0, 480.0, 900.0, 1800.0, 3600.0];
/// Range of a value that power does not follow in proportion, where the drives themselves would lead it away: heat that comes
/// and goes within seconds is no heat, but power by another name; and a centre of mass stays on its side of the middle.
pub(crate) fn range(applied: &Applied, robot: &Robot, parameter: usize) -> [f64; 2] {
    match (applied.mechanism.name(), parameter) {
        ("motor_heating", 1) => [MEMORIES_S[0], MEMORIES_S[MEMORIES_S.len() - 1]],
        ("center_of_mass", 0) => off_middle::range_m(applied, robot),
        _ => applied.mechanism.bounds(robot, parameter),
    }
}

/// A mechanism with some of its values moved, within what the robot can have and what drives may tell.
pub(crate) fn moved(applied: &Applied, robot: &Robot, parameters: &[usize], by: &[f64]) -> Applied {
    let mut moved = applied.clone();
    for (&parameter, by) in parameters.iter().zip(by) {
        let [low, high] = range(applied, robot, parameter);
        moved.values[parameter] = (moved.values[parameter] + by).clamp(low, high);
    }
    moved
}

/// Winds that are tried [m/s], in eight directions.
const WINDS_MPS: [f64; 3] = [3.0, 6.0, 10.0];

/// A mechanism with its sensitivities, and the spans in which it may act.
pub(crate) struct Family {
    /// All the time.
    always: Candidate,
    spans: Vec<Span>,
}

impl Family {
    /// Whose it is.
    pub(crate) fn name(&self) -> &'static str {
        self.always.applied.mechanism.name()
    }

    /// Number of its candidates.
    pub(crate) fn count(&self) -> usize {
        self.spans.len()
    }

    /// How many of them always act: one or none.
    pub(crate) fn always_count(&self) -> usize {
        self.spans.iter().filter(|span| span.is_all()).count()
    }

    /// Its candidates, one by one.
    ///
    /// What remembers has no onset but the beginning; all else does from some time on what it would always do.
    pub(crate) fn candidates<'a>(&'a self, series: &'a Series) -> impl Iterator<Item = Candidate> + 'a {
        self.spans.iter().map(|&span| {
            let from = |column: &Vec<f64>| {
                let acts = series.averages.iter().map(|average| average.is_in(span));
                column.iter().zip(acts).map(|(by, acts)| if acts { *by } else { 0.0 }).collect()
            };
            Candidate {
                applied: Applied { span, ..self.always.applied.clone() },
                linear: self.always.linear.clone(),
                columns: self.always.columns.iter().map(from).collect(),
            }
        })
    }
}

/// All candidates beside mechanisms that act already, by mechanism and values that power does not follow in proportion.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn all(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
) -> Result<Vec<Family>, Error> {
    let grounds: Vec<&'static dyn mechanism::Mechanism> =
        series.others(applied).filter(|one| one.name() == GROUND).map(|_| &AsHard as _).collect();
    let probes: Vec<(Applied, Vec<usize>)> = series
        .others(applied)
        .chain(second_ground::second(series, applied))
        .chain(grounds)
        .flat_map(|mechanism| {
            told_grids(series, mechanism)
                .map(move |(values, linear)| (Applied { mechanism, values, span: Span::ALL }, linear))
        })
        .collect();
    let family = |(probe, linear): (Applied, Vec<usize>)| {
        let is_new = |span: &Span| {
            applied.iter().all(|a| a.mechanism.name() != probe.mechanism.name() || a.span != *span)
        };
        let spans = spans(series, probe.mechanism.name()).into_iter();
        let spans = spans.filter(|span| is_new(span) && !stands_in(&probe, span, applied)).collect();
        Ok(Family { always: of(series, robot, applied, predicted_w, probe, linear)?, spans })
    };
    probes.into_par_iter().map(family).collect()
}

/// The sensitivities of one mechanism about a probe whose linear parameters are at nothing.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn of(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
    probe: Applied,
    linear: Vec<usize>,
) -> Result<Candidate, Error> {
    let columns = of_more(series, robot, applied, predicted_w, &probe, &linear)?;
    Ok(Candidate { applied: probe, linear, columns })
}

/// Change of predictions, made with a mechanism as it stands or at nothing, per unit of more of each of its parameters.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn of_more(
    series: &Series,
    robot: &Robot,
    others: &[Applied],
    predicted_w: &[f64],
    standing: &Applied,
    linear: &[usize],
) -> Result<Vec<Vec<f64>>, Error> {
    let mut columns = Vec::new();
    for &parameter in linear {
        // Away from nothing, where what a mechanism does may turn round.
        let by = standing.mechanism.parameters()[parameter].probe.copysign(standing.values[parameter]);
        let mut more = standing.clone();
        more.values[parameter] += by;
        let seen = series.predict(robot, &[others, &[more]].concat())?;
        columns.push(seen.iter().zip(predicted_w).map(|(a, b)| (a - b) / by).collect());
    }
    Ok(columns)
}

/// Whether a load that shifts during a drive would, beside other forces, stand in for drag on one side, as other ground and such a load
/// do together. Beside what is wrong with the measurement alone there is nothing that it could make up for.
fn stands_in(probe: &Applied, span: &Span, beside: &[Applied]) -> bool {
    let acts = |one: &Applied| one.mechanism.kind() == Kind::Physics;
    probe.mechanism.name() == "center_of_mass" && !span.is_all() && beside.iter().any(acts)
}

/// Points of a mechanism's grid that drives may tell from each other: what another meter does shows where both are recorded.
pub(crate) fn told_grids(
    series: &Series,
    mechanism: &'static dyn mechanism::Mechanism,
) -> impl Iterator<Item = (Vec<f64>, Vec<usize>)> {
    let is_all = mechanism.name() != "power_offset" || series.meters.contains(&Meter::Rest);
    grids(mechanism).into_iter().filter(move |(values, _)| is_all || values[1] == 0.0)
}

/// Parameters of a mechanism that acts which power follows in proportion.
pub(crate) fn sizes(applied: &Applied) -> Vec<usize> {
    let linear: Vec<usize> = grids(applied.mechanism).into_iter().flat_map(|(_, linear)| linear).collect();
    (0..applied.values.len()).filter(|i| applied.values[*i] != 0.0 && linear.contains(i)).collect()
}

/// Change of predictions, made with mechanisms that act, per unit of more of each one's sizes.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn of_sizes(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
) -> Result<Vec<Vec<Vec<f64>>>, Error> {
    let of = |which: usize| {
        let (one, others) = apart(applied, which);
        of_more(series, robot, &others, predicted_w, &one, &sizes(&one))
    };
    (0..applied.len()).into_par_iter().map(of).collect()
}

/// One of some mechanisms that act, and the others.
pub(crate) fn apart(applied: &[Applied], which: usize) -> (Applied, Vec<Applied>) {
    let mut others = applied.to_vec();
    (others.remove(which), others)
}

/// Spans in which a mechanism is tried: from the beginning, shares of each drive, and of several drives their beginnings and shares
/// of all the time driven, since what happens to a robot stays with it in the drives that follow.
///
/// Without healthy drives to compare with, what acts all the time looks like what the model itself misses; only what sets in,
/// grows in time or shifts it can then be told.
fn spans(series: &Series, name: &str) -> Vec<Span> {
    if name == "motor_heating" {
        return vec![Span::ALL];
    }
    let mut tried: Vec<Span> = series.has_healthy().then_some(Span::ALL).into_iter().collect();
    let line = series.timeline();
    if line.drives() > 1 {
        let longest_s = series.longest_s();
        tried.extend(ONSETS.map(|share| Span::EachDrive(share * longest_s)));
    }
    tried.extend(moments(&line));
    if is_of_ground(name) {
        tried.extend(moments(&line).into_iter().map(Span::until));
        // Alone, what the model misses on the slopes of one place would pass for its ground.
        if series.has_healthy() {
            let visits = Visits::of(&series.averages, blocks(series));
            let often = regions(&series.averages).into_iter().filter(|region| visits.are_enough(*region));
            tried.extend(often.map(Span::Within));
        }
    }
    tried
}

/// Beginnings of drives, and shares of all the time driven.
pub(crate) fn moments(line: &Timeline) -> Vec<Span> {
    let borders_s = Some(line.borders_s()).filter(|borders_s| borders_s.len() <= MOST_BORDERS).unwrap_or(&[]);
    let shares_s = ONSETS.map(|share| share * line.total_s());
    borders_s.iter().chain(&shares_s).map(|driven_s| line.at(*driven_s)).collect()
}

/// Whether it may end during the drives, or act in some place only: ground is left behind, and come back to.
fn is_of_ground(name: &str) -> bool {
    name == GROUND || name == "soft_soil"
}

/// Values of the parameters that power does not follow in proportion, with the others at nothing.
pub(crate) fn grids(mechanism: &'static dyn mechanism::Mechanism) -> Vec<(Vec<f64>, Vec<usize>)> {
    match mechanism.name() {
        "motor_heating" => MEMORIES_S.iter().map(|tau_s| (vec![0.0, *tau_s], vec![0])).collect(),
        "wind" => {
            let mut winds = vec![(vec![0.0; 3], vec![0])];
            for wind_mps in WINDS_MPS {
                for eighth in 0..8 {
                    let (sin, cos) = (f64::from(eighth) * std::f64::consts::FRAC_PI_4).sin_cos();
                    winds.push((vec![0.0, wind_mps * cos, wind_mps * sin], vec![0]));
                }
            }
            winds
        }
        // To the side alone as well: how far forward it lies can only add.
        "center_of_mass" => vec![
            (vec![0.0; 2], vec![0, 1]),
            (vec![off_middle::BEHIND_M, 0.0], vec![0, 1]),
            (vec![0.0; 2], vec![1]),
        ],
        // What spins carries the robot less far and turns it less; what gives way under pull shows in turns, where wheels pull hardest.
        "wheel_slip" => vec![(vec![0.0; 2], vec![0]), (vec![0.0; 2], vec![1]), (vec![0.0; 2], vec![0, 1])],
        // Where meters of the sides are off, the battery's is off as each of them or right. If it were off by their sum, they would be right as
        // well, and drivers lose so much: of a loss at low duty it was the wrong name.
        "power_offset" => [0.0, -1.0].map(|more| (vec![0.0, more], vec![0])).into(),
        // One side drags; what holds both back alike is the ground.
        "drivetrain_drag" => vec![(vec![0.0; 2], vec![0]), (vec![0.0; 2], vec![1])],
        _ => {
            let count = mechanism.parameters().len();
            vec![(vec![0.0; count], (0..count).collect())]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_that_shifts_stands_in_beside_forces_only_and_one_that_lies_still_never_does() {
        let applied = |name: &str, span: Span| {
            let mechanism = mechanism::by_name(name).unwrap();
            Applied { mechanism, values: vec![0.0; mechanism.parameters().len()], span }
        };
        let shifts = Span::EachDrive(300.0);
        let told = |span: Span, beside: &[&str]| {
            let beside: Vec<Applied> = beside.iter().map(|name| applied(name, Span::ALL)).collect();
            stands_in(&applied("center_of_mass", span), &span, &beside)
        };
        assert!(told(shifts, &["surface_change"]) && told(shifts, &["power_scale", "payload"]));
        assert!(!told(shifts, &["power_scale"]) && !told(shifts, &[]));
        assert!(!told(Span::ALL, &["surface_change"]));
    }
}
