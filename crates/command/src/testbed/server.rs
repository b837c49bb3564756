//! The testbed over HTTP, for the user of this machine alone: on the loopback address, and under a secret
//! part of the path that no other page knows.

use anyhow::{Context, bail};
use backstop_testbed::page;
use oxhttp::Server;
use oxhttp::model::header::{self, HeaderName};
use oxhttp::model::{Body, Method, Request, Response, StatusCode};
use std::io::Read;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};

/// Bytes of the largest request for a frame.
const LARGEST: u64 = 1 << 20;
/// Connections at once: a browser opens six.
const CONNECTIONS: usize = 32;
/// Bytes of the secret.
const SECRET: usize = 16;
/// Ports to try where the user asks for none: another process may take one before it is used.
const ATTEMPTS: u32 = 16;

/// Headers of every answer: no other page may read, frame or guess anything.
const HEADERS: [(HeaderName, &str); 7] = [
    (header::CACHE_CONTROL, "no-store"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CONTENT_SECURITY_POLICY, POLICY),
    // By itself a page has a clock of 5 µs; others have one of 100 µs.
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-embedder-policy"), "require-corp"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; frame-ancestors 'none'";

/// A request for a frame, and where its answer goes.
pub(crate) struct Call {
    pub(crate) json: String,
    pub(crate) answer: SyncSender<Vec<u8>>,
}

/// A server that listens.
pub(crate) struct Listening {
    /// Where the page is.
    pub(crate) address: String,
    /// Requests for frames, one after the other.
    pub(crate) calls: Receiver<Call>,
}

/// Listens at a port of the loopback address; 0 is any that is free.
pub(crate) fn listen(port: u16) -> anyhow::Result<Listening> {
    let mut bytes = [0; SECRET];
    getrandom::fill(&mut bytes).context("the system has no random numbers")?;
    let secret: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    for attempt in 1.. {
        let port = if port == 0 { free_port()? } else { port };
        let (sender, calls) = mpsc::channel();
        let gate = Gate { port, secret: secret.clone(), calls: sender };
        let server = Server::new(move |request| gate.pass(request))
            .bind((Ipv4Addr::LOCALHOST, port))
            .with_max_concurrent_connections(CONNECTIONS);
        match server.spawn() {
            // Its threads end with the process.
            Ok(_) => {
                let address = format!("http://{}:{port}/{secret}/", Ipv4Addr::LOCALHOST);
                return Ok(Listening { address, calls });
            }
            Err(_) if attempt < ATTEMPTS => {}
            Err(error) => return Err(error).with_context(|| format!("can't listen at port {port}")),
        }
    }
    bail!("can't listen at any port")
}

fn free_port() -> anyhow::Result<u16> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).context("can't listen at any port")?;
    Ok(listener.local_addr()?.port())
}

/// The address that a request must have, and the session that answers.
struct Gate {
    port: u16,
    secret: String,
    calls: Sender<Call>,
}

impl Gate {
    fn pass(&self, request: &mut Request<Body>) -> Response<Body> {
        let Some(name) = self.admitted(request) else {
            return told(StatusCode::FORBIDDEN, "this is not the address that the command printed\n");
        };
        let name = name.to_owned();
        match (request.method(), name.as_str()) {
            (&Method::POST, "frame") => self.frame(request.body_mut()),
            (_, "frame") => told(StatusCode::METHOD_NOT_ALLOWED, "a frame is asked for by POST\n"),
            (&Method::GET | &Method::HEAD, name) => match page::file(name) {
                Some(&(_, kind, bytes)) => whole(StatusCode::OK, kind, bytes.to_vec()),
                None => told(StatusCode::NOT_FOUND, "there is no such file\n"),
            },
            _ => told(StatusCode::METHOD_NOT_ALLOWED, "this is neither GET nor POST\n"),
        }
    }

    /// What is asked for, if the request is to this host, under the secret, and by no page of another one.
    ///
    /// A name of somebody else's that leads to this machine (DNS rebinding) is no host of ours.
    fn admitted<'a>(&self, request: &'a Request<Body>) -> Option<&'a str> {
        let text = |name| request.headers().get(name).map(|value| value.to_str().unwrap_or_default());
        let hosts = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let host = text(header::HOST)?;
        let own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        let known = hosts.iter().any(|own| own == host) && text(header::ORIGIN).is_none_or(own);
        let (secret, name) = request.uri().path().strip_prefix('/')?.split_once('/')?;
        (known && same(secret, &self.secret)).then_some(name)
    }

    fn frame(&self, body: &mut Body) -> Response<Body> {
        let mut json = String::new();
        // One byte more, to know.
        let read = body.take(LARGEST + 1).read_to_string(&mut json);
        if read.is_err() || json.len() as u64 > LARGEST {
            return told(StatusCode::BAD_REQUEST, "a request for a frame is at most 1 MiB of JSON\n");
        }
        let (answer, frame) = mpsc::sync_channel(1);
        let asked = self.calls.send(Call { json, answer });
        match asked.ok().and_then(|()| frame.recv().ok()) {
            Some(frame) => whole(StatusCode::OK, "application/octet-stream", frame),
            None => told(StatusCode::SERVICE_UNAVAILABLE, "the testbed has ended\n"),
        }
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

fn told(status: StatusCode, text: &str) -> Response<Body> {
    whole(status, "text/plain; charset=utf-8", text.as_bytes().to_vec())
}

fn whole(status: StatusCode, kind: &str, bytes: Vec<u8>) -> Response<Body> {
    let mut response = Response::builder().status(status).header(header::CONTENT_TYPE, kind);
    for (name, value) in HEADERS {
        response = response.header(name, value);
    }
    response.body(Body::from(bytes)).unwrap_or_else(|_| {
        // Not with the names and values above.
        let mut empty = Response::new(Body::empty());
        *empty.status_mut() = StatusCode::INTERNAL_SERVER_ERROR;
        empty
    })
}
