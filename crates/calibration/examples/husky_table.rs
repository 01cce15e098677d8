//! draft
use calibration::*;
use calibration::current_fit::*;
use calibration::current::YawSource;
use calibration::score::Score;
fn main() {
    let b: f64 = std::env::args().nth(1).map_or(0.87, |s| s.parse().unwrap());
    let mut robot = model::builtin::husky_a200();
    robot.slip_track_m = b;
    let load = |s: &str| {
        let r = recording::read_path(std::path::Path::new(&format!("/work/shared/recordings/husky-{s}.csv")), None).unwrap();
        Drives::new(&robot, &r.recording).unwrap()
    };
    let fl = load("flooring");
    println!("slip track {:?}", slip_track_m(&fl));
    let refs = folds::halves(&fl);
    let rf: Vec<CurrentFit> = refs.iter().map(|d| fit_reference(&robot, d, b, YawSource::Wheels)).collect();
    for s in ["flooring", "asphalt", "ice", "sandy-loam", "snow"] {
        let t = std::time::Instant::now();
        let d = load(s);
        let h = folds::halves(&d);
        let fits: Vec<CurrentFit> = if s == "flooring" { rf.clone() } else { (0..2).map(|i| fit_surface(&robot, &h[i], &rf[i], YawSource::Wheels)).collect() };
        let mut r = vec![];
        for i in 0..2 {
            let o = &h[1 - i];
            r.push(Score::of(&fits[i].predict_a(&robot, o), &o.recorded_averages()).r2);
        }
        println!("{s} {:.3}/{:.3} flagged {} rows {} b {:?} {:?}", r[0], r[1], d.rows.iter().filter(|r| r.stuck).count(), d.rows.len(), slip_track_m(&d), t.elapsed());
        for f in &fits { println!("   {:.3?} idle {} F/A {:.1} {:.1?}", f.parameters.to_array(), f.idle_a, f.force_n_per_a(&robot), f.force_interval_n_per_a(&robot)); }
    }
}
