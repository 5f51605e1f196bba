//! An ADIS16130 read through the Linux kernel's own driver for it, by polling sysfs.
//!
//! The kernel's driver occupies the bus and gives single readings without data-ready signal, status or timestamp. So
//! it is unknown whether a reading is new, and how many conversions were never read. `lost` counts skipped polls.

use super::sysfs::read;
use super::{DEFAULT_POLL_HZ, IioAddress, Poll, Polls};
use crate::options::PartOptions;
use crate::source::{DeviceInfo, Setup, Source};
use adis16130::{MCLK_HZ, RATE_LSB_PER_DPS, RateCode, Sample, TEMP_LSB_PER_C, TempCode, Width, ZERO_CODE};
use anyhow::{Result, bail, ensure};
use std::path::Path;
use zerorate_record::Row;

const RATE: &str = "in_anglvel_z";
const TEMP: &str = "in_temp0";
/// Relative tolerance of a scale. The kernel prints nine decimals, so the rate's scale has only three digits.
const SCALE_TOLERANCE: f64 = 0.005;

pub struct Adis16130 {
    address: IioAddress,
    facts: DeviceInfo,
    /// Number to add to a raw rate to get a 24-bit code.
    rate_shift: i64,
    temp_shift: i64,
    polls: Polls,
}

impl Adis16130 {
    /// Reads the driver's scales and offsets, and checks that the scales are those of F-40 and F-41, within 0.5 %.
    pub fn open(address: &IioAddress, device: &str, setup: &Setup) -> crate::Result<Self> {
        let (folder, hz) = (&address.folder, address.hz.unwrap_or(DEFAULT_POLL_HZ));
        let options = PartOptions { bandwidth_hz: address.bandwidth_hz, ..PartOptions::new() };
        let sampling = setup.sampling.config(options.divided);
        let facts = DeviceInfo::of_part(device, &options, sampling, MCLK_HZ, setup.part.as_ref())?;
        let facts = DeviceInfo { framing: None, rate_hz: Some(hz.into()), ..facts };
        let dps = std::f64::consts::PI / 180.0; // the kernel's unit is rad/s
        let rate_shift = shift(folder, RATE, dps / f64::from(RATE_LSB_PER_DPS), i64::from(ZERO_CODE))?;
        // the kernel's unit is 0.001 °C, and its offset counts from 0 °C: 25 · 14093 codes below the zero code (F-41)
        let temp_zero = i64::from(ZERO_CODE) - 25 * i64::from(TEMP_LSB_PER_C);
        let temp_shift = shift(folder, TEMP, 1000.0 / f64::from(TEMP_LSB_PER_C), temp_zero)?;
        let (address, polls) = (address.clone(), Polls::new(hz, setup.sampling));
        Ok(Self { address, facts, rate_shift, temp_shift, polls })
    }

    fn poll(&mut self) -> Result<Sample> {
        let Poll { slot, lost, t_ns, with_temp } = self.polls.wait();
        let rate = RateCode::new(self.code(RATE, self.rate_shift)?, Width::Bits24);
        let temp = with_temp.then(|| self.code(TEMP, self.temp_shift)).transpose()?;
        let temp = temp.map(|code| TempCode::new(code, Width::Bits24));
        Ok(Sample { t_ns, seq: slot, rate, status: None, temp, lost })
    }

    fn code(&self, channel: &str, shift: i64) -> Result<u32> {
        let raw: i64 = read(&self.address.folder, &format!("{channel}_raw"))?;
        let code = raw + shift;
        ensure!((0..1 << 24).contains(&code), "{channel}_raw is {raw}, which is not a reading of 24 bits");
        Ok(code as u32)
    }
}

impl Source for Adis16130 {
    fn facts(&self) -> DeviceInfo {
        self.facts.clone()
    }

    fn next(&mut self) -> crate::Result<Option<Row>> {
        Ok(self.poll().map(|sample| Some(Row::from(&sample)))?)
    }
}

/// Checks the scale. Returns the number to add to raw readings, so that they become codes with the zero code `zero`.
fn shift(folder: &Path, channel: &str, expected_scale: f64, zero: i64) -> Result<i64> {
    let scale: f64 = read(folder, &format!("{channel}_scale"))?;
    let offset: i64 = read(folder, &format!("{channel}_offset"))?;
    if (scale / expected_scale - 1.0).abs() > SCALE_TOLERANCE {
        bail!(
            "{channel}_scale is {scale}, but codes of an ADIS16130 have {expected_scale:.6e}: is that another part?"
        );
    }
    Ok(zero + offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Sampling;
    use std::fs;

    /// A folder with the attributes that the driver of Linux 6.12 provides.
    fn folder(rate_scale: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in [
            ("name", "adis16130"),
            ("in_anglvel_z_raw", "8388622"),
            ("in_anglvel_z_offset", "-8388608"),
            ("in_anglvel_z_scale", rate_scale),
            ("in_temp0_raw", "8388609"),
            ("in_temp0_offset", "-8036283"),
            ("in_temp0_scale", "0.070957212"),
        ] {
            fs::write(folder.path().join(name), format!("{text}\n")).expect("written");
        }
        folder
    }

    fn address(folder: &Path) -> IioAddress {
        IioAddress { folder: folder.to_owned(), hz: Some(1000), bandwidth_hz: None }
    }

    #[test]
    fn raw_readings_are_the_codes_of_the_part() {
        let folder = folder("0.000000743");
        let address = address(folder.path());
        let sampling = Sampling { every_temp: Some(2), divider: None };
        let every_other = Setup { sampling, ..Setup::default() };
        let mut device = Adis16130::open(&address, "iio:x", &every_other).expect("a device");
        let samples: Vec<_> = (0..3).map(|_| device.poll().expect("a sample")).collect();
        assert!(samples.iter().all(|sample| sample.rate.code24() == 8_388_622 && sample.status.is_none()));
        let temps: Vec<_> = samples.iter().map(|sample| sample.temp.map(TempCode::code24)).collect();
        assert_eq!(temps, [Some(8_388_609), None, Some(8_388_609)]);
        fs::remove_file(folder.path().join("in_anglvel_z_raw")).expect("removed");
        assert!(format!("{:#}", device.poll().unwrap_err()).contains("unplugged"));
    }

    #[test]
    fn another_part_is_refused() {
        let folder = folder("0.000000500");
        let address = address(folder.path());
        let error = Adis16130::open(&address, "iio:x", &Setup::default()).err().expect("no device").to_string();
        assert!(error.contains("another part"), "{error}");
    }
}
