//! UDP over a simulated bad line: late, out of order, lost and doubled packets, from a seed.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

use ggrs::{Message, NonBlockingSocket};

use crate::random::SplitMix;

/// Quality of the line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Number of calls of `receive_all_messages` that a message is held back; a game makes one call a frame.
    pub(crate) latency: u64,
    /// Largest number of further calls, so that messages overtake each other.
    pub(crate) jitter: u64,
    /// Loss, in percent.
    pub(crate) lost: u64,
    /// Doubled packets, in percent.
    pub(crate) doubled: u64,
}

/// A socket on the loopback device with a bad line behind it. Time is counted in calls, not in seconds: a slow machine gets
/// the same line as a fast one.
pub(crate) struct BadLine {
    socket: UdpSocket,
    line: Line,
    random: SplitMix,
    calls: u64,
    /// (the call at which it is handed out, from where, what), in the order of arrival.
    held: Vec<(u64, SocketAddr, Message)>,
}

impl BadLine {
    /// A socket on a port that is free.
    ///
    /// # Errors
    /// If there is none.
    pub(crate) fn bind(line: Line, seed: u64) -> io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket, line, random: SplitMix(seed), calls: 0, held: Vec::new() })
    }

    /// The port of the socket.
    ///
    /// # Errors
    /// If the system does not say.
    pub(crate) fn port(&self) -> io::Result<u16> {
        Ok(self.socket.local_addr()?.port())
    }

    fn percent(&mut self, share: u64) -> bool {
        self.random.next() % 100 < share
    }

    /// The call at which a message that arrives now is handed out.
    fn due(&mut self) -> u64 {
        self.calls + self.line.latency + self.random.next() % (self.line.jitter + 1)
    }
}

impl NonBlockingSocket<SocketAddr> for BadLine {
    fn send_to(&mut self, message: &Message, address: &SocketAddr) {
        // A packet that cannot be sent is lost, as on a real line: GGRS resends unacknowledged packets.
        if let Ok(bytes) = postcard::to_allocvec(message) {
            let _ = self.socket.send_to(&bytes, address);
        }
    }

    fn receive_all_messages(&mut self) -> Vec<(SocketAddr, Message)> {
        self.calls += 1;
        let mut bytes = [0; 4096];
        // Any error means that nothing can be received now.
        while let Ok((length, from)) = self.socket.recv_from(&mut bytes) {
            let Ok(message) = postcard::from_bytes::<Message>(&bytes[..length]) else { continue };
            if self.percent(self.line.lost) {
                continue;
            }
            if self.percent(self.line.doubled) {
                let due = self.due();
                self.held.push((due, from, message.clone()));
            }
            let due = self.due();
            self.held.push((due, from, message));
        }
        let calls = self.calls;
        let (mut due, later): (Vec<_>, Vec<_>) = self.held.drain(..).partition(|(at, ..)| *at <= calls);
        self.held = later;
        due.sort_by_key(|(at, ..)| *at);
        due.into_iter().map(|(_, from, message)| (from, message)).collect()
    }
}
