//! Tests of the choice of axes.

use super::*;

/// The axes of a CSV file with this head and these rows.
fn read(head: &str, rows: impl Iterator<Item = String>, options: &ImuOptions) -> zerorate_logs::Result<Axes> {
    let text = rows.fold(format!("{head}\n"), |text, row| text + &row + "\n");
    let parts = vec![(std::path::PathBuf::from("imu.csv"), text.into_bytes().into())];
    Axes::read(Path::new("imu.csv"), parts, options)
}

/// `rostopic echo -p` writes the covariance of an angular velocity beside it. Such columns are not axes, unless the
/// user lists them.
#[test]
fn columns_beside_the_axes_are_left_out() {
    let head = "%time,field.angular_velocity.x,field.angular_velocity_covariance0,gyro_clipping";
    let rows = ["1000,0.5,0.0,0", "2000,0.25,0.0,0", "3000,1.5,0.0,1"].map(str::to_owned);
    let of = |columns: Option<Vec<String>>| {
        let log = ColumnOptions { rate: Some(200.0), ..ColumnOptions::default() };
        read(head, rows.iter().cloned(), &ImuOptions { columns, log, ..ImuOptions::default() }).unwrap()
    };
    let found = of(None);
    assert_eq!(found.columns.len(), 1);
    assert_eq!(found.columns[0].name, "field.angular_velocity.x");
    assert!(
        found.warnings.iter().any(|one| one.code() == "columns-left-out" && one.to_string().contains("gyro_clipping"))
    );
    assert_eq!(of(Some(vec!["field.angular_velocity_covariance0".to_owned()])).columns.len(), 1);
}

fn axes(head: &str) -> zerorate_logs::Result<Axes> {
    axes_with(head, &ImuOptions::default())
}

fn axes_with(head: &str, options: &ImuOptions) -> zerorate_logs::Result<Axes> {
    let width = head.split(',').count();
    let row = |at: u64| {
        let cells = (1..width as u64).map(|column| format!("0.{}", (at * (column + 3)) % 7));
        std::iter::once((1_385_030_208_736_607_488 + at * 5_000_000).to_string()).chain(cells).collect::<Vec<_>>()
    };
    let text = (0..60).map(|at| row(at).join(",") + "\n").fold(format!("{head}\n"), |text, row| text + &row);
    let columns = zerorate_logs::read_all(
        Path::new("log.csv"),
        text.into_bytes().into(),
        options.selection(options.listed().as_deref()),
        &zerorate_logs::ColumnOptions::default(),
    )?;
    Axes::of(Path::new("log.csv"), columns, options)
}

/// A log of integers at rest, in which the third axis of the accelerometer always has the value `gravity`.
fn codes(gravity: i32, options: &ImuOptions) -> zerorate_logs::Result<Axes> {
    let row =
        |at: i32| format!("{},{},{},{},{},{},{}", at * 10, at % 5, at % 3, -at % 7, at % 3 - 1, at % 5 - 2, gravity);
    read("t_ms,gx,gy,gz,ax,ay,az", (0..90).map(row), options)
}

#[test]
fn gravity_tells_the_full_scale_or_the_unit() {
    for (gravity, told) in [
        (16_384, "codes of ±2 g (16384 per g): accel_range 2"),
        (8100, "codes of ±4 g (8192 per g): accel_range 4"),
        (2060, "codes of ±16 g (2048 per g): accel_range 16"),
        (1003, "looks like mg: accel_unit mg"),
        (10, "looks like m/s²: accel_unit m/s²"),
        (1, "looks like g: accel_unit g"),
    ] {
        let why = codes(gravity, &ImuOptions::default()).map(drop).unwrap_err().to_string();
        assert!(why.contains(told) && why.contains("gyro_range"), "{gravity}: {why}");
    }
    let why = codes(700, &ImuOptions::default()).map(drop).unwrap_err().to_string();
    assert!(!why.contains("gravity") && why.contains("gyro_range"), "{why}");
}

#[test]
fn fractions_are_not_scaled_as_codes() {
    let of = |setting, width_bits, unit, scale| KindOptions {
        unit: Some(unit),
        scale: Some(scale),
        codes: Some(Codes { setting, width_bits }),
        ..KindOptions::default()
    };
    let options = |width_bits| ImuOptions {
        gyro: of(Setting::Part, width_bits, Unit::Dps, 1.0 / 131.0),
        accel: of(Setting::AccelRange, width_bits, Unit::G, 1.0 / 16_384.0),
        ..ImuOptions::default()
    };
    let found = codes(16_384, &options(16)).unwrap();
    assert_eq!((found.columns[0].scale, found.warnings.len()), (1.0 / 131.0, 0));
    let why = codes(40_000, &options(16)).map(drop).unwrap_err().to_string();
    assert!(why.contains("accel_range is for integer codes, and column `az` holds 40000"), "{why}");
    let ways = [("gx_dps", "`gx_dps` is in °/s; leave part out"), ("gx", "`gx` holds 0.")];
    for (name, told) in ways {
        let why = axes_with(&format!("t_ns,{name}"), &options(16)).map(drop).unwrap_err().to_string();
        assert!(why.contains(told), "{why}");
    }
}

/// A table of a ROS message has zeros for a sensor that does not exist. A single axis of zeros is more likely broken,
/// and stays.
#[test]
fn a_kind_of_zeros_is_left_out_of_a_table() {
    let of = |zero: fn(usize) -> bool| {
        let row = |at: usize| {
            let cells =
                (0..6).map(|axis| if zero(axis) { "0.0".to_owned() } else { format!("0.{}", at * (axis + 3) % 7) });
            format!("{},{}", at * 5, cells.collect::<Vec<_>>().join(","))
        };
        let head = "t_ms,wx_dps,wy_dps,wz_dps,ax_g,ay_g,az_g";
        read(head, (0..60).map(row), &ImuOptions::default()).unwrap()
    };
    let found = of(|axis| axis >= 3);
    assert_eq!(names(&found), ["wx_dps", "wy_dps", "wz_dps"]);
    assert!(found.warnings.iter().any(|one| one.to_string().contains("being 0 in every row: ax_g, ay_g, az_g")));
    assert_eq!(names(&of(|axis| axis == 1)).len(), 6);
    assert_eq!(names(&of(|_| true)).len(), 6);
}

fn names(found: &Axes) -> Vec<&str> {
    found.columns.iter().map(|column| column.name.as_str()).collect()
}

/// A log may have two IMUs, or a yaw rate beside three axes.
#[test]
fn three_axes_of_one_pattern_are_a_sensor() {
    let two = "t_ns,gyro1_x_dps,gyro1_y_dps,gyro1_z_dps,gyro2_x_dps,gyro2_y_dps,gyro2_z_dps,acc1_x_g,acc2_x_g,\
               acc1_y_g,acc2_y_g,acc1_z_g,acc2_z_g";
    let why = axes(two).map(drop).unwrap_err().to_string();
    assert!(why.starts_with("log.csv has several IMUs; choose the axes of one with column:\n"), "{why}");
    assert!(why.ends_with("  gyro2_x_dps,gyro2_y_dps,gyro2_z_dps,acc2_x_g,acc2_y_g,acc2_z_g"), "{why}");
    let found = axes("t_ns,gx_dps,gy_dps,gz_dps,yaw_dps").unwrap();
    assert_eq!(names(&found), ["gx_dps", "gy_dps", "gz_dps"]);
    assert!(found.warnings.iter().any(|warning| warning.to_string().ends_with(": yaw_dps")));
}

#[test]
fn the_other_kind_is_found_beside_listed_columns() {
    let gyro = KindOptions {
        columns: ["turn_three", "turn_one", "turn_two"].map(str::to_owned).to_vec(),
        unit: Some(Unit::RadPerS),
        ..KindOptions::default()
    };
    let options = ImuOptions { gyro, ..ImuOptions::default() };
    let found = axes_with("t_ns,turn_one,turn_two,turn_three,ax_g,ay_g,az_g,spin_dps", &options).unwrap();
    assert_eq!(names(&found), ["turn_three", "turn_one", "turn_two", "ax_g", "ay_g", "az_g"]);
    // an accelerometer without a unit is left out, without a question
    let found = axes_with("t_ns,turn_one,turn_two,turn_three,ax,ay,az", &options).unwrap();
    assert_eq!(names(&found), ["turn_three", "turn_one", "turn_two"]);
}

/// A RealSense writes its gyroscope and its accelerometer to two topics.
#[test]
fn topics_that_differ_in_gyro_and_accel_are_one_imu() {
    let topics = |names: &[&str]| halves(&names.iter().copied().map(str::to_owned).collect::<Vec<_>>()).is_some();
    assert!(topics(&["/camera/accel/sample", "/camera/gyro/sample"]) && topics(&["/gyro", "/accel"]));
    assert!(!topics(&["/imu0", "/imu1"]) && !topics(&["/a/gyro", "/b/accel"]) && !topics(&["/gyro"]));
    let together = |heads: [&str; 2]| {
        let each = heads.map(|head| axes(head).unwrap()).into();
        Axes::together(Path::new("log.bag"), each, &ImuOptions::default())
    };
    let found = together(["t_ns,ax_g,ay_g,az_g", "t_ns,gx_dps,gy_dps,gz_dps"]).unwrap();
    assert_eq!(names(&found), ["gx_dps", "gy_dps", "gz_dps", "ax_g", "ay_g", "az_g"]);
    let gyroscope = "t_ns,gx_dps,gy_dps,gz_dps";
    let why = together([gyroscope, gyroscope]).map(drop).unwrap_err().to_string();
    assert!(why.contains("6 gyroscopes together, and an IMU has three; give one topic"), "{why}");
}

/// Kalibr's tools define the units of these names, but other programs use the names as well.
#[test]
fn units_of_kalibr_are_taken_where_gravity_fits() {
    let of = |gravity: f64| {
        let row = |at: i32| format!("{},{gravity}{},0.1,0.{},0.3,0.{},0.1", at * 10, at % 3, at % 7, at % 5);
        let head = "t_ms,alpha_z,omega_x,omega_y,omega_z,alpha_x,alpha_y";
        read(head, (0..60).map(row), &ImuOptions::default())
    };
    let found = of(9.81).unwrap();
    assert_eq!((found.columns.len(), found.columns[0].scale), (6, Unit::RadPerS.in_results()));
    assert!(found.warnings.iter().any(|warning| warning.code() == "units-taken"));
    assert!(of(0.51).map(drop).unwrap_err().to_string().contains("omega_x, omega_y, omega_z (gyroscope) state"));
}

/// The naming of ROS tells the unit in a message, and only suggests it in a table of another origin.
#[test]
fn units_by_words_are_a_warning_outside_of_messages() {
    let taken = |head: &str, options: &ImuOptions| {
        let found = axes_with(head, options).unwrap();
        let count = found.warnings.iter().filter(|warning| warning.code() == "units-taken").count();
        (count, found.columns[0].scale)
    };
    let table = "t_ns,angular_velocity_x,angular_velocity_y,angular_velocity_z";
    let rad = Unit::RadPerS.in_results();
    assert_eq!(taken(table, &ImuOptions::default()), (1, rad));
    assert_eq!(taken("t_ns,field.angular_velocity.x", &ImuOptions::default()), (0, rad));
    let gyro = KindOptions { unit: Some(Unit::Dps), ..KindOptions::default() };
    assert_eq!(taken(table, &ImuOptions { gyro, ..ImuOptions::default() }), (0, 1.0));
}

#[test]
fn a_forced_unit_overrides_the_name_of_a_listed_axis() {
    let gyro = KindOptions { columns: vec!["x_g".to_owned()], unit: Some(Unit::Mdps), ..KindOptions::default() };
    let of = |force_unit| {
        let log = ColumnOptions { force_unit, ..ColumnOptions::default() };
        axes_with("t_ns,x_g", &ImuOptions { gyro: gyro.clone(), log, ..ImuOptions::default() })
    };
    let why = of(false).map(drop).unwrap_err().to_string();
    assert!(why.contains("x_g is in m/s², which is not a unit of gyroscopes"), "{why}");
    assert_eq!(of(true).unwrap().columns[0].scale, Unit::Mdps.in_results());
}

/// Wheel speeds, biases and set points have the unit of a rate.
#[test]
fn wheels_biases_and_commands_beside_a_gyroscope_are_left_out() {
    let found = axes("t_ns,gz_dps,wheel_speed_rad_s,gyro_bias_z_dps,yaw_cmd_dps").unwrap();
    assert_eq!(found.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["gz_dps"]);
    // if a log has no other axes, columns of a wheel are axes: the IMU is on the wheel
    let found = axes("t_ns,wheel_gyro_x_dps,wheel_gyro_y_dps").unwrap();
    assert_eq!(found.columns.len(), 2);
}

/// A log of 1200 samples at 100 Hz if its time is in ms, or at 0.1 Hz if it is in s.
fn noisy(head: &str, sample: impl Fn(usize, usize) -> f64) -> zerorate_logs::Result<Axes> {
    let width = head.split(',').count();
    let row = |at: usize| {
        let cells = (1..width).map(|column| format!("{:.5}", sample(at, column)));
        std::iter::once((at * 10).to_string()).chain(cells).collect::<Vec<_>>().join(",")
    };
    read(head, (0..1200).map(row), &ImuOptions::default())
}

fn noise(at: usize, column: usize) -> f64 {
    ((at * 7919 + column * 104_729) * 48_271 % 65_537) as f64 / 65_537.0 - 0.5
}

#[test]
fn numbers_that_no_imu_has_are_doubted() {
    let doubts = |found: zerorate_logs::Result<Axes>| -> Vec<String> {
        let warnings = found.unwrap().warnings;
        warnings.iter().filter(|one| one.code() == "implausible").map(ToString::to_string).collect()
    };
    assert_eq!(doubts(noisy("t_ms,gx_dps,gy_dps,gz_dps", noise)), [""; 0]);
    let loud = doubts(noisy("t_ms,gx_dps,gy_dps,gz_dps", |at, column| 30.0 * noise(at, column)));
    assert!(loud[0].contains("the noise of all gyroscopes is above 1."), "{loud:?}");
    let huge =
        doubts(noisy("t_ms,gx_dps,gy_dps,gz_dps", |at, column| if at == 600 { 1e150 } else { noise(at, column) }));
    assert!(huge[0].contains("gx_dps is 8.33e146 °/s in the mean"), "{huge:?}");
    assert!(huge.iter().all(|said| said.len() < 150), "{huge:?}");
    let slow = doubts(noisy("t_s,gx_dps,gy_dps,gz_dps", |at, column| 0.01 * noise(at, column)));
    assert!(slow[0].contains("rows come at 0.100000 Hz"), "{slow:?}");
    let free = doubts(noisy("t_ms,ax_m_s2,ay_m_s2,az_m_s2", noise));
    assert!(free[0].contains("as if it had been subtracted"), "{free:?}");
    let turned = doubts(noisy("t_ms,gx_dps,gy_dps,gz_dps", |at, column| noise(at, column) + (at % 2) as f64));
    assert!(turned[0].contains("samples of gx_dps differ in turns of 2, as of 2 sensors"), "{turned:?}");
}

#[test]
fn columns_of_one_name_are_chosen_by_number() {
    let Err(said) = noisy("t_ms,gx_dps,gy_dps,gz_dps,gx_dps,gy_dps,gz_dps", noise) else { panic!("one sensor") };
    assert!(said.to_string().contains("several columns `gx_dps`") && said.to_string().contains("by number from 0"));
}

/// The accelerometer has half the rate of the gyroscope, and its rows end in the middle of the file.
#[test]
fn sensors_beside_each_other_have_their_own_times() {
    let row = |at: usize| {
        let cells = |rate_hz: f64, unit: f64| {
            let numbers = (0..3).map(|axis| format!("{:.5}", unit + 0.1 * noise(at, axis))).collect::<Vec<_>>();
            format!("{},{}", at as f64 / rate_hz, numbers.join(","))
        };
        let accel = if at < 600 { cells(50.0, 0.5) } else { ",,,".to_owned() };
        format!("{},{accel}\n", cells(100.0, 0.0))
    };
    for [gyro, accel] in [["t_gyro_s", "t_accel_s"], ["Time (s)", "Time (s)"]] {
        let head = format!("{gyro},gx_dps,gy_dps,gz_dps,{accel},ax_g,ay_g,az_g\n");
        let text = (0..1200).map(row).fold(head, |text, row| text + &row);
        for time_column in [None, Some("0".to_owned())] {
            let log = ColumnOptions { time_column, ..ColumnOptions::default() };
            let parts = vec![(std::path::PathBuf::from("imu.csv"), text.clone().into_bytes().into())];
            let options = ImuOptions { log, ..ImuOptions::default() };
            let found = Axes::read(Path::new("imu.csv"), parts, &options).unwrap();
            let rates: Vec<(f64, usize)> =
                found.columns.iter().map(|column| (column.rate_hz.round(), column.series.len())).collect();
            assert_eq!(rates, [[(100.0, 1200); 3], [(50.0, 600); 3]].concat(), "{gyro}");
        }
        // a given rate applies to all columns
        let log = ColumnOptions { rate: Some(200.0), ..ColumnOptions::default() };
        let columns =
            zerorate_logs::read_all(Path::new("imu.csv"), text.into_bytes().into(), ColumnSelection::All, &log);
        assert!(columns.unwrap().iter().all(|column| column.rate_hz == 200.0));
    }
}

/// Codes of 16 bits in hexadecimal digits. The second axis is always negative. Only the first axis shows that the
/// codes are signed.
#[test]
fn an_axis_that_is_always_negative_gets_its_sign_from_another() {
    let row = |at: i16| format!("{},0x{:04X},0x{:04X},0x{:04X}", 10 * at, at % 9 - 4, at % 5 - 900, at % 7);
    let found = read("t_ms,gx_dps,gy_dps,gz_dps", (0..300).map(row), &ImuOptions::default()).unwrap();
    let zerorate_logs::Series::Codes(codes) = &found.columns[1].series else { panic!("integers") };
    assert_eq!(codes[..3], [-900, -899, -898]);
    assert!((found.columns[1].facts().mean() + 898.0).abs() < 0.1);
}

/// A time column beside a given rate is not a temperature, although its name has the word `t`.
#[test]
fn a_time_is_not_a_temperature() {
    for (name, expected) in
        [("t", false), ("t_s", false), ("t_ms", false), ("T", true), ("t_c", true), ("temp_raw", true)]
    {
        assert_eq!(is_temperature_name(name), expected, "{name}");
    }
}
