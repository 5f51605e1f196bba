//! Access control. A request must use the server's own name, come from its own page, and show any required token.

use crate::exit::Usage;
use anyhow::{Result, anyhow};
use hyper::header::{HeaderName, HeaderValue};
use hyper::http::uri::Authority;
use hyper::{HeaderMap, Method, StatusCode, Uri, header};
use std::fmt;
use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use subtle::ConstantTimeEq;

/// A secret that a client must show to get samples.
pub struct Token(String);

/// Size of a random token: 128 bits, which cannot be guessed.
const TOKEN_BYTES: usize = 16;
/// Allowed lengths of a token that the user gives.
pub const TOKEN_LENGTHS: std::ops::RangeInclusive<usize> = 16..=256;

impl Token {
    pub fn random() -> Result<Self> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(|error| anyhow!("no random numbers for the token: {error}"))?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// The token in the first line of `text`, the content of the file `path`.
    pub fn of_file(path: &Path, text: &str) -> Result<Self> {
        let token = text.lines().next().unwrap_or_default().trim();
        let fits = TOKEN_LENGTHS.contains(&token.len()) && token.bytes().all(|byte| byte.is_ascii_alphanumeric());
        if !fits {
            let how = "a token has 16 to 256 letters and digits in one line; `openssl rand -hex 16` makes one";
            return Err(Usage(format!("{}: {how}", path.display())).into());
        }
        Ok(Self(token.to_owned()))
    }

    /// True if `shown` is the token, in constant time.
    pub fn is(&self, shown: &str) -> bool {
        self.0.as_bytes().ct_eq(shown.as_bytes()).into()
    }

    pub fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token")
    }
}

#[derive(Debug)]
pub struct Guard {
    token: Option<Token>,
    is_local: bool,
    /// Additional names of this machine.
    names: Vec<String>,
    cookie: String,
}

pub type Refusal = (StatusCode, &'static str);

const NOT_OUR_NAME: Refusal = (
    StatusCode::MISDIRECTED_REQUEST,
    "this is not a name of this server (another site may point its name here): use the IP address, or start the \
     server with --host NAME\n",
);
const NOT_OUR_PAGE: Refusal = (StatusCode::FORBIDDEN, "only the page of this server may ask\n");
const NO_SUCH_METHOD: Refusal = (StatusCode::METHOD_NOT_ALLOWED, "GET and HEAD alone, and POST of the token\n");
const NO_BODY: Refusal = (StatusCode::PAYLOAD_TOO_LARGE, "a request here has no body\n");

const FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
const FETCH_MODE: HeaderName = HeaderName::from_static("sec-fetch-mode");

impl Guard {
    /// The checks for a server at `address` that is also reached by `names`. Clients must show the `token` to get
    /// samples; with `None`, they need no token.
    pub fn new(address: SocketAddr, token: Option<Token>, names: Vec<String>) -> Self {
        let cookie = format!("zerorate_{}", address.port());
        Self { token, is_local: address.ip().is_loopback(), names, cookie }
    }

    pub fn token(&self) -> Option<&Token> {
        self.token.as_ref()
    }

    /// Checks every request. It must use a name of this server, come from its page, and have a known method. Only a
    /// request that sends a token may have a body.
    pub fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = self.own_name(headers)?;
        // a host in the request line takes precedence over the header (RFC 9112, 3.2.2)
        if uri.authority().is_some_and(|named| !named.as_str().eq_ignore_ascii_case(host)) {
            return Err(NOT_OUR_NAME);
        }
        from_own_page(method, host, headers)?;
        match *method {
            Method::GET | Method::HEAD if has_body(headers) => Err(NO_BODY),
            Method::GET | Method::HEAD => Ok(()),
            Method::POST if uri.path() == "/token" => Ok(()),
            _ => Err(NO_SUCH_METHOD),
        }
    }

    /// The cookie that stores the token; `None` without a token. Scripts cannot read the cookie, and browsers do not
    /// send it with requests from pages of other sites.
    pub fn cookie(&self) -> Option<HeaderValue> {
        let token = self.token.as_ref()?.reveal();
        HeaderValue::try_from(format!("{}={token}; Path=/; HttpOnly; SameSite=Strict", self.cookie)).ok()
    }

    /// The tokens in a request: in the cookie, or for other programs in `Authorization: Bearer`.
    pub fn shown<'a>(&'a self, headers: &'a HeaderMap) -> impl Iterator<Item = &'a str> {
        let texts = |name| headers.get_all(name).iter().filter_map(|value| value.to_str().ok());
        let cookies = texts(header::COOKIE).flat_map(|value| value.split(';'));
        let in_cookies = cookies.filter_map(|cookie| cookie.trim().strip_prefix(&*self.cookie)?.strip_prefix('='));
        in_cookies.chain(texts(header::AUTHORIZATION).filter_map(|value| value.strip_prefix("Bearer ")))
    }

    /// Protects against DNS rebinding: if another site points its name to this machine, the request has that name.
    /// IP addresses are accepted, but only loopback addresses if the server listens at one. The port is not compared,
    /// since it may be forwarded.
    fn own_name<'a>(&self, headers: &'a HeaderMap) -> Result<&'a str, Refusal> {
        let mut all = headers.get_all(header::HOST).iter();
        let (Some(host), None) = (all.next().and_then(|host| host.to_str().ok()), all.next()) else {
            return Err(NOT_OUR_NAME);
        };
        let authority: Authority = host.parse().map_err(|_| NOT_OUR_NAME)?;
        let name = authority.host().trim_matches(['[', ']']);
        let is_number = |ip: IpAddr| !self.is_local || ip.is_loopback();
        let is_own = name.eq_ignore_ascii_case("localhost")
            || name.parse().is_ok_and(is_number)
            || self.names.iter().any(|own| own.eq_ignore_ascii_case(name));
        if is_own && !host.contains('@') { Ok(host) } else { Err(NOT_OUR_NAME) }
    }
}

/// Refuses requests from pages of other sites. A browser allows any site to open a WebSocket to this machine, or to
/// post to it, but the request states the site.
fn from_own_page(method: &Method, host: &str, headers: &HeaderMap) -> Result<(), Refusal> {
    for origin in headers.get_all(header::ORIGIN) {
        let of = origin.to_str().ok().and_then(|origin| origin.split_once("://"));
        if !of.is_some_and(|(scheme, of)| matches!(scheme, "http" | "https") && of.eq_ignore_ascii_case(host)) {
            return Err(NOT_OUR_PAGE);
        }
    }
    let is = |name, text: &str| headers.get(name).is_some_and(|value| value == text);
    let told = headers.contains_key(FETCH_SITE);
    let from_here = is(FETCH_SITE, "same-origin") || is(FETCH_SITE, "none");
    // a link on another site may lead to this page
    let follows_link = is(FETCH_MODE, "navigate") && method == Method::GET;
    if told && !from_here && !follows_link { Err(NOT_OUR_PAGE) } else { Ok(()) }
}

fn has_body(headers: &HeaderMap) -> bool {
    let is_empty = |length: &header::HeaderValue| length == "0";
    headers.contains_key(header::TRANSFER_ENCODING)
        || headers.get_all(header::CONTENT_LENGTH).iter().any(|length| !is_empty(length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(listen: &str, names: &[&str]) -> Guard {
        let token = Token("0123456789abcdef".to_owned());
        let listen: SocketAddr = listen.parse().unwrap();
        let token = (!listen.ip().is_loopback()).then_some(token);
        Guard::new(listen, token, names.iter().map(ToString::to_string).collect())
    }

    fn headers(all: &[(&'static str, &'static str)]) -> HeaderMap {
        let pair = |&(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value));
        let mut headers = HeaderMap::new();
        for (name, value) in all.iter().map(pair) {
            headers.append(name, value);
        }
        headers
    }

    fn get(guard: &Guard, all: &[(&'static str, &'static str)]) -> Option<StatusCode> {
        guard.check(&Method::GET, &Uri::from_static("/ws"), &headers(all)).err().map(|(status, _)| status)
    }

    #[test]
    fn only_its_own_names_reach_the_server() {
        let local = guard("127.0.0.1:8130", &["bench.local"]);
        for own in ["127.0.0.1:8130", "localhost:9000", "LOCALHOST", "[::1]:8130", "127.1.2.3", "bench.local:8130"] {
            assert_eq!(get(&local, &[("host", own)]), None, "{own}");
        }
        let foreign = ["evil.example:8130", "192.168.1.5:8130", "localhost.evil.example", "a@localhost", "", "x y"];
        for foreign in foreign {
            assert_eq!(get(&local, &[("host", foreign)]), Some(StatusCode::MISDIRECTED_REQUEST), "{foreign}");
        }
        let twice = [("host", "localhost"), ("host", "localhost")];
        assert_eq!(get(&local, &twice).or(get(&local, &[])), Some(StatusCode::MISDIRECTED_REQUEST));
        let open = guard("0.0.0.0:8130", &[]);
        assert_eq!(get(&open, &[("host", "192.168.1.5:8130")]), None);
        assert!(get(&open, &[("host", "evil.example")]).is_some());
    }

    #[test]
    fn a_request_line_names_no_other_host_than_the_header() {
        let local = guard("127.0.0.1:8130", &[]);
        let of = |uri: &'static str| {
            let all = headers(&[("host", "localhost:8130")]);
            local.check(&Method::GET, &Uri::from_static(uri), &all).err().map(|(status, _)| status.as_u16())
        };
        assert_eq!(of("http://LOCALHOST:8130/ws"), None);
        for other in ["http://evil.example/ws", "http://127.0.0.1:8130/ws", "http://localhost/ws"] {
            assert_eq!(of(other), Some(421), "{other}");
        }
    }

    #[test]
    fn only_its_own_page_may_ask() {
        let local = guard("127.0.0.1:8130", &[]);
        let with = |more: &[(&'static str, &'static str)]| {
            get(&local, &[&[("host", "localhost:8130")], more].concat()).is_none()
        };
        assert!(with(&[("origin", "http://localhost:8130")]));
        assert!(with(&[("origin", "http://localhost:8130"), ("sec-fetch-site", "same-origin")]));
        let others = ["http://evil.example", "http://localhost:3000", "null", "http://localhost", "localhost:8130"];
        assert!(others.iter().all(|other| !with(&[("origin", other)])));
        assert!(!with(&[("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "no-cors")]));
        assert!(!with(&[("sec-fetch-site", "same-site"), ("sec-fetch-mode", "cors")]));
        // following a link on another site, or typing the address, leads to the page
        assert!(with(&[("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")]));
        assert!(with(&[("sec-fetch-site", "none"), ("sec-fetch-mode", "navigate")]));
    }

    #[test]
    fn a_request_has_a_known_method_and_no_body() {
        let local = guard("127.0.0.1:8130", &[]);
        let of = |method: &Method, path: &str, more: &[(&'static str, &'static str)]| {
            let all = headers(&[&[("host", "localhost")], more].concat());
            local.check(method, &path.parse().unwrap(), &all).err().map(|(status, _)| status.as_u16())
        };
        assert_eq!(of(&Method::GET, "/", &[("content-length", "0")]), None);
        assert_eq!(of(&Method::GET, "/", &[("content-length", "1")]), Some(413));
        assert_eq!(of(&Method::GET, "/", &[("transfer-encoding", "chunked")]), Some(413));
        assert_eq!(of(&Method::POST, "/token", &[("content-length", "32")]), None);
        assert_eq!(of(&Method::POST, "/", &[]), Some(405));
        assert_eq!(of(&Method::DELETE, "/token", &[]), Some(405));
    }

    #[test]
    fn a_token_comes_in_a_cookie_or_a_header() {
        let open = guard("0.0.0.0:8130", &[]);
        let token = open.token().unwrap();
        let admitted = |all: &[(&'static str, &'static str)]| open.shown(&headers(all)).any(|shown| token.is(shown));
        assert!(admitted(&[("cookie", "a=b; zerorate_8130=0123456789abcdef")]));
        assert!(admitted(&[("authorization", "Bearer 0123456789abcdef")]));
        let wrong = ["zerorate_8130=", "zerorate_8130=0123456789abcdee", "zerorate_8131=0123456789abcdef"];
        assert!(wrong.iter().all(|wrong| !admitted(&[("cookie", wrong)])) && !admitted(&[]));
        assert!(!admitted(&[("authorization", "0123456789abcdef")]));
        let cookie = open.cookie().unwrap();
        assert!(cookie.as_bytes().ends_with(b"HttpOnly; SameSite=Strict"), "{cookie:?}");
        assert!(guard("127.0.0.1:8130", &[]).token().is_none());
    }

    #[test]
    fn a_token_is_random_and_nobody_prints_it_by_accident() {
        let (one, other) = (Token::random().unwrap(), Token::random().unwrap());
        assert!(one.reveal().len() == 32 && one.reveal() != other.reveal());
        assert!(one.is(one.reveal()) && !one.is(other.reveal()) && !one.is(""));
        assert!(!format!("{:?}", Guard::new(([0, 0, 0, 0], 1).into(), Some(one), vec![])).contains(other.reveal()));
        for (text, fits) in [("0123456789abcdef\n", true), ("short\n", false), ("0123456789abcde;\n", false)] {
            assert_eq!(Token::of_file(Path::new("token"), text).is_ok(), fits, "{text}");
        }
    }
}
