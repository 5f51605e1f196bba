"""Makes MCAP's conformance files where a checkout has only pointers of Git LFS in their place.

Each file is described by a JSON beside it. The pointer states the SHA-256 of the published file, and only a file with
that sum is written. Arguments: the folder of the data, and the folder to write into. Prints the names of the files.
"""

import hashlib
import json
import pathlib
import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"
OPCODES = {
    "Header": 1, "Footer": 2, "Schema": 3, "Channel": 4, "Message": 5, "Chunk": 6, "MessageIndex": 7,
    "ChunkIndex": 8, "Attachment": 9, "AttachmentIndex": 10, "Statistics": 11, "Metadata": 12, "MetadataIndex": 13,
    "SummaryOffset": 14, "DataEnd": 15,
}  # fmt: skip


def text(value):
    return struct.pack("<I", len(value.encode())) + value.encode()


def blob(values):
    return bytes(int(value) for value in values)


def pairs(items):
    joined = b"".join(items)
    return struct.pack("<I", len(joined)) + joined


def strings(values):
    return pairs(text(key) + text(value) for key, value in sorted(values.items()))


def numbers(values, form):
    return pairs(struct.pack(form, int(key), int(value)) for key, value in values.items())


def content(kind, f):
    """The bytes of a record without its opcode and length."""
    n = {key: int(value) for key, value in f.items() if isinstance(value, str) and value.lstrip("-").isdigit()}

    def pack(form, *names):
        return struct.pack("<" + form, *(n[name] for name in names))

    if kind == "Header":
        return text(f["profile"]) + text(f["library"])
    if kind == "Footer":
        return pack("QQI", "summary_start", "summary_offset_start", "summary_crc")
    if kind == "Schema":
        data = blob(f["data"])
        return pack("H", "id") + text(f["name"]) + text(f["encoding"]) + struct.pack("<I", len(data)) + data
    if kind == "Channel":
        ids = pack("HH", "id", "schema_id")
        return ids + text(f["topic"]) + text(f["message_encoding"]) + strings(f["metadata"])
    if kind == "Message":
        return pack("HIQQ", "channel_id", "sequence", "log_time", "publish_time") + blob(f["data"])
    if kind == "ChunkIndex":
        times = pack("QQQQ", "message_start_time", "message_end_time", "chunk_start_offset", "chunk_length")
        offsets = numbers(f["message_index_offsets"], "<HQ") + pack("Q", "message_index_length")
        return times + offsets + text(f["compression"]) + pack("QQ", "compressed_size", "uncompressed_size")
    if kind == "Attachment":
        data = blob(f["data"])
        head = pack("QQ", "log_time", "create_time") + text(f["name"]) + text(f["media_type"])
        body = head + struct.pack("<Q", len(data)) + data
        return body + struct.pack("<I", zlib.crc32(body))
    if kind == "AttachmentIndex":
        head = pack("QQQQQ", "offset", "length", "log_time", "create_time", "data_size")
        return head + text(f["name"]) + text(f["media_type"])
    if kind == "Statistics":
        counts = pack("QHIIIIQQ", "message_count", "schema_count", "channel_count", "attachment_count",
                      "metadata_count", "chunk_count", "message_start_time", "message_end_time")  # fmt: skip
        return counts + numbers(f["channel_message_counts"], "<HQ")
    if kind == "Metadata":
        return text(f["name"]) + strings(f["metadata"])
    if kind == "MetadataIndex":
        return pack("QQ", "offset", "length") + text(f["name"])
    if kind == "SummaryOffset":
        return pack("BQQ", "group_opcode", "group_start", "group_length")
    return pack("I", "data_section_crc")


def framed(kind, body, padding=b""):
    if kind in ("Message", "Chunk", "DataEnd", "Footer"):
        padding = b""
    return struct.pack("<BQ", OPCODES[kind], len(body + padding)) + body + padding


def chunked(records, features, padding):
    """The schemas, channels and messages as a chunk, followed by its indexes if `features` contains `mx`."""
    inside = [(kind, f) for kind, f in records if kind in ("Schema", "Channel", "Message")]
    body, offsets, times = b"", {}, []
    for kind, fields in inside:
        if kind == "Message":
            time = int(fields["log_time"])
            offsets.setdefault(int(fields["channel_id"]), []).append((time, len(body)))
            times.append(time)
        body += framed(kind, content(kind, fields))
    head = struct.pack("<QQQI", min(times, default=0), max(times, default=0), len(body), zlib.crc32(body))
    chunk = framed("Chunk", head + text("") + struct.pack("<Q", len(body)) + body)
    for channel, entries in offsets.items() if "mx" in features else ():
        index = struct.pack("<H", channel) + pairs(struct.pack("<QQ", *entry) for entry in entries)
        chunk += framed("MessageIndex", index, padding)
    return chunk


def written(description):
    features = description["meta"]["variant"]["features"]
    padding = b"\x01\xff\xff" if "pad" in features else b""
    records = [(record["type"], dict(record["fields"])) for record in description["records"]]
    end = next(index for index, (kind, _) in enumerate(records) if kind == "DataEnd")
    data, rest = records[1:end], records[end:]
    out = MAGIC + framed("Header", content(*records[0]), padding)
    if "ch" in features:
        out += chunked(data, features, padding)
        data = [(kind, fields) for kind, fields in data if kind not in ("Schema", "Channel", "Message")]
    for kind, fields in data + rest:
        out += framed(kind, content(kind, fields), padding)
    return out + MAGIC


def main(data, target):
    for path in sorted(pathlib.Path(data).glob("*/*.mcap")):
        found = path.read_bytes()
        if found.startswith(b"version https://git-lfs"):
            wanted = found.split(b"sha256:")[1].split()[0].decode()
            found = written(json.loads(path.with_suffix(".json").read_text()))
            if hashlib.sha256(found).hexdigest() != wanted:
                print(f"{path}: what is written anew is not the published file", file=sys.stderr)
                continue
        new = pathlib.Path(target) / path.name
        new.write_bytes(found)
        print(new, flush=True)


main(*sys.argv[1:])
