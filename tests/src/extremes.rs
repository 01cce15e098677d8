//! Requests to the planning API whose every field may lie at the edge of its range, all at the same time.

use rand::RngExt;
use rand_pcg::Pcg64;
use serde_json::{Map, Value, json};

/// Endpoints that plan, range or order; each answers any request of [`request`].
pub const ENDPOINTS: [&str; 7] = [
    "/v1/plan",
    "/v1/compare",
    "/v1/alternatives",
    "/v1/matrix",
    "/v1/range",
    "/v1/reachable",
    "/v1/mission",
];

/// A number from a range: often an end of it, seldom a value between.
fn edge(random: &mut Pcg64, usual: f64, min: f64, max: f64) -> f64 {
    match random.random_range(0..10) {
        0..4 => usual,
        4..6 => min,
        6..8 => max,
        8 => min + (max - min) * random.random::<f64>(),
        // Between the ends by orders of magnitude, where the range is of one sign.
        _ => {
            let low = min.max(1e-9 * max);
            low * (max / low).powf(random.random())
        }
    }
}

fn coin(random: &mut Pcg64, one_in: u32) -> bool {
    random.random_range(0..one_in) == 0
}

/// A robot with every field drawn from the range that robot files may have.
pub fn robot(random: &mut Pcg64) -> Value {
    let wheelbase_m = edge(random, 0.54, 0.02, 10.0);
    let track_m = edge(random, 0.54, 0.02, 10.0);
    let motor = |random: &mut Pcg64| json!({ "k1_w_per_n2": edge(random, 0.002, 0.0, 10.0), "k2": edge(random, 1.7, 1.0, 20.0) });
    let surface = |random: &mut Pcg64| {
        json!({
            "mu_roll": edge(random, 0.06, 0.0, 2.0), "mu_skid": edge(random, 0.3, 0.0, 3.0),
            "slip_angle_scale_rad": edge(random, 0.3, 0.0, std::f64::consts::FRAC_PI_2)
        })
    };
    let nominal_voltage_v = edge(random, 24.0, 1.0, 1500.0);
    let mut robot = json!({
        "name": "extreme",
        "mass_kg": edge(random, 90.0, 0.1, 20_000.0),
        "wheelbase_m": wheelbase_m,
        "track_m": track_m,
        "slip_track_m": track_m * edge(random, 1.0, 0.5, 10.0),
        "wheel_radius_m": edge(random, 0.165, 0.005, 2.0),
        "center_of_mass": {
            "forward_m": wheelbase_m / 2.0 * edge(random, 0.0, -1.0, 1.0),
            "left_m": track_m / 2.0 * edge(random, 0.0, -1.0, 1.0),
            "height_m": edge(random, 0.0, 0.0, 5.0)
        },
        "yaw_inertia_kgm2": edge(random, 5.0, 1e-6, 1e6),
        "max_wheel_speed_mps": edge(random, 1.0, 0.01, 30.0),
        "motors": {
            "left": motor(random), "right": motor(random),
            "reference_temperature_c": edge(random, 20.0, -60.0, 150.0),
            "resistance_per_k": edge(random, 0.0039, 0.0, 0.02),
            "motor_constant_per_k": edge(random, -0.0012, -0.01, 0.0),
            "regeneration": edge(random, 0.5, 0.0, 1.0)
        },
        "hotel_power_w": edge(random, 0.0, 0.0, 1e5),
        "drive_electronics_w": edge(random, 0.0, 0.0, 1e4),
        "battery": {
            "capacity_wh": edge(random, 480.0, 1e-3, 1e6),
            "nominal_voltage_v": nominal_voltage_v,
            "reserve_fraction": edge(random, 0.2, 0.0, 0.99),
            "peukert_exponent": edge(random, 1.1, 1.0, 2.0),
            "internal_resistance_ohm": edge(random, 0.02, 0.0, 1e3)
        },
        "limits": {
            "max_pitch_rad": edge(random, 0.5, 0.001, std::f64::consts::FRAC_PI_2),
            "max_roll_rad": edge(random, 0.45, 0.001, std::f64::consts::FRAC_PI_2)
        },
        "surfaces": { "ground": surface(random) },
        "default_surface": "ground",
        "uncertainty": {
            "mu_roll": edge(random, 0.1, 0.0, 1.0), "mu_skid": edge(random, 0.1, 0.0, 1.0), "k1": edge(random, 0.05, 0.0, 1.0),
            "k2": edge(random, 0.02, 0.0, 1.0), "mass_kg": edge(random, 0.02, 0.0, 1.0)
        }
    });
    if coin(random, 2) {
        robot["limits"]["max_side_force_n"] = json!(edge(random, 600.0, 0.1, 1e6));
    }
    robot
}

/// A small map: level, rolling or a heap of cliffs, with obstacles and unknown ground in some.
pub fn map(random: &mut Pcg64) -> Value {
    let (rows, columns) = (random.random_range(1..40), random.random_range(1..40));
    let cell_size_m = edge(random, 0.5, 0.01, 100.0);
    let height_m = [0.0, 0.1, 1.0, 1e4][random.random_range(0..4)] * cell_size_m;
    let (unknown, blocked) = (coin(random, 3), coin(random, 2));
    let cell = |random: &mut Pcg64| match unknown && coin(random, 15) {
        true => Value::Null,
        false => json!(height_m * random.random::<f64>()),
    };
    let mut map = json!({ "cell_size_m": cell_size_m, "origin_m": [0, 0], "rows": rows, "columns": columns });
    map["elevation_m"] = (0..rows).map(|_| (0..columns).map(|_| cell(random)).collect::<Value>()).collect();
    if blocked {
        map["obstacle"] =
            (0..rows).map(|_| (0..columns).map(|_| coin(random, 12)).collect::<Value>()).collect();
    }
    map
}

/// The map of a request and where it lies.
#[derive(Clone, Debug)]
pub struct Ground {
    /// `{"map": ..}` or `{"map_id": ..}`.
    pub fields: Value,
    /// South-western corner [m].
    pub low_m: [f64; 2],
    /// North-eastern corner [m].
    pub high_m: [f64; 2],
}

impl Ground {
    /// A map of [`map`], sent along with the request.
    pub fn inline(random: &mut Pcg64) -> Ground {
        let map = map(random);
        let number = |name: &str| map[name].as_f64().unwrap_or(1.0);
        let high_m = [number("columns") * number("cell_size_m"), number("rows") * number("cell_size_m")];
        Ground { fields: json!({ "map": map }), low_m: [0.0; 2], high_m }
    }

    /// A place on it, seldom beside it.
    fn place(&self, random: &mut Pcg64) -> Value {
        let mut along = |axis: usize| {
            let share = if coin(random, 20) { 1.5 } else { random.random::<f64>() };
            self.low_m[axis] + share * (self.high_m[axis] - self.low_m[axis])
        };
        let (x_m, y_m) = (along(0), along(1));
        let mut place = json!({ "x_m": x_m, "y_m": y_m });
        if coin(random, 3) {
            place["heading_rad"] = json!(edge(random, 1.0, -7.0, 7.0));
        }
        place
    }
}

/// Chance of one in so many that an optional field is given.
const OPTION_ONE_IN: u32 = 3;

fn option(random: &mut Pcg64, fields: &mut Map<String, Value>, name: &str, value: impl Into<Value>) {
    if coin(random, OPTION_ONE_IN) {
        fields.insert(name.to_owned(), value.into());
    }
}

/// A request to one of [`ENDPOINTS`] with a deadline of its own [s].
pub fn request(random: &mut Pcg64, endpoint: &str, ground: &Ground, timeout_s: f64) -> Value {
    let mut fields = ground.fields.as_object().cloned().unwrap_or_default();
    fields.insert("robot".into(), robot(random));
    fields.insert("timeout_s".into(), json!(timeout_s));
    fields.insert(
        "snap_radius_m".into(),
        json!(edge(random, (ground.high_m[0] - ground.low_m[0]) / 10.0, 0.0, 1e6)),
    );
    let speed_mps = edge(random, 0.5, 1e-3, 30.0);
    option(random, &mut fields, "speed_mps", speed_mps);
    let reverse = coin(random, 2);
    option(random, &mut fields, "reverse", reverse);
    if endpoint == "/v1/matrix" {
        let places = random.random_range(1..12);
        fields.insert("sources".into(), (0..places).map(|_| ground.place(random)).collect());
        return Value::Object(fields);
    }
    fields.insert("start".into(), ground.place(random));
    match endpoint {
        "/v1/plan" | "/v1/compare" => plan(random, &mut fields, ground, endpoint == "/v1/plan"),
        "/v1/alternatives" => {
            fields.insert("goal".into(), ground.place(random));
            let (count, epsilon) = (random.random_range(2..50), edge(random, 0.01, 0.0, 1.0));
            option(random, &mut fields, "count", count);
            option(random, &mut fields, "epsilon", epsilon);
        }
        "/v1/range" => range(random, &mut fields, ground),
        "/v1/reachable" => {
            let kind = ["outward", "homeward", "out-and-back"][random.random_range(0..3)];
            fields.insert("kind".into(), json!(kind));
            fields.insert("energies_j".into(), json!([edge(random, 1e3, 1e-3, 1e12), 1e4]));
        }
        _ => mission(random, &mut fields, ground),
    }
    Value::Object(fields)
}

fn plan(random: &mut Pcg64, fields: &mut Map<String, Value>, ground: &Ground, single: bool) {
    fields.insert("goal".into(), ground.place(random));
    if !single {
        return;
    }
    let objective = ["energy", "distance", "time"][random.random_range(0..3)];
    option(random, fields, "objective", objective);
    let bound = edge(random, 1.05, 1.0, 10.0);
    option(random, fields, "bound", bound);
    let hold_goal = coin(random, 2);
    option(random, fields, "hold_goal", hold_goal);
    let max_time_s = edge(random, 100.0, 1e-3, 1e9);
    option(random, fields, "max_time_s", max_time_s);
    let max_energy_j = edge(random, 1e4, -1e6, 1e12);
    option(random, fields, "max_energy_j", max_energy_j);
    let max_slope_rad = edge(random, 0.3, 1e-3, 1.5);
    option(random, fields, "max_slope_rad", max_slope_rad);
    let power_model = ["force-balance", "dogru-marques"][random.random_range(0..2)];
    option(random, fields, "power_model", power_model);
}

fn range(random: &mut Pcg64, fields: &mut Map<String, Value>, ground: &Ground) {
    let goal = ground.place(random);
    option(random, fields, "goal", goal);
    let back = coin(random, 2);
    option(random, fields, "return", back);
    let charge = edge(random, 1.0, 0.0, 1.0);
    option(random, fields, "charge", charge);
    let samples = [1, 1000, 100_000][random.random_range(0..3)];
    option(random, fields, "samples", samples);
    let replanned = random.random_range(0..=100);
    option(random, fields, "replanned", replanned);
    let sigma_m = edge(random, 0.1, 0.0, 10.0);
    option(random, fields, "elevation_sigma_m", sigma_m);
    let ambient_c = edge(random, 20.0, -40.0, 60.0);
    option(random, fields, "ambient_c", ambient_c);
}

fn mission(random: &mut Pcg64, fields: &mut Map<String, Value>, ground: &Ground) {
    let most = [3, 12, 40][random.random_range(0..3)];
    let waypoints = random.random_range(1..=most);
    fields.insert("waypoints".into(), (0..waypoints).map(|_| ground.place(random)).collect());
    let back = coin(random, 2);
    option(random, fields, "return", back);
    let deadline_s = edge(random, 1e4, 1e-3, 1e9);
    option(random, fields, "deadline_s", deadline_s);
    let samples = [1, 1000, 100_000][random.random_range(0..3)];
    option(random, fields, "samples", samples);
    if coin(random, OPTION_ONE_IN) {
        let mut charger = ground.place(random);
        charger["power_w"] = json!(edge(random, 100.0, 1e-3, 1e5));
        fields.insert("chargers".into(), json!([charger]));
    }
}

/// A deadline [s]: from none at all to the time of a short plan.
pub fn timeout_s(random: &mut Pcg64) -> f64 {
    [1e-9, 0.005, 0.02, 0.05, 0.1, 0.3][random.random_range(0..6)]
}
