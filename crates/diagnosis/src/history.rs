//! What a robot did before, as far as power may follow it: since when it has not stood still, and how much it drove of late.

use calibration::Drives;

/// Time in which what driving has warmed cools to a third \[s\]: brakes, grease and tyres take minutes.
const COOLS_S: f64 = 300.0;

/// By row: time since the robot last stood still, as far as the stretch tells [s].
pub(crate) fn moving_s(drives: &Drives) -> Vec<f64> {
    let mut moving_s = vec![0.0; drives.rows.len()];
    for stretch in &drives.stretches {
        let mut since_s = 0.0;
        for i in stretch.rows.clone() {
            let row = &drives.rows[i];
            since_s = if row.stands() { 0.0 } else { since_s + row.step_s };
            moving_s[i] = since_s;
        }
    }
    moving_s
}

/// By row: way driven in the same run, of which less and less counts the longer ago it was; gaps are taken for rests [m].
pub(crate) fn of_late_m(drives: &Drives) -> Vec<f64> {
    let mut of_late_m = vec![0.0; drives.rows.len()];
    let mut last: Option<(usize, f64, f64)> = None;
    for stretch in &drives.stretches {
        for i in stretch.rows.clone() {
            let row = &drives.rows[i];
            let before_m = match last {
                Some((run, t_s, m)) if run == stretch.run => m * (-(row.t_s - t_s).max(0.0) / COOLS_S).exp(),
                _ => 0.0,
            };
            of_late_m[i] = before_m + row.speed_mps().abs() * row.step_s;
            last = Some((stretch.run, row.t_s, of_late_m[i]));
        }
    }
    of_late_m
}

#[cfg(test)]
mod tests {
    use calibration::{drives::Stretch, row::Row};

    use super::*;

    /// Ten minutes at 0.5 m/s, five of rest, and another run.
    fn drives() -> Drives {
        let row = |(i, speed_mps): (usize, f64)| Row {
            t_s: i as f64,
            step_s: if i == 0 || i == 900 { 0.0 } else { 1.0 },
            rim_mps: model::Sides { left: speed_mps, right: speed_mps },
            ..Row::default()
        };
        let speeds_mps = [vec![0.5; 600], vec![0.0; 300], vec![0.5; 10]].concat();
        let rows = speeds_mps.into_iter().enumerate().map(row).collect();
        let mut drives = Drives::default();
        drives.rows = rows;
        drives.stretches = vec![
            Stretch { run: 0, surface: 0, rows: 0..900 },
            Stretch { run: 1, surface: 0, rows: 900..910 },
        ];
        drives
    }

    #[test]
    fn driving_of_late_saturates_fades_at_rest_and_starts_anew_with_each_run() {
        let of_late_m = of_late_m(&drives());
        // x' = v - x/T: x = v T (1 - e^(-t/T)).
        let driven_m = 0.5 * COOLS_S * (1.0 - (-599.0 / COOLS_S).exp());
        assert!((of_late_m[599] / driven_m - 1.0).abs() < 0.01, "{} {driven_m}", of_late_m[599]);
        assert!((of_late_m[899] / of_late_m[599] - (-300.0 / COOLS_S).exp()).abs() < 1e-9);
        assert_eq!(of_late_m[900], 0.0);
    }

    #[test]
    fn a_rest_begins_the_time_since_it_anew() {
        let moving_s = moving_s(&drives());
        assert_eq!([moving_s[0], moving_s[599], moving_s[899], moving_s[909]], [0.0, 599.0, 0.0, 9.0]);
    }
}
