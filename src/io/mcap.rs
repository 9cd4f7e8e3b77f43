//! ROS 2 bags in MCAP: the joint states in them.
//!
//! Messages of type `sensor_msgs/msg/JointState` become the columns `<joint>.position`,
//! `<joint>.velocity` and `<joint>.effort`; where several topics carry such messages, their names
//! stand before, `<topic>/<joint>.position`. The column `t` \[s\] counts from the first row. Stamps
//! are those of the headers, or the times of logging for a topic with a header that has none.
//! Topics and joints that come at different times are put in rows as the entries of a WPILOG are.
//!
//! ```text
//! JointState = header: { stamp: { sec: i32, nanosec: u32 }, frame_id: string }
//!              name: string[], position: f64[], velocity: f64[], effort: f64[]
//! ```
//! in CDR: four bytes that say the order of bytes, then each number at a multiple of its size,
//! strings with length and a closing zero. A field without numbers, or with NaN throughout, is no
//! column.
//!
//! Source: MCAP format specification; OMG DDSI-RTPS 2.3, section 10 (CDR).

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use ::mcap::io::MessageReader;
use ::mcap::sans_io::LinearReaderOptions;
use ::mcap::{McapError, Message};

use super::IoError;
use super::bytes::{Bytes, Damage};
use super::error::shown;
use super::signals::{Collector, Signals};
use super::whole::{Content, WholeFormat};

const TYPE: &str = "sensor_msgs/msg/JointState";
/// Records of other topics, such as images, may be this large \[bytes\].
const LARGEST_RECORD: usize = 256 << 20;
/// Joint states in one file \[bytes\]; a compressed file can claim any number.
const MOST_BYTES: usize = 1 << 30;

/// Messages of one topic.
#[derive(Default)]
struct Topic {
    /// Header stamp and time of logging of each message [ns].
    stamps: Vec<(i64, i64)>,
    /// Fields of joints, stamped with the number of their message.
    signals: Collector,
}

/// Joint states by topic, and the message types of the other topics.
#[derive(Default)]
struct Bag {
    topics: BTreeMap<String, Topic>,
    others: BTreeMap<String, String>,
    bytes: usize,
}

pub(super) const FORMAT: WholeFormat = WholeFormat {
    extension: "mcap",
    magic: b"\x89MCAP0\r\n",
    read: |path| read(path).map(Content::Signals),
};

fn read(path: &Path) -> Result<Signals, IoError> {
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    let options = LinearReaderOptions::default()
        .with_record_length_limit(LARGEST_RECORD)
        .with_validate_chunk_crcs(true);
    let mut bag = Bag::default();
    for message in MessageReader::new_with_options(BufReader::new(file), options) {
        let message = message.map_err(|e| unreadable(path, &e))?;
        bag.add(&message).map_err(|damage| damage.in_file(path, "MCAP"))?;
    }
    let others: Vec<String> = bag.others.iter().map(|(t, kind)| format!("{t} ({kind})")).collect();
    let signals = bag.signals();
    if signals.is_empty() {
        let others = if others.is_empty() { "none".into() } else { others.join(", ") };
        let needed = "joint states (sensor_msgs/msg/JointState in cdr) with numbers";
        return Err(IoError::nothing(path, "MCAP", needed, &others));
    }
    Ok(signals)
}

fn unreadable(path: &Path, e: &McapError) -> IoError {
    let reason = match e {
        McapError::UnexpectedEof => "it ends in the middle of a record".into(),
        McapError::BadMagic => "it does not begin and end with the mark of an MCAP file".into(),
        _ => e.to_string().lines().next().unwrap_or_default().to_string(),
    };
    let reason = format!("{reason}; `mcap recover` saves the messages before the damage");
    IoError::Format { file: shown(path), format: "MCAP".into(), reason }
}

impl Bag {
    fn add(&mut self, message: &Message) -> Result<(), Damage> {
        let channel = &message.channel;
        let kind = channel.schema.as_ref().map_or("no type", |s| s.name.as_str());
        if kind != TYPE || channel.message_encoding != "cdr" {
            if !self.others.contains_key(&channel.topic) {
                let said = format!("{kind} in {}", channel.message_encoding);
                self.others.insert(channel.topic.clone(), said);
            }
            return Ok(());
        }
        self.bytes += message.data.len();
        if self.bytes > MOST_BYTES {
            let expected = format!("at most {} MiB of joint states", MOST_BYTES >> 20);
            return Err(Damage::new(format!("topic {}", channel.topic), expected, "more"));
        }
        let topic = self.topics.entry(channel.topic.clone()).or_default();
        let number = topic.stamps.len() + 1;
        topic
            .add(&message.data, message.log_time as i64)
            .map_err(|damage| damage.of(&format!("message {number} of {}", channel.topic)))
    }

    fn signals(self) -> Signals {
        let mut all = Collector::default();
        let several = self.topics.len() > 1;
        for (name, topic) in self.topics {
            let stamped = topic.stamps.iter().all(|(header, _)| *header != 0);
            let stamp = |message: i64| {
                let (header, logged) = topic.stamps[message as usize];
                if stamped { header } else { logged }
            };
            let prefix = if several { format!("{name}/") } else { String::new() };
            all.absorb(topic.signals, &prefix, stamp);
        }
        all.finish(1e9)
    }
}

impl Topic {
    fn add(&mut self, data: &[u8], logged: i64) -> Result<(), Damage> {
        let state = joint_state(data)?;
        let message = self.stamps.len() as i64;
        self.stamps.push((state.stamp, logged));
        for (field, values) in ["position", "velocity", "effort"].iter().zip(&state.fields) {
            for (joint, value) in state.joints.iter().zip(values) {
                let place = self.signals.place(&format!("{joint}.{field}"));
                self.signals.push(place, message, *value);
            }
        }
        Ok(())
    }
}

/// A message.
#[derive(Debug, PartialEq)]
struct JointState {
    /// Stamp of the header [ns].
    stamp: i64,
    joints: Vec<String>,
    /// Position, velocity, effort: one number for each joint or none.
    fields: [Vec<f64>; 3],
}

fn joint_state(data: &[u8]) -> Result<JointState, Damage> {
    let (mark, body) = data.split_at_checked(4).unwrap_or((data, &[]));
    let big_endian = match mark {
        [0, 1, ..] => false,
        [0, 0, ..] => true,
        _ => {
            let expected = "plain CDR (00 00 or 00 01)";
            return Err(Damage::new("byte 0", expected, format!("{mark:02x?}")));
        }
    };
    let mut bytes = Bytes::ordered(body, big_endian);
    let seconds = bytes.u32("header.stamp.sec")? as i32;
    let nanoseconds = bytes.u32("header.stamp.nanosec")?;
    string(&mut bytes, "header.frame_id")?;
    let count = length(&mut bytes, 5, "name")?;
    let joints = (0..count).map(|_| string(&mut bytes, "name")).collect::<Result<Vec<_>, _>>()?;
    let mut numbers = |what: &str| {
        let count = length(&mut bytes, 8, what)?;
        if count != 0 && count != joints.len() {
            let expected =
                format!("{} numbers in {what}, one for each joint, or none", joints.len());
            return Err(Damage::new(format!("byte {}", bytes.at()), expected, count.to_string()));
        }
        if count > 0 {
            bytes.align(8);
        }
        (0..count).map(|_| bytes.f64(what)).collect::<Result<Vec<f64>, _>>()
    };
    let fields = [numbers("position")?, numbers("velocity")?, numbers("effort")?];
    let stamp = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
    Ok(JointState { stamp, joints, fields })
}

/// The length of a sequence whose elements take at least `size` bytes, checked before anything
/// is made room for.
fn length(bytes: &mut Bytes, size: usize, what: &str) -> Result<usize, Damage> {
    bytes.align(4);
    let place = format!("byte {}", bytes.at());
    let count = bytes.u32(what)? as usize;
    if count > bytes.left() / size {
        let expected = format!("a {what} that fits in {} bytes", bytes.left());
        return Err(Damage::new(place, expected, format!("{count} elements")));
    }
    Ok(count)
}

fn string(bytes: &mut Bytes, what: &str) -> Result<String, Damage> {
    let count = length(bytes, 1, what)?;
    let text = bytes.take(count, what)?;
    let text = text.strip_suffix(&[0]).unwrap_or(text);
    Ok(String::from_utf8_lossy(text).into_owned())
}

#[cfg(test)]
mod tests;
