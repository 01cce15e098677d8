//! The columns of a table while it is read, in the room that there is.

use crate::{
    Error,
    coarse::Coarse,
    column::{Column, Kind, Plan},
    label_column::LabelColumn,
    watch::{Budget, Looks},
};

/// Columns of as many rows each.
pub(crate) struct Table {
    pub(crate) columns: Vec<Column>,
    /// How rows stand for several of the file.
    pub(crate) coarse: Coarse,
    kinds: Vec<Kind>,
    time: Option<usize>,
    periods: Vec<Option<f64>>,
    budget: Budget,
    rows: usize,
    /// Rows that fit.
    most_rows: usize,
}

impl Table {
    /// Columns of the plan's kinds without a row.
    pub(crate) fn new(plan: &Plan, budget: Budget) -> Table {
        let empty = |kind: &Kind| match kind {
            Kind::Label => Column::Labels(LabelColumn::default()),
            Kind::Number | Kind::Perhaps => Column::Numbers(Vec::new()),
        };
        Table {
            columns: plan.kinds.iter().map(empty).collect(),
            coarse: Coarse::default(),
            kinds: plan.kinds.clone(),
            time: plan.time(),
            periods: plan.periods(),
            rows: 0,
            most_rows: budget.room.rows(plan.kinds.len()),
            budget,
        }
    }

    /// Takes note that every column has so many rows more; where they fill the room, neighbours become one.
    pub(crate) fn end_rows(&mut self, more: usize) -> Result<(), Error> {
        self.rows += more;
        self.budget.looks.worked(more)?;
        if self.rows < self.most_rows { Ok(()) } else { self.make_room() }
    }

    fn make_room(&mut self) -> Result<(), Error> {
        // What is no channel is of no use to a model, and goes first.
        for (column, _) in
            self.columns.iter_mut().zip(&self.kinds).filter(|(_, kind)| **kind == Kind::Perhaps)
        {
            if matches!(column, Column::Numbers(_)) {
                *column = Column::Unusable("no channel, and the file is too long to keep it aside".into());
            }
        }
        let kept = self.columns.iter().filter(|column| !matches!(column, Column::Unusable(_))).count();
        self.most_rows = self.budget.room.rows(kept);
        if self.rows < self.most_rows {
            return Ok(());
        }
        self.join(self.most_rows / 2)
    }

    /// The watch of the reading.
    pub(crate) fn looks(&self) -> &Looks {
        &self.budget.looks
    }

    /// Brings the rows that were read last to means of as many as those before, so that a run has one rhythm.
    pub(crate) fn settle(&mut self) -> Result<(), Error> {
        if self.coarse.is_joined() { self.join(usize::MAX) } else { Ok(()) }
    }

    fn join(&mut self, most_rows: usize) -> Result<(), Error> {
        let labels: Vec<Vec<u32>> =
            self.columns.iter_mut().filter_map(Column::index).map(|index| index.clone()).collect();
        let same = |row: usize| labels.iter().all(|index| index[row] == index[row - 1]);
        let t: &[f64] = match self.time.and_then(|time| self.columns.get(time)) {
            Some(Column::Numbers(t)) => t,
            _ => &[],
        };
        let Some(groups) = self.coarse.group(t, most_rows, same) else {
            return Err(Error::TooLarge { most: self.most_rows });
        };
        for (column, period) in self.columns.iter_mut().zip(&self.periods) {
            self.budget.looks.worked(self.rows)?;
            match column {
                Column::Numbers(values) => groups.average(values, *period),
                Column::Labels(labels) => groups.first(labels.index()),
                Column::Unusable(_) => {}
            }
        }
        self.rows = groups.count();
        Ok(())
    }
}

impl Column {
    fn index(&mut self) -> Option<&mut Vec<u32>> {
        match self {
            Column::Labels(labels) => Some(labels.index()),
            Column::Numbers(_) | Column::Unusable(_) => None,
        }
    }
}
