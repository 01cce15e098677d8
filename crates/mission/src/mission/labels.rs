//! The best order under limits of charge and time, with chargers on the way where they help.

use std::{cmp::Reverse, collections::BinaryHeap};

use super::graph::{Network, Way};
use crate::{Error, journey::Stop, meter::Meter, pack::Pack};

/// Limits and what stops take.
pub(crate) struct Limits<'a> {
    pub(crate) pack: &'a Pack,
    pub(crate) hotel_w: f64,
    pub(crate) charge: f64,
    pub(crate) reserve: f64,
    pub(crate) deadline_s: f64,
    /// Factor on the charge of ways, above 1 where driving the plan showed that they take more.
    pub(crate) charge_factor: f64,
}

/// A partial mission.
#[derive(Clone, Copy, Debug)]
struct Label {
    visited: u64,
    node: usize,
    energy_j: f64,
    time_s: f64,
    charge: f64,
    parent: usize,
}

/// Most partial missions that are kept.
const MOST_LABELS: usize = 2_000_000;
const NONE: usize = usize::MAX;
/// Work of a stop beside that of comparing two partial missions: charging may have as many stretches as a charge has thousandths.
const WORK_PER_STOP: usize = 200;

/// The nodes, in order, of the mission that draws least energy within the limits, chargers included; `None` where there is none,
/// or none was found before memory ended.
///
/// Label setting over sets of waypoints (Desrochers & Soumis 1988): a partial mission is dropped where another one with the same
/// waypoints at the same place has drawn no more, is no later and has no less charge. `fixed` allows the waypoints' own order
/// alone. Ways are those of the network, whose headings join nearly, so what is found is driven before it is believed.
///
/// # Errors
/// Patience that ends first.
pub(crate) fn cheapest_within(
    network: &Network,
    limits: &Limits<'_>,
    fixed: Option<&[usize]>,
    meter: &mut Meter<'_>,
) -> Result<Option<Vec<usize>>, Error> {
    let all = (1_u64 << network.waypoints) - 1;
    // Descents may return energy; the most that one way can return keeps keys in order.
    let gain_j = (0..network.chargers().end)
        .flat_map(|a| (0..network.chargers().end).filter_map(move |b| network.way(a, b)))
        .map(|way| way.energy_j)
        .fold(0.0, f64::min);
    let mut labels =
        vec![Label { visited: 0, node: 0, energy_j: 0.0, time_s: 0.0, charge: limits.charge, parent: NONE }];
    let mut fronts = std::collections::HashMap::<(u64, usize), Vec<usize>>::new();
    let mut queue = BinaryHeap::from([Reverse((Key(0.0), 0_usize))]);
    while let Some(Reverse((_, at))) = queue.pop() {
        if labels.len() > MOST_LABELS {
            return Ok(None);
        }
        let label = labels[at];
        let done = label.visited == all && network.home().is_none_or(|home| home == label.node);
        if done {
            return Ok(Some(trace(&labels, at)));
        }
        for next in successors(network, &label, all, fixed) {
            let Some(way) = network.way(label.node, next) else { continue };
            meter.spend(WORK_PER_STOP)?;
            let Some(arrived) = extended(network, limits, &label, at, next, way) else { continue };
            let front = fronts.entry((arrived.visited, next)).or_default();
            meter.spend(front.len())?;
            let beaten = |other: &usize| dominates(&labels[*other], &arrived);
            if front.iter().any(beaten) {
                continue;
            }
            front.retain(|other| !dominates(&arrived, &labels[*other]));
            let index = labels.len();
            front.push(index);
            let legs_left = (all & !arrived.visited).count_ones() + 1;
            queue.push(Reverse((Key(arrived.energy_j + gain_j * f64::from(legs_left)), index)));
            labels.push(arrived);
        }
    }
    Ok(None)
}

fn successors(network: &Network, label: &Label, all: u64, fixed: Option<&[usize]>) -> Vec<usize> {
    let left = |waypoint: &usize| label.visited >> (waypoint - 1) & 1 == 0;
    let mut next: Vec<usize> = match fixed {
        Some(order) => order.iter().copied().find(|waypoint| left(waypoint)).into_iter().collect(),
        None => (1..=network.waypoints).filter(left).collect(),
    };
    if label.visited == all {
        next.extend(network.home());
    }
    next.extend(network.chargers().filter(|charger| *charger != label.node));
    next
}

/// The partial mission one stop further; `None` where a limit forbids it.
fn extended(
    network: &Network,
    limits: &Limits<'_>,
    label: &Label,
    parent: usize,
    next: usize,
    way: &Way,
) -> Option<Label> {
    let mut charge = (label.charge - way.charge * limits.charge_factor.powf(way.charge.signum())).min(1.0);
    let (mut energy_j, mut time_s) = (label.energy_j + way.energy_j, label.time_s + way.duration_s);
    if charge < limits.reserve {
        return None;
    }
    for stop in &network.node(next).site.stops {
        match *stop {
            Stop::Work { duration_s, power_w } => {
                let delivered = limits.pack.deliver(charge, limits.hotel_w + power_w, duration_s);
                (charge, energy_j) = (delivered.charge, energy_j + delivered.drawn_j);
                time_s += duration_s;
            }
            Stop::Charge { level, power_w } => {
                time_s += limits.pack.charging_time_s(charge, level, power_w)?;
                charge = charge.max(level);
            }
        }
    }
    if charge < limits.reserve || time_s > limits.deadline_s {
        return None;
    }
    let visited = match next {
        waypoint if (1..=network.waypoints).contains(&waypoint) => label.visited | 1 << (waypoint - 1),
        _ => label.visited,
    };
    Some(Label { visited, node: next, energy_j, time_s, charge, parent })
}

fn dominates(a: &Label, b: &Label) -> bool {
    a.energy_j <= b.energy_j && a.time_s <= b.time_s && a.charge >= b.charge
}

fn trace(labels: &[Label], end: usize) -> Vec<usize> {
    let mut order = Vec::new();
    let mut at = end;
    while at != NONE {
        order.push(labels[at].node);
        at = labels[at].parent;
    }
    order.reverse();
    order
}

/// An energy as a key.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key(f64);

impl Eq for Key {}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
