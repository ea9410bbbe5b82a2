//! The live view of one command: its threads, its feeds, its end.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;

use crate::feed::Feed;
use crate::hub::{Hub, PARCELS, Parcel};
use crate::options::{LiveOptions, PacedLiveOptions};
use crate::server::Server;
use crate::shared::{Commands, Shared};
use crate::source::{Description, Source};
use crate::udp::Udp;

/// Time that the viewers have to read the end of the run.
const FAREWELL: Duration = Duration::from_millis(500);
/// Interval of the checks while the view waits.
const POLL: Duration = Duration::from_millis(10);

/// Live view of one command.
pub struct Live {
    hub: Option<SyncSender<Parcel>>,
    thread: JoinHandle<()>,
    server: Option<Server>,
    shared: Arc<Shared>,
    speed: Option<f64>,
    waits_for_viewer: bool,
    text: String,
}

impl Live {
    /// Starts the view that the options ask for; `None` if they ask for no view. `title` is shown to viewers, `speed`
    /// makes runs follow the clock, `commands` carries out the commands of the page.
    pub fn start(
        options: &LiveOptions,
        title: &str,
        speed: Option<f64>,
        commands: Option<Commands>,
    ) -> Outcome<Option<Self>> {
        if !options.is_wanted() {
            return Ok(None);
        }
        let (page, udp_address) = (options.page_address()?, options.udp_address()?);
        let shared = Arc::new(Shared::default());
        let server = page.map(|address| Server::listen(address, title, &shared, commands)).transpose()?;
        let udp = udp_address.map(Udp::to).transpose()?;
        shared.has_udp.store(udp.is_some(), Ordering::Relaxed);
        let mut text = String::new();
        if let Some(server) = &server {
            text += &format!("live:     {} (Foxglove: {})\n", server.url("http"), server.url("ws"));
        }
        if let Some(address) = udp_address {
            text += &format!("live-udp: {address}\n");
        }
        let (sender, parcels) = sync_channel(PARCELS);
        let hub = Hub::new(parcels, shared.clone(), udp);
        let thread = thread::Builder::new()
            .name("live".to_owned())
            .spawn(move || hub.run())
            .map_err(|error| Failure::new(format!("cannot start the live view: {error}")))?;
        let waits_for_viewer = options.live_wait;
        Ok(Some(Self { hub: Some(sender), thread, server, shared, speed, waits_for_viewer, text }))
    }

    /// Starts the view of runs that are as fast as the machine without one.
    pub fn start_paced(options: &PacedLiveOptions, title: &str) -> Outcome<Option<Self>> {
        Self::start(&options.view, title, options.live_speed, None)
    }

    /// Prints the addresses of the view, and waits for a viewer if the options say so.
    pub fn announce(&self, progress: &Progress) {
        self.text.lines().for_each(|line| progress.print_message(line));
        if self.waits_for_viewer {
            progress.stage("waiting for a viewer");
            self.wait();
            progress.clear();
        }
    }

    /// Addresses of the view, a line each.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Waits, if the options say so, until the first viewer has connected or the user ends the command.
    pub fn wait(&self) {
        while self.waits_for_viewer && !self.shared.has_viewer() && !interruption::requested() {
            thread::sleep(POLL);
        }
    }

    /// Feed of a source that begins now.
    pub fn feed(&self, description: Description) -> Option<Feed> {
        self.open(description, false)
    }

    /// Feed of a run, unless the view shows another run: of runs in parallel, viewers see one at a time.
    pub fn claim(&self, description: Description) -> Option<Feed> {
        let is_free = !self.shared.is_claimed.swap(true, Ordering::Acquire);
        if is_free { self.open(description, true) } else { None }
    }

    fn open(&self, description: Description, is_claim: bool) -> Option<Feed> {
        let number = self.shared.sources.fetch_add(1, Ordering::Relaxed);
        let source = Arc::new(Source::starting(description, number));
        let hub = self.hub.as_ref()?;
        Some(Feed::new(source, hub.clone(), self.shared.clone(), self.speed, is_claim))
    }

    /// Time that runs have waited for the clock; a limit on the time of a run does not count it.
    pub fn waited(&self) -> Duration {
        self.shared.waited()
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.hub = None;
        let end = Instant::now() + FAREWELL;
        let is_open = || !self.thread.is_finished() || self.shared.has_viewer();
        while is_open() && Instant::now() < end {
            thread::sleep(POLL);
        }
        if let Some(server) = &self.server {
            server.end(end);
        }
    }
}
