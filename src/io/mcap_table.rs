//! A table over time as an MCAP file, for PlotJuggler, Foxglove and Rerun.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use ::mcap::records::MessageHeader;
use ::mcap::{McapError, Writer};
use serde_json::{Map, Value, json};

use super::IoError;
use super::error::shown;

/// The rows of a table as JSON messages on the topic `topic`, each at its time `t` \[s\], counted from the
/// first row. The schema names every column as a number; one that is NaN in a row is left out there.
///
/// Source: MCAP format specification; well-known encodings `json` and `jsonschema`.
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
    let number = |(name, _): &(String, Vec<f64>)| (name.clone(), json!({ "type": "number" }));
    let properties: Map<String, Value> = columns.iter().map(number).collect();
    let schema = json!({ "type": "object", "title": topic, "properties": properties }).to_string();
    let schema = writer.add_schema(topic, "jsonschema", schema.as_bytes())?;
    let channel = writer.add_channel(schema, &format!("/{topic}"), "json", &BTreeMap::new())?;
    for (k, now) in t.iter().enumerate() {
        let time = ((now - t[0]) * 1e9).round() as u64;
        let cells = columns.iter().map(|(name, values)| (name.clone(), values[k]));
        let row: Map<String, Value> =
            cells.filter(|(_, v)| v.is_finite()).map(|(name, v)| (name, json!(v))).collect();
        let header = MessageHeader {
            channel_id: channel,
            sequence: k as u32,
            log_time: time,
            publish_time: time,
        };
        writer.write_to_known_channel(&header, Value::Object(row).to_string().as_bytes())?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_back_to_the_last_bit_and_what_is_missing_is_missing() {
        let t = [10.0, 10.005, 10.02];
        let columns =
            [("a".to_owned(), vec![0.1, f64::NAN, 1e-17]), ("b".to_owned(), vec![1.0, 2.0, 3.0])];
        let bytes = write_mcap_table(Path::new("x.mcap"), "run", &t, &columns).unwrap();
        let messages: Vec<_> =
            ::mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap).collect();
        let times: Vec<u64> = messages.iter().map(|m| m.log_time).collect();
        assert_eq!(times, [0, 5_000_000, 20_000_000]);
        assert!(messages.iter().all(|m| m.channel.topic == "/run"));
        let rows: Vec<Value> =
            messages.iter().map(|m| serde_json::from_slice(&m.data).unwrap()).collect();
        assert_eq!(
            rows,
            [json!({"a": 0.1, "b": 1.0}), json!({"b": 2.0}), json!({"a": 1e-17, "b": 3.0})]
        );
    }
}
