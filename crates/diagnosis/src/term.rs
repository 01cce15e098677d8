//! Terms that a discovery may be made of: a scale of power times dimensionless groups of what was recorded.

use model::{Robot, STANDARD_GRAVITY_MPS2};

use crate::{
    average::Average,
    candidates::moments,
    driven::Driven,
    group::{GROUPS, Group},
    series::Series,
    span::Span,
};

/// A power that a term is measured in; it brings the unit, so that all else has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Scale {
    /// m g ∂P/∂F: a force in weights of the robot that holds the side's wheels back, and what it costs beyond the motors.
    Force,
    /// P: what the model predicts.
    Power,
    /// m g ∂P/∂F tanh(Δ/0.05 u_max): a moment against turning, in weights of the robot times its track, which turns round with the turn: it
    /// holds back the side that runs ahead and drives on the other; of each side its own part.
    Moment,
    /// One watt.
    Watt,
}

impl Scale {
    /// All, in the order of their numbers.
    pub(crate) const ALL: [Scale; 4] = [Scale::Force, Scale::Power, Scale::Moment, Scale::Watt];

    /// Its value in one average, for a side that is recorded apart or for both \[W\].
    pub(crate) fn value_w(self, driven: &Driven<'_>, i: usize, is_both: bool) -> f64 {
        let weight_n = driven.robot.mass_kg * STANDARD_GRAVITY_MPS2;
        match self {
            Scale::Force => weight_n * driven.held_back_w_per_n(i, is_both),
            Scale::Moment => weight_n * driven.turned_w_per_n(i, is_both),
            Scale::Power => driven.predicted_w[i],
            Scale::Watt => 1.0,
        }
    }
}

/// On which side a term acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum On {
    Both,
    Left,
    Right,
    /// On the left side, and as much less on the right one.
    Apart,
}

impl On {
    /// How much of it a channel has: 1, as much less, or nothing.
    pub(crate) fn sign(self, channel: usize) -> f64 {
        match (self, channel) {
            (On::Both, 0 | 1) | (On::Left | On::Apart, 0) | (On::Right, 1) => 1.0,
            (On::Apart, 1) => -1.0,
            _ => 0.0,
        }
    }
}

/// A term, its size still open.
#[derive(Clone)]
pub(crate) struct Term {
    pub(crate) scale: Scale,
    pub(crate) groups: Vec<&'static Group>,
    pub(crate) on: On,
    /// Since when.
    pub(crate) span: Span,
}

/// Every term of at most two groups that acts all the time, and of at most one that does so from one of some times on, on the sides that
/// were recorded apart.
fn all(channels: usize, from: &[Span]) -> Vec<Term> {
    let sides: &[On] = if channels == 2 { &[On::Both, On::Left, On::Right, On::Apart] } else { &[On::Both] };
    let mut products: Vec<Vec<&'static Group>> = vec![Vec::new()];
    for (i, one) in GROUPS.iter().enumerate() {
        products.push(vec![one]);
        // Two groups of one quantity make another group of it, not another dependence.
        let others = GROUPS[i + 1..].iter().filter(|other| other.quantity.0 != one.quantity.0);
        products.extend(others.map(|other| vec![one, other]));
    }
    let mut terms = Vec::new();
    for scale in [Scale::Force, Scale::Moment, Scale::Power, Scale::Watt] {
        // A moment acts on both sides, on each its own way.
        let sides = if scale == Scale::Moment { &sides[..1] } else { sides };
        for groups in &products {
            let from = if groups.len() > 1 { &[] } else { from };
            for span in [Span::ALL].iter().chain(from) {
                terms.extend(sides.iter().map(|on| Term {
                    scale,
                    groups: groups.clone(),
                    on: *on,
                    span: *span,
                }));
            }
        }
    }
    terms
}

/// All of which drives tell anything, from the times that are tried of mechanisms on, and those from which some act.
pub(crate) fn of_drives(
    series: &Series,
    robot: &Robot,
    of_mechanisms: impl Iterator<Item = Span>,
) -> Vec<Term> {
    let mut from = moments(&series.timeline());
    from.extend(of_mechanisms.filter(|span| matches!(span, Span::From { .. })));
    let mut terms = all(series.channels(), &from);
    terms.retain(|term| term.is_reached(series, robot));
    terms
}

impl Term {
    /// Its value in every average of power under suspicion, 0 in the others \[W\].
    pub(crate) fn column(&self, driven: &Driven<'_>) -> Vec<f64> {
        let all = self.everywhere(driven).into_iter().zip(driven.averages);
        all.map(|(value, a)| if a.suspect { value } else { 0.0 }).collect()
    }

    /// What of it models may miss of a robot in order: how it goes with driving.
    pub(crate) fn of_driving(&self) -> Term {
        let groups = self.groups.iter().copied().filter(|group| group.is_of_driving()).collect();
        Term { groups, ..self.clone() }
    }

    /// Whether it goes with where the robot heads.
    pub(crate) fn is_of_heading(&self) -> bool {
        self.groups.iter().any(|group| group.is_of_heading())
    }

    /// Its value in every average of power, under suspicion or not \[W\].
    pub(crate) fn everywhere(&self, driven: &Driven<'_>) -> Vec<f64> {
        let fastest_mps = driven.robot.max_wheel_speed_mps;
        let is_both = driven.averages.iter().all(|a| a.channel != 1);
        let value = |(i, a): (usize, &Average)| {
            let sign = self.on.sign(a.channel);
            if !a.is_in(self.span) || sign == 0.0 {
                return 0.0;
            }
            let since = a.since(self.span);
            let groups = self.groups.iter().map(|group| (group.value)(&since, fastest_mps));
            sign * self.scale.value_w(driven, i, is_both) * groups.product::<f64>()
        };
        driven.averages.iter().enumerate().map(value).collect()
    }

    /// Whether another is the same but for the side on which it acts.
    pub(crate) fn is_but_for_sides(&self, other: &Term) -> bool {
        let is_same = |(one, other): (&&Group, &&Group)| one.symbol == other.symbol;
        self.scale == other.scale
            && self.span == other.span
            && self.groups.len() == other.groups.len()
            && self.groups.iter().zip(&other.groups).all(is_same)
    }

    /// Whether drives under suspicion tell anything of it.
    pub(crate) fn is_reached(&self, series: &Series, robot: &Robot) -> bool {
        self.groups.iter().all(|group| group.is_reached(&series.averages, robot.max_wheel_speed_mps))
    }

    /// It times one more group each, of another quantity; none of what has two.
    pub(crate) fn with_one_more(&self) -> Vec<Term> {
        let is_other =
            |more: &&'static Group| self.groups.iter().all(|one| one.quantity.0 != more.quantity.0);
        let more = GROUPS.iter().filter(is_other).filter(|_| self.groups.len() < 2);
        more.map(|more| Term { groups: [&self.groups[..], &[more]].concat(), ..self.clone() }).collect()
    }

    /// What is chosen to have it: its size, each group, the side, and since when it acts, which counts twice, as one of many times.
    pub(crate) fn choices(&self) -> usize {
        1 + self.groups.len() + usize::from(self.on != On::Both) + 2 * self.span.bounds()
    }

    /// Whether it goes with one quantity at most and acts all the time.
    pub(crate) fn is_plain(&self) -> bool {
        self.groups.len() <= 1 && self.span.is_all()
    }

    /// Whether it goes with nothing but the angle that wheels have turned.
    pub(crate) fn is_turn(&self) -> bool {
        self.scale == Scale::Force
            && self.on == On::Both
            && self.span.is_all()
            && !self.groups.is_empty()
            && self.groups.iter().all(|group| group.is_turn())
    }

    /// Its right-hand side, as `c · m g ∂P/∂F · |tan φ|`, with what stands in it.
    pub(crate) fn equation(&self) -> String {
        let scale = match self.scale {
            Scale::Force => "m g ∂P/∂F",
            Scale::Moment => "m g ∂P/∂F tanh(|Δ|/0.05 u_max)",
            Scale::Power => "P",
            Scale::Watt => "1 W",
        };
        let mut text = format!("c · {scale}");
        for group in &self.groups {
            text += " · ";
            text += group.symbol;
        }
        text += match self.on {
            On::Both => "",
            On::Left => " on the left side",
            On::Right => " on the right side",
            On::Apart => " on the left side, as much less on the right side",
        };
        match self.scale {
            Scale::Force | Scale::Moment => text + ", ∂P/∂F the power that one newton at the rim costs",
            Scale::Power | Scale::Watt => text,
        }
    }

    /// What it grows with, in words.
    pub(crate) fn words(&self) -> String {
        let scale = match self.scale {
            Scale::Force => "a force in the drive",
            Scale::Moment => "a moment against turning",
            Scale::Power => "a share of the power",
            Scale::Watt => "a power",
        };
        let side = match self.on {
            On::Both => "",
            On::Left => " of the left side",
            On::Right => " of the right side",
            On::Apart => " of the left side, as much less of the right side,",
        };
        let groups: Vec<&str> = self.groups.iter().map(|group| group.words).collect();
        match groups[..] {
            [] => format!("{scale}{side} that is always there"),
            _ => format!("{scale}{side} that goes with {}", groups.join(" and with ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Input;

    fn average(channel: usize, roll_rad: f64) -> Average {
        let input = Input { rim_mps: -0.5, speed_mps: 0.4, roll_rad, height_m: f64::NAN, ..Input::default() };
        Average { channel, run: 0, suspect: true, t_s: 60.0, input }
    }

    /// A term's column where 50 W are predicted and motors lose nothing.
    fn column(term: &Term, averages: &[Average]) -> Vec<f64> {
        let robot = model::builtin::husky_a200();
        let rim = |channel: usize| {
            move |a: &Average| if a.channel == channel { a.input.rim_mps.abs() } else { 0.0 }
        };
        let rims_w_per_n = [0, 1].map(|channel| averages.iter().map(rim(channel)).collect());
        let predicted_w = vec![50.0; averages.len()];
        term.column(&Driven {
            robot: &robot,
            averages,
            predicted_w: &predicted_w,
            rims_w_per_n: &rims_w_per_n,
        })
    }

    #[test]
    fn a_force_on_side_slopes_has_its_weight_its_speed_and_its_side() {
        let across = GROUPS.iter().find(|group| group.symbol == "|tan φ|").unwrap();
        let term = Term { scale: Scale::Force, groups: vec![across], on: On::Left, span: Span::ALL };
        let column = column(&term, &[average(0, -0.1), average(1, -0.1)]);
        assert!(
            (column[0] - 90.0 * STANDARD_GRAVITY_MPS2 * 0.5 * 0.1f64.tan()).abs() < 1e-9 && column[1] == 0.0
        );
        assert_eq!(
            term.equation(),
            "c · m g ∂P/∂F · |tan φ| on the left side, ∂P/∂F the power that one newton at the rim costs"
        );
        assert!(term.words().contains("slope across the way"));
    }

    #[test]
    fn what_fades_does_so_from_when_it_set_in_and_is_nothing_before() {
        let fading = GROUPS.iter().find(|group| group.symbol == "e^(−t/60 s)").unwrap();
        let span = Span::From { run: 0, t_s: 40.0 };
        let term = Term { scale: Scale::Watt, groups: vec![fading], on: On::Apart, span };
        let mut averages = [average(0, 0.0), average(1, 0.0), average(0, 0.0)];
        averages[2].t_s = 39.0;
        let column = column(&term, &averages);
        let faded = (-20.0f64 / 60.0).exp();
        assert_eq!(column, [faded, -faded, 0.0]);
    }

    #[test]
    fn every_term_is_finite_even_where_heading_and_height_are_unknown() {
        let unknown =
            Average { input: Input { heading_rad: f64::NAN, ..average(0, 0.1).input }, ..average(0, 0.1) };
        for term in all(2, &[Span::EachDrive(30.0)]) {
            let column = column(&term, &[unknown]);
            assert!(column[0].is_finite(), "{}", term.equation());
        }
    }

    #[test]
    fn no_term_has_two_groups_of_one_quantity_and_none_stands_twice() {
        let mut equations: Vec<String> = all(2, &[]).iter().map(Term::equation).collect();
        let count = equations.len();
        equations.sort();
        equations.dedup();
        assert_eq!(equations.len(), count);
        assert!(all(1, &[]).iter().all(|term| term.on == On::Both && term.groups.len() <= 2));
    }
}
