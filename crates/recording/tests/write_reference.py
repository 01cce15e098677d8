"""Writes the same drive as ROS 2 MCAP files, folders of rosbag2 and ROS 1 bags with the formats' own tools, and its values as JSON.

    python write_reference.py FOLDER [SECONDS]

The drive is a Husky's: wheel speeds at 10 Hz, IMU at 50 Hz, odometry at 20 Hz, power at 5 Hz. Values are formulas of
time, so that a reader can be held to what was written.
"""

import json
import math
import sys
from pathlib import Path

from mcap.writer import CompressionType
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.typesys import Stores, get_typestore, get_types_from_msg

START_NS = 1_700_000_000_000_000_000
SECONDS = int(sys.argv[2]) if len(sys.argv) > 2 else 20
JOINTS = ["front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"]

STATUS = """std_msgs/Header header
uint32 uptime
float64 ros_control_loop_freq
float64 mcu_and_user_port_current
float64 left_driver_current
float64 right_driver_current
float64 battery_voltage
float64 left_driver_voltage
float64 right_driver_voltage
float64 left_driver_temp
float64 right_driver_temp
float64 left_motor_temp
float64 right_motor_temp
uint16 capacity_estimate
float64 charge_estimate
bool timeout
bool lockout
bool e_stop
bool ros_pause
bool no_battery
bool current_limit
"""


def wheel_radps(t):
    return {"left": 2.0 + math.sin(t), "right": 2.0 - math.sin(t)}


def quaternion(roll, pitch, yaw):
    """The rotation of REP 103 angles: pitch positive nose-down."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return {
        "x": sr * cp * cy - cr * sp * sy,
        "y": cr * sp * cy + sr * cp * sy,
        "z": cr * cp * sy - sr * sp * cy,
        "w": cr * cp * cy + sr * sp * sy,
    }


def vector(x=0.0, y=0.0, z=0.0):
    return {"x": x, "y": y, "z": z}


def times(rate_hz):
    return [START_NS + i * 1_000_000_000 // rate_hz for i in range(SECONDS * rate_hz)]


def seconds(ns):
    return (ns - START_NS) / 1e9


def header(ns, frame="base_link"):
    return {"stamp": ns, "frame_id": frame}


def messages():
    """(topic, type, log time, message as nested dicts), in order of time."""
    out = []
    for ns in times(10):
        speed = wheel_radps(seconds(ns))
        velocity = [speed["right" if "right" in name else "left"] for name in JOINTS]
        body = {"header": header(ns, ""), "name": JOINTS, "position": [0.0] * 4, "velocity": velocity, "effort": []}
        out.append(("/joint_states", "sensor_msgs/msg/JointState", ns, body))
        twist = {"linear": vector(speed["left"] * 0.1), "angular": vector(z=0.25)}
        out.append(("/cmd_vel", "geometry_msgs/msg/TwistStamped", ns, {"header": header(ns), "twist": twist}))
    for ns in times(50):
        t = seconds(ns)
        body = {
            "header": header(ns, "imu"),
            "orientation": quaternion(0.05 * math.sin(t), -0.1 * math.cos(t), 0.2 * t),
            "orientation_covariance": [0.0] * 9,
            "angular_velocity": vector(z=-0.7 * math.sin(t)),
            "angular_velocity_covariance": [0.0] * 9,
            "linear_acceleration": vector(x=0.3 * math.cos(t)),
            "linear_acceleration_covariance": [0.0] * 9,
        }
        out.append(("/imu/data", "sensor_msgs/msg/Imu", ns, body))
    for ns in times(20):
        t = seconds(ns)
        pose = {"position": vector(0.4 * t, 1.5, 0.0), "orientation": quaternion(0, 0, 0.3 * t)}
        body = {
            "header": header(ns, "odom"),
            "child_frame_id": "base_link",
            "pose": {"pose": pose, "covariance": [0.0] * 36},
            "twist": {"twist": {"linear": vector(), "angular": vector()}, "covariance": [0.0] * 36},
        }
        out.append(("/odometry/filtered", "nav_msgs/msg/Odometry", ns, body))
    for ns in times(5):
        t = seconds(ns)
        battery = {
            "header": header(ns), "voltage": 25.5, "temperature": 20.0, "current": -4.0 - t / 8.0, "charge": 1.0,
            "capacity": 1.0, "design_capacity": 1.0, "percentage": 0.5, "power_supply_status": 2,
            "power_supply_health": 1, "power_supply_technology": 2, "present": True, "cell_voltage": [3.5],
            "cell_temperature": [], "location": "bay", "serial_number": "7",
        }
        out.append(("/battery_state", "sensor_msgs/msg/BatteryState", ns, battery))
        status = {
            "header": header(ns), "uptime": 5, "ros_control_loop_freq": 10.0, "mcu_and_user_port_current": 1.0,
            "left_driver_current": 3.0 + t / 4.0, "right_driver_current": 2.0, "battery_voltage": 26.0,
            "left_driver_voltage": 25.0, "right_driver_voltage": 24.0, "left_driver_temp": 30.0,
            "right_driver_temp": 31.0, "left_motor_temp": 32.0 + t, "right_motor_temp": 33.0,
            "capacity_estimate": 400, "charge_estimate": 0.5, "timeout": False, "lockout": False, "e_stop": False,
            "ros_pause": False, "no_battery": False, "current_limit": False,
        }
        out.append(("/status", "husky_msgs/msg/HuskyStatus", ns, status))
    return sorted(out, key=lambda message: message[2])


def build(store, name, value, sequence):
    """A message object of the typestore."""
    import numpy

    kinds = {"float64": numpy.float64, "float32": numpy.float32}
    fields = {}
    for field, (kind, detail) in store.get_msgdef(name).fields:
        if field == "seq":
            fields[field] = sequence
            continue
        part = value[field]
        if field == "stamp":
            part = {"sec": part // 10**9, "nanosec": part % 10**9}
        if kind.name == "NAME":
            part = build(store, detail, part, sequence)
        elif kind.name in ("ARRAY", "SEQUENCE") and detail[0][1][0] in kinds:
            part = numpy.array(part, dtype=kinds[detail[0][1][0]])
        fields[field] = part
    return store.types[name](**fields)


def write_bag(path, compression):
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg(STATUS, "husky_msgs/msg/HuskyStatus"))
    writer = BagWriter(path)
    if compression:
        writer.set_compression(compression)
    with writer:
        connections = {}
        for sequence, (topic, name, ns, body) in enumerate(messages()):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=store)
            message = build(store, name, body, sequence)
            writer.write(connections[topic], ns, store.serialize_ros1(message, name))


def ros2(body):
    if isinstance(body, dict):
        stamp = lambda ns: {"sec": ns // 10**9, "nanosec": ns % 10**9}
        return {key: stamp(part) if key == "stamp" else ros2(part) for key, part in body.items()}
    return body


def write_mcap(path, compression):
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(STATUS, "husky_msgs/msg/HuskyStatus"))
    with open(path, "wb") as stream:
        writer = McapWriter(stream, chunk_size=64 * 1024, compression=compression)
        schemas = {}
        for sequence, (topic, name, ns, body) in enumerate(messages()):
            if name not in schemas:
                definition, _ = store.generate_msgdef(name, ros_version=2)
                schemas[name] = writer.register_msgdef(name.replace("/msg/", "/"), definition)
            writer.write_message(topic, schemas[name], ros2(body), log_time=ns, publish_time=ns, sequence=sequence)
        writer.finish()


def write_rosbag2(path, plugin, mode=None):
    """A folder as `ros2 bag record` leaves it."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(STATUS, "husky_msgs/msg/HuskyStatus"))
    writer = Rosbag2Writer(path, version=9, storage_plugin=plugin)
    if mode:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for sequence, (topic, name, ns, body) in enumerate(messages()):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=store)
            message = build(store, name, body, sequence)
            writer.write(connections[topic], ns, store.serialize_cdr(message, name))


def expected():
    """Values at the stamps of the power topic, which the built-in map takes for the rows."""
    rows = []
    for ns in times(5):
        t = seconds(ns)
        speed = wheel_radps(t)
        rows.append({
            "t_s": t, "v_left_mps": 0.165 * speed["left"], "v_right_mps": 0.165 * speed["right"],
            "power_left_w": 25.0 * (3.0 + t / 4.0), "power_right_w": 48.0, "current_a": 6.0 + t / 4.0,
            "voltage_v": 26.0, "yaw_rate_radps": -0.7 * math.sin(t), "pitch_rad": 0.1 * math.cos(t),
            "roll_rad": 0.05 * math.sin(t), "accel_forward_mps2": 0.3 * math.cos(t), "motor_temp_left_c": 32.0 + t,
            "motor_temp_right_c": 33.0, "x_m": 0.4 * t, "y_m": 1.5,
            "heading_rad": math.atan2(math.sin(0.3 * t), math.cos(0.3 * t)), "speed_command_mps": 0.1 * speed["left"],
            "yaw_rate_command_radps": 0.25, "battery_current_a": 4.0 + t / 8.0,
        })
    return rows


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write_mcap(folder / "zstd.mcap", CompressionType.ZSTD)
    write_mcap(folder / "lz4.mcap", CompressionType.LZ4)
    write_mcap(folder / "plain.mcap", CompressionType.NONE)
    write_bag(folder / "plain.bag", None)
    write_bag(folder / "lz4.bag", BagWriter.CompressionFormat.LZ4)
    write_bag(folder / "bz2.bag", BagWriter.CompressionFormat.BZ2)
    write_rosbag2(folder / "sqlite", StoragePlugin.SQLITE3)
    write_rosbag2(folder / "sqlite-file", StoragePlugin.SQLITE3, CompressionMode.FILE)
    write_rosbag2(folder / "sqlite-message", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    write_rosbag2(folder / "mcap", StoragePlugin.MCAP)
    write_rosbag2(folder / "mcap-file", StoragePlugin.MCAP, CompressionMode.FILE)
    write_rosbag2(folder / "mcap-message", StoragePlugin.MCAP, CompressionMode.MESSAGE)
    (folder / "expected.json").write_text(json.dumps(expected()))
