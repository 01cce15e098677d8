//! When and where a mechanism acts in the drives under suspicion.

use model::mechanism::Mechanism;

use crate::observe::region::Region;

/// The part of the drives in which a mechanism acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Span {
    /// From so long after the beginning of every drive on [s].
    EachDrive(f64),
    /// From so long after the beginning of one drive on, and all through those that follow it.
    From {
        /// Which of the drives under suspicion, counted from 0 in the order in which they were given.
        run: usize,
        /// Time since it began [s].
        t_s: f64,
    },
    /// All through the drives before one, and until so long after its beginning.
    Until {
        /// As in [`Span::From`].
        run: usize,
        /// As in [`Span::From`].
        t_s: f64,
    },
    /// Wherever drives went through a part of the ground.
    Within(Region),
}

impl Span {
    /// All of all drives.
    pub const ALL: Span = Span::EachDrive(0.0);

    /// Whether this is all of all drives.
    #[must_use]
    pub fn is_all(self) -> bool {
        self == Span::ALL
    }

    /// Whether it acts so long after the beginning of a drive, at a position; where that is unknown, in no region [m].
    #[inline]
    #[must_use]
    pub fn acts(self, run: usize, t_s: f64, position_m: [f64; 2]) -> bool {
        match self {
            Span::EachDrive(from_s) => t_s >= from_s,
            Span::From { run: first, t_s: from_s } => is_after((run, t_s), (first, from_s)),
            Span::Until { run: last, t_s: until_s } => !is_after((run, t_s), (last, until_s)),
            Span::Within(region) => region.contains(position_m),
        }
    }

    /// It as a person would say it, with the names of the drives.
    #[must_use]
    pub fn words(self, names: &[String]) -> String {
        let name = |run: usize| names.get(run).map_or("?", String::as_str);
        match self {
            Span::EachDrive(s) | Span::From { t_s: s, .. } if names.len() < 2 => {
                format!("from about {s:.0} s on")
            }
            Span::Until { t_s, .. } if names.len() < 2 => format!("until about {t_s:.0} s"),
            Span::EachDrive(from_s) => format!("from about {from_s:.0} s of each drive on"),
            Span::From { run, t_s: 0.0 } => format!("from drive {} on", name(run)),
            Span::From { run, t_s } => format!("from about {t_s:.0} s of drive {} on", name(run)),
            Span::Until { run, t_s: 0.0 } => format!("until drive {}", name(run)),
            Span::Until { run, t_s } => format!("until about {t_s:.0} s of drive {}", name(run)),
            Span::Within(region) => region.words(),
        }
    }
}

fn is_after((run, t_s): (usize, f64), (first, from_s): (usize, f64)) -> bool {
    run > first || run == first && t_s >= from_s
}

/// A mechanism at some values from some time on.
#[derive(Clone)]
pub struct Applied {
    /// Which.
    pub mechanism: &'static dyn Mechanism,
    /// Values of its parameters.
    pub values: Vec<f64>,
    /// When it acts in the drives under suspicion.
    pub span: Span,
}

impl std::fmt::Debug for Applied {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?} {:?}", self.mechanism.name(), self.values, self.span)
    }
}

/// The drives under suspicion, one behind the other.
pub(crate) struct Timeline {
    /// Beginnings of the drives, and the end of the last, in seconds driven.
    begins_s: Vec<f64>,
}

impl Timeline {
    /// Of drives of which some seconds are known, each by its drive and its middle, in time since the drive began [s].
    pub(crate) fn of(drives: usize, seconds: impl Iterator<Item = (usize, f64)>) -> Self {
        let mut durations_s = vec![0.0; drives];
        for (run, t_s) in seconds {
            durations_s[run] = f64::max(durations_s[run], t_s + 0.5);
        }
        Timeline::new(durations_s)
    }

    /// Of drives that took so long [s].
    fn new(durations_s: impl IntoIterator<Item = f64>) -> Self {
        let mut begins_s = vec![0.0];
        let mut driven_s = 0.0;
        for duration_s in durations_s {
            driven_s += duration_s;
            begins_s.push(driven_s);
        }
        Timeline { begins_s }
    }

    /// Time driven until a span begins or ends; for one in each drive, that in the first, for a place none [s].
    pub(crate) fn driven_s(&self, span: Span) -> f64 {
        match span {
            Span::EachDrive(from_s) => from_s,
            Span::Within(_) => 0.0,
            Span::From { run, t_s } | Span::Until { run, t_s } => {
                self.begins_s[run.min(self.begins_s.len() - 1)] + t_s
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_set_in_during_a_drive_acts_in_all_that_follow_and_in_none_before() {
        let (from, until) = (Span::From { run: 1, t_s: 30.0 }, Span::Until { run: 1, t_s: 30.0 });
        let acts = |span: Span, run, t_s| span.acts(run, t_s, [0.0; 2]);
        let moments = [(0, 500.0), (1, 29.0), (1, 30.0), (2, 0.0)];
        assert!(moments.iter().all(|(run, t_s)| acts(until, *run, *t_s) != acts(from, *run, *t_s)));
        assert!(!acts(from, 0, 500.0) && !acts(from, 1, 29.0) && acts(from, 1, 30.0) && acts(from, 2, 0.0));
        let each = Span::EachDrive(30.0);
        assert!(acts(each, 0, 30.0) && !acts(each, 2, 29.0) && acts(Span::ALL, 0, 0.0));
    }

    #[test]
    fn moments_are_said_by_drive_and_counted_in_time_driven() {
        let line = Timeline::new([100.0, 50.0, 80.0]);
        let (border, later) = (Span::From { run: 1, t_s: 0.0 }, Span::From { run: 2, t_s: 20.0 });
        assert_eq!([line.driven_s(border), line.driven_s(later)], [100.0, 170.0]);
        let names: Vec<String> = ["a", "b", "c"].map(str::to_owned).into();
        assert_eq!(border.words(&names), "from drive b on");
        assert_eq!(later.words(&names), "from about 20 s of drive c on");
        assert_eq!(Span::EachDrive(20.0).words(&names), "from about 20 s of each drive on");
        assert_eq!(Span::Until { run: 1, t_s: 0.0 }.words(&names), "until drive b");
        assert_eq!(Span::Until { run: 2, t_s: 20.0 }.words(&names), "until about 20 s of drive c");
        assert_eq!(Span::Until { run: 0, t_s: 20.0 }.words(&names[..1]), "until about 20 s");
        assert_eq!(Span::EachDrive(20.0).words(&names[..1]), "from about 20 s on");
    }
}
