//! Maps of robots whose topics are known.
//!
//! Names and meanings of fields are those of the public packages: `husky_msgs` and `jackal_msgs` (ROS 1), `clearpath_platform_msgs` (currents and
//! voltages of `Power.msg` stand in an order of each platform), `clearpath_robot` (its battery node publishes a drawn current as positive in all
//! releases, against the convention of `sensor_msgs/BatteryState`), and `scout_msgs` (motors: front right, front left, rear right, rear left).
//! Those of PX4 are the messages of `PX4-Autopilot` (`WheelEncoders`: left, right; axes forward-right-down).

use serde_json::Value;

use crate::Map;

/// A built-in map.
struct BuiltIn {
    name: &'static str,
    /// Its document.
    text: &'static str,
    /// The map whose sources come after its own.
    after: Option<&'static str>,
    /// How namespaces of such robots begin by default.
    namespace: Option<&'static str>,
}

const ALL: [BuiltIn; 7] = [
    BuiltIn { name: "husky", text: include_str!("../maps/husky.json"), after: None, namespace: None },
    BuiltIn {
        name: "clearpath-a200",
        text: include_str!("../maps/clearpath-a200.json"),
        after: Some("husky"),
        namespace: Some("a200"),
    },
    BuiltIn {
        name: "clearpath-j100",
        text: include_str!("../maps/clearpath-j100.json"),
        after: Some("husky"),
        namespace: Some("j100"),
    },
    BuiltIn {
        name: "jackal",
        text: include_str!("../maps/jackal.json"),
        after: Some("husky"),
        namespace: None,
    },
    BuiltIn {
        name: "scout",
        text: include_str!("../maps/scout.json"),
        after: Some("husky"),
        namespace: None,
    },
    BuiltIn { name: "px4", text: include_str!("../maps/px4.json"), after: None, namespace: None },
    BuiltIn { name: "borealtc", text: include_str!("../maps/borealtc.json"), after: None, namespace: None },
];

impl Map {
    /// Names of the built-in maps.
    pub const BUILT_IN: [&'static str; ALL.len()] =
        ["husky", "clearpath-a200", "clearpath-j100", "jackal", "scout", "px4", "borealtc"];

    /// A built-in map: `husky` for the usual topics of a Clearpath Husky under ROS 1 and ROS 2; `clearpath-a200` and `clearpath-j100` for a
    /// Husky and a Jackal under ROS 2 whose microcontroller tells currents; `jackal` for one under ROS 1; `scout` for an AgileX Scout;
    /// `px4` for the logs of a PX4 rover with wheel encoders; `borealtc` for the columns of the recordings made from the BorealTC data set.
    pub fn built_in(name: &str) -> Option<Map> {
        Map::from_value(&Map::built_in_document(name)?).ok()
    }

    /// A built-in map with the wheels of another robot \[m\].
    pub fn built_in_for(name: &str, wheel_radius_m: f64, wheel_separation_m: f64) -> Option<Map> {
        let mut document = Map::built_in_document(name)?;
        if name != "borealtc" {
            document["wheel_radius_m"] = wheel_radius_m.into();
            document["wheel_separation_m"] = wheel_separation_m.into();
        }
        Map::from_value(&document).ok()
    }

    /// The document of a built-in map.
    pub(crate) fn built_in_document(name: &str) -> Option<Value> {
        let own = ALL.iter().find(|one| one.name == name)?;
        let mut document: Value = serde_json::from_str(own.text).ok()?;
        if let Some(after) = own.after {
            let mut more = Map::built_in_document(after)?;
            let sources = document["sources"].as_array_mut()?;
            sources.append(more["sources"].as_array_mut()?);
        }
        Some(document)
    }

    /// How namespaces of the robots of a built-in map begin by default.
    pub(crate) fn built_in_namespace(name: &str) -> Option<&'static str> {
        ALL.iter().find(|one| one.name == name)?.namespace
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Target, map::Place};

    #[test]
    fn names_stand_in_the_order_of_the_table_and_each_map_is_valid() {
        for (name, one) in Map::BUILT_IN.iter().zip(&ALL) {
            assert_eq!(*name, one.name);
            assert!(Map::built_in(name).is_some(), "{name}");
            assert!(Map::built_in_for(name, 0.1, 0.5).is_some(), "{name}");
        }
    }

    #[test]
    fn a_current_of_clearpaths_battery_node_is_drawn_and_of_others_charged() {
        let husky = Map::built_in("husky").unwrap();
        let factor = |topic: &str| {
            let source = husky.sources.iter().find(|source| {
                let is_of = |pattern: &str| Map::topic_matches(pattern, topic);
                source.target == Target::Channel(Channel::Current)
                    && matches!(&source.place, Place::Topic { topic, .. } if is_of(topic))
            });
            source.unwrap().conversion.factor
        };
        assert!(factor("/a200_0000/platform/bms/state") > 0.0);
        assert!(factor("/bms/state") < 0.0 && factor("/battery_state") < 0.0);
    }
}
