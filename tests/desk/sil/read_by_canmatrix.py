"""Another reader of hal/offnominal.dbc, canmatrix, decodes what a run in the loop has sent.

Usage: read_by_canmatrix.py OFFNOMINAL DBC
"""

import csv
import math
import pathlib
import subprocess
import sys
import tempfile

import canmatrix.formats


def frames_of(path):
    """(time, identifier, bytes, whether CAN FD) of every line of `candump -l`."""
    for line in path.read_text().splitlines():
        time, _, frame = line.split()
        identifier, data = frame.split("#", 1)
        is_fd = data.startswith("#")
        yield float(time[1:-1]), int(identifier, 16), bytes.fromhex(data[2:] if is_fd else data), is_fd


def decode(matrix, identifier, data):
    """Name of the message and its physical values; fails where the file does not have it."""
    message = matrix.frame_by_id(canmatrix.ArbitrationId(identifier, extended=False))
    assert message is not None, f"identifier {identifier:#x} is not in the file"
    # Groups are as long as their joints need, the file describes the longest.
    values = message.decode(data.ljust(message.size, b"\0"))
    return message, {name: float(value.phys_value) for name, value in values.items()}


def joint_values(message, values):
    """(joint, quantity, value) of what is told of joints."""
    for name, value in values.items():
        if message.name.endswith("_group"):
            joint, quantity = name.split("_", 1)
            yield int(joint[1:]), quantity, value
        else:
            yield int(message.name.rsplit("_", 1)[1]), name, value


def check(offnominal, dbc, folder, options):
    log, rows = folder / "run.log", folder / "run.csv"
    command = [offnominal, "sil", "--fault", "none", "--duration", "2", "--force", "--json"]
    subprocess.run([*command, "--candump", log, "--log", rows, *options], check=True, stdout=subprocess.PIPE)
    matrix = canmatrix.formats.loadp_flat(dbc)
    # The first row is where the arm stood before the first tick.
    truth = list(csv.DictReader(rows.open()))[1:]
    positions, velocities, torques, states, kinds = {1: [], 2: []}, {1: [], 2: []}, {1: [], 2: []}, [], set()
    for _, identifier, data, is_fd in frames_of(log):
        message, values = decode(matrix, identifier, data)
        assert bool(message.is_fd) == is_fd, message.name
        kinds.add(message.name.split("_")[0])
        if message.name.startswith("heartbeat"):
            states.append(values["state"])
            continue
        for joint, quantity, value in joint_values(message, values):
            if joint <= 2 and message.name.startswith("encoder"):
                {"position": positions, "velocity": velocities}.get(quantity, {1: [], 2: []})[joint].append(value)
            if joint <= 2 and quantity == "applied_torque":
                torques[joint].append(value)
    assert kinds == {"torque", "encoder", "drive", "heartbeat"}, kinds
    assert states[-1] == 2, "armed in the last heartbeat"
    for joint in (1, 2):
        # The run's own record has a row per tick, of the arm itself; the last ones stand for both.
        for row, q, dq, tau in zip(reversed(truth), reversed(positions[joint]), reversed(velocities[joint]),
                                   reversed(torques[joint])):
            assert abs(q - float(row[f"q{joint}"])) <= 2**-18, (row, q)
            assert abs(dq - float(row[f"dq{joint}"])) <= 2**-10, (row, dq)
            assert math.isclose(tau, float(row[f"tau{joint}"]), rel_tol=1e-6, abs_tol=1e-6), (row, tau)
        assert len(positions[joint]) >= len(truth), "a frame per tick and joint"
    print(f"{' '.join(options) or 'classic'}: {sum(map(len, positions.values()))} readings as the arm was")


def main():
    offnominal, dbc = sys.argv[1:]
    for options in ([], ["--fd"]):
        with tempfile.TemporaryDirectory() as name:
            check(offnominal, dbc, pathlib.Path(name), options)


main()
