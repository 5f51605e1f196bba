//! Separates rows of several sensors that were joined by time. In rows that lack a sensor, its cells are empty.

use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::raw_columns::{Clock, RawColumns, first_rows};
use crate::sample::{Cell, Sampled};
use crate::setting::Setting;
use std::path::Path;

/// Least number of rows of each sensor, and least share of the rows that must fit the pattern of separate sensors.
const FEWEST: usize = 8;
const ALONE: f64 = 0.9;

impl RawColumns {
    /// Drops rows of other sensors, in which the columns that were read are empty. The stamps of the kept rows still
    /// show where samples are missing.
    ///
    /// # Errors
    /// Returns [`LogError::Merged`] if the columns that were read are of several sensors.
    pub fn separate_sensors(&mut self, path: &Path, args: &ColumnOptions) -> Result<()> {
        let Clock::Column(time, _) = &self.clock else { return Ok(()) };
        let sample = first_rows(&self.sample, &self.columns);
        let is_read = |column: &&Sampled| self.columns.iter().any(|read| read.name == column.name);
        let read: Vec<Presence> = sample.iter().filter(is_read).map(Presence::of).collect();
        let mut others = sample.iter().filter(|column| !is_read(column) && column.name != *time).map(Presence::of);
        let Some(first) = read.first() else { return Ok(()) };
        let mut groups: Vec<Vec<&Presence>> = Vec::new();
        for column in &read {
            match groups.iter_mut().find(|group| !column.is_apart(group[0])) {
                Some(group) => group.push(column),
                None => groups.push(vec![column]),
            }
        }
        // a single column with a cell now and then, such as a temperature, does not count as a sensor
        groups.retain(|group| group.len() > 1);
        if groups.len() > 1 {
            let names = |group: Vec<&Presence>| group.iter().map(|one| one.name.clone()).collect::<Vec<_>>();
            let groups = groups.into_iter().map(names).collect();
            let option = args.names.of(Setting::Column);
            let question = format!(
                "{}: its rows are of several sensors, joined by time; choose one with {option}:",
                path.display()
            );
            return Err(LogError::Merged { question, groups, has_own_times: false });
        }
        if others.any(|other| other.alternates(first) || first.is_thinner(&other)) {
            self.drop_empty_rows();
        }
        Ok(())
    }

    fn drop_empty_rows(&mut self) {
        let values: Vec<Vec<f64>> = self.columns.iter().map(|column| column.values.rows_as_numbers()).collect();
        let rows = values.first().map_or(0, Vec::len);
        let kept: Vec<usize> = (0..rows).filter(|row| values.iter().any(|values| !values[*row].is_nan())).collect();
        self.columns.iter_mut().for_each(|column| column.values.reorder(&kept));
        if let Clock::Column(_, times) = &mut self.clock {
            times.select(&kept);
        }
    }
}

/// The rows in which a column has a cell.
struct Presence {
    name: String,
    rows: Vec<bool>,
}

impl Presence {
    fn of(column: &Sampled) -> Self {
        let rows = column.cells.iter().map(|cell| *cell != Cell::Missing).collect();
        Self { name: column.name.clone(), rows }
    }

    /// True if the two columns belong to different sensors.
    fn is_apart(&self, other: &Self) -> bool {
        self.alternates(other) || self.is_thinner(other) || other.is_thinner(self)
    }

    /// True if the cells of this column are evenly spaced by two rows or more, and `other` has at least 1.5 times as
    /// many cells.
    fn is_thinner(&self, other: &Self) -> bool {
        let there = |of: &Self| (0..of.rows.len()).filter(|row| of.rows[*row]).collect::<Vec<usize>>();
        let (own, others) = (there(self), there(other));
        let mut steps: Vec<usize> = own.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_unstable();
        let Some(usual) = steps.get(steps.len() / 2).copied() else { return false };
        let even = steps.iter().filter(|step| **step == usual).count();
        let is_even = usual > 1 && own.len() >= FEWEST && even as f64 >= ALONE * steps.len() as f64;
        is_even && own.len() * 3 <= others.len() * 2
    }

    /// True if nearly all cells of the two columns are in rows in which the other of the two has none.
    fn alternates(&self, other: &Self) -> bool {
        let pairs = || self.rows.iter().zip(&other.rows);
        let one_alone = pairs().filter(|(one, other)| **one && !**other).count();
        let other_alone = pairs().filter(|(one, other)| !**one && **other).count();
        let any = pairs().filter(|(one, other)| **one || **other).count();
        one_alone.min(other_alone) >= FEWEST && (one_alone + other_alone) as f64 >= ALONE * any as f64
    }
}

#[cfg(test)]
mod tests {
    use crate::choice::ColumnSelection;
    use crate::error::LogError;
    use crate::options::ColumnOptions;
    use crate::{Column, read_all};
    use std::path::Path;

    fn read(text: &str, wanted: ColumnSelection<'_>) -> Result<Vec<Column>, LogError> {
        read_all(Path::new("log.csv"), text.as_bytes().to_vec().into(), wanted, &ColumnOptions::default())
    }

    #[test]
    fn each_sensor_of_merged_rows_has_its_own_rate() {
        let alternating = |row: usize| match row % 2 {
            0 => format!("{},0.{},0.5,,\n", row * 5, row % 7),
            _ => format!("{},,,0.{},0.25\n", row * 5, row % 9),
        };
        let thinner = |row: usize| match row % 3 {
            0 => format!("{},0.{},0.5,0.{},0.25\n", row * 5, row % 7, row % 9),
            _ => format!("{},0.{},0.5,,\n", row * 5, row % 7),
        };
        type Row = fn(usize) -> String;
        let cases: [(Row, f64, f64); 2] = [(alternating, 100.0, 100.0), (thinner, 200.0, 200.0 / 3.0)];
        for (row, gyro_hz, accel_hz) in cases {
            let text = (0..120).map(row).fold("t_ms,gx,gy,ax,ay\n".to_owned(), |text, row| text + &row);
            let Err(LogError::Merged { groups, .. }) = read(&text, ColumnSelection::All) else { panic!("one sensor") };
            assert_eq!(groups, [["gx", "gy"], ["ax", "ay"]]);
            for (column, rate_hz) in [("gx", gyro_hz), ("ax", accel_hz)] {
                let columns = read(&text, ColumnSelection::One(Some(column))).unwrap();
                assert!((columns[0].rate_hz - rate_hz).abs() < 1e-9 && columns[0].missing() == 0, "{column}");
            }
        }
    }

    #[test]
    fn lost_cells_and_a_slow_temperature_are_one_sensor() {
        let row = |row: usize| {
            let [gx, ax] = [row * 7919 % 5, row * 104_729 % 3].map(|rest| if rest > 0 { "0.5" } else { "" });
            format!("{},{gx},0.{},{ax},{}\n", row * 10, row % 7, if row.is_multiple_of(20) { "25.5" } else { "" })
        };
        let text = (0..200).map(row).fold("t_ms,gx,gy,ax,temp_c\n".to_owned(), |text, row| text + &row);
        let columns = read(&text, ColumnSelection::All).unwrap();
        assert!(columns.len() == 4 && columns[0].rate_hz == 100.0 && columns[0].missing() > 20);
    }
}
