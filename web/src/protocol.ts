// Made from message.rs and log/message.rs of crates/zerorate-web/src, which say more.

/**
 * A point of the Allan deviation.
 */
export type AllanPoint = { 
/**
 * s.
 */
tau_s: number, 
/**
 * °/s.
 */
dev_dps: number, 
/**
 * One sigma, lower, °/s.
 */
lo_dps: number, 
/**
 * One sigma, upper, °/s.
 */
hi_dps: number, 
/**
 * What the model expects, °/s.
 */
model_dps: number | null, };

/**
 * What comes back for a request.
 */
export type Answer = { 
/**
 * That of the request.
 */
id: number, } & ({ "ok": Reply } | { "error": string });

/**
 * An axis of the part.
 */
export type AxisAbout = { 
/**
 * What it is called.
 */
name: string, 
/**
 * Largest rate, °/s.
 */
range_dps: number | null, 
/**
 * −3 dB, Hz.
 */
bandwidth_hz: number | null, 
/**
 * The mechanical resonance, Hz.
 */
resonance_hz: number | null, };

/**
 * What an axis is of.
 */
export type AxisKind = "gyroscope" | "accelerometer";

/**
 * The newest numbers of an axis: means over the last second, with the standard uncertainty that their digits warrant.
 */
export type AxisNow = { 
/**
 * °/s.
 */
rate_dps: number | null, 
/**
 * Of that mean, by its noise, °/s.
 */
u_rate_dps: number | null, 
/**
 * °/s; null where no calibration is applied.
 */
corrected_dps: number | null, 
/**
 * Of that mean with the calibration's, °/s.
 */
u_corrected_dps: number | null, 
/**
 * The temperature is outside of the calibration's.
 */
extrapolated: boolean, 
/**
 * Integral of the corrected rate (of the raw one where none is applied) since it was zero, °: by `zero-angle`, or
 * when another calibration was applied.
 */
angle_deg: number, 
/**
 * Its standard uncertainty by noise and calibration, °.
 */
u_angle_deg: number | null, 
/**
 * Whether the part is at rest.
 */
rest: Rest, };

/**
 * What a calibration found of an axis.
 */
export type AxisResult = { 
/**
 * What it is called.
 */
name: string, 
/**
 * °/s.
 */
pbc_dps: number, 
/**
 * Standard uncertainty, °/s.
 */
u_pbc_dps: number, 
/**
 * °/s/°C.
 */
btc_dps_per_c: number, 
/**
 * Standard uncertainty, °/s/°C.
 */
u_btc_dps_per_c: number, 
/**
 * °C.
 */
t3_c: number, 
/**
 * Over the temperatures seen.
 */
curve: Array<CurvePoint>, 
/**
 * Mean rate in the last minute before the end, °/s.
 */
before_dps: number | null, 
/**
 * The same corrected, °/s.
 */
after_dps: number | null, };

/**
 * A guided calibration: a method and what differs from its defaults.
 */
export type CalibrateCommand = { 
/**
 * How.
 */
method: MethodName, 
/**
 * Steps 4 and 6, s.
 */
average_s?: number, 
/**
 * Step 5, s.
 */
warmup_s?: number, 
/**
 * Step 7, s.
 */
settle_s?: number, 
/**
 * Step 8, s.
 */
offset_s?: number, 
/**
 * Where the part is, if its axis is vertical, °, north of the equator positive.
 */
latitude_deg?: number, 
/**
 * Serial number of the part.
 */
serial?: string, 
/**
 * Of the method `chamber`: the name of a plan that comes with the software, or a plan itself
 * (docs/formats/plan.md).
 */
plan?: string, };

/**
 * The guided calibration.
 */
export type Calibrating = { "is": "idle" } | { "is": "running" } & Running | { "is": "done" } & CalibrationResult | { "is": "refused", 
/**
 * By which method.
 */
method: MethodName, 
/**
 * Why, and what to do.
 */
text: string, } | { "is": "aborted", 
/**
 * By which method.
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
 * By its content.
 */
id: string, 
/**
 * Of which part.
 */
serial: string | null, 
/**
 * When, if that is stated.
 */
created: string | null, 
/**
 * By which method, if that is stated.
 */
method: string | null, 
/**
 * Of the first axis, °/s.
 */
pbc_dps: number, 
/**
 * Of the first axis, °/s/°C.
 */
btc_dps_per_c: number, 
/**
 * Of the first axis, °C.
 */
t3_c: number, 
/**
 * Where it holds, °C.
 */
range_c: [number, number] | null, 
/**
 * Whether it is applied.
 */
applied: boolean, 
/**
 * Its file, which the page of a static site keeps.
 */
toml: string, };

/**
 * What a calibration came to.
 */
export type CalibrationResult = { 
/**
 * By which method.
 */
method: MethodName, 
/**
 * As it stands on file.
 */
entry: CalibrationEntry, 
/**
 * Of each axis.
 */
axes: Array<AxisResult>, 
/**
 * What there is to say.
 */
warnings: Array<string>, };

/**
 * A check of the connection.
 */
export type CheckResult = { 
/**
 * What was tried.
 */
what: string, 
/**
 * Whether it is well.
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
 * Its name.
 */
name: string, 
/**
 * In `unit`.
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
 * Of it.
 */
unit: string, 
/**
 * Whether to believe it.
 */
identified: boolean, 
/**
 * In how many seconds it will be, if the noise is what it seems; null where that cannot be said, or is now.
 */
identified_in_s: number | null, };

/**
 * What is added to a rate at a temperature.
 */
export type CurvePoint = { 
/**
 * °C.
 */
temp_c: number, 
/**
 * °/s.
 */
correction_dps: number, 
/**
 * Standard uncertainty, °/s.
 */
u_dps: number | null, 
/**
 * What a perfect measurement would find, °/s: of the twin.
 */
truth_dps: number | null, };

/**
 * What is being read.
 */
export type Device = { 
/**
 * As `zerorate --device` names it.
 */
name: string, 
/**
 * How it is with it.
 */
state: DeviceState, 
/**
 * Whether its time is simulated, so that `speed` works.
 */
simulated: boolean, 
/**
 * How many times as fast as the clock; 0: as fast as it goes.
 */
speed: number, 
/**
 * What kind of gyroscope it is.
 */
part: string, 
/**
 * Its axes.
 */
axes: Array<AxisAbout>, 
/**
 * Length of a bin at each level, s.
 */
bins_s: Array<number>, 
/**
 * Bins that are kept of each level.
 */
bins_kept: number, 
/**
 * How often it should convert, Hz, if that is known.
 */
nominal_hz: number | null, 
/**
 * Its registers when it was opened; empty where there are none to read.
 */
registers: Array<Register>, 
/**
 * What the check of the connection found.
 */
checks: Array<CheckResult>, 
/**
 * What a guided calibration takes where a command leaves it open.
 */
durations: Durations, 
/**
 * Version of the program.
 */
software: string, };

/**
 * How it is with a device.
 */
export type DeviceState = { "is": "opening" } | { "is": "reading" } | { "is": "ended" } | { "is": "failed", 
/**
 * In words.
 */
why: string, };

/**
 * A file for the user.
 */
export type Download = { 
/**
 * What it is called.
 */
name: string, 
/**
 * Its media type.
 */
media_type: string, 
/**
 * What stands in it.
 */
text: string, };

/**
 * Of the steps of application note AN-1042, s.
 */
export type Durations = { average_s: number, warmup_s: number, settle_s: number, offset_s: number, };

/**
 * Bits of a register.
 */
export type Field = { 
/**
 * As the data sheet calls them.
 */
name: string, 
/**
 * What stands in them.
 */
value: number, 
/**
 * In plain words.
 */
meaning: string, 
/**
 * Not what it should be.
 */
wrong: boolean, };

/**
 * What is new since the frame before; in a snapshot, all there is. What is absent is as it was.
 */
export type Frame = { 
/**
 * Counts the frames of a session.
 */
seq: number, 
/**
 * Everything that was shown before is void: of a new session, or of a page that just came.
 */
snapshot: boolean, 
/**
 * Bins that are complete, whose numbers follow in the payload.
 */
strips: Array<Strip>, 
/**
 * What is being read.
 */
device?: Device, 
/**
 * The newest numbers.
 */
now?: Now, 
/**
 * What was read and lost.
 */
ledger?: SampleCounts, 
/**
 * What there is to say, the newest last; at most 100.
 */
notices?: Array<Notice>, 
/**
 * Of each axis.
 */
statistics?: Array<Statistics>, 
/**
 * The guided calibration.
 */
calibration?: Calibrating, 
/**
 * What is on file, the newest last.
 */
calibrations?: Array<CalibrationEntry>, };

/**
 * What is in a log.
 */
export type LogAbout = { 
/**
 * What kind of file it is: `Parquet`, `text, packed by gzip`.
 */
form: string, 
/**
 * Samples of a column, those that are missing included.
 */
samples: number, 
/**
 * Samples per second, Hz.
 */
rate_hz: number, 
/**
 * How long it is, s.
 */
duration_s: number, 
/**
 * The topic of a bag.
 */
topic: string | null, 
/**
 * What will be analysed, gyroscopes first.
 */
columns: Array<LogColumn>, 
/**
 * What there is to say of it.
 */
warnings: Array<string>, };

/**
 * What was found in a column.
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
 * N, B, K and what else the noise model has.
 */
coefficients: Array<LogCoefficient>, 
/**
 * Other terms of the model, in words.
 */
terms: Array<string>, 
/**
 * By how much the model may be off, as a share; none: there is no model.
 */
model_error: number | null, 
/**
 * Why the coefficients are no result, if they are none.
 */
doubt: string | null, 
/**
 * What there is to say: `code: text`.
 */
warnings: Array<string>, };

/**
 * A coefficient of a noise model.
 */
export type LogCoefficient = { 
/**
 * `N`, `B`, `K`, `Q` or `R`, as IEEE Std 952 has them.
 */
symbol: string, 
/**
 * Its name.
 */
name: string, 
/**
 * In each of its units, the usual one first.
 */
values: Array<LogValue>, 
/**
 * Whether to believe it; if not, only `hi` says something.
 */
identified: boolean, 
/**
 * What is to be said of one that is not identified.
 */
remark: string, };

/**
 * A column of a log.
 */
export type LogColumn = { 
/**
 * What it is called, or its number.
 */
name: string, 
/**
 * None: neither, and no file for a filter can have it.
 */
kind: AxisKind | null, 
/**
 * The unit of its results; none: its own, which nobody stated.
 */
unit: string | null, 
/**
 * Samples that are missing.
 */
missing: number, };

/**
 * A picture.
 */
export type LogPicture = { 
/**
 * What it is called as a file: `gyroscope-allan.svg`.
 */
name: string, 
/**
 * What it shows.
 */
title: string, 
/**
 * SVG.
 */
svg: string, };

/**
 * A point of an Allan deviation, in the unit of its column.
 */
export type LogPoint = { 
/**
 * s.
 */
tau_s: number, 
/**
 * The deviation.
 */
dev: number, 
/**
 * One sigma, lower.
 */
lo: number, 
/**
 * One sigma, upper.
 */
hi: number, 
/**
 * What the model expects.
 */
model: number | null, };

/**
 * A field of [`LogSettings`].
 */
export type LogSetting = "columns" | "topic" | "rate_hz" | "time_column" | "time_unit" | "gyro_unit" | "gyro_scale" | "accel_unit" | "accel_scale" | "decimal";

/**
 * What a log may not say of itself, as the user says; what is left out is as the log says.
 */
export type LogSettings = { 
/**
 * The columns, by name or by number counted from 0; none: all that are axes.
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
 * Of gyroscopes: `dps`, `rad/s` …
 */
gyro_unit?: string, 
/**
 * What a step of 1 is, in that unit.
 */
gyro_scale?: number, 
/**
 * Of accelerometers: `m/s²`, `g`, `mg` …
 */
accel_unit?: string, 
/**
 * What a step of 1 is, in that unit.
 */
accel_scale?: number, 
/**
 * What stands before the decimals: `point` or `comma`.
 */
decimal?: string, };

/**
 * What all axes come to, after the last.
 */
export type LogSummary = { 
/**
 * The curves of each kind, spectra and records.
 */
pictures: Array<LogPicture>, 
/**
 * What there is to say of several axes at once.
 */
warnings: Array<string>, 
/**
 * Why no file for a filter can be had, if so.
 */
no_noise_file: string | null, };

/**
 * A number with its 95 % interval.
 */
export type LogValue = { 
/**
 * The number.
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
 * Of all three.
 */
unit: string, };

/**
 * What a look into a log gives.
 */
export type Looked = { "is": "log" } & LogAbout | { "is": "question", 
/**
 * What is missing, and why.
 */
text: string, 
/**
 * A table to choose from: the head, then a row each.
 */
choices: Array<string>, 
/**
 * Any of these answers it.
 */
settings: Array<LogSetting>, } | { "is": "refused", 
/**
 * In words.
 */
text: string, };

/**
 * What can be in a spectrum.
 */
export type MarkKind = "bandwidth" | "nyquist" | "resonance" | "line";

/**
 * Ways to calibrate.
 */
export type MethodName = "an1042" | "warmup" | "cycle" | "chamber";

/**
 * A file for the filter that takes the noise.
 */
export type NoiseFileCommand = { 
/**
 * Who reads it: `kalibr`, `openvins`, `vins`, `orbslam3`, `kf-gins` or `ros`.
 */
format: string, 
/**
 * What stands for all axes of a kind where the reader takes one number: `worst` or `mean`.
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
 * Something to know.
 */
export type Notice = { 
/**
 * Its code, which `zerorate explain` knows; empty where it has none.
 */
code: string, 
/**
 * What was seen, why it matters, what to do.
 */
text: string, 
/**
 * When first, s since the first sample.
 */
at_s: number, 
/**
 * How often it happened, or began to be so.
 */
count: number, };

/**
 * The newest numbers.
 */
export type Now = { 
/**
 * Since the first sample, s.
 */
t_s: number, 
/**
 * Mean temperature of the last second, °C.
 */
temp_c: number | null, 
/**
 * Of each axis.
 */
axes: Array<AxisNow>, };

/**
 * The rate over temperature.
 */
export type OverTemperature = { 
/**
 * From cold to warm.
 */
points: Array<TemperaturePoint>, 
/**
 * The straight line through them; none: there are too few.
 */
line: TemperatureLine | null, };

/**
 * A register and what it says.
 */
export type Register = { 
/**
 * As the data sheet calls it.
 */
name: string, 
/**
 * Where.
 */
address: number, 
/**
 * What stands in it.
 */
value: number, 
/**
 * How wide it is.
 */
bits: number, 
/**
 * Its fields.
 */
fields: Array<Field>, };

/**
 * What a request gives.
 */
export type Reply = Record<symbol, never> | Download | CalibrationEntry;

/**
 * What the page asks for; `id` comes back with the answer.
 */
export type Request = { 
/**
 * Chosen by the page.
 */
id: number, } & ({ "do": "calibrate" } & CalibrateCommand | { "do": "abort-calibration" } | { "do": "finish-calibration" } | { "do": "dismiss-calibration" } | { "do": "apply", 
/**
 * Its `id`.
 */
calibration: string | null, } | { "do": "add-calibration", 
/**
 * What stands in the file.
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
 * In which form.
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
 * The verdict; `unjudged` before there is enough, or where the part's noise is not known.
 */
verdict: RestVerdict, 
/**
 * In words, with the numbers.
 */
text: string, };

/**
 * Verdicts on rest.
 */
export type RestVerdict = "at-rest" | "moving" | "noisy" | "step" | "unjudged";

/**
 * A calibration under way.
 */
export type Running = { 
/**
 * By which method.
 */
method: MethodName, 
/**
 * All steps, in their order.
 */
steps: Array<Step>, 
/**
 * Since it began, s.
 */
elapsed_s: number, 
/**
 * Until it ends, s.
 */
left_s: number, 
/**
 * What to do now.
 */
advice: string, 
/**
 * What would be refused if the step ended here.
 */
threats: Array<string>, 
/**
 * Temperature at the beginning and now, and the lowest and highest in between, °C.
 */
temps_c: [number, number, number, number] | null, 
/**
 * By `warmup` and `cycle`: standard uncertainty of the correction by now, °/s.
 */
u_dps: number | null, 
/**
 * Whether `finish-calibration` may be asked for.
 */
can_finish: boolean, };

/**
 * What was read and lost since the beginning.
 */
export type SampleCounts = { 
/**
 * Samples that came here.
 */
samples: number, 
/**
 * Lost in front of the device's thread, as its samples count them.
 */
lost: number, 
/**
 * Read, but not shown: this page's session was too slow for them. A recording has them.
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
 * Samples a second.
 */
rate_hz: number, 
/**
 * Edges of data ready a second.
 */
rdy_hz: number, 
/**
 * Since when the part has stopped, s since the first sample.
 */
frozen_since_s: number | null, 
/**
 * How long it takes, s, from the first sample.
 */
duration_s: number, };

/**
 * Something in the spectrum.
 */
export type SpectrumMark = { 
/**
 * Hz.
 */
hz: number, 
/**
 * What.
 */
kind: MarkKind, 
/**
 * In words.
 */
text: string, };

/**
 * A point of the spectrum.
 */
export type SpectrumPoint = { 
/**
 * Hz.
 */
hz: number, 
/**
 * One-sided, °/s/√Hz.
 */
density_dps_per_rt_hz: number, };

/**
 * What is known of the noise of an axis by now.
 */
export type Statistics = { 
/**
 * Over how much time, s.
 */
duration_s: number, 
/**
 * Allan deviation.
 */
allan: Array<AllanPoint>, 
/**
 * Its coefficients; none before there is enough.
 */
coefficients: Array<Coefficient>, 
/**
 * Welch's spectrum of the last 131 072 readings.
 */
spectrum: Array<SpectrumPoint>, 
/**
 * What is to be seen in it.
 */
marks: Array<SpectrumMark>, 
/**
 * The bias over temperature.
 */
temperature: OverTemperature, 
/**
 * What is in there beside noise.
 */
caution: string | null, };

/**
 * A step of a procedure.
 */
export type Step = { 
/**
 * What it is called.
 */
name: string, 
/**
 * From its beginning, s.
 */
from_s: number, 
/**
 * To its end, s.
 */
to_s: number, };

/**
 * Bins in a row of one axis at one level. In the payload: rate_min_dps, rate_max_dps, corrected_min_dps,
 * corrected_max_dps, temp_min_c, temp_max_c, each `count` numbers (f32, little endian). NaN where nothing is known.
 */
export type Strip = { 
/**
 * Which axis, from 0.
 */
axis: number, 
/**
 * Which level, from 0.
 */
level: number, 
/**
 * Number of the first bin: it begins at `first` times the level's `bin_s`, since the first sample.
 */
first: number, 
/**
 * How many.
 */
count: number, 
/**
 * Where its numbers begin in the payload, in numbers.
 */
at: number, };

/**
 * A straight line through the rate over temperature, weighted by the uncertainties of its points.
 */
export type TemperatureLine = { 
/**
 * Minus BTC, °/s/°C.
 */
slope_dps_per_c: number, 
/**
 * Standard uncertainty of that by white noise alone, °/s/°C.
 */
u_dps_per_c: number, };

/**
 * The rate at a temperature.
 */
export type TemperaturePoint = { 
/**
 * Mean, °C.
 */
temp_c: number, 
/**
 * Mean, °/s.
 */
rate_dps: number, 
/**
 * Standard uncertainty of that by white noise, °/s.
 */
u_dps: number, 
/**
 * Seconds in it.
 */
seconds: number, };

/**
 * Forms of a download: name and label.
 */
export const FORMS = [["toml","TOML"],["c","C"],["rust","Rust"],["csv","CSV"],["json","JSON"],["report","Report"]] as const;

export type Form = (typeof FORMS)[number][0];
