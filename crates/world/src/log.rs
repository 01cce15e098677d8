//! A recording in the columns of the contract.

use std::io::{self, Write};

use crate::{PowerChannels, Sensors};

/// One row; NaN is a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time, the end of the window that the row averages over [s].
    pub t_s: f64,
    /// Which run, from 1.
    pub run: usize,
    /// Rim speeds, left and right [m/s].
    pub rim_mps: [f64; 2],
    /// Power at both drivers [W].
    pub side_w: [f64; 2],
    /// Power at the battery [W].
    pub battery_w: f64,
    /// Voltage of the battery [V].
    pub voltage_v: f64,
    /// Currents of both motors, without sign [A].
    pub motor_a: [f64; 2],
    /// Yaw rate [rad/s].
    pub yaw_rate_radps: f64,
    /// Pitch [rad].
    pub pitch_rad: f64,
    /// Roll [rad].
    pub roll_rad: f64,
    /// Forward acceleration [m/s²].
    pub acceleration_mps2: f64,
    /// Position [m].
    pub position_m: [f64; 3],
    /// Case temperatures [°C].
    pub motor_c: [f64; 2],
    /// Index of the surface.
    pub surface: usize,
}

/// A recorded drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// Which columns there are.
    pub sensors: Sensors,
    /// Names of the surfaces.
    pub surfaces: Vec<String>,
    /// Rows in order of time.
    pub rows: Vec<Row>,
}

/// A column of numbers: its name and where a row has it.
type Column = (&'static str, fn(&Row) -> f64);

impl Log {
    /// The columns of numbers that its sensors tell, by the contract's names.
    pub fn columns(&self) -> Vec<Column> {
        let mut columns: Vec<Column> =
            vec![("t_s", |r| r.t_s), ("v_left_mps", |r| r.rim_mps[0]), ("v_right_mps", |r| r.rim_mps[1])];
        columns.extend(power_columns(self.sensors.power));
        columns.extend([
            ("yaw_rate_radps", (|r| r.yaw_rate_radps) as fn(&Row) -> f64),
            ("pitch_rad", |r| r.pitch_rad),
            ("roll_rad", |r| r.roll_rad),
        ]);
        if self.sensors.acceleration {
            columns.push(("accel_forward_mps2", |r| r.acceleration_mps2));
        }
        if self.sensors.motor_temperature {
            columns.extend([
                ("motor_temp_left_c", (|r| r.motor_c[0]) as fn(&Row) -> f64),
                ("motor_temp_right_c", |r| r.motor_c[1]),
            ]);
        }
        if self.sensors.position {
            columns.extend([
                ("x_m", (|r| r.position_m[0]) as fn(&Row) -> f64),
                ("y_m", |r| r.position_m[1]),
                ("z_m", |r| r.position_m[2]),
            ]);
        }
        columns
    }

    /// Adds what the same sensors recorded later on the same ground, as further runs.
    pub(crate) fn go_on(&mut self, next: Log) {
        let (runs, until_s) = self.rows.last().map_or((0, 0.0), |last| (last.run, last.t_s));
        let later = |row: Row| Row { run: row.run + runs, t_s: row.t_s + until_s, ..row };
        self.rows.extend(next.rows.into_iter().map(later));
    }

    /// Writes it as comma-separated text; gaps are empty cells.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, mut to: impl Write) -> io::Result<()> {
        let columns = self.columns();
        let names: Vec<&str> = columns.iter().map(|column| column.0).collect();
        write!(to, "{}", names.join(","))?;
        writeln!(to, "{}", if self.sensors.surface { ",surface,run" } else { ",run" })?;
        for row in &self.rows {
            for (i, (name, value)) in columns.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                let (value, digits) = (value(row), digits(name));
                if value.is_nan() { write!(to, "{comma}")? } else { write!(to, "{comma}{value:.digits$}")? }
            }
            if self.sensors.surface {
                write!(to, ",{}", self.surfaces.get(row.surface).map_or("", String::as_str))?;
            }
            writeln!(to, ",{}", row.run)?;
        }
        to.flush()
    }
}

/// Digits behind the point: more than any sensor of a default set resolves.
fn digits(name: &str) -> usize {
    if name.ends_with("_w") || name.ends_with("_c") { 3 } else { 6 }
}

fn power_columns(power: PowerChannels) -> Vec<Column> {
    let sides: [Column; 2] = [("power_left_w", |r| r.side_w[0]), ("power_right_w", |r| r.side_w[1])];
    match power {
        PowerChannels::Sides => sides.to_vec(),
        PowerChannels::Battery => vec![("power_w", |r| r.battery_w)],
        PowerChannels::SidesAndBattery => {
            let battery: [Column; 2] = [("power_w", |r| r.battery_w), ("voltage_v", |r| r.voltage_v)];
            [sides, battery].concat()
        }
        PowerChannels::CurrentAndVoltage => {
            vec![("current_a", |r| r.battery_w / r.voltage_v), ("voltage_v", |r| r.voltage_v)]
        }
        PowerChannels::MotorCurrents => {
            vec![("motor_current_left_a", |r| r.motor_a[0]), ("motor_current_right_a", |r| r.motor_a[1])]
        }
    }
}
