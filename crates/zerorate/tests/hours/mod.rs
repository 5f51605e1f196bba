//! Whole procedures on the means of a twin: an hour takes seconds.

use adis16130_twin::{Means, Spec, Truth};
use zerorate::{Action, Axis, Event, Method, Outcome, Plan, Procedure, Reading, Refusal};

/// Time of one mean, and of a block of the procedure, s.
const MEAN_S: f64 = 0.1;
/// The air of a cycle: time at which it begins to move, s, distance from its beginning, °C, and duration, s.
const CYCLE: [(u32, f64, f64); 2] = [(1200, -8.0, 480.0), (2400, 0.0, 480.0)];

/// The plan of a method. A cycle takes 70 minutes, so that the part is in balance again.
pub fn plan(method: Method) -> Plan {
    let settle_s = if method == Method::Cycle { 3429.0 } else { Plan::default().settle_s };
    Plan { method, settle_s, ..Plan::default() }
}

/// The result of a procedure on this unit, and the truth at its end.
pub fn measure(spec: &Spec, method: Method) -> Result<(Outcome, Truth), Refusal> {
    let axis = Axis::ADIS16130;
    let mut means = Means::new(spec, 1);
    let mut procedure = Procedure::new(&axis, plan(method)).expect("a plan that makes sense");
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

/// Largest error of PBC, BTC and the correction over the temperatures seen, in standard uncertainties.
pub fn worst_u(outcome: &Outcome, truth: &Truth) -> f64 {
    let (correction, u) = (&outcome.correction, &outcome.uncertainty);
    let pbc = (correction.pbc_dps - truth.pbc_dps(correction.t3_c)) / u.u_pbc_dps;
    let btc = (correction.btc_dps_per_c - truth.btc_dps_per_c(correction.t3_c)) / u.u_btc_dps_per_c;
    let at = |temp_c: f64| {
        let error_dps = correction.at(temp_c) + truth.bias_dps(temp_c);
        outcome.curve.map_or(0.0, |curve| error_dps / curve.u_dps(temp_c))
    };
    let span = outcome.curve.map_or((0.0, 0.0), |curve| curve.span_c);
    let over = (0..9).map(|k| at(span.0 + (span.1 - span.0) * f64::from(k) / 8.0));
    over.chain([pbc, btc]).map(f64::abs).fold(0.0, f64::max)
}
