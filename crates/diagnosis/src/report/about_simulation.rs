//! A report about another simulation: its predictions where those of the robot's file stood.

use recording::Recording;

use crate::report::diagnosis::Diagnosis;

/// What such a report has to say of itself.
const SAID: &str = "the simulation stands in the place of the robot file's prediction; what it left out is given as the robot's model \
     has it, beside constants that may differ as far as the file says; the corrected robot is the file with what was found; \
     the battery's voltage is not compared, without which a payload and a power meter that reads in proportion too much are easily mistaken for one another";

/// Puts power back that was taken off the recording to stand beside the file's prediction; `offset_w` is by row of the recording.
pub(crate) fn about_simulation(report: &mut Diagnosis, recording: &Recording, offset_w: &[f64]) {
    let trace = &mut report.trace;
    let (mut sum_w, mut count) = (0.0, 0.0);
    for i in 0..trace.t_s.len() {
        let offset_w = around(recording, offset_w, trace.run[i], trace.t_s[i]);
        for power_w in [&mut trace.recorded_w[i], &mut trace.filed_w[i], &mut trace.corrected_w[i]] {
            *power_w += offset_w;
        }
        (sum_w, count) = (sum_w + offset_w, count + 1.0);
    }
    if let Some(file) = &mut report.file {
        file.error.mean_power_w += sum_w / f64::max(count, 1.0);
    }
    report.notes.push(SAID.to_owned());
}

/// Mean over the second around so long after a drive began; 0 where nothing is known [W].
fn around(recording: &Recording, offset_w: &[f64], run: usize, t_s: f64) -> f64 {
    let Some(run) = recording.runs.get(run) else { return 0.0 };
    let Some(times) = recording.t_s.get(run.rows.clone()) else { return 0.0 };
    let middle_s = times.first().copied().unwrap_or(0.0) + t_s;
    let rows =
        [middle_s - 0.5, middle_s + 0.5].map(|t_s| run.rows.start + times.partition_point(|t| *t < t_s));
    let known = offset_w.get(rows[0]..rows[1]).unwrap_or(&[]).iter().filter(|w| w.is_finite());
    known.clone().sum::<f64>() / known.count().max(1) as f64
}
