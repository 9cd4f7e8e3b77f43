//! Bags by the MCAP writer for Python, and messages made of bytes.

use super::*;
use crate::io::headers;
use crate::io::tests::{ROWS, data, input, position, recording, refused, velocity};

#[test]
fn a_bag_by_another_program_is_read_to_the_last_digit() {
    let r = recording(
        "joint_states.mcap",
        &[
            ("alpha1", "right_wheel.position", 1.0),
            ("alpha2", "left_wheel.position", 1.0),
            ("dalpha1", "right_wheel.velocity", 1.0),
            ("dalpha2", "left_wheel.velocity", 1.0),
            ("M1", "right_wheel.effort", 1.0),
            ("M2", "left_wheel.effort", 1.0),
        ],
    );
    assert_eq!(r.len(), ROWS);
    for k in 0..ROWS {
        // stamps of the headers, across a full second, and not the jittering times of logging
        assert_eq!(r.t()[k], (10_000_000 * k) as f64 / 1e9);
        assert_eq!((r.alpha()[k], r.omega()[k]), (position(k), velocity(k)), "row {k}");
        assert_eq!(r.torque()[k], input(k), "row {k}");
    }
    let names = headers(&data("joint_states.mcap")).unwrap().names;
    // the caster, whose numbers are all NaN, is none
    assert_eq!(names[..3], ["t", "right_wheel.position", "left_wheel.position"]);
    assert_eq!(names.len(), 7);
}

#[test]
fn two_topics_without_stamps_are_put_in_rows_by_their_times_of_logging() {
    let r = recording(
        "two_topics.mcap",
        &[
            ("alpha1", "/states/right.position", 1.0),
            ("alpha2", "/states/left.position", 1.0),
            ("dalpha1", "/states/right.velocity", 1.0),
            ("dalpha2", "/states/left.velocity", 1.0),
            ("M1", "/commands/right.effort", 1.0),
            ("M2", "/commands/left.effort", 1.0),
        ],
    );
    assert_eq!(r.len(), ROWS);
    for k in 0..ROWS {
        assert_eq!(r.t()[k], (10_000_000 * k) as f64 / 1e9);
        assert_eq!((r.alpha()[k], r.omega()[k]), (position(k), velocity(k)), "row {k}");
        assert_eq!(r.torque()[k], input(k - k % 2), "row {k}");
    }
}

/// A message in either order of bytes: frame `ab`, joints `l` and `right`, two positions.
fn message(big_endian: bool) -> Vec<u8> {
    let mut out = vec![0, u8::from(!big_endian), 0, 0];
    let int = |out: &mut Vec<u8>, n: u32| {
        out.extend(if big_endian { n.to_be_bytes() } else { n.to_le_bytes() });
    };
    let string = |out: &mut Vec<u8>, text: &str| {
        out.resize((out.len() - 4).next_multiple_of(4) + 4, 0);
        int(out, text.len() as u32 + 1);
        out.extend(text.bytes().chain([0]));
    };
    int(&mut out, 2);
    int(&mut out, 7);
    string(&mut out, "ab");
    out.push(0);
    int(&mut out, 2);
    string(&mut out, "l");
    string(&mut out, "right");
    out.resize((out.len() - 4).next_multiple_of(4) + 4, 0);
    int(&mut out, 2);
    out.resize((out.len() - 4).next_multiple_of(8) + 4, 0);
    for x in [0.1_f64, -7.0] {
        out.extend(if big_endian { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    int(&mut out, 0);
    int(&mut out, 0);
    out
}

#[test]
fn both_orders_of_bytes_are_read() {
    let expected = JointState {
        stamp: 2_000_000_007,
        joints: vec!["l".into(), "right".into()],
        fields: [vec![0.1, -7.0], vec![], vec![]],
    };
    assert_eq!(joint_state(&message(false)).unwrap(), expected);
    assert_eq!(joint_state(&message(true)).unwrap(), expected);
}

#[test]
fn lengths_that_do_not_fit_are_named_before_room_is_made() {
    let mut long = message(false);
    // the length of the list of names
    long[20..24].fill(0xff);
    let e = joint_state(&long).unwrap_err();
    assert_eq!((e.place.as_str(), e.found.as_str()), ("byte 16", "4294967295 elements"));
    let mut three = message(false);
    // before two lengths, two numbers and four bytes of filling
    let at = three.len() - 8 - 16 - 4 - 4;
    three[at] = 1;
    let e = joint_state(&three).unwrap_err();
    assert!(e.expected.contains("2 numbers in position, one for each joint"), "{e:?}");
    let e = joint_state(&[0, 7, 0, 0, 0, 0]).unwrap_err();
    assert!(e.expected.contains("plain CDR"), "{e:?}");
    for cut in 0..message(false).len() {
        assert!(joint_state(&message(false)[..cut]).is_err(), "{cut}");
    }
}

#[test]
fn a_bag_without_joint_states_says_what_it_holds() {
    let mut bytes = vec![];
    let mut bag = ::mcap::Writer::new(std::io::Cursor::new(&mut bytes)).unwrap();
    let schema = bag.add_schema("nav_msgs/msg/Odometry", "ros2msg", b"").unwrap();
    let id = bag.add_channel(schema, "/odom", "cdr", &BTreeMap::new()).unwrap();
    let head = ::mcap::records::MessageHeader {
        channel_id: id,
        sequence: 0,
        log_time: 1,
        publish_time: 1,
    };
    bag.write_to_known_channel(&head, &[0; 8]).unwrap();
    bag.finish().unwrap();
    drop(bag);
    let e = refused("x.mcap", &bytes);
    assert!(e.contains("no joint states") && e.contains("/odom (nav_msgs/msg/Odometry"), "{e}");
    let e = refused("x.mcap", &bytes[..bytes.len() / 2]);
    assert!(e.contains("x.mcap cannot be read as MCAP") && e.contains("mcap recover"), "{e}");
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(5000))]

    // checksums keep most changes of a whole file from getting this far
    #[test]
    fn a_changed_message_is_read_or_refused(
        edits in proptest::collection::vec((0_usize..100, proptest::num::u8::ANY), 0..8),
        big_endian in proptest::bool::ANY,
    ) {
        let mut bytes = message(big_endian);
        for (at, byte) in edits {
            let place = at % bytes.len();
            bytes[place] = byte;
        }
        if let Ok(state) = joint_state(&bytes) {
            let numbers = state.fields.iter().map(Vec::len).sum::<usize>();
            proptest::prop_assert!(8 * numbers + 5 * state.joints.len() <= bytes.len());
        }
    }
}
