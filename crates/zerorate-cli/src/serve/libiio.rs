//! Serves libiio clients, beside the page. Each time the device is opened, a new server is started.

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

pub struct Libiio {
    listener: TcpListener,
    calibration: Option<Calibration>,
    may_be_written: bool,
    running: Option<(Stop, JoinHandle<()>)>,
}

impl Libiio {
    pub fn new(listener: TcpListener, calibration: Option<Calibration>, may_be_written: bool) -> Self {
        Self { listener, calibration, may_be_written, running: None }
    }

    pub fn address(&self) -> Result<SocketAddr> {
        self.listener.local_addr().context("the libiio server")
    }

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

    /// Ends the server, and drops the hub and all clients.
    pub fn end(&mut self) {
        if let Some((stop, thread)) = self.running.take() {
            stop.ask();
            // a server that failed has already reported that
            let _ = thread.join();
        }
    }
}

impl Drop for Libiio {
    fn drop(&mut self) {
        self.end();
    }
}
