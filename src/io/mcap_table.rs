//! A table over time as an MCAP file, for PlotJuggler, Foxglove and Rerun.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use ::mcap::records::MessageHeader;
use ::mcap::{McapError, Writer};

use super::IoError;
use super::error::shown;
use super::protobuf::Doubles;

/// The rows of a table as messages on the topic `topic`, each at its time `t` \[s\], counted from the first row.
/// The schema names every column as a double; what is missing is NaN, as in the table.
///
/// The messages are Protocol Buffers: Rerun decodes no other encoding that describes itself (it has none for
/// JSON), and PlotJuggler and Foxglove read it too.
///
/// Source: MCAP format specification; well-known encoding `protobuf`.
///
/// # Errors
/// If the file cannot be made.
pub fn write_mcap_table(
    path: &Path,
    topic: &str,
    t: &[f64],
    columns: &[(String, Vec<f64>)],
) -> Result<Vec<u8>, IoError> {
    let wrong = |e: McapError| IoError::Format {
        file: shown(path),
        format: "MCAP".into(),
        reason: e.to_string(),
    };
    write(topic, t, columns).map_err(wrong)
}

fn write(topic: &str, t: &[f64], columns: &[(String, Vec<f64>)]) -> Result<Vec<u8>, McapError> {
    let mut writer = Writer::new(Cursor::new(Vec::new()))?;
    let schema = Doubles::new(columns.iter().map(|(name, _)| name.as_str())).schema();
    let schema = writer.add_schema(&Doubles::name(), "protobuf", &schema)?;
    let channel = writer.add_channel(schema, &format!("/{topic}"), "protobuf", &BTreeMap::new())?;
    for (k, now) in t.iter().enumerate() {
        let time = ((now - t[0]) * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: channel,
            sequence: k as u32,
            log_time: time,
            publish_time: time,
        };
        let row = Doubles::message(columns.iter().map(|(_, values)| values[k]));
        writer.write_to_known_channel(&header, &row)?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_back_to_the_last_bit_at_their_times() {
        let t = [10.0, 10.005, 10.02];
        let a = vec![0.1, f64::NAN, 1e-17];
        let columns = [("a".to_owned(), a.clone()), ("b".to_owned(), vec![1.0, 2.0, 3.0])];
        let bytes = write_mcap_table(Path::new("x.mcap"), "run", &t, &columns).unwrap();
        let messages: Vec<_> =
            ::mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap).collect();
        let times: Vec<u64> = messages.iter().map(|m| m.log_time).collect();
        assert_eq!(times, [0, 5_000_000, 20_000_000]);
        let channel = &messages[0].channel;
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!((channel.topic.as_str(), schema.name.as_str()), ("/run", "amigo_ident.Motion"));
        assert_eq!([&channel.message_encoding, &schema.encoding], ["protobuf"; 2]);
        for (k, message) in messages.iter().enumerate() {
            // 1 << 3 | 1 and 2 << 3 | 1 before eight bytes each
            assert_eq!((message.data.len(), message.data[0], message.data[9]), (18, 9, 17));
            let value =
                |at: usize| f64::from_le_bytes(message.data[at..at + 8].try_into().unwrap());
            assert_eq!((value(1).to_bits(), value(10)), (a[k].to_bits(), columns[1].1[k]));
        }
    }
}
