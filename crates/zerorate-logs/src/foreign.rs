//! Tests with logs that common libraries wrote or read back (`fixtures/make.py`): 20 samples at 200 Hz, of which the
//! thirteenth is missing. Sample n, counted from 0, has z = 0.25·n.

use super::several::all;
use super::tests::{
    DATAFLASH, HDF5, HDF5_LATEST, HDF5_UNITS, MAT, MAT_73, MAT_FS, MAT_PACKED, NPZ, NPZ_FS, NPZ_PACKED, ROSBAG,
    ROSBAG_BZ2, ROSBAG_LZ4, ULOG, fails, numbers, options, read_file, there,
};
use super::*;
use std::path::{Path, PathBuf};

#[track_caller]
fn is_z(column: &Column, name: &str) {
    let expected: Vec<Option<f64>> = (0..20).map(|n| (n != 12).then_some(0.25 * f64::from(n))).collect();
    assert_eq!((there(column), column.name.as_str()), (expected, name));
    assert!((column.rate_hz - 200.0).abs() < 1e-9, "{}", column.rate_hz);
}

/// Cuts a file at every 97th byte. The reader may fail, but must not panic.
fn cut(bytes: &[u8], options: &str) {
    (0..bytes.len()).step_by(97).for_each(|at| drop(read_file(&bytes[..at], options)));
}

#[test]
fn bags_of_ros_1() {
    for bag in [ROSBAG, ROSBAG_BZ2, ROSBAG_LZ4] {
        let column = read_file(bag, "--column z").unwrap();
        is_z(&column, "/imu.angular_velocity.z");
        assert_eq!((column.scale, column.warnings.len()), (1f64.to_degrees(), 0));
        let column = read_file(bag, "--column linear_acceleration.z --rate 7").unwrap();
        assert_eq!((column.series, column.rate_hz), (Series::Numbers(vec![9.81; 19]), 7.0));
        assert!(fails(bag, "").contains("choose with --column one of: /imu.angular_velocity.x"));
        cut(bag, "--column z");
        // a bag that was not closed lists its connections in its chunks only
        let open = read_file(&bag[..bag.len() - 40], "--column z").unwrap();
        assert!(open.warnings[0].to_string().contains("was not closed or is damaged"), "{:?}", open.warnings);
        assert_eq!(open.series.len(), 20);
    }
    assert!(fails(b"#ROSBAG V1.2\nxxxxxx", "").contains("rosbag fix"));
}

/// IMU messages inside messages of another type, behind strings and lists of changing length.
#[test]
fn bags_with_nested_imus() {
    let bags = [
        &include_bytes!("../fixtures/nested.bag")[..],
        include_bytes!("../fixtures/nested.mcap"),
        include_bytes!("../fixtures/nested.db3"),
    ];
    for bag in bags {
        is_z(&read_file(bag, "--column z").unwrap(), "/bundle.state.imu.angular_velocity.z");
        let column = read_file(bag, "--column /bundle.state.imu.linear_acceleration.z --rate 7").unwrap();
        assert_eq!(column.series, Series::Numbers(vec![9.81; 19]));
        let said = fails(bag, "--topic /bundle --column z");
        assert!(said.contains("/bundle.state.imu") && said.contains("19"), "{said}");
        cut(bag, "--column z");
    }
}

#[test]
fn a_record_of_mcap_longer_than_any_file_ends_it() {
    let mut bytes = include_bytes!("../fixtures/imu_zstd.mcap").to_vec();
    let third = bytes.len() / 3;
    bytes[third..].fill(0x5A);
    let column = read_file(bytes, "--column z").unwrap();
    assert!(column.warnings[0].to_string().contains("was not closed or is damaged"), "{:?}", column.warnings);
    assert_eq!(column.series.len(), 9);
}

#[test]
fn bags_of_several_files() {
    let path = Path::new("bag_of_two");
    let parts = || {
        let files = [
            &include_bytes!("../fixtures/bag_of_two/bag_of_two_0.mcap")[..],
            include_bytes!("../fixtures/bag_of_two/bag_of_two_1.mcap"),
        ];
        let parts = files.iter().zip(0..).map(|(file, at)| (path.join(format!("{at}.mcap")), file.to_vec().into()));
        parts.collect::<Vec<(PathBuf, Input)>>()
    };
    let read = |parts, said: &str| read_parts(path, parts, ColumnSelection::One(Some("z")), &options(said));
    is_z(&read(parts(), "").unwrap()[0], "/imu.angular_velocity.z");
    assert_eq!(read(parts(), "--rate 5").unwrap()[0].series.len(), 19);
    let mut mixed = parts();
    mixed.push((PathBuf::from("other.csv"), b"z\n1\n2\n".to_vec().into()));
    assert!(
        read(mixed, "--rate 5")
            .unwrap_err()
            .to_string()
            .contains("other.csv: it has z where the file before has /imu")
    );
    assert!(read(Vec::new(), "").unwrap_err().to_string().contains("no file with a log"));
}

#[test]
fn archives_of_numpy() {
    for archive in [NPZ, NPZ_PACKED] {
        let column = read_file(archive, "--column gz_rad_s --time-column t_ns").unwrap();
        is_z(&column, "gz_rad_s");
        assert_eq!(column.scale, 1f64.to_degrees());
        cut(archive, "--column gz_rad_s --time-column t_ns");
    }
    let column = read_file(NPZ, "--column gyro.1 --rate 10").unwrap();
    assert_eq!((column.series.len(), numbers(&column)[3]), (19, -3.0));
    let said = fails(NPZ, "--rate 10");
    assert!(said.contains("one of: 0 `t_ns`, 1 `gz_rad_s`, 2 `gyro.0`, 3 `gyro.1`, 4 `gyro.2`"), "{said}");
    let mut empty = b"PK\x05\x06".to_vec();
    empty.extend([0; 18]);
    // the offset of the index, behind a local header of 30 bytes
    empty[16] = 30;
    let plain = [&b"PK\x03\x04"[..], &[0; 26], &empty].concat();
    assert!(fails(plain, "--rate 1").contains("without arrays of NumPy"));
}

#[test]
fn matrices_of_matlab() {
    for file in [MAT, MAT_PACKED] {
        for (name, time) in [("gz", "--time-column t --time-unit s"), ("imu.gx", "--time-column imu.t_s")] {
            is_z(&read_file(file, &format!("--column {name} {time}")).unwrap(), name);
        }
        for name in ["gyro.1", "lying.1"] {
            let column = read_file(file, &format!("--column {name} --rate 10")).unwrap();
            assert_eq!((column.series.len(), numbers(&column)[3]), (19, -3.0), "{name}");
            assert!(matches!(column.series, Series::Codes(_)));
        }
        let said = fails(file, "--rate 10");
        assert!(
            said.contains("0 `t`, 1 `gz`, 2 `gyro.0`") && !said.contains("`fs`") && !said.contains("note"),
            "{said}"
        );
        cut(file, "--column gz --rate 1");
    }
}

/// Files of h5py in its oldest and newest format, and a file that hdf5storage wrote for MATLAB.
#[test]
fn data_sets_of_hdf5() {
    for file in [HDF5, HDF5_LATEST] {
        is_z(&read_file(file, "--column imu/gz --time-column t_s").unwrap(), "imu/gz");
        is_z(&read_file(file, "--column table.gz --time-column table.t_ns").unwrap(), "table.gz");
        for name in ["imu/gyro.1", "lying.1"] {
            let column = read_file(file, &format!("--column {name} --rate 10")).unwrap();
            assert_eq!((column.series.len(), numbers(&column)[3]), (19, -3.0), "{name}");
            assert!(matches!(column.series, Series::Codes(_)));
        }
        let said = fails(file, "--rate 10");
        assert!(said.contains("0 `imu/gyro.0`, 1 `imu/gyro.1`, 2 `imu/gyro.2`, 3 `imu/gz`, 4 `lying.0`"), "{said}");
        assert!(!said.contains("`note`") && !said.contains("`fs`") && !said.contains("table.name"), "{said}");
        cut(file, "--column imu/gz --rate 1");
    }
    for (name, time) in [("gz", "--time-column t --time-unit s"), ("imu.gx", "--time-column imu.t_s")] {
        is_z(&read_file(MAT_73, &format!("--column {name} {time}")).unwrap(), name);
    }
    let said = fails(MAT_73, "--rate 10");
    assert!(said.contains("`gyro.2`") && !said.contains("note") && !said.contains('#'), "{said}");
    let short = fails(&HDF5[..HDF5.len() / 2], "--column imu/gz --rate 1");
    assert!(short.contains("as an HDF5 file"), "{short}");
    assert!(fails(b"\x89HDF\r\n\x1A\nxxxxxxxxx", "").contains("as an HDF5 file"));
    assert!(fails([b"MATLAB 7.3 MAT-file".as_slice(), &[0; 600]].concat(), "").contains("as an HDF5 file"));
}

#[test]
fn a_sample_rate_beside_the_columns_is_taken_and_said() {
    for (file, rate) in [(MAT_FS, "imu.Fs"), (NPZ_FS, "Fs")] {
        let column = read_file(file, "--column gz --unit dps").unwrap();
        let said: Vec<String> = column.warnings.iter().map(LogWarning::coded).collect();
        assert!(column.rate_hz == 200.0 && said.len() == 1, "{rate}: {} Hz, {said:?}", column.rate_hz);
        assert!(said[0].contains(&format!("`{rate}` states 200 Hz")), "{said:?}");
        let said = &read_file(file, "--column gz --unit dps --rate 100").unwrap().warnings;
        assert!(said[0].coded().contains("rate-contradicts"), "{said:?}");
    }
    // two columns of `HDF5` state a unit of time, so `fs` gives the rate; in the other files, one column states a unit
    for (file, name, said) in [(MAT, "imu.gx", 0), (MAT_73, "imu.gx", 0), (HDF5, "imu/gz", 1)] {
        let read = |options: &str| read_file(file, &format!("--column {name} --unit dps {options}")).unwrap();
        assert_eq!((read("").warnings.len(), read("").rate_hz.round()), (said, 200.0));
        assert!(read("--rate 100").warnings[0].coded().contains("rate-contradicts"));
    }
}

#[test]
fn units_in_the_attributes_of_a_data_set_are_used() {
    let read = |column: &str| read_file(HDF5_UNITS, &format!("--column {column} --time-column Time"));
    for (column, name, scale) in
        [("gz", "gz [rad/s]", 1f64.to_degrees()), ("ax", "ax [m/s²]", 1.0), ("gy_dps", "gy_dps", 1.0)]
    {
        let column = read(column).unwrap();
        let said: Vec<String> = column.warnings.iter().map(LogWarning::coded).collect();
        assert_eq!((&*column.name, column.scale), (name, scale));
        assert!((column.rate_hz - 200.0).abs() < 1e-9, "{}", column.rate_hz);
        assert!(said.len() == 1 && said[0].contains("250.000000 Hz was given"), "{said:?}");
    }
    let other = fails(HDF5_UNITS, "--column gz --time-column Time --unit dps");
    assert!(other.contains("states rad/s, and --unit says dps"), "{other}");
    assert_eq!(read_file(HDF5_UNITS, "--column gz").unwrap().rate_hz, 200.0);
    let at = HDF5_UNITS.windows(5).position(|text| text == b"deg/s").unwrap();
    let codes = [&HDF5_UNITS[..at], b"codes", &HDF5_UNITS[at + 5..]].concat();
    let column = read_file(codes, "--column gy_dps --time-column Time").unwrap();
    assert_eq!((&*column.name, column.quantity), ("gy_dps [codes]", None));
}

#[test]
fn logs_of_px4() {
    let column = read_file(ULOG, "--column sensor_gyro#0.z").unwrap();
    is_z(&column, "sensor_gyro#0.z");
    assert_eq!(column.scale, 1f64.to_degrees());
    is_z(&read_file(ULOG, "--column sensor_combined.gyro_rad[2]").unwrap(), "sensor_combined.gyro_rad[2]");
    assert_eq!(numbers(&read_file(ULOG, "--column sensor_gyro#1.z --rate 1").unwrap())[2], 1.0);
    assert_eq!(numbers(&read_file(ULOG, "--column sensor_gyro#0.device_id").unwrap())[0], 7.0);
    let columns = all(ULOG, ColumnSelection::All, "").unwrap();
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!((names.len(), names[3]), (6, "sensor_combined.accelerometer_m_s2[0]"));
    assert_eq!(columns[5].quantity, Some(Quantity::Acceleration));
    let of_topic = all(ULOG, ColumnSelection::All, "--topic sensor_gyro#0").unwrap();
    assert_eq!(of_topic[2].name, "sensor_gyro#0.z");
    let said = all(ULOG, ColumnSelection::All, "--topic chat").unwrap_err();
    let rows: Vec<Vec<String>> =
        said.to_string().lines().map(|line| line.split_whitespace().map(str::to_owned).collect()).collect();
    let row = rows.iter().find(|row| row[0] == "sensor_gyro#0").expect("the row of a topic");
    assert_eq!(row[1..5], ["sensor_gyro", "19", "189.47", "Hz"].map(str::to_owned), "{said}");
    let said = fails(ULOG, "");
    assert!(said.contains("one of: sensor_combined.gyro_rad[0]") && said.contains("sensor_gyro#1.z"), "{said}");
    cut(ULOG, "--column sensor_gyro#0.z");
    // inside the body and inside the head of a message
    for torn in [&ULOG[..ULOG.len() - 9], &[ULOG, &[40, 0]].concat()] {
        let torn = read_file(torn, "--column sensor_gyro#0.z").unwrap();
        assert!(torn.warnings[0].to_string().contains("ends inside a message"), "{:?}", torn.warnings);
    }
}

#[test]
fn logs_of_ardupilot() {
    let column = read_file(DATAFLASH, "--column IMU[0].GyrZ").unwrap();
    is_z(&column, "IMU[0].GyrZ");
    assert_eq!(column.scale, 1f64.to_degrees());
    assert_eq!(numbers(&read_file(DATAFLASH, "--topic IMU[1] --column GyrZ").unwrap())[2], -0.5);
    let of_topic = all(DATAFLASH, ColumnSelection::All, "--topic IMU[1]").unwrap();
    let names: Vec<String> = of_topic.into_iter().map(|column| column.name).collect();
    assert_eq!((names.len(), &*names[3]), (6, "IMU[1].AccX"));
    let said = all(DATAFLASH, ColumnSelection::All, "").unwrap_err().to_string();
    assert!(said.contains("several IMUs") && said.contains("IMU[0]") && !said.contains("BARO"), "{said}");
    assert!(fails(DATAFLASH, "--column IMU[0].Nothing").contains("one of: IMU[0].GyrX"));
    // four stray bytes in the middle, and a file that ends inside a message
    let at = DATAFLASH.len() / 2;
    let torn = [&DATAFLASH[..at], &[0xA3, 0x95, 7, 0xA3], &DATAFLASH[at..DATAFLASH.len() - 9]].concat();
    let torn = read_file(torn, "--column IMU[0].GyrZ").unwrap();
    assert!(torn.warnings[0].to_string().contains(" unreadable bytes in "), "{:?}", torn.warnings);
    assert!(torn.series.len() - torn.missing() as usize >= 17, "{}", torn.series.len());
}

#[test]
fn text_of_two_bytes_to_a_character() {
    let text = "t_ms;gz_°/s\r\n0;0,5\r\n10;-1,25\r\n20;3,0\r\n";
    let wide = |mark: &str, to_bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("{mark}{text}").encode_utf16().flat_map(to_bytes).collect()
    };
    for (mark, to_bytes) in [
        ("\u{FEFF}", u16::to_le_bytes as fn(u16) -> [u8; 2]),
        ("\u{FEFF}", u16::to_be_bytes),
        ("", u16::to_le_bytes),
        ("", u16::to_be_bytes),
    ] {
        let column = read_file(wide(mark, to_bytes), "--column 1 --time-column t_ms").unwrap();
        assert_eq!((numbers(&column), column.rate_hz), (vec![0.5, -1.25, 3.0], 100.0));
    }
}
