//! A cable between the emulator and the program that damages frames, or is pulled.

use anyhow::Result;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::thread;

/// Address of the program's end of the cable.
pub struct Cable(u16);

impl Cable {
    /// Lays a cable to the emulator's socket for one connection.
    pub fn lay(to: u16, damaged_every: Option<u64>, pulled_after: Option<u64>) -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let port = listener.local_addr()?.port();
        thread::spawn(move || -> std::io::Result<()> {
            let (program, _) = listener.accept()?;
            let bridge = TcpStream::connect(("127.0.0.1", to))?;
            for stream in [&program, &bridge] {
                stream.set_nodelay(true)?;
            }
            let (mut requests, mut answers) = (program.try_clone()?, bridge.try_clone()?);
            thread::spawn(move || std::io::copy(&mut requests, &mut answers));
            let carried = Harm { damaged_every, pulled_after, frames: 0, place: 0, bytes: 0 }.carry(&bridge, &program);
            for stream in [&program, &bridge] {
                let _ = stream.shutdown(Shutdown::Both);
            }
            carried
        });
        Ok(Self(port))
    }

    pub fn port(&self) -> u16 {
        self.0
    }
}

struct Harm {
    damaged_every: Option<u64>,
    pulled_after: Option<u64>,
    /// Frames that have passed whole.
    frames: u64,
    /// Bytes of the frame that passes now.
    place: u64,
    bytes: u64,
}

impl Harm {
    fn carry(mut self, mut from: &TcpStream, mut to: &TcpStream) -> std::io::Result<()> {
        let mut bytes = [0; 4096];
        loop {
            let length = from.read(&mut bytes)?;
            self.bytes += length as u64;
            if length == 0 || self.pulled_after.is_some_and(|most| self.bytes > most) {
                return Ok(());
            }
            for byte in &mut bytes[..length] {
                *byte = self.pass(*byte);
            }
            to.write_all(&bytes[..length])?;
        }
    }

    /// Flips a bit in the second byte of a frame to be damaged, without turning it into an end.
    fn pass(&mut self, byte: u8) -> u8 {
        if byte == 0 {
            self.frames += 1;
            self.place = 0;
            return byte;
        }
        self.place += 1;
        let harmed = self.damaged_every.is_some_and(|every| self.frames % every == every - 1);
        match byte {
            0x10 if harmed && self.place == 2 => 0x11,
            _ if harmed && self.place == 2 => byte ^ 0x10,
            _ => byte,
        }
    }
}
