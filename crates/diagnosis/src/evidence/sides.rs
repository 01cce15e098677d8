//! What many columns explain that are the same but for the side on which they act: what each does on either side is worked out once, and
//! both, one or their difference are put together of that.

use nalgebra::{DMatrix, DVector};

use super::{System, is_nothing};
use crate::shared::Shared;

/// A system over the averages of one channel.
struct Channel<'a> {
    /// The columns that are fitted always, row by row.
    transposed: DMatrix<f64>,
    shared: Option<&'a Shared>,
    left: DVector<f64>,
}

/// A system over the averages of each of some channels.
pub(crate) struct Sides<'a> {
    channels: Vec<Channel<'a>>,
    inverse: &'a DMatrix<f64>,
}

/// Products of some columns on one side with each other, with what is fitted always and with the errors.
struct Products {
    columns: DMatrix<f64>,
    fitted: DMatrix<f64>,
    /// Products with what models miss, and its weights in the columns.
    taken: Option<(DMatrix<f64>, DMatrix<f64>)>,
    right: DVector<f64>,
}

/// Products of some columns on each side.
pub(crate) struct OnSides<'a> {
    sides: Vec<Products>,
    inverse: &'a DMatrix<f64>,
}

/// A column with how much of it acts on each side.
#[derive(Clone, Copy)]
pub(crate) struct Sided<'a> {
    pub(crate) column: usize,
    pub(crate) signs: &'a [f64],
    /// By what it is multiplied.
    pub(crate) by: f64,
}

impl System {
    /// It over the averages of each of some channels, which lie at such places.
    pub(crate) fn sides<'a>(&'a self, places: impl Iterator<Item = &'a [usize]>) -> Sides<'a> {
        let of = |places: &[usize]| Channel {
            transposed: self.transposed.select_columns(places),
            shared: self.shared.iter().find(|shared| shared.places == places),
            left: self.left.select_rows(places),
        };
        Sides { channels: places.map(of).collect(), inverse: &self.inverse }
    }
}

impl Channel<'_> {
    fn products(&self, columns: DMatrix<f64>) -> Products {
        let fitted = &self.transposed * &columns;
        let taken = self.shared.map(|shared| shared.taken_of(&columns));
        let right = columns.tr_mul(&self.left);
        Products { columns, fitted, taken, right }
    }
}

impl Products {
    /// Product of two columns, less what models miss takes of it.
    fn product(&self, i: usize, j: usize) -> f64 {
        let taken = self.taken.as_ref();
        self.columns.column(i).dot(&self.columns.column(j))
            - taken.map_or(0.0, |(products, weights)| products.column(i).dot(&weights.column(j)))
    }
}

impl<'a> Sides<'a> {
    /// Products of columns, of which each side has its own rows.
    pub(crate) fn products(&self, columns: Vec<DMatrix<f64>>) -> OnSides<'a> {
        let sides = self.channels.iter().zip(columns).map(|(channel, columns)| channel.products(columns));
        OnSides { sides: sides.collect(), inverse: self.inverse }
    }
}

impl OnSides<'_> {
    /// Drop of squared errors by a column at its best, beyond what a neighbour explains of whose weight is known that it is about 0 with one
    /// sigma of 1; 0 where everything else explains all that the column does.
    pub(crate) fn explained(&self, one: Sided<'_>, beside: Option<Sided<'_>>) -> f64 {
        let whole = self.sum(one, one, |side, i, _| side.columns.column(i).norm_squared());
        let (own, right) = (self.product(one, one), self.right(one));
        let (left, right) = match beside {
            Some(beside) => {
                let (both, square) = (self.product(one, beside), self.product(beside, beside) + 1.0);
                (own - both * both / square, right - both * self.right(beside) / square)
            }
            None => (own, right),
        };
        if is_nothing(left, whole) { 0.0 } else { right * right / left }
    }

    /// Product of two columns less what everything fitted always takes of it.
    fn product(&self, one: Sided<'_>, other: Sided<'_>) -> f64 {
        let taken = self.fitted(one).dot(&(self.inverse * self.fitted(other)));
        self.sum(one, other, Products::product) - taken
    }

    fn right(&self, one: Sided<'_>) -> f64 {
        let of = |(side, sign): (&Products, &f64)| sign * side.right[one.column];
        one.by * self.sides.iter().zip(one.signs).map(of).sum::<f64>()
    }

    /// Products with what is fitted always, of all sides.
    fn fitted(&self, one: Sided<'_>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.inverse.nrows());
        for (side, sign) in self.sides.iter().zip(one.signs) {
            sum.axpy(one.by * sign, &side.fitted.column(one.column), 1.0);
        }
        sum
    }

    fn sum(&self, one: Sided<'_>, other: Sided<'_>, of: impl Fn(&Products, usize, usize) -> f64) -> f64 {
        let signs = one.signs.iter().zip(other.signs);
        let both = self.sides.iter().zip(signs).filter(|(_, (a, b))| **a * **b != 0.0);
        let sum: f64 = both.map(|(side, (a, b))| a * b * of(side, one.column, other.column)).sum();
        one.by * other.by * sum
    }
}
