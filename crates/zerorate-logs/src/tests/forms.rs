//! Tests of the formats that a Cargo feature adds.

use super::*;
use std::io::{Cursor, Write};

/// Four lines, `0.5`, `0.25`, `-1.5` and `2`, as Python's gzip, lzma and zstandard pack them.
pub const GZIP: &[u8] = b"\
    \x1F\x8B\x08\x00\x00\x00\x00\x00\x02\x03\x33\xD0\x33\xE5\x32\xD0\x33\x32\xE5\xD2\x35\x04\xB2\x8C\xB8\x00\
    \x3C\x10\xE6\xEC\x10\x00\x00\x00";
pub const XZ: &[u8] = b"\
    \xFD\x37\x7A\x58\x5A\x00\x00\x01\x69\x22\xDE\x36\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\x01\x00\
    \x0F\x30\x2E\x35\x0A\x30\x2E\x32\x35\x0A\x2D\x31\x2E\x35\x0A\x32\x0A\x00\x3C\x10\xE6\xEC\x00\x01\x24\x10\
    \xE9\x44\xD9\xCC\x90\x42\x99\x0D\x01\x00\x00\x00\x00\x01\x59\x5A";
pub const ZSTD: &[u8] =
    b"\x28\xB5\x2F\xFD\x20\x10\x81\x00\x00\x30\x2E\x35\x0A\x30\x2E\x32\x35\x0A\x2D\x31\x2E\x35\x0A\x32\x0A";

/// Logs that common libraries wrote or read back (`fixtures/make.py`).
pub const NPZ: &[u8] = include_bytes!("../../fixtures/imu.npz");
pub const NPZ_PACKED: &[u8] = include_bytes!("../../fixtures/imu_packed.npz");
pub const MAT: &[u8] = include_bytes!("../../fixtures/imu.mat");
pub const MAT_PACKED: &[u8] = include_bytes!("../../fixtures/imu_packed.mat");
pub const MAT_73: &[u8] = include_bytes!("../../fixtures/imu73.mat");
pub const MAT_FS: &[u8] = include_bytes!("../../fixtures/imu_fs.mat");
pub const NPZ_FS: &[u8] = include_bytes!("../../fixtures/imu_fs.npz");
pub const HDF5_UNITS: &[u8] = include_bytes!("../../fixtures/imu_units.h5");
pub const HDF5: &[u8] = include_bytes!("../../fixtures/imu.h5");
pub const HDF5_LATEST: &[u8] = include_bytes!("../../fixtures/imu_latest.h5");
pub const ROSBAG: &[u8] = include_bytes!("../../fixtures/imu_none.bag");
pub const ROSBAG_BZ2: &[u8] = include_bytes!("../../fixtures/imu_bz2.bag");
pub const ROSBAG_LZ4: &[u8] = include_bytes!("../../fixtures/imu_lz4.bag");
pub const ULOG: &[u8] = include_bytes!("../../fixtures/imu.ulg");
pub const DATAFLASH: &[u8] = include_bytes!("../../fixtures/imu.bin");

#[test]
fn packed_files_are_known_by_their_content() {
    for packed in [GZIP, XZ, ZSTD] {
        let column = read_file(packed, "--rate 10 --unit dps").unwrap();
        assert_eq!(numbers(&column), [0.5, 0.25, -1.5, 2.0]);
        assert!(fails(&packed[..packed.len() - 9], "--rate 10").contains("cannot be unpacked"));
    }
    // 16 bytes of text are two f64
    assert_eq!(read_file(GZIP, "--rate 10 --raw f64").unwrap().series.len(), 2);
    let twice = zstd::encode_all(GZIP, 1).unwrap();
    assert!(fails(twice, "--rate 10").contains("packed twice"));
    let batch = vec![("x", Arc::new(Float64Array::from(vec![1.5, 2.5])) as ArrayRef)];
    let packed = zstd::encode_all(Cursor::new(parquet_of(&batch)), 1).unwrap();
    assert_eq!(numbers(&read_file(packed, "--rate 10").unwrap()), [1.5, 2.5]);
}

#[test]
fn lz4_of_several_frames_is_read_whole() {
    let packed = |text: &str| {
        let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
        encoder.write_all(text.as_bytes()).unwrap();
        encoder.finish().unwrap()
    };
    let frames = [packed("0.5\n0.25\n"), packed(""), packed("-1.5\n2\n")].concat();
    assert_eq!(numbers(&read_file(&frames, "--rate 10").unwrap()), [0.5, 0.25, -1.5, 2.0]);
    assert!(fails([&frames[..], b"and more"].concat(), "--rate 10").contains("cannot be unpacked"));
}

/// An array of a type without fields has no bytes, and may state any length.
#[test]
fn a_ulog_of_endless_arrays_is_refused() {
    let message = |kind: u8, body: &[u8]| [&(body.len() as u16).to_le_bytes()[..], &[kind], body].concat();
    let log = [
        b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec(),
        message(b'F', b"e:"),
        message(b'F', b"sensor_gyro:uint64_t timestamp;float x;e[3000000000] p;"),
        message(b'A', b"\0\0\0sensor_gyro"),
    ];
    assert!(fails(log.concat(), "--column sensor_gyro.x").contains("sensor_gyro.x"));
}

#[test]
fn a_matrix_that_states_no_rows_and_holds_numbers_is_an_error() {
    let mut mat = MAT.to_vec();
    assert_eq!(mat[160..168], [19, 0, 0, 0, 1, 0, 0, 0]);
    mat[164] = 0;
    let why = fails(mat, "--column gz");
    assert!(why.contains("states 19 x 0 numbers, and holds some"), "{why}");
}

/// An NPY file of format 1.0, put together as NEP 1 describes.
pub fn npy(header: &str, data: impl AsRef<[u8]>) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    let padding = " ".repeat(63 - (10 + header.len()) % 64);
    file.extend(((header.len() + padding.len() + 1) as u16).to_le_bytes());
    file.extend(format!("{header}{padding}\n").as_bytes());
    file.extend(data.as_ref());
    file
}

#[test]
fn npy_of_every_type() {
    let header = |descr: &str| format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2,), }}");
    let cases: [(&str, Vec<u8>, [f64; 2]); 12] = [
        ("|i1", vec![5, 0xFE], [5.0, -2.0]),
        ("|u1", vec![5, 0xFE], [5.0, 254.0]),
        ("<i2", vec![5, 0, 0xFE, 0xFF], [5.0, -2.0]),
        (">i2", vec![0, 5, 0xFF, 0xFE], [5.0, -2.0]),
        (">u2", vec![0, 5, 0xFF, 0xFE], [5.0, 65534.0]),
        ("<i4", [5i32, -2].map(i32::to_le_bytes).concat(), [5.0, -2.0]),
        (">u4", [5u32, 4_000_000_000].map(u32::to_be_bytes).concat(), [5.0, 4e9]),
        ("<i8", [5i64, -2].map(i64::to_le_bytes).concat(), [5.0, -2.0]),
        ("<u8", [5u64, 1 << 63].map(u64::to_le_bytes).concat(), [5.0, 9_223_372_036_854_775_808.0]),
        (">f4", [1.5f32, -2.5].map(f32::to_be_bytes).concat(), [1.5, -2.5]),
        ("<f8", [1.5f64, -2.5].map(f64::to_le_bytes).concat(), [1.5, -2.5]),
        (">f8", [1.5f64, -2.5].map(f64::to_be_bytes).concat(), [1.5, -2.5]),
    ];
    for (descr, data, expected) in cases {
        let column = read_file(npy(&header(descr), data), "--rate 10").unwrap();
        assert_eq!(numbers(&column), expected, "{descr}");
        assert_eq!(
            matches!(column.series, Series::Codes(_)),
            expected.iter().all(|n| n.abs() < 1e5 && n.fract() == 0.0)
        );
    }
    let missing = npy(&header("<f8"), [f64::NAN, 1.0].map(f64::to_le_bytes).concat());
    assert_eq!(there(&read_file(missing, "--rate 10").unwrap()), [None, Some(1.0)]);
}

#[test]
fn npy_of_two_dimensions_and_of_fields() {
    let header = |order| format!("{{'descr': '<i2', 'fortran_order': {order}, 'shape': (3, 2), }}");
    let rows = [1i16, 10, 2, 20, 4, 40].map(i16::to_le_bytes).concat();
    let columns = [1i16, 2, 4, 10, 20, 40].map(i16::to_le_bytes).concat();
    for file in [npy(&header("False"), rows), npy(&header("True"), columns)] {
        let column = read_file(&file, "--column 1 --time-column 0 --time-unit s").unwrap();
        assert_eq!(
            (numbers(&column), column.gaps.as_slice()),
            (vec![10.0, 20.0, 40.0], &[Gap { at: 2, missing: 1 }][..])
        );
        assert!(fails(&file, "--rate 10").contains("several columns; choose with --column one of: 0, 1"));
    }
    // with more than 64 columns and fewer rows, each column is a sample
    let header = "{'descr': '<i2', 'fortran_order': False, 'shape': (2, 300), }";
    let file = npy(header, (0..600i16).map(i16::to_le_bytes).collect::<Vec<_>>().concat());
    assert_eq!(numbers(&read_file(&file, "--column 1 --rate 10").unwrap())[..2], [300.0, 301.0]);
    let descr = "[('t', '<M8[ms]'), ('ok', '|u1'), ('gz_rad_s', '>f4'), ('name', '<U2')]";
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (3,), }}");
    let row = |t: i64, z: f32| [&t.to_le_bytes()[..], &[1], &z.to_be_bytes(), &[0; 8]].concat();
    let file = npy(&header, [row(1000, 0.5), row(1010, 1.5), row(1020, 2.5)].concat());
    let column = read_file(&file, "--column gz_rad_s --time-column t").unwrap();
    assert_eq!((numbers(&column), column.rate_hz, column.scale), (vec![0.5, 1.5, 2.5], 100.0, 1f64.to_degrees()));
    assert!(fails(&file, "--column name --rate 1").contains("holds no numbers in `name`"));
    assert!(
        fails(&file[..file.len() - 1], "--column ok --rate 1")
            .contains("header states 63 bytes of data and 62 follow")
    );
}

/// Two recordings by the Python writer mcap-ros2-support 0.6.0: 8 messages at 200 Hz, one missing before the sixth.
#[test]
fn bags_of_an_independent_writer() {
    for bag in [&include_bytes!("../../fixtures/imu_zstd.mcap")[..], include_bytes!("../../fixtures/imu_lz4.mcap")] {
        let column = read_file(bag, "--column z").unwrap();
        assert_eq!(
            there(&column),
            [0.0, 0.25, 0.5, 0.75, 1.0, f64::NAN, 1.25, 1.5, 1.75].map(|n| Some(n).filter(|n| !n.is_nan()))
        );
        assert_eq!(
            (column.name.as_str(), column.scale, column.rate_hz),
            ("/imu.angular_velocity.z", 1f64.to_degrees(), 200.0)
        );
        assert_eq!(
            read_file(bag, "--column /imu.angular_velocity.y --rate 10").unwrap().series,
            Series::Numbers(vec![-0.5; 8])
        );
        let gravity = read_file(bag, "--column linear_acceleration.z").unwrap();
        assert_eq!((numbers(&gravity)[0], gravity.quantity), (9.81, Some(Quantity::Acceleration)));
        let asked = fails(bag, "");
        assert!(
            asked.contains("choose with --column one of: /imu.angular_velocity.x, /imu.angular_velocity.y"),
            "{asked}"
        );
        assert!(fails(bag, "--column /gyro.angular_velocity.x").contains("no column `/gyro.angular_velocity.x`"));
        for at in (0..bag.len()).step_by(13) {
            drop(read_file(&bag[..at], "--column z"));
        }
    }
}

/// An IMU message, put together by hand. CDR aligns numbers to their size, and ROS 1 does not.
pub fn imu(cdr: bool, big_endian: bool, ns: u64, z: f64) -> Vec<u8> {
    let u32_of = |number: u32| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
    let f64_of = |number: f64| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
    let mut body = Vec::new();
    body.extend(u32_of((ns / 1_000_000_000) as u32));
    body.extend(u32_of((ns % 1_000_000_000) as u32));
    let frame: &[u8] = if cdr { b"imu\0" } else { b"imu" };
    body.extend(u32_of(frame.len() as u32));
    body.extend(frame);
    while cdr && !body.len().is_multiple_of(8) {
        body.push(0);
    }
    for at in 0..37 {
        body.extend(f64_of(if at == 15 { z } else { 100.0 + f64::from(at) }));
    }
    let start: &[u8] = if cdr { &[0, u8::from(!big_endian), 0, 0] } else { &[9, 0, 0, 0] };
    [start, &body].concat()
}

fn mcap(topics: &[&str], encoding: &str, messages: impl Fn(u64) -> Vec<u8>) -> Vec<u8> {
    mcap_packed(Some(mcap::Compression::Zstd), topics, encoding, messages)
}

pub fn mcap_packed(
    packing: Option<mcap::Compression>,
    topics: &[&str],
    encoding: &str,
    messages: impl Fn(u64) -> Vec<u8>,
) -> Vec<u8> {
    let topics: Vec<(&str, &str)> = topics.iter().map(|topic| (*topic, "sensor_msgs/msg/Imu")).collect();
    mcap_of_types(packing, &topics, encoding, |_, i| messages(i))
}

/// A bag with 20 messages of each topic; topics are given with their types. `messages` takes the number of the topic
/// and the number of the message in it.
fn mcap_of_types(
    packing: Option<mcap::Compression>,
    topics: &[(&str, &str)],
    encoding: &str,
    messages: impl Fn(usize, u64) -> Vec<u8>,
) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().compression(packing).create(&mut file).unwrap();
    for (at, (topic, kind)) in topics.iter().enumerate() {
        let schema = writer.add_schema(kind, "ros2msg", b"").unwrap();
        let channel = writer.add_channel(schema, topic, encoding, &Default::default()).unwrap();
        for i in 0..20 {
            let log_time = i * 10_000_000;
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: i as u32,
                log_time,
                publish_time: log_time,
            };
            writer.write_to_known_channel(&header, &messages(at, i)).unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

/// The bag of a driver that does not stamp its messages.
#[test]
fn a_bag_of_zero_stamps_has_the_times_of_its_recording() {
    let bag = mcap_packed(None, &["/imu"], "cdr", |i| imu(true, false, 0, (i % 7) as f64));
    let column = read_file(bag, "--column z").unwrap();
    assert!((column.rate_hz - 100.0).abs() < 1e-6, "{}", column.rate_hz);
    let is_mended =
        |warning: &LogWarning| warning.to_string().contains("all stamps are 0; the times at which the bag");
    assert!(column.warnings.iter().any(is_mended), "{:?}", column.warnings);
}

#[test]
fn messages_in_every_encoding() {
    for (name, cdr, big_endian) in [("cdr", true, false), ("cdr", true, true), ("ros1", false, false)] {
        let bag =
            mcap(&["/imu"], name, |i| imu(cdr, big_endian, 1_700_000_000_000_000_000 + i * 10_000_000, i as f64));
        let column = read_file(&bag, "--column z").unwrap();
        assert_eq!((numbers(&column), column.rate_hz), ((0..20).map(f64::from).collect(), 100.0));
    }
    let two = mcap(&["/a", "/b"], "cdr", |i| imu(true, false, i * 10_000_000, i as f64));
    let asked = fails(&two, "--column z");
    let head = ["topic", "type", "messages", "rate", "duration", "frame_id"];
    let row = ["/b", "sensor_msgs/msg/Imu", "20", "100.00", "Hz", "0.2", "s", "imu"];
    let rows: Vec<Vec<&str>> = asked.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(asked.contains("several IMUs; choose one with --topic") && rows[1] == head && rows[3] == row, "{asked}");
    assert_eq!(read_file(&two, "--column z --topic /b").unwrap().name, "/b.angular_velocity.z");
    assert!(fails(&two, "--column z --topic /c").contains("no IMU on a topic `/c`"));
    assert!(fails(&two, "--column w --topic /b").contains("one of: /b.angular_velocity.x"));
    assert_eq!(read_file(&two, "--column /b.angular_velocity.z").unwrap().series.len(), 20);
    let short = mcap(&["/imu"], "cdr", |_| vec![0, 1, 0, 0, 5]);
    assert!(
        fails(&short, "--column z").contains("topic /imu, message 0: its 5 bytes are not a sensor_msgs/Imu in Cdr")
    );
    let back = mcap(&["/imu"], "cdr", |i| imu(true, false, (30 - i) * 1000, 0.0));
    let said =
        "column /imu.header.stamp: the time goes back by 0.000001 s, at row 1: the newest row is first; reverse";
    assert!(fails(&back, "--column z").contains(said));
    let other = mcap(&["/imu"], "json", |_| b"{}".to_vec());
    assert!(fails(&other, "--column z").contains("topic /imu: its messages are encoded in `json`"));
}

/// The tables that rosbag2_storage_sqlite3 makes, with 8 messages at 100 Hz, one missing before the fifth.
pub fn sqlite_bag() -> Vec<u8> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("bag.db3");
    let bag = rusqlite::Connection::open(&path).unwrap();
    bag.execute_batch(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format \
         TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data \
         BLOB NOT NULL);
         INSERT INTO topics VALUES (1, '/chat', 'std_msgs/msg/String', 'cdr', ''), (2, '/imu', 'sensor_msgs/msg/Imu', \
         'cdr', '');
         INSERT INTO messages(topic_id, timestamp, data) VALUES (1, 0, x'00010000');",
    )
    .unwrap();
    for i in [0, 1, 2, 3, 5, 6, 7, 8] {
        let message = imu(true, false, i * 10_000_000, i as f64);
        let message = if i > 4 { zstd::encode_all(&message[..], 1).unwrap() } else { message };
        bag.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (2, ?1, ?2)", (i as i64, message))
            .unwrap();
    }
    drop(bag);
    fs::read(&path).unwrap()
}

/// The bag with the type `kind` of its messages replaced by a joystick's, whose name is as long.
fn of_joysticks(bag: &[u8], kind: &[u8]) -> Vec<u8> {
    let joy = [&kind[..kind.len() - 3], b"Joy"].concat();
    let mut bag = bag.to_vec();
    for at in 0..bag.len() - kind.len() {
        if bag[at..].starts_with(kind) {
            bag[at..at + kind.len()].copy_from_slice(&joy);
        }
    }
    bag
}

#[test]
fn bags_without_an_imu_name_their_topics() {
    let joy = "sensor_msgs/msg/Joy";
    let mcap = mcap_of_types(None, &[("/b", joy), ("/a", joy)], "cdr", |_, _| vec![0, 1, 0, 0]);
    for (bag, topics) in [
        (mcap, "it has /a (sensor_msgs/msg/Joy), /b (sensor_msgs/msg/Joy)"),
        (of_joysticks(ROSBAG, b"sensor_msgs/Imu"), "it has /chat (std_msgs/String), /imu (sensor_msgs/Joy)"),
        (
            of_joysticks(&sqlite_bag(), b"sensor_msgs/msg/Imu"),
            "it has /chat (std_msgs/msg/String), /imu (sensor_msgs/msg/Joy)",
        ),
    ] {
        let said = fails(bag, "--column z");
        assert!(
            said.contains("a bag without a topic of type sensor_msgs/msg/Imu") && said.ends_with(topics),
            "{said}"
        );
    }
    let many: Vec<String> = (0..30).map(|at| format!("/{at:02}")).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|topic| (topic.as_str(), joy)).collect();
    let bag = mcap_of_types(None, &many, "cdr", |_, _| vec![0, 1, 0, 0]);
    assert!(fails(bag, "--column z").ends_with("/19 (sensor_msgs/msg/Joy), and 10 more"));
}

#[test]
fn bags_in_sqlite() {
    let content = sqlite_bag();
    for content in [content.clone(), zstd::encode_all(&content[..], 1).unwrap()] {
        let column = read_file(&content, "--column z").unwrap();
        assert_eq!((column.series.len(), column.missing(), column.rate_hz), (9, 1, 100.0));
    }
    assert!(fails(&content[..5000], "--column z").contains("ros2 bag"));
}

/// A temperature message in CDR: `std_msgs/Header header; float64 temperature; float64 variance`.
fn temperature(ns: u64, temp_c: f64) -> Vec<u8> {
    let mut message = imu(true, false, ns, 0.0);
    message.truncate(message.len() - 37 * 8);
    message.extend([temp_c, 0.0].map(f64::to_le_bytes).concat());
    message
}

#[test]
fn a_bag_with_topics_of_temperature() {
    let imus = |topics: &[&str]| {
        let mut all = vec![("/front/imu", "sensor_msgs/msg/Imu")];
        all.extend(topics.iter().map(|topic| (*topic, "sensor_msgs/msg/Temperature")));
        mcap_of_types(None, &all, "cdr", |topic, i| match topic {
            0 => imu(true, false, i * 10_000_000, i as f64),
            topic => temperature(1_000_000 + i * 20_000_000, (20 * topic as u64 + i) as f64),
        })
    };
    let one = imus(&["/front/temperature"]);
    let column = read_file(&one, "--column temperature").unwrap();
    assert_eq!((column.name.as_str(), column.rate_hz), ("/front/temperature.temperature", 50.0));
    assert_eq!((column.quantity, column.start_s), (Some(Quantity::Temperature), Some(0.001)));
    assert_eq!(numbers(&column), (20..40).map(f64::from).collect::<Vec<_>>());
    assert_eq!(read_file(&one, "--column z").unwrap().name, "/front/imu.angular_velocity.z", "the only IMU");
    let two = imus(&["/baro/temperature", "/front/temperature"]);
    let near = read_file(&two, "--column temperature --topic /front/imu").unwrap();
    assert_eq!(near.name, "/front/temperature.temperature");
    let likewise = imus(&["/front2/temperature", "/front/imu/temperature"]);
    let near = read_file(&likewise, "--column temperature --topic /front/imu").unwrap();
    assert_eq!(near.name, "/front/imu/temperature.temperature", "another sensor's name begins alike");
    let given = read_file(&two, "--column /baro/temperature").unwrap();
    assert_eq!(given.name, "/baro/temperature.temperature");
    let asked = fails(&two, "--column temperature");
    assert!(asked.contains("several temperatures; choose one with --temp-column:\n  /baro/temperature"), "{asked}");
}
