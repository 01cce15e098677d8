//! Where the energy went.

/// Energies since the start of a drive [J]. What the cells gave is everything else together, to the error of the integration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Given by the cells of the battery.
    pub given_j: f64,
    /// Heat of the battery.
    pub battery_j: f64,
    /// Electronics: hotel load, drivers' own draw, and what effects draw there.
    pub electronics_j: f64,
    /// Heat of the windings.
    pub copper_j: f64,
    /// Heat of conversion and drivers.
    pub conversion_j: f64,
    /// Heat of gears, belts and brakes.
    pub gears_j: f64,
    /// Heat of rolling tyres and soil.
    pub rolling_j: f64,
    /// Heat of tyres that slide.
    pub sliding_j: f64,
    /// Given to wind, trailers and other forces from outside.
    pub outside_j: f64,
    /// Kinetic energy now, less that at the start.
    pub kinetic_j: f64,
    /// Potential energy gained.
    pub potential_j: f64,
}

impl Ledger {
    /// Everything but what the cells gave [J].
    pub fn spent_j(&self) -> f64 {
        self.battery_j
            + self.electronics_j
            + self.copper_j
            + self.conversion_j
            + self.gears_j
            + self.rolling_j
            + self.sliding_j
            + self.outside_j
            + self.kinetic_j
            + self.potential_j
    }
}
