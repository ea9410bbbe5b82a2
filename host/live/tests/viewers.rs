//! Viewers of a live view: good, stuck and hostile ones, on sockets of this machine.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use live::{Commands, Description, Live, LiveOptions, PacedLiveOptions, Sample, Watch};
use parameters::ContactState;
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Error, HandshakeError, Message, WebSocket, client};

/// Longest wait on a machine under load.
const TIMEOUT: Duration = Duration::from_secs(60);

fn page_options() -> LiveOptions {
    LiveOptions { live: Some("127.0.0.1:0".to_owned()), ..LiveOptions::default() }
}

fn view(commands: Option<Commands>) -> (Live, SocketAddr) {
    let live = Live::start(&page_options(), "test", None, commands).expect("it listens").expect("a view");
    let address = address(&live);
    (live, address)
}

/// View of runs that follow the clock at a multiple of real time.
fn view_at_speed(speed: f64) -> Live {
    let options = PacedLiveOptions { view: page_options(), live_speed: Some(speed) };
    Live::start_paced(&options, "test").expect("it listens").expect("a view")
}

fn address(live: &Live) -> SocketAddr {
    let url = live.text().split("http://").nth(1).and_then(|rest| rest.split('/').next()).expect("a URL");
    url.parse().expect("an address")
}

fn description() -> Description {
    Description { id: 1, name: "q1".to_owned(), planets: 3, ratio: 9.0, rated_torque: 8.0 }
}

fn sample(tick: u32, contact: ContactState) -> Sample {
    let time = f64::from(tick) / 20e3;
    let mut sample = Sample { gap: 1e-5, ..Sample::at(time) };
    (0..6).for_each(|_| sample.meshes.add(contact, 0.0));
    sample
}

/// Publishes a second at 20 kHz that crosses from flank to flank once.
fn publish_a_crossing(live: &Live) {
    let mut feed = live.feed(description()).expect("a feed");
    for tick in 0..20_000 {
        let contact = match tick {
            0..10_000 => ContactState::DriveSide,
            10_000..10_060 => ContactState::Separated,
            _ => ContactState::BackSide,
        };
        feed.publish(f64::from(tick) / 20e3, || sample(tick, contact));
    }
}

type Socket = WebSocket<TcpStream>;

fn connect(address: SocketAddr, path: &str, headers: &[(&'static str, &str)]) -> Result<Socket, u16> {
    let stream = TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(TIMEOUT)).expect("a limit");
    let mut request = format!("ws://{address}{path}").into_client_request().expect("a URL");
    for (name, value) in headers {
        request.headers_mut().insert(*name, value.parse().expect("a value"));
    }
    match client(request, stream) {
        Ok((socket, _)) => Ok(socket),
        Err(HandshakeError::Failure(Error::Http(response))) => Err(response.status().as_u16()),
        Err(error) => panic!("neither a socket nor a refusal: {error}"),
    }
}

fn foxglove(address: SocketAddr) -> Socket {
    connect(address, "/", &[("sec-websocket-protocol", "foxglove.websocket.v1")]).expect("Foxglove is served")
}

/// Next text. Samples may come before the answer to a request.
fn text(socket: &mut Socket) -> Value {
    loop {
        match socket.read().expect("a message") {
            Message::Text(text) => return serde_json::from_str(&text).expect("JSON"),
            Message::Binary(_) => {}
            other => panic!("a text or samples, not {other:?}"),
        }
    }
}

/// Answer to raw bytes, until the connection closes or the limit passes.
fn answer(address: SocketAddr, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(TIMEOUT)).expect("a limit");
    // The server may close before it has read all of a hostile request.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

fn page(address: SocketAddr) -> String {
    answer(address, format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n").as_bytes())
}

fn is_served(address: SocketAddr) -> bool {
    page(address).starts_with("HTTP/1.1 200 OK")
}

#[test]
fn page_is_self_contained() {
    let (_live, address) = view(None);
    let page = page(address);
    assert!(page.starts_with("HTTP/1.1 200 OK"), "{page}");
    assert!(page.contains("default-src 'none'") && page.contains("frame-ancestors 'none'"), "{page}");
    for outside in ["https://", "src=\"http", "url(", "@import", "<link rel=\"stylesheet"] {
        assert!(!page.contains(outside), "the page needs nothing from elsewhere: {outside}");
    }
}

#[test]
fn foxglove_gets_every_sample_of_a_burst() {
    let (live, address) = view(None);
    let mut socket = foxglove(address);
    assert_eq!(text(&mut socket)["op"], "serverInfo");
    // A viewer learns a source with its first batch, so a first feed announces the channel.
    let mut feed = live.feed(description()).expect("a feed");
    (0..400).for_each(|tick| feed.publish(f64::from(tick) / 20e3, || sample(tick, ContactState::DriveSide)));
    drop(feed);
    let channel = &text(&mut socket)["channels"][0];
    assert_eq!((&channel["topic"], &channel["encoding"]), (&json!("/joint/1"), &json!("cdr")));
    assert!(channel["schema"].as_str().is_some_and(|schema| schema.contains("float64 gap_m")), "{channel}");
    let subscribe = json!({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": channel["id"]}]});
    socket.send(Message::text(subscribe.to_string())).expect("sent");
    // Its answer tells that the server has read the subscription.
    socket.send(Message::text("garbage")).expect("sent");
    assert_eq!(text(&mut socket)["op"], "status");
    publish_a_crossing(&live);
    drop(live);
    let mut times = Vec::new();
    while let Ok(message) = socket.read() {
        if let Message::Binary(bytes) = message {
            assert_eq!(bytes[..5], [1, 7, 0, 0, 0]);
            // Behind the header of the protocol and that of the encoding.
            times.push(f64::from_le_bytes(bytes[17..25].try_into().expect("a number")));
        }
    }
    let count = |from: f64, to: f64| times.iter().filter(|time| (from..to).contains(*time)).count();
    assert!(times.is_sorted());
    assert_eq!(count(0.496, 0.507), 220, "full rate from 5 ms before the flank was left to 5 ms behind the landing");
    assert_eq!((count(0.0, 0.4), count(0.6, 1.0)), (400, 400));
}

#[test]
fn plotjuggler_gets_json() {
    let receiver = UdpSocket::bind("127.0.0.1:0").expect("a port");
    receiver.set_read_timeout(Some(TIMEOUT)).expect("a limit");
    let address = receiver.local_addr().expect("an address").to_string();
    let options = LiveOptions { live_udp: Some(address), ..LiveOptions::default() };
    let live = Live::start(&options, "test", None, None).expect("it sends").expect("a view");
    let mut feed = live.feed(description()).expect("a feed");
    (0..400).for_each(|tick| feed.publish(f64::from(tick) / 20e3, || sample(tick, ContactState::BackSide)));
    let mut buffer = [0; 4096];
    let length = receiver.recv(&mut buffer).expect("a datagram");
    let value: Value = serde_json::from_slice(&buffer[..length]).expect("JSON");
    let joint = &value["joint"]["1"];
    assert_eq!(joint["gap_m"].as_f64(), Some(1e-5));
    assert_eq!(joint["sun_planet_contact"], json!([-1, -1, -1]));
}

/// A view whose samples go to PlotJuggler as well.
fn view_with_udp(live_wait: bool) -> Live {
    let options = LiveOptions { live_udp: Some("127.0.0.1:9".to_owned()), live_wait, ..page_options() };
    Live::start(&options, "test", None, None).expect("it listens").expect("a view")
}

#[test]
fn plotjuggler_counts_as_no_viewer() {
    let live = view_with_udp(true);
    let page = address(&live);
    let waiting = thread::spawn(move || {
        live.wait();
        live
    });
    thread::sleep(Duration::from_millis(100));
    assert!(!waiting.is_finished(), "--live-wait waits for a viewer");
    let _viewer = connect(page, "/live", &[]).expect("the page's socket");
    drop(waiting.join().expect("no panic"));
}

/// The shortest of five ends, on a machine under load.
#[test]
fn view_without_viewer_ends_at_once() {
    let end = |_| {
        let live = view_with_udp(false);
        let begin = Instant::now();
        drop(live);
        begin.elapsed()
    };
    let shortest = (0..5).map(end).min().expect("five ends");
    assert!(shortest < Duration::from_millis(400), "{shortest:?}");
}

/// At a hundredth of real time and 20 kHz a parcel of 64 samples fills in 0.32 s; a batch has the samples of 25 ms.
#[test]
fn slow_motion_arrives_evenly() {
    let live = view_at_speed(0.01);
    let mut viewer = connect(address(&live), "/live", &[]).expect("the page's socket");
    assert_eq!(text(&mut viewer)["type"], "hello");
    let mut feed = live.feed(description()).expect("a feed");
    for tick in 0..500 {
        // A change of contact in every sample, so that viewers get all of them.
        let contact = if tick % 2 == 0 { ContactState::DriveSide } else { ContactState::Separated };
        feed.publish(f64::from(tick) / 20e3, || sample(tick, contact));
    }
    drop(feed);
    drop(live);
    let mut rows = Vec::new();
    while let Ok(message) = viewer.read() {
        if let Message::Binary(bytes) = message {
            rows.push(u32::from_le_bytes(bytes[8..12].try_into().expect("a number")));
        }
    }
    rows.sort_unstable();
    assert!(rows[rows.len() / 2] < 20, "{rows:?} samples in the batches");
}

#[test]
fn limit_excludes_own_waits_only() {
    let live = view_at_speed(1.0);
    let limit = || Watch::until(Instant::now() + Duration::from_millis(100)).beside(Some(&live));
    let wait = || live.feed(description()).expect("a feed").publish(0.3, || Sample::at(0.3));
    let first = limit();
    wait();
    assert!(!first.is_over(), "a wait for the clock is no time of the run");
    let second = limit();
    thread::sleep(Duration::from_millis(200));
    assert!(second.is_over(), "a wait before the limit was set extends it");
}

#[test]
fn stuck_viewer_slows_nobody() {
    let (live, address) = view(None);
    let stuck = connect(address, "/live", &[]).expect("the page's socket");
    let mut good = connect(address, "/live", &[]).expect("the page's socket");
    assert_eq!(text(&mut good)["type"], "hello");
    let reader = thread::spawn(move || {
        let mut rows = 0;
        while let Ok(message) = good.read() {
            if let Message::Binary(bytes) = message {
                rows += u32::from_le_bytes(bytes[8..12].try_into().expect("a number"));
            }
        }
        rows
    });
    // The samples fill every buffer between the run and the stuck viewer many times over.
    let mut feed = live.feed(description()).expect("a feed");
    let begin = Instant::now();
    let mut longest = Duration::ZERO;
    for tick in 0..4_000_000 {
        let before = Instant::now();
        feed.publish(f64::from(tick) / 20e3, || sample(tick, ContactState::DriveSide));
        longest = longest.max(before.elapsed());
        if tick % 20_000 == 0 {
            // A run at a hundred times real time, which the good viewer can follow.
            thread::sleep(Duration::from_millis(10));
        }
    }
    println!("{:?} for 200 s of samples, longest call {longest:?}", begin.elapsed());
    drop(feed);
    let ending = Instant::now();
    drop(live);
    assert!(ending.elapsed() < Duration::from_secs(20), "the end does not wait for a viewer");
    let rows = reader.join().expect("no panic");
    assert!(rows > 100_000, "the good viewer got {rows} of 200,000 samples beside the stuck one");
    drop(stuck);
}

#[test]
fn hostile_bytes_end_their_own_connection() {
    let (_live, address) = view(None);
    let long = [b"GET / HTTP/1.1\r\nHost: localhost\r\nX: ".as_slice(), &[b'a'; 100_000], b"\r\n\r\n"].concat();
    let many = format!("GET / HTTP/1.1\r\nHost: localhost\r\n{}\r\n", "A: b\r\n".repeat(500));
    for (bytes, status) in [
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03garbage\r\n\r\n".as_slice(), "400"),
        (&long, "431"),
        (many.as_bytes(), "431"),
        (b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", "403"),
        (b"POST /live HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\n\r\n{}{}", "405"),
        (b"GET / HTTP/1.1\r\n", "408"),
    ] {
        let answer = answer(address, bytes);
        // A server that closes while bytes arrive may cut its own answer off.
        assert!(answer.is_empty() || answer.starts_with(&format!("HTTP/1.1 {status}")), "{answer}");
        assert!(is_served(address));
    }
    let mut socket = connect(address, "/live", &[]).expect("the page's socket");
    assert_eq!(text(&mut socket)["type"], "hello");
    let _ = socket.send(Message::text("x".repeat(200_000)));
    assert!((0..10).any(|_| socket.read().is_err()), "a message above the limit ends the connection");
    assert!(is_served(address));
}

#[test]
fn silent_connections_make_room() {
    let (_live, address) = view(None);
    let silent: Vec<TcpStream> = (0..40).map(|_| TcpStream::connect(address).expect("it listens")).collect();
    let begin = Instant::now();
    while !is_served(address) {
        assert!(begin.elapsed() < TIMEOUT, "the places of silent connections become free");
        thread::sleep(Duration::from_millis(100));
    }
    drop(silent);
}

#[test]
fn only_own_page_commands() {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let commands: Commands = {
        let lines = lines.clone();
        Arc::new(move |line| {
            lines.lock().expect("no panic").push(line);
            Some(r#"{"time_s":1.0}"#.to_owned())
        })
    };
    let (_live, address) = view(Some(commands));
    for origin in ["http://evil.example", "http://127.0.0.1:1", "null"] {
        assert_eq!(connect(address, "/live", &[("origin", origin)]).err(), Some(403), "{origin}");
    }
    assert_eq!(connect(address, "/live", &[("host", "evil.example")]).err(), Some(403));
    // Foxglove cannot command.
    let mut reader = foxglove(address);
    reader.send(Message::text(r#"{"load_N_m": 1}"#)).expect("sent");
    assert_eq!(text(&mut reader)["op"], "serverInfo");
    assert_eq!(text(&mut reader)["op"], "status");
    assert_eq!(lines.lock().expect("no panic").len(), 0);
    let own = format!("http://{address}");
    let mut page = connect(address, "/live", &[("origin", &own)]).expect("the page's socket");
    assert_eq!(text(&mut page)["commands"], true);
    page.send(Message::text(r#"{"load_N_m": 1}"#)).expect("sent");
    assert_eq!(text(&mut page), json!({"type": "answer", "answer": {"time_s": 1.0}}));
    assert_eq!(*lines.lock().expect("no panic"), [r#"{"load_N_m": 1}"#]);
}

#[test]
fn flood_of_commands_is_slowed() {
    let commands: Commands = Arc::new(|_| Some("{}".to_owned()));
    let (_live, address) = view(Some(commands));
    let mut page = connect(address, "/live", &[]).expect("the page's socket");
    assert_eq!(text(&mut page)["type"], "hello");
    (0..400).for_each(|_| page.send(Message::text("{}")).expect("sent"));
    let begin = Instant::now();
    (0..400).for_each(|_| assert_eq!(text(&mut page)["type"], "answer"));
    assert!(begin.elapsed() > Duration::from_secs(2), "400 commands at 100 a second: {:?}", begin.elapsed());
}

#[test]
fn parallel_runs_show_one_at_a_time() {
    let (live, _) = view(None);
    let first = live.claim(description());
    assert!(first.is_some() && live.claim(description()).is_none());
    drop(first);
    assert!(live.claim(description()).is_some());
}

#[test]
fn port_in_use_names_remedy() {
    let (_live, address) = view(None);
    let options = LiveOptions { live: Some(address.to_string()), ..LiveOptions::default() };
    let refused = Live::start(&options, "test", None, None).err().expect("the port is taken");
    assert!(refused.message().contains(&address.to_string()), "{refused}");
    assert!(refused.help().is_some_and(|help| help.contains("--live=")), "{refused}");
}
