//! A battery as it is drawn empty and charged: Peukert's law, sag, and how much of what comes back it takes.

use model::robot::Battery;

/// A battery in the state it is in: its age and temperature are worked in, its charge is the caller's.
///
/// Discharging, with Peukert's law in the form that adds up over a current that changes,
///
/// ```text
/// dq/dt = −(I/C) max(1, I/I_n)^(k−1),   I_n = C/H,   P = I V,   V = V_o(q) − R I
/// ```
///
/// q charge as a fraction of the capacity, C capacity [A s] at the rate of H hours, I_n the rated current, k Peukert's exponent,
/// V_o voltage without load, linear in q, R resistance, P power at the terminals. At a constant current this is Peukert's
/// t = H (C/(I H))^k (Peukert 1897; Doerffel & Sharkh, J. Power Sources 155 (2006) 395, doi:10.1016/j.jpowsour.2005.04.030).
/// Below the rated current nothing is gained. Pauses, in which a real pack recovers, are not credited: the law errs on the safe
/// side there, as the same paper shows.
///
/// Charging, `dq/dt = η I/C` with I no more than the cells take: `c C` up to 80 % of charge, from there falling with the
/// room that is left (absorption), nothing when full. What they do not take is lost in the drives.
///
/// The capacity is `C = a (1 + β (T − 25 °C)) C_new`, a ageing, β its change per kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pack {
    /// C: charge of a full pack [A s].
    capacity_as: f64,
    /// I_n: the current that the capacity is rated for [A].
    rated_a: f64,
    /// k − 1 [-].
    peukert_excess: f64,
    nominal_v: f64,
    empty_v: f64,
    /// By how much a full pack has more voltage than an empty one [V].
    span_v: f64,
    resistance_ohm: f64,
    cutoff_v: f64,
    /// c C: the largest charging current [A].
    most_charging_a: f64,
    efficiency: f64,
}

/// What a pack did for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delivery {
    /// Charge afterwards, 1 full; below 0 it tells by how much the pack was overdrawn.
    pub charge: f64,
    /// Voltage at the terminals [V].
    pub voltage_v: f64,
    /// Energy drawn at the terminals, negative where the pack was charged [J].
    pub drawn_j: f64,
    /// Energy that came back and that the pack did not take [J].
    pub refused_j: f64,
}

/// Charge up to which cells take the largest charging current (Linden & Reddy, Handbook of Batteries, 3rd ed., §24.8).
const ABSORPTION_FROM: f64 = 0.8;
/// Least share of that current that cells take until they are full: what a charger floats them at.
const FLOAT_SHARE: f64 = 0.02;
/// Shortest time over which voltage and acceptance are held [s].
const HELD_S: f64 = 20.0;
/// Change of the charge over which they are held however long it takes: the open voltage changes by a hundredth of a per cent.
const HELD_CHARGE: f64 = 1e-3;
/// Most stretches of one delivery: twice as many as a pack from full to empty has, after which the rest is one.
const MOST_HELD: usize = 2000;

/// What flows at one moment.
#[derive(Clone, Copy, Debug)]
struct Flow {
    /// Change of the charge [1/s].
    charge_per_s: f64,
    voltage_v: f64,
    drawn_w: f64,
    refused_w: f64,
}

impl Pack {
    /// The pack that a robot file describes, with `capacity_factor` times the capacity.
    pub fn new(file: &Battery, capacity_factor: f64) -> Self {
        let capacity_as = capacity_factor * file.capacity_j() / file.nominal_voltage_v;
        Pack {
            capacity_as,
            rated_a: capacity_as / (file.rated_hours * 3600.0),
            peukert_excess: file.peukert_exponent - 1.0,
            nominal_v: file.nominal_voltage_v,
            empty_v: file.empty_v(),
            span_v: file.full_v() - file.empty_v(),
            resistance_ohm: file.resistance_ohm(),
            cutoff_v: file.cutoff_v(),
            most_charging_a: file.charge_acceptance_per_h * capacity_as / 3600.0,
            efficiency: file.charge_efficiency,
        }
    }

    /// What a full pack gives at the rated current and the nominal voltage [J].
    pub fn full_j(&self) -> f64 {
        self.capacity_as * self.nominal_v
    }

    /// Voltage without load at a charge [V].
    pub fn open_voltage_v(&self, charge: f64) -> f64 {
        self.empty_v + self.span_v * charge.clamp(0.0, 1.0)
    }

    /// Voltage over the nominal one, at most 1: share of their top speed and force that is left to the motors. Speed without
    /// load and force at standstill of a motor are in proportion to its voltage.
    pub fn motor_share(&self, voltage_v: f64) -> f64 {
        (voltage_v / self.nominal_v).min(1.0)
    }

    /// Whether the drives are switched off at a voltage.
    pub fn is_cut_off(&self, voltage_v: f64) -> bool {
        voltage_v < self.cutoff_v
    }

    /// Largest charging current at a charge [A].
    pub fn acceptance_a(&self, charge: f64) -> f64 {
        if charge >= 1.0 {
            return 0.0;
        }
        let room = ((1.0 - charge) / (1.0 - ABSORPTION_FROM)).clamp(FLOAT_SHARE, 1.0);
        room * self.most_charging_a
    }

    /// Delivers a power for a time, or takes it where it is negative.
    pub fn deliver(&self, charge: f64, power_w: f64, duration_s: f64) -> Delivery {
        let (mut charge, mut left_s) = (charge, duration_s);
        let (mut drawn_j, mut refused_j) = (0.0, 0.0);
        let mut stretches = 0;
        loop {
            stretches += 1;
            let flow = self.flow(charge, power_w);
            let held_s = if stretches < MOST_HELD { held_s(charge, &flow, left_s) } else { left_s };
            drawn_j += flow.drawn_w * held_s;
            refused_j += flow.refused_w * held_s;
            charge = charged(charge, &flow, held_s);
            left_s -= held_s;
            if stretches >= MOST_HELD || left_s.is_nan() || left_s <= 0.0 {
                return Delivery { charge, voltage_v: flow.voltage_v, drawn_j, refused_j };
            }
        }
    }

    /// Time that a charger of a power takes to bring a pack to a level [s]; `None` where it never does.
    pub fn charging_time_s(&self, charge: f64, level: f64, power_w: f64) -> Option<f64> {
        let (mut charge, mut time_s) = (charge, 0.0);
        for stretch in 0..=MOST_HELD {
            if charge >= level {
                break;
            }
            let flow = self.flow(charge, -power_w);
            if flow.charge_per_s.is_nan() || flow.charge_per_s <= 0.0 {
                return None;
            }
            let left_s = (level - charge) / flow.charge_per_s;
            let held_s = if stretch < MOST_HELD { held_s(charge, &flow, left_s) } else { left_s };
            time_s += held_s;
            charge = if held_s < left_s { charged(charge, &flow, held_s) } else { level };
        }
        Some(time_s)
    }

    /// Change of the charge while a power is delivered [1/s].
    pub(crate) fn charge_per_s(&self, charge: f64, power_w: f64) -> f64 {
        self.flow(charge, power_w).charge_per_s
    }

    /// What flows at a charge and a power.
    #[inline]
    fn flow(&self, charge: f64, power_w: f64) -> Flow {
        let open_v = self.open_voltage_v(charge);
        // V (V_o − V) = P R has its larger root at the load that packs are made for; beyond V_o²/4R there is none.
        let root_v2 = open_v * open_v - 4.0 * self.resistance_ohm * power_w;
        let voltage_v = 0.5 * (open_v + root_v2.max(0.0).sqrt());
        let current_a = power_w / voltage_v;
        if power_w >= 0.0 {
            let rate = current_a / self.rated_a;
            let hurry = if rate > 1.0 { rate.powf(self.peukert_excess) } else { 1.0 };
            let charge_per_s = -hurry * current_a / self.capacity_as;
            return Flow { charge_per_s, voltage_v, drawn_w: power_w, refused_w: 0.0 };
        }
        let taken_a = self.acceptance_a(charge).min(-current_a);
        let voltage_v = open_v + self.resistance_ohm * taken_a;
        let taken_w = voltage_v * taken_a;
        Flow {
            charge_per_s: self.efficiency * taken_a / self.capacity_as,
            voltage_v,
            drawn_w: -taken_w,
            refused_w: -power_w - taken_w,
        }
    }
}

/// Time for which a flow may be held, at most what is left [s]. Below empty the voltage stays, and so does everything else.
#[inline]
fn held_s(charge: f64, flow: &Flow, left_s: f64) -> f64 {
    if left_s <= HELD_S || flow.charge_per_s == 0.0 || (charge <= 0.0 && flow.charge_per_s < 0.0) {
        return left_s;
    }
    let change = HELD_CHARGE.max(-charge);
    (change / flow.charge_per_s.abs()).max(HELD_S).min(left_s)
}

/// Charge after a flow was held; what comes back fills a pack and no more.
#[inline]
fn charged(charge: f64, flow: &Flow, duration_s: f64) -> f64 {
    let after = charge + flow.charge_per_s * duration_s;
    if flow.charge_per_s > 0.0 { after.min(charge.max(1.0)) } else { after }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    /// 24 V, 20 Ah, without resistance and at one voltage, so that currents can be told by hand.
    fn stiff() -> Battery {
        Battery {
            full_voltage_v: Some(24.0),
            empty_voltage_v: Some(24.0),
            internal_resistance_ohm: Some(0.0),
            ..Battery::lead_acid(480.0, 24.0, 0.2)
        }
    }

    fn husky() -> Pack {
        Pack::new(&Battery::lead_acid(480.0, 24.0, 0.2), 1.0)
    }

    #[test]
    fn at_the_rated_current_a_pack_lasts_its_rated_hours() {
        // 20 Ah at the 20-hour rate: 1 A, 24 W, for 20 h.
        let after = Pack::new(&stiff(), 1.0).deliver(1.0, 24.0, 20.0 * 3600.0);
        assert!(after.charge.abs() < 1e-9, "{after:?}");
    }

    #[test]
    fn at_four_times_the_rated_current_it_lasts_as_peukert_says() {
        // t = 20 h (20 Ah/(4 A · 20 h))^1.16 = 20 h / 4^1.16 = 4.006 h, which is 16.02 Ah.
        let hours = 20.0 / 4.0f64.powf(1.16);
        assert_relative_eq!(hours, 4.006, epsilon = 1e-3);
        let after = Pack::new(&stiff(), 1.0).deliver(1.0, 96.0, hours * 3600.0);
        assert!(after.charge.abs() < 1e-9, "{after:?}");
    }

    #[test]
    fn the_default_exponent_is_that_of_a_data_sheet() {
        // Power-Sonic PS-12400: 40 Ah at 2.0 A, 33 Ah at 6.6 A.
        let file = Battery { capacity_wh: 960.0, ..stiff() };
        let drawn = 1.0 - Pack::new(&file, 1.0).deliver(1.0, 6.6 * 24.0, 5.0 * 3600.0).charge;
        assert!((drawn - 1.0).abs() < 0.01, "{drawn} of the charge in five hours");
    }

    #[test]
    fn load_lets_the_voltage_sag_by_current_times_resistance() {
        // V_o = 25.68 V, V (25.68 − V) = 0.045 · 240: V = 25.252 V, I = 9.504 A.
        let full = husky().deliver(1.0, 240.0, 0.0);
        assert_relative_eq!(full.voltage_v, 25.252, epsilon = 1e-3);
        assert_relative_eq!(25.68 - 0.045 * 240.0 / full.voltage_v, full.voltage_v, epsilon = 1e-9);
        assert!(husky().is_cut_off(husky().deliver(0.1, 2000.0, 0.0).voltage_v));
        assert!(!husky().is_cut_off(full.voltage_v));
        assert_eq!(husky().motor_share(full.voltage_v), 1.0);
        assert_relative_eq!(husky().motor_share(21.6), 0.9, epsilon = 1e-12);
    }

    #[test]
    fn a_full_pack_takes_nothing_and_an_empty_one_what_it_is_made_for() {
        let full = husky().deliver(1.0, -50.0, 10.0);
        assert_eq!((full.charge, full.drawn_j, full.refused_j), (1.0, 0.0, 500.0));
        let half = husky().deliver(0.5, -50.0, 10.0);
        assert!(half.refused_j.abs() < 1e-9 && half.charge > 0.5, "{half:?}");
        // 0.3/h of 20 Ah are 6 A, some 150 W: the rest of 1000 W is not taken.
        let flooded = husky().deliver(0.5, -1000.0, 1.0);
        assert!((flooded.drawn_j + 6.0 * flooded.voltage_v).abs() < 1e-9, "{flooded:?}");
        assert!((flooded.refused_j - (1000.0 + flooded.drawn_j)).abs() < 1e-9);
    }

    #[test]
    fn what_goes_in_and_out_again_is_less_by_the_efficiency() {
        // 1 A, the rated current, an hour in and out again: 1/20 of the charge and 85 % of it.
        let pack = Pack::new(&stiff(), 1.0);
        let charged = pack.deliver(0.5, -24.0, 3600.0).charge;
        assert_relative_eq!(charged, 0.5 + 0.85 / 20.0, epsilon = 1e-9);
        assert_relative_eq!(pack.deliver(charged, 24.0, 3600.0).charge, charged - 1.0 / 20.0, epsilon = 1e-9);
    }

    #[test]
    fn age_and_cold_take_their_share_of_the_capacity() {
        let old = Battery { ageing_factor: 0.8, temperature_c: 5.0, ..stiff() };
        // 20 Ah · 0.8 · (1 − 0.01 · 20) = 12.8 Ah: 0.64 A for 20 h.
        let after = Pack::new(&old, 1.0).deliver(1.0, 0.64 * 24.0, 20.0 * 3600.0);
        assert!(after.charge.abs() < 1e-9, "{after:?}");
    }

    #[test]
    fn charging_takes_the_time_that_its_power_and_the_cells_allow() {
        let pack = Pack::new(&stiff(), 1.0);
        // 72 W are 3 A: 0.85 · 3/20 of the charge an hour.
        let hours = pack.charging_time_s(0.2, 0.7, 72.0).unwrap() / 3600.0;
        assert_relative_eq!(hours, 0.5 / (0.85 * 3.0 / 20.0), epsilon = 1e-3);
        assert_eq!(pack.charging_time_s(0.9, 0.5, 72.0), Some(0.0), "there already");
        assert_eq!(pack.charging_time_s(0.2, 0.5, 0.0), None, "a charger without power");
        let full = pack.charging_time_s(0.2, 1.0, 500.0).unwrap();
        assert!(full > pack.charging_time_s(0.2, 0.8, 500.0).unwrap() * 1.5, "absorption takes its time");
    }

    #[test]
    fn a_delivery_without_end_ends() {
        // 1 W of 480 Wh for longer than the universe has lasted: empty, and overdrawn by the rest at the empty voltage.
        let pack = Pack::new(&stiff(), 1.0);
        for duration_s in [1e10, 1e18, 1e300] {
            let after = pack.deliver(1.0, 1.0, duration_s);
            assert_relative_eq!(after.drawn_j, duration_s, max_relative = 1e-9);
            assert_relative_eq!(after.charge, 1.0 - duration_s / (480.0 * 3600.0), max_relative = 1e-6);
        }
        assert_eq!(pack.deliver(0.5, 0.0, 1e300).charge, 0.5, "nothing is drawn");
        assert_eq!(pack.deliver(0.5, -1.0, 1e300).charge, 1.0, "full, and stays so");
        let overdrawn = pack.deliver(-1e9, -24.0, 3600.0);
        assert_relative_eq!(overdrawn.charge, -1e9 + 0.85 / 20.0, max_relative = 1e-12);
    }

    #[test]
    fn a_charger_too_weak_for_its_pack_takes_its_time_and_is_not_waited_for() {
        // 1 MWh by 1 mW at an efficiency of 0.85: 10⁶ · 3600 J / (0.85 · 0.001 W), a hundredth of that for 10 kWh.
        let huge = Pack::new(&Battery { capacity_wh: 1e6, ..stiff() }, 1.0);
        let time_s = huge.charging_time_s(0.2, 0.21, 1e-3).unwrap();
        assert_relative_eq!(time_s, 0.01 * 1e6 * 3600.0 / (0.85 * 1e-3), max_relative = 1e-9);
        let full_s = huge.charging_time_s(0.0, 1.0, 1e-3).unwrap();
        assert_relative_eq!(full_s, 1e6 * 3600.0 / (0.85 * 1e-3), max_relative = 1e-6);
    }

    proptest! {
        #[test]
        fn holding_for_long_takes_what_short_steps_take(
            charge in 0.1f64..1.0, power in -100.0f64..600.0, steps in 2u32..400,
        ) {
            let pack = husky();
            let whole = pack.deliver(charge, power, 5.0 * f64::from(steps));
            let split = (0..steps).fold(charge, |charge, _| pack.deliver(charge, power, 5.0).charge);
            prop_assert!((whole.charge - split).abs() < 5e-3 * (1.0 + (charge - split).abs()), "{} for {split}", whole.charge);
        }

        #[test]
        fn more_power_takes_more_charge_and_a_split_delivery_the_same(
            charge in 0.2f64..0.75, power in -100.0f64..600.0, seconds in 1.0f64..60.0,
        ) {
            let pack = husky();
            let whole = pack.deliver(charge, power, seconds);
            let more = pack.deliver(charge, power + 5.0, seconds);
            prop_assert!(more.charge < whole.charge);
            let half = pack.deliver(charge, power, seconds / 2.0);
            let both = pack.deliver(half.charge, power, seconds / 2.0);
            prop_assert!((both.charge - whole.charge).abs() < 2e-5, "{} for {}", both.charge, whole.charge);
            let kept_j = whole.drawn_j - whole.refused_j;
            prop_assert!((kept_j - power * seconds).abs() < 1e-6 * (1.0 + (power * seconds).abs()));
        }
    }
}
