//! A log of the unit to calibrate: a file, or a table in memory.

use arrow_array::RecordBatch;
use std::path::{Path, PathBuf};
use zerorate_host::files;
use zerorate_imu::{Axes, ImuOptions};
use zerorate_logs::{Column, ColumnOptions, ColumnSelection};

/// A log of the unit to calibrate.
pub enum UnitLog {
    /// A file, or the folder of a ROS bag.
    File(PathBuf),
    /// A table in memory, with the name that messages use for it.
    Table(PathBuf, RecordBatch),
}

impl UnitLog {
    /// The path, or the name of the table, for messages.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) | Self::Table(path, _) => path,
        }
    }

    /// Reads columns of the log.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read or lacks a fact.
    pub fn columns(&self, wanted: ColumnSelection<'_>, options: &ColumnOptions) -> zerorate_logs::Result<Vec<Column>> {
        match self {
            Self::File(path) => zerorate_logs::read_parts(path, files::log(path)?, wanted, options),
            Self::Table(name, table) => zerorate_logs::read_table(name, table, wanted, options),
        }
    }

    /// Reads the axes of an IMU.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read or lacks a fact.
    pub fn axes(&self, options: &ImuOptions) -> zerorate_logs::Result<Axes> {
        match self {
            Self::File(path) => Axes::read(path, files::log(path)?, options),
            Self::Table(name, _) => {
                let listed = options.listed();
                let columns = self.columns(options.selection(listed.as_deref()), &options.log)?;
                Axes::of(name, columns, options)
            }
        }
    }
}
