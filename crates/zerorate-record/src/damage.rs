//! Tests with damaged files. A reader must refuse the file, return all rows, or warn and return only the first rows.

#[cfg(feature = "parquet")]
mod of_parquet;

use super::tests::{FORMATS, batch_ends, info, read, write};
use super::*;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::fs;
use tempfile::TempDir;

/// Makes `n` rows, 50 ms apart, so that a block of a stream or of a CSV file holds 20.
fn slow(n: u32) -> Vec<Row> {
    let row = |i: u32| {
        Row::new(1_000 + u64::from(i) * 50_000_000, i, &[(8_388_608 + i.wrapping_mul(2_654_435_761) % 9_999).into()])
            .unwrap()
            .with_status((!i.is_multiple_of(5)).then_some(8))
            .with_temp_code(i.is_multiple_of(3).then(|| (8_400_000 + i).into()))
    };
    (0..n).map(row).collect()
}

#[derive(Debug, PartialEq)]
enum Outcome {
    Refused,
    Same,
    /// The reader warned and returned only this many rows, from the start.
    Prefix(usize),
    Wrong(String),
}

fn outcome(path: &Path, truth: &[Row]) -> Outcome {
    let Ok(mut reader) = super::tests::open(path) else { return Outcome::Refused };
    if reader.info() != &info() {
        return Outcome::Wrong(format!("{:?}", reader.info()));
    }
    match reader.by_ref().take(truth.len() + 1).collect::<Result<Vec<_>, _>>() {
        Err(_) => Outcome::Refused,
        Ok(found) if found == truth => Outcome::Same,
        Ok(found) if truth.starts_with(&found) && !reader.warnings().is_empty() => Outcome::Prefix(found.len()),
        Ok(found) => Outcome::Wrong(format!("{} rows, warnings {:?}", found.len(), reader.warnings())),
    }
}

/// A valid capture of which a test writes damaged copies.
struct Victim {
    dir: TempDir,
    format: Format,
    truth: Vec<Row>,
    bytes: Vec<u8>,
}

impl Victim {
    fn new(format: Format, truth: Vec<Row>) -> Self {
        let dir = TempDir::new().unwrap();
        let path = dir.path().join("whole");
        write(&path, format, &info(), &truth);
        let bytes = fs::read(path).unwrap();
        Self { dir, format, truth, bytes }
    }

    fn with(&self, bytes: &[u8]) -> Outcome {
        let path = self.dir.path().join("damaged");
        fs::write(&path, bytes).unwrap();
        outcome(&path, &self.truth)
    }

    /// Checks that the file is refused or that all its rows are read. The first rows alone are not accepted here.
    #[track_caller]
    fn stays_true(&self, bytes: &[u8], what: &str) {
        let outcome = self.with(bytes);
        assert!(matches!(outcome, Outcome::Refused | Outcome::Same), "{:?}, {what}: {outcome:?}", self.format);
    }
}

#[test]
fn no_flipped_bit_is_believed() {
    for &format in FORMATS {
        let victim = Victim::new(format, slow(50));
        let mut random = SplitMix64::seed_from_u64(9);
        for at in 0..victim.bytes.len() {
            let bit = random.next_u64() % 8;
            let mut bytes = victim.bytes.clone();
            bytes[at] ^= 1 << bit;
            victim.stays_true(&bytes, &format!("bit {bit} of byte {at}"));
        }
    }
}

/// Each round overwrites, removes or inserts bytes at one to three places.
#[test]
fn no_other_mutation_is_believed() {
    for &format in FORMATS {
        let victim = Victim::new(format, slow(50));
        let mut random = SplitMix64::seed_from_u64(11);
        let mut below = |bound: usize| random.next_u64() as usize % bound;
        for round in 0..400 {
            let mut bytes = victim.bytes.clone();
            for _ in 0..=below(3) {
                let at = below(bytes.len());
                let end = (at + 1 + below(16)).min(bytes.len());
                match below(4) {
                    0 => bytes[at] = below(256) as u8,
                    1 => bytes[at..end].fill(0),
                    2 => drop(bytes.drain(at..end)),
                    _ => bytes.insert(at, below(256) as u8),
                }
            }
            let outcome = victim.with(&bytes);
            assert!(!matches!(outcome, Outcome::Wrong(_)), "{format:?}, round {round}: {outcome:?}");
        }
    }
}

#[test]
fn a_cut_at_any_byte_leaves_a_prefix() {
    for &format in FORMATS {
        let victim = Victim::new(format, slow(50));
        let mut seen = Vec::new();
        for cut in 0..victim.bytes.len() {
            match victim.with(&victim.bytes[..cut]) {
                Outcome::Prefix(rows) => seen.push(rows),
                Outcome::Wrong(what) => panic!("{format:?}, cut at {cut}: {what}"),
                Outcome::Refused | Outcome::Same => {}
            }
        }
        seen.dedup();
        let blocks: &[usize] = match format {
            Format::Parquet => &[],
            Format::Arrows | Format::Csv => &[0, 20, 40],
        };
        assert_eq!(seen, blocks, "{format:?}");
    }
}

/// Splits a stream into its head, its blocks and its end.
fn pieces_of_stream(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut from = 0;
    let mut pieces: Vec<Vec<u8>> =
        batch_ends(bytes).into_iter().map(|end| bytes[std::mem::replace(&mut from, end)..end].to_vec()).collect();
    pieces.push(bytes[from..].to_vec());
    pieces
}

fn pieces_of_csv(bytes: &[u8]) -> Vec<Vec<u8>> {
    let text = std::str::from_utf8(bytes).unwrap();
    let rows = text.find("\n1000,").unwrap() + 1;
    let mut pieces = vec![text.as_bytes()[..rows].to_vec(), Vec::new()];
    for line in text[rows..].split_inclusive('\n') {
        pieces.last_mut().unwrap().extend(line.as_bytes());
        if line.contains("zerorate.check") {
            pieces.push(Vec::new());
        }
    }
    pieces
}

/// Orders in which blocks are missing, swapped or repeated. Each order lists the numbers of the blocks to write.
fn rearranged(blocks: usize) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..blocks).collect();
    let without = |left_out: usize| all.iter().copied().filter(|block| *block != left_out).collect();
    let mut orders: Vec<Vec<usize>> = all.iter().map(|block| without(*block)).collect();
    for block in 1..blocks {
        let mut swapped = all.clone();
        swapped.swap(block - 1, block);
        let mut repeated = all.clone();
        repeated.insert(block, block - 1);
        orders.extend([swapped, repeated]);
    }
    orders.push(Vec::new());
    orders
}

#[test]
fn blocks_that_are_removed_repeated_or_moved_are_noticed() {
    for (format, pieces) in
        [(Format::Arrows, pieces_of_stream as fn(&[u8]) -> Vec<Vec<u8>>), (Format::Csv, pieces_of_csv)]
    {
        let victim = Victim::new(format, slow(90));
        let pieces = pieces(&victim.bytes);
        let blocks =
            pieces[1..].iter().take_while(|piece| !String::from_utf8_lossy(piece).contains("check.end")).count();
        assert_eq!(blocks, 5, "{format:?}");
        for order in rearranged(blocks) {
            let middle = order.iter().map(|block| &pieces[1 + block]);
            let bytes: Vec<u8> =
                [&pieces[0]].into_iter().chain(middle).chain(&pieces[1 + blocks..]).flatten().copied().collect();
            assert_eq!(victim.with(&bytes), Outcome::Refused, "{format:?}, blocks {order:?}");
        }
        let without_end = pieces[..1 + blocks].concat();
        assert_eq!(victim.with(&without_end), Outcome::Same, "{format:?}");
        assert!(read(&victim.dir.path().join("damaged")).1.is_some(), "{format:?}: torn, and said");
    }
}

/// A CSV capture in version 1 of the format, which has no checks.
fn version_1(rows: &[Row]) -> CaptureReader {
    let mut text = "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n\
        # zerorate.temp_conversion = 5\nt_ns,edge_seq,rate_code,status,temp_code,lost\n"
        .to_owned();
    for row in rows {
        text += &format!("{},{},{},,,{}\n", row.t_ns, row.edge_seq, row.codes()[0], row.lost);
    }
    CaptureReader::open(Path::new("old.csv"), text.into_bytes().into()).unwrap()
}

fn version_1_error(rows: &[Row]) -> Option<String> {
    version_1(rows).find_map(Result::err).map(|error| error.to_string())
}

#[test]
fn version_1_is_read_with_a_note() {
    let mut reader = version_1(&slow(100));
    assert_eq!(reader.by_ref().map(Result::unwrap).count(), 100);
    assert!(reader.warnings()[0].to_string().contains("version 1 without checks"));
}

#[test]
fn rows_of_version_1_must_agree_with_each_other() {
    let rows = slow(1_000);
    assert_eq!(version_1_error(&rows), None);
    let removed: Vec<Row> = rows.iter().copied().filter(|row| !(200..480).contains(&row.edge_seq)).collect();
    assert!(version_1_error(&removed).unwrap().contains("about 280 rows are missing"));
    let mut jumped = rows.clone();
    jumped[3..].iter_mut().for_each(|row| row.t_ns += 3_600_000_000_000);
    assert!(version_1_error(&jumped).unwrap().contains("t_ns jumps by 36000"));
    let mut invented = rows;
    invented[500].lost = 1_000_000;
    assert!(version_1_error(&invented).unwrap().contains("more than there can be"));
}

#[test]
fn version_2_is_not_taken_for_version_1() {
    let victim = Victim::new(Format::Csv, slow(50));
    let old = String::from_utf8(victim.bytes.clone()).unwrap().replace("capture_schema = 2", "capture_schema = 1");
    assert_eq!(victim.with(old.as_bytes()), Outcome::Refused);
}

/// Computes the checks by the rules of docs/formats/capture.md, without the code that writes them.
#[test]
fn the_checks_are_those_of_the_document() {
    use sha2::{Digest, Sha256};
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("two.csv");
    write(&path, Format::Csv, &info(), &slow(2));
    let text = fs::read_to_string(&path).unwrap();
    let stated =
        |key: &str| text.lines().find_map(|line| line.strip_prefix(&format!("# {key} = "))).unwrap().to_owned();
    let digits = |digest: &[u8]| digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let described: String = text
        .lines()
        .filter_map(|line| line.strip_prefix("# "))
        .filter(|entry| !entry.starts_with("zerorate.check."))
        .map(|entry| format!("{entry}\n"))
        .collect();
    let columns = "t_ns: u64\nedge_seq: u32\nrate_code: u32\nstatus: u8\ntemp_code: u32\nlost: u32\n";
    let head = Sha256::digest(format!("zerorate.capture.v2\n{described}{columns}"));
    assert_eq!(stated("zerorate.check.head"), digits(&head)[..16]);
    let mut hash = SampleHash::new(&info().layout);
    slow(2).iter().for_each(|sample| hash.update(sample));
    let link =
        Sha256::new().chain_update(head).chain_update(hash.digest()).chain_update(Sha256::digest("")).finalize();
    assert_eq!(stated("zerorate.check.batch"), digits(&link)[..16]);
    let end = Sha256::new().chain_update(link).chain_update("end\n").chain_update(2u64.to_le_bytes());
    let end = digits(&end.chain_update(hash.digest()).finalize());
    assert_eq!(stated("zerorate.check.end"), format!("00000000000000000002 {} {}", hash.hex(), &end[..16]));
}
