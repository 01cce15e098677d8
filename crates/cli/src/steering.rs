//! Arguments that steer a path: prices, bans, and which ends will do.

use clap::{Args, ValueEnum};
use service::routes::plan::{ForbidName, PlanRequest, PricesRequest};

/// How a path is to be steered.
#[derive(Args)]
pub(crate) struct Steering {
    /// What a manoeuvre weighs besides what it takes, as reverse_j_per_m=30, spin_j_per_rad=20, direction_change_j=100, the same with
    /// _s in place of _j, or stops; may be given several times
    #[arg(long = "price", value_name = "NAME=VALUE", value_parser = price)]
    prices: Vec<Price>,
    /// What the robot is not to do; may be given several times
    #[arg(long, value_enum)]
    forbid: Vec<Forbidden>,
    /// No turn is tighter [m]; above 0 the robot does not turn on the spot
    #[arg(long)]
    least_radius_m: Option<f64>,
    /// The opposite of the goal's heading will do as well
    #[arg(long)]
    pub(crate) either_way: bool,
    /// Where no path leads to the goal, go to the place nearest to it that can be reached
    #[arg(long)]
    partial: bool,
    /// Begin and end the path at centres of cells, not exactly where it is asked to
    #[arg(long)]
    snapped_ends: bool,
}

/// A named price.
#[derive(Clone, Copy, Debug)]
struct Price {
    set: fn(&mut PricesRequest, f64),
    value: f64,
}

#[derive(Clone, Copy, ValueEnum)]
enum Forbidden {
    Reverse,
    Spin,
}

fn price(text: &str) -> Result<Price, String> {
    let (name, value) = text.split_once('=').unwrap_or((text, ""));
    let set: fn(&mut PricesRequest, f64) = match name {
        "reverse_j_per_m" => |prices, value| prices.reverse_j_per_m = value,
        "reverse_s_per_m" => |prices, value| prices.reverse_s_per_m = value,
        "spin_j_per_rad" => |prices, value| prices.spin_j_per_rad = value,
        "spin_s_per_rad" => |prices, value| prices.spin_s_per_rad = value,
        "direction_change_j" => |prices, value| prices.direction_change_j = value,
        "direction_change_s" => |prices, value| prices.direction_change_s = value,
        "stops" if value.is_empty() => return Ok(Price { set: |prices, _| prices.stops = true, value: 0.0 }),
        _ => {
            return Err("give reverse_j_per_m, reverse_s_per_m, spin_j_per_rad, spin_s_per_rad, direction_change_j or direction_change_s with =VALUE, or stops".into());
        }
    };
    match value.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(Price { set, value }),
        _ => Err(format!("`{value}` is no number of 0 or more")),
    }
}

impl Steering {
    /// Whether anything is asked for.
    pub(crate) fn is_any(&self) -> bool {
        let Steering { prices, forbid, least_radius_m, either_way, partial, snapped_ends } = self;
        !prices.is_empty()
            || !forbid.is_empty()
            || least_radius_m.is_some()
            || *either_way
            || *partial
            || *snapped_ends
    }

    /// The request as it is to be steered.
    pub(crate) fn on(&self, request: PlanRequest) -> PlanRequest {
        let mut prices = PricesRequest::default();
        self.prices.iter().for_each(|price| (price.set)(&mut prices, price.value));
        let name = |forbidden: &Forbidden| match forbidden {
            Forbidden::Reverse => ForbidName::Reverse,
            Forbidden::Spin => ForbidName::Spin,
        };
        PlanRequest {
            prices: (!self.prices.is_empty()).then_some(prices),
            forbid: self.forbid.iter().map(name).collect(),
            least_radius_m: self.least_radius_m,
            partial: self.partial,
            exact_ends: !self.snapped_ends,
            ..request
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prices_are_named_and_have_a_value() {
        let mut prices = PricesRequest::default();
        for text in ["reverse_j_per_m=30", "direction_change_s=2.5", "stops"] {
            let Price { set, value } = price(text).unwrap();
            set(&mut prices, value);
        }
        assert_eq!((prices.reverse_j_per_m, prices.direction_change_s, prices.stops), (30.0, 2.5, true));
        for (wrong, said) in [
            ("reverse=3", "spin_j_per_rad"),
            ("spin_j_per_rad", "no number"),
            ("spin_j_per_rad=-1", "no number"),
            ("stops=1", "stops"),
        ] {
            assert!(price(wrong).unwrap_err().contains(said), "{wrong}");
        }
    }
}
