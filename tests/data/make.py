"""Writes the recordings of this folder. See README.md for the programs and versions.

Row k of every recording, k = 0 ... 59, 10 ms apart, in numbers that binary floats hold exactly:
  position right k*k/64, left k/8      [rad]
  velocity right k/32,   left -0.5     [rad/s]
  drive    right k%7/16, left -k/128   [N m]
"""

import json
import sys

import numpy as np
from scipy.io import savemat
from mcap_ros2.writer import Writer
from mcap.writer import CompressionType
from wpiutil import DataLogWriter
from wpiutil import log as wpi

ROWS = 60
k = np.arange(ROWS)
position = np.stack([k * k / 64, k / 8], axis=1)
velocity = np.stack([k / 32, np.full(ROWS, -0.5)], axis=1)
drive = np.stack([k % 7 / 16, -k / 128], axis=1)
time = k / 128  # exact in binary, for the formats that hold the time as a float


def wpilog():
    log = DataLogWriter("drive.wpilog", "test data")
    start = 5_000_000  # us
    both = wpi.DoubleArrayLogEntry(log, "/drive/position", start)
    right = wpi.FloatLogEntry(log, "/drive/right/velocity", start)
    left = wpi.DoubleLogEntry(log, "/drive/left/velocity", '{"unit": "rad/s"}', start)
    # twice as slow, and behind the others
    drives = [wpi.IntegerLogEntry(log, f"/drive/{side}/torque_128th", start) for side in ("right", "left")]
    enabled = wpi.BooleanLogEntry(log, "/enabled", start)
    note = wpi.StringLogEntry(log, "/note", start)
    fast = wpi.IntegerLogEntry(log, "/fast", start)
    note.append("a text", start)
    for i in range(ROWS):
        now = start + 10_000 * i
        both.append(list(position[i]), now)
        right.append(velocity[i, 0], now)
        left.append(velocity[i, 1], now)
        if i % 2 == 0:
            for side in range(2):
                drives[side].append(int(drive[i, side] * 128), now - 1000)
            enabled.append(i >= 10, now)
        for j in range(5):
            fast.append(-i, now + 2000 * j)
    left.setMetadata("{}", start)
    fast.finish(start)
    log.flush()
    log.stop()


JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def mcap():
    """One topic with everything and stamps in the headers, and one of another type."""
    with open("joint_states.mcap", "wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        states = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        text = writer.register_msgdef("std_msgs/msg/String", "string data")
        for i in range(ROWS):
            # seven digits of a frame name, so that numbers do not start at a multiple of 8 by luck
            stamp = 1_700_000_000_995_000_000 + 10_000_000 * i
            message = {
                "header": {
                    "stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9},
                    "frame_id": "x" * (i % 8),
                },
                "name": ["caster", "right_wheel", "left_wheel"],
                "position": [float("nan"), *position[i]],
                "velocity": [float("nan"), *velocity[i]],
                "effort": [float("nan"), *drive[i]],
            }
            writer.write_message("/joint_states", states, message, log_time=stamp + 3_000_000 * (i % 3))
            writer.write_message("/rosout", text, {"data": "a text"}, log_time=stamp)
        writer.finish()


def mcap_two():
    """States and commands on two topics, without stamps in the headers."""
    with open("two_topics.mcap", "wb") as file:
        writer = Writer(file, compression=CompressionType.LZ4)
        states = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
        names = ["right", "left"]
        for i in range(ROWS):
            now = 1_700_000_000_000_000_000 + 10_000_000 * i
            if i % 2 == 0:
                command = {"header": header, "name": names, "position": [], "velocity": [], "effort": list(drive[i])}
                writer.write_message("/commands", states, command, log_time=now - 1_000_000)
            state = {"header": header, "name": names, "position": list(position[i]), "velocity": list(velocity[i]), "effort": []}
            writer.write_message("/states", states, state, log_time=now)
        writer.finish()


def mat():
    variables = {
        "t": time,
        "q": position,
        "dq": velocity.T.astype(np.float32),
        "tau_128th": (drive * 128).astype(np.int32),
        "on": k >= 10,
        "radius": 0.1,
        "note": "a text",
        "robot": {"mass": 1.5},
        "z": np.array([1 + 2j, 3]),
        "short": np.arange(5.0),
    }
    savemat("v7.mat", variables, do_compression=True)
    savemat("v6.mat", variables, do_compression=False, oned_as="column")


def sysid():
    def rows(k0, k1):
        left_right = [drive, position, velocity]
        return [
            [time[i]] + [float(v) for q in left_right for v in (q[i, 1], q[i, 0])] + [0.0, 0.0]
            for i in range(k0, k1)
        ]

    data = {
        "fast-forward": rows(36, 60),
        "slow-backward": [],
        "slow-forward": rows(0, 24),
        "sysid": True,
        "test": "Drivetrain",
        "units": "Meters",
        "unitsPerRotation": 0.5,
    }
    with open("sysid.json", "w") as file:
        json.dump(data, file, indent=2)


for make in (wpilog, mcap, mcap_two, mat, sysid):
    if len(sys.argv) < 2 or make.__name__ in sys.argv[1:]:
        make()
