use super::*;
use drives::frame::standard;

const CLIENT: usize = 0;

fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::classic(standard(id), data).expect("up to 8 bytes")
}

/// Events up to a time.
fn events(medium: &mut Medium, until: f64) -> Vec<Event> {
    std::iter::from_fn(|| medium.next(until)).collect()
}

/// Identifiers that arrive up to a time, with the ends of the frames.
fn arrivals(medium: &mut Medium, until: f64) -> Vec<(u32, f64)> {
    let received = |event| match event {
        Event::Received { frame, time, .. } => Some((frame.raw_id(), time)),
        _ => None,
    };
    events(medium, until).into_iter().filter_map(received).collect()
}

#[test]
fn frames_occupy_the_bus_in_order_of_priority() {
    let mut medium = Medium::new(3, Some(Rate { nominal: 500e3, data: 5e6 }), 1);
    medium.enqueue(CLIENT, frame(0x300, &[0x55; 8]), 0.0);
    medium.enqueue(1, frame(0x200, &[0x55; 8]), 10e-6);
    medium.enqueue(2, frame(0x100, &[0x55; 8]), 20e-6);
    assert_eq!(arrivals(&mut medium, 100e-6), []);
    let arrived = arrivals(&mut medium, 1e-3);
    // The first frame was alone; then the lower identifier wins. 47 + 64 bits and some stuff bits take 2 us each.
    assert_eq!(arrived.iter().map(|(id, _)| *id).collect::<Vec<_>>(), [0x300, 0x100, 0x200]);
    for (index, (_, time)) in arrived.iter().enumerate() {
        let bits = time * 500e3 / (index + 1) as f64;
        assert!((111.0..120.0).contains(&bits), "{bits}");
    }
}

#[test]
fn flood_of_low_identifiers_takes_the_bus() {
    let mut medium = Medium::new(2, Some(Rate::USUAL), 1);
    medium.enqueue(1, frame(1, &[]), 1e-6);
    (0..100).for_each(|_| medium.enqueue(CLIENT, frame(0, &[0; 8]), 0.0));
    let arrived = arrivals(&mut medium, 1.0);
    assert_eq!(arrived.last().map(|(id, _)| *id), Some(1));
    assert!(arrived.last().is_some_and(|(_, time)| *time > 100.0 * 111e-6), "{:?}", arrived.last());
}

/// Both senders count 8 an attempt, all others 1. The sixteenth makes both error passive; then the frame whose bit is
/// dominant goes on, and the other one follows.
#[test]
fn equal_identifiers_collide_until_passive() {
    let mut medium = Medium::new(3, None, 1);
    medium.enqueue(1, frame(0x100, &[1]), 0.0);
    medium.enqueue(2, frame(0x100, &[0]), 0.0);
    let happened = events(&mut medium, 1.0);
    let data: Vec<_> = happened
        .iter()
        .map(|event| match event {
            Event::Received { frame, .. } => frame.data()[0],
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(data, [0, 1]);
    assert_eq!(medium.statistics.destroyed, 16);
    // 16 x 8 - 1, and 17 x 8 - 1.
    assert_eq!([1, 2].map(|node| medium.node(node).counters().0), [135, 127]);
    assert_eq!(medium.node(CLIENT).counters().1, 16 - 2);
    let collision = medium.statistics.collisions.values().next().expect("a collision");
    assert_eq!((collision.count, collision.nodes.iter().copied().collect::<Vec<_>>()), (17, vec![1, 2]));
}

#[test]
fn node_that_collides_for_long_goes_off_and_returns() {
    let mut medium = Medium::new(3, None, 1);
    let (mut off, mut back) = (Vec::new(), Vec::new());
    for round in 0..200 {
        let time = 1e-3 * f64::from(round);
        medium.enqueue(1, frame(0x100, &[1]), time);
        medium.enqueue(2, frame(0x100, &[0]), time);
        for event in events(&mut medium, time + 0.9e-3) {
            match event {
                Event::Off(node) => off.push((node, time)),
                Event::Back(node, time) => back.push((node, time)),
                Event::Received { .. } => {}
            }
        }
    }
    // The node with the recessive bit counts 8 for each collision and loses 1 with each frame. Once it is back and error
    // active, it destroys the other one's frames as well.
    assert!(off.len() > 3 && off[0].0 == 1 && off.iter().any(|(node, _)| *node == 2), "{off:?}");
    // 128 sequences of 11 bits take 1.41 ms on an idle bus.
    let silence = back[0].1 - off[0].1;
    assert!((1e-3..2.5e-3).contains(&silence), "{silence}");
}

#[test]
fn equal_frames_are_one_frame() {
    let mut medium = Medium::new(3, None, 1);
    (1..3).for_each(|node| medium.enqueue(node, frame(0x80, &[]), 0.0));
    assert_eq!(arrivals(&mut medium, 1.0).len(), 1);
    assert_eq!((medium.statistics.destroyed, medium.statistics.collisions.len(), medium.is_busy()), (0, 0, false));
}

#[test]
fn frame_without_a_receiver_waits() {
    let mut medium = Medium::new(2, None, 1);
    medium.force_off(1);
    medium.enqueue(CLIENT, frame(1, &[]), 0.0);
    // 1.41 ms until the other node is back; the client stays error passive and is never off the bus.
    let happened = events(&mut medium, 1e-2);
    assert!(matches!(happened[..], [Event::Off(1), Event::Back(1, _), Event::Received { .. }]), "{happened:?}");
    assert_eq!(medium.node(CLIENT).bus_offs, 0);
    assert!(medium.statistics.unacknowledged > 5, "{:?}", medium.statistics);
}

#[test]
fn noise_of_one_takes_its_sender_off() {
    let mut medium = Medium::new(2, None, 1);
    medium.set_noise(1, 1.0);
    medium.enqueue(1, frame(1, &[0; 8]), 0.0);
    assert!(matches!(events(&mut medium, 4e-3)[..], [Event::Off(1), ..]));
    assert_eq!(medium.statistics.destroyed, 32);
}

/// Frames of all nodes under noise: repeated frames arrive in order, none is lost and none comes twice.
#[test]
fn million_frames_under_noise_arrive() {
    let count: u32 = if std::env::var("LONG_TESTS").is_ok() { 1_000_000 } else { 30_000 };
    let mut medium = Medium::new(4, Some(Rate::USUAL), 1);
    (0..4).for_each(|node| medium.set_noise(node, 0.05));
    let mut received = [0_u32; 4];
    let mut sent = [0_u32; 4];
    let mut time = 0.0;
    while received.iter().sum::<u32>() < count {
        time += 1e-4;
        for node in 0..4 {
            if medium.node(node).waiting() < 8 && sent.iter().sum::<u32>() < count {
                medium.enqueue(node, frame(0x100 + node as u16, &sent[node].to_le_bytes()), time);
                sent[node] += 1;
            }
        }
        while let Some(event) = medium.next(time) {
            let Event::Received { frame, .. } = event else { panic!("{event:?}") };
            let node = (frame.raw_id() - 0x100) as usize;
            assert_eq!(frame.data(), received[node].to_le_bytes());
            received[node] += 1;
        }
        assert!(time < 1e3, "{received:?} of {sent:?}");
    }
    assert_eq!(received, sent);
    let share = medium.statistics.destroyed as f64 / f64::from(count);
    assert!((0.045..0.06).contains(&share), "{share}");
}
