//! The files of the page, which are embedded in the program. A request cannot get any other file.

use super::answer::{self, Answer};
use flate2::read::GzDecoder;
use hyper::body::Bytes;
use hyper::header::HeaderValue;
use hyper::{HeaderMap, StatusCode, Uri, header};
use std::io::Read;
use zerorate_view::SessionWarning;
use zerorate_web::session::NoticeText;

/// An embedded file, compressed by gzip. Browsers accept gzip from any host over plain HTTP, but not brotli.
struct Asset {
    name: &'static str,
    /// A hash of the content, as the ETag for caches.
    tag: &'static str,
    packed: &'static [u8],
}

/// The files of the page that the build found; empty if there were none.
static PAGE: &[Asset] = include!(concat!(env!("OUT_DIR"), "/page.rs"));

pub fn is_there() -> bool {
    !PAGE.is_empty()
}

pub fn file(uri: &Uri, headers: &HeaderMap) -> Answer {
    let name = match uri.path().trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    match PAGE.iter().find(|asset| asset.name == name) {
        Some(asset) => asset.answer(headers),
        None if is_there() => answer::text(StatusCode::NOT_FOUND, "no such file\n"),
        None => answer::text(StatusCode::NOT_FOUND, format!("{}\n", NoticeText::from(SessionWarning::NoPage))),
    }
}

impl Asset {
    fn answer(&self, headers: &HeaderMap) -> Answer {
        let is_known = headers.get(header::IF_NONE_MATCH).is_some_and(|tag| tag == self.tag);
        let is_packed = !is_known && takes_gzip(headers);
        let (status, body) = match (is_known, is_packed) {
            (true, _) => (StatusCode::NOT_MODIFIED, Bytes::new()),
            (false, true) => (StatusCode::OK, Bytes::from_static(self.packed)),
            (false, false) => (StatusCode::OK, self.unpacked().into()),
        };
        let mut answer = answer::typed(status, media_type(self.name), body);
        let own = answer.headers_mut();
        if is_packed {
            own.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
        }
        own.insert(header::ETAG, HeaderValue::from_static(self.tag));
        own.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        // the address may belong to another program tomorrow, so the browser must revalidate its cache
        own.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
        answer
    }

    fn unpacked(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // the build compressed the file, so it cannot be damaged
        let _ = GzDecoder::new(self.packed).read_to_end(&mut bytes);
        bytes
    }
}

fn takes_gzip(headers: &HeaderMap) -> bool {
    let accepted = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    accepted.flat_map(|value| value.split(',')).any(|coding| {
        let (name, weight) = coding.split_once(';').unwrap_or((coding, ""));
        name.trim().eq_ignore_ascii_case("gzip") && !matches!(weight.trim(), "q=0" | "q=0.0")
    })
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("json" | "map") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("webp") => "image/webp",
        Some("txt" | "md") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(accepted: &'static str) -> HeaderMap {
        HeaderMap::from_iter([(header::ACCEPT_ENCODING, HeaderValue::from_static(accepted))])
    }

    #[test]
    fn packed_bytes_go_only_to_clients_that_accept_them() {
        assert!(["gzip", "deflate, GZIP;q=0.5, br", "br , gzip"].map(headers).iter().all(takes_gzip));
        assert!(!["", "br", "gzip;q=0", "xgzip"].map(headers).iter().any(takes_gzip));
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        std::io::Write::write_all(&mut packer, b"body {}").unwrap();
        let packed: &'static [u8] = packer.finish().unwrap().leak();
        let asset = Asset { name: "a.css", tag: "\"1\"", packed };
        assert_eq!(asset.unpacked(), b"body {}");
        let whole = asset.answer(&headers("br"));
        assert!(whole.headers().get(header::CONTENT_ENCODING).is_none());
        assert_eq!(whole.headers()[header::CONTENT_TYPE], "text/css; charset=utf-8");
        assert_eq!(asset.answer(&headers("gzip")).headers()[header::CONTENT_ENCODING], "gzip");
        let known = HeaderMap::from_iter([(header::IF_NONE_MATCH, HeaderValue::from_static("\"1\""))]);
        assert_eq!(asset.answer(&known).status(), StatusCode::NOT_MODIFIED);
    }
}
