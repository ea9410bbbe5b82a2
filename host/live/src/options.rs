//! Options of the live view, common to all commands that have one.

use std::net::{SocketAddr, ToSocketAddrs};

use clap::ArgGroup;
use report::failure::{Failure, Outcome};

use crate::pace::parse_speed;

/// Default address of page and Foxglove: the port that Foxglove offers.
const PAGE_ADDRESS: &str = "127.0.0.1:8765";
/// Default address of PlotJuggler's UDP server.
const UDP_ADDRESS: &str = "127.0.0.1:9870";

/// Group of the options that ask for a view; the other options need one of them.
const VIEW: &str = "live_view";

/// Options of the live view.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(group(ArgGroup::new(VIEW).args(["live", "live_udp"]).multiple(true)))]
pub struct LiveOptions {
    /// Live view as a page and for Foxglove [default address: 127.0.0.1:8765; port 0 lets the system choose]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, default_missing_value = PAGE_ADDRESS)]
    pub live: Option<String>,
    /// Live view for PlotJuggler's UDP server with JSON [default address: 127.0.0.1:9870]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, default_missing_value = UDP_ADDRESS)]
    pub live_udp: Option<String>,
    /// Allows --live and --live-udp addresses beyond this machine; viewers on other machines cannot command the joint
    #[arg(long, requires = VIEW)]
    pub live_network: bool,
    /// Starts the run when the first viewer has connected
    #[arg(long, requires = "live")]
    pub live_wait: bool,
}

/// Options of the live view of a run that is as fast as the machine.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct PacedLiveOptions {
    /// Live view.
    #[command(flatten)]
    pub view: LiveOptions,
    /// Slows the run under a live view to this multiple of real time [default: as fast as the machine]
    #[arg(long, value_name = "FACTOR", value_parser = parse_speed, requires = VIEW)]
    pub live_speed: Option<f64>,
}

impl LiveOptions {
    /// True if the options ask for a view.
    pub fn is_wanted(&self) -> bool {
        self.live.is_some() || self.live_udp.is_some()
    }

    /// Rejects addresses that cannot be used, before other work.
    pub fn check(&self) -> Outcome<()> {
        self.page_address()?;
        self.udp_address().map(drop)
    }

    /// Address of page and Foxglove.
    pub(crate) fn page_address(&self) -> Outcome<Option<SocketAddr>> {
        self.live.as_deref().map(|address| self.resolve("live", address, PAGE_ADDRESS)).transpose()
    }

    /// Address of PlotJuggler.
    pub(crate) fn udp_address(&self) -> Outcome<Option<SocketAddr>> {
        self.live_udp.as_deref().map(|address| self.resolve("live-udp", address, UDP_ADDRESS)).transpose()
    }

    fn resolve(&self, option: &str, text: &str, example: &str) -> Outcome<SocketAddr> {
        let found = text.to_socket_addrs().ok().and_then(|mut addresses| addresses.next());
        let address = found.ok_or_else(|| {
            Failure::new(format!("--{option}={text} is no address"))
                .with_help(format!("write an address and a port, such as --{option}={example}"))
        })?;
        if !address.ip().is_loopback() && !self.live_network {
            return Err(Failure::new(format!("--{option}={text} is an address beyond this machine")).with_help(
                format!("write --{option}={example}, or add --live-network to show the run in the network"),
            ));
        }
        Ok(address)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    fn options(address: &str, live_network: bool) -> LiveOptions {
        LiveOptions { live: Some(address.to_owned()), live_network, ..LiveOptions::default() }
    }

    #[test]
    fn loopback_address_needs_no_flag() {
        for address in ["127.0.0.1:0", "localhost:8765", "[::1]:8765"] {
            assert!(options(address, false).page_address().is_ok(), "{address}");
        }
    }

    #[test]
    fn network_address_needs_flag() {
        for address in ["0.0.0.0:8765", "192.168.1.2:8765", "[::]:8765"] {
            let refused = options(address, false).page_address().expect_err(address);
            assert!(refused.help().is_some_and(|help| help.contains("--live-network")), "{refused}");
            assert!(options(address, true).page_address().is_ok(), "{address}");
        }
    }

    #[derive(Debug, clap::Parser)]
    struct Command {
        #[command(flatten)]
        live: PacedLiveOptions,
    }

    #[test]
    fn options_without_view_are_refused() {
        let read = |words: &str| Command::try_parse_from(format!("joint {words}").trim().split(' '));
        for option in ["--live-wait", "--live-network", "--live-speed=1"] {
            let refused = read(option).expect_err(option).to_string();
            assert!(refused.contains("--live"), "{refused}");
            let given = read(&format!("--live {option}")).expect(option);
            assert!(given.live.view.is_wanted());
        }
        assert!(read("--live-udp --live-network --live-speed=1").is_ok());
        assert!(!read("").expect("no option").live.view.is_wanted());
    }

    #[test]
    fn bad_address_names_option() {
        for address in ["8765", "127.0.0.1", "127.0.0.1:99999", ""] {
            let refused = options(address, true).page_address().expect_err(address);
            assert!(refused.message().contains(&format!("--live={address}")), "{refused}");
        }
    }
}
