// Made from message.rs and log/message.rs of crates/zerorate-web/src, which say more.

/**
 * A point of the Allan deviation.
 */
export type AllanPoint = { 
/**
 * Averaging time, s.
 */
tau_s: number, 
/**
 * The deviation, °/s.
 */
dev_dps: number, 
/**
 * Lower end of the one-sigma interval, °/s.
 */
lo_dps: number, 
/**
 * Upper end of the one-sigma interval, °/s.
 */
hi_dps: number, 
/**
 * The deviation of the model, °/s.
 */
model_dps: number | null, };

/**
 * The answer to a request.
 */
export type Answer = { 
/**
 * The `id` of the request.
 */
id: number, } & ({ "ok": Reply } | { "error": string });

/**
 * An axis of the part.
 */
export type AxisAbout = { 
/**
 * The name.
 */
name: string, 
/**
 * Largest rate, °/s.
 */
range_dps: number | null, 
/**
 * Bandwidth (−3 dB), Hz.
 */
bandwidth_hz: number | null, 
/**
 * The mechanical resonance, Hz.
 */
resonance_hz: number | null, };

/**
 * The quantity of an axis.
 */
export type AxisKind = "gyroscope" | "accelerometer";

/**
 * The newest numbers of an axis: means over the last second, with standard uncertainties.
 */
export type AxisNow = { 
/**
 * Raw rate, °/s.
 */
rate_dps: number | null, 
/**
 * Standard uncertainty of the raw rate by its noise, °/s.
 */
u_rate_dps: number | null, 
/**
 * Corrected rate, °/s; null if no calibration is applied.
 */
corrected_dps: number | null, 
/**
 * Standard uncertainty of the corrected rate, including the calibration's, °/s.
 */
u_corrected_dps: number | null, 
/**
 * Whether the temperature is outside the range of the calibration.
 */
extrapolated: boolean, 
/**
 * Integral of the corrected rate since it was set to zero, °. Without a calibration, the raw rate is integrated.
 * `zero-angle` sets it to zero, and so does a change of the calibration.
 */
angle_deg: number, 
/**
 * Standard uncertainty of the angle by noise and calibration, °.
 */
u_angle_deg: number | null, 
/**
 * Whether the part is at rest.
 */
rest: Rest, };

/**
 * The result of a calibration for an axis.
 */
export type AxisResult = { 
/**
 * The name of the axis.
 */
name: string, 
/**
 * PBC, °/s.
 */
pbc_dps: number, 
/**
 * Standard uncertainty of PBC, °/s.
 */
u_pbc_dps: number, 
/**
 * BTC, °/s/°C.
 */
btc_dps_per_c: number, 
/**
 * Standard uncertainty of BTC, °/s/°C.
 */
u_btc_dps_per_c: number, 
/**
 * T3, °C.
 */
t3_c: number, 
/**
 * The correction over the temperatures that occurred.
 */
curve: Array<CurvePoint>, 
/**
 * Mean rate in the last minute before the end, °/s.
 */
before_dps: number | null, 
/**
 * The same mean, corrected, °/s.
 */
after_dps: number | null, };

/**
 * A guided calibration: its method, and the settings that differ from the defaults.
 */
export type CalibrateCommand = { 
/**
 * The method.
 */
method: MethodName, 
/**
 * Duration of steps 4 and 6, s.
 */
average_s?: number, 
/**
 * Duration of step 5, s.
 */
warmup_s?: number, 
/**
 * Duration of step 7, s.
 */
settle_s?: number, 
/**
 * Duration of step 8, s.
 */
offset_s?: number, 
/**
 * Latitude of the part if its axis is vertical, °, north positive.
 */
latitude_deg?: number, 
/**
 * Serial number of the part.
 */
serial?: string, 
/**
 * For the method `chamber`: the name of a plan that comes with the software, or the text of a plan
 * (docs/formats/plan.md).
 */
plan?: string, };

/**
 * The guided calibration.
 */
export type Calibrating = { "is": "idle" } | { "is": "running" } & Running | { "is": "done" } & CalibrationResult | { "is": "refused", 
/**
 * The method.
 */
method: MethodName, 
/**
 * Why, and what to do.
 */
text: string, } | { "is": "aborted", 
/**
 * The method.
 */
method: MethodName, 
/**
 * Why.
 */
text: string, };

/**
 * A calibration on file.
 */
export type CalibrationEntry = { 
/**
 * The id, made from the content.
 */
id: string, 
/**
 * Serial number of the part, if it is stated.
 */
serial: string | null, 
/**
 * The date of the measurement, if it is stated.
 */
created: string | null, 
/**
 * The method, if it is stated.
 */
method: string | null, 
/**
 * PBC of the first axis, °/s.
 */
pbc_dps: number, 
/**
 * BTC of the first axis, °/s/°C.
 */
btc_dps_per_c: number, 
/**
 * T3 of the first axis, °C.
 */
t3_c: number, 
/**
 * The range of temperatures in which it holds, °C.
 */
range_c: [number, number] | null, 
/**
 * Whether it is applied.
 */
applied: boolean, 
/**
 * The text of its file, which the page of a static site keeps.
 */
toml: string, };

/**
 * The result of a calibration.
 */
export type CalibrationResult = { 
/**
 * The method.
 */
method: MethodName, 
/**
 * The calibration as it is on file.
 */
entry: CalibrationEntry, 
/**
 * The results of each axis.
 */
axes: Array<AxisResult>, 
/**
 * Warnings about the result.
 */
warnings: Array<string>, };

/**
 * A check of the connection.
 */
export type CheckResult = { 
/**
 * The subject of the check.
 */
what: string, 
/**
 * Whether the check passed.
 */
ok: boolean, 
/**
 * What was seen, and what to do.
 */
text: string, };

/**
 * A noise coefficient.
 */
export type Coefficient = { 
/**
 * `N`, `B` or `K`.
 */
symbol: string, 
/**
 * The name in words.
 */
name: string, 
/**
 * The value, in `unit`.
 */
value: number, 
/**
 * Lower end of its 95 % interval.
 */
lo: number, 
/**
 * Upper end of its 95 % interval.
 */
hi: number, 
/**
 * Unit of the value.
 */
unit: string, 
/**
 * Whether the value is identified.
 */
identified: boolean, 
/**
 * Seconds until it is identified, if the noise is what it seems. Null if that is unknown, or if it is identified
 * already.
 */
identified_in_s: number | null, };

/**
 * The correction at a temperature.
 */
export type CurvePoint = { 
/**
 * Temperature, °C.
 */
temp_c: number, 
/**
 * The correction that is added to the rate, °/s.
 */
correction_dps: number, 
/**
 * Standard uncertainty, °/s.
 */
u_dps: number | null, 
/**
 * The result of a perfect measurement, °/s; only the twin knows it.
 */
truth_dps: number | null, };

/**
 * The device that is being read.
 */
export type Device = { 
/**
 * The name, as `zerorate --device` takes it.
 */
name: string, 
/**
 * The state.
 */
state: DeviceState, 
/**
 * Whether its time is simulated, so that `speed` works.
 */
simulated: boolean, 
/**
 * The speed in multiples of real time; 0: as fast as possible.
 */
speed: number, 
/**
 * The kind of gyroscope.
 */
part: string, 
/**
 * The axes.
 */
axes: Array<AxisAbout>, 
/**
 * Length of a bin at each level, s.
 */
bins_s: Array<number>, 
/**
 * Number of bins that are kept of each level.
 */
bins_kept: number, 
/**
 * Nominal conversion rate, Hz, if it is known.
 */
nominal_hz: number | null, 
/**
 * The registers at the time of opening; empty if there are none to read.
 */
registers: Array<Register>, 
/**
 * The results of the connection check.
 */
checks: Array<CheckResult>, 
/**
 * The durations of a guided calibration, if a command gives none.
 */
durations: Durations, 
/**
 * Version of the program.
 */
software: string, };

/**
 * The state of a device.
 */
export type DeviceState = { "is": "opening" } | { "is": "reading" } | { "is": "ended" } | { "is": "failed", 
/**
 * Why, and what to do about it.
 */
why: string, };

/**
 * A file for the user.
 */
export type Download = { 
/**
 * The name of the file.
 */
name: string, 
/**
 * Its media type.
 */
media_type: string, 
/**
 * The text of the file.
 */
text: string, };

/**
 * Durations of the steps of application note AN-1042, s.
 */
export type Durations = { average_s: number, warmup_s: number, settle_s: number, offset_s: number, };

/**
 * Bits of a register.
 */
export type Field = { 
/**
 * The name in the data sheet.
 */
name: string, 
/**
 * The value.
 */
value: number, 
/**
 * The meaning in plain words.
 */
meaning: string, 
/**
 * Whether the value is not as expected.
 */
wrong: boolean, };

/**
 * Everything that changed since the last frame; a snapshot has everything. A field that is absent did not change.
 */
export type Frame = { 
/**
 * The number of the frame in its session.
 */
seq: number, 
/**
 * Everything that was shown before is void: the session is new, or the page just opened.
 */
snapshot: boolean, 
/**
 * Complete bins, whose numbers follow in the payload.
 */
strips: Array<Strip>, 
/**
 * The device.
 */
device?: Device, 
/**
 * The newest numbers.
 */
now?: Now, 
/**
 * The counts of samples.
 */
ledger?: SampleCounts, 
/**
 * The notices, the newest last; at most 100.
 */
notices?: Array<Notice>, 
/**
 * The statistics of each axis.
 */
statistics?: Array<Statistics>, 
/**
 * The guided calibration.
 */
calibration?: Calibrating, 
/**
 * The calibrations on file, the newest last.
 */
calibrations?: Array<CalibrationEntry>, };

/**
 * The content of a log.
 */
export type LogAbout = { 
/**
 * The format of the file: `Parquet`, `text, packed by gzip`.
 */
form: string, 
/**
 * Number of samples of a column, including missing ones.
 */
samples: number, 
/**
 * Samples per second, Hz.
 */
rate_hz: number, 
/**
 * Duration, s.
 */
duration_s: number, 
/**
 * The topic of a bag.
 */
topic: string | null, 
/**
 * The columns that will be analysed, gyroscopes first.
 */
columns: Array<LogColumn>, 
/**
 * Warnings about the log.
 */
warnings: Array<string>, };

/**
 * The results of a column.
 */
export type LogAxis = { 
/**
 * The column.
 */
column: LogColumn, 
/**
 * Overlapping Allan deviation at octaves, in the unit of the column.
 */
points: Array<LogPoint>, 
/**
 * The coefficients of the noise model: N, B, K and others.
 */
coefficients: Array<LogCoefficient>, 
/**
 * Other terms of the model, in words.
 */
terms: Array<string>, 
/**
 * The possible error of the model, as a share; none: without a model.
 */
model_error: number | null, 
/**
 * Why the coefficients are not a valid result, if so.
 */
doubt: string | null, 
/**
 * Warnings: `code: text`.
 */
warnings: Array<string>, };

/**
 * A coefficient of a noise model.
 */
export type LogCoefficient = { 
/**
 * `N`, `B`, `K`, `Q` or `R`, as IEEE Std 952 names them.
 */
symbol: string, 
/**
 * The name in words.
 */
name: string, 
/**
 * The value in each unit, the usual one first.
 */
values: Array<LogValue>, 
/**
 * Whether the value is identified; if not, only `hi` means something.
 */
identified: boolean, 
/**
 * A remark on a coefficient that is not identified.
 */
remark: string, };

/**
 * A column of a log.
 */
export type LogColumn = { 
/**
 * The name, or the number of a column without one.
 */
name: string, 
/**
 * The quantity; none: neither of them, and no file for a filter can take the column.
 */
kind: AxisKind | null, 
/**
 * The unit of the results; none: the unit of the column, which nobody stated.
 */
unit: string | null, 
/**
 * Number of missing samples.
 */
missing: number, };

/**
 * A picture.
 */
export type LogPicture = { 
/**
 * The name of its file: `gyroscope-allan.svg`.
 */
name: string, 
/**
 * The title.
 */
title: string, 
/**
 * The picture as SVG.
 */
svg: string, };

/**
 * A point of an Allan deviation, in the unit of its column.
 */
export type LogPoint = { 
/**
 * Averaging time, s.
 */
tau_s: number, 
/**
 * The deviation.
 */
dev: number, 
/**
 * Lower end of the one-sigma interval.
 */
lo: number, 
/**
 * Upper end of the one-sigma interval.
 */
hi: number, 
/**
 * The deviation of the model.
 */
model: number | null, };

/**
 * A field of [`LogSettings`].
 */
export type LogSetting = "columns" | "topic" | "rate_hz" | "time_column" | "time_unit" | "gyro_unit" | "gyro_scale" | "accel_unit" | "accel_scale" | "decimal";

/**
 * The user's statements about a log. The rest is taken from the log itself.
 */
export type LogSettings = { 
/**
 * The columns, by name or by number counted from 0; none: all axes.
 */
columns?: Array<string>, 
/**
 * The topic of a bag with several IMUs.
 */
topic?: string, 
/**
 * Samples per second, Hz.
 */
rate_hz?: number, 
/**
 * The column with the times.
 */
time_column?: string, 
/**
 * `s`, `ms`, `us` or `ns`.
 */
time_unit?: string, 
/**
 * Unit of gyroscopes: `dps`, `rad/s` …
 */
gyro_unit?: string, 
/**
 * The value of one step, in that unit.
 */
gyro_scale?: number, 
/**
 * Unit of accelerometers: `m/s²`, `g`, `mg` …
 */
accel_unit?: string, 
/**
 * The value of one step, in that unit.
 */
accel_scale?: number, 
/**
 * The decimal mark: `point` or `comma`.
 */
decimal?: string, };

/**
 * The summary of all axes, after the last one.
 */
export type LogSummary = { 
/**
 * The pictures of each kind of axis: curves, spectra and records.
 */
pictures: Array<LogPicture>, 
/**
 * Warnings about several axes at once.
 */
warnings: Array<string>, 
/**
 * Why no file for a filter can be made, if so.
 */
no_noise_file: string | null, };

/**
 * A number with its 95 % interval.
 */
export type LogValue = { 
/**
 * The value.
 */
value: number, 
/**
 * Lower end.
 */
lo: number, 
/**
 * Upper end.
 */
hi: number, 
/**
 * Unit of all three.
 */
unit: string, };

/**
 * The result of a look into a log.
 */
export type Looked = { "is": "log" } & LogAbout | { "is": "question", 
/**
 * What is missing, and why.
 */
text: string, 
/**
 * A table to choose from: the head, then the rows.
 */
choices: Array<string>, 
/**
 * The settings, any of which answers the question.
 */
settings: Array<LogSetting>, } | { "is": "refused", 
/**
 * What is wrong, and what to do.
 */
text: string, };

/**
 * The kinds of features in a spectrum.
 */
export type MarkKind = "bandwidth" | "nyquist" | "resonance" | "line";

/**
 * The methods of calibration.
 */
export type MethodName = "an1042" | "warmup" | "cycle" | "chamber";

/**
 * A request for the file with the noise parameters of a filter.
 */
export type NoiseFileCommand = { 
/**
 * The filter: `kalibr`, `openvins`, `vins`, `orbslam3`, `kf-gins` or `ros`.
 */
format: string, 
/**
 * The value of all axes of a kind, if the filter takes one number: `worst` or `mean`.
 */
combine: string, 
/**
 * Factor on all noise, above 0; 1: as measured.
 */
inflate: number, 
/**
 * Also make it from rejected models; the file says so.
 */
accept_rejected: boolean, };

/**
 * A notice.
 */
export type Notice = { 
/**
 * The code, which `zerorate explain` knows; empty for a notice without one.
 */
code: string, 
/**
 * What was seen, why it matters, what to do.
 */
text: string, 
/**
 * The first time, s since the first sample.
 */
at_s: number, 
/**
 * The number of times that it happened or began.
 */
count: number, };

/**
 * The newest numbers.
 */
export type Now = { 
/**
 * Time since the first sample, s.
 */
t_s: number, 
/**
 * Mean temperature of the last second, °C.
 */
temp_c: number | null, 
/**
 * The numbers of each axis.
 */
axes: Array<AxisNow>, };

/**
 * The rate over temperature.
 */
export type OverTemperature = { 
/**
 * The points, from cold to warm.
 */
points: Array<TemperaturePoint>, 
/**
 * The straight line through them; none: there are too few points.
 */
line: TemperatureLine | null, };

/**
 * A register and its content.
 */
export type Register = { 
/**
 * The name in the data sheet.
 */
name: string, 
/**
 * The address.
 */
address: number, 
/**
 * The content.
 */
value: number, 
/**
 * The width, bits.
 */
bits: number, 
/**
 * The fields.
 */
fields: Array<Field>, };

/**
 * The reply to a request that was done.
 */
export type Reply = Record<symbol, never> | Download | CalibrationEntry;

/**
 * A request of the page. The answer has the same `id`.
 */
export type Request = { 
/**
 * The number of the request, chosen by the page.
 */
id: number, } & ({ "do": "calibrate" } & CalibrateCommand | { "do": "abort-calibration" } | { "do": "finish-calibration" } | { "do": "dismiss-calibration" } | { "do": "apply", 
/**
 * Its `id`.
 */
calibration: string | null, } | { "do": "add-calibration", 
/**
 * The text of the file.
 */
toml: string, } | { "do": "remove-calibration", 
/**
 * Its `id`.
 */
calibration: string, } | { "do": "download", 
/**
 * Its `id`.
 */
calibration: string, 
/**
 * The form of the file.
 */
form: Form, } | { "do": "restart" } | { "do": "zero-angle" } | { "do": "speed", 
/**
 * 0 … 1000.
 */
factor: number, } | { "do": "reopen" });

/**
 * Whether the part is at rest, over the last 10 s.
 */
export type Rest = { 
/**
 * The verdict; `unjudged` if there are too few readings, or if the noise of the part is unknown.
 */
verdict: RestVerdict, 
/**
 * The verdict in words, with its numbers.
 */
text: string, };

/**
 * Verdicts on rest.
 */
export type RestVerdict = "at-rest" | "moving" | "noisy" | "step" | "unjudged";

/**
 * A running calibration.
 */
export type Running = { 
/**
 * The method.
 */
method: MethodName, 
/**
 * All steps, in their order.
 */
steps: Array<Step>, 
/**
 * Time since the start, s.
 */
elapsed_s: number, 
/**
 * Time until the end, s.
 */
left_s: number, 
/**
 * The advice of what to do now.
 */
advice: string, 
/**
 * Refusals that would follow if the step ended now.
 */
threats: Array<string>, 
/**
 * Temperature at the start and now, and the lowest and highest in between, °C.
 */
temps_c: [number, number, number, number] | null, 
/**
 * Standard uncertainty of the correction so far, °/s; only `warmup` and `cycle` have it.
 */
u_dps: number | null, 
/**
 * Whether `finish-calibration` is possible now.
 */
can_finish: boolean, };

/**
 * The counts of samples since the start.
 */
export type SampleCounts = { 
/**
 * Samples that arrived here.
 */
samples: number, 
/**
 * Samples that were lost before the thread of the device, as the samples themselves count them.
 */
lost: number, 
/**
 * Samples that were read but not shown, because the session of this page was too slow. A recording has them.
 */
missed: number, 
/**
 * Readings that are impossible for the part.
 */
impossible: number, 
/**
 * Readings out of range.
 */
out_of_range: number, 
/**
 * Rate of samples, Hz.
 */
rate_hz: number, 
/**
 * Rate of edges of data ready, Hz.
 */
rdy_hz: number, 
/**
 * The time since which the part has stopped, s since the first sample.
 */
frozen_since_s: number | null, 
/**
 * Duration since the first sample, s.
 */
duration_s: number, };

/**
 * A feature of the spectrum.
 */
export type SpectrumMark = { 
/**
 * Frequency, Hz.
 */
hz: number, 
/**
 * The kind of feature.
 */
kind: MarkKind, 
/**
 * The feature in words.
 */
text: string, };

/**
 * A point of the spectrum.
 */
export type SpectrumPoint = { 
/**
 * Frequency, Hz.
 */
hz: number, 
/**
 * One-sided density, °/s/√Hz.
 */
density_dps_per_rt_hz: number, };

/**
 * The noise of an axis, as far as it is known.
 */
export type Statistics = { 
/**
 * Length of the record, s.
 */
duration_s: number, 
/**
 * Allan deviation.
 */
allan: Array<AllanPoint>, 
/**
 * The coefficients; empty before there are enough samples.
 */
coefficients: Array<Coefficient>, 
/**
 * Welch's spectrum of the last 131 072 readings.
 */
spectrum: Array<SpectrumPoint>, 
/**
 * Features of the spectrum.
 */
marks: Array<SpectrumMark>, 
/**
 * The bias over temperature.
 */
temperature: OverTemperature, 
/**
 * A remark if the deviations contain more than noise.
 */
caution: string | null, };

/**
 * A step of a procedure.
 */
export type Step = { 
/**
 * The name.
 */
name: string, 
/**
 * Start of the step, s.
 */
from_s: number, 
/**
 * End of the step, s.
 */
to_s: number, };

/**
 * Consecutive bins of one axis at one level. In the payload: rate_min_dps, rate_max_dps, corrected_min_dps,
 * corrected_max_dps, temp_min_c, temp_max_c, each `count` numbers (f32, little endian). NaN means unknown.
 */
export type Strip = { 
/**
 * The number of the axis, from 0.
 */
axis: number, 
/**
 * The number of the level, from 0.
 */
level: number, 
/**
 * Number of the first bin. It begins at `first` times the level's `bin_s`, since the first sample.
 */
first: number, 
/**
 * The number of bins.
 */
count: number, 
/**
 * Start of its numbers in the payload, counted in numbers.
 */
at: number, };

/**
 * A straight line through the rate over temperature, weighted by the uncertainties of its points.
 */
export type TemperatureLine = { 
/**
 * The slope, which is minus BTC, °/s/°C.
 */
slope_dps_per_c: number, 
/**
 * Standard uncertainty of the slope by white noise alone, °/s/°C.
 */
u_dps_per_c: number, };

/**
 * The rate at a temperature.
 */
export type TemperaturePoint = { 
/**
 * Mean temperature, °C.
 */
temp_c: number, 
/**
 * Mean rate, °/s.
 */
rate_dps: number, 
/**
 * Standard uncertainty of the mean rate by white noise, °/s.
 */
u_dps: number, 
/**
 * Time at this temperature, s.
 */
seconds: number, };

/**
 * Forms of a download: name and label.
 */
export const FORMS = [["toml","TOML"],["c","C"],["rust","Rust"],["csv","CSV"],["json","JSON"],["report","Report"]] as const;

export type Form = (typeof FORMS)[number][0];
