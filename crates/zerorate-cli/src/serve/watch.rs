//! Serves a viewer over a WebSocket: sends frames and answers requests.

use super::answer::{self, Answer};
use super::bucket::Bucket;
use super::server::{Connection, Server};
use super::session_thread::{RequestSender, SessionRequest, Subscription};
use futures_util::{SinkExt, StreamExt};
use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::upgrade::Upgraded;
use hyper::{Request, StatusCode};
use hyper_util::rt::TokioIo;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::oneshot;
use tokio::time;
use tokio_tungstenite::WebSocketStream;
use tungstenite::handshake::server::create_response_with_body;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message};

/// Time in which a viewer must receive a message. Otherwise its connection is closed, and the page connects again.
const PATIENCE: Duration = Duration::from_secs(5);
/// Largest message of a page, bytes: a calibration file, with a margin.
const MESSAGE: usize = 1 << 20;
/// Number of requests at once, and per second in the long run. Faster requests are delayed.
const BURST: u32 = 40;
const REQUESTS_PER_S: f64 = 20.0;

type WebSocket = WebSocketStream<TokioIo<Upgraded>>;

pub fn watch(server: &Arc<Server>, connection: Arc<Connection>, request: Request<Incoming>) -> Answer {
    let Ok(accepted) = create_response_with_body(&request, Full::default) else {
        return answer::text(StatusCode::BAD_REQUEST, "this is not a WebSocket handshake (RFC 6455, version 13)\n");
    };
    let Ok(seat) = Arc::clone(&server.seats).try_acquire_owned() else {
        return answer::text(StatusCode::SERVICE_UNAVAILABLE, "too many viewers already\n");
    };
    let server = Arc::clone(server);
    tokio::spawn(async move {
        // an error of a client is not an error of the server
        if let Ok(upgraded) = hyper::upgrade::on(request).await {
            let config = WebSocketConfig::default();
            let config = config.max_message_size(Some(MESSAGE)).max_frame_size(Some(MESSAGE)).write_buffer_size(0);
            let upgraded = TokioIo::new(upgraded);
            let socket = WebSocketStream::from_raw_socket(upgraded, Role::Server, Some(config)).await;
            Watch { socket, requests: server.requests.clone() }.serve(server.limits.sign_of_life).await;
        }
        drop((seat, connection));
    });
    accepted
}

/// Requests a snapshot and the frames that follow; `None` if the session has ended.
pub async fn subscribe(requests: &RequestSender) -> Option<Subscription> {
    let (subscriber, subscription) = oneshot::channel();
    requests.try_send(SessionRequest::Watch(subscriber)).ok()?;
    subscription.await.ok()
}

struct Watch {
    socket: WebSocket,
    requests: RequestSender,
}

impl Watch {
    /// Serves the viewer until it leaves, stalls, does not answer a ping, or the session ends. A page that misses
    /// frames gets a new snapshot.
    async fn serve(mut self, sign_of_life: Duration) {
        let mut allowance = Bucket::new(BURST, REQUESTS_PER_S, Instant::now());
        let mut rounds = time::interval_at(time::Instant::now() + sign_of_life, sign_of_life);
        // if this loop is late, the viewer still gets the full time to answer
        rounds.set_missed_tick_behavior(time::MissedTickBehavior::Delay);
        let mut is_alive = true;
        while let Some(Subscription { snapshot, mut frames }) = subscribe(&self.requests).await {
            if !self.send(Message::Binary(snapshot)).await {
                return;
            }
            let mut reads_at = time::Instant::now();
            loop {
                tokio::select! {
                    frame = frames.recv() => match frame {
                        Ok(frame) => {
                            if !self.send(Message::Binary(frame)).await {
                                return;
                            }
                        }
                        Err(RecvError::Lagged(_)) => break,
                        Err(RecvError::Closed) => return,
                    },
                    message = next(&mut self.socket, reads_at) => {
                        let Some(message) = message else { return };
                        let message = match message {
                            Ok(message) => message,
                            Err(error) => return self.break_off(&error).await,
                        };
                        is_alive = true;
                        if !self.heed(message).await {
                            return;
                        }
                        reads_at = allowance.borrow(Instant::now()).into();
                    }
                    _ = rounds.tick() => {
                        if !std::mem::take(&mut is_alive) || !self.send(Message::Ping(Bytes::new())).await {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Sends a message. Returns false if the viewer does not receive it in time.
    async fn send(&mut self, message: Message) -> bool {
        matches!(time::timeout(PATIENCE, self.socket.send(message)).await, Ok(Ok(())))
    }

    /// Handles a message. Returns false if it was the last message of the connection.
    async fn heed(&mut self, message: Message) -> bool {
        match message {
            Message::Text(request) => {
                let (answer, answered) = oneshot::channel();
                if self.requests.try_send(SessionRequest::Ask(request.to_string(), answer)).is_err() {
                    return false;
                }
                match answered.await {
                    Ok(answer) => self.send(Message::Text(answer.into())).await,
                    Err(_) => false,
                }
            }
            Message::Binary(_) => {
                self.close(CloseCode::Unsupported, "requests are text").await;
                false
            }
            Message::Close(_) => {
                // the next read sends the answer to the close frame (RFC 6455, 5.5.1)
                let _ = time::timeout(PATIENCE, self.socket.next()).await;
                false
            }
            Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => true,
        }
    }

    /// Tells a viewer that is still connected why the server closes the connection.
    async fn break_off(&mut self, error: &Error) {
        let (code, reason) = match error {
            Error::Utf8(_) => (CloseCode::Invalid, "a text is not UTF-8"),
            Error::Capacity(_) => (CloseCode::Size, "a message is too large"),
            Error::Protocol(_) => (CloseCode::Protocol, "a frame breaks RFC 6455"),
            _ => return,
        };
        self.close(code, reason).await;
    }

    async fn close(&mut self, code: CloseCode, reason: &'static str) {
        self.send(Message::Close(Some(CloseFrame { code, reason: reason.into() }))).await;
    }
}

/// Reads the next message, but not before the time `at`; `None` at the end of the connection.
async fn next(socket: &mut WebSocket, at: time::Instant) -> Option<Result<Message, Error>> {
    time::sleep_until(at).await;
    socket.next().await
}
