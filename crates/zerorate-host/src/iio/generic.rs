//! Any gyroscope that has a Linux kernel driver, read with the scales that the driver states.

use super::channel::{Channel, Element};
use super::sysfs::{first, read_text, write};
use super::{DEFAULT_POLL_HZ, IioAddress, Poll, Polls};
use crate::Stop;
use crate::clock;
use crate::error::{Cause, UserError};
use crate::source::{DeviceInfo, Sampling, Setup, Source, part_of};
use adis16130::MCLK_HZ;
use anyhow::{Context, Result, bail, ensure};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use zerorate::calibration::Notes;
use zerorate::{Axis, NamedAxis, NoiseSources, Part, Scale};
use zerorate_record::{CaptureInfo, Layout, Row};

/// Number of scans that the kernel queues.
const BUFFERED: u32 = 4096;
/// Time without a scan that is an error, if it is also longer than [`SILENT_PERIODS`] sample periods.
const SILENCE: Duration = Duration::from_secs(1);
const SILENT_PERIODS: f64 = 20.0;
/// Time without a scan that is an error if the driver does not state its sample rate.
const UNKNOWN_SILENCE: Duration = Duration::from_secs(10);
/// Longest delay until a stop is noticed.
const STOP_POLL: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };
/// The kernel clock of the timestamps. It is monotonic, as `t_ns` of a capture must be; other clocks may step.
const CLOCK: &str = "monotonic";

pub fn open(
    address: &IioAddress,
    name: &str,
    driver: &str,
    setup: &Setup,
    stop: &Stop,
) -> crate::Result<Box<dyn Source>> {
    let device = Device::find(address, name, driver, setup)?;
    // the device file has the same name as the sysfs folder
    let file = Path::new("/dev").join(address.folder.file_name().unwrap_or_default());
    match address.hz {
        None if device.has_buffer() => Ok(Box::new(BufferedScans::open(device, &file, stop)?)),
        hz => Ok(Box::new(PolledChannels::new(device, hz.unwrap_or(DEFAULT_POLL_HZ), setup.sampling))),
    }
}

struct Device {
    folder: PathBuf,
    rates: Vec<Channel>,
    temp: Option<Channel>,
    facts: DeviceInfo,
}

impl Device {
    fn find(address: &IioAddress, name: &str, driver: &str, setup: &Setup) -> crate::Result<Self> {
        let folder = &address.folder;
        // the kernel's unit is rad/s
        let rate = |axis: &str| Channel::read(folder, &format!("in_anglvel_{axis}"), "in_anglvel", 1f64.to_radians());
        let there = |axis: &&str| folder.join(format!("in_anglvel_{axis}_raw")).exists();
        let axes: Vec<&str> = ["x", "y", "z"].into_iter().filter(there).collect();
        if axes.is_empty() {
            let why = format!("{driver} in {} is not a gyroscope: it lacks in_anglvel_x, _y and _z", folder.display());
            return Err(UserError::request(why).into());
        }
        let rates = axes.iter().map(|axis| rate(axis)).collect::<Result<Vec<_>>>()?;
        let named = ["in_temp", "in_temp0"].into_iter().find(|name| folder.join(format!("{name}_raw")).exists());
        // the kernel's unit is 0.001 °C
        let temp = named.map(|name| Channel::read(folder, name, "in_temp", 1000.0)).transpose()?;
        let part = part(driver, &axes, &rates, temp.as_ref(), setup.part.as_ref());
        let layout = Layout::of_part(&part).map_err(anyhow::Error::new)?;
        let info = CaptureInfo {
            device: name.to_owned(),
            every_temp: setup.sampling.every_temp.unwrap_or(1),
            bandwidth_hz: address.bandwidth_hz,
            software: zerorate::SOFTWARE.to_owned(),
            created: clock::text(),
            notes: Notes { host: clock::host(), ..Notes::default() },
            ..CaptureInfo::new(layout)
        };
        let part =
            part_of(&info, setup.part.as_ref().map(|known| Part { name: part.name, ..known.clone() }).as_ref())?;
        let rate_hz = address.hz.map(f64::from);
        let facts =
            DeviceInfo { name: name.to_owned(), info, part, framing: None, is_real: true, rate_hz, mclk_hz: MCLK_HZ };
        Ok(Self { folder: folder.clone(), rates, temp, facts })
    }

    fn has_buffer(&self) -> bool {
        self.folder.join("buffer/enable").exists() && self.rates.iter().all(|channel| channel.element.is_some())
    }
}

/// The part as the driver describes it. If `known` has the driver's name, in any case of letters, the name and the
/// operating temperatures are those of `known`.
fn part(driver: &str, axes: &[&str], rates: &[Channel], temp: Option<&Channel>, known: Option<&Part>) -> Part {
    const NO_TEMP: Scale = Scale { lsb_per_unit: 1.0, zero_code: 0, zero_value: 0.0, width_bits: 16, signed: true };
    let known = known.filter(|known| known.name.eq_ignore_ascii_case(driver));
    let axis = |(name, channel): (&&str, &Channel)| NamedAxis {
        name: (*name).to_owned().into(),
        axis: Axis::unknown(channel.scale, temp.map_or(NO_TEMP, |temp| temp.scale)),
        sources: NoiseSources::default(),
        column: None,
    };
    Part {
        name: known.map_or_else(|| driver.to_owned().into(), |known| known.name.clone()),
        axes: axes.iter().zip(rates).map(axis).collect(),
        temp_column: None,
        operating_c: known.and_then(|known| known.operating_c),
    }
}

/// A device whose channels are polled at regular times. Whether a reading is new is unknown.
struct PolledChannels {
    device: Device,
    polls: Polls,
}

impl PolledChannels {
    fn new(mut device: Device, hz: u32, sampling: Sampling) -> Self {
        device.facts.rate_hz = Some(hz.into());
        Self { device, polls: Polls::new(hz, sampling) }
    }

    fn poll(&mut self) -> Result<Row> {
        let Poll { slot, lost, t_ns, with_temp } = self.polls.wait();
        let Device { folder, rates, temp, .. } = &self.device;
        let codes = rates.iter().map(|channel| channel.poll(folder)).collect::<Result<Vec<_>>>()?;
        let temp = temp.as_ref().filter(|_| with_temp).map(|temp| temp.poll(folder)).transpose()?;
        let row = Row::new(t_ns, slot, &codes).context("more axes than a row has room for")?;
        Ok(row.with_temp_code(temp).with_lost(lost))
    }
}

impl Source for PolledChannels {
    fn facts(&self) -> DeviceInfo {
        self.device.facts.clone()
    }

    fn next(&mut self) -> crate::Result<Option<Row>> {
        Ok(self.poll().map(Some)?)
    }
}

struct BufferedScans {
    device: Device,
    scans: File,
    /// The byte offset and layout of each rate in a scan; `temp` and `time` are those of temperature and timestamp.
    rates: Vec<(usize, Element)>,
    temp: Option<(usize, Element)>,
    time: (usize, Element),
    scan: Vec<u8>,
    period_ns: Option<f64>,
    silence: Duration,
    last_ns: Option<u64>,
    taken: u32,
    stop: Stop,
}

impl BufferedScans {
    fn open(device: Device, file: &Path, stop: &Stop) -> Result<Self> {
        let folder = device.folder.clone();
        // open the device before setting its attributes, because the kernel then refuses other programs that open it
        let scans = File::open(file).map_err(|error| why_not_open(file, error))?;
        let time = Element::read(&folder, "in_timestamp")?;
        let time = time.context("its driver stamps no scan with its time; poll it with ?hz=N")?;
        let mut enabled: Vec<(&str, Element)> = device
            .rates
            .iter()
            .chain(&device.temp)
            .filter_map(|one| Some((one.name.as_str(), one.element?)))
            .collect();
        enabled.push(("in_timestamp", time));
        set_up(&folder, &enabled)?;
        let (places, bytes) = places(&enabled);
        let place =
            |name: &str| enabled.iter().position(|(one, _)| *one == name).map(|at| (places[at], enabled[at].1));
        let rates = device.rates.iter().filter_map(|channel| place(&channel.name)).collect();
        let temp = device.temp.as_ref().and_then(|channel| place(&channel.name));
        let time = place("in_timestamp").context("no time stamp")?;
        write(&folder, "buffer/enable", "1")?;
        let rate_hz: Option<f64> = first(&folder, &["in_anglvel_sampling_frequency", "sampling_frequency"])?;
        let rate_hz = rate_hz.filter(|hz| *hz > 0.0);
        let facts = DeviceInfo { rate_hz, ..device.facts };
        let device = Device { facts, ..device };
        let period_ns = rate_hz.map(|hz| 1e9 / hz);
        let periods = rate_hz.and_then(|hz| Duration::try_from_secs_f64(SILENT_PERIODS / hz).ok());
        let silence = periods.map_or(UNKNOWN_SILENCE, |periods| periods.max(SILENCE));
        let (scan, stop) = (vec![0; bytes], stop.clone());
        Ok(Self { device, scans, rates, temp, time, scan, period_ns, silence, last_ns: None, taken: 0, stop })
    }

    /// Reads the next scan; `None` if a stop was requested.
    fn read(&mut self) -> Result<Option<Row>> {
        if !self.wait()? {
            return Ok(None);
        }
        self.scans.read_exact(&mut self.scan).with_context(gone)?;
        let value = |(at, element): &(usize, Element)| element.value(&self.scan[*at..at + element.bytes]);
        let t_ns = u64::try_from(value(&self.time)).context("a time stamp before the beginning of time")?;
        let codes: Vec<i64> = self.rates.iter().map(value).collect();
        let passed_ns = self.last_ns.map_or(0, |last_ns| t_ns.saturating_sub(last_ns));
        // the kernel does not count scans that its queue dropped, so the losses are computed from the time
        let periods = self.period_ns.map_or(1.0, |period_ns| (passed_ns as f64 / period_ns).round());
        let lost = (periods - 1.0).max(0.0) as u32;
        self.last_ns = Some(t_ns);
        self.taken = self.taken.wrapping_add(1).wrapping_add(lost);
        let row = Row::new(t_ns, self.taken, &codes).context("more axes than a row has room for")?;
        Ok(Some(row.with_temp_code(self.temp.as_ref().map(value)).with_lost(lost)))
    }

    /// Waits for a scan, with a time limit. Returns false if a stop was requested.
    fn wait(&self) -> Result<bool> {
        let since = Instant::now();
        while !self.stop.asked() {
            match poll(&mut [PollFd::new(&self.scans, PollFlags::IN)], Some(&STOP_POLL)) {
                Ok(0) => self.require_alive(since.elapsed())?,
                Err(Errno::INTR) => {}
                Err(error) => return Err(error).context("waiting for the buffer"),
                Ok(_) => return Ok(true),
            }
        }
        Ok(false)
    }

    /// Checks that the device still exists, and that it is not silent for too long. The kernel does not wake a
    /// program that waits for a removed device.
    fn require_alive(&self, silent: Duration) -> Result<()> {
        ensure!(self.device.folder.exists(), gone());
        if silent < self.silence {
            return Ok(());
        }
        let (folder, s) = (self.device.folder.display(), self.silence.as_secs_f64());
        let words = format!(
            "no scan came for {s} s: what triggers them has stopped (cat {folder}/trigger/current_trigger), the part \
             sleeps, or it reports changes only (echo 0 > {folder}/in_anglvel_hysteresis); ?hz=N polls it instead"
        );
        bail!(UserError::new(Cause::Silent, words))
    }
}

/// Configures the buffer for scans of exactly these channels.
fn set_up(folder: &Path, enabled: &[(&str, Element)]) -> Result<()> {
    write(folder, "buffer/enable", "0")?;
    if folder.join("current_timestamp_clock").exists() {
        write(folder, "current_timestamp_clock", CLOCK)?;
    }
    for entry in folder.join("scan_elements").read_dir().context("looking for scan_elements")? {
        let name = entry?.file_name();
        let Some(channel) = name.to_str().and_then(|name| name.strip_suffix("_en")) else { continue };
        let wanted = enabled.iter().any(|(one, _)| *one == channel);
        write(folder, &format!("scan_elements/{channel}_en"), if wanted { "1" } else { "0" })?;
    }
    write(folder, "buffer/length", &BUFFERED.to_string())?;
    require_trigger(folder)
}

fn why_not_open(file: &Path, error: io::Error) -> anyhow::Error {
    let file = file.display();
    let words = match error.kind() {
        io::ErrorKind::ResourceBusy => format!("{file} is busy: another program reads it (fuser {file})"),
        io::ErrorKind::PermissionDenied => {
            format!("no permission to open {file}: run it as root, or poll with ?hz=N, which needs no buffer")
        }
        _ => format!("cannot open {file}; ?hz=N polls it instead"),
    };
    UserError::of_system(error, words)
}

fn gone() -> UserError {
    UserError::new(
        Cause::Gone,
        "reading the buffer: the device is gone; was the part unplugged, or its driver unbound?",
    )
}

/// Checks that a trigger is set if the device has triggers, because then only a trigger fills the buffer. Some
/// drivers set one themselves.
fn require_trigger(folder: &Path) -> Result<()> {
    if !folder.join("trigger/current_trigger").exists() {
        return Ok(());
    }
    let trigger = read_text(folder, "trigger/current_trigger")?;
    ensure!(
        !trigger.is_empty(),
        "nothing triggers its scans: write the name of a trigger (cat /sys/bus/iio/devices/trigger*/name) into \
         {}/trigger/current_trigger, or poll with ?hz=N",
        folder.display()
    );
    Ok(())
}

/// The offset of each channel in a scan, and the length of a scan. Channels are in the order of their indices, each
/// at a multiple of its size.
fn places(enabled: &[(&str, Element)]) -> (Vec<usize>, usize) {
    let mut order: Vec<usize> = (0..enabled.len()).collect();
    order.sort_by_key(|at| enabled[*at].1.index);
    let mut places = vec![0; enabled.len()];
    let (mut end, mut widest) = (0usize, 1);
    for at in order {
        let bytes = enabled[at].1.bytes;
        places[at] = end.next_multiple_of(bytes);
        end = places[at] + bytes;
        widest = widest.max(bytes);
    }
    (places, end.next_multiple_of(widest))
}

impl Source for BufferedScans {
    fn facts(&self) -> DeviceInfo {
        self.device.facts.clone()
    }

    fn next(&mut self) -> crate::Result<Option<Row>> {
        Ok(self.read()?)
    }
}

impl Drop for BufferedScans {
    fn drop(&mut self) {
        // nothing can be done about an error here
        let _ = write(&self.device.folder, "buffer/enable", "0");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    use std::fs;

    /// A sysfs folder of a HID gyroscope (`hid-sensor-gyro-3d`) that also has a temperature channel.
    fn folder(more: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in [
            ("name", "gyro_3d"),
            ("in_anglvel_x_raw", "100"),
            ("in_anglvel_y_raw", "-200"),
            ("in_anglvel_z_raw", "5"),
            ("in_anglvel_scale", "0.001"),
            ("in_temp_raw", "2500"),
            ("in_temp_scale", "10"),
            ("in_temp_offset", "-100"),
        ]
        .iter()
        .chain(more)
        {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            fs::write(path, format!("{text}\n")).expect("written");
        }
        folder
    }

    const BUFFER: &[(&str, &str)] = &[
        ("buffer/enable", "0"),
        ("buffer/length", "2"),
        ("current_timestamp_clock", "realtime"),
        ("trigger/current_trigger", "gyro_3d-dev0"),
        ("in_anglvel_sampling_frequency", "100.0"),
        ("scan_elements/in_accel_x_en", "1"),
        ("scan_elements/in_anglvel_x_en", "0"),
        ("scan_elements/in_anglvel_y_en", "0"),
        ("scan_elements/in_anglvel_z_en", "0"),
        ("scan_elements/in_temp_en", "0"),
        ("scan_elements/in_timestamp_en", "0"),
        ("scan_elements/in_anglvel_x_index", "0"),
        ("scan_elements/in_anglvel_x_type", "le:s16/16>>0"),
        ("scan_elements/in_anglvel_y_index", "1"),
        ("scan_elements/in_anglvel_y_type", "le:s16/16>>0"),
        ("scan_elements/in_anglvel_z_index", "2"),
        ("scan_elements/in_anglvel_z_type", "be:s24/32>>8"),
        ("scan_elements/in_temp_index", "3"),
        ("scan_elements/in_temp_type", "le:s16/16>>0"),
        ("scan_elements/in_timestamp_index", "4"),
        ("scan_elements/in_timestamp_type", "le:s64/64>>0"),
    ];

    fn find(folder: &Path, hz: Option<u32>, part: Option<Part>) -> crate::Result<Device> {
        let address = IioAddress { folder: folder.to_owned(), hz, bandwidth_hz: None };
        let driver = read_text(folder, "name")?;
        Device::find(&address, "iio:x", &driver, &Setup { part, ..Setup::default() })
    }

    #[test]
    fn polls_are_codes_in_the_scales_that_the_driver_states() {
        let folder = folder(&[]);
        let device = find(folder.path(), Some(1000), None).expect("a gyroscope");
        assert!(!device.has_buffer());
        let mut polled = PolledChannels::new(device, 1000, Sampling { every_temp: Some(2), divider: None });
        let (one, next) = (polled.poll().expect("a row"), polled.poll().expect("a row"));
        assert_eq!((one.codes(), one.temp_code, next.temp_code), (&[100, -200, 5][..], Some(2500), None));
        let DeviceInfo { info, part, .. } = polled.facts();
        assert_eq!((&*part.name, part.axes.len(), &*part.axes[1].name), ("gyro_3d", 3, "y"));
        let scan = info.layout.scan(&one);
        let Axis { rate, temp, .. } = part.axes[1].axis;
        let y_dps = rate.value(scan.rates()[1].into());
        assert!((y_dps - (-0.2f64).to_degrees()).abs() < 1e-9, "{y_dps} °/s");
        assert!((temp.value(scan.temp.expect("a temperature").into()) - 24.0).abs() < 1e-9);
    }

    #[test]
    fn scans_of_the_buffer_have_their_time_and_count_what_is_missing() {
        let folder = folder(BUFFER);
        // 2 + 2 + 4 + 2 bytes of channels, then 6 of padding: the time begins at a multiple of 8
        let scan = |x: i16, y: i16, z: i32, temp: i16, t_ns: i64| {
            let z = (z << 8).to_be_bytes();
            [&x.to_le_bytes()[..], &y.to_le_bytes(), &z, &temp.to_le_bytes(), &[0; 6], &t_ns.to_le_bytes()].concat()
        };
        let t0 = 1_700_000_000_000_000_000;
        let scans =
            [scan(1, -2, -70_000, 2500, t0), scan(3, 4, 5, 2600, t0 + 9_900_000), scan(0, 0, 0, 0, t0 + 40_100_000)];
        let file = folder.path().join("dev");
        fs::write(&file, scans.concat()).expect("written");
        let device = find(folder.path(), None, None).expect("a gyroscope");
        assert!(device.has_buffer());
        let mut buffered = BufferedScans::open(device, &file, &Stop::default()).expect("a buffer");
        assert_eq!(buffered.facts().rate_hz, Some(100.0));
        let rows: Vec<Row> = (0..3).map(|_| buffered.read().expect("a scan").expect("a row")).collect();
        assert_eq!((rows[0].codes(), rows[0].temp_code), (&[1, -2, -70_000][..], Some(2500)));
        assert_eq!((rows[1].t_ns - rows[0].t_ns, rows[1].lost, rows[2].lost), (9_900_000, 0, 2));
        assert_eq!(rows[2].edge_seq - rows[1].edge_seq, 3);
        let gone = crate::DeviceError::from(buffered.read().expect_err("the end of the file"));
        assert_eq!((gone.cause(), gone.to_string().contains("unplugged")), (Cause::Gone, true));
        let set = |name: &str| read_text(folder.path(), name).expect("an attribute");
        assert_eq!((set("scan_elements/in_anglvel_y_en"), set("buffer/enable")), ("1".into(), "1".into()));
        assert_eq!(set("scan_elements/in_accel_x_en"), "0", "somebody else wanted it");
        assert_eq!(set("current_timestamp_clock"), "monotonic", "the time of day steps");
        drop(buffered);
        assert_eq!(set("buffer/enable"), "0");
    }

    #[test]
    fn a_buffer_that_stays_empty_ends_in_bounded_time_or_when_asked_to() {
        let folder = folder(BUFFER);
        let pipe = folder.path().join("dev");
        mknodat(CWD, &pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).expect("a pipe");
        let _open = File::options().read(true).write(true).open(&pipe).expect("somebody who could write");
        let stop = Stop::default();
        let device = find(folder.path(), None, None).expect("a gyroscope");
        let mut buffered = BufferedScans::open(device, &pipe, &stop).expect("a buffer");
        assert_eq!(buffered.silence, SILENCE);
        buffered.silence = Duration::from_millis(1);
        let silent = crate::DeviceError::from(buffered.read().expect_err("no scan"));
        assert_eq!((silent.cause(), silent.to_string().contains("in_anglvel_hysteresis")), (Cause::Silent, true));
        buffered.silence = Duration::from_secs(3600);
        let there = std::mem::replace(&mut buffered.device.folder, "/there/is/none".into());
        assert_eq!(crate::DeviceError::from(buffered.read().expect_err("no device")).cause(), Cause::Gone);
        buffered.device.folder = there;
        stop.ask();
        assert!(buffered.read().expect("no failure").is_none());
    }

    #[test]
    fn a_part_file_adds_facts_to_the_device_of_its_name() {
        let folder = folder(&[]);
        let text = "schema = 1\nname = \"GYRO_3D\"\naxis = [{ name = \"x\" }, { name = \"y\" }, { name = \"z\" }]\n\
            rate = { lsb_per_dps = 1, zero_code = 0, width_bits = 16, range_dps = 500 }\n\
            temperature = { lsb_per_c = 1, zero_code = 0, zero_c = 0, width_bits = 16 }\n";
        let device = find(folder.path(), None, Some(Part::parse(text).expect("a part"))).expect("a gyroscope");
        let axis = &device.facts.part.axes[2].axis;
        assert_eq!((&*device.facts.part.name, axis.range_dps), ("GYRO_3D", Some(500.0)));
        assert!((axis.rate.lsb_per_unit - 1f64.to_radians() / 0.001).abs() < 1e-9, "the driver knows its scale");
    }

    #[test]
    fn a_device_without_rates_or_scale_is_refused() {
        let fails = |remove: &str, more: &[(&str, &str)]| {
            let folder = folder(more);
            for axis in ["x", "y", "z"].into_iter().filter(|_| remove == "rates") {
                fs::remove_file(folder.path().join(format!("in_anglvel_{axis}_raw"))).expect("removed");
            }
            if remove == "scale" {
                fs::remove_file(folder.path().join("in_anglvel_scale")).expect("removed");
            }
            find(folder.path(), None, None).map(drop).expect_err("nothing to read").to_string()
        };
        assert!(fails("rates", &[]).contains("not a gyroscope"));
        assert!(fails("scale", &[]).contains("in_anglvel_x states no scale"));
        assert!(fails("", &[("in_anglvel_scale", "0")]).contains("nothing can be converted"));
        let busy = folder(&[BUFFER, &[("buffer/enable", "1")]].concat());
        let device = find(busy.path(), None, None).expect("a gyroscope");
        let error = BufferedScans::open(device, &busy.path().join("none"), &Stop::default());
        assert_eq!(crate::DeviceError::from(error.map(drop).expect_err("no file")).cause(), Cause::Missing);
        let enable = read_text(busy.path(), "buffer/enable").expect("an attribute");
        assert_eq!(enable, "1", "whoever reads it goes on");
        let idle = folder(&[BUFFER, &[("trigger/current_trigger", "")]].concat());
        let device = find(idle.path(), None, None).expect("a gyroscope");
        fs::write(idle.path().join("dev"), "").expect("written");
        let error = BufferedScans::open(device, &idle.path().join("dev"), &Stop::default());
        let error = error.map(drop).expect_err("no trigger").to_string();
        assert!(error.contains("nothing triggers"), "{error}");
    }
}
