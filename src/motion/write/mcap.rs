//! Moves as an MCAP log: joint states over time, as Foxglove and its like open them.
//!
//! The container is written here, after its specification (mcap.dev/spec): records are an opcode, a length and content, all
//! little-endian; messages lie in chunks, and a summary tells where. The `mcap` crate, which the tests read it with, would bring a dozen others for this one page.
//! Checksums are 0, which the specification has for those that are not given.

use serde::Serialize;

use super::{Waypoints, seconds_and_nanoseconds};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Opcodes of records.
mod op {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const CHUNK_INDEX: u8 = 0x08;
    pub const STATISTICS: u8 = 0x0B;
    pub const SUMMARY_OFFSET: u8 = 0x0E;
    pub const DATA_END: u8 = 0x0F;
}

/// The one schema and the one channel.
const ID: u16 = 1;

/// A chunk is closed when it holds as many bytes: readers take them whole.
const CHUNK: usize = 1 << 20;

/// Where viewers look for the joints of a robot.
const TOPIC: &str = "/joint_states";

/// Viewers know a joint state by this name, whatever its encoding.
const SCHEMA_NAME: &str = "sensor_msgs/msg/JointState";

/// JSON Schema; an object of `sec` and `nsec` titled `time` is a time to Foxglove.
const SCHEMA: &str = r#"{
  "type": "object",
  "title": "sensor_msgs/msg/JointState",
  "properties": {
    "header": {
      "type": "object",
      "properties": {
        "stamp": {
          "type": "object",
          "title": "time",
          "properties": {
            "sec": {"type": "integer", "minimum": 0},
            "nsec": {"type": "integer", "minimum": 0, "maximum": 999999999}
          }
        },
        "frame_id": {"type": "string"}
      }
    },
    "name": {"type": "array", "items": {"type": "string"}},
    "position": {"type": "array", "items": {"type": "number"}},
    "velocity": {"type": "array", "items": {"type": "number"}},
    "effort": {"type": "array", "items": {"type": "number"}}
  }
}"#;

#[derive(Serialize)]
struct JointState<'a> {
    header: Header,
    name: &'a [&'a str],
    position: &'a [f64],
    velocity: &'a [f64],
    effort: [f64; 0],
}

#[derive(Serialize)]
struct Header {
    stamp: Time,
    frame_id: &'static str,
}

#[derive(Serialize)]
struct Time {
    sec: u64,
    nsec: u64,
}

/// Bytes as they are written.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn u16(&mut self, value: u16) -> &mut Self {
        self.raw(&value.to_le_bytes())
    }

    fn u32(&mut self, value: usize) -> &mut Self {
        let value = u32::try_from(value).expect("names and chunks are far below 4 GB");
        self.raw(&value.to_le_bytes())
    }

    fn u64(&mut self, value: u64) -> &mut Self {
        self.raw(&value.to_le_bytes())
    }

    /// A length and a text.
    fn text(&mut self, text: &str) -> &mut Self {
        self.u32(text.len()).raw(text.as_bytes())
    }

    fn raw(&mut self, bytes: &[u8]) -> &mut Self {
        self.0.extend_from_slice(bytes);
        self
    }

    fn record(&mut self, opcode: u8, content: &Self) -> &mut Self {
        self.0.push(opcode);
        self.u64(content.0.len() as u64).raw(&content.0)
    }

    /// How many there are: where the next one will lie.
    fn end(&self) -> u64 {
        self.0.len() as u64
    }
}

/// Messages that lie together.
#[derive(Default)]
struct Chunk {
    records: Bytes,
    /// Time \[ns\] and place of each message.
    index: Vec<(u64, u64)>,
}

impl Chunk {
    /// Appends the chunk and the index of its messages, and what the summary says of them.
    fn close(&mut self, file: &mut Bytes, indices: &mut Bytes) {
        let (Some((first, _)), Some((last, _))) = (self.index.first(), self.index.last()) else {
            return;
        };
        let size = self.records.end();
        let mut chunk = Bytes::default();
        chunk.u64(*first).u64(*last).u64(size).u32(0).text("");
        chunk.u64(size).raw(&self.records.0);
        let start = file.end();
        file.record(op::CHUNK, &chunk);
        let index_start = file.end();

        let mut index = Bytes::default();
        index.u16(ID).u32(self.index.len() * 16);
        for (time, place) in &self.index {
            index.u64(*time).u64(*place);
        }
        file.record(op::MESSAGE_INDEX, &index);

        let mut told = Bytes::default();
        told.u64(*first)
            .u64(*last)
            .u64(start)
            .u64(index_start - start);
        told.u32(10).u16(ID).u64(index_start);
        told.u64(file.end() - index_start)
            .text("")
            .u64(size)
            .u64(size);
        indices.record(op::CHUNK_INDEX, &told);
        *self = Self::default();
    }
}

impl Waypoints {
    /// An MCAP log of joint states, uncompressed and indexed: JSON with the fields of sensor_msgs/JointState on the topic
    /// `/joint_states`, a message a waypoint, time 0 the start of the move. A viewer that has the URDF moves the robot by it.
    pub fn to_mcap(&self) -> Vec<u8> {
        let names: Vec<&str> = self.joints().iter().map(String::as_str).collect();
        let mut header = Bytes::default();
        header
            .text("")
            .text(concat!("undulate ", env!("CARGO_PKG_VERSION")));
        let mut schema = Bytes::default();
        schema
            .u16(ID)
            .text(SCHEMA_NAME)
            .text("jsonschema")
            .text(SCHEMA);
        let mut channel = Bytes::default();
        channel.u16(ID).u16(ID).text(TOPIC).text("json").u32(0);

        let mut file = Bytes(MAGIC.to_vec());
        file.record(op::HEADER, &header)
            .record(op::SCHEMA, &schema)
            .record(op::CHANNEL, &channel);
        let mut chunk_indices = Bytes::default();
        let mut chunk = Chunk::default();
        let mut chunks = 0;
        let (mut first, mut last) = (None, 0);
        for (sequence, waypoint) in self.iter().enumerate() {
            let (sec, nsec) = seconds_and_nanoseconds(waypoint.time);
            last = sec * super::NANO as u64 + nsec;
            first.get_or_insert(last);
            let state = JointState {
                header: Header {
                    stamp: Time { sec, nsec },
                    frame_id: "",
                },
                name: &names,
                position: waypoint.positions,
                velocity: waypoint.velocities.unwrap_or(&[]),
                effort: [],
            };
            let data =
                serde_json::to_vec(&state).expect("strings and finite numbers have a JSON form");
            let mut message = Bytes::default();
            message.u16(ID).u32(sequence).u64(last).u64(last).raw(&data);
            chunk.index.push((last, chunk.records.end()));
            chunk.records.record(op::MESSAGE, &message);
            if chunk.records.0.len() >= CHUNK || sequence + 1 == self.len() {
                chunk.close(&mut file, &mut chunk_indices);
                chunks += 1;
            }
        }
        let mut data_end = Bytes::default();
        file.record(op::DATA_END, data_end.u32(0));

        let messages = self.len() as u64;
        let mut statistics = Bytes::default();
        statistics
            .u64(messages)
            .u16(1)
            .u32(1)
            .u32(0)
            .u32(0)
            .u32(chunks);
        statistics.u64(first.unwrap_or(0)).u64(last);
        statistics.u32(10).u16(ID).u64(messages);

        let summary = file.end();
        let mut offsets = Bytes::default();
        let mut group = |opcode: u8, records: &Bytes| {
            let mut offset = Bytes::default();
            offset
                .raw(&[opcode])
                .u64(file.end())
                .u64(records.0.len() as u64);
            offsets.record(op::SUMMARY_OFFSET, &offset);
            file.raw(&records.0);
        };
        for (opcode, content) in [
            (op::SCHEMA, &schema),
            (op::CHANNEL, &channel),
            (op::STATISTICS, &statistics),
        ] {
            group(opcode, Bytes::default().record(opcode, content));
        }
        group(op::CHUNK_INDEX, &chunk_indices);

        let summary_offset = file.end();
        let mut footer = Bytes::default();
        footer.u64(summary).u64(summary_offset).u32(0);
        file.raw(&offsets.0).record(op::FOOTER, &footer).raw(MAGIC);
        file.0
    }
}
