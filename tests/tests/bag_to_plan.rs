//! The example `examples/bag-to-plan.sh` goes from bags to a plan, for a Husky and for a robot of one's own.

#![allow(clippy::unwrap_used)]

use std::{
    path::Path,
    process::{Command, Output},
};

use joulepath_tests::{drive_csv, file, program};
use serde_json::{Value, json};

#[path = "../../crates/recording/tests/written/ros1.rs"]
#[allow(dead_code)]
mod ros1;
use ros1::{Chunk, Topic, header};

/// What a `std_msgs/Header` is, as a bag defines it.
const OF_HEADER: &str = "\n====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const VOLTAGE_V: f64 = 24.0;

/// A moment of a drive.
#[derive(Clone, Copy)]
struct Moment {
    at_ns: u64,
    left_mps: f64,
    right_mps: f64,
    left_w: f64,
    right_w: f64,
}

/// One of the drives that other tests fit a Husky to.
fn moments(run: usize) -> Vec<Moment> {
    let of_line = |line: &str| {
        let cells: Vec<f64> = line.split(',').skip(1).take(6).map(|cell| cell.parse().unwrap()).collect();
        let [t_s, left_mps, right_mps, _, left_w, right_w] = cells[..] else { unreachable!("six numbers") };
        let at_ns = 1_700_000_000_000_000_000 + (t_s * 1e9) as u64;
        Moment { at_ns, left_mps, right_mps, left_w, right_w }
    };
    let text = drive_csv(2, 1200);
    text.lines().filter(|line| line.starts_with(&format!("drive-{run},"))).map(of_line).collect()
}

fn message(moment: &Moment, numbers: &[u8]) -> (u64, Vec<u8>) {
    let (seconds, nanoseconds) = (moment.at_ns / 1_000_000_000, moment.at_ns % 1_000_000_000);
    let stamp = [0, seconds as u32, nanoseconds as u32, 0].map(u32::to_le_bytes).concat();
    (moment.at_ns, [&stamp, numbers].concat())
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn singles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect()
}

fn bag(chunks: &[Chunk]) -> Vec<u8> {
    let chunks: Vec<Vec<u8>> = chunks.iter().map(Chunk::closed).collect();
    [header(4117), chunks.concat()].concat()
}

/// Joints and status of a Husky under ROS 1.
fn husky_bag(moments: &[Moment]) -> Vec<u8> {
    const RADIUS_M: f64 = 0.165;
    let names = ["front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"];
    let counted = |bytes: &[u8], count: u32| [&count.to_le_bytes(), bytes].concat();
    let named: Vec<u8> = names.iter().flat_map(|name| counted(name.as_bytes(), name.len() as u32)).collect();
    let joints = |moment: &Moment| {
        let [left, right] = [moment.left_mps, moment.right_mps].map(|mps| mps / RADIUS_M);
        let velocity = counted(&doubles(&[left, right, left, right]), 4);
        message(moment, &[counted(&named, 4), counted(&[], 0), velocity, counted(&[], 0)].concat())
    };
    let status = |moment: &Moment| {
        let [left_a, right_a] = [moment.left_w, moment.right_w].map(|w| w / VOLTAGE_V);
        message(moment, &doubles(&[left_a, right_a, VOLTAGE_V, VOLTAGE_V]))
    };
    let joint_state =
        "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort".to_owned();
    let husky_status = "Header header\nfloat64 left_driver_current\nfloat64 right_driver_current\n\
                        float64 left_driver_voltage\nfloat64 right_driver_voltage"
        .to_owned();
    let of = |connection, name, type_name, definition: String, messages: Vec<(u64, Vec<u8>)>| {
        let definition = &(definition + OF_HEADER);
        Chunk::new(&Topic { connection, name, type_name, definition }, &messages)
    };
    bag(&[
        of(0, "/joint_states", "sensor_msgs/JointState", joint_state, moments.iter().map(joints).collect()),
        of(1, "/status", "husky_msgs/HuskyStatus", husky_status, moments.iter().map(status).collect()),
    ])
}

/// Feedback and, once a second, status of a robot with the electronics of a Jackal: currents are means over the second.
fn own_bag(moments: &[Moment], radius_m: f64) -> Vec<u8> {
    let feedback = |moment: &Moment| {
        let driver = |mps: f64| [singles(&[0.0, 30.0, mps / radius_m]), vec![0]].concat();
        message(moment, &[driver(moment.left_mps), driver(moment.right_mps)].concat())
    };
    let status = |second: &[Moment]| {
        let mean_w = second.iter().map(|m| m.left_w + m.right_w).sum::<f64>() / second.len() as f64;
        message(&second[second.len() - 1], &singles(&[VOLTAGE_V, mean_w / VOLTAGE_V]))
    };
    let drive_feedback = "Header header\nDriveFeedback[2] drivers\n====\nMSG: jackal_msgs/DriveFeedback\n\
                          float32 current\nfloat32 motor_temperature\nfloat32 measured_speed\nbool driver_fault";
    let of = |connection, name, type_name, definition: &str, messages: Vec<(u64, Vec<u8>)>| {
        let definition = &(definition.to_owned() + OF_HEADER);
        Chunk::new(&Topic { connection, name, type_name, definition }, &messages)
    };
    let of_status = "Header header\nfloat32 measured_battery\nfloat32 total_current";
    bag(&[
        of(0, "/feedback", "jackal_msgs/Feedback", drive_feedback, moments.iter().map(feedback).collect()),
        of(1, "/status", "jackal_msgs/Status", of_status, moments.chunks(10).map(status).collect()),
    ])
}

/// Runs the example on two bags and gives what it says, the map of fields and the plan that it wrote.
fn planned(folder: &Path, robot: &str, bags: [Vec<u8>; 2]) -> (String, Value, Value) {
    for (name, bytes) in ["first.bag", "second.bag"].into_iter().zip(bags) {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    let Output { status, stdout, stderr } = Command::new("sh")
        .arg(file("examples/bag-to-plan.sh"))
        .args([robot, &file("maps/yard.json").display().to_string(), "@0.2,0.2", "@0.7,0.6", "out"])
        .args(["first.bag", "second.bag"])
        .env("JOULEPATH", program())
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{said}");
    let read =
        |name: &str| serde_json::from_slice(&std::fs::read(folder.join("out").join(name)).unwrap()).unwrap();
    (said, read("log-map.json"), read("plan.json"))
}

#[test]
fn bags_of_a_husky_become_a_plan() {
    let folder = tempfile::tempdir().unwrap();
    let bags = [0, 1].map(|run| husky_bag(&moments(run)));
    let (said, map, plan) = planned(folder.path(), "husky-a200", bags);
    assert!(said.contains("the built-in map `husky` was taken"), "{said}");
    assert_eq!(map["sources"][0]["topic"], "/joint_states");
    assert!(plan["energy_j"].as_f64().unwrap() > 0.0);
}

#[test]
fn bags_of_a_robot_of_ones_own_become_a_plan() {
    let folder = tempfile::tempdir().unwrap();
    let robot: Value = json!({
        "name": "own", "mass_kg": 90.0, "wheelbase_m": 0.54, "track_m": 0.54, "slip_track_m": 0.9, "wheel_radius_m": 0.098,
        "max_wheel_speed_mps": 1.0,
        "center_of_mass": {"forward_m": 0.0, "left_m": 0.0, "height_m": 0.0},
        "motors": {"left": {"k1_w_per_n2": 0.0023, "k2": 1.7158}, "right": {"k1_w_per_n2": 0.0016, "k2": 1.7723}},
        "battery": {"capacity_wh": 480.0, "nominal_voltage_v": 24.0, "reserve_fraction": 0.2},
        "limits": {"max_side_force_n": 600.0, "max_pitch_rad": 0.52, "max_roll_rad": 0.45},
        "surfaces": {
            "marble": {"mu_roll": 0.063, "mu_skid": 0.29, "slip_angle_scale_rad": 0.30},
            "sandy_loam": {"mu_roll": 0.12, "mu_skid": 0.4, "slip_angle_scale_rad": 0.30}
        },
        "default_surface": "marble"
    });
    std::fs::write(folder.path().join("own.json"), robot.to_string()).unwrap();
    let bags = [0, 1].map(|run| own_bag(&moments(run), 0.098));
    let (said, map, plan) = planned(folder.path(), "own.json", bags);
    assert!(said.contains("the built-in map `jackal` was taken"), "{said}");
    assert!(said.contains("slower than the wheels"), "{said}");
    assert_eq!(map["wheel_radius_m"], 0.098);
    assert!(plan["energy_j"].as_f64().unwrap() > 0.0);
}
