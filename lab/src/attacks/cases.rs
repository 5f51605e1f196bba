//! HTTP requests that a server and a proxy in front of it may parse differently (request smuggling).
//!
//! The obfuscations of `Transfer-Encoding` and `Content-Length` have the names of PortSwigger's http-request-smuggler
//! (`DesyncBox.java`, for HTTP/1.1). The rest follows RFC 9112 and the categories of narfindustries' http-garden and
//! nodejs' llhttp. All cases were written anew for this project.

/// The expected answers to a request with [`SMUGGLED`] after or inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// No answer or one refusal, after which the connection is closed.
    Refused,
    /// One answer, and none to the smuggled request.
    Once,
    /// Two answers, because it is unambiguous where the second request starts.
    Both,
}
use Expectation::{Both, Once, Refused};

#[derive(Clone, Debug)]
pub struct Case {
    pub name: String,
    pub bytes: Vec<u8>,
    pub expected: Expectation,
}

/// The smuggled request. Its answer differs from the answer to [`POST`].
pub const SMUGGLED: &[u8] = b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";

const POST: &[u8] = b"POST /token HTTP/1.1\r\nHost: localhost\r\n";

pub fn all() -> Vec<Case> {
    let mut all = transfer_encodings();
    all.extend(special_bytes());
    for (name, line, expected) in CONTENT_LENGTHS {
        all.push(case(&format!("length: {name}"), expected, &[POST, line, b"\r\n\r\nhello", SMUGGLED]));
    }
    let chunked = b"Transfer-Encoding: chunked\r\n\r\n";
    for (name, body, expected) in CHUNKS {
        all.push(case(&format!("chunk: {name}"), expected, &[POST, chunked, body, SMUGGLED]));
    }
    for (name, head, expected) in HEADS {
        all.push(case(&format!("head: {name}"), expected, &[head, SMUGGLED]));
    }
    let long = [b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nX: ", "x".repeat(1 << 17).as_bytes()].concat();
    all.push(case("head: 128 KiB", Refused, &[&long, b"\r\n\r\n", SMUGGLED]));
    let many = [b"GET /home.json HTTP/1.1\r\nHost: localhost\r\n", "X: y\r\n".repeat(500).as_bytes()].concat();
    all.push(case("head: 500 lines", Refused, &[&many, b"\r\n", SMUGGLED]));
    all
}

fn case(name: &str, expected: Expectation, bytes: &[&[u8]]) -> Case {
    Case { name: name.to_owned(), bytes: bytes.concat(), expected }
}

/// Two requests with both lengths. In CL.TE the content length includes the smuggled request, and the chunks end
/// before it. In TE.CL the chunks include the smuggled request, and the content length ends before it.
fn both_lengths(name: &str, line: &[u8], expected: Expectation) -> [Case; 2] {
    let ended = [b"0\r\n\r\n", SMUGGLED].concat();
    let size = format!("{:x}\r\n", SMUGGLED.len());
    let chunk = [size.as_bytes(), SMUGGLED, b"\r\n0\r\n\r\n"].concat();
    let of = |length: usize| format!("\r\nContent-Length: {length}\r\n\r\n").into_bytes();
    [
        case(&format!("CL.TE: {name}"), expected, &[POST, line, &of(ended.len()), &ended]),
        case(&format!("TE.CL: {name}"), expected, &[POST, line, &of(size.len()), &chunk]),
    ]
}

fn transfer_encodings() -> Vec<Case> {
    let both = TRANSFER_ENCODINGS.iter().flat_map(|(name, line, expected)| both_lengths(name, line, *expected));
    // these lines are headers without an effect, so that only the content length counts
    let other = OTHER_HEADERS.iter().map(|(name, line)| {
        let [of_length, _] = both_lengths(name, line, Once);
        of_length
    });
    both.chain(other).collect()
}

/// Bytes that some parsers treat as white space or ignore.
const SPECIAL: [u8; 14] = [0, 1, 4, 8, 9, 11, 12, 13, 28, 31, 32, 127, 160, 255];

/// Requests with each of the [`SPECIAL`] bytes around the header's name and value.
fn special_bytes() -> Vec<Case> {
    let places = SPECIAL.iter().flat_map(|byte| {
        let in_value = if matches!(byte, b' ' | b'\t') { Once } else { Refused };
        let lines = [
            ("spacefix1", [b"Transfer-Encoding:".as_slice(), &[*byte], b"chunked"].concat(), in_value),
            ("prefix1", [b"Transfer-Encoding: ".as_slice(), &[*byte], b"chunked"].concat(), in_value),
            ("suffix1", [b"Transfer-Encoding: chunked".as_slice(), &[*byte]].concat(), in_value),
            ("namesuffix1", [b"Transfer-Encoding".as_slice(), &[*byte], b": chunked"].concat(), Refused),
        ];
        lines.map(|(place, line, expected)| both_lengths(&format!("{place}:{byte}"), &line, expected))
    });
    places.flatten().collect()
}

const TRANSFER_ENCODINGS: [(&str, &[u8], Expectation); 40] = [
    ("vanilla", b"Transfer-Encoding: chunked", Once),
    ("connection", b"Connection: Transfer-Encoding\r\nTransfer-Encoding: chunked", Once),
    ("valueprefix1", b"Transfer-Encoding:  chunked", Once),
    ("nospace1", b"Transfer-Encoding:chunked", Once),
    ("multiCase", b"tRANSFER-ENCODING: chunked", Once),
    ("UPPERCASE", b"TRANSFER-ENCODING: CHUNKED", Once),
    ("tabsuffix", b"Transfer-Encoding: chunked\t", Once),
    // a line may end with LF alone (RFC 9112, 2.2), which makes this a header of its own
    ("badsetupLF", b"Foo: bar\nTransfer-Encoding: chunked", Once),
    ("space1", b"Transfer-Encoding : chunked", Refused),
    ("spacejoin1", b"Transfer Encoding: chunked", Refused),
    ("nameprefix1", b"Foo: bar\r\n Transfer-Encoding: chunked", Refused),
    ("nameprefix2", b"Foo: bar\r\n\tTransfer-Encoding: chunked", Refused),
    ("linewrapped1", b"Transfer-Encoding:\n chunked", Refused),
    ("doublewrapped", b"Transfer-Encoding:\r\n \r\n chunked", Refused),
    ("gareth1", b"Transfer-Encoding\n : chunked", Refused),
    ("badsetupCR", b"Foo: bar\rTransfer-Encoding: chunked", Refused),
    ("vertwrap", b"Transfer-Encoding: \n\x0bchunked", Refused),
    ("tabwrap", b"Transfer-Encoding: \r\n\tchunked", Refused),
    ("0dwrap", b"Foo: bar\r\n\rTransfer-Encoding: chunked", Refused),
    ("0dspam", b"Tra\rnsfer-Encoding: chunked", Refused),
    ("0dsuffix", b"Transfer-Encoding: chunked\r", Refused),
    ("spjunk", b"Transfer-Encoding x: chunked", Refused),
    ("backslash", b"Transfer\\Encoding: chunked", Refused),
    ("nel", b"Transfer-Encoding\xc2\x85: chunked", Refused),
    ("nbsp", b"Transfer-Encoding\xc2\xa0: chunked", Refused),
    ("shy", b"Transfer\xc2\xadEncoding: chunked", Refused),
    ("shy2", b"Transfer-Encoding\xc2\xad: chunked", Refused),
    ("spaceFF", b"Transfer-Encoding:\xffchunked", Refused),
    ("unispace", b"Transfer-Encoding:\xa0chunked", Refused),
    ("accentTE", b"Transf\x82r-Encoding: chunked", Refused),
    ("accentCH", b"Transfer-Encoding: ch\x96nked", Refused),
    ("commaCow", b"Transfer-Encoding: chunked, identity", Refused),
    ("dualchunk", b"Transfer-Encoding: chunked\r\nTransfer-encoding: identity", Refused),
    ("nested", b"Transfer-Encoding: identity, chunked, identity", Refused),
    ("quoted", b"Transfer-Encoding: \"chunked\"", Refused),
    ("aposed", b"Transfer-Encoding: 'chunked'", Refused),
    ("lazygrep", b"Transfer-Encoding: chunk", Refused),
    ("qencode", b"Transfer-Encoding: =?iso-8859-1?B?Y2h1bmtlZA==?=", Refused),
    ("qencodeutf", b"Transfer-Encoding: =?UTF-8?B?Y2h1bmtlZA==?=", Refused),
    ("badwrap", b" Transfer-Encoding: chunked", Refused),
];

const OTHER_HEADERS: [(&str, &[u8]); 4] = [
    ("underjoin1", b"Transfer_Encoding: chunked"),
    ("contentEnc", b"Content-Encoding: chunked"),
    ("encode", b"Transfer-%45ncoding: chunked"),
    ("removed", b"Nothing-interesting: 1"),
];

const CONTENT_LENGTHS: [(&str, &[u8], Expectation); 18] = [
    ("vanilla", b"Content-Length: 5", Both),
    ("twice the same", b"Content-Length: 5\r\nContent-Length: 5", Both),
    ("CL-pad", b"Content-Length: 05", Both),
    ("CL-bigpad", b"Content-Length: 000000000005", Both),
    ("twice", b"Content-Length: 5\r\nContent-Length: 0", Refused),
    ("twice, the other way round", b"Content-Length: 0\r\nContent-Length: 5", Refused),
    ("CL-plus", b"Content-Length: +5", Refused),
    ("CL-minus", b"Content-Length: -5", Refused),
    ("CL-spacepad", b"Content-Length: 0 5", Refused),
    ("CL-e", b"Content-Length: 5e0", Refused),
    ("CL-dec", b"Content-Length: 5.0", Refused),
    ("CL-commaprefix", b"Content-Length: 0, 5", Refused),
    ("CL-commasuffix", b"Content-Length: 5, 0", Refused),
    ("hexadecimal", b"Content-Length: 0x5", Refused),
    ("empty", b"Content-Length:", Refused),
    ("beyond 64 bits", b"Content-Length: 18446744073709551621", Refused),
    ("CL-error", b"X-Invalid Y: \r\nContent-Length: 5", Refused),
    ("a blank before the colon", b"Content-Length : 5", Refused),
];

const CHUNKS: [(&str, &[u8], Expectation); 20] = [
    ("whole", b"5\r\nhello\r\n0\r\n\r\n", Both),
    ("extension", b"5;a=b\r\nhello\r\n0\r\n\r\n", Both),
    ("zeros before the size", b"000005\r\nhello\r\n0\r\n\r\n", Both),
    ("trailer", b"5\r\nhello\r\n0\r\nA: b\r\n\r\n", Both),
    ("length as a trailer", b"5\r\nhello\r\n0\r\nContent-Length: 70\r\n\r\n", Both),
    ("LF in an extension", b"5;\nx\r\nhello\r\n0\r\n\r\n", Refused),
    ("CR in an extension", b"5;a\rb\r\nhello\r\n0\r\n\r\n", Refused),
    ("line end in quotes", b"5;a=\"\r\n\"\r\nhello\r\n0\r\n\r\n", Refused),
    ("LF behind the size", b"5\nhello\r\n0\r\n\r\n", Refused),
    ("LF behind the data", b"5\r\nhello\n0\r\n\r\n", Refused),
    ("CR behind the size", b"5\rhello\r\n0\r\n\r\n", Refused),
    ("no size", b"\r\nhello\r\n0\r\n\r\n", Refused),
    ("0x before the size", b"0x5\r\nhello\r\n0\r\n\r\n", Refused),
    ("plus before the size", b"+5\r\nhello\r\n0\r\n\r\n", Refused),
    ("minus before the size", b"-5\r\nhello\r\n0\r\n\r\n", Refused),
    ("blank before the size", b" 5\r\nhello\r\n0\r\n\r\n", Refused),
    ("underscore in the size", b"0_5\r\nhello\r\n0\r\n\r\n", Refused),
    ("beyond 64 bits", b"10000000000000005\r\nhello\r\n0\r\n\r\n", Refused),
    ("data longer than the size", b"5\r\nhelloXX\r\n0\r\n\r\n", Refused),
    ("any bytes for a line end", b"5\r\nhelloXX0\r\n\r\n", Refused),
];

const HEADS: [(&str, &[u8], Expectation); 33] = [
    ("pipelined", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\n\r\n", Both),
    ("empty lines before", b"\r\n\r\nGET /home.json HTTP/1.1\r\nHost: localhost\r\n\r\n", Both),
    ("LF alone", b"GET /home.json HTTP/1.1\nHost: localhost\n\n", Both),
    ("absolute form", b"GET http://localhost/home.json HTTP/1.1\r\nHost: localhost\r\n\r\n", Both),
    ("HTTP/1.0", b"GET /home.json HTTP/1.0\r\nHost: localhost\r\n\r\n", Once),
    (
        "absolute form of another host",
        b"GET http://evil.example/home.json HTTP/1.1\r\nHost: localhost\r\n\r\n",
        Refused,
    ),
    ("absolute form, another Host", b"GET http://localhost/home.json HTTP/1.1\r\nHost: evil.example\r\n\r\n", Refused),
    ("no Host", b"GET /home.json HTTP/1.1\r\n\r\n", Refused),
    ("no Host in HTTP/1.0", b"GET /home.json HTTP/1.0\r\n\r\n", Refused),
    ("two Hosts", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n", Refused),
    ("the same Host twice", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n", Refused),
    ("empty Host", b"GET /home.json HTTP/1.1\r\nHost:\r\n\r\n", Refused),
    ("two names in Host", b"GET /home.json HTTP/1.1\r\nHost: localhost, evil.example\r\n\r\n", Refused),
    ("a name before Host", b"GET /home.json HTTP/1.1\r\nHost: localhost@evil.example\r\n\r\n", Refused),
    ("a path in Host", b"GET /home.json HTTP/1.1\r\nHost: localhost/evil.example\r\n\r\n", Refused),
    ("Host behind a blank", b"GET /home.json HTTP/1.1\r\n Host: localhost\r\n\r\n", Refused),
    (
        "GET with chunks",
        b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        Refused,
    ),
    ("GET with a length", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nContent-Length: 63\r\n\r\n", Refused),
    (
        "chunks in HTTP/1.0",
        b"POST /token HTTP/1.0\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        Refused,
    ),
    ("HTTP/0.9", b"GET /home.json\r\n\r\n", Refused),
    ("HTTP/1.2", b"GET /home.json HTTP/1.2\r\nHost: localhost\r\n\r\n", Refused),
    ("HTTP/2", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", Refused),
    ("CONNECT", b"CONNECT localhost:80 HTTP/1.1\r\nHost: localhost:80\r\n\r\n", Refused),
    ("TRACE", b"TRACE / HTTP/1.1\r\nHost: localhost\r\n\r\n", Refused),
    ("OPTIONS *", b"OPTIONS * HTTP/1.1\r\nHost: localhost\r\n\r\n", Refused),
    ("tabs in the first line", b"GET\t/home.json\tHTTP/1.1\r\nHost: localhost\r\n\r\n", Refused),
    ("two blanks", b"GET  /home.json HTTP/1.1\r\nHost: localhost\r\n\r\n", Refused),
    ("a fourth word", b"GET /home.json x HTTP/1.1\r\nHost: localhost\r\n\r\n", Refused),
    ("NUL in the path", b"GET /home.json\0 HTTP/1.1\r\nHost: localhost\r\n\r\n", Refused),
    ("NUL in a header", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nX: a\0b\r\n\r\n", Refused),
    ("NUL in a name", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nX\0: a\r\n\r\n", Refused),
    ("a header without a name", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\n: a\r\n\r\n", Refused),
    ("a line without a colon", b"GET /home.json HTTP/1.1\r\nHost: localhost\r\nX\r\n\r\n", Refused),
];
