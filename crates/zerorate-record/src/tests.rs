//! Every format keeps every sample. Files that are torn, damaged or of another kind are reported.

use super::*;
use adis16130::Width;
use std::fs::{self, File};
use tempfile::TempDir;

pub(super) const FORMATS: &[Format] = &[
    Format::Arrows,
    Format::Csv,
    #[cfg(feature = "parquet")]
    Format::Parquet,
];

/// Number of samples that are lost before every 1000th sample.
const LOST: u32 = 3;

pub(super) fn info() -> CaptureInfo {
    CaptureInfo {
        device: "twin:seed=7,bias_dps=0.8".to_owned(),
        serial: Some("A = 17, \"ä\"".to_owned()),
        every_temp: 3,
        bandwidth_hz: Some(50.0),
        earth_dps: Some(-0.00209),
        software: "zerorate 0.1.0".to_owned(),
        ..CaptureInfo::adis16130(Converter { width: Width::Bits24, rate_conversion: 5, temp_conversion: 0x91 })
    }
}

/// Samples at 5.7 kSPS with every kind of row: with and without status, temperature and losses, and extreme codes.
fn samples(n: u32) -> Vec<Row> {
    let row = |i: u32| {
        let t_ns = 1_000 + u64::from(i + LOST * (i / 1000)) * 175_667;
        Row::new(t_ns, i.wrapping_sub(7), &[(i.wrapping_mul(2_654_435_761) >> 8).into()])
            .unwrap()
            .with_status((!i.is_multiple_of(5)).then_some(i & 0xFF))
            .with_temp_code(i.is_multiple_of(3).then(|| (0x00FF_FFFF - i).into()))
            .with_lost(if i > 0 && i.is_multiple_of(1000) { LOST } else { 0 })
    };
    (0..n).map(row).collect()
}

pub(super) fn open(path: &Path) -> Result<CaptureReader, CaptureError> {
    let file = File::open(path).map_err(|error| CaptureError::io("read", path, error))?;
    CaptureReader::open(path, file.into())
}

pub(super) fn start(path: &Path, format: Format, info: &CaptureInfo) -> CaptureWriter {
    CaptureWriter::create(path, Box::new(File::create(path).unwrap()), format, info).unwrap()
}

pub fn bytes(format: Format, count: u32) -> Vec<u8> {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("capture");
    write(&path, format, &info(), &samples(count));
    fs::read(&path).unwrap()
}

pub(super) fn write(path: &Path, format: Format, info: &CaptureInfo, samples: &[Row]) -> CaptureSummary {
    let mut writer = start(path, format, info);
    samples.iter().for_each(|sample| writer.push(sample).unwrap());
    writer.finish().unwrap()
}

pub(super) fn read(path: &Path) -> (Vec<Row>, Option<String>) {
    let mut reader = open(path).unwrap();
    let samples = reader.by_ref().collect::<Result<_, _>>().unwrap();
    let said: Vec<String> = reader.warnings().iter().map(ToString::to_string).collect();
    (samples, (!said.is_empty()).then(|| said.join("; ")))
}

fn open_error(path: &Path) -> String {
    match open(path) {
        Ok(_) => panic!("{} was taken for a capture", path.display()),
        Err(error) => error.to_string(),
    }
}

#[test]
fn every_form_gives_back_every_sample() {
    let dir = TempDir::new().unwrap();
    for count in [0, 1, 20_000] {
        let samples = samples(count);
        for &format in FORMATS {
            let path = dir.path().join(format!("{count}.{format:?}"));
            let summary = write(&path, format, &info(), &samples);
            let lost = samples.iter().map(|sample| u64::from(sample.lost)).sum();
            assert_eq!(summary, CaptureSummary { samples: u64::from(count), lost });
            assert_eq!(read(&path), (samples.clone(), None), "{format:?}");
            assert_eq!(open(&path).unwrap().info(), &info(), "{format:?}");
        }
    }
}

#[test]
fn sixteen_bit_codes_keep_their_width() {
    let dir = TempDir::new().unwrap();
    let sample = Row::new(1_000, 0, &[55_706]).unwrap();
    for &format in FORMATS {
        let path = dir.path().join(format!("{format:?}"));
        let narrow = Converter { width: Width::Bits16, ..info().converter.unwrap() };
        write(&path, format, &CaptureInfo::adis16130(narrow), &[sample]);
        assert_eq!(read(&path).0, [sample]);
    }
}

/// The two rows in docs/formats/capture.md. Python's hashlib over struct.pack gave their hash.
#[test]
fn the_hash_is_that_of_the_document() {
    let row = |t_ns, seq, code| Row::new(t_ns, seq, &[code]).unwrap().with_status(Some(8));
    let mut hash = SampleHash::new(&info().layout);
    hash.update(&row(87_833_333, 41, 8_400_000).with_temp_code(Some(8_401_112)));
    hash.update(&row(263_500_000, 42, 8_399_871));
    assert_eq!(hash.hex(), "46fffcb6d6b70b295f39d5dc0e1dcd1b74ff976a1d339b49fa1787e92b063787");
}

#[test]
fn a_torn_stream_keeps_its_whole_batches() {
    let dir = TempDir::new().unwrap();
    let samples = samples(15_000);
    let bytes = bytes(Format::Arrows, 15_000);
    let ends = batch_ends(&bytes);
    let batches: Vec<usize> = vec![5_678, 11_353, 15_000, 15_000];
    assert_eq!(ends.len(), batches.len() + 1, "the schema, batches of 1 s, and the end");
    let near_ends = ends.iter().flat_map(|end| end - 9..end + 9);
    let cuts =
        (ends[0]..bytes.len() - 8).step_by(4_801).chain(near_ends).filter(|cut| (ends[0]..bytes.len()).contains(cut));
    for cut in cuts {
        let torn = dir.path().join("torn.arrows");
        fs::write(&torn, &bytes[..cut]).unwrap();
        let whole = ends[1..].iter().filter(|end| **end <= cut).count();
        let expected = if whole == 0 { 0 } else { batches[whole - 1] };
        let (found, warning) = read(&torn);
        assert!(found == samples[..expected], "cut at {cut}: {} samples instead of {expected}", found.len());
        assert!(
            warning.unwrap().contains(&format!("the {} bytes after", cut - ends[..=whole].last().unwrap())),
            "cut at {cut}"
        );
    }
}

/// Offsets in a stream at which the schema and each batch end, bytes.
pub(super) fn batch_ends(bytes: &[u8]) -> Vec<usize> {
    let mut reader = std::io::Cursor::new(bytes);
    let mut stream = arrow_ipc::reader::StreamReader::try_new(&mut reader, None).unwrap();
    let mut ends = vec![stream.get_ref().position() as usize];
    while let Some(batch) = stream.next() {
        batch.unwrap();
        ends.push(stream.get_ref().position() as usize);
    }
    ends
}

/// After a power cut, the end of a file may consist of zeros, because the file system never filled it.
#[test]
fn a_tail_of_zeros_is_dropped() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("zeros.arrows");
    let mut bytes = bytes(Format::Arrows, 5_693);
    bytes.truncate(bytes.len() - 8);
    bytes.extend([0; 4096]);
    fs::write(&path, bytes).unwrap();
    let (found, warning) = read(&path);
    assert_eq!(found, samples(5_693));
    assert!(warning.unwrap().contains("dropped"));
}

#[test]
fn a_stream_cut_inside_its_schema_is_an_error() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("head.arrows");
    let bytes = bytes(Format::Arrows, 10);
    for cut in [4, 7, 8, 100, batch_ends(&bytes)[0] - 1] {
        fs::write(&path, &bytes[..cut]).unwrap();
        assert!(open_error(&path).contains("head.arrows"), "cut at {cut}");
    }
}

#[test]
fn a_dropped_writer_closes_its_file() {
    let dir = TempDir::new().unwrap();
    let samples = samples(100);
    for &format in FORMATS {
        let path = dir.path().join(format!("{format:?}"));
        let mut writer = start(&path, format, &info());
        samples.iter().for_each(|sample| writer.push(sample).unwrap());
        drop(writer);
        assert_eq!(read(&path), (samples.clone(), None), "{format:?}");
    }
}

#[test]
fn whole_batches_are_readable_while_recording() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("live.arrows");
    let samples = samples(12_000);
    let mut writer = start(&path, Format::Arrows, &info());
    assert_eq!(read(&path).0, []);
    samples.iter().for_each(|sample| writer.push(sample).unwrap());
    assert_eq!(read(&path).0, samples[..11_353]);
}

#[test]
fn other_files_are_named_and_explained() {
    let dir = TempDir::new().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = dir.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let cases = [
        (file("empty", b""), "it is empty"),
        (file("text.csv", b"t,x\n1,2\n"), "# zerorate."),
        (file("bare.csv", b"# zerorate.width_bits = 24\nt_ns,rate_code\n"), "zerorate.capture_schema"),
        (file("feather.arrow", b"ARROW1\0\0"), "convert"),
        #[cfg(feature = "parquet")]
        (file("cut.parquet", b"PAR1PAR1"), "not closed"),
        (dir.path().to_owned(), "directory"),
        (dir.path().join("absent"), "cannot read"),
    ];
    for (path, reason) in cases {
        let error = open_error(&path);
        assert!(error.contains(reason) && error.contains(&path.display().to_string()), "{error}");
    }
}

#[test]
fn a_csv_says_where_it_is_wrong() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("edited.csv");
    let header = "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n\
        # zerorate.temp_conversion = 5\nlost,t_ns,rate_code,note,temp_code,status,edge_seq\n";
    let cases = [
        ("0,10,8388608,x,,,1\n0,20,abc,x,,,2\n", "line 7, column rate_code: `abc`"),
        ("0,10,8388608,x,,,1\n0,20,8388608\n", "line 7, column note: the line ends"),
        ("0,10,8388608,x,,,1,\n", "line 6: more cells"),
        ("0,10,,x,,,1\n", "column rate_code has 1 empty"),
        ("0,10,16777216,x,,,1\n", "rate_code 16777216"),
        ("0,10,1,x,,,1\n0,10,1,x,,,2\n", "t_ns does not increase, from 10 to 10"),
    ];
    for (rows, reason) in cases {
        fs::write(&path, format!("{header}{rows}")).unwrap();
        let error = open(&path).unwrap().find_map(Result::err).unwrap().to_string();
        assert!(error.contains(reason), "{error}");
    }
    fs::write(&path, format!("{header}0,10,8388608,x,,8,1\n0,20,8388")).unwrap();
    let (samples, warning) = read(&path);
    assert_eq!(samples.len(), 1);
    assert!(warning.unwrap().contains("last line"));
}

#[test]
fn metadata_is_checked() {
    let path = Path::new("x.arrows");
    let whole = info().to_metadata();
    let error = |metadata| CaptureInfo::from_metadata(path, &metadata).unwrap_err().to_string();
    assert_eq!(CaptureInfo::from_metadata(path, &whole).unwrap(), info());
    assert!(error(whole.clone().with("zerorate.capture_schema", "3")).contains("newer"));
    assert!(error(whole.clone().with("zerorate.width_bits", "20")).contains("expected 16 or 24"));
    assert!(error(whole.clone().with("zerorate.divided", "x")).contains("zerorate.divided = x"));
    assert!(error(whole.clone().with("zerorate.divider", "-1")).contains("zerorate.divider = -1"));
    let mut without_width = whole;
    without_width.remove("zerorate.width_bits");
    assert!(error(without_width).contains("is missing"));
}

#[test]
fn the_name_chooses_the_form() {
    let by_name = |name: &str| Format::choose(None, Path::new(name)).ok();
    let parquet = Some(Format::Parquet).filter(|_| cfg!(feature = "parquet"));
    assert_eq!(
        ["a.csv", "a.parquet", "a.ARROWS", "a"].map(by_name),
        [Some(Format::Csv), parquet, Some(Format::Arrows), Some(Format::Arrows)]
    );
    let said = Format::choose(None, Path::new("a.txt")).map_err(|error| error.to_string());
    assert_eq!(said, Err("a.txt has no ending of a capture: name it .arrows, .parquet or .csv".to_owned()));
    assert_eq!(Format::choose(Some(Format::Arrows), Path::new("a.txt")).ok(), Some(Format::Arrows));
    assert_eq!(Format::choose(Some(Format::Csv), Path::new("a.parquet")).ok(), Some(Format::Csv));
}
