//! One case of every effect at a share of the power, with what its key says.
//!
//! `cargo run --release -p joulepath-world --example keys -- 0.03 1`: share, seed.

use world::{Case, CaseKind, EffectName, Error, example_robot};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let share: f64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(0.03);
    let seed: u64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(1);
    let robot = example_robot();
    for name in EffectName::all() {
        let case = Case::draw(seed, CaseKind::One(name), share, &robot)?;
        let key = case.key(&robot)?;
        for truth in key.truths {
            println!(
                "{:<26} {:>9.4} {:<40} from {:>4} s on {:?}: power {:+.4} of {:.0} W, change {:.4}, rims {:.4}, yaw rate {:.4}, pitch {:.4}",
                name.name(),
                case.world.effects[0].strength,
                name.unit(),
                truth.onset_s,
                case.drive.kind,
                truth.power_share,
                key.healthy_mean_w,
                truth.power_change,
                truth.channel_changes[0],
                truth.channel_changes[1],
                truth.channel_changes[2],
            );
        }
    }
    Ok(())
}
