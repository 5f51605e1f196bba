//! The protection of the server: each rule of docs/serve.md is tested with a request that breaks it.

use super::{LONG, TestServer, Watch};
use crate::harness::Bench;
use serde_json::json;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};
use tungstenite::Message;
use tungstenite::protocol::CloseFrame;
use tungstenite::protocol::frame::coding::CloseCode;

fn code(answer: &str) -> u16 {
    let status = answer.strip_prefix("HTTP/1.1 ").and_then(|rest| rest.get(..3));
    status.and_then(|status| status.parse().ok()).unwrap_or_else(|| panic!("no status in {answer:?}"))
}

const UPGRADE: &str = "connection: upgrade\r\nupgrade: websocket\r\nsec-websocket-version: 13\r\n\
    sec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

#[test]
fn only_its_own_page_under_its_own_name_gets_in() {
    let served = TestServer::start(&Bench::new(), "");
    let own = format!("origin: http://localhost:{}\r\n", served.port);
    for path in ["/home.json", "/metrics"] {
        assert_eq!(code(&served.ask(&format!("GET {path}"), &own, "")), 200, "{path}");
    }
    for path in ["/", "/home.json", "/metrics", "/ws"] {
        let get = format!("GET {path}");
        // a name of another site for this machine (DNS rebinding), and requests from pages of other sites
        assert_eq!(code(&served.ask(&get, "host: evil.example\r\n", "")), 421, "{path}");
        assert_eq!(code(&served.ask(&get, "origin: http://evil.example\r\n", "")), 403, "{path}");
        assert_eq!(code(&served.ask(&get, "sec-fetch-site: cross-site\r\n", "")), 403, "{path}");
    }
    assert_eq!(code(&served.get("http://evil.example/metrics")), 421, "the request line goes before the header");
    assert_eq!(code(&served.ask("POST /token", "origin: http://evil.example\r\n", "x")), 403);
    assert_eq!(code(&served.raw(b"GET / HTTP/1.1\r\nconnection: close\r\n\r\n")), 421);
    // a WebSocket from a page of another site
    for foreign in ["http://evil.example", "null", "http://localhost:1"] {
        assert!(served.watch_with(&[("origin", foreign)]).is_err(), "{foreign}");
    }
    let own = format!("http://127.0.0.1:{}", served.port);
    assert!(served.watch_with(&[("origin", &own)]).is_ok());
}

#[test]
fn every_answer_carries_the_policy() {
    let served = TestServer::start(&Bench::new(), "");
    let answers = [
        served.get("/"),
        served.get("/nothing"),
        served.get("/home.json"),
        served.get("/metrics"),
        served.ask("DELETE /", "", ""),
        served.ask("GET /", "host: evil.example\r\n", ""),
    ];
    for answer in answers {
        for line in [
            "content-security-policy: default-src 'none'; ",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
        ] {
            assert!(answer.contains(&format!("\r\n{line}")), "{line}\n{answer}");
        }
        let policy = answer.lines().find(|line| line.starts_with("content-security-policy")).expect("a policy");
        assert!(policy.contains("frame-ancestors 'none'") && policy.contains("script-src 'self'"), "{policy}");
        assert!(!policy.contains("unsafe-inline") && !policy.contains("'unsafe-eval'"), "{policy}");
    }
    assert!(served.get("/home.json").ends_with("{\"home\":\"served\",\"token_needed\":false}"));
}

#[test]
fn no_path_leads_to_a_file() {
    let bench = Bench::new();
    bench.write("secret.txt", "hidden");
    let served = TestServer::start(&bench, "");
    let paths = [
        "/../../../../../../etc/passwd",
        "/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/secret.txt",
        "/./secret.txt",
        "/..%5csecret.txt",
        "/README.md",
        "/%00",
    ];
    let absolute = format!("http://localhost:{}/etc/passwd", served.port);
    for path in paths.into_iter().chain([&*absolute]) {
        let answer = served.get(path);
        assert!(!answer.contains("root:") && !answer.contains("hidden"), "{path}\n{answer}");
        assert!([400, 404].contains(&code(&answer)), "{path}\n{answer}");
    }
}

#[test]
fn large_requests_are_refused() {
    let served = TestServer::start(&Bench::new(), "");
    let long = format!("GET / HTTP/1.1\r\nhost: localhost\r\nx: {}\r\n\r\n", "y".repeat(1 << 20));
    let many = format!("GET / HTTP/1.1\r\nhost: localhost\r\n{}\r\n", "x: y\r\n".repeat(1000));
    for request in [long, many] {
        let answer = served.raw(request.as_bytes());
        assert!(answer.is_empty() || [400, 431].contains(&code(&answer)), "{answer}");
    }
    assert_eq!(code(&served.ask("GET /home.json", "", "body")), 413);
    assert_eq!(code(&served.ask("POST /token", "", &"x".repeat(1 << 16))), 413);
    let chunked = "POST /token HTTP/1.1\r\nhost: localhost\r\ntransfer-encoding: chunked\r\n\r\n800\r\n";
    let answer = served.raw((chunked.to_owned() + &"x".repeat(0x800) + "\r\n").as_bytes());
    assert_eq!(code(&answer), 413);
    // a message of two megabytes, and one that is not text
    for message in [Message::text("x".repeat(2 << 20)), Message::binary(vec![1, 2, 3])] {
        let mut page = served.watch();
        page.frame();
        let _ = page.socket.send(message);
        let begun = Instant::now();
        while page.socket.read().is_ok() {
            assert!(begun.elapsed() < LONG, "it goes on");
        }
    }
    served.watch().frame();
}

/// The code of the close frame that ends a connection, if one comes.
fn close_code(page: &mut Watch) -> Option<u16> {
    let begun = Instant::now();
    loop {
        assert!(begun.elapsed() < LONG, "it goes on");
        match page.socket.read() {
            Ok(Message::Close(frame)) => return frame.map(|frame| frame.code.into()),
            Ok(_) => {}
            Err(_) => return None,
        }
    }
}

#[test]
fn a_page_is_told_how_its_connection_ends() {
    let served = TestServer::start(&Bench::new(), "");
    let mut leaving = served.watch();
    let frame = CloseFrame { code: CloseCode::Normal, reason: "done".into() };
    leaving.socket.close(Some(frame)).expect("it is sent");
    assert_eq!(close_code(&mut leaving), Some(1000), "the answer to a close frame");
    // first byte of a frame with FIN, masked length, mask, content
    let broken: [(&[u8], u16); 4] = [
        (&[0x82, 0x81, 0, 0, 0, 0, 7], 1003),
        (&[0x81, 0x81, 0, 0, 0, 0, 0xff], 1007),
        (&[0xc1, 0x81, 0, 0, 0, 0, b'x'], 1002),
        (&[0x81, 0xff, 0, 0, 0, 0, 0x7f, 0, 0, 0, 0, 0, 0, 0], 1009),
    ];
    for (bytes, code) in broken {
        let mut page = served.watch();
        page.socket.get_mut().write_all(bytes).expect("it is sent");
        assert_eq!(close_code(&mut page), Some(code), "{bytes:x?}");
    }
}

/// The test checks shortest times only, so it does not fail on a slow machine.
#[test]
fn frequent_requests_wait_or_are_refused() {
    let served = TestServer::start(&Bench::new(), "");
    let request = format!("GET /home.json HTTP/1.1\r\nhost: localhost:{}\r\n\r\n", served.port);
    let answers = served.raw(request.repeat(150).as_bytes());
    assert!(answers.contains("HTTP/1.1 200") && answers.contains("HTTP/1.1 429"), "{}", answers.len());
    let mut page = served.watch();
    let begun = Instant::now();
    for id in 0..70 {
        assert_eq!(page.ask(&json!({"id": id, "do": "zero-angle"}))["id"], id);
    }
    assert!(begun.elapsed() >= Duration::from_millis(1300), "{:?} for 40 at once and 20 a second", begun.elapsed());
}

#[test]
fn a_stalled_client_is_disconnected() {
    let served = TestServer::start(&Bench::new(), "");
    let begin = |bytes: &[u8]| {
        let mut stream = served.connect();
        stream.write_all(bytes).expect("it is sent");
        stream
    };
    let token = b"POST /token HTTP/1.1\r\nhost: localhost\r\ncontent-length: 32\r\n\r\n0123";
    let slow: Vec<TcpStream> = [&b""[..], b"GET / HT", b"GET / HTTP/1.1\r\nhost: local", token].map(begin).into();
    for mut stream in slow {
        let mut rest = Vec::new();
        let begun = Instant::now();
        let ended = stream.read_to_end(&mut rest);
        assert!(ended.is_ok() && begun.elapsed() < LONG / 2, "{ended:?} {}", String::from_utf8_lossy(&rest));
    }
}

#[test]
fn connections_are_limited() {
    let bench = Bench::new();
    bench.zerorate("capture --samples 100 -o short.arrows").ok();
    // a replay that has ended sends no frames, so a viewer that reads none stays connected
    let served = TestServer::start(&bench, "--device replay:short.arrows");
    let pages: Vec<_> = (0..48).map(|_| served.watch()).collect();
    assert!(served.watch_with(&[]).is_err(), "too many viewers");
    let begun = Instant::now();
    // the server closes idle connections, on a slow machine before the last connection is open
    let others = loop {
        let others: Vec<TcpStream> = (0..60).map(|_| served.connect()).collect();
        if code(&served.get("/home.json")) == 503 {
            break others;
        }
        assert!(begun.elapsed() < LONG, "room for all");
    };
    drop((pages, others));
    while served.watch_with(&[]).is_err() {
        assert!(begun.elapsed() < LONG, "there is room again");
        thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn network_clients_need_the_token() {
    let served = TestServer::at(&Bench::new(), "0.0.0.0", "");
    let (url, token) = served.url.split_once("#token=").expect("a token");
    assert!(token.len() == 32 && !url.contains('?'), "{url}");
    assert!(served.get("/home.json").ends_with("\"token_needed\":true}"));
    for path in ["/metrics".to_owned(), format!("/metrics?token={token}"), "/ws".to_owned()] {
        assert_eq!(code(&served.ask(&format!("GET {path}"), UPGRADE, "")), 401, "{path}");
    }
    let refused = served.watch_with(&[("cookie", &format!("zerorate_{}=x", served.port))]);
    assert!(refused.is_err());
    assert_eq!(code(&served.ask("POST /token", "", "0123456789abcdef0123456789abcdef")), 403);
    let given = served.ask("POST /token", "", token);
    assert_eq!(code(&given), 204);
    let cookie = given.lines().find_map(|line| line.strip_prefix("set-cookie: ")).expect("a cookie");
    assert!(cookie.contains("; HttpOnly") && cookie.contains("; SameSite=Strict"), "{cookie}");
    let cookie = cookie.split(';').next().expect("a value");
    served.watch_with(&[("cookie", cookie)]).expect("a WebSocket").frame();
    let bearer = format!("authorization: Bearer {token}\r\n");
    assert_eq!(code(&served.ask("GET /metrics", &bearer, "")), 200);
    let with_cookie = served.ask("GET /home.json", &format!("cookie: {cookie}\r\n"), "");
    assert!(with_cookie.ends_with("\"token_needed\":false}"));
    // a client that tries many tokens is slowed down, wherever it shows them
    let bearer_of = |k: u32| format!("authorization: Bearer {k:032}\r\n");
    assert!((0..50).any(|k| code(&served.ask("GET /metrics", &bearer_of(k), "")) == 429));
    assert!((50..100).any(|k| code(&served.ask("POST /token", "", &format!("{k:032}"))) == 429));
    let cookie_of = |k: u32| format!("cookie: zerorate_{}={k:032}\r\n{UPGRADE}", served.port);
    assert!((100..150).any(|k| code(&served.ask("GET /ws", &cookie_of(k), "")) == 429));
    assert_eq!(served.said().try_iter().filter(|line| line.contains(token)).count(), 0, "it is printed once");
}

#[test]
fn a_token_of_ones_own_can_be_given() {
    let bench = Bench::new();
    bench.write("token", "correcthorsebattery\n");
    let served = TestServer::start(&bench, "--token-file token --host bench.local");
    assert!(served.url.ends_with("/ with the token of token"), "{}", served.url);
    assert_eq!(code(&served.ask("GET /metrics", "host: bench.local:80\r\n", "")), 401);
    let bearer = "host: bench.local:80\r\nauthorization: Bearer correcthorsebattery\r\n";
    assert_eq!(code(&served.ask("GET /metrics", bearer, "")), 200);
    let said: Vec<String> = served.said().try_iter().collect();
    assert!(!said.concat().contains("correcthorsebattery"), "a service's journal is read by others: {said:?}");
    bench.write("weak", "1234\n");
    bench.zerorate("serve --listen 127.0.0.1:0 --token-file weak").fails(2, &["16 to 256"]);
}
