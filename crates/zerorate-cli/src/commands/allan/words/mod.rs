//! Records in words: the parts that the table, the pictures, the page and the JSON object share.

pub mod advice;
pub mod names;
pub mod units;
pub mod warnings;
