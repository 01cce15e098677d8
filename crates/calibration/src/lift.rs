//! The paper's lifting test: k1 and k2 of each side from lifts of a known weight.

use model::{
    Robot,
    fit::{LiftSample, motor_from_lifts},
};

use crate::Error;

/// Lifts by side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lifts {
    /// Of the left side.
    pub left: Vec<LiftSample>,
    /// Of the right side.
    pub right: Vec<LiftSample>,
}

const COLUMNS: [&str; 4] = ["side", "force_n", "rim_speed_mps", "power_w"];

/// Reads a table with the columns `side` (`left` or `right`), `force_n`, `rim_speed_mps` and `power_w`, separated by commas.
///
/// # Errors
/// [`Error::Lift`] with line and column.
pub fn read(text: &str) -> Result<Lifts, Error> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let wrong = |line: usize, column: &str, found: &str| Error::Lift {
        line: line + 1,
        column: column.to_owned(),
        found: found.chars().take(60).collect(),
    };
    let (_, head) = lines.next().ok_or_else(|| wrong(0, "side", "nothing"))?;
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let mut places = [0; 4];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = names.iter().position(|name| *name == column).ok_or_else(|| wrong(0, column, head))?;
    }
    let mut lifts = Lifts::default();
    for (number, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let cell = |i: usize| cells.get(places[i]).copied().unwrap_or("");
        let value = |i: usize| {
            let parsed = cell(i).parse::<f64>().ok().filter(|v| v.is_finite());
            parsed.ok_or_else(|| wrong(number, COLUMNS[i], cell(i)))
        };
        let sample = LiftSample { force_n: value(1)?, rim_speed_mps: value(2)?, power_w: value(3)? };
        match cell(0) {
            "left" => lifts.left.push(sample),
            "right" => lifts.right.push(sample),
            other => return Err(wrong(number, "side", other)),
        }
    }
    Ok(lifts)
}

/// The robot with the motor constants that the lifts show; a side without lifts keeps its own.
///
/// # Errors
/// [`Error::Robot`] where a side was lifted at one speed only, or the constants found cannot be.
pub fn apply(robot: &Robot, lifts: &Lifts) -> Result<Robot, Error> {
    let mut robot = robot.clone();
    for (samples, motor) in [(&lifts.left, &mut robot.motors.left), (&lifts.right, &mut robot.motors.right)] {
        if !samples.is_empty() {
            let found = motor_from_lifts(samples)?;
            (motor.k1_w_per_n2, motor.k2) = (found.k1_w_per_n2, found.k2);
        }
    }
    robot.validate()?;
    Ok(robot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lifts_of_one_side_change_that_side_only_and_a_bad_cell_is_named() {
        let mut text = "side,force_n,rim_speed_mps,power_w\n".to_owned();
        for speed in [0.1, 0.3, 0.5] {
            text += &format!("left,60,{speed},{}\n", 0.003 * 3600.0 + 1.8 * speed * 60.0);
        }
        let husky = model::builtin::husky_a200();
        let robot = apply(&husky, &read(&text).unwrap()).unwrap();
        assert!(
            (robot.motors.left.k1_w_per_n2 - 0.003).abs() < 1e-9 && (robot.motors.left.k2 - 1.8).abs() < 1e-9
        );
        assert_eq!(robot.motors.right, husky.motors.right);
        let message = read(&(text + "left,60,fast,20\n")).unwrap_err().to_string();
        assert!(
            message.contains("line 5") && message.contains("rim_speed_mps") && message.contains("fast"),
            "{message}"
        );
    }
}
