//! Short holes in a channel, bridged by its own rhythm: a meter at half the rate of the wheels leaves every second row empty.

use crate::{
    Channel, Error, Recording, Repair,
    align::{Between, interpolate},
    gap::threshold_s,
    watch::Looks,
};

/// Fills every hole of a channel whose ends lie no farther apart than its own rhythm allows, run by run, and says how many were filled and how
/// many are left.
pub(crate) fn bridge(recording: &mut Recording, looks: &Looks) -> Result<Vec<Repair>, Error> {
    let mut looks = looks.clone();
    let mut told = Vec::new();
    let Recording { t_s, channels, runs, .. } = recording;
    for (channel, values) in channels {
        looks.worked(values.len())?;
        let missing = values.iter().filter(|value| value.is_nan()).count();
        if missing == 0 || missing == values.len() {
            continue;
        }
        let between = if *channel == Channel::Heading { Between::ShorterArc } else { Between::Line };
        let mut widest_s = 0.0_f64;
        for run in runs.iter() {
            let (Some(t_s), Some(own)) = (t_s.get(run.rows.clone()), values.get_mut(run.rows.clone())) else {
                continue;
            };
            let known: Vec<f64> =
                t_s.iter().zip(own.iter()).filter(|(_, x)| !x.is_nan()).map(|(t, _)| *t).collect();
            if known.len() < 2 || known.len() == own.len() {
                continue;
            }
            let most_s = threshold_s(&known);
            widest_s = widest_s.max(most_s);
            let filled = interpolate(t_s, own, t_s, most_s, between);
            own.copy_from_slice(&filled);
        }
        let left = values.iter().filter(|value| value.is_nan()).count();
        let rows = values.len();
        let bridged = missing - left;
        let how = format!("{bridged} were bridged between neighbours at most {widest_s:.3} s apart");
        told.push(Repair {
            place: channel.name().to_owned(),
            what: match (bridged, left) {
                (0, _) => format!("{missing} of {rows} rows have no value; they are not counted"),
                (_, 0) => format!("{missing} of {rows} rows have no value; {how}"),
                _ => format!("{missing} of {rows} rows have no value; {how}, and {left} are not counted"),
            },
        });
    }
    Ok(told)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{Run, unwatched};

    fn bridged(power_w: Vec<f64>) -> (Vec<f64>, Vec<Repair>) {
        let t_s: Vec<f64> = (0..power_w.len()).map(|i| 0.1 * i as f64).collect();
        let runs = vec![Run::new("drive".into(), 0..t_s.len(), &t_s, None)];
        let channels = BTreeMap::from([(Channel::Power, power_w)]);
        let mut recording = Recording { t_s, channels, runs, ..Recording::default() };
        let told = bridge(&mut recording, &Looks::new(&unwatched())).unwrap();
        (recording.channels.remove(&Channel::Power).unwrap(), told)
    }

    #[test]
    fn holes_of_a_slower_meter_are_bridged_at_any_ratio_and_said() {
        for every in [2_usize, 3, 10] {
            let sampled = |i: usize| if i.is_multiple_of(every) { i as f64 } else { f64::NAN };
            let (power_w, told) = bridged((0..301).map(sampled).collect());
            let worst = power_w.iter().enumerate().map(|(i, w)| (w - i as f64).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "every {every}: {worst}");
            assert!(told[0].what.contains("were bridged"), "{told:?}");
        }
    }

    #[test]
    fn a_meter_that_pauses_is_not_bridged_and_the_rows_are_said() {
        let (power_w, told) =
            bridged((0..300).map(|i| if (100..150).contains(&i) { f64::NAN } else { 7.0 }).collect());
        assert_eq!(power_w.iter().filter(|w| w.is_nan()).count(), 50);
        assert_eq!(told[0].what, "50 of 300 rows have no value; they are not counted");
    }
}
