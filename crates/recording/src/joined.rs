//! Tables of one drive, such as wheels in one and power in another, joined on time.

use std::path::{Path, PathBuf};

use crate::{
    Error, Ignored, Labels, Map, Reading, Recording, Repair, Run,
    format::run_name,
    own_clocks::onto_one_clock,
    reading::Part,
    report::{AlignmentReport, ReadingReport},
    watch::Looks,
};

/// The tables that a name stands for: itself, or where there is no such file, those between its plus signs.
pub(crate) fn tables_of(path: &Path) -> Vec<PathBuf> {
    match path.to_str() {
        Some(text) if text.contains('+') && !path.exists() => text.split('+').map(PathBuf::from).collect(),
        _ => vec![path.to_owned()],
    }
}

/// One recording of tables of the same drives: their rows on the union of their times, brought onto one clock.
pub(crate) fn join_in_time(
    parts: Vec<(PathBuf, Part)>,
    map: Option<&Map>,
    looks: &Looks,
) -> Result<Reading, Error> {
    let sources: Vec<String> = parts.iter().map(|(path, _)| path.display().to_string()).collect();
    let tables: Vec<Table<'_>> = sources
        .iter()
        .zip(&parts)
        .map(|(source, (_, part))| Table { source, recording: &part.recording })
        .collect();
    for table in &tables[1..] {
        tables[0].refuse_other_drives(table)?;
    }
    refuse_doubles(&tables)?;
    let mut recording = Recording::default();
    for run in 0..tables[0].recording.runs.len() {
        looks.go_on()?;
        append_run(&mut recording, &tables, run);
    }
    let name = parts.first().map_or_else(|| "recording".to_owned(), |(path, _)| run_name(path));
    let (source, mut report, mut found) = (sources.join("+"), ReadingReport::default(), Vec::new());
    for ((_, part), source) in parts.into_iter().zip(&sources) {
        let repair = |repair: Repair| Repair { place: format!("{source}, {}", repair.place), ..repair };
        let ignored = |ignored: Ignored| Ignored { name: format!("{source}, {}", ignored.name), ..ignored };
        report.channels.extend(part.report.channels);
        report.repairs.extend(part.report.repairs.into_iter().map(repair));
        report.ignored.extend(part.report.ignored.into_iter().map(ignored));
        found.extend(part.found);
    }
    onto_one_clock(&mut recording, map.and_then(|map| map.max_gap_s), &mut report.repairs, looks)?;
    report.alignment = Some(AlignmentReport {
        base: source.clone(),
        method: "rows of tables joined on the union of their times; empty cells interpolated linearly, headings on the shorter arc, \
                 between samples at most three of their own steps apart"
            .into(),
        max_gap_s: Vec::new(),
    });
    let part = Part { recording, report, found, format: "tables" };
    let mut reading =
        Reading::finish(part, &name, map, looks).map_err(|error| error.in_file(Path::new(&source)))?;
    reading.report.source = source;
    Ok(reading)
}

/// A table with its name for messages.
struct Table<'t> {
    source: &'t str,
    recording: &'t Recording,
}

impl Table<'_> {
    fn run_names(&self) -> String {
        let names: Vec<String> = self.recording.runs.iter().map(|run| format!("`{}`", run.name)).collect();
        names.join(", ")
    }

    /// Refuses a table whose runs have other names, unless both have one run, or were recorded at other times.
    fn refuse_other_drives(&self, other: &Table<'_>) -> Result<(), Error> {
        let (own, others) = (&self.recording.runs, &other.recording.runs);
        let is_same = |pair: (&Run, &Run)| pair.0.name == pair.1.name;
        let is_one = own.len() == 1 && others.len() == 1;
        if own.len() != others.len() || !(is_one || own.iter().zip(others).all(is_same)) {
            return Err(Error::JoinedRuns {
                first: self.source.to_owned(),
                first_runs: self.run_names(),
                second: other.source.to_owned(),
                second_runs: other.run_names(),
            });
        }
        for (one, another) in own.iter().zip(others) {
            let [first_s, second_s] = [self.times(one), other.times(another)];
            if first_s[1] < second_s[0] || second_s[1] < first_s[0] {
                let (first, second) = (self.source.to_owned(), other.source.to_owned());
                return Err(Error::Apart { first, first_s, second, second_s });
            }
        }
        Ok(())
    }

    /// First and last time of a run \[s\].
    fn times(&self, run: &Run) -> [f64; 2] {
        let at = |row: usize| self.recording.t_s.get(row).copied().unwrap_or(f64::NAN);
        [at(run.rows.start), at(run.rows.end.saturating_sub(1))]
    }

    /// For each of some times, the row of a run that has it.
    fn rows_at(&self, run: usize, t_s: &[f64]) -> Vec<Option<usize>> {
        let mut rows = self.recording.runs[run].rows.clone().peekable();
        let row_at = |t: &f64| rows.next_if(|row| self.recording.t_s[*row] == *t);
        t_s.iter().map(row_at).collect()
    }
}

fn refuse_doubles(tables: &[Table<'_>]) -> Result<(), Error> {
    for (index, table) in tables.iter().enumerate() {
        for (channel, values) in &table.recording.channels {
            let holds = |values: &Vec<f64>| values.iter().any(|value| !value.is_nan());
            let gives = |other: &&Table<'_>| other.recording.channels.get(channel).is_some_and(holds);
            if let Some(other) = tables[..index].iter().find(gives).filter(|_| holds(values)) {
                let (first, second) = (other.source.to_owned(), table.source.to_owned());
                return Err(Error::GivenTwice { channel: *channel, first, second });
            }
        }
    }
    Ok(())
}

/// Appends a run: every time of any table, and the cells that the tables have there.
fn append_run(joined: &mut Recording, tables: &[Table<'_>], run: usize) {
    let times =
        tables.iter().flat_map(|table| table.recording.t_s[table.recording.runs[run].rows.clone()].iter());
    let mut t_s: Vec<f64> = times.copied().collect();
    t_s.sort_unstable_by(f64::total_cmp);
    t_s.dedup();
    let before = joined.t_s.len();
    let rows = before..before + t_s.len();
    for table in tables {
        let at = table.rows_at(run, &t_s);
        let moved = |values: &Vec<f64>| -> Vec<f64> {
            at.iter().map(|row| row.map_or(f64::NAN, |row| values[row])).collect()
        };
        for (channel, values) in &table.recording.channels {
            place(joined.channels.entry(*channel).or_default(), before, moved(values));
        }
        for (name, values) in &table.recording.aside {
            place(joined.aside.entry(name.clone()).or_default(), before, moved(values));
        }
        if let Some(labels) = &table.recording.surface {
            let surface = joined
                .surface
                .get_or_insert_with(|| Labels { names: labels.names.clone(), index: Vec::new() });
            if surface.names == labels.names && surface.index.len() == before {
                surface.index.extend(held(labels, &at));
            }
        }
    }
    for values in joined.channels.values_mut().chain(joined.aside.values_mut()) {
        values.resize(rows.end, f64::NAN);
    }
    let first = &tables[0].recording.runs[run];
    joined.t_s.extend(t_s);
    joined.runs.push(Run::new(first.name.clone(), rows, &joined.t_s, first.start_unix_s));
}

/// Puts the values of a run behind those of the runs before. A column that an earlier table gave keeps what it has.
fn place(column: &mut Vec<f64>, before: usize, values: Vec<f64>) {
    column.resize(column.len().max(before), f64::NAN);
    if column.len() == before {
        column.extend(values);
        return;
    }
    for (own, value) in column[before..].iter_mut().zip(values) {
        if own.is_nan() {
            *own = value;
        }
    }
}

/// Labels hold until the next one; the first one holds before it as well.
fn held(labels: &Labels, at: &[Option<usize>]) -> Vec<u32> {
    let label = |row: &Option<usize>| row.map(|row| labels.index[row]);
    let mut last = at.iter().find_map(label).unwrap_or(Labels::NONE);
    at.iter()
        .map(|row| {
            last = label(row).unwrap_or(last);
            last
        })
        .collect()
}
