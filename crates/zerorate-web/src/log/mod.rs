//! A log that is dropped on the page: what is in it, its noise, and the file for the filter that takes it.

pub mod message;
