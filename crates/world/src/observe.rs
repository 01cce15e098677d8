//! From the truth to a recording: sensors with noise, bias, drift, steps, delays and gaps.

use crate::{
    Effect, Instant, Log, Row, Sensors, World,
    effect::{Act, Distortion},
    random::Random,
    simulate::INSTANTS_PER_ROW,
};

/// Rim speed from which on an encoder is as noisy as it gets [m/s].
const FULL_JITTER_MPS: f64 = 0.05;
/// How long the error of a position remembers itself [s].
const POSITION_MEMORY_S: f64 = 30.0;

/// The recording of all runs.
pub(crate) fn observe(world: &World, truth: &[Vec<Instant>], surfaces: Vec<String>) -> Log {
    let mut observer = Observer::new(world);
    let mut rows = Vec::new();
    for (run, instants) in truth.iter().enumerate() {
        let count = instants.len().saturating_sub(1) / INSTANTS_PER_ROW;
        observer.rim_before = None;
        rows.extend((1..=count).map(|k| observer.row(run + 1, instants, k * INSTANTS_PER_ROW)));
    }
    Log { sensors: world.sensors.clone(), surfaces, rows }
}

/// A group of sensors that fails together.
#[derive(Debug)]
struct Gap {
    random: Random,
    rows_left: f64,
}

impl Gap {
    /// Whether this row is one. Two numbers are drawn for each row, whatever happens.
    fn opens(&mut self, sensors: &Sensors) -> bool {
        let begins = self.random.chance(sensors.dropouts / sensors.dropout_rows);
        let length = -sensors.dropout_rows * (1.0 - self.random.between(0.0, 1.0)).ln();
        self.rows_left = if self.rows_left > 0.0 {
            self.rows_left - 1.0
        } else if begins {
            length.ceil()
        } else {
            0.0
        };
        self.rows_left > 0.0
    }
}

/// All sensors with what they remember.
#[derive(Debug)]
struct Observer<'a> {
    sensors: &'a Sensors,
    effects: Vec<(Effect, Box<dyn Act>)>,
    row_s: f64,
    speed: [Random; 2],
    power: [Random; 3],
    power_error: [f64; 3],
    gyro: Random,
    gyro_bias_radps: f64,
    tilt: [Random; 2],
    tilt_bias_rad: [f64; 2],
    position: [Random; 3],
    position_error_m: [f64; 3],
    other: Random,
    gaps: [Gap; 4],
    /// Encoder readings of the row before [m].
    rim_before: Option<[f64; 2]>,
}

impl<'a> Observer<'a> {
    fn new(world: &'a World) -> Self {
        let stream = |purpose: &str| Random::new(world.seed, purpose);
        let sensors = &world.sensors;
        let mut biases = Random::new(world.robot_seed(), "biases");
        let gap = |purpose| Gap { random: stream(purpose), rows_left: 0.0 };
        Observer {
            sensors,
            effects: world.effects.iter().map(|e| (e.clone(), e.actor())).collect(),
            row_s: 1.0 / sensors.rate_hz,
            speed: [stream("left encoder"), stream("right encoder")],
            power: [stream("left power"), stream("right power"), stream("battery power")],
            power_error: [0.0; 3],
            gyro: stream("gyroscope"),
            gyro_bias_radps: sensors.yaw_rate_bias_radps * biases.normal(),
            tilt: [stream("pitch"), stream("roll")],
            tilt_bias_rad: [sensors.tilt_bias_rad * biases.normal(), sensors.tilt_bias_rad * biases.normal()],
            position: [stream("x"), stream("y"), stream("z")],
            position_error_m: [0.0; 3],
            other: stream("other"),
            gaps: [gap("encoder gaps"), gap("power gaps"), gap("tilt gaps"), gap("position gaps")],
            rim_before: None,
        }
    }

    /// The row whose window ends at an instant.
    fn row(&mut self, run: usize, truth: &[Instant], end: usize) -> Row {
        let (before, now) = (truth[end - INSTANTS_PER_ROW], truth[end]);
        let distortion = self.distortion(&now);
        let [no_rims, no_power, no_tilt, no_position] =
            [0, 1, 2, 3].map(|i| self.gaps[i].opens(self.sensors));
        let hide = |hidden: bool, value: f64| if hidden { f64::NAN } else { value };
        let late_s = self.sensors.power_delay_s + distortion.power_late_s;
        let watts = self.watts(truth, end, late_s, &distortion);
        let rim_mps = self.rims(&before, &now, &distortion);
        let [pitch_rad, roll_rad] = self.tilts(truth, end, &distortion);
        let position_m = self.position(&now);
        let yaw_rate_radps = self.yaw_rate(&before, &now);
        let noise = [(); 4].map(|()| self.other.normal());
        let amperes = [0, 1].map(|i| {
            let mean_a = (now.motor_as[i] - before.motor_as[i]) / self.row_s;
            // What a gain and a step do to watts they do to amperes, at about the nominal voltage.
            (mean_a * (1.0 + self.sensors.power_gain_noise * noise[i]) * distortion.power_factor).max(0.0)
        });
        let warm = |i: usize| quantised(now.case_c[i], self.sensors.temperature_step_k);
        let acceleration = (now.speed_mps - before.speed_mps) / self.row_s;
        Row {
            t_s: now.t_s,
            run,
            rim_mps: rim_mps.map(|v| hide(no_rims, v)),
            side_w: [hide(no_power, watts[0]), hide(no_power, watts[1])],
            battery_w: hide(no_power, watts[2]),
            voltage_v: hide(no_power, now.voltage_v + self.sensors.voltage_noise_v * noise[2]),
            motor_a: amperes.map(|a| hide(no_power, a)),
            yaw_rate_radps: hide(no_tilt, yaw_rate_radps),
            pitch_rad: hide(no_tilt, pitch_rad),
            roll_rad: hide(no_tilt, roll_rad),
            acceleration_mps2: hide(no_tilt, acceleration + self.sensors.acceleration_noise_mps2 * noise[3]),
            position_m: position_m.map(|p| hide(no_position, p)),
            motor_c: [hide(no_power, warm(0)), hide(no_power, warm(1))],
            surface: now.surface,
        }
    }

    fn distortion(&self, now: &Instant) -> Distortion {
        let mut distortion = Distortion::default();
        for (effect, actor) in &self.effects {
            if effect.acts(now.t_s, [now.x_m, now.y_m]) {
                actor.distort(&mut distortion);
            }
        }
        distortion
    }

    /// Rim speeds from counts of the encoders.
    fn rims(&mut self, before: &Instant, now: &Instant, distortion: &Distortion) -> [f64; 2] {
        let count = |m: f64| quantised(m, self.sensors.encoder_step_m);
        let start = self.rim_before.unwrap_or(before.rim_m.map(count));
        let end = now.rim_m.map(count);
        self.rim_before = Some(end);
        [0, 1].map(|i| {
            let true_mps = (now.rim_m[i] - before.rim_m[i]) / self.row_s;
            // The jitter of an encoder's edges stands still with the wheel.
            let jitter = (true_mps.abs() / FULL_JITTER_MPS).min(1.0);
            let noise_mps = self.sensors.speed_noise_mps * jitter * self.speed[i].normal();
            (end[i] - start[i]) / self.row_s * distortion.rim_factor + noise_mps
        })
    }

    /// Powers of both sides and the battery over a window that ended `late_s` ago.
    fn watts(&mut self, truth: &[Instant], end: usize, late_s: f64, distortion: &Distortion) -> [f64; 3] {
        let late = late_s / self.row_s * INSTANTS_PER_ROW as f64;
        let last = at(truth, end as f64 - late);
        let first = at(truth, end as f64 - late - INSTANTS_PER_ROW as f64);
        let memory = (-self.row_s / self.sensors.power_noise_memory_s.max(1e-9)).exp();
        [0, 1, 2].map(|i| {
            let mean_w = (last.drawn_j[i] - first.drawn_j[i]) / self.row_s;
            let fresh = (1.0 - memory * memory).sqrt() * self.power[i].normal();
            self.power_error[i] = memory * self.power_error[i] + fresh;
            let sigma_w = self.sensors.power_noise_w.hypot(self.sensors.power_gain_noise * mean_w);
            let read_w =
                mean_w * distortion.power_factor + distortion.power_w + sigma_w * self.power_error[i];
            quantised(read_w, self.sensors.power_step_w)
        })
    }

    fn yaw_rate(&mut self, before: &Instant, now: &Instant) -> f64 {
        // A random walk that is as far as the drift says after an hour.
        let walk = self.sensors.yaw_rate_drift_radps * (self.row_s / 3600.0).sqrt() * self.gyro.normal();
        self.gyro_bias_radps += walk;
        let noise = self.sensors.yaw_rate_noise_radps * self.gyro.normal();
        (now.heading_rad - before.heading_rad) / self.row_s + self.gyro_bias_radps + noise
    }

    /// Pitch and roll over the window of the row.
    fn tilts(&mut self, truth: &[Instant], end: usize, distortion: &Distortion) -> [f64; 2] {
        let window = &truth[end - INSTANTS_PER_ROW + 1..=end];
        let mean = |angle: fn(&Instant) -> f64| window.iter().map(angle).sum::<f64>() / window.len() as f64;
        let truth = [mean(|i| i.pitch_rad) + distortion.pitch_rad, mean(|i| i.roll_rad)];
        [0, 1].map(|i| truth[i] + self.tilt_bias_rad[i] + self.sensors.tilt_noise_rad * self.tilt[i].normal())
    }

    fn position(&mut self, now: &Instant) -> [f64; 3] {
        let memory = (-self.row_s / POSITION_MEMORY_S).exp();
        let truth = [now.x_m, now.y_m, now.z_m];
        [0, 1, 2].map(|i| {
            let fresh = (1.0 - memory * memory).sqrt() * self.position[i].normal();
            self.position_error_m[i] =
                memory * self.position_error_m[i] + self.sensors.position_noise_m * fresh;
            truth[i] + self.position_error_m[i]
        })
    }
}

/// The truth between instants; before the first nothing had happened, after the last nothing more does.
fn at(truth: &[Instant], place: f64) -> Instant {
    let place = place.clamp(0.0, (truth.len() - 1) as f64);
    let low = (place as usize).min(truth.len().saturating_sub(2));
    truth[low].between(&truth[(low + 1).min(truth.len() - 1)], place - low as f64)
}

fn quantised(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}
