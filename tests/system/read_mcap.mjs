// SPDX-License-Identifier: Apache-2.0
// Reads an MCAP file with @mcap/core, which is not ours: index, statistics, every message; prints what is in it.
//   node read_mcap.mjs NODE_MODULES FILE
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { open } from "node:fs/promises";

const [modules, path] = process.argv.slice(2);
const { McapIndexedReader } = createRequire(`${modules}/`)("@mcap/core");
const file = await open(path);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    await file.read(bytes, 0, bytes.length, Number(offset));
    return bytes;
  },
};
const zstd = (bytes, size) =>
  new Uint8Array(execFileSync("zstd", ["-dcq"], { input: bytes, maxBuffer: Number(size) + 1024 }));
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: { zstd } });
const topics = {};
let before = 0n;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  const topic = (topics[channel.topic] ??= { messages: 0, encoding: channel.messageEncoding, schema: schema.name, bytes: 0 });
  if (message.logTime < before) throw new Error("not in order");
  before = message.logTime;
  topic.messages++;
  topic.bytes += message.data.byteLength;
  if (channel.messageEncoding === "json") JSON.parse(new TextDecoder().decode(message.data));
}
const metadata = [];
for await (const record of reader.readMetadata()) metadata.push(record.name);
const counted = Object.values(topics).reduce((sum, topic) => sum + topic.messages, 0);
if (BigInt(counted) !== reader.statistics.messageCount) throw new Error("statistics");
console.log(JSON.stringify({ messages: counted, chunks: reader.chunkIndexes.length, metadata, topics }, null, 1));
