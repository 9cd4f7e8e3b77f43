#!/usr/bin/env python3
"""EMPS of nonlinearbenchmark.org: the identified model as a submission. Needs `pip install nonlinear_benchmarks`.

usage: submission.py MODEL_PY [--data FOLDER] [--start CSV]

MODEL_PY  reports/emps/model.py, which `experiment measured/emps.toml` writes from the training file
--data    folder with emps_est.csv and emps_val_pulses.csv (columns t, q, tau); else the package downloads the data
--start   start from the first row of the simulated motion in this file, which `experiment export measured/emps.toml
          --to csv` writes, in place of the first samples of the position: the score is then that of the program

Prints the RMSE of the simulated position on the test file: a simulation from the force alone.
"""
import argparse
import importlib.util
from pathlib import Path

import numpy as np
import nonlinear_benchmarks
from nonlinear_benchmarks import Input_output_data
from nonlinear_benchmarks.error_metrics import RMSE


def model_of(path):
    spec = importlib.util.spec_from_file_location("model", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def columns(path):
    return np.genfromtxt(path, delimiter=",", names=True)


def from_csv(folder):
    """Training and test data as the package returns them."""

    def read(name):
        data = columns(Path(folder) / name)
        return Input_output_data(u=data["tau"], y=data["q"], sampling_time=data["t"][1] - data["t"][0], name=name)

    train_val, test = read("emps_est.csv"), read("emps_val_pulses.csv")
    test.state_initialization_window_length = 20
    return train_val, test


def start_of(y_init, sampling_time):
    """Position [m] and speed [m/s] of the first sample, by a parabola through the first samples."""
    t = sampling_time * np.arange(len(y_init))
    _, speed, position = np.polyfit(t, y_init, 2)
    return float(position), float(speed)


def start_of_program(path):
    first = columns(path)[0]
    return float(first["alpha1_rad"]), float(first["dalpha1_simulated_rad_s"])


def apply_model(model, u_test, start, sampling_time):
    """The position [m] from the force [N] and the start."""
    t = [k * float(sampling_time) for k in range(len(u_test))]
    # the axis is a robot that drives straight: its position is both wheel angles, its force both torques
    force = [(float(f), float(f)) for f in u_test]
    position, speed = start
    alpha, _ = model.simulate(t, force, [position] * 2, [speed] * 2)
    return np.array(alpha)[:, 0]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("model")
    options.add_argument("--data")
    options.add_argument("--start")
    options = options.parse_args()
    train_val, test = from_csv(options.data) if options.data else nonlinear_benchmarks.EMPS()
    n = test.state_initialization_window_length
    start = start_of_program(options.start) if options.start else start_of(test.y[:n], test.sampling_time)
    y_model = apply_model(model_of(options.model), test.u, start, test.sampling_time)
    print(f"start {start[1]:.5f} m/s, RMSE to submit: {1e3 * RMSE(test.y[n:], y_model[n:]):.2f} mm")


main()
