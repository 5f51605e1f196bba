//! What a measurement of bias and temperature coefficient says.

use super::{Explanation, Says};

/// In the order of the book.
pub const ALL: &[Explanation] = &[
    Explanation {
        code: "earth-included",
        says: Says::Warning,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The Earth turns, and nothing was said about how much of that the axis sees.",
        matters: "Up to 0.00418 °/s of rotation (F-16) are inside PBC, more than the uncertainty of PBC. They come \
            and go as the axis is turned.",
        remedy: "Give the component on the axis: 0.00418 times the sine of the latitude for a vertical axis, with \
            its sign. Or accept it, if the part never changes its direction.",
        command: "zerorate calibrate --earth-dps 0.0031 -o unit.toml",
    },
    Explanation {
        code: "earth-subtracted",
        says: Says::Warning,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The Earth's rotation was subtracted as you gave it.",
        matters: "Any other rotation that is constant during the measurement is still inside PBC: nothing at rest \
            can tell it from bias.",
        remedy: "Nothing, if nothing turned. To be sure, calibrate again with the axis turned over: half of the \
            difference of the two PBC is rotation.",
        command: "",
    },
    Explanation {
        code: "curvature-unseen",
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "Two temperatures give a line, and a line shows no curvature.",
        matters: "A typical unit bends. The uncertainty of BTC holds that; where it is then larger than was asked \
            for, the measurement is refused.",
        remedy: "Use a method that bends, or measure in a chamber. If this very unit is known to be linear, say so. \
            Or accept more.",
        command: "zerorate calibrate --method warmup -o unit.toml",
    },
    Explanation {
        code: "temperature-drifting",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The temperature still moved between the average of the rate and T3.",
        matters: "PBC is off by BTC times that difference; the text says by how much.",
        remedy: "Settle longer, and shield the part from draughts.",
        command: "zerorate calibrate --settle 60m -o unit.toml",
    },
    Explanation {
        code: "step",
        says: Says::Either,
        by: &["calibrate", "recalibrate", "allan", "imu"],
        seen: "The level of the rate jumped, and stayed.",
        matters: "A knock or a step of the supply looks like a change of the bias. It is taken out or widens the \
            uncertainty; where it cannot be told from the temperature, or spoils BTC, the measurement is \
            refused. In an Allan analysis a random walk would be seen in its place.",
        remedy: "Use a linear supply, check that nothing moved, and measure again.",
        command: "",
    },
    Explanation {
        code: "curved",
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "The rate bends over temperature.",
        matters: "A line through two temperatures is wrong between and beyond them. The size is in the \
            uncertainties; where BTC would be too uncertain, it is refused.",
        remedy: "Use a method that bends, or a chamber. Slow motion of the table looks the same: check that.",
        command: "zerorate recalibrate unit.arrows --method warmup -o curve.toml",
    },
    Explanation {
        code: "lagging",
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate follows the temperature sensor late, as if the sensing element were warmed later than the \
            sensor beside it.",
        matters: "While the temperature changes, the correction is that of a temperature which the element does not \
            have yet.",
        remedy: "Warm and settle more slowly, or measure in a chamber. Slow motion looks the same.",
        command: "",
    },
    Explanation {
        code: "hysteresis",
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The bias on the way up is not that on the way down; or it held still until the temperature had \
            changed by some degrees.",
        matters: "No curve over temperature corrects that: the correction is right for the way on which it was \
            measured.",
        remedy: "Measure both ways in a chamber, and take the loop as what is left.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Explanation {
        code: "swaying",
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "The rate sways slowly to and fro.",
        matters: "The platform moves: a building, a long bench, a person. What it adds to the averages is in the \
            uncertainty, or more than a result can bear.",
        remedy: "Fix the part to something that stands still by itself: a stone, a wall, the floor of a cellar.",
        command: "",
    },
    Explanation {
        code: "restless",
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate did more than noise and temperature explain, in ways that cannot be told apart; in a \
            chamber, for too great a share of the time.",
        matters: "The uncertainties may be too small. In a chamber there would be too little rest to learn from.",
        remedy: "Fix the part to a still platform, in a chamber on something that damps its fan; use a linear supply.",
        command: "",
    },
    Explanation {
        code: "flat-bias",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The bias hardly follows the temperature, far less than a typical unit's.",
        matters: "Such units exist. But a wide hysteresis or a long lag looks the same over a few degrees.",
        remedy: "Check it over a wider range before you rely on it elsewhere than near T3.",
        command: "zerorate chamber two-point -o unit.toml",
    },
    Explanation {
        code: "hour-unchecked",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The seconds of the hour were not kept, or are too few.",
        matters: "Steps, lag, curvature, hysteresis and slow motion between the averages were not looked for.",
        remedy: "Record the samples, and compute the calibration from the recording.",
        command: "zerorate calibrate --log unit.arrows -o unit.toml",
    },
    Explanation {
        code: "short-average",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "PBC was averaged for less than half of the time at which this part's Allan deviation is least.",
        matters: "A longer average would have given a better PBC for the price of minutes.",
        remedy: "Average the offset longer.",
        command: "zerorate calibrate --offset 300s -o unit.toml",
    },
    Explanation {
        code: "unsteady-offset",
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "The rate wandered or stepped during the offset average (step 8).",
        matters: "BTC would be more uncertain than was asked for.",
        remedy: "Use a linear supply, keep the platform still, or accept more.",
        command: "zerorate calibrate --max-u-btc 0.01 -o unit.toml",
    },
    Explanation {
        code: "wandering-bias",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The bias wanders more than a typical unit's flicker noise explains.",
        matters: "The uncertainties follow it and are larger than those of a typical unit. Something that moves \
            slowly looks the same.",
        remedy: "Nothing, if the unit is like that: compare with an Allan analysis of some hours.",
        command: "zerorate capture --duration 3h --divider 57 -o rest.parquet",
    },
    Explanation {
        code: "rest-unjudged",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The file of the part does not state its typical noise or temperature coefficient.",
        matters: "Whether the part was at rest was not judged, and the uncertainties hold the white noise alone.",
        remedy: "Complete the file of the part (docs/formats/part.md).",
        command: "",
    },
    Explanation {
        code: "curvature-unknown",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The file of the part does not state its typical curvature or hysteresis.",
        matters: "The uncertainty of BTC holds nothing of what two temperatures cannot show.",
        remedy: "Complete the file of the part (docs/formats/part.md), or use a method that bends.",
        command: "",
    },
    Explanation {
        code: "one-branch",
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The part only warmed, or only cooled.",
        matters: "That shows one branch of the hysteresis. On the other branch the bias is another; that is not in \
            the uncertainty.",
        remedy: "Heat and cool the part, by hand or in a chamber.",
        command: "zerorate calibrate --method cycle -o unit.toml",
    },
    Explanation {
        code: "target-missed",
        says: Says::Warning,
        by: &["calibrate"],
        seen: "The uncertainty that was asked for was not reached.",
        matters: "The part's own flicker and random walk do not allow it in that time, however long one averages.",
        remedy: "Ask for what the part can give, or measure in a chamber.",
        command: "",
    },
    Explanation {
        code: "extrapolated",
        says: Says::Warning,
        by: &["correct", "stream"],
        seen: "The temperature left the range in which the calibration was measured.",
        matters: "The correction goes on as a line or a curve, and nobody measured whether the part does.",
        remedy: "Calibrate over a wider span.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Explanation {
        code: "moving",
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "Means of the rate vary more than noise and temperature explain: the part moves.",
        matters: "Motion would become bias.",
        remedy: "Fix the part to a still platform, and stay away from it.",
        command: "",
    },
    Explanation {
        code: "turning",
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "The mean rate is larger than any bias of such a part.",
        matters: "The part turns, or is not the part that it is taken for.",
        remedy: "Keep the platform still; check the file of the part.",
        command: "zerorate probe",
    },
    Explanation {
        code: "small-span",
        says: Says::Refusal,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The temperature hardly changed between the averages.",
        matters: "The coefficient is a difference of rates divided by a difference of temperatures: with a small \
            one, noise decides.",
        remedy: "Start with a part that was off for an hour, warm it longer, or accept more. In a chamber: check \
            that it is on, and that the part is in it.",
        command: "zerorate calibrate --warmup 20m -o unit.toml",
    },
    Explanation {
        code: "one-way",
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "With `--method cycle`, the temperature did not cover half of its span while it rose, or while it fell.",
        matters: "A cycle shows hysteresis and lag by going both ways. One way shows neither.",
        remedy: "Heat and cool the part while it is measured; or take the method for a warming alone.",
        command: "zerorate recalibrate unit.arrows --method warmup -o unit.toml",
    },
    Explanation {
        code: "too-few-samples",
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "A window of the procedure holds too few samples.",
        matters: "An average of so few is no measurement.",
        remedy: "Check the data-ready wire; use a smaller divider, or average longer.",
        command: "zerorate probe",
    },
];
