//! Samples for PlotJuggler: one JSON object a datagram, with the names of Foxglove's topics.

use std::fmt::Write as _;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

use report::contacts::families;
use report::failure::{Failure, Outcome};

use crate::sample::{LISTS, NUMBERS, Sample};
use crate::shared::Batch;
use crate::source::Source;

/// Socket to PlotJuggler.
pub struct Udp {
    socket: UdpSocket,
    text: String,
}

impl Udp {
    /// Socket that sends to an address. Nobody has to listen there.
    pub fn to(address: SocketAddr) -> Outcome<Self> {
        let open = || -> io::Result<UdpSocket> {
            let any = match (address.is_ipv4(), address.ip().is_loopback()) {
                (true, true) => Ipv4Addr::LOCALHOST.into(),
                (true, false) => Ipv4Addr::UNSPECIFIED.into(),
                (false, true) => Ipv6Addr::LOCALHOST.into(),
                (false, false) => Ipv6Addr::UNSPECIFIED.into(),
            };
            let socket = UdpSocket::bind(SocketAddr::new(any, 0))?;
            socket.connect(address)?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        };
        let socket = open().map_err(|error| {
            Failure::new(format!("cannot send to {address}: {error}")).with_help("name another --live-udp=ADDRESS")
        })?;
        Ok(Self { socket, text: String::new() })
    }

    /// Sends a batch. Datagrams that the system does not take are lost, as those that nobody receives.
    pub fn send(&mut self, batch: &Batch) {
        for sample in &batch.samples {
            self.text.clear();
            write_json(&mut self.text, &batch.source, sample);
            let _ = self.socket.send(self.text.as_bytes());
        }
    }
}

/// Writes a sample as `{"timestamp": .., "joint": {"ID": {..}}}`; a quantity that is NaN is left out,
/// null in a list.
fn write_json(text: &mut String, source: &Source, sample: &Sample) {
    let (id, planets) = (source.description.id, source.description.planets);
    let _ = write!(text, "{{\"timestamp\":{},\"joint\":{{\"{id}\":{{", source.epoch + sample.time);
    for (name, _, value) in NUMBERS {
        let value = value(sample);
        if value.is_finite() {
            let _ = write!(text, "\"{name}\":{value:e},");
        }
    }
    for (family, lists) in families(planets).iter().zip(sample.meshes.lists()) {
        for ((name, _), values) in LISTS.iter().zip(lists) {
            let _ = write!(text, "\"{family}_{name}\":[");
            for (index, value) in values.iter().enumerate() {
                let comma = if index > 0 { "," } else { "" };
                let _ = if value.is_finite() { write!(text, "{comma}{value}") } else { write!(text, "{comma}null") };
            }
            text.push_str("],");
        }
    }
    text.pop();
    text.push_str("}}}");
}

#[cfg(test)]
mod tests {
    use parameters::ContactState;
    use serde_json::Value;

    use super::*;
    use crate::source::Description;

    #[test]
    fn datagram_is_json_without_nan() {
        let description = Description { id: 3, name: "q1".to_owned(), planets: 1, ratio: 9.0, rated_torque: 8.0 };
        let mut sample = Sample { gap: 2e-5, ..Sample::at(0.5) };
        sample.meshes.add(ContactState::BackSide, -7.0);
        sample.meshes.add(ContactState::Separated, f64::NAN);
        let mut text = String::new();
        write_json(&mut text, &Source { description, number: 0, epoch: 100.0 }, &sample);
        let value: Value = serde_json::from_str(&text).expect("it is JSON");
        assert_eq!(value["timestamp"], 100.5);
        let joint = &value["joint"]["3"];
        assert_eq!(joint["gap_m"], 2e-5);
        assert_eq!(joint["motor_half_contact"][0], -1);
        assert_eq!(joint["motor_half_force_N"][0], -7);
        assert_eq!(joint["link_half_contact"][0], 0);
        assert!(joint["link_half_force_N"][0].is_null() && joint.get("wanted_rad").is_none(), "{text}");
    }
}
