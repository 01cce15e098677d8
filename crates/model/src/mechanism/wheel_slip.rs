//! `wheel_slip`: wheels that turn and do not carry the robot as far.

use crate::{
    Robot,
    mechanism::{Form, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Wheels that turn and do not carry the robot as far.
///
/// Slip grows with what a wheel pulls (Wong, Theory of Ground Vehicles, 4th ed., ch. 2): wheels that spin carry the robot less far and turn
/// it less. On firm ground wheels pull hardly in going straight on and hard in every turn, where as long as tyres answer in proportion the
/// skid falls with the radius as the share does by which both sides differ, so that the same share of every turn is lost. A robot that turns
/// more than its wheels would have it is on ground that holds it less: on ice wheels that hardly skid hardly slip.
pub(super) struct WheelSlip;

/// Most by which a robot may move farther than its wheels turn: slip that healthy drives had and others have not, and radii that are off. What
/// drives itself cannot do more; with half a length more, a mass ahead of the middle passed for wheels that carry a robot 11 % farther.
const MOST_FARTHER: f64 = 0.02;

/// Below this a share is not worth a word.
const WORTH_A_WORD: f64 = 5e-4;

impl Mechanism for WheelSlip {
    fn name(&self) -> &'static str {
        "wheel_slip"
    }

    fn label(&self) -> &'static str {
        "slipping wheels"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "slip", unit: "1", bounds: [-MOST_FARTHER, 0.9], probe: 0.02 },
            Parameter { name: "turning", unit: "1", bounds: [0.0, 0.9], probe: 0.02 },
        ]
    }

    /// Only ground that gives way under pull has the second.
    fn is_optional(&self, parameter: usize) -> bool {
        parameter == 1
    }

    /// A tenth in going straight on and twice as much in turns, where wheels pull hardest.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        [0.1, 0.2].map(SizePrior::positive).into()
    }

    /// What spins carries the robot less far and turns it less; what gives way under pull shows in turns; or both.
    fn forms(&self, _: &Robot) -> Vec<Form> {
        [vec![0], vec![1], vec![0, 1]].map(|free| Form { values: vec![0.0; 2], free, widening: 1.0 }).into()
    }

    /// Wheels slip by some hundredths of their way wherever they pull.
    fn healthy_share(&self) -> f64 {
        0.2
    }

    fn equation(&self) -> &'static str {
        "v = (1 − s) (u_l + u_r)/2, ω = (1 − s) (1 − s_t) (u_r − u_l)/b_s"
    }

    fn statement(&self, values: &[f64]) -> String {
        let share = |s: f64| match s < 0.0 {
            true => format!("{:.1} % more", -100.0 * s),
            false => format!("{:.1} % less", 100.0 * s),
        };
        let [slip, turning] = [values[0], values[1]];
        match (slip.abs() < WORTH_A_WORD, turning.abs() < WORTH_A_WORD) {
            (_, true) => format!("the robot moves {} than its wheels turn", share(slip)),
            (true, false) => format!("the robot turns {} than its wheels would have it", share(turning)),
            (false, false) => format!(
                "the robot moves {} than its wheels turn, and beyond that turns {}",
                share(slip),
                share(turning)
            ),
        }
    }

    fn measure(&self, values: &[f64], moment: &mut Moment) {
        let moved = 1.0 - values[0];
        let turned = moved * (1.0 - values[1]);
        moment.motion.speed_mps *= moved;
        moment.motion.yaw_rate_radps *= turned;
        moment.acceleration.forward_mps2 *= moved;
        moment.acceleration.yaw_radps2 *= turned;
        moment.acceleration.left_mps2 *= moved * turned;
    }
}
