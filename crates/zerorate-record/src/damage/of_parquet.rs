//! Tests Parquet files whose row groups were removed, repeated or moved, or that other software wrote.

use super::*;
use ::parquet::arrow::ArrowWriter;
use ::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use ::parquet::file::properties::WriterProperties;
use arrow_array::RecordBatch;
use std::fs::File;

/// Writes the row groups of a Parquet file in another order or number, with the original metadata.
#[test]
fn row_groups_that_are_removed_repeated_or_moved_are_noticed() {
    let victim = Victim::new(Format::Parquet, slow(90));
    let path = victim.dir.path().join("damaged");
    let whole = File::open(victim.dir.path().join("whole")).unwrap();
    let builder = ParquetRecordBatchReaderBuilder::try_new(whole).unwrap();
    let metadata = builder.metadata().file_metadata().key_value_metadata().cloned();
    let groups: Vec<RecordBatch> = builder.with_batch_size(20).build().unwrap().map(Result::unwrap).collect();
    for order in rearranged(groups.len()).into_iter().chain([vec![0, 1, 2, 3, 4]]) {
        let properties = WriterProperties::builder().set_key_value_metadata(metadata.clone()).build();
        let schema = groups[0].schema();
        let bare = std::sync::Arc::new(schema.as_ref().clone().with_metadata(arrow_schema::Metadata::default()));
        let mut writer = ArrowWriter::try_new(File::create(&path).unwrap(), bare.clone(), Some(properties)).unwrap();
        for group in &order {
            let group = RecordBatch::try_new(bare.clone(), groups[*group].columns().to_vec()).unwrap();
            writer.write(&group).unwrap();
            writer.flush().unwrap();
        }
        writer.close().unwrap();
        let expected = if order == [0, 1, 2, 3, 4] { Outcome::Same } else { Outcome::Refused };
        assert_eq!(outcome(&path, &victim.truth), expected, "{order:?}");
    }
}

/// Other software, such as PyArrow, keeps the description and the columns, and drops the checks of the rows.
#[test]
fn a_file_that_other_software_wrote_again_is_unchecked() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("whole.arrows");
    write(&path, Format::Arrows, &info(), &slow(50));
    let stream = arrow_ipc::reader::StreamReader::try_new(File::open(&path).unwrap(), None).unwrap();
    let schema = stream.schema();
    let batches: Vec<RecordBatch> = stream.map(Result::unwrap).collect();
    let again = dir.path().join("again.parquet");
    let mut writer = ArrowWriter::try_new(File::create(&again).unwrap(), schema.clone(), None).unwrap();
    batches.iter().for_each(|batch| writer.write(batch).unwrap());
    writer.close().unwrap();
    let (found, said) = read(&again);
    assert!(found == slow(50) && said.unwrap().contains("rewritten by other software"));
}
