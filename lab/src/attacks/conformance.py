"""Makes MCAP's conformance files where a checkout has only pointers of Git LFS in their place.

Each file is described by a JSON beside it. The pointer states the SHA-256 of the published file, and only a made file
with that sum is written. Files that are not pointers are copied. Arguments: the folder of the data, and the folder to
write into. Prints the paths of the written files.
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


# The fields of each record. B, H, I and Q are integers, s is a text, m a map of texts and n one of numbers. d, b and a
# are bytes: d without their length, b behind their length of 32 bits, and a behind their length of 64 bits.
LAYOUTS = {
    "Header": "s:profile s:library",
    "Footer": "Q:summary_start Q:summary_offset_start I:summary_crc",
    "Schema": "H:id s:name s:encoding b:data",
    "Channel": "H:id H:schema_id s:topic s:message_encoding m:metadata",
    "Message": "H:channel_id I:sequence Q:log_time Q:publish_time d:data",
    "ChunkIndex": "Q:message_start_time Q:message_end_time Q:chunk_start_offset Q:chunk_length "
                  "n:message_index_offsets Q:message_index_length s:compression Q:compressed_size Q:uncompressed_size",
    "Attachment": "Q:log_time Q:create_time s:name s:media_type a:data",
    "AttachmentIndex": "Q:offset Q:length Q:log_time Q:create_time Q:data_size s:name s:media_type",
    "Statistics": "Q:message_count H:schema_count I:channel_count I:attachment_count I:metadata_count I:chunk_count "
                  "Q:message_start_time Q:message_end_time n:channel_message_counts",
    "Metadata": "s:name m:metadata",
    "MetadataIndex": "Q:offset Q:length s:name",
    "SummaryOffset": "B:group_opcode Q:group_start Q:group_length",
    "DataEnd": "I:data_section_crc",
}  # fmt: skip


def sized(data, form="<I"):
    return struct.pack(form, len(data)) + data


def text(value):
    return sized(value.encode())


def pairs(items):
    return sized(b"".join(items))


def field(code, value):
    if code == "s":
        return text(value)
    if code == "m":
        return pairs(text(key) + text(value) for key, value in sorted(value.items()))
    if code == "n":
        return pairs(struct.pack("<HQ", int(key), int(value)) for key, value in value.items())
    if code in "dba":
        data = bytes(int(byte) for byte in value)
        return data if code == "d" else sized(data, "<I" if code == "b" else "<Q")
    return struct.pack("<" + code, int(value))


def content(kind, fields):
    """The bytes of a record without its opcode and length."""
    layout = (entry.split(":") for entry in LAYOUTS[kind].split())
    body = b"".join(field(code, fields[name]) for code, name in layout)
    return body + struct.pack("<I", zlib.crc32(body)) if kind == "Attachment" else body


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
    chunk = framed("Chunk", head + text("") + sized(body, "<Q"))
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
