//! Mechanisms that a robot's file carries: what a diagnosis found and the fields beside them cannot hold.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{
    Acceleration, Attitude, Motion, Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{self, Adjustment, Kind, Mechanism, Moment},
    robot::Surface,
};

/// A mechanism at values, as a robot or one of its surfaces has it.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "KnownMechanismFile", into = "KnownMechanismFile")]
pub struct KnownMechanism {
    mechanism: &'static dyn Mechanism,
    values: Vec<f64>,
}

/// A mechanism in a robot's file: its name and all of its parameters by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct KnownMechanismFile {
    /// Name of a mechanism of physics, as a diagnosis reports it.
    pub mechanism: String,
    /// Its parameters, each named with its unit.
    pub parameters: BTreeMap<String, f64>,
}

/// Mechanisms that a surface may have: those that change its friction and nothing else.
pub(crate) const OF_GROUND: [&str; 4] =
    ["soft_soil", "surface_change", "speed_dependent_friction", "grade_dependent_friction"];

impl KnownMechanism {
    /// A mechanism at values in the order of its parameters.
    pub fn new(mechanism: &'static dyn Mechanism, values: Vec<f64>) -> Self {
        KnownMechanism { mechanism, values }
    }

    /// Which.
    pub fn mechanism(&self) -> &'static dyn Mechanism {
        self.mechanism
    }

    /// Values of its parameters, in their order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Whether a surface may have it.
    pub fn is_of_ground(mechanism: &dyn Mechanism) -> bool {
        OF_GROUND.contains(&mechanism.name())
    }

    /// Whether a robot's file can have it: physics that no field of the file is there for.
    pub fn fits_file(mechanism: &dyn Mechanism) -> bool {
        mechanism.kind() == Kind::Physics && mechanism.name() != "center_of_mass"
    }
}

impl std::fmt::Debug for KnownMechanism {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?}", self.mechanism.name(), self.values)
    }
}

impl PartialEq for KnownMechanism {
    fn eq(&self, other: &Self) -> bool {
        self.mechanism.name() == other.mechanism.name() && self.values == other.values
    }
}

impl From<KnownMechanism> for KnownMechanismFile {
    fn from(known: KnownMechanism) -> Self {
        let named = known.mechanism.parameters().iter().map(|p| p.name.to_owned());
        KnownMechanismFile {
            mechanism: known.mechanism.name().to_owned(),
            parameters: named.zip(known.values).collect(),
        }
    }
}

impl TryFrom<KnownMechanismFile> for KnownMechanism {
    type Error = String;

    fn try_from(file: KnownMechanismFile) -> Result<Self, String> {
        let name = &file.mechanism;
        let fitting = || mechanism::ALL.into_iter().filter(|m| KnownMechanism::fits_file(*m));
        let Some(mechanism) = fitting().find(|m| m.name() == name) else {
            let known: Vec<&str> = fitting().map(Mechanism::name).collect();
            let known = known.join(", ");
            return Err(match mechanism::by_name(name).map(Mechanism::kind) {
                None => format!("there is no mechanism `{name}`; a robot may have {known}"),
                Some(Kind::Measurement) => {
                    format!("`{name}` is a fault of a recording, not of a robot: mend it there")
                }
                Some(Kind::Physics) => {
                    format!("write what `{name}` says into the field `{name}` of the robot")
                }
            });
        };
        let wanted = mechanism.parameters();
        if let Some(unknown) = file.parameters.keys().find(|name| !wanted.iter().any(|p| p.name == **name)) {
            let names: Vec<&str> = wanted.iter().map(|p| p.name).collect();
            return Err(format!("`{name}` has no parameter `{unknown}`; it has {}", names.join(", ")));
        }
        if file.parameters.get("slip_scale_change").is_some_and(|change| *change != 0.0) {
            return Err(format!(
                "`{name}` cannot change the slip angle's scale in a file: write it into `slip_angle_scale_rad` of the surface"
            ));
        }
        let value = |(i, p): (usize, &mechanism::Parameter)| {
            let written = file.parameters.get(p.name).copied();
            written
                .or(mechanism.is_optional(i).then_some(0.0))
                .ok_or(format!("`{name}` lacks its parameter `{}`", p.name))
        };
        let values = wanted.iter().enumerate().map(value).collect::<Result<_, String>>()?;
        Ok(KnownMechanism { mechanism, values })
    }
}

impl Moment {
    /// Steady motion on level ground, with cold motors.
    pub fn steady(motion: Motion) -> Self {
        Moment {
            motion,
            acceleration: Acceleration::NONE,
            rim_mps2: Sides::both(0.0),
            attitude: Attitude::LEVEL,
            loss_w: Sides::both(0.0),
        }
    }
}

impl Robot {
    /// What the height of its centre of mass, this robot's own mechanisms and those of a surface add at a moment.
    #[inline]
    pub fn adjustment(&self, surface: &Surface, moment: &Moment) -> Adjustment {
        let mut all = Adjustment::default();
        let height_m = self.center_of_mass.height_m;
        if height_m != 0.0 {
            all = mechanism::OF_HEIGHT.adjust(self, &[height_m], moment);
        }
        for known in self.mechanisms.iter().chain(&surface.mechanisms) {
            all = all.and(known.mechanism.adjust(self, &known.values, moment));
        }
        all
    }

    /// Whether it has mechanisms, on any ground.
    pub fn has_mechanisms(&self) -> bool {
        !self.mechanisms.is_empty() || self.surfaces.values().any(|surface| !surface.mechanisms.is_empty())
    }

    /// Whether anything is added to what rolling, skidding and the weight along a slope ask for, on this surface.
    pub fn is_adjusted(&self, surface: &Surface) -> bool {
        self.center_of_mass.height_m != 0.0 || !self.mechanisms.is_empty() || !surface.mechanisms.is_empty()
    }

    /// The mass that a climb lifts: the robot's with everything that it carries and tows [kg].
    pub fn lifted_mass_kg(&self) -> f64 {
        let at_rest = Moment::steady(Motion::of_body(self, 0.0, 0.0));
        let with = |mass_kg, known: &KnownMechanism| {
            let adjustment = known.mechanism.adjust(self, &known.values, &at_rest);
            mass_kg + adjustment.mass_kg + adjustment.lifting_n.sum() / STANDARD_GRAVITY_MPS2
        };
        self.mechanisms.iter().fold(self.mass_kg, with)
    }

    /// s of the mechanism `wheel_slip`: share by which the robot moves less than its wheels turn [-].
    pub fn wheel_slip(&self) -> f64 {
        self.slips(0)
    }

    /// s_t of the mechanism `wheel_slip`: share by which the robot turns less beyond that [-].
    pub fn turning_slip(&self) -> f64 {
        self.slips(1)
    }

    fn slips(&self, parameter: usize) -> f64 {
        let slips = self.mechanisms.iter().filter(|known| known.mechanism.name() == "wheel_slip");
        slips.filter_map(|known| known.values.get(parameter)).sum()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::{Error, Manoeuvre, PowerModel, builtin};

    fn with(mechanisms: Value) -> Result<Robot, Error> {
        let mut file = serde_json::to_value(builtin::husky_a200()).unwrap();
        file["mechanisms"] = mechanisms;
        Robot::from_json(&file.to_string())
    }

    fn bus_w(robot: &Robot, motion: Motion, attitude: Attitude) -> f64 {
        let marble = robot.surface("marble").unwrap();
        Manoeuvre::new(PowerModel::ForceBalance, robot, marble, motion, Sides::both(20.0))
            .power(attitude)
            .bus_w
    }

    #[test]
    fn a_robot_with_mechanisms_survives_a_round_trip_and_one_without_says_nothing_of_them() {
        let windy = json!([{"mechanism": "wind", "parameters": {"drag_area_m2": 0.8, "east_mps": -6.0, "north_mps": 0.0}}]);
        let robot = with(windy.clone()).unwrap();
        let written = serde_json::to_value(&robot).unwrap();
        assert_eq!(written["mechanisms"], windy);
        assert_eq!(Robot::from_json(&written.to_string()).unwrap(), robot);
        assert_eq!(serde_json::to_value(builtin::husky_a200()).unwrap().get("mechanisms"), None);
    }

    #[test]
    fn a_head_wind_costs_what_its_drag_takes_and_a_tail_wind_less() {
        let robot = with(
            json!([{"mechanism": "wind", "parameters": {"drag_area_m2": 0.8, "east_mps": -6.0, "north_mps": 0.0}}]),
        )
        .unwrap();
        let motion = Motion::of_body(&robot, 0.5, 0.0);
        let calm_w = bus_w(&builtin::husky_a200(), motion, Attitude::LEVEL);
        let east_w = bus_w(&robot, motion.heading(0.0), Attitude::LEVEL);
        let west_w = bus_w(&robot, motion.heading(std::f64::consts::PI), Attitude::LEVEL);
        assert!(west_w < calm_w && calm_w < east_w, "{west_w} {calm_w} {east_w}");
        // ½ ρ C_d A (6.5 m/s)² = 20.7 N at 0.5 m/s, through k2 of about 1.74, and its share of copper losses.
        assert!(
            (east_w - calm_w) > 1.7 * 20.7 * 0.5 && (east_w - calm_w) < 2.4 * 20.7 * 0.5,
            "{}",
            east_w - calm_w
        );
    }

    #[test]
    fn a_payload_in_the_list_is_the_same_mass_in_the_field() {
        let listed = with(json!([{"mechanism": "payload", "parameters": {"mass_kg": 15.0}}])).unwrap();
        let mut heavy = builtin::husky_a200();
        heavy.mass_kg += 15.0;
        let motion = Motion::of_body(&heavy, 0.4, 0.6);
        let uphill = Attitude { pitch_rad: 0.1, roll_rad: 0.05 };
        assert!((bus_w(&listed, motion, uphill) - bus_w(&heavy, motion, uphill)).abs() < 1e-9);
        assert!((listed.lifted_mass_kg() - 105.0).abs() < 1e-12);
    }

    #[test]
    fn slipping_wheels_turn_faster_for_the_same_way() {
        let slipping =
            |parameters: Value| with(json!([{"mechanism": "wheel_slip", "parameters": parameters}])).unwrap();
        for robot in [slipping(json!({"slip": 0.2})), slipping(json!({"slip": 0.2, "turning": 0.1}))] {
            let motion = Motion::of_body(&robot, 0.4, 0.5);
            let back = Motion::of_wheels(&robot, motion.rim_speeds_mps);
            assert!((motion.rim_speeds_mps.sum() / 2.0 - 0.5).abs() < 1e-12);
            assert!((back.speed_mps - 0.4).abs() < 1e-12 && (back.yaw_rate_radps - 0.5).abs() < 1e-12);
        }
        let turning = slipping(json!({"slip": 0.0, "turning": 0.1}));
        let [firm, loose] = [builtin::husky_a200(), turning].map(|robot| {
            let rims_mps = Motion::of_body(&robot, 0.4, 0.5).rim_speeds_mps;
            rims_mps.right - rims_mps.left
        });
        assert!((loose - firm / 0.9).abs() < 1e-12, "its wheels turn against each other by a ninth more");
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_place_and_what_to_write() {
        let cases = [
            (json!([{"mechanism": "winds", "parameters": {}}]), "mechanisms[0]", "wind"),
            (json!([{"mechanism": "pitch_bias", "parameters": {}}]), "mechanisms[0]", "recording"),
            (json!([{"mechanism": "center_of_mass", "parameters": {}}]), "mechanisms[0]", "field"),
            (json!([{"mechanism": "payload", "parameters": {}}]), "mechanisms[0]", "lacks"),
            (
                json!([{"mechanism": "payload", "parameters": {"mass_kg": 1e6}}]),
                "mechanisms[0]",
                "-60 to 400",
            ),
            (json!([{"mechanism": "payload", "parameters": {"mass": 1}}]), "mechanisms[0]", "mass_kg"),
            (
                json!([{"mechanism": "payload", "parameters": {"mass_kg": -60}}, {"mechanism": "payload", "parameters": {"mass_kg": -60}}]),
                "mechanisms",
                "weigh",
            ),
            (
                json!([{"mechanism": "wheel_slip", "parameters": {"slip": 0, "turning": 0.6}}, {"mechanism": "wheel_slip", "parameters": {"slip": 0, "turning": 0.6}}]),
                "mechanisms",
                "turn the robot",
            ),
        ];
        for (mechanisms, place, hint) in cases {
            let said = with(mechanisms.clone()).unwrap_err().to_string();
            assert!(said.contains(place) && said.contains(hint), "{mechanisms}: {said}");
        }
    }

    #[test]
    fn what_can_be_grows_with_the_robot() {
        let (husky, mut large) = (builtin::husky_a200(), builtin::husky_a200());
        large.mass_kg = 900.0;
        for (name, parameter, factor) in [
            ("drivetrain_drag", 0, 10.0),
            ("towed_load", 1, 10.0),
            ("hotel_load", 0, 10.0),
            ("motor_heating", 0, 0.1),
            ("motor_heating", 1, 1.0),
            ("soft_soil", 0, 1.0),
        ] {
            let mechanism = mechanism::by_name(name).unwrap();
            let [[_, usual], [_, on_large]] =
                [&husky, &large].map(|robot| mechanism.bounds(robot, parameter));
            assert!((on_large / usual - factor).abs() < 1e-12, "{name}: {usual} {on_large}");
        }
        let drag =
            json!([{"mechanism": "drivetrain_drag", "parameters": {"left_n": 1000.0, "right_n": 0.0}}]);
        assert!(with(drag.clone()).unwrap_err().to_string().contains("-10 to 300 on a robot of 90 kg"));
        let mut file = serde_json::to_value(&large).unwrap();
        file["mechanisms"] = drag;
        assert!(Robot::from_json(&file.to_string()).is_ok());
    }

    #[test]
    fn ground_has_what_changes_its_friction_and_nothing_else() {
        let on_marble = |mechanism: Value| {
            let mut file = serde_json::to_value(builtin::husky_a200()).unwrap();
            file["surfaces"]["marble"]["mechanisms"] = json!([mechanism]);
            Robot::from_json(&file.to_string())
        };
        let soft = on_marble(json!({"mechanism": "soft_soil", "parameters": {"sinking": 0.5}})).unwrap();
        let motion = Motion::of_body(&soft, 0.5, 0.0);
        assert!(
            bus_w(&soft, motion, Attitude::LEVEL) > bus_w(&builtin::husky_a200(), motion, Attitude::LEVEL)
        );
        let said =
            on_marble(json!({"mechanism": "payload", "parameters": {"mass_kg": 5}})).unwrap_err().to_string();
        assert!(said.contains("surfaces.marble.mechanisms[0]") && said.contains("soft_soil"), "{said}");
    }
}
