//! What the model misses of the robot, as a smooth function of the inputs and another of the ground that nobody names: the same in suspect
//! and in healthy drives (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 2001, §4, with a Gaussian process as prior).
//!
//! Where healthy drives went, they tell the function, and what only suspect drives have stands out against it. Where they did
//! not go, the function may be anything of its usual size, and nothing small stands out.

mod functions;
mod likelihood;

use rayon::prelude::*;

use self::likelihood::{Likelihoods, SIZES, likelihoods, most};
use crate::{average::Average, channel, noise::Whitening};

/// Logarithm of the likelihood ratio from which ground is taken for uneven: 20, as of any name ([`crate::search::AS_GOOD`]). Of worlds
/// with the same ground everywhere it stays below 1, of one with patches of 2 % it reaches 4 to 26.
const SURE: f64 = 3.0;
/// Channels of power at the wheels.
const SIDES: usize = 2;

/// Parts of the function's variance that grow with the square of what is predicted, which are weighed: of a large robot, whose turns take
/// six times the mean, healthy drives are e³⁰ times likelier with most of it than with none.
const GROWING: [f64; 3] = [0.0, 0.5, 0.9];

/// Logarithm of the likelihood ratio from which a size is one: as much as one more number is asked for by Akaike's information criterion
/// (IEEE Trans. Autom. Control 19, 1974).
const LIKELIER: f64 = 1.0;

/// The functions of one set of drives, by channel: one of the inputs, and one of the ground.
#[derive(Debug)]
pub(crate) struct Discrepancy {
    channels: Vec<[Process; 2]>,
}

/// Whether the ground may be otherwise from place to place than it is on the whole. What acts in a place only is held against that; what
/// acts everywhere is the same in many places, and wind on a robot that goes round and round would pass for ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    Even,
    Uneven,
}

#[derive(Debug)]
struct Process {
    /// By function, over the averages of the channel.
    functions: Vec<Vec<f64>>,
    /// One sigma of it, as a share of the mean power.
    share: f64,
}

/// Errors with what else is fitted to them, all over their scatter.
pub(crate) struct Whitened<'a> {
    /// Errors.
    pub(crate) errors: Vec<f64>,
    /// Columns with weights of one sigma 1.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Makes the same of any other column in watts.
    pub(crate) white: &'a Whitening,
}

impl Discrepancy {
    /// Learns how large the functions are, and how they grow with what is predicted: the sizes under which the errors of healthy drives are
    /// most likely, of all drives where none is known to be healthy. `means` are mean sizes of what is predicted, by channel.
    pub(crate) fn learn(
        averages: &[Average],
        (means, predicted): (&[f64], &[f64]),
        beside: &Whitened<'_>,
    ) -> Self {
        let Whitened { errors, columns, white } = beside;
        let of_channel = |(channel, mean): (usize, &f64)| {
            let places = channel::places(averages, channel);
            let whitened = |functions: &[Vec<f64>]| -> Vec<Vec<f64>> {
                let all = channel::spread(&scaled(functions, *mean), &places, averages.len());
                all.iter().map(|column| white.of(column)).collect()
            };
            let likely = |functions: &[Vec<f64>], beside: &[Vec<f64>]| {
                likelihoods(averages, channel, (&whitened(functions), beside), errors)
            };
            let alike = functions::of_inputs(averages, &places);
            let of_inputs = GROWING.map(|part| {
                let functions = grown(&alike, &places, predicted, (*mean, part));
                let by_size = likely(&functions, columns);
                let best = most(&by_size);
                (by_size[best] - by_size[0], Process { functions, share: SIZES[best] })
            });
            let of_inputs = likeliest(of_inputs);
            // Slopes go with places, and what the model misses of them does.
            let beside = [&columns[..], &whitened(&of_inputs.columns(1.0))].concat();
            let of_ground =
                if channel < SIDES { functions::of_ground(averages, &places) } else { Vec::new() };
            let by_ground = likely(&of_ground, &beside);
            (of_inputs, of_ground, by_ground)
        };
        let learnt: Vec<_> = means.par_iter().enumerate().map(of_channel).collect();
        // Ground is under both sides alike.
        let likely: Likelihoods = std::array::from_fn(|i| learnt.iter().map(|(.., one)| one[i]).sum());
        let best = most(&likely);
        let share = if likely[best] - likely[0] >= SURE { SIZES[best] } else { 0.0 };
        let both = |(of_inputs, functions, _)| [of_inputs, Process { functions, share }];
        Discrepancy { channels: learnt.into_iter().map(both).collect() }
    }

    /// Size of the largest function of the inputs of so many first channels, as a share of the channel's mean.
    pub(crate) fn share(&self, channels: usize) -> f64 {
        self.channels.iter().take(channels).map(|[of_inputs, _]| of_inputs.share).fold(0.0, f64::max)
    }

    /// Columns over the averages of a channel of such a mean size, with weights of one sigma 1, those of the ground among them if asked for;
    /// none where it misses nothing.
    pub(crate) fn of_channel(&self, channel: usize, mean: f64, ground: Ground) -> Vec<Vec<f64>> {
        let Some([of_inputs, of_ground]) = self.channels.get(channel) else { return Vec::new() };
        let mut columns = of_inputs.columns(mean);
        if ground == Ground::Uneven {
            columns.extend(of_ground.columns(mean));
        }
        columns
    }
}

impl Process {
    /// See [`Discrepancy::of_channel`].
    fn columns(&self, mean: f64) -> Vec<Vec<f64>> {
        if self.share > 0.0 { scaled(&self.functions, self.share * mean) } else { Vec::new() }
    }
}

/// The process under which errors are likeliest, of some with the logarithm of how much likelier they are than with none; none if they hardly
/// are.
fn likeliest<const COUNT: usize>(of: [(f64, Process); COUNT]) -> Process {
    let most = |a: (f64, Process), b: (f64, Process)| if b.0 > a.0 { b } else { a };
    let none = (LIKELIER, Process { functions: Vec::new(), share: 0.0 });
    of.into_iter().fold(none, most).1
}

/// Functions whose one sigma is the same at the mean power, and elsewhere as of a part of its variance that grows with the square of power.
fn grown(
    functions: &[Vec<f64>],
    places: &[usize],
    predicted: &[f64],
    (mean, part): (f64, f64),
) -> Vec<Vec<f64>> {
    let size = |i: &usize| (1.0 - part + part * (predicted[*i] / mean.max(1e-9)).powi(2)).sqrt();
    let sizes: Vec<f64> = places.iter().map(size).collect();
    functions.iter().map(|function| function.iter().zip(&sizes).map(|(x, size)| x * size).collect()).collect()
}

fn scaled(functions: &[Vec<f64>], by: f64) -> Vec<Vec<f64>> {
    functions.iter().map(|function| function.iter().map(|value| value * by).collect()).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::{average::Input, noise::Noise};

    fn averages(count: usize) -> Vec<Average> {
        let of = |i: usize| {
            let x = i as f64;
            let input = Input {
                rim_mps: (0.1 * x).sin(),
                difference_mps: (0.07 * x).cos(),
                pitch_rad: 0.03 * (0.013 * x).sin(),
                ..Input::default()
            };
            Average { channel: i % 2, run: 0, suspect: false, t_s: x, input }
        };
        (0..count).map(of).collect()
    }

    /// The functions as they are learnt from errors made of some watts and noise of one watt, where 100 W are predicted.
    fn learnt_from(averages: &[Average], missed_w: &dyn Fn(&Average) -> f64) -> Discrepancy {
        learnt_at(averages, &vec![100.0; averages.len()], missed_w)
    }

    /// The same where other powers are.
    fn learnt_at(averages: &[Average], predicted: &[f64], missed_w: &dyn Fn(&Average) -> f64) -> Discrepancy {
        let mut noise = 12345_u64;
        let mut normal = || -> f64 {
            let uniform = |state: &mut u64| {
                *state =
                    state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (*state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform(&mut noise)).sum::<f64>() - 6.0
        };
        let errors: Vec<f64> = averages.iter().map(|a| missed_w(a) + normal()).collect();
        let white = Noise::of(&errors, predicted, averages, &vec![true; averages.len()])
            .whitening(predicted, averages);
        let beside = Whitened { errors: white.of(&errors), columns: Vec::new(), white: &white };
        Discrepancy::learn(averages, (&[100.0, 100.0], predicted), &beside)
    }

    /// Size of the functions of the inputs and of the ground, learnt so.
    fn learnt_of(averages: &[Average], missed_w: &dyn Fn(&Average) -> f64) -> [f64; 2] {
        learnt_from(averages, missed_w).channels[0].each_ref().map(|process| process.share)
    }

    /// The same of a smooth function of the inputs of so many watts.
    fn learnt(averages: &[Average], size_w: f64) -> f64 {
        let missed_w = |a: &Average| size_w * (1.4 * (2.0 * a.input.rim_mps + a.input.difference_mps).sin());
        learnt_of(averages, &missed_w)[0]
    }

    #[test]
    fn its_size_is_learnt_from_the_errors() {
        let averages = averages(1200);
        assert_eq!(learnt(&averages, 0.0), 0.0);
        assert!((0.005..=0.02).contains(&learnt(&averages, 1.0)), "{}", learnt(&averages, 1.0));
        assert!(learnt(&averages, 3.0) > learnt(&averages, 1.0));
    }

    #[test]
    fn what_is_missed_in_proportion_to_power_may_be_more_where_more_is_predicted_and_what_is_not_may_not() {
        let averages = averages(1200);
        let predicted: Vec<f64> = (0..1200).map(|i| if i % 8 < 2 { 340.0 } else { 20.0 }).collect();
        let smooth = |a: &Average| (1.4 * (2.0 * a.input.rim_mps + a.input.difference_mps)).sin();
        // One sigma of the functions at much and at little power.
        let sizes = |missed_w: &dyn Fn(&Average) -> f64| {
            let learnt = learnt_at(&averages, &predicted, missed_w);
            let functions = learnt.of_channel(0, 100.0, Ground::Even);
            [0, 1].map(|k| functions.iter().map(|f| f[k] * f[k]).sum::<f64>().sqrt())
        };
        let [much, little] = sizes(&|a| 0.05 * predicted[a.t_s as usize] * smooth(a));
        assert!(much > 5.0 * little, "{much} {little}");
        let [much, little] = sizes(&|a| 5.0 * smooth(a));
        assert!(little > 0.5 * much, "{much} {little}");
    }

    #[test]
    fn the_likeliest_process_is_learnt_if_it_is_likelier_than_none_by_as_much_as_a_number_costs() {
        let process = |share: f64| Process { functions: vec![vec![1.0]], share };
        assert_eq!(likeliest([(0.9, process(0.01)), (0.5, process(0.02))]).share, 0.0);
        assert_eq!(likeliest([(1.1, process(0.01)), (2.5, process(0.02))]).share, 0.02);
    }

    /// Averages of a drive that comes to most places of a field.
    fn about_a_field() -> Vec<Average> {
        let mut averages = averages(1200);
        for a in &mut averages {
            a.input.position_m = [20.0 * (0.011 * a.t_s).sin(), 15.0 * (0.0173 * a.t_s).sin()];
        }
        averages
    }

    /// Patches some 13 m across, of 2 W root mean square at the usual speed, which is a share of 100 W.
    fn uneven(a: &Average) -> f64 {
        let [x_m, y_m] = a.input.position_m;
        4.0 * (0.47 * x_m).sin() * (0.51 * y_m + 1.0).sin() * a.input.rim_mps.abs()
    }

    /// What drives tell of a column's size, over what they would if the functions missed nothing, with noise of one watt.
    fn told(functions: &[Vec<f64>], column: &[f64]) -> f64 {
        let size: f64 = column.iter().map(|x| x * x).sum();
        let phi = DMatrix::from_fn(column.len(), functions.len(), |i, j| functions[j][i]);
        let along = phi.tr_mul(&DVector::from_column_slice(column));
        let inner = DMatrix::identity(functions.len(), functions.len()) + phi.tr_mul(&phi);
        1.0 - along.dot(&inner.cholesky().map_or_else(|| along.clone(), |root| root.solve(&along))) / size
    }

    #[test]
    fn on_uneven_ground_drives_tell_little_of_a_place_and_no_less_of_what_acts_as_it_turns() {
        let averages = about_a_field();
        let learnt = learnt_from(&averages, &uneven);
        let of = |ground: Ground, column: &dyn Fn(&Average) -> f64| {
            let places = channel::places(&averages, 0);
            let column: Vec<f64> = places.iter().map(|i| column(&averages[*i])).collect();
            told(&learnt.of_channel(0, 100.0, ground), &column)
        };
        let in_the_east = |a: &Average| if a.input.position_m[0] > 0.0 { a.input.rim_mps.abs() } else { 0.0 };
        let turning = |a: &Average| a.input.difference_mps.abs();
        let [even, uneven] = [Ground::Even, Ground::Uneven].map(|ground| of(ground, &in_the_east));
        assert!(uneven < 0.2 * even, "{even} {uneven}");
        let [even, uneven] = [Ground::Even, Ground::Uneven].map(|ground| of(ground, &turning));
        assert!(uneven > 0.5 * even, "{even} {uneven}");
    }

    #[test]
    fn ground_that_is_uneven_is_learnt_where_the_robot_rolls_and_even_ground_is_not() {
        let mut averages = about_a_field();
        let [_, share] = learnt_of(&averages, &uneven);
        assert!((0.005..=0.04).contains(&share), "{share}");
        assert_eq!(learnt_of(&averages, &|_| 0.0)[1], 0.0);
        // Where positions are unknown there are no places.
        averages.iter_mut().for_each(|a| a.input.position_m = [f64::NAN; 2]);
        assert_eq!(learnt_of(&averages, &uneven)[1], 0.0);
    }

    #[test]
    fn products_of_the_functions_are_the_covariance_and_channels_stay_apart() {
        let averages = averages(300);
        let of = |channel| {
            let places = channel::places(&averages, channel);
            channel::spread(&functions::of_inputs(&averages, &places), &places, averages.len())
        };
        let functions = [of(0), of(1)].concat();
        let covariance = |i: usize, j: usize| -> f64 { functions.iter().map(|f| f[i] * f[j]).sum() };
        for i in (0..300).step_by(7) {
            assert!((covariance(i, i) - 1.0).abs() < functions::LEFT_OUT + 1e-9, "{i}: {}", covariance(i, i));
        }
        assert!(covariance(4, 6) > 0.9, "neighbours go together");
        assert!(covariance(4, 5).abs() < 1e-12, "left and right have each their own");
    }
}
