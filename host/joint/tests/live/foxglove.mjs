// Foxglove's own packages read the live view at URL: server information, channel, schema and a second of messages.

import protocol from "@foxglove/ws-protocol";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import WebSocket from "ws";
import assert from "node:assert";

const { FoxgloveClient } = protocol;
const url = process.argv[2];
const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
client.on("error", (error) => {
  throw error;
});
client.on("serverInfo", (info) => assert.equal(info.name, "joint twin"));
client.on("status", (status) => assert.fail(JSON.stringify(status)));

const channel = await new Promise((found) => client.on("advertise", ([first]) => found(first)));
assert.equal(channel.topic, "/joint/1");
assert.equal(channel.schemaEncoding, "ros2msg");
const reader = new MessageReader(parse(channel.schema, { ros2: true }));
const subscription = client.subscribe(channel.id);
let count = 0,
  last = -1,
  lastStamp = 0n;
await new Promise((done) =>
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    assert.equal(subscriptionId, subscription);
    const message = reader.readMessage(data);
    assert.ok(message.time_s > last, `${message.time_s} after ${last}`);
    assert.ok(timestamp > lastStamp);
    assert.ok(Math.abs(message.gap_m) < 1e-3);
    assert.equal(message.drive_flank_m, 2 * message.half_backlash_m);
    assert.equal(message.back_flank_m, -message.drive_flank_m);
    assert.equal(message.sun_planet_contact.length, 3);
    assert.equal(message.ring_planet_force_n.length, 3);
    assert.ok([...message.sun_planet_contact].every((side) => [-1, 0, 1].includes(side)));
    [last, lastStamp] = [message.time_s, timestamp];
    if (++count === 1000) done();
  }),
);
client.unsubscribe(subscription);
client.close();
console.log(`${count} messages until ${last.toFixed(3)} s`);
