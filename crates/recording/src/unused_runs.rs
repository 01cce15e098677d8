//! Runs that no model can use, because they lack a channel that other runs have.

use crate::{
    Channel, ReadingReport, Recording,
    report::{Suspicion, SuspicionKind as Kind},
};

impl Recording {
    /// Runs of which every row lacks a channel that other runs have and that is needed where it is there: wheel speeds, power in the
    /// recording's form, pitch and roll. Each comes with those channels.
    pub fn unused_runs(&self) -> Vec<(usize, Vec<Channel>)> {
        let power = self.power_form().map(|form| form.channels()).into_iter().flatten();
        let mut needed: Vec<Channel> =
            [Channel::LeftSpeed, Channel::RightSpeed, Channel::Pitch, Channel::Roll]
                .into_iter()
                .chain(power)
                .collect();
        needed.dedup();
        let lacks = |run: usize, channel: Channel| {
            let values = self.channel(channel).and_then(|values| values.get(self.runs[run].rows.clone()));
            values.is_some_and(|values| values.iter().all(|value| value.is_nan()))
        };
        let lacking = |run: usize| needed.iter().copied().filter(|channel| lacks(run, *channel)).collect();
        let unused = |(_, lacking): &(usize, Vec<Channel>)| !lacking.is_empty();
        (0..self.runs.len()).map(|run| (run, lacking(run))).filter(unused).collect()
    }
}

/// Tells in the reports of files whose recordings were put behind one another which of their runs are left out, and why.
pub(crate) fn tell_unused_runs(joined: &Recording, reports: &mut [ReadingReport]) {
    let own = |(file, report): (usize, &ReadingReport)| -> Vec<(usize, String)> {
        report.runs.iter().map(|run| (file, run.run.clone())).collect()
    };
    let runs: Vec<(usize, String)> = reports.iter().enumerate().flat_map(own).collect();
    for (run, lacking) in joined.unused_runs() {
        let (Some((file, own_name)), Some(&channel)) = (runs.get(run), lacking.first()) else { continue };
        let file = *file;
        let is_told = |doubt: &Suspicion| {
            doubt.run.as_ref() == Some(own_name) && doubt.channel == channel && doubt.kind == Kind::Sparse
        };
        if reports.get(file).is_none_or(|report| report.suspicions.iter().any(is_told)) {
            continue;
        }
        let names: Vec<&str> = lacking.iter().map(|channel| channel.name()).collect();
        let gives = |report: &&ReadingReport| report.channels.iter().any(|used| used.channel == channel);
        let other = reports.iter().find(gives).map_or_else(String::new, |report| report.source.clone());
        let statement = format!(
            "this run is left out: it has no {}, as other runs have ({other}); give runs with the same channels, or this one by itself",
            names.join(", ")
        );
        let run = joined.runs.get(run).map(|run| run.name.clone());
        if let Some(report) = reports.get_mut(file) {
            report.suspicions.push(Suspicion { channel, run, kind: Kind::Sparse, statement });
        }
    }
}
