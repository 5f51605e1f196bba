//! Clients of libiio beside the page. Each opening of the device has a server of its own.

use crate::output::warn;
use anyhow::{Context, Result};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use zerorate::Calibration;
use zerorate_host::iiod::Server;
use zerorate_host::{Hub, Stop};
use zerorate_view::SessionWarning;
use zerorate_web::session::NoticeText;

/// The listener for clients, and the data that they get.
pub struct Libiio {
    listener: TcpListener,
    calibration: Option<Calibration>,
    may_be_written: bool,
    running: Option<(Stop, JoinHandle<()>)>,
}

impl Libiio {
    /// Serves nothing yet.
    pub fn new(listener: TcpListener, calibration: Option<Calibration>, may_be_written: bool) -> Self {
        Self { listener, calibration, may_be_written, running: None }
    }

    /// The address that clients connect to.
    ///
    /// # Errors
    /// Returns an error if the system does not know the address.
    pub fn address(&self) -> Result<SocketAddr> {
        self.listener.local_addr().context("the libiio server")
    }

    /// Serves the device of this hub from here on.
    ///
    /// # Errors
    /// Returns an error if no thread or no socket can be had.
    pub fn begin(&mut self, hub: &Arc<Hub>) -> Result<()> {
        self.end();
        let (hub, stop) = (Arc::clone(hub), Stop::default());
        let listener = self.listener.try_clone().context("serving libiio")?;
        let (calibration, may_be_written, ends) = (self.calibration.clone(), self.may_be_written, stop.clone());
        let body = move || {
            let server = Server::new(&hub, calibration.as_ref()).or_else(|error| {
                warn(&[NoticeText::from(SessionWarning::LibiioUncorrected(error.to_string()))]);
                Server::new(&hub, None)
            });
            let server = server.map(|server| if may_be_written { server.writable() } else { server });
            if let Ok(Err(error)) = server.map(|server| server.serve(&listener, &ends)) {
                warn(&[NoticeText::from(SessionWarning::LibiioEnded(error.to_string()))]);
            }
        };
        let thread = thread::Builder::new().name("libiio".to_owned()).spawn(body).context("serving libiio")?;
        self.running = Some((stop, thread));
        Ok(())
    }

    /// Ends serving, and drops the hub and all clients.
    pub fn end(&mut self) {
        if let Some((stop, thread)) = self.running.take() {
            stop.ask();
            // a server that failed has said so
            let _ = thread.join();
        }
    }
}

impl Drop for Libiio {
    fn drop(&mut self) {
        self.end();
    }
}
