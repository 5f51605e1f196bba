//! Lines of the Linux GPIO character device: RDY as an input of edges, and outputs to the self-test pins.

use crate::edges::Edges;
use crate::error::{Cause, UserError, no_permission};
use crate::pin::HalError;
use adis16130::{Edge, RdyEdge};
use anyhow::{Context, Result};
use embedded_hal::digital::{self, OutputPin};
use gpiocdev::Request;
use gpiocdev::line::{EdgeDetection, Value};
use rustix::io::Errno;
use std::path::Path;
use std::time::Duration;

/// Size of the kernel's queue of edges: the largest that the kernel allows.
const KERNEL_EDGES: u32 = 1024;
const EDGES_AT_ONCE: usize = 64;

pub struct GpioEdges {
    request: Request,
    name: String,
    buffer: Vec<u64>,
    first_ns: Option<u64>,
    last_ns: u64,
}

impl GpioEdges {
    pub fn open(chip: &Path, line: u32, edge: RdyEdge) -> Result<Self> {
        let edge = match edge {
            RdyEdge::Falling => EdgeDetection::FallingEdge,
            RdyEdge::Rising => EdgeDetection::RisingEdge,
        };
        let request = Request::builder()
            .on_chip(chip)
            .with_consumer("zerorate RDY")
            .with_line(line)
            .as_input()
            .with_edge_detection(edge)
            .with_kernel_event_buffer_size(KERNEL_EDGES)
            .request()
            .map_err(|error| why_no_line(chip, line, error))?;
        let buffer = vec![0; EDGES_AT_ONCE * request.edge_event_u64_size()];
        Ok(Self { request, name: format!("{} line {line}", chip.display()), buffer, first_ns: None, last_ns: 0 })
    }

    /// Returns the newest edge in the kernel's queue; `None` if the queue is empty. `seq` also counts dropped edges.
    fn newest(&mut self) -> Result<Option<Edge>> {
        let size = self.request.edge_event_u64_size();
        let mut newest = None;
        // reads one full queue at most; edges that arrive meanwhile can wait
        for _ in 0..KERNEL_EDGES as usize / EDGES_AT_ONCE {
            let words = self.request.read_edge_events_into_slice(&mut self.buffer)?;
            if let Some(last) = words.checked_sub(size) {
                let event = self.request.edge_event_from_slice(&self.buffer[last..words])?;
                newest = Some(Edge { t_ns: event.timestamp_ns, seq: event.line_seqno });
            }
            if words < self.buffer.len() || !self.request.has_edge_event()? {
                break;
            }
        }
        Ok(newest)
    }
}

impl Edges for GpioEdges {
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>> {
        let came = self.request.wait_edge_event(Duration::from_nanos(timeout_ns));
        let edge = match came {
            Ok(true) => self.newest().with_context(|| format!("reading the RDY line, {}", self.name))?,
            Ok(false) => None,
            Err(error) if errno(&error) == Some(Errno::INTR) => return self.next(timeout_ns),
            Err(error) => return Err(error).with_context(|| format!("waiting for the RDY line, {}", self.name)),
        };
        if let Some(edge) = edge {
            self.first_ns.get_or_insert(edge.t_ns);
            self.last_ns = edge.t_ns;
        }
        Ok(edge)
    }

    fn now(&self) -> String {
        let elapsed_ns = self.last_ns.saturating_sub(self.first_ns.unwrap_or(self.last_ns));
        format!("{:.1} s after the first edge", elapsed_ns as f64 * 1e-9)
    }
}

/// An output line to the self-test pins, initially inactive. The kernel releases it when the program ends.
pub struct GpioOutput {
    request: Request,
    line: u32,
}

impl GpioOutput {
    pub fn open(chip: &Path, line: u32) -> Result<Self> {
        let request = Request::builder()
            .on_chip(chip)
            .with_consumer("zerorate self-test")
            .with_line(line)
            .as_output(Value::Inactive)
            .request()
            .map_err(|error| why_no_line(chip, line, error))?;
        Ok(Self { request, line })
    }
}

impl digital::ErrorType for GpioOutput {
    type Error = HalError;
}

impl OutputPin for GpioOutput {
    fn set_low(&mut self) -> Result<(), HalError> {
        self.request.set_value(self.line, Value::Inactive).map(drop).map_err(HalError::new)
    }

    fn set_high(&mut self) -> Result<(), HalError> {
        self.request.set_value(self.line, Value::Active).map(drop).map_err(HalError::new)
    }
}

fn why_no_line(chip: &Path, line: u32, error: gpiocdev::Error) -> anyhow::Error {
    let file = chip.display();
    let (cause, remedy) = match errno(&error) {
        Some(Errno::BUSY) => (
            Cause::Busy,
            format!("line {line} of {file} is busy: gpioinfo shows who uses it; RDY needs a line of its own"),
        ),
        Some(Errno::ACCESS | Errno::PERM) => (Cause::Permission, no_permission(file, "gpio")),
        Some(Errno::INVAL) => {
            (Cause::Missing, format!("{file} has no line {line} that can raise interrupts: gpioinfo lists its lines"))
        }
        _ => (
            Cause::Missing,
            format!("no GPIO chip {file}: ls /dev/gpiochip* lists them; RDY (pin 10) needs one of their lines"),
        ),
    };
    anyhow::Error::new(error).context(UserError::new(cause, remedy))
}

pub fn errno(error: &gpiocdev::Error) -> Option<Errno> {
    match error {
        gpiocdev::Error::Os(errno) | gpiocdev::Error::Uapi(_, gpiocdev_uapi::Error::Os(errno)) => {
            Some(Errno::from_raw_os_error(errno.0))
        }
        _ => None,
    }
}
