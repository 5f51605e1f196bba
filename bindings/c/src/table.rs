//! The look-up table of F-52, in memory of the caller.

use crate::boundary;
use crate::correction::Correction;
use crate::status::{self, Status, StatusNumber, ZERORATE_E_ARGUMENT, ZERORATE_E_NULL, ZERORATE_E_TABLE_OUTSIDE};
use zerorate::{Axis, RowIndex};

/// A table of the correction over temperature without PBC, in millionths of a deg/s: (temperature - T3) * BTC for a
/// line. The caller owns the rows, which must stay in place as long as the table is used. A look-up changes nothing,
/// so the main loop and interrupts may share a table.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Table {
    /// The rows, in millionths of a deg/s. Row 0 is for T3 + span, the last one for T3 - span.
    pub rows_udps: *const i32,
    /// Number of rows.
    pub rows: usize,
    /// The row at which `t3_code` lies, with its fraction, plus 1/2, times 2^32.
    pub middle_q32: i64,
    /// Rows per temperature code, times 2^32.
    pub rows_per_code_q32: i64,
    /// The temperature code nearest to T3.
    pub t3_code: i32,
}

/// Lays out the table of a correction in `memory`, which has space for `room` rows. The rows go from T3 + `span_c`
/// down to T3 - `span_c` in steps of `step_c`, deg C. Their number is 2 * span_c / step_c + 1.
///
/// # Safety
/// Each pointer is null or points to memory of its type, and `memory` points to `room` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_table_lay_out(
    table: *mut Table,
    correction: *const Correction,
    step_c: f64,
    span_c: f64,
    memory: *mut i32,
    room: usize,
) -> Status {
    if memory.is_null() {
        return ZERORATE_E_NULL;
    }
    // SAFETY: not null, by the contract so many, and written as integers before they are read.
    let memory = unsafe { core::slice::from_raw_parts_mut(memory, room) };
    // SAFETY: by the contract.
    let done = unsafe { boundary::input(correction) }.and_then(|correction| {
        let rows = correction.to_core().fill_table(step_c, span_c, memory).map_err(|error| error.status())?;
        let RowIndex { middle_q, rows_per_code_q, t3_code } =
            RowIndex::new(rows, step_c, correction.t3_c, &Axis::ADIS16130.temp);
        let made = Table {
            rows_udps: memory.as_ptr(),
            rows,
            middle_q32: middle_q,
            rows_per_code_q32: rows_per_code_q,
            t3_code,
        };
        // SAFETY: by the contract.
        unsafe { boundary::output(table, made) }
    });
    status::of(done)
}

/// Writes the row nearest to the temperature of a 24-bit code, in 1e-6 deg/s: corrected rate = rate + PBC + row.
///
/// Returns ZERORATE_E_TABLE_OUTSIDE more than half a step beyond the table, but writes the first or the last row. For
/// a line, that row is wrong by BTC times its distance from the temperature. Returns ZERORATE_E_ARGUMENT if there is
/// no table.
///
/// # Safety
/// Each pointer is null or points to memory of its type. The rows of `table` are still in place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_table_look_up(table: *const Table, temp_code: u32, row_udps: *mut i32) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(table).and_then(|table| look_up(table, temp_code, row_udps)) })
}

/// # Safety
/// As [`zerorate_table_look_up`].
unsafe fn look_up(table: &Table, temp_code: u32, row_udps: *mut i32) -> Result<(), Status> {
    let &Table { rows_udps, rows, middle_q32, rows_per_code_q32, t3_code } = table;
    if rows_udps.is_null() || rows == 0 {
        return Err(ZERORATE_E_ARGUMENT);
    }
    let row = RowIndex { middle_q: middle_q32, rows_per_code_q: rows_per_code_q32, t3_code }.row(temp_code);
    let last = rows - 1;
    let held = usize::try_from(row).map_or(if row < 0 { 0 } else { last }, |row| row.min(last));
    // SAFETY: not null, and below the number of rows; the place by the contract.
    unsafe { boundary::output(row_udps, *rows_udps.add(held))? };
    if i64::try_from(held) == Ok(row) { Ok(()) } else { Err(ZERORATE_E_TABLE_OUTSIDE) }
}
