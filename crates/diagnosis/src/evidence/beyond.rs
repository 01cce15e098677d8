//! What a column explains beyond a neighbour that may be a part of it.

use nalgebra::{DMatrix, DVectorView};

use super::{Evidence, System};

impl System {
    /// What each of some columns explains beyond what its neighbour in a pair does, of whose weight is known that it is about 0, with
    /// one sigma of 1.
    pub(crate) fn weigh_beyond(&self, pairs: &[[Vec<f64>; 2]]) -> Vec<Option<Evidence>> {
        let own = self.own(pairs.as_flattened());
        let one = |(i, [column, _]): (usize, &[Vec<f64>; 2])| {
            let beside = own.column(2 * i + 1);
            let square = 1.0 + beside.norm_squared();
            // What is known before of the neighbour is one more row.
            let without = |of: DVectorView<'_, f64>| {
                let weight = beside.dot(&of) / square;
                let left = (of - beside * weight).insert_row(self.left.len(), -weight);
                DMatrix::from_column_slice(left.len(), 1, left.as_slice())
            };
            let left = without(self.left.column(0)).column(0).into_owned();
            self.weigh_own(std::slice::from_ref(column), without(own.column(2 * i)), &left)
        };
        pairs.iter().enumerate().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::evidence::Fitted;

    const ROWS: usize = 80;
    const BLOCKS: usize = 16;

    fn column(which: usize) -> Vec<f64> {
        (0..ROWS).map(|i| (1.3 * i as f64 + (i * i * (which + 1)) as f64).sin()).collect()
    }

    fn system(errors: &[f64], columns: &[Vec<f64>], known: &[f64]) -> System {
        let offset = vec![0.0; columns.len()];
        let fitted = Fitted { columns, known, offset: &offset, shared: &[].into() };
        let block = (0..ROWS).map(|i| i * BLOCKS / ROWS).collect();
        System::new(errors.to_vec(), &fitted, (block, vec![0; ROWS]))
    }

    /// A column in the second half only, and what it does in all rows.
    fn pair() -> [Vec<f64>; 2] {
        let all = column(1);
        let half = all.iter().enumerate().map(|(i, x)| if i < ROWS / 2 { 0.0 } else { *x }).collect();
        [half, all]
    }

    fn with_noise(signal: &[f64]) -> Vec<f64> {
        column(4).iter().zip(signal).map(|(noise, x)| 0.3 * noise + x).collect()
    }

    #[test]
    fn it_is_what_a_fit_with_the_neighbour_about_nothing_says() {
        let [half, all] = pair();
        let errors = with_noise(&half);
        let found = system(&errors, &[column(0)], &[0.5]);
        let with_neighbour = system(&errors, &[column(0), all.clone()], &[0.5, 1.0]);
        let beyond = found.weigh_beyond(&[[half.clone(), all.clone()]])[0].clone().unwrap();
        let by_hand = with_neighbour.weigh(std::slice::from_ref(&half)).unwrap();
        assert!(
            (beyond.values[0] - by_hand.values[0]).abs() < 1e-9,
            "{} {}",
            beyond.values[0],
            by_hand.values[0]
        );
        assert!((beyond.explained - by_hand.explained).abs() < 1e-9);
        // The same by least squares over rows, each written down.
        let matrix = DMatrix::from_fn(ROWS + 2, 3, |i, j| match i {
            i if i < ROWS => [column(0)[i], all[i], half[i]][j],
            i => [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0]][i - ROWS][j],
        });
        let right = DVector::from_fn(ROWS + 2, |i, _| errors.get(i).copied().unwrap_or(0.0));
        let values = matrix.svd(true, true).solve(&right, 1e-12).unwrap();
        assert!((beyond.values[0] - values[2]).abs() < 1e-9);
    }

    #[test]
    fn what_acts_in_all_rows_alike_is_nothing_beyond_and_what_acts_in_half_of_them_is() {
        let [half, all] = pair();
        let evidence = |signal: &[f64]| {
            let strong: Vec<f64> = signal.iter().map(|x| 3.0 * x).collect();
            let found = system(&with_noise(&strong), &[column(0)], &[0.5]);
            let alone = found.weigh(std::slice::from_ref(&half)).unwrap();
            let beyond = found.weigh_beyond(&[[half.clone(), all.clone()]])[0].clone().unwrap();
            [alone.wald, beyond.wald]
        };
        let [alone, beyond] = evidence(&all);
        assert!(alone > 50.0 && beyond < 9.0, "{alone} {beyond}");
        let [alone, beyond] = evidence(&half);
        assert!(alone > 50.0 && beyond > 50.0, "{alone} {beyond}");
    }

    #[test]
    fn a_neighbour_that_is_nothing_changes_nothing() {
        let [half, _] = pair();
        let found = system(&with_noise(&half), &[column(0)], &[0.5]);
        let beyond = found.weigh_beyond(&[[half.clone(), vec![0.0; ROWS]]])[0].clone().unwrap();
        let alone = found.weigh(std::slice::from_ref(&half)).unwrap();
        assert!((beyond.wald / alone.wald - 1.0).abs() < 1e-9);
        assert!((beyond.explained - alone.explained).abs() < 1e-9);
    }
}
