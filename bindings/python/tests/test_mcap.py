"""Bags of `zerorate capture --format mcap`, read by the packages of MCAP and of rosbags."""

import json
import math
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.records import Statistics
from mcap.summary import Summary
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

PROGRAM = shutil.which("zerorate", path=sysconfig.get_path("scripts")) or "zerorate is not installed"
SAMPLES = 6000
CALIBRATE = "calibrate --average 1s --warmup 60s --settle 30s --offset 5s --max-u-btc 1 -o unit.toml"


def run(folder: Path, line: str) -> str:
    command = [PROGRAM, *line.split(" ")]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True, timeout=120).stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bags")
    run(folder, f"{CALIBRATE} --device twin:seed=5")
    run(folder, f"capture --device twin:seed=5 --samples {SAMPLES} --every-temp 3 -o raw.mcap")
    run(folder, f"capture --device twin:seed=5 --samples {SAMPLES} --cal unit.toml -o corrected.mcap")
    return folder


def messages(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """The decoded messages of each topic, with the times of the log."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            stamp = message.log_time
            if hasattr(decoded, "header"):
                assert decoded.header.stamp.sec * 10**9 + decoded.header.stamp.nanosec == stamp
                assert decoded.header.frame_id == "imu_link"
            found.setdefault(channel.topic, []).append((stamp, decoded))
    return found


def test_mcap_reads_rates_and_codes(folder: Path) -> None:
    found = messages(folder / "raw.mcap")
    samples = [sample for _, sample in found["/zerorate/samples"]]
    assert len(samples) == SAMPLES
    rates = found["/imu/data_raw"]
    assert len(rates) == SAMPLES
    for sample, (stamp, imu) in zip(samples, rates, strict=True):
        # F-40
        dps = (sample.rate_code - 8388608) / 23488
        assert stamp == sample.t_ns
        assert math.isclose(imu.angular_velocity.z, math.radians(dps), rel_tol=1e-12, abs_tol=1e-15)
        assert (imu.angular_velocity.x, imu.angular_velocity.y) == (0, 0)
        assert list(imu.angular_velocity_covariance) == [0.0] * 9
        assert imu.orientation_covariance[0] == -1 and imu.linear_acceleration_covariance[0] == -1
    with_temp = [sample for sample in samples if sample.temp_code_is_there]
    temperatures = [message.temperature for _, message in found["/imu/temperature"]]
    assert len(with_temp) == SAMPLES / 3
    # F-41
    expected = [(sample.temp_code - 8388608) / 14093 + 25 for sample in with_temp]
    assert temperatures == pytest.approx(expected, rel=1e-12)


def test_mcap_reads_corrected_rates_and_their_covariance(folder: Path) -> None:
    found = messages(folder / "corrected.mcap")
    assert "/imu/data_raw" not in found
    rates = [imu.angular_velocity.z for _, imu in found["/imu/data"]]
    variances = [imu.angular_velocity_covariance[8] for _, imu in found["/imu/data"]]
    mean = sum(rates) / len(rates)
    spread = math.sqrt(sum((rate - mean) ** 2 for rate in rates) / (len(rates) - 1))
    stated = math.sqrt(sum(variances) / len(variances))
    # the noise of a sample, whose bandwidth is stated as that of a filter of first order
    assert spread < stated < 1.3 * spread
    channels, _ = summary(folder / "corrected.mcap")
    ids = {channel.topic: channel.metadata.get("zerorate.calibration_id") for channel in channels.channels.values()}
    assert ids["/imu/data"] and ids["/zerorate/samples"] is None


def test_rosbags_reads_it(folder: Path) -> None:
    bag = folder / "bag"
    bag.mkdir(exist_ok=True)
    shutil.copy(folder / "raw.mcap", bag / "bag_0.mcap")
    (bag / "metadata.yaml").write_text(metadata(folder / "raw.mcap"))
    with AnyReader([bag]) as reader:
        rates = [connection for connection in reader.connections if connection.topic == "/imu/data_raw"]
        assert [connection.msgtype for connection in rates] == ["sensor_msgs/msg/Imu"]
        decoded: list[Any] = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages(rates)]
        samples = [connection for connection in reader.connections if connection.topic == "/zerorate/samples"]
        rows: list[Any] = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages(samples)]
    assert len(decoded) == SAMPLES
    expected = [math.radians((row.rate_code - 8388608) / 23488) for row in rows]
    assert [imu.angular_velocity.z for imu in decoded] == pytest.approx(expected, rel=1e-12, abs=1e-15)


def summary(path: Path) -> tuple[Summary, Statistics]:
    with path.open("rb") as file:
        found = make_reader(file).get_summary()
    assert found is not None and found.statistics is not None
    return found, found.statistics


def metadata(path: Path) -> str:
    """What `ros2 bag reindex` writes beside a bag."""
    found, statistics = summary(path)
    topics = [
        {
            "topic_metadata": {
                "name": channel.topic,
                "type": found.schemas[channel.schema_id].name,
                "serialization_format": "cdr",
                "offered_qos_profiles": "",
            },
            "message_count": statistics.channel_message_counts.get(number, 0),
        }
        for number, channel in found.channels.items()
    ]
    start, end = statistics.message_start_time, statistics.message_end_time
    information = {
        "version": 5,
        "storage_identifier": "mcap",
        "relative_file_paths": ["bag_0.mcap"],
        "duration": {"nanoseconds": end - start},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": statistics.message_count,
        "compression_format": "",
        "compression_mode": "",
        "topics_with_message_count": topics,
    }
    return json.dumps({"rosbag2_bagfile_information": information})
