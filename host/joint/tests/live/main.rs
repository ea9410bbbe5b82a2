//! Live views of `twin`, `sim` and `hil`: figures do not depend on viewers, options are refused with their remedy, and
//! the clients of other makers read the view.

#[path = "../command/mod.rs"]
mod command;
mod node;
#[path = "../scripts/mod.rs"]
mod scripts;

use std::fs;
use std::io::{BufRead, BufReader};
use std::net::{TcpStream, UdpSocket};
use std::path::Path;
use std::process::Child;
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use command::{TIMEOUT, folder, interrupt, joint, joint_in, start, text, wait, within};
use node::Node;
use report::workspace::workspace;
use serde_json::Value;
use tungstenite::{Message, WebSocket, client};

/// Address of the page, from a line that names it.
fn address(line: &str) -> Option<String> {
    let rest = line.split_once("live:     http://")?.1;
    rest.split_once('/').map(|(address, _)| address.to_owned())
}

/// Waits for the line with the address on the output or the errors of a command.
fn announced(child: &mut Child, on_errors: bool) -> String {
    let lines: Box<dyn BufRead> = match on_errors {
        true => Box::new(BufReader::new(child.stderr.take().expect("a pipe"))),
        false => Box::new(BufReader::new(child.stdout.take().expect("a pipe"))),
    };
    let found = lines.lines().map_while(Result::ok).find_map(|line| address(&line));
    found.expect("the command names its address")
}

/// Socket of the page, behind its greeting.
fn viewer(address: &str) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(address).expect("it listens");
    let (mut socket, _) = client(format!("ws://{address}/live"), stream).expect("a socket");
    assert!(matches!(socket.read(), Ok(Message::Text(_))), "the greeting");
    socket
}

/// Viewer that connects and never reads.
fn stuck_viewer(address: &str) -> TcpStream {
    viewer(address).get_ref().try_clone().expect("a second handle")
}

/// Runs a command without a view, then with a viewer that never reads; returns the files that both wrote.
fn with_and_without(arguments: &[&str], file: &str) -> [Vec<u8>; 2] {
    let place = folder();
    let [alone, seen] = ["alone", "seen"].map(|name| place.path().join(name));
    let ended = joint(&[arguments, &["--out", text(&alone)]].concat());
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let live = ["--live=127.0.0.1:0", "--live-udp=127.0.0.1:9", "--live-wait", "--out", text(&seen)];
    let mut child = start(&[arguments, &live].concat());
    let address = announced(&mut child, true);
    let _viewer = stuck_viewer(&address);
    let ended = wait(child);
    assert_eq!(ended.code, Some(0), "{ended:?}");
    [alone, seen].map(|folder| fs::read(folder.join(file)).expect("it was written"))
}

#[test]
fn stuck_viewer_leaves_history_of_sim() {
    let [alone, seen] = with_and_without(&["sim", "q1", "--duration", "2"], "history.csv");
    assert!(alone.len() > 1_000_000 && alone == seen);
}

#[test]
fn stuck_viewer_leaves_digests_of_hil() {
    let file = workspace().join("hil/t2.toml");
    let records = with_and_without(&["hil", text(&file), "--host", "--seed", "1"], "record.json");
    let [alone, seen] = records.map(|record| {
        let record: Value = serde_json::from_slice(&record).expect("JSON");
        let runs = record["tests"][0]["runs"].as_array().expect("runs").clone();
        runs.iter().map(|run| (run["digest"].clone(), run["figures"].clone())).collect::<Vec<_>>()
    });
    assert!(alone.len() > 1 && alone == seen, "{alone:?}\n{seen:?}");
}

/// Without a client a twin is a function of its seed, whatever its pace.
#[test]
fn stuck_viewer_leaves_log_of_twin() {
    let place = folder();
    let [alone, seen] = ["alone.mcap", "seen.mcap"].map(|name| place.path().join(name));
    let arguments = |log| ["twin", "q1", "--plant", "core", "--for", "2", "--speed", "1000", "--log", log];
    let ended = joint(&arguments(text(&alone)));
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let mut child = start(&[&arguments(text(&seen))[..], &["--live=127.0.0.1:0", "--live-wait"]].concat());
    let address = announced(&mut child, false);
    let _viewer = stuck_viewer(&address);
    let ended = wait(child);
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let [alone, seen] = [alone, seen].map(|log| fs::read(log).expect("it was written"));
    assert!(alone.len() > 10_000 && alone == seen, "{} and {} bytes", alone.len(), seen.len());
}

/// PlotJuggler is no viewer; and the clock of the samples starts with the run, after the wait.
#[test]
fn twin_waits_for_viewer_beside_plotjuggler() {
    let plotjuggler = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let udp = format!("--live-udp={}", plotjuggler.local_addr().expect("an address"));
    let twin = ["twin", "q1", "--plant", "core", "--for", "0.2", "--live=127.0.0.1:0", "--live-wait", &udp];
    let mut child = start(&twin);
    let address = announced(&mut child, false);
    thread::sleep(Duration::from_millis(500));
    plotjuggler.set_nonblocking(true).expect("a socket of ours");
    let mut datagram = [0; 4096];
    assert!(plotjuggler.recv(&mut datagram).is_err(), "the run waits");
    let connected = SystemTime::now().duration_since(UNIX_EPOCH).expect("a clock").as_secs_f64();
    let _viewer = viewer(&address);
    plotjuggler.set_nonblocking(false).expect("a socket of ours");
    plotjuggler.set_read_timeout(Some(TIMEOUT)).expect("a limit");
    let length = plotjuggler.recv(&mut datagram).expect("a datagram");
    let value: Value = serde_json::from_slice(&datagram[..length]).expect("JSON");
    let first = value["timestamp"].as_f64().expect("a number");
    assert!(first >= connected, "the first sample is {} s old", connected - first);
    assert_eq!(wait(child).code, Some(0));
}

/// A run that fills the memory for the tested run is no run of the test.
#[test]
fn hil_shows_tested_run_from_memory() {
    let place = folder();
    let file = place.path().join("memory.toml");
    let test = "duration_s = 1\nsettle_s = 0.2\nseeds = [1]\nprofile = \"T2\"\n[controller]\nrivals = []\nfrom_memory = true\n";
    fs::write(&file, test).expect("room");
    let out = place.path().join("out");
    let hil = ["hil", text(&file), "--host", "--live=127.0.0.1:0", "--live-wait", "--out", text(&out)];
    let mut child = start(&hil);
    let mut viewer = viewer(&announced(&mut child, true));
    let mut shown = Vec::new();
    while let Ok(message) = viewer.read() {
        if let Message::Text(text) = message {
            let value: Value = serde_json::from_str(&text).expect("JSON");
            shown.extend(value["name"].as_str().map(str::to_owned));
        }
    }
    let ended = wait(child);
    assert_eq!(ended.code, Some(0), "{ended:?}");
    assert_eq!(shown.len(), 1, "{shown:?}");
}

#[test]
fn options_of_view_need_view() {
    for command in [&["twin"][..], &["sim"], &["hil", "q1"]] {
        joint(&[command, &["--live-network"]].concat()).refused(&["--live"]);
    }
    for command in [&["sim"][..], &["hil", "q1"]] {
        joint(&[command, &["--live-speed", "1"]].concat()).refused(&["--live"]);
    }
}

/// A view tells joints apart by their identifiers.
#[test]
fn view_refuses_joints_of_one_identifier() {
    for view in ["--live=127.0.0.1:0", "--live-udp"] {
        let ended = joint(&["twin", "--same-id", "--id", "1=q1", "--id", "1=d2", "--for", "0.1", view]);
        ended.refused(&["--same-id", "an identifier of its own"]);
    }
}

/// `joint hil` alone builds images before it runs a test.
#[test]
fn bad_address_is_refused_before_any_build() {
    let place = folder();
    let ended = joint_in(place.path(), &["hil", "--live=nowhere"]);
    ended.refused(&["--live=nowhere is no address", "127.0.0.1:8765"]);
    assert!(ended.out.is_empty() && command::contents(place.path()).is_empty(), "{ended:?}");
}

#[test]
fn network_needs_its_option() {
    for command in [&["twin", "--for", "0.1"][..], &["sim"], &["hil", text(&workspace().join("hil/t2.toml")), "--host"]]
    {
        for option in ["--live=0.0.0.0:0", "--live-udp=192.0.2.1:9870"] {
            let ended = joint(&[command, &[option]].concat());
            assert_eq!(ended.code, Some(2), "{ended:?}");
            assert!(ended.err.contains(option) && ended.err.contains("--live-network"), "{ended:?}");
        }
    }
}

#[test]
fn hil_names_what_cannot_be_shown() {
    let file = workspace().join("hil/t2.toml");
    let on_board = joint(&["hil", text(&file), "--role", "loop", "--live"]);
    assert_eq!(on_board.code, Some(2), "{on_board:?}");
    assert!(on_board.err.contains("--role observer"), "{on_board:?}");
    let of_joint = joint(&["hil", "q1", "--live"]);
    assert_eq!(of_joint.code, Some(2), "{of_joint:?}");
    assert!(of_joint.err.contains("--live is for test files"), "{of_joint:?}");
}

/// A twin in real time under a script of a client.
fn twin_under(script: &str, arguments: &[&str]) -> String {
    let node = Node::new();
    let mut child = start(&["twin", "q1", "--plant", "core", "--for", "600", "--live=127.0.0.1:0"]);
    let address = announced(&mut child, false);
    let printed = node.run(script, &[&[script_url(script, &address).as_str()], arguments].concat());
    interrupt(&child);
    let status = within(TIMEOUT, "the twin ends", || child.try_wait().expect("a child of ours"));
    assert_eq!(status.code(), Some(0));
    printed
}

fn script_url(script: &str, address: &str) -> String {
    let scheme = if script == "page.mjs" { "http" } else { "ws" };
    format!("{scheme}://{address}")
}

#[test]
#[ignore = "needs Node.js and npm with access to its registry for 15 MB of packages"]
fn foxglove_packages_read_the_view() {
    println!("{}", twin_under("foxglove.mjs", &[]));
}

/// `LIVE_SCREENSHOTS` names a folder for screenshots.
#[test]
#[ignore = "needs Chromium at /usr/bin/chromium or CHROMIUM, Node.js, and npm with access to its registry"]
fn page_works_in_chromium() {
    let folder = std::env::var("LIVE_SCREENSHOTS").ok();
    folder.iter().for_each(|folder| fs::create_dir_all(Path::new(folder)).expect("a folder"));
    println!("{}", twin_under("page.mjs", &folder.iter().map(String::as_str).collect::<Vec<_>>()));
}
