//! Connections, and what may be asked on them. Every wait and every size has a bound.

use super::bucket::Bucket;
use super::desk::Visits;
use super::guard::{Guard, Refusal};
use super::{metrics, page, watch};
use anyhow::{Context, Result};
use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use serde_json::json;
use std::net::TcpListener;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::net::TcpStream;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time;
use zerorate_host::Stop;

/// Connections at a time.
const CONNECTIONS: usize = 96;
/// Pages that look on.
const SEATS: usize = 48;
/// Until the head of a request must be there, and until the next one.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// Of a connection that is no page looking on.
const LIFETIME: Duration = Duration::from_secs(120);
/// Largest head of a request, bytes.
const HEAD: usize = 16 << 10;
const HEADERS: usize = 64;
/// Requests at once on a connection, and in a second.
const BURST: u32 = 100;
const REQUESTS_PER_S: f64 = 20.0;
/// Tokens that may be tried at once, and in a second, by all together.
const TRIALS: u32 = 5;
const TRIALS_PER_S: f64 = 0.5;
/// Largest token, bytes.
const TOKEN: usize = 1 << 10;
/// A wish to end is heeded this often.
const POLL: Duration = Duration::from_millis(50);

/// Where the page's script and everything else may come from: here, and no other place.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
    img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; worker-src 'self'; manifest-src 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// What all requests share.
pub struct Server {
    pub visits: Visits,
    pub seats: Arc<Semaphore>,
    guard: Guard,
    trials: Mutex<Bucket>,
}

/// A connection, and how much is asked on it.
pub struct Connection {
    requests: Mutex<Bucket>,
    _place: OwnedSemaphorePermit,
}

impl Server {
    /// Pages that look on.
    pub fn watchers(&self) -> usize {
        SEATS - self.seats.available_permits()
    }
}

/// Serves until the wish to end.
///
/// # Errors
/// The system does not let it.
pub fn run(listener: TcpListener, guard: Guard, visits: Visits, stop: &Stop) -> Result<()> {
    let trials = Mutex::new(Bucket::new(TRIALS, TRIALS_PER_S, Instant::now()));
    let server = Arc::new(Server { visits, seats: Arc::new(Semaphore::new(SEATS)), guard, trials });
    listener.set_nonblocking(true).context("the server")?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().context("the server")?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener).context("the server")?;
        tokio::select! {
            () = accept(listener, routes(server)) => {}
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

fn routes(server: Arc<Server>) -> Router {
    let admitted = Router::new()
        .route("/ws", get(watch::watch))
        .route("/metrics", get(metrics::metrics))
        .route_layer(middleware::from_fn_with_state(Arc::clone(&server), admit));
    Router::new()
        .merge(admitted)
        .route("/home.json", get(home))
        .route("/token", post(token))
        .fallback(page::file)
        .layer(middleware::from_fn_with_state(Arc::clone(&server), check))
        .with_state(server)
}

async fn accept(listener: tokio::net::TcpListener, routes: Router) {
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // no room for another file, or who came has left
            time::sleep(POLL).await;
            continue;
        };
        match Arc::clone(&places).try_acquire_owned() {
            Ok(place) => drop(tokio::spawn(attend(stream, routes.clone(), place))),
            Err(_) => turn_away(&stream),
        }
    }
}

fn turn_away(stream: &TcpStream) {
    let _ = stream.try_write(b"HTTP/1.1 503 Service Unavailable\r\nconnection: close\r\ncontent-length: 0\r\n\r\n");
}

async fn attend(stream: TcpStream, routes: Router, place: OwnedSemaphorePermit) {
    // frames are small, and late ones useless
    let _ = stream.set_nodelay(true);
    let requests = Mutex::new(Bucket::new(BURST, REQUESTS_PER_S, Instant::now()));
    let connection = Arc::new(Connection { requests, _place: place });
    let service = TowerToHyperService::new(routes.layer(Extension(connection)));
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEAD_TIME).max_buf_size(HEAD).max_headers(HEADERS);
    let served = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
    // whoever breaks off is no failure of the server
    let _ = time::timeout(LIFETIME, served).await;
}

/// What holds for every request and every answer.
async fn check(
    State(server): State<Arc<Server>>,
    Extension(connection): Extension<Arc<Connection>>,
    request: Request,
    next: Next,
) -> Response {
    let taken = lock(&connection.requests).take(Instant::now());
    let checked = server.guard.check(request.method(), request.uri().path(), request.headers());
    let mut response = match (taken, checked) {
        (Err(_), _) => refused((StatusCode::TOO_MANY_REQUESTS, "slower\n")),
        (_, Err(refusal)) => refused(refusal),
        (Ok(()), Ok(())) => next.run(request).await,
    };
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    let headers = response.headers_mut();
    headers.extend(fixed.map(|(name, value)| (name, HeaderValue::from_static(value))));
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

/// What holds beside for samples and requests.
async fn admit(State(server): State<Arc<Server>>, request: Request, next: Next) -> Response {
    match server.guard.admit(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refused(refusal),
    }
}

/// What is left of a body is not waited for.
fn refused((status, why): Refusal) -> Response {
    (status, [(header::CONNECTION, "close")], why).into_response()
}

/// Which home the page is in (docs/formats/page.md).
async fn home(State(server): State<Arc<Server>>, request: Request) -> Response {
    let token_needed = server.guard.admit(request.headers()).is_err();
    let text = json!({"home": "served", "token_needed": token_needed}).to_string();
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

/// The token, typed into the page or taken by it from the fragment of the address; the answer brings the cookie.
async fn token(State(server): State<Arc<Server>>, body: Body) -> Response {
    if lock(&server.trials).take(Instant::now()).is_err() {
        return refused((StatusCode::TOO_MANY_REQUESTS, "too many tokens were tried: wait some seconds\n"));
    }
    let shown = match time::timeout(HEAD_TIME, to_bytes(body, TOKEN)).await {
        Ok(Ok(bytes)) => bytes,
        Ok(Err(_)) => return refused((StatusCode::PAYLOAD_TOO_LARGE, "that is no token\n")),
        Err(_) => return refused((StatusCode::REQUEST_TIMEOUT, "the token did not come\n")),
    };
    let shown = str::from_utf8(&shown).unwrap_or_default().trim();
    match (server.guard.token(), server.guard.cookie()) {
        (Some(token), Some(cookie)) if token.is(shown) => {
            (StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie)]).into_response()
        }
        (Some(_), _) => refused((StatusCode::FORBIDDEN, "that is not the token\n")),
        (None, _) => StatusCode::NO_CONTENT.into_response(),
    }
}

fn lock(bucket: &Mutex<Bucket>) -> std::sync::MutexGuard<'_, Bucket> {
    bucket.lock().unwrap_or_else(PoisonError::into_inner)
}
