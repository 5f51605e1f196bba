//! Stand-ins for formats that are not in this build. Each returns an error that tells how to include the format.

#[cfg(not(feature = "parquet"))]
pub mod parquet {
    use crate::CaptureError;
    use crate::blocks::{BlockSink, Out};
    use arrow_schema::SchemaRef;
    use std::path::Path;
    use zerorate_input::{InputError, NotBuiltIn};

    pub const BLOCK: usize = 1;

    pub fn sink(path: &Path, _: Out, _: &SchemaRef) -> Result<Box<dyn BlockSink>, CaptureError> {
        Err(InputError::not_built_in(path, NotBuiltIn::PARQUET).into())
    }
}
