//! Captures are read by pyarrow, which shares no code with this project.

use super::{Bench, capture, run, skip};
use std::process::Command;

/// Prints the rows, columns and some metadata of an Arrow stream and of a Parquet file with the same content, and the
/// number of rows that can be read of another stream that is cut short.
const READER: &str = r#"
import pyarrow as pa, pyarrow.parquet as pq
whole = pa.ipc.open_stream("rest.arrows").read_all()
parquet = pq.read_table("rest.parquet")
assert whole.equals(parquet), "the forms differ"
for row in whole.to_pylist():
    print(",".join("" if value is None else str(value) for value in row.values()))
print(whole.schema.names, [str(field.type) for field in whole.schema])
of_parquet = pq.read_metadata("rest.parquet").metadata
print(whole.schema.metadata[b"zerorate.serial"].decode(), of_parquet[b"zerorate.width_bits"].decode())
open("torn.arrows", "wb").write(open("long.arrows", "rb").read()[:-1000])
rows = 0
try:
    for batch in pa.ipc.open_stream("torn.arrows"):
        rows += batch.num_rows
except Exception:
    pass
print(rows)
"#;

#[test]
fn pyarrow_reads_what_we_write() {
    let importable =
        Command::new("python3").args(["-c", "import pyarrow"]).output().is_ok_and(|output| output.status.success());
    if !importable {
        skip("it needs python3 with pyarrow");
        return;
    }
    let bench = Bench::new();
    let rows =
        "1000,4294967295,0,255,16777215,0\n2000,0,16777215,,,4294967295\n18446744073709551615,1,8388608,8,8400000,7\n";
    bench.write("rest.csv", capture("A1", rows));
    let long: String = (0..250u64).map(|i| format!("{},{i},8388608,8,8388608,0\n", i * 10_000_000)).collect();
    bench.write("long.csv", capture("A1", &long));
    bench.zerorate("capture --device replay:rest.csv -o rest.arrows").ok();
    bench.zerorate("capture --device replay:rest.csv -o rest.parquet").ok();
    bench.zerorate("capture --device replay:long.csv -o long.arrows").ok();
    let columns = "['t_ns', 'edge_seq', 'rate_code', 'status', 'temp_code', 'lost'] ['uint64', 'uint32', 'uint32', \
        'uint8', 'uint32', 'uint32']";
    let expected = format!("{rows}{columns}\nA1 24\n200\n");
    assert_eq!(run("python3", &["-c", READER], bench.dir.path()), expected);
}
