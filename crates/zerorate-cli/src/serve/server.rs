//! Accepts connections and routes their requests. Every wait and every size has a limit.

use super::answer::{self, Answer};
use super::bucket::Bucket;
use super::guard::{Guard, Refusal};
use super::session_thread::RequestSender;
use super::small_page::{self, small_page};
use super::trials::Trials;
use super::{metrics, page, watch};
use anyhow::{Context, Result};
use http_body_util::{BodyExt, Limited};
use hyper::body::Incoming;
use hyper::header::{HeaderName, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{HeaderMap, Method, Request, StatusCode, header};
use hyper_util::rt::{TokioIo, TokioTimer};
use serde_json::json;
use std::convert::Infallible;
use std::net::TcpListener;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::net::TcpStream;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time;
use zerorate_host::Stop;

const CONNECTIONS: usize = 96;
/// Largest number of simultaneous viewers.
const SEATS: usize = 48;
/// Largest head of a request, bytes.
const HEAD: usize = 16 << 10;
const HEADERS: usize = 64;
/// Largest number of requests at once on a connection, and per second in the long run.
const BURST: u32 = 100;
const REQUESTS_PER_S: f64 = 20.0;
/// Largest body of a request that sends a token, bytes.
const TOKEN: usize = 1 << 10;
/// Interval between checks for a requested stop, and the wait after a connection could not be accepted.
const POLL: Duration = Duration::from_millis(50);

/// Content security policy: the page can load everything from this server only.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
    img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; worker-src 'self'; manifest-src 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Time limit for receiving the head of a request or a token, and for the wait until the next request.
    pub head: Duration,
    /// Lifetime of a connection that is not a viewer.
    pub lifetime: Duration,
    /// Time within which a viewer must answer a ping.
    pub sign_of_life: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        let [head, lifetime, sign_of_life] = [5, 120, 30].map(Duration::from_secs);
        Self { head, lifetime, sign_of_life }
    }
}

pub struct Server {
    pub requests: RequestSender,
    pub seats: Arc<Semaphore>,
    pub limits: Limits,
    guard: Guard,
    trials: Trials,
}

pub struct Connection {
    requests: Mutex<Bucket>,
    _place: OwnedSemaphorePermit,
}

impl Server {
    pub fn watchers(&self) -> usize {
        SEATS - self.seats.available_permits()
    }

    fn new(guard: Guard, requests: RequestSender, limits: Limits) -> Self {
        Self { requests, seats: Arc::new(Semaphore::new(SEATS)), limits, guard, trials: Trials::new(Instant::now()) }
    }

    /// Checks the token, if one is required. Every request for samples or commands must pass this check.
    fn admit(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let Some(token) = self.guard.token() else { return Ok(()) };
        self.trials.admit(token, self.guard.shown(headers), Instant::now())
    }
}

/// Requests a stop of all threads when this value is dropped, also after a panic.
pub struct EndsAll(pub Stop);

impl Drop for EndsAll {
    fn drop(&mut self) {
        self.0.ask();
    }
}

pub fn run(listener: TcpListener, guard: Guard, requests: RequestSender, stop: &Stop) -> Result<()> {
    serve(listener, Server::new(guard, requests, Limits::default()), stop)
}

fn serve(listener: TcpListener, server: Server, stop: &Stop) -> Result<()> {
    let server = Arc::new(server);
    listener.set_nonblocking(true).context("the server")?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().context("the server")?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener).context("the server")?;
        tokio::select! {
            () = accept(listener, server) => {}
            () = asked(stop) => {}
        }
        Ok(())
    })
}

async fn asked(stop: &Stop) {
    while !stop.asked() {
        time::sleep(POLL).await;
    }
}

async fn accept(listener: tokio::net::TcpListener, server: Arc<Server>) {
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // a connection cannot be accepted if too many files are open, or if the client has left
            time::sleep(POLL).await;
            continue;
        };
        match Arc::clone(&places).try_acquire_owned() {
            Ok(place) => drop(tokio::spawn(attend(stream, Arc::clone(&server), place))),
            Err(_) => turn_away(&stream),
        }
    }
}

fn turn_away(stream: &TcpStream) {
    let _ = stream.try_write(b"HTTP/1.1 503 Service Unavailable\r\nconnection: close\r\ncontent-length: 0\r\n\r\n");
}

async fn attend(stream: TcpStream, server: Arc<Server>, place: OwnedSemaphorePermit) {
    // frames are small and must not be delayed
    let _ = stream.set_nodelay(true);
    let requests = Mutex::new(Bucket::new(BURST, REQUESTS_PER_S, Instant::now()));
    let connection = Arc::new(Connection { requests, _place: place });
    let limits = server.limits;
    let service = service_fn(move |request| {
        let (server, connection) = (Arc::clone(&server), Arc::clone(&connection));
        async move { Ok::<_, Infallible>(checked(&server, connection, request).await) }
    });
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(limits.head).max_buf_size(HEAD).max_headers(HEADERS);
    let served = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
    // an error of a client is not an error of the server
    let _ = time::timeout(limits.lifetime, served).await;
}

/// Checks and answers a request, and sets the headers that every answer has.
async fn checked(server: &Arc<Server>, connection: Arc<Connection>, request: Request<Incoming>) -> Answer {
    let taken = lock(&connection.requests).take(Instant::now());
    let checked = server.guard.check(request.method(), request.uri(), request.headers());
    let mut answer = match (taken, checked) {
        (Err(_), _) => refused((StatusCode::TOO_MANY_REQUESTS, "slower\n")),
        (_, Err(refusal)) => refused(refusal),
        (Ok(()), Ok(())) => routed(server, connection, request).await,
    };
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    let headers = answer.headers_mut();
    headers.extend(fixed.map(|(name, value)| (name, HeaderValue::from_static(value))));
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    answer
}

/// Answers a request that passed the checks. Samples and commands need the token.
async fn routed(server: &Arc<Server>, connection: Arc<Connection>, request: Request<Incoming>) -> Answer {
    let path = request.uri().path();
    let has_samples = matches!(path, "/ws" | "/metrics") || path == "/" && !page::is_there();
    if has_samples && let Err(refusal) = server.admit(request.headers()) {
        return refused(refusal);
    }
    match (request.method(), path) {
        (_, "/ws") => watch::watch(server, connection, request),
        (_, "/metrics") => metrics::metrics(server).await,
        (_, "/") if has_samples => small_page(server).await,
        (_, "/small_page.js") if !page::is_there() => small_page::script(),
        (_, "/home.json") => home(server, request.headers()),
        (&Method::POST, "/token") => token(server, request.into_body()).await,
        (_, "/token") => answer::text(StatusCode::METHOD_NOT_ALLOWED, "POST alone\n"),
        _ => page::file(request.uri(), request.headers()),
    }
}

/// Answers with a refusal and closes the connection, without waiting for the rest of a body.
fn refused((status, why): Refusal) -> Answer {
    let mut answer = answer::text(status, why);
    answer.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    answer
}

/// Tells the page that it comes from a server, and whether the server needs a token (docs/formats/page.md).
fn home(server: &Server, headers: &HeaderMap) -> Answer {
    let token_needed = server.admit(headers).is_err();
    let text = json!({"home": "served", "token_needed": token_needed}).to_string();
    answer::typed(StatusCode::OK, "application/json", text)
}

/// Checks a token that the user typed, or that the page took from its address. If right, the answer sets the cookie.
async fn token(server: &Server, body: Incoming) -> Answer {
    let shown = match time::timeout(server.limits.head, Limited::new(body, TOKEN).collect()).await {
        Ok(Ok(body)) => body.to_bytes(),
        Ok(Err(_)) => return refused((StatusCode::PAYLOAD_TOO_LARGE, "that is not a token\n")),
        Err(_) => return refused((StatusCode::REQUEST_TIMEOUT, "the token did not come\n")),
    };
    let shown = str::from_utf8(&shown).unwrap_or_default().trim();
    let (Some(token), Some(cookie)) = (server.guard.token(), server.guard.cookie()) else {
        return answer::empty(StatusCode::NO_CONTENT);
    };
    match server.trials.admit(token, [shown], Instant::now()) {
        Ok(()) => {
            let mut answer = answer::empty(StatusCode::NO_CONTENT);
            answer.headers_mut().insert(header::SET_COOKIE, cookie);
            answer
        }
        Err((StatusCode::UNAUTHORIZED, _)) => refused((StatusCode::FORBIDDEN, "that is not the token\n")),
        Err(refusal) => refused(refusal),
    }
}

fn lock(bucket: &Mutex<Bucket>) -> std::sync::MutexGuard<'_, Bucket> {
    bucket.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
