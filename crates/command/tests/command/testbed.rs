//! The testbed: which requests get an answer, and which answer.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream, UdpSocket};
use std::process::{Child, Command, Stdio};

/// A command that serves the page, ended when the test is.
struct Served {
    child: Child,
    port: u16,
    secret: String,
    /// The path after the secret.
    rest: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An answer: status, head in small letters, body.
type Answer = (u16, String, Vec<u8>);

impl Served {
    fn by(arguments: &[&str]) -> Served {
        let mut command = Command::new(env!("CARGO_BIN_EXE_backstop"));
        command.args(arguments).current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a command");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("output")).read_line(&mut line).expect("an address");
        let rest = line.trim().strip_prefix("http://127.0.0.1:").expect("an address of this machine");
        let mut parts = rest.splitn(3, '/').map(str::to_owned);
        let mut part = || parts.next().expect("a part of the address");
        Served { child, port: part().parse().expect("a port"), secret: part(), rest: part() }
    }

    /// The answer to a request with these lines in its head, and this body.
    fn answer(&self, begin: &str, head: &str, body: &[u8]) -> Answer {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).expect("a connection");
        let length = body.len();
        let text = format!("{begin} HTTP/1.1\r\n{head}connection: close\r\ncontent-length: {length}\r\n\r\n");
        stream.write_all(&[text.as_bytes(), body].concat()).expect("it reads");
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("an answer");
        let end = bytes.windows(4).position(|part| part == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
        let status = head.split(' ').nth(1).expect("a status").parse().expect("a number");
        (status, head, bytes[end + 4..].to_vec())
    }

    /// The same for the right host.
    fn ask(&self, method: &str, path: &str, body: &[u8]) -> Answer {
        self.answer(&format!("{method} {path}"), &format!("host: 127.0.0.1:{}\r\n", self.port), body)
    }

    /// Header and numbers of a frame.
    fn frame(&self, request: &Value) -> (Value, Vec<u8>) {
        let path = format!("/{}/frame", self.secret);
        let (status, head, body) = self.ask("POST", &path, request.to_string().as_bytes());
        assert_eq!(status, 200, "{head}");
        assert!(head.contains("content-type: application/octet-stream"));
        let length = u32::from_le_bytes(body[..4].try_into().expect("four bytes")) as usize;
        let header = serde_json::from_slice(&body[4..4 + length]).expect("JSON");
        (header, body[4 + length..].to_vec())
    }
}

#[test]
fn a_frame_comes_over_http_and_steps_add_up() {
    let served = Served::by(&["testbed", "--scene", "talk", "--threads", "2"]);
    assert_eq!(served.rest, "#scene=talk");
    let open = json!({ "commands": [{ "do": "open", "name": "talk" }], "steps": 1, "want": ["scene"] });
    let (first, numbers) = served.frame(&open);
    assert_eq!((&first["step"], &first["settings"]["threads"]), (&json!(1), &json!(2)));
    // Twelve shapes, one of them a terrain of 100,352 triangles.
    let count = |name: &str| {
        let sections = first["sections"].as_array().expect("sections");
        sections.iter().find(|section| section["name"] == name).expect("a section")["count"].as_u64()
    };
    assert_eq!(count("poses"), Some(12 * 8));
    assert!(numbers.len() > 4 * 9 * 100_352);
    let (second, _) = served.frame(&json!({ "steps": 2 }));
    assert_eq!(second["step"], 3);
    // The same steps by another command.
    let other = Served::by(&["testbed"]);
    assert_eq!(other.rest, "");
    other.frame(&open);
    assert_eq!(other.frame(&json!({ "steps": 2 })).0["hash"], second["hash"]);
    let (_, head, body) = served.ask("POST", &format!("/{}/frame", served.secret), b"no request");
    assert!(
        head.starts_with("http/1.1 200") && String::from_utf8_lossy(&body).contains("can't read the request")
    );
}

#[test]
fn nobody_else_gets_an_answer() {
    let served = Served::by(&["testbed"]);
    let secret = &served.secret;
    assert!(secret.len() == 32 && secret.bytes().all(|b| b.is_ascii_hexdigit()), "{secret}");
    let status = |begin: &str, head: &str| served.answer(begin, head, b"").0;
    let host = format!("host: 127.0.0.1:{}\r\n", served.port);
    let page = format!("GET /{secret}/");
    assert_eq!(status(&page, &host), 200);
    assert_eq!(status(&page, &format!("host: localhost:{}\r\n", served.port)), 200);
    // Without the secret, or with another one.
    let other = "0".repeat(32);
    for path in
        ["/", "/frame", "/index.html", "/favicon.ico", "//", &format!("/{other}/"), &format!("/{secret}")]
    {
        assert_eq!(status(&format!("GET {path}"), &host), 403, "{path}");
        assert_eq!(status(&format!("POST {path}"), &host), 403, "{path}");
    }
    // By a name of somebody else's that leads here, and from a page of another origin.
    for head in
        ["host: example.org\r\n".into(), "host: 127.0.0.1\r\n".into(), format!("{host}origin: null\r\n")]
    {
        assert_eq!(status(&page, &head), 403, "{head}");
    }
    assert_eq!(status(&page, &format!("{host}origin: http://example.org\r\n")), 403);
    assert_eq!(status(&page, &format!("{host}origin: http://127.0.0.1:{}\r\n", served.port)), 200);
    // Paths that do not exist, and requests by another method.
    assert_eq!(status(&format!("GET /{secret}/no.js"), &host), 404);
    assert_eq!(status(&format!("GET /{secret}/../Cargo.toml"), &host), 404);
    assert_eq!(status(&format!("GET /{secret}/frame"), &host), 405);
    assert_eq!(status(&format!("DELETE /{secret}/"), &host), 405);
    let (status, _, _) = served.ask("POST", &format!("/{secret}/frame"), &vec![b' '; (1 << 20) + 1]);
    assert_eq!(status, 400);
    // Two secrets are not the same.
    assert_ne!(Served::by(&["testbed"]).secret, *secret);
}

#[test]
fn only_this_machine_is_listened_to() {
    let served = Served::by(&["testbed"]);
    // The address by which this machine would reach another one; nothing is sent.
    let outside = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).and_then(|socket| {
        socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9))?;
        socket.local_addr()
    });
    // Without a network there is none.
    let Ok(outside) = outside.map(|address| address.ip()).inspect_err(|why| eprintln!("{why}")) else {
        return;
    };
    if !outside.is_loopback() {
        assert!(TcpStream::connect(SocketAddr::new(outside, served.port)).is_err(), "{outside}");
    }
    let port = served.port.to_string();
    let second = Command::new(env!("CARGO_BIN_EXE_backstop")).args(["testbed", "--port", &port]).output();
    let second = second.expect("a command");
    let errors = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(1), "{errors}");
    assert!(errors.contains(&format!("can't listen at port {port}")), "{errors}");
}

#[test]
fn a_file_is_viewed_with_the_settings_of_the_run() {
    let run = ["run", "scenes/tower.gltf", "--view", "--substeps", "6", "--dt", "1/120", "--quiet"];
    let served = Served::by(&run);
    assert_eq!(served.rest, "#scene=file");
    let open = json!({ "do": "open", "name": "file" });
    let (header, _) = served.frame(&json!({ "commands": [open], "want": ["catalogue"], "steps": 12 }));
    assert_eq!((&header["title"], &header["settings"]["substeps"]), (&json!("tower"), &json!(6)));
    assert!((header["time"].as_f64().expect("a time") - 0.1).abs() < 1e-6);
    let first = &header["catalogue"][0];
    assert_eq!((&first["name"], &first["group"]), (&json!("file"), &json!("file")));
    assert!(first["about"].as_str().expect("a path").ends_with("tower.gltf"));
}

#[test]
fn what_can_not_be_shown_is_refused() {
    for (arguments, code, reason) in [
        (&["testbed", "--scene", "no_such"][..], 1, "no_such"),
        (&["testbed", "--port", "99999"], 2, "--port"),
        (&["run", "chain", "--view", "--json"], 2, "--json"),
        (&["run", "chain", "--view", "--record", "x"], 2, "--record"),
        (&["run", "no/such.glb", "--view"], 1, "no/such.glb"),
        (&["run", "chain", "--view", "--substeps", "99"], 1, "substeps"),
    ] {
        let output =
            Command::new(env!("CARGO_BIN_EXE_backstop")).args(arguments).output().expect("a command");
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{errors}");
        assert!(errors.contains(reason) && output.stdout.is_empty(), "{errors}");
    }
}

/// Expected: the exit code of a shell for a program that the signal ended, at once.
#[cfg(unix)]
#[test]
fn it_ends_when_it_is_asked_to() {
    let mut served = Served::by(&["testbed"]);
    served.frame(&json!({ "commands": [{ "do": "open", "name": "talk" }] }));
    let sent = Command::new("kill").args(["-INT", &served.child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
    assert_eq!(served.child.wait().expect("its end").code(), Some(130));
}
