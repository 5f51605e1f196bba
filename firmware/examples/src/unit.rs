// Bias correction of one ADIS16130 gyroscope, for its own codes only.
// Written by zerorate 0.1.0; do not edit, export again.
// A program may use a part of it: hence the allow(dead_code).
//
// serial       an example: export your own unit's
// calibration  fc793a7ef88b
// measured     not stated, method not stated
// with         not stated
// valid for    25.0 to 31.6 deg C, seen while measuring
//
// Formula (Analog Devices AN-1042):
//
//   corrected = RATE + PBC + (TEMP - T3) * BTC
//
//   PBC = -0.25 deg/s
//   BTC = -0.04 deg/s per deg C
//   T3  = 31.5 deg C
//
// Both coefficients are added: each is minus the bias that it removes.
// RATE = (code - 2^23) / 23488 deg/s, TEMP = (code - 2^23) / 14093 + 25 deg C.
// All codes here are 24 bits; a 16-bit code goes in times 256.

/// The calibration that these numbers come from; store it with whatever they correct.
#[allow(dead_code)]
pub const CALIBRATION_ID: &str = "fc793a7ef88b";

/// Lowest temperature for which the correction holds, deg C. 25.0 to 31.6 deg C, seen while measuring; beyond, it is
/// extrapolated.
#[allow(dead_code)]
pub const TEMP_MIN_C: f64 = 25.0;

/// Highest temperature for which the correction holds, deg C.
#[allow(dead_code)]
pub const TEMP_MAX_C: f64 = 31.6;

/// The lowest temperature as a code.
#[allow(dead_code)]
pub const TEMP_MIN_CODE: u32 = 8388608;

/// The highest temperature as a code.
#[allow(dead_code)]
pub const TEMP_MAX_CODE: u32 = 8481622;

/// The functions allow for 0.5 deg C more on both sides, for the noise of a reading: so many codes.
#[allow(dead_code)]
pub const TEMP_MARGIN_CODE: u32 = 7047;

/// Whether the correction holds at the temperature of a temperature code.
#[allow(dead_code)]
#[inline]
#[must_use]
pub const fn in_range(temp_code: u32) -> bool {
    let temp = temp_code & 0xFF_FFFF;
    let above = temp + TEMP_MARGIN_CODE >= TEMP_MIN_CODE;
    above && temp <= TEMP_MAX_CODE + TEMP_MARGIN_CODE
}

/// The temperature code, or that end of the range that is nearer: what [`correct_code`] takes where one wrong
/// temperature must not move it far.
#[allow(dead_code)]
#[inline]
#[must_use]
pub const fn hold_in_range(temp_code: u32) -> u32 {
    let temp = temp_code & 0xFF_FFFF;
    if temp + TEMP_MARGIN_CODE < TEMP_MIN_CODE {
        TEMP_MIN_CODE - TEMP_MARGIN_CODE
    } else if temp > TEMP_MAX_CODE + TEMP_MARGIN_CODE {
        TEMP_MAX_CODE + TEMP_MARGIN_CODE
    } else {
        temp
    }
}

/// PBC in rate codes, times 2^30.
#[allow(dead_code)]
pub const OFFSET_Q30: i64 = -6305047781414;

/// BTC in rate codes per temperature code, times 2^30.
#[allow(dead_code)]
pub const SLOPE_Q30: i64 = -71581772;

/// T3 as a temperature code.
#[allow(dead_code)]
pub const T3_CODE: i64 = 8480213;

/// The corrected rate code of a rate code and the temperature code taken with it.
///
/// Rounds to nearest, holds the result to 0 ... 2^24 - 1. Uses no division and no table. Extrapolates where the
/// temperature is not in range, and does not say so: ask [`in_range`], or give [`hold_in_range`] of the code.
#[allow(dead_code)]
#[inline]
#[must_use]
pub const fn correct_code(rate_code: u32, temp_code: u32) -> u32 {
    let rate = (rate_code & 0xFF_FFFF) as i64;
    let from_t3 = (temp_code & 0xFF_FFFF) as i64 - T3_CODE;
    let one = 1_i64 << 30;
    let scaled = rate * one + OFFSET_Q30 + from_t3 * SLOPE_Q30 + one / 2;
    let code = scaled >> 30;
    if code < 0 {
        0
    } else if code > 0xFF_FFFF {
        0xFF_FFFF
    } else {
        code as u32
    }
}

/// PBC in millionths of a deg/s. By table, corrected = RATE + PBC + table.
#[allow(dead_code)]
pub const PBC_UDPS: i32 = -250000;

/// Step of the table in millionths of a deg C; half a step is worth 0.00040 deg/s.
#[allow(dead_code)]
pub const TABLE_STEP_UC: i64 = 20000;

/// The first row is for this many millionths of a deg C above T3, the last for as many below it.
#[allow(dead_code)]
pub const TABLE_SPAN_UC: i64 = 7000000;

/// The row of T3_CODE and a half, times 2^32.
#[allow(dead_code)]
pub const TABLE_MIDDLE_Q32: i64 = 1505378418275;

/// Rows per temperature code, times 2^32.
#[allow(dead_code)]
pub const TABLE_ROWS_PER_CODE_Q32: i64 = 15237945;

/// (TEMP - T3) * BTC in millionths of a deg/s, for TEMP - T3 from +7 deg C down to -7 deg C in steps of 0.02 deg C:
/// 2804 bytes.
#[allow(dead_code)]
#[rustfmt::skip]
pub static TABLE_UDPS: [i32; 701] = [
    -280000, -279200, -278400, -277600, -276800, -276000, -275200, -274400,
    -273600, -272800, -272000, -271200, -270400, -269600, -268800, -268000,
    -267200, -266400, -265600, -264800, -264000, -263200, -262400, -261600,
    -260800, -260000, -259200, -258400, -257600, -256800, -256000, -255200,
    -254400, -253600, -252800, -252000, -251200, -250400, -249600, -248800,
    -248000, -247200, -246400, -245600, -244800, -244000, -243200, -242400,
    -241600, -240800, -240000, -239200, -238400, -237600, -236800, -236000,
    -235200, -234400, -233600, -232800, -232000, -231200, -230400, -229600,
    -228800, -228000, -227200, -226400, -225600, -224800, -224000, -223200,
    -222400, -221600, -220800, -220000, -219200, -218400, -217600, -216800,
    -216000, -215200, -214400, -213600, -212800, -212000, -211200, -210400,
    -209600, -208800, -208000, -207200, -206400, -205600, -204800, -204000,
    -203200, -202400, -201600, -200800, -200000, -199200, -198400, -197600,
    -196800, -196000, -195200, -194400, -193600, -192800, -192000, -191200,
    -190400, -189600, -188800, -188000, -187200, -186400, -185600, -184800,
    -184000, -183200, -182400, -181600, -180800, -180000, -179200, -178400,
    -177600, -176800, -176000, -175200, -174400, -173600, -172800, -172000,
    -171200, -170400, -169600, -168800, -168000, -167200, -166400, -165600,
    -164800, -164000, -163200, -162400, -161600, -160800, -160000, -159200,
    -158400, -157600, -156800, -156000, -155200, -154400, -153600, -152800,
    -152000, -151200, -150400, -149600, -148800, -148000, -147200, -146400,
    -145600, -144800, -144000, -143200, -142400, -141600, -140800, -140000,
    -139200, -138400, -137600, -136800, -136000, -135200, -134400, -133600,
    -132800, -132000, -131200, -130400, -129600, -128800, -128000, -127200,
    -126400, -125600, -124800, -124000, -123200, -122400, -121600, -120800,
    -120000, -119200, -118400, -117600, -116800, -116000, -115200, -114400,
    -113600, -112800, -112000, -111200, -110400, -109600, -108800, -108000,
    -107200, -106400, -105600, -104800, -104000, -103200, -102400, -101600,
    -100800, -100000, -99200, -98400, -97600, -96800, -96000, -95200,
    -94400, -93600, -92800, -92000, -91200, -90400, -89600, -88800,
    -88000, -87200, -86400, -85600, -84800, -84000, -83200, -82400,
    -81600, -80800, -80000, -79200, -78400, -77600, -76800, -76000,
    -75200, -74400, -73600, -72800, -72000, -71200, -70400, -69600,
    -68800, -68000, -67200, -66400, -65600, -64800, -64000, -63200,
    -62400, -61600, -60800, -60000, -59200, -58400, -57600, -56800,
    -56000, -55200, -54400, -53600, -52800, -52000, -51200, -50400,
    -49600, -48800, -48000, -47200, -46400, -45600, -44800, -44000,
    -43200, -42400, -41600, -40800, -40000, -39200, -38400, -37600,
    -36800, -36000, -35200, -34400, -33600, -32800, -32000, -31200,
    -30400, -29600, -28800, -28000, -27200, -26400, -25600, -24800,
    -24000, -23200, -22400, -21600, -20800, -20000, -19200, -18400,
    -17600, -16800, -16000, -15200, -14400, -13600, -12800, -12000,
    -11200, -10400, -9600, -8800, -8000, -7200, -6400, -5600,
    -4800, -4000, -3200, -2400, -1600, -800, 0, 800,
    1600, 2400, 3200, 4000, 4800, 5600, 6400, 7200,
    8000, 8800, 9600, 10400, 11200, 12000, 12800, 13600,
    14400, 15200, 16000, 16800, 17600, 18400, 19200, 20000,
    20800, 21600, 22400, 23200, 24000, 24800, 25600, 26400,
    27200, 28000, 28800, 29600, 30400, 31200, 32000, 32800,
    33600, 34400, 35200, 36000, 36800, 37600, 38400, 39200,
    40000, 40800, 41600, 42400, 43200, 44000, 44800, 45600,
    46400, 47200, 48000, 48800, 49600, 50400, 51200, 52000,
    52800, 53600, 54400, 55200, 56000, 56800, 57600, 58400,
    59200, 60000, 60800, 61600, 62400, 63200, 64000, 64800,
    65600, 66400, 67200, 68000, 68800, 69600, 70400, 71200,
    72000, 72800, 73600, 74400, 75200, 76000, 76800, 77600,
    78400, 79200, 80000, 80800, 81600, 82400, 83200, 84000,
    84800, 85600, 86400, 87200, 88000, 88800, 89600, 90400,
    91200, 92000, 92800, 93600, 94400, 95200, 96000, 96800,
    97600, 98400, 99200, 100000, 100800, 101600, 102400, 103200,
    104000, 104800, 105600, 106400, 107200, 108000, 108800, 109600,
    110400, 111200, 112000, 112800, 113600, 114400, 115200, 116000,
    116800, 117600, 118400, 119200, 120000, 120800, 121600, 122400,
    123200, 124000, 124800, 125600, 126400, 127200, 128000, 128800,
    129600, 130400, 131200, 132000, 132800, 133600, 134400, 135200,
    136000, 136800, 137600, 138400, 139200, 140000, 140800, 141600,
    142400, 143200, 144000, 144800, 145600, 146400, 147200, 148000,
    148800, 149600, 150400, 151200, 152000, 152800, 153600, 154400,
    155200, 156000, 156800, 157600, 158400, 159200, 160000, 160800,
    161600, 162400, 163200, 164000, 164800, 165600, 166400, 167200,
    168000, 168800, 169600, 170400, 171200, 172000, 172800, 173600,
    174400, 175200, 176000, 176800, 177600, 178400, 179200, 180000,
    180800, 181600, 182400, 183200, 184000, 184800, 185600, 186400,
    187200, 188000, 188800, 189600, 190400, 191200, 192000, 192800,
    193600, 194400, 195200, 196000, 196800, 197600, 198400, 199200,
    200000, 200800, 201600, 202400, 203200, 204000, 204800, 205600,
    206400, 207200, 208000, 208800, 209600, 210400, 211200, 212000,
    212800, 213600, 214400, 215200, 216000, 216800, 217600, 218400,
    219200, 220000, 220800, 221600, 222400, 223200, 224000, 224800,
    225600, 226400, 227200, 228000, 228800, 229600, 230400, 231200,
    232000, 232800, 233600, 234400, 235200, 236000, 236800, 237600,
    238400, 239200, 240000, 240800, 241600, 242400, 243200, 244000,
    244800, 245600, 246400, 247200, 248000, 248800, 249600, 250400,
    251200, 252000, 252800, 253600, 254400, 255200, 256000, 256800,
    257600, 258400, 259200, 260000, 260800, 261600, 262400, 263200,
    264000, 264800, 265600, 266400, 267200, 268000, 268800, 269600,
    270400, 271200, 272000, 272800, 273600, 274400, 275200, 276000,
    276800, 277600, 278400, 279200, 280000,
];

/// The row nearest to the temperature of a temperature code, in millionths of a deg/s. Uses no division.
///
/// None where the table does not have that temperature, and where the correction does not hold there.
#[allow(dead_code)]
#[must_use]
pub fn table_lookup_udps(temp_code: u32) -> Option<i32> {
    let row = table_row(temp_code);
    if row < 0 || !in_range(temp_code) {
        return None;
    }
    TABLE_UDPS.get(row as usize).copied()
}

/// The same, held at the first or last row beyond the table, which is wrong there by BTC times the distance to it.
#[allow(dead_code)]
#[must_use]
pub fn table_lookup_held_udps(temp_code: u32) -> i32 {
    let last = TABLE_UDPS.len() as i64 - 1;
    TABLE_UDPS[table_row(temp_code).max(0).min(last) as usize]
}

/// Negative above the table, beyond its end below it.
#[allow(dead_code)]
const fn table_row(temp_code: u32) -> i64 {
    let below_t3 = T3_CODE - (temp_code & 0xFF_FFFF) as i64;
    (TABLE_MIDDLE_Q32 + below_t3 * TABLE_ROWS_PER_CODE_Q32) >> 32
}
