//! Runs whole procedures on means of 0.1 s from a twin instead of samples, so that an hour takes seconds.

use adis16130_twin::{Means, Spec, Truth};
use zerorate::{Action, Axis, Event, Method, Outcome, Plan, Procedure, Reading, Refusal};

/// Time of one mean, and of a block of the procedure, s.
const MEAN_S: f64 = 0.1;
/// Changes of the air temperature in a cycle: start, s, target relative to the first air temperature, °C, and
/// duration, s.
const CYCLE: [(u32, f64, f64); 2] = [(1200, -8.0, 480.0), (2400, 0.0, 480.0)];

/// The result of a procedure on this unit, and the truth at its end.
pub fn measure(spec: &Spec, method: Method) -> Result<(Outcome, Truth), Refusal> {
    let axis = Axis::ADIS16130;
    let mut means = Means::new(spec, 1);
    // a cycle takes 70 minutes, so that the part is in thermal equilibrium again at its end
    let settle_s = if method == Method::Cycle { 3429.0 } else { Plan::default().settle_s };
    let plan = Plan { method, settle_s, ..Plan::default() };
    let mut procedure = Procedure::new(&axis, plan).expect("a plan that makes sense");
    procedure.handle(Event::Initialised { t_ns: 0 })?;
    for seq in 0_u32.. {
        if procedure.next() == Action::Done {
            break;
        }
        if let Some((_, by_c, over_s)) = CYCLE.iter().find(|(at_s, ..)| method == Method::Cycle && at_s * 10 == seq) {
            means.set_ambient(spec.ambient_c + by_c, *over_s);
        }
        let mean = means.next_mean();
        let reading = Reading {
            t_ns: ((mean.start_s + MEAN_S / 2.0) * 1e9) as u64,
            seq,
            rate: (axis.rate.nearest_code(mean.rate_dps) - axis.rate.zero_code) as i32,
            temp: Some((axis.temp.nearest_code(mean.temp_c) - axis.temp.zero_code) as i32),
            out_of_range: false,
            lost: 0,
        };
        procedure.handle(Event::Reading(&reading))?;
    }
    Ok((procedure.finish()?, means.truth()))
}
