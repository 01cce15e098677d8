//! What a battery's voltage says of the current that is drawn: it sags with it, whatever asks for the power and whatever a meter makes of it.
//!
//! A robot that draws more lets the voltage sag more; a meter that only reads more does not. How far the voltage lies below that of the
//! seconds around is held against the current that the meter says, so that neither the charge nor slow changes within the cells matter.

use std::collections::BTreeMap;

use calibration::Drives;
use recording::{Channel, PowerForm, Recording};

/// Length of the stretches in which voltages are held against each other [s]: the charge hardly changes in one.
const WINDOW_S: f64 = 20.0;
/// Seconds of a stretch that have to be recorded.
const LEAST_SECONDS: usize = 8;
/// Stretches from which the resistance of a drive is told.
const LEAST_WINDOWS: usize = 5;
/// Relative one-sigma error of the resistance beyond which voltages tell nothing: a source that does not sag, or drives at one power.
const LEAST_TOLD: f64 = 0.05;
/// Voltages of drives of one kind, beside the current that their power stands for.
pub(crate) struct Sag {
    /// Power of the battery, or of both sides, as a meter says it, by row [W].
    power_w: Vec<f64>,
    /// Voltage by row [V].
    volts: Vec<f64>,
    /// Stretch by average.
    window: Vec<usize>,
    /// Drive by average.
    run: Vec<usize>,
    /// Voltage less that of the stretch; NaN where it is not told [V].
    beyond_v: Vec<f64>,
}

impl Sag {
    /// The voltages of a recording, where it has them beside power of the battery or of both sides.
    pub(crate) fn of(recording: &Recording, drives: &Drives) -> Option<Sag> {
        let volts = recording.channel(Channel::Voltage)?;
        let power_w = recording.channel(Channel::Power);
        let mut power_w: Vec<f64> = match (drives.form?, power_w, &drives.recorded[..]) {
            (PowerForm::MotorCurrents, ..) => return None,
            (_, Some(power_w), _) => power_w.to_vec(),
            (_, None, [left_w, right_w]) => left_w.iter().zip(right_w).map(|(a, b)| a + b).collect(),
            (_, None, [power_w]) => power_w.clone(),
            _ => return None,
        };
        for run in &recording.runs {
            align(&mut power_w[run.rows.clone()], &volts[run.rows.clone()], &recording.t_s[run.rows.clone()]);
        }
        let mut names = BTreeMap::new();
        let mut window = Vec::with_capacity(drives.averages.len());
        for average in &drives.averages {
            let next = names.len();
            window.push(*names.entry((average.run, (average.t_s / WINDOW_S) as usize)).or_insert(next));
        }
        let run = drives.averages.iter().map(|average| average.run).collect();
        let mut sag = Sag { power_w, volts: volts.to_vec(), window, run, beyond_v: Vec::new() };
        let mut mean_v = drives.averaged(volts);
        let currents_a = drives.averaged_by(|row| sag.current_a(row, |w| w));
        mean_v.iter_mut().zip(currents_a).filter(|(_, a)| !a.is_finite()).for_each(|(v, _)| *v = f64::NAN);
        sag.beyond_v = sag.beyond(&mean_v, &mean_v);
        Some(sag)
    }

    /// Current of a row by its power, as a meter has read it [A].
    pub(crate) fn current_a(&self, row: usize, read: impl Fn(f64) -> f64) -> f64 {
        // What meters make of power is a factor and a sum.
        let (none_w, per_watt) = (read(0.0), read(1.0) - read(0.0));
        (self.power_w[row] - none_w) / per_watt / self.volts[row]
    }

    /// Voltages, average by average; NaN where they are not told [V].
    pub(crate) fn beyond_v(&self) -> &[f64] {
        &self.beyond_v
    }

    /// Currents, average by average, less those of the stretch; NaN where voltages are not told [A].
    pub(crate) fn beyond_a(&self, current_a: &[f64]) -> Vec<f64> {
        self.beyond(current_a, &self.beyond_v)
    }

    /// Values less a straight line through those of each stretch, where others are known.
    fn beyond(&self, values: &[f64], known: &[f64]) -> Vec<f64> {
        let mut places: Vec<Vec<usize>> =
            vec![Vec::new(); self.window.iter().max().map_or(0, |last| last + 1)];
        for (i, window) in self.window.iter().enumerate().filter(|(i, _)| known[*i].is_finite()) {
            places[*window].push(i);
        }
        let mut beyond = vec![f64::NAN; values.len()];
        for own in places.iter().filter(|own| own.len() >= LEAST_SECONDS) {
            let count = own.len() as f64;
            let mean = own.iter().map(|i| values[*i]).sum::<f64>() / count;
            let middle = 0.5 * (count - 1.0);
            let times = || (0..own.len()).map(|k| k as f64 - middle);
            let slope = own.iter().zip(times()).map(|(i, t)| t * values[*i]).sum::<f64>()
                / times().map(|t| t * t).sum::<f64>();
            own.iter().zip(times()).for_each(|(i, t)| beyond[*i] = values[*i] - mean - slope * t);
        }
        beyond
    }

    /// Resistances of the drives by how far their voltages sag, each with its relative one-sigma error [Ω].
    fn resistances_ohm(&self, current_a: &[f64]) -> Vec<[f64; 2]> {
        let beyond_a = self.beyond_a(current_a);
        let mut sums: BTreeMap<usize, BTreeMap<usize, [f64; 2]>> = BTreeMap::new();
        for (i, (a, v)) in beyond_a.iter().zip(&self.beyond_v).enumerate() {
            if a.is_finite() && v.is_finite() {
                let [both, own] = sums.entry(self.run[i]).or_default().entry(self.window[i]).or_default();
                *both -= a * v;
                *own += a * a;
            }
        }
        let of_drive = |windows: &BTreeMap<usize, [f64; 2]>| {
            let [both, own] = windows.values().fold([0.0; 2], |[p, q], [both, own]| [p + both, q + own]);
            let ohm = both / own;
            let scatter = windows.values().map(|[both, own]| (both - ohm * own).powi(2)).sum::<f64>().sqrt();
            let is_told = windows.len() >= LEAST_WINDOWS && ohm > 0.0 && ohm.is_finite();
            is_told.then(|| [ohm, scatter / both])
        };
        sums.values().filter_map(of_drive).collect()
    }
}

/// Length of what is brought to the same time together [s].
const ALIGNED_S: f64 = 100.0;
/// How far apart meters of power and voltage are, at most [s].
const MOST_APART_S: f64 = 1.0;

/// Brings power of one drive to the time of voltages, part by part: meters may be late by themselves, and which of them is nobody's business
/// here.
fn align(power_w: &mut [f64], volts: &[f64], t_s: &[f64]) {
    let Some((first_s, last_s)) = t_s.first().zip(t_s.last()) else { return };
    let row_s = (last_s - first_s) / (t_s.len() as f64 - 1.0).max(1.0);
    if row_s.is_nan() || row_s <= 0.0 {
        return;
    }
    let most = (MOST_APART_S / row_s) as isize;
    let part = ((ALIGNED_S / row_s) as usize).max(1);
    let recorded_w = power_w.to_vec();
    let later = |row: usize, by: isize| {
        row.checked_add_signed(by).and_then(|row| recorded_w.get(row)).copied().unwrap_or(f64::NAN)
    };
    for start in (0..power_w.len()).step_by(part) {
        let rows = start..(start + part).min(power_w.len());
        let likeness = |by: isize| {
            let known = |row: &usize| later(*row, by).is_finite() && volts[*row].is_finite();
            correlation(rows.clone().filter(known).map(|row| [-later(row, by), volts[row]]))
        };
        let shifts = (0..=most).flat_map(|by| [-by, by]);
        // Of shifts as good the least.
        let best = shifts.fold((0, f64::NEG_INFINITY), |best, by| match likeness(by) {
            found if found > best.1 => (by, found),
            _ => best,
        });
        rows.for_each(|row| power_w[row] = later(row, best.0));
    }
}

/// Correlation of the changes of two quantities, pair by pair; 0 where one does not change.
fn correlation(pairs: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let count = pairs.clone().count().max(1) as f64;
    let [sum_a, sum_b] = pairs.clone().fold([0.0; 2], |[p, q], [a, b]| [p + a, q + b]);
    let (mean_a, mean_b) = (sum_a / count, sum_b / count);
    let [aa, ab, bb] = pairs.fold([0.0; 3], |[aa, ab, bb], [a, b]| {
        let (a, b) = (a - mean_a, b - mean_b);
        [aa + a * a, ab + a * b, bb + b * b]
    });
    if aa * bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// How voltages follow currents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Source {
    /// Resistance [Ω].
    pub(crate) resistance_ohm: f64,
}

impl Source {
    /// What some drives show, by currents average by average; `None` where voltages do not tell it.
    pub(crate) fn of(sag: &Sag, current_a: &[f64]) -> Option<Source> {
        let seen = sag.resistances_ohm(current_a);
        let weights: Vec<f64> = seen.iter().map(|[ohm, error]| (ohm * error).max(1e-12).powi(-2)).collect();
        let whole: f64 = weights.iter().sum();
        let mean_ohm = seen.iter().zip(&weights).map(|([ohm, _], weight)| weight * ohm).sum::<f64>() / whole;
        let is_told = !seen.is_empty() && whole.sqrt().recip() < LEAST_TOLD * mean_ohm;
        is_told.then_some(Source { resistance_ohm: mean_ohm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two drives of 200 s at 1 Hz of a pack whose charge falls, with resistances of their own, and the currents of their seconds.
    fn drives(resistances_ohm: [f64; 2]) -> (Sag, Vec<f64>) {
        let current_a: Vec<f64> = (0..400).map(|i| 4.0 + 3.0 * (0.9 * f64::from(i)).sin()).collect();
        let open_v = |i: usize| 25.0 - 0.001 * i as f64;
        let volts: Vec<f64> = (0..400).map(|i| open_v(i) - resistances_ohm[i / 200] * current_a[i]).collect();
        let mut sag = Sag {
            power_w: volts.iter().zip(&current_a).map(|(v, a)| v * a).collect(),
            window: (0..400).map(|i| i / 20).collect(),
            run: (0..400).map(|i| i / 200).collect(),
            beyond_v: Vec::new(),
            volts,
        };
        sag.beyond_v = sag.beyond(&sag.volts, &sag.volts);
        (sag, current_a)
    }

    #[test]
    fn the_resistance_is_told_whatever_the_charge_does() {
        let (sag, current_a) = drives([0.05, 0.05]);
        let alike = Source::of(&sag, &current_a).unwrap();
        assert!((alike.resistance_ohm - 0.05).abs() < 1e-9, "{alike:?}");
    }

    #[test]
    fn currents_are_what_meters_read_without_their_faults() {
        let (sag, current_a) = drives([0.05, 0.05]);
        let askew = Sag { power_w: sag.power_w.iter().map(|w| 1.1 * w + 7.0).collect(), ..sag };
        for (row, current_a) in current_a.iter().enumerate() {
            let found_a = askew.current_a(row, |w| 1.1 * w + 7.0);
            assert!((found_a - current_a).abs() < 1e-9, "row {row}: {found_a} A for {current_a} A");
        }
    }

    #[test]
    fn a_source_that_does_not_sag_and_drives_at_one_power_tell_nothing() {
        let (sag, current_a) = drives([0.0, 0.0]);
        assert_eq!(Source::of(&sag, &current_a), None);
        let (sag, _) = drives([0.05, 0.05]);
        assert_eq!(Source::of(&sag, &[4.0; 400]), None);
    }

    #[test]
    fn power_is_brought_to_the_time_of_voltages() {
        let power_w: Vec<f64> =
            (0..1000).map(|i| 100.0 + 60.0 * (0.05 * f64::from(i * i % 977)).sin()).collect();
        let t_s: Vec<f64> = (0..1000).map(|i| 0.1 * f64::from(i)).collect();
        let volts: Vec<f64> = power_w.iter().map(|w| 25.0 - 0.002 * w).collect();
        // A meter that is three rows late.
        let mut late_w: Vec<f64> = (0..1000).map(|i: usize| power_w[i.saturating_sub(3)]).collect();
        align(&mut late_w, &volts, &t_s);
        assert_eq!(late_w[..997], power_w[..997]);
        let mut punctual_w = power_w.clone();
        align(&mut punctual_w, &volts, &t_s);
        assert_eq!(punctual_w, power_w);
    }
}
